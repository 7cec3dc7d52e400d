//! Poses and profiles in a tree: known by their keys, or by the length of lists of numbers.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

use crate::geometry::notation::{LengthUnit, OrientationForm};
use crate::geometry::{PoseConvention, Vec3};
use crate::session::import::Role;
use crate::session::import::header::{self, Said};

use super::tree::{Item, Node};

/// A matrix further from a rotation is none.
const MATRIX_TOLERANCE: f64 = 1e-3;

/// Points of a profile, z NaN where there is none.
#[derive(Debug)]
pub(super) struct Points {
    pub at: (usize, usize),
    pub name: Option<String>,
    pub x: Vec<f64>,
    pub z: Vec<f64>,
}

/// A pose, its numbers as its keys say.
#[derive(Debug)]
pub(super) struct FoundPose {
    pub at: (usize, usize),
    pub label: Option<String>,
    pub numbers: Vec<f64>,
    pub said: Said,
    pub point_in_sensor: Option<Vec3>,
    pub points: Option<Points>,
}

/// All that was found, in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub poses: Vec<FoundPose>,
    pub profiles: Vec<Points>,
}

/// Letters and digits of a key, in lower case.
fn plain(key: &str) -> String {
    key.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).take(40).collect()
}

fn entry<'i>(entries: &'i [(Box<str>, Item)], names: &[&str]) -> Option<(&'i str, &'i Item)> {
    let found = entries.iter().find(|(key, _)| names.contains(&plain(key).as_str()));
    found.map(|(key, item)| (key.as_ref(), item))
}

/// Looks through a tree; its depth is limited.
pub(super) fn find(item: &Item, found: &mut Found) {
    visit(item, None, found);
}

fn visit(item: &Item, name: Option<&str>, found: &mut Found) {
    let numbers_pose = numbers_of_pose(item);
    match &item.node {
        _ if numbers_pose.is_some() => {
            let (numbers, said) = numbers_pose.unwrap_or_default();
            found.poses.push(FoundPose {
                at: item.at(),
                label: name.map(str::to_owned),
                numbers,
                said,
                point_in_sensor: None,
                points: None,
            });
        }
        Node::Map(entries) => {
            if let Some(pose) = pose(item, entries) {
                found.poses.push(FoundPose { label: pose.label.or_else(|| name.map(str::to_owned)), ..pose });
            } else if let Some(points) = points(item, name) {
                found.profiles.push(points);
            } else {
                for (key, value) in entries {
                    visit(value, Some(key), found);
                }
            }
        }
        Node::List(items) => match points(item, name) {
            Some(points) => found.profiles.push(points),
            None => items.iter().for_each(|item| visit(item, None, found)),
        },
        Node::Number(_) | Node::Text(_) | Node::Numbers(_) => {}
    }
}

/// A pose without keys: six or seven numbers, or a matrix of 4 × 4 or 3 × 4.
fn numbers_of_pose(item: &Item) -> Option<(Vec<f64>, Said)> {
    match &item.node {
        Node::Numbers(numbers) => match numbers.len() {
            6 | 7 if numbers.iter().all(|number| number.is_finite()) => Some((numbers.clone(), Said::default())),
            16 => matrix(numbers.chunks(4)),
            _ => None,
        },
        Node::List(rows) if matches!(rows.len(), 3 | 4) => {
            let rows: Vec<&[f64]> = rows
                .iter()
                .filter_map(|row| match &row.node {
                    Node::Numbers(numbers) if numbers.len() == 4 => Some(numbers.as_slice()),
                    _ => None,
                })
                .collect();
            (rows.len() >= 3).then(|| matrix(rows.into_iter()))?
        }
        _ => None,
    }
}

/// A rigid motion as position and quaternion, if the matrix is one.
fn matrix<'m>(rows: impl Iterator<Item = &'m [f64]>) -> Option<(Vec<f64>, Said)> {
    let rows: Vec<&[f64]> = rows.collect();
    if rows.get(3).is_some_and(|last| *last != [0.0, 0.0, 0.0, 1.0]) {
        return None;
    }
    let rotation = Matrix3::from_fn(|row, column| rows[row][column]);
    let is_rotation = (rotation.transpose() * rotation - Matrix3::identity()).amax() < MATRIX_TOLERANCE
        && rotation.determinant() > 0.0;
    if !is_rotation || rows.iter().any(|row| !row[3].is_finite()) {
        return None;
    }
    let quaternion = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    let numbers = vec![rows[0][3], rows[1][3], rows[2][3], quaternion.w, quaternion.i, quaternion.j, quaternion.k];
    Some((numbers, Said { orientation: Some(OrientationForm::QuaternionWxyz), ..Said::default() }))
}

