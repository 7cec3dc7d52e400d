//! What a session may hold: only what could be saved and opened again.

use nalgebra::UnitQuaternion;

use crate::geometry::{Base, Flange, Frame, Transform, Vec3};
use crate::session::limits::{self, Quantity};
use crate::session::model::{Capture, Edge, Reading, Station, Target, WrittenAngles};

use super::EditRefusal;
use super::labels::Labels;

pub(super) fn within(value: f64, quantity: &Quantity) -> Result<(), EditRefusal> {
    if quantity.admits(value) {
        Ok(())
    } else {
        Err(EditRefusal::OutOfRange { found: value, expected: quantity.to_string() })
    }
}

pub(super) fn all_within(values: &Vec3, quantity: &Quantity) -> Result<(), EditRefusal> {
    values.iter().try_for_each(|value| within(*value, quantity))
}

pub(super) fn check_label(label: &str) -> Result<(), EditRefusal> {
    let is_usable = !label.trim().is_empty() && !label.chars().any(char::is_control);
    is_usable.then_some(()).ok_or(EditRefusal::LabelUnusable)
}

/// A profile is within its limits by its type.
pub(super) fn check_reading(reading: &Reading) -> Result<(), EditRefusal> {
    match reading {
        Reading::Point(point_in_sensor) => all_within(point_in_sensor, &limits::POINT_MM),
        Reading::Pose(sensor_from_target) => all_within(&sensor_from_target.translation_mm(), &limits::POSITION_MM),
        Reading::Profile(_) => Ok(()),
    }
}

/// Gives a capture another pose, in the form that it would have after saving and loading.
pub(super) fn set_pose(
    capture: &mut Capture,
    base_from_flange: Transform<Base, Flange>,
    written_angles: Option<WrittenAngles>,
) -> Result<(), EditRefusal> {
    all_within(&base_from_flange.translation_mm(), &limits::POSITION_MM)?;
    if let Some(written) = &written_angles {
        written.angles_deg.iter().try_for_each(|angle| within(*angle, &limits::ANGLE_DEG))?;
    }
    capture.base_from_flange = as_saved(&base_from_flange);
    capture.written_angles = written_angles;
    if written_angles.is_none()
        && let Some(serde_json::Value::Object(of_pose)) = capture.unknown.get_mut("base_from_flange")
    {
        // What else the file said of angles that are there no more.
        of_pose.shift_remove("written");
        if of_pose.is_empty() {
            capture.unknown.shift_remove("base_from_flange");
        }
    }
    Ok(())
}

/// Of the two quaternions of a rotation the one with `w ≥ 0`, of unit norm as exactly as loading demands.
pub(super) fn as_saved<Dst: Frame, Src: Frame>(pose: &Transform<Dst, Src>) -> Transform<Dst, Src> {
    let quaternion = pose.rotation().into_inner();
    let upper = if quaternion.w < 0.0 { -quaternion } else { quaternion };
    let rotation = if (upper.norm() - 1.0).abs() > limits::QUATERNION_NORM_EXACT {
        UnitQuaternion::new_normalize(upper)
    } else {
        UnitQuaternion::new_unchecked(upper)
    };
    Transform::from_parts(pose.translation_mm(), rotation)
}

/// Stations from elsewhere, such as an import, are looked at as a whole.
pub(super) fn check_stations(
    stations: &mut [Station],
    target: &Target,
    labels: &mut Labels,
) -> Result<(), EditRefusal> {
    for station in stations {
        check_station(station)?;
        station.label = labels.claim(&station.label);
        if *target == Target::RightAnglePlate {
            need_edge(station);
        }
    }
    Ok(())
}

/// A station of a plate saw an edge. One that does not say which takes no part until somebody has looked.
pub(super) fn need_edge(station: &mut Station) {
    if station.edge.is_none() {
        station.edge = Some(Edge::P);
        station.enabled = false;
    }
}

fn check_station(station: &mut Station) -> Result<(), EditRefusal> {
    check_label(&station.label)?;
    if station.captures.is_empty() {
        return Err(EditRefusal::NoCaptures { label: station.label.clone() });
    }
    station.captures.iter_mut().try_for_each(check_capture)
}

pub(super) fn check_capture(capture: &mut Capture) -> Result<(), EditRefusal> {
    set_pose(capture, capture.base_from_flange, capture.written_angles)?;
    check_reading(&capture.reading)?;
    capture.step_mm.map_or(Ok(()), |step_mm| within(step_mm, &limits::STEP_MM))
}
