//! The calibration as a matrix, as a quaternion and in the robot's own numbers, with the conventions spelt out.

use crate::calibrate::Solution;
use crate::geometry::notation::AngleUnit;
use crate::report::document::{Block, Cell, Column, Fact, Table};
use crate::report::evidence::Evidence;
use crate::session::Session;
use crate::text::conventions::not_known_apart;
use crate::text::digits::decimals_for;
use crate::text::report as words;

/// Decimals of direction cosines and quaternions where their uncertainty is not known: a micrometre at a metre.
const ROTATION_DECIMALS: usize = 6;

/// Decimals of direction cosines and quaternions: two digits of σ of the orientation about an axis, and one more, as these
/// figures have to make a rotation together.
fn rotation_decimals(solution: &Solution) -> usize {
    let known = solution.uncertainty.as_ref();
    let std_rad = known.map(|known| (known.rotation_covariance().trace().max(0.0) / 3.0).sqrt());
    std_rad.map_or(ROTATION_DECIMALS, |std_rad| (decimals_for(Some(std_rad)) + 1).clamp(3, ROTATION_DECIMALS))
}

pub(in crate::report::document) fn blocks(evidence: &Evidence) -> Vec<Block> {
    let Some((target, solution)) = evidence.answer() else { return Vec::new() };
    let convention = target.session.robot.notation.convention;
    let is_camera = solution.motion.is_some();
    let sensor_frame = if is_camera { words::CAMERA_FRAME } else { words::SENSOR_FRAME };
    let mut blocks = vec![
        Block::Paragraph(words::meaning(solution.mount).to_owned()),
        Block::Paragraph(sensor_frame.to_owned()),
        Block::Table(matrix(solution)),
        Block::Table(quaternion(solution)),
        Block::Table(six_numbers(&target.session, solution)),
        Block::Paragraph(words::convention_in_words(convention)),
        Block::Paragraph(words::DIGITS.to_owned()),
    ];
    let rotation = solution.flange_from_sensor.rotation();
    let known = solution.uncertainty.as_ref();
    let remark = known.and_then(|known| not_known_apart(convention, &rotation, &known.rotation_covariance()));
    blocks.extend(remark.map(|remark| Block::Facts(vec![Fact::new(words::REMARKS, remark)])));
    blocks
}

fn matrix(solution: &Solution) -> Table {
    let matrix = solution.flange_from_sensor.matrix();
    let std_mm = solution.uncertainty.as_ref().map(|known| known.translation_std_mm);
    let rotation_decimals = rotation_decimals(solution);
    let names = ["x", "y", "z"];
    let rotation = names.map(|name| Column::number(name, None, format!("r_{name}")).under(words::ROTATION_PART));
    let translation = Column::number("t", Some("mm"), "t_mm").under(words::TRANSLATION_PART);
    let row = |row: usize| {
        let cell = |column: usize| match (row, column) {
            // The last row is exact.
            (3, _) => Cell::number(matrix[(row, column)], 0),
            (_, 3) => Cell::number(matrix[(row, column)], decimals_for(std_mm.map(|std| std[row]))),
            _ => Cell::number(matrix[(row, column)], rotation_decimals),
        };
        (0..4).map(cell).collect()
    };
    Table {
        id: "matrix".to_owned(),
        title: words::matrix_title(solution.mount),
        columns: rotation.into_iter().chain([translation]).collect(),
        rows: (0..4).map(row).collect(),
        note: None,
    }
}

fn quaternion(solution: &Solution) -> Table {
    let quaternion = solution.flange_from_sensor.quaternion_wxyz();
    let decimals = rotation_decimals(solution);
    Table {
        id: "quaternion".to_owned(),
        title: words::QUATERNION_TITLE.to_owned(),
        columns: ["w", "x", "y", "z"].map(|name| Column::number(name, None, format!("q_{name}"))).to_vec(),
        rows: vec![quaternion.map(|part| Cell::number(part, decimals)).to_vec()],
        note: None,
    }
}

/// x y z and the three angles, each with its σ, in the robot's own convention and unit.
fn six_numbers(session: &Session, solution: &Solution) -> Table {
    let convention = session.robot.notation.convention;
    let rotation = solution.flange_from_sensor.rotation();
    let known = solution.uncertainty.as_ref();
    let (unit, per_degree) = match convention.usual_angle_unit {
        AngleUnit::Degrees => ("°", 1.0),
        AngleUnit::Radians => ("rad", 1.0_f64.to_radians()),
    };
    let translation = solution.flange_from_sensor.translation_mm();
    let angles_std_deg = known.map(|known| convention.angles_std_deg(&rotation, &known.rotation_covariance()));
    let lengths = (0..3).map(|axis| {
        (["x", "y", "z"][axis], translation[axis], known.map(|known| known.translation_std_mm[axis]), "mm")
    });
    let angles = convention.angles_deg_from_rotation(&rotation).into_iter().enumerate().map(|(idx, angle_deg)| {
        let std = angles_std_deg.map(|std_deg| std_deg[idx] * per_degree);
        (convention.angle_names[idx], angle_deg * per_degree, std, unit)
    });
    let row = |(name, value, std, unit): (&str, f64, Option<f64>, &str)| {
        let decimals = decimals_for(std);
        vec![Cell::words(name), Cell::number(value, decimals), Cell::maybe(std, decimals), Cell::words(unit)]
    };
    Table {
        id: "six-numbers".to_owned(),
        title: words::six_numbers_title(convention.label),
        columns: vec![
            Column::words(words::QUANTITY, "quantity"),
            Column::number(words::VALUE, None, "value"),
            Column::number(words::STD, None, "std"),
            Column::words(words::UNIT, "unit"),
        ],
        rows: lengths.chain(angles).map(row).collect(),
        note: None,
    }
}
