//! All the ways to read the poses of a session that could be meant.

use std::f64::consts::TAU;

use crate::geometry::{AngleOrder, PoseConvention, Vec3};
use crate::session::{Capture, Session};

use super::reading::{
    AngleReading, AngleUnit, Inversion, LengthUnit, PoseReading, QuaternionOrder, RotationReading, numbers,
};
use super::sections::Section;

/// The positions of a robot's stations about one ball lie within a box of at least and at most this diagonal, mm.
const EXTENT_MM: std::ops::RangeInclusive<f64> = 10.0..=10_000.0;

/// The ways, the simpler ones first, beginning with the session as given.
pub(super) fn candidates(session: &Session, sections: &[Section]) -> Vec<PoseReading> {
    let rotations = rotations(session, sections);
    let lengths: Vec<LengthUnit> = lengths(session, sections);
    let mut readings: Vec<PoseReading> = Vec::with_capacity(rotations.len() * lengths.len() * Inversion::ALL.len());
    for length_unit in lengths {
        for inversion in Inversion::ALL {
            let reading =
                |rotation: &RotationReading| PoseReading { rotation: rotation.clone(), inversion, length_unit };
            readings.extend(rotations.iter().map(reading));
        }
    }
    readings.sort_by_key(PoseReading::num_changes);
    readings
}

/// Units in which the positions would have the extent of a robot's work; millimetres in any case.
fn lengths(session: &Session, sections: &[Section]) -> Vec<LengthUnit> {
    let positions = || {
        sections.iter().map(|section| {
            session.stations[section.station_idx].captures[section.capture_idx].base_from_flange.translation_mm()
        })
    };
    let most = positions().fold(Vec3::repeat(f64::NEG_INFINITY), |most, position| most.sup(&position));
    let least = positions().fold(Vec3::repeat(f64::INFINITY), |least, position| least.inf(&position));
    let extent = (most - least).norm();
    let is_likely =
        |unit: &LengthUnit| *unit == LengthUnit::Millimetres || EXTENT_MM.contains(&(extent * unit.factor()));
    LengthUnit::ALL.into_iter().filter(is_likely).collect()
}

fn rotations(session: &Session, sections: &[Section]) -> Vec<RotationReading> {
    let written: Vec<bool> =
        sections.iter().map(|section| capture(session, section).written_angles.is_some()).collect();
    let all_written = written.iter().all(|is_written| *is_written);
    let any_written = written.iter().any(|is_written| *is_written);
    let mut rotations = vec![RotationReading::AsGiven];
    if !all_written {
        rotations.extend([QuaternionOrder::Xyzw, QuaternionOrder::WxyzReordered].map(RotationReading::Quaternion));
    }
    let froms = if all_written { written_order(session, sections).into_iter().collect() } else { orders_read(session) };
    let makers_first = {
        let mut orders = AngleOrder::ALL;
        orders.sort_by_key(|order| !has_maker(*order));
        orders
    };
    for from in froms {
        for unit in angle_units(session, sections, from, all_written) {
            for to in makers_first {
                if to != from || unit != AngleUnit::Degrees {
                    // Where nobody wrote the numbers, they may as well be listed backwards, as some maker does.
                    let is_backwards = !any_written && !has_maker(to) && has_maker(to.backwards());
                    let (from, to) = if is_backwards { (from.backwards(), to.backwards()) } else { (from, to) };
                    let second_at_station_idxs = Vec::new();
                    rotations.push(RotationReading::Angles(AngleReading { from, to, unit, second_at_station_idxs }));
                }
            }
        }
    }
    rotations
}

fn has_maker(order: AngleOrder) -> bool {
    PoseConvention::of_order(order).next().is_some()
}

fn capture<'a>(session: &'a Session, section: &Section) -> &'a Capture {
    &session.stations[section.station_idx].captures[section.capture_idx]
}

/// How the file says that its numbers are to be read.
fn written_order(session: &Session, sections: &[Section]) -> Option<AngleOrder> {
    sections.iter().find_map(|section| capture(session, section).written_angles).map(|written| written.convention.order)
}

/// The orders by which a program may have made the rotations: the robot's own, then those of the other makers. A list of
/// numbers and the same list backwards are read alike, so one of them is enough.
fn orders_read(session: &Session) -> Vec<AngleOrder> {
    let mut orders = vec![session.robot.notation.convention.order];
    for convention in PoseConvention::MAKERS {
        let order = convention.order;
        if !orders.contains(&order) && !orders.contains(&order.backwards()) {
            orders.push(order);
        }
    }
    orders
}

/// Degrees, and what else numbers of this size may be.
fn angle_units(session: &Session, sections: &[Section], from: AngleOrder, are_written: bool) -> Vec<AngleUnit> {
    let largest = sections
        .iter()
        .flat_map(|section| numbers(&session.stations[section.station_idx], section.capture_idx, from, false))
        .fold(0.0_f64, |largest, number| largest.max(number.abs()))
        .to_degrees();
    let mut units = vec![AngleUnit::Degrees];
    if largest <= TAU {
        units.push(AngleUnit::Radians);
    }
    // Of a rotation the whole turns are lost, and with them such numbers.
    if are_written && largest > 360.0 {
        units.push(AngleUnit::DegreesConvertedTwice);
    }
    units
}