/// A map with a pose in it, and what stands beside it.
fn pose(item: &Item, entries: &[(Box<str>, Item)]) -> Option<FoundPose> {
    let inner = entry(entries, &["pose", "transform", "basefromflange", "flange", "tcp", "matrix"]);
    let (numbers, said) = match inner.map(|(_, inner)| (inner, &inner.node)) {
        Some((inner, Node::Map(entries))) => nested(entries)
            .or_else(|| flat(entries))
            .or_else(|| Some((pose(inner, entries)?.numbers, Said::default())))?,
        Some((inner, _)) => numbers_of_pose(inner)?,
        None => nested(entries).or_else(|| flat(entries))?,
    };
    let label = entry(entries, &["label", "name", "id", "station", "no", "number", "index"]);
    let beside = entry(entries, &["points", "profile", "scan", "line"]);
    let point = entry(entries, &["point", "pointmm", "ballinsensor", "pointinsensor"]);
    Some(FoundPose {
        at: item.at(),
        label: label.and_then(|(_, label)| match &label.node {
            Node::Text(text) => Some(text.to_string()),
            Node::Number(number) if number.is_finite() => Some(number.to_string()),
            _ => None,
        }),
        numbers,
        said,
        point_in_sensor: point.and_then(|(_, point)| triple(point, ["x", "y", "z"])).map(Vec3::from),
        points: beside.and_then(|(_, beside)| points(beside, None)),
    })
}

/// Three numbers, as a list or by their names.
fn triple(item: &Item, names: [&str; 3]) -> Option<[f64; 3]> {
    match &item.node {
        Node::Numbers(numbers) => numbers.as_slice().try_into().ok(),
        Node::Map(entries) => {
            let mut values = [0.0; 3];
            for (value, name) in values.iter_mut().zip(names) {
                let Node::Number(number) = entry(entries, &[name])?.1.node else { return None };
                *value = number;
            }
            Some(values)
        }
        _ => None,
    }
    .filter(|values| values.iter().all(|value| value.is_finite()))
}

/// `translation` and `rotation`, under their many names.
fn nested(entries: &[(Box<str>, Item)]) -> Option<(Vec<f64>, Said)> {
    let positions =
        ["translation", "position", "t", "pos", "trans", "xyz", "translationmm", "positionmm", "translationm"];
    let (key, item) = entry(entries, &positions)?;
    let mut said = Said::default();
    if key.to_lowercase().ends_with("mm") {
        said.length_unit = Some(LengthUnit::Millimetres);
    }
    let mut numbers = triple(item, ["x", "y", "z"])?.to_vec();
    let rotations = [
        "rotation",
        "orientation",
        "quaternion",
        "quat",
        "q",
        "rot",
        "rpy",
        "euler",
        "angles",
        "rotvec",
        "rvec",
        "wpr",
        "abc",
        "quaternionwxyz",
        "quaternionxyzw",
        "rpydeg",
        "rpyrad",
        "eulerdeg",
    ];
    let (key, item) = entry(entries, &rotations)?;
    let key = plain(key);
    match &item.node {
        Node::Numbers(four) if four.len() == 4 => {
            numbers.extend(four);
            said.orientation = match key.as_str() {
                "quaternionwxyz" => Some(OrientationForm::QuaternionWxyz),
                "quaternionxyzw" => Some(OrientationForm::QuaternionXyzw),
                _ => None,
            };
        }
        Node::Numbers(three) if three.len() == 3 => {
            numbers.extend(three);
            said.orientation = Some(OrientationForm::Angles);
            let id = match key.as_str() {
                "rotvec" | "rvec" => Some("ur-rotvec"),
                "rpy" | "rpydeg" | "rpyrad" | "wpr" => Some("fanuc-wpr"),
                "abc" => Some("kuka-abc"),
                _ => None,
            };
            said.convention = id.and_then(PoseConvention::by_id);
            said.angle_unit = match key.as_str() {
                "rpydeg" | "eulerdeg" => Some(crate::geometry::notation::AngleUnit::Degrees),
                "rpyrad" => Some(crate::geometry::notation::AngleUnit::Radians),
                _ => None,
            };
        }
        Node::Map(parts) => {
            let (orientation, found) = flat_orientation(parts)?;
            numbers.extend(orientation);
            said.orientation = found.orientation;
            said.convention = found.convention;
            said.angle_unit = found.angle_unit;
        }
        _ => return None,
    }
    numbers.iter().all(|number| number.is_finite()).then_some((numbers, said))
}

