//! The same poses in other numbers, and the same numbers read as other poses.

use crate::geometry::PoseNotation;
use crate::session::limits;
use crate::session::model::{Capture, Session, WrittenAngles};

use super::EditRefusal;
use super::valid::{all_within, set_pose};

pub(super) fn set_notation(session: &mut Session, notation: &PoseNotation) -> Result<(), EditRefusal> {
    if let Some(flange_from_tcp) = &notation.flange_from_tcp {
        all_within(&flange_from_tcp.translation_mm(), &limits::POSITION_MM)?;
    }
    session.robot.notation = *notation;
    Ok(())
}

/// The numbers of each pose, as they are shown now, read in the other way.
pub(super) fn reinterpret(session: &mut Session, notation: &PoseNotation) -> Result<(), EditRefusal> {
    let shown = session.robot.notation;
    let of_further = session.further.iter_mut().flat_map(|further| &mut further.stations);
    for station in session.stations.iter_mut().chain(of_further) {
        for capture in &mut station.captures {
            let numbers = shown_numbers(capture, &shown);
            let base_from_flange = notation
                .base_from_flange(&numbers)
                .map_err(|problem| EditRefusal::NotAPose { label: station.label.clone(), problem })?;
            set_pose(capture, base_from_flange, written_angles(&numbers, notation))?;
        }
    }
    set_notation(session, notation)
}

/// The numbers of a capture's pose: as they were typed where that is known, as near gimbal lock other angles mean the same.
#[must_use]
pub fn shown_numbers(capture: &Capture, notation: &PoseNotation) -> Vec<f64> {
    let mut numbers = notation.numbers(&capture.base_from_flange);
    let written = capture.written_angles.filter(|written| written.convention.id == notation.convention.id);
    if let Some(written) = written.filter(|_| notation.writes_angles_of_the_flange()) {
        numbers.truncate(3);
        numbers.extend(written.angles_deg.map(|angle| angle / notation.angle_unit.in_degrees()));
    }
    numbers
}

/// The angles among the numbers of a pose, where they are to be kept beside the rotation.
#[must_use]
pub fn written_angles(numbers: &[f64], notation: &PoseNotation) -> Option<WrittenAngles> {
    let angles: [f64; 3] = numbers.get(3..)?.try_into().ok()?;
    let angles_deg = angles.map(|angle| angle * notation.angle_unit.in_degrees());
    let is_kept =
        notation.writes_angles_of_the_flange() && angles_deg.iter().all(|angle| limits::ANGLE_DEG.admits(*angle));
    is_kept.then_some(WrittenAngles { angles_deg, convention: notation.convention })
}
