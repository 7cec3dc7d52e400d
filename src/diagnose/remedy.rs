//! One-click remedies: a changed copy of the session; undo is the caller's.

use std::sync::Arc;

use crate::calibrate::{Edge, Mount, SideChoice};
use crate::geometry::{Profile, Transform};
use crate::session::{Reading, Session, Target};

use super::convention::PoseReading;
use super::finding::Axis;

/// What mends a fault. Stations are given by their index in the session.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// These stations take no part any more.
    LeaveOut(Vec<usize>),
    /// All poses are read in this way.
    ReadPosesAs(PoseReading),
    /// The ball's radius, mm.
    SetRadius(f64),
    /// Sides of the ball's centre.
    SetSides(Vec<(usize, SideChoice)>),
    /// The edge of the plate that a station saw.
    SetEdge {
        /// The station.
        station_idx: usize,
        /// The edge.
        edge: Edge,
    },
    /// `(station, station whose poses it gets)`, all at once. A station whose poses go to another and that gets none is left
    /// out: nobody knows where it was.
    TakePosesFrom(Vec<(usize, usize)>),
    /// All profiles (and reduced points) times this factor.
    ScaleProfiles(f64),
    /// This coordinate of all profiles (and reduced points) with the other sign.
    MirrorProfiles(Axis),
    /// The sensor is mounted the other way: on the flange, or fixed beside the robot.
    ToOtherMount,
    /// The places of the target times this factor.
    ScaleTargets(f64),
    /// The stations from the first on report this frame; their poses become those of the flange again.
    RemoveTool {
        /// The first station concerned.
        from_station_idx: usize,
        /// The frame in the flange.
        flange_from_tool: crate::geometry::Rigid,
    },
}

/// The session with the remedy applied.
#[must_use]
pub fn apply(session: &Session, remedy: &Remedy) -> Session {
    let mut mended = session.clone();
    match remedy {
        Remedy::LeaveOut(station_idxs) => {
            for (idx, station) in mended.stations.iter_mut().enumerate() {
                station.enabled &= !station_idxs.contains(&idx);
            }
        }
        Remedy::ReadPosesAs(reading) => reading.apply(&mut mended),
        Remedy::SetRadius(found_mm) => {
            if let Target::Ball { radius_mm, .. } = &mut mended.target {
                *radius_mm = *found_mm;
            }
        }
        Remedy::SetSides(sides) => {
            for (idx, side) in sides {
                if let Some(station) = mended.stations.get_mut(*idx) {
                    station.side = *side;
                }
            }
        }
        Remedy::SetEdge { station_idx, edge } => {
            if let Some(station) = mended.stations.get_mut(*station_idx) {
                station.edge = Some(*edge);
            }
        }
        Remedy::TakePosesFrom(pairs) => {
            for (to, from) in pairs {
                let Some(source) = session.stations.get(*from) else { continue };
                let Some(station) = mended.stations.get_mut(*to) else { continue };
                if station.captures.len() != source.captures.len() {
                    continue;
                }
                for (capture, other) in station.captures.iter_mut().zip(&source.captures) {
                    capture.base_from_flange = other.base_from_flange;
                    capture.written_angles = other.written_angles;
                }
            }
            for (idx, station) in mended.stations.iter_mut().enumerate() {
                let gives = pairs.iter().any(|(_, from)| *from == idx);
                let gets = pairs.iter().any(|(to, _)| *to == idx);
                station.enabled &= gets || !gives;
            }
        }
        Remedy::ScaleProfiles(factor) => change_readings(&mut mended, |x, z| (x * factor, z * factor)),
        Remedy::MirrorProfiles(Axis::X) => change_readings(&mut mended, |x, z| (-x, z)),
        Remedy::MirrorProfiles(Axis::Z) => change_readings(&mut mended, |x, z| (x, -z)),
        Remedy::ToOtherMount => {
            mended.mount = match mended.mount {
                Mount::OnFlange => Mount::Fixed,
                Mount::Fixed => Mount::OnFlange,
            };
        }
        Remedy::ScaleTargets(factor) => {
            for capture in mended.stations.iter_mut().flat_map(|station| &mut station.captures) {
                if let Reading::Pose(seen) = &mut capture.reading {
                    *seen = Transform::from_parts(seen.translation_mm() * *factor, seen.rotation());
                }
            }
        }
        Remedy::RemoveTool { from_station_idx, flange_from_tool } => {
            let tool_from_flange = flange_from_tool.inverse();
            for capture in mended.stations.iter_mut().skip(*from_station_idx).flat_map(|station| &mut station.captures)
            {
                capture.base_from_flange = Transform::from_rigid(*capture.base_from_flange.rigid() * tool_from_flange);
                capture.written_angles = None;
            }
        }
    }
    mended
}

/// Maps x and z of every reading; one that would not be a profile any more stays as it was.
fn change_readings(session: &mut Session, map: impl Fn(f64, f64) -> (f64, f64)) {
    for capture in session.stations.iter_mut().flat_map(|station| &mut station.captures) {
        match &mut capture.reading {
            Reading::Point(point) => (point.x, point.z) = map(point.x, point.z),
            // A camera has no line to mirror or scale.
            Reading::Pose(_) => {}
            Reading::Profile(profile) => {
                if let Some(changed) = changed_profile(profile, &map) {
                    *profile = Arc::new(changed);
                }
            }
        }
    }
}

fn changed_profile(profile: &Profile, map: &impl Fn(f64, f64) -> (f64, f64)) -> Option<Profile> {
    let (mut x_mm, mut z_mm) = (Vec::with_capacity(profile.len()), Vec::with_capacity(profile.len()));
    for (x, z) in profile.x_mm().iter().zip(profile.z_mm()) {
        let (x, z) = map(*x, *z);
        x_mm.push(x);
        z_mm.push((!z.is_nan()).then_some(z));
    }
    Profile::new(x_mm, &z_mm).ok()
}