/// The scalars of a map by the roles that a table's header would give its keys.
fn by_roles(entries: &[(Box<str>, Item)], before: &[&str]) -> (Vec<(Role, f64)>, Said) {
    let scalars: Vec<(&str, f64)> = entries
        .iter()
        .filter_map(|(key, item)| match item.node {
            Node::Number(number) => Some((key.as_ref(), number)),
            _ => None,
        })
        .collect();
    let names: Vec<&str> = before.iter().copied().chain(scalars.iter().map(|(key, _)| *key)).collect();
    let (roles, said) = header::roles(&names, PoseConvention::default_convention(), None);
    let values = scalars.iter().zip(roles.iter().skip(before.len()));
    (values.filter_map(|((_, number), role)| role.map(|role| (role, *number))).collect(), said)
}

fn orientation_of(values: &[(Role, f64)]) -> Option<Vec<f64>> {
    let at = |idx: usize| values.iter().find(|(role, _)| *role == Role::Orientation(idx)).map(|(_, number)| *number);
    let three = [at(0)?, at(1)?, at(2)?];
    Some(three.into_iter().chain(at(3)).collect())
}

/// `{x: 0, y: 0, z: 0, w: 1}` or `{roll: 0, pitch: 0, yaw: 90}` beside a position.
fn flat_orientation(entries: &[(Box<str>, Item)]) -> Option<(Vec<f64>, Said)> {
    if let Some((_, Item { node: Node::Number(w), .. })) = entry(entries, &["w", "qw"]) {
        let part = |names: &[&str]| match entry(entries, names)?.1.node {
            Node::Number(number) => Some(number),
            _ => None,
        };
        let xyz = [part(&["x", "qx"])?, part(&["y", "qy"])?, part(&["z", "qz"])?];
        let said = Said { orientation: Some(OrientationForm::QuaternionWxyz), ..Said::default() };
        return Some((vec![*w, xyz[0], xyz[1], xyz[2]], said));
    }
    let (values, said) = by_roles(entries, &["tx", "ty", "tz"]);
    Some((orientation_of(&values)?, said))
}

/// `{x: 1, y: 2, z: 3, rx: 4, ry: 5, rz: 6}`
fn flat(entries: &[(Box<str>, Item)]) -> Option<(Vec<f64>, Said)> {
    let (values, said) = by_roles(entries, &[]);
    let at = |idx: usize| values.iter().find(|(role, _)| *role == Role::Position(idx)).map(|(_, number)| *number);
    let mut numbers = vec![at(0)?, at(1)?, at(2)?];
    numbers.extend(orientation_of(&values)?);
    numbers.iter().all(|number| number.is_finite()).then_some((numbers, said))
}

fn is_of_point(key: &str) -> bool {
    matches!(plain(key).as_str(), "x" | "y" | "z" | "i" | "intensity")
}

/// Points: two lists `x` and `z`, or a list of pairs, triples or `{x: …, z: …}`.
fn points(item: &Item, name: Option<&str>) -> Option<Points> {
    let mut points = Points { at: item.at(), name: name.map(str::to_owned), x: Vec::new(), z: Vec::new() };
    match &item.node {
        Node::Map(entries) => {
            if let Some((key, inner)) = entry(entries, &["points", "profile", "scan", "data"]) {
                let name = name.unwrap_or(key);
                return self::points(inner, Some(name));
            }
            let list = |names: &[&str]| match &entry(entries, names)?.1.node {
                Node::Numbers(numbers) if !numbers.is_empty() => Some(numbers),
                _ => None,
            };
            points.x.clone_from(list(&["x", "xmm"])?);
            points.z.clone_from(list(&["z", "zmm"])?);
        }
        Node::List(items) => {
            points.x.reserve_exact(items.len());
            points.z.reserve_exact(items.len());
            for item in items {
                let (x, z) = match &item.node {
                    Node::Numbers(numbers) => match numbers.as_slice() {
                        [x, z] | [x, _, z] => (*x, *z),
                        _ => return None,
                    },
                    // With other keys it is a pose.
                    Node::Map(entries) if !entries.iter().all(|(key, _)| is_of_point(key)) => return None,
                    Node::Map(entries) => match (&entry(entries, &["x"])?.1.node, &entry(entries, &["z"])?.1.node) {
                        (Node::Number(x), Node::Number(z)) => (*x, *z),
                        _ => return None,
                    },
                    _ => return None,
                };
                points.x.push(x);
                points.z.push(z);
            }
        }
        _ => return None,
    }
    (!points.x.is_empty()).then_some(points)
}
