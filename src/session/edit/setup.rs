//! Edits of the session as a whole: robot, sensor, target, and what is known of it.

use std::path::Path;

use crate::geometry::{Flange, Sensor, Transform};
use crate::session::limits::{self, Quantity};
use crate::session::model::{Known, Session, Target};

use super::valid::{all_within, as_saved, need_edge, within};
use super::{EditRefusal, SetupField};

pub(super) fn set_field(session: &mut Session, field: &SetupField) -> Result<(), EditRefusal> {
    let optional = |value: &Option<f64>, quantity: &Quantity| {
        value.map_or(Ok(()), |value| within(value, quantity)).map(|()| *value)
    };
    match field {
        SetupField::Name(name) => session.name.clone_from(name),
        SetupField::Notes(notes) => session.notes.clone_from(notes),
        SetupField::RobotModel(model) => session.robot.model.clone_from(model),
        SetupField::PositionStdMm(std) => session.robot.position_std_mm = optional(std, &limits::LENGTH_STD_MM)?,
        SetupField::OrientationStdDeg(std) => {
            session.robot.orientation_std_deg = optional(std, &limits::ORIENTATION_STD_DEG)?;
        }
        SetupField::SensorModel(model) => session.sensor.model.clone_from(model),
        SetupField::ProfileStdMm(std) => session.sensor.profile_std_mm = optional(std, &limits::LENGTH_STD_MM)?,
        SetupField::ReferenceDistanceMm(distance) => {
            session.sensor.reference_distance_mm = optional(distance, &limits::REFERENCE_DISTANCE_MM)?;
        }
        SetupField::Target(target) => set_target(session, target)?,
        SetupField::Mount(mount) => session.mount = *mount,
    }
    Ok(())
}

fn set_target(session: &mut Session, target: &Target) -> Result<(), EditRefusal> {
    check_target(target)?;
    match target {
        Target::RightAnglePlate => session.stations.iter_mut().for_each(need_edge),
        Target::Rgbd { .. } if !session.stations.is_empty() => return Err(EditRefusal::NoStationsHere),
        Target::Ball { .. } | Target::Point | Target::Pose { .. } | Target::Workpiece | Target::Rgbd { .. } => {}
    }
    if std::mem::discriminant(target) != std::mem::discriminant(&session.target) {
        // The truth and what is known were of the other kind, and so was what else the file said of it.
        session.truth = None;
        session.known = Known::default();
        for name in ["target", "truth", "sequence", "stations"] {
            session.unknown.shift_remove(name);
        }
    }
    session.target = target.clone();
    Ok(())
}

pub(super) fn check_target(target: &Target) -> Result<(), EditRefusal> {
    match target {
        Target::Ball { radius_mm, radius_std_mm } => {
            within(*radius_mm, &limits::BALL_RADIUS_MM)?;
            radius_std_mm.map_or(Ok(()), |std| within(std, &limits::LENGTH_STD_MM))
        }
        Target::Rgbd { sequence } if sequence.trim().is_empty() || Path::new(sequence).is_absolute() => {
            Err(EditRefusal::NotASequence { found: sequence.clone() })
        }
        Target::Pose { translation_std_mm, rotation_std_deg } => {
            translation_std_mm.map_or(Ok(()), |std| within(std, &limits::LENGTH_STD_MM))?;
            rotation_std_deg.map_or(Ok(()), |std| within(std, &limits::ORIENTATION_STD_DEG))
        }
        Target::RightAnglePlate | Target::Point | Target::Workpiece | Target::Rgbd { .. } => Ok(()),
    }
}

pub(super) fn set_known(session: &mut Session, known: &Known) -> Result<(), EditRefusal> {
    check_known(known, &session.target)?;
    session.known = *known;
    Ok(())
}

/// A point was touched somewhere, a workpiece has sizes; of other targets nothing is known beside what they are.
pub(super) fn check_known(known: &Known, target: &Target) -> Result<(), EditRefusal> {
    let Known { point_in_base_mm, angle_deg, pitch_mm, height_mm, diameter_mm } = known;
    let is_point = *target == Target::Point;
    let is_workpiece = *target == Target::Workpiece;
    let needed = match target {
        Target::Point => "touched_in_base_mm or nothing",
        Target::Workpiece => "angle_deg, pitch_mm, height_mm, diameter_mm or nothing",
        Target::Ball { .. } | Target::RightAnglePlate | Target::Pose { .. } | Target::Rgbd { .. } => "nothing",
    };
    let sizes = [
        ("angle_deg", angle_deg, &limits::PLANE_ANGLE_DEG),
        ("pitch_mm", pitch_mm, &limits::PART_SIZE_MM),
        ("height_mm", height_mm, &limits::PART_SIZE_MM),
        ("diameter_mm", diameter_mm, &limits::PART_SIZE_MM),
    ];
    let stray = [("touched_in_base_mm", point_in_base_mm.is_some() && !is_point)]
        .into_iter()
        .chain(sizes.map(|(field, value, _)| (field, value.is_some() && !is_workpiece)))
        .find(|(_, is_stray)| *is_stray);
    if let Some((field, _)) = stray {
        return Err(EditRefusal::NotKnownOfThis { field, needed });
    }
    point_in_base_mm.as_ref().map_or(Ok(()), |point| all_within(point, &limits::POSITION_MM))?;
    sizes.into_iter().try_for_each(|(_, value, quantity)| value.map_or(Ok(()), |value| within(value, quantity)))
}

pub(super) fn set_rough_mounting(
    session: &mut Session,
    rough: Option<&Transform<Flange, Sensor>>,
) -> Result<(), EditRefusal> {
    rough.map_or(Ok(()), |rough| all_within(&rough.translation_mm(), &limits::POSITION_MM))?;
    session.sensor.rough_flange_from_sensor = rough.map(as_saved);
    // What else the file said of it was about the one before.
    session.sensor.unknown.shift_remove("rough_flange_from_sensor");
    Ok(())
}
