//! Names of columns, in the many spellings of spreadsheets, teach pendants and other programs.

use crate::geometry::PoseConvention;
use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::sheet::unit::{angle_unit, length_unit, name_and_unit};

use super::Role;

/// What a header says beside the meaning of each column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Said {
    pub length_unit: Option<LengthUnit>,
    /// Of the reduced points; millimetres if nothing is said.
    pub point_unit: Option<LengthUnit>,
    pub angle_unit: Option<AngleUnit>,
    pub orientation: Option<OrientationForm>,
    pub convention: Option<&'static PoseConvention>,
    /// Of the target's pose, where it is written in another form than the robot's.
    pub target: TargetSaid,
}

/// What a header says of the target's pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TargetSaid {
    pub length_unit: Option<LengthUnit>,
    pub orientation: Option<OrientationForm>,
}

/// The meaning of a name, before it is known what stands beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    Position(usize),
    Point(usize),
    /// A part of a quaternion: 0 is the real one.
    Quaternion(usize),
    /// `q1`: the real part where the four are `q1` to `q4`.
    Numbered(usize),
    /// An angle, by its name in one of [`ANGLES`].
    Angle {
        family: usize,
        idx: usize,
    },
    Other(Role),
}

/// Angles that are named together, and the makers that name them so, the usual one first.
const ANGLES: [(&[[&str; 3]], &[&str]); 9] = [
    (&[["w", "p", "r"]], &["fanuc-wpr"]),
    (&[["a", "b", "c"]], &["kuka-abc", "mitsubishi-abc"]),
    (
        &[["rx", "ry", "rz"], ["rotx", "roty", "rotz"], ["rotationx", "rotationy", "rotationz"]],
        &["yaskawa-rxryrz", "ur-rotvec", "staubli-rxryrz", "denso-rxryrz"],
    ),
    (&[["rvx", "rvy", "rvz"], ["rotvecx", "rotvecy", "rotvecz"], ["rotvec1", "rotvec2", "rotvec3"]], &["ur-rotvec"]),
    (&[["o", "a", "t"]], &["kawasaki-oat"]),
    (&[["a", "e", "r"]], &["comau-aer"]),
    (&[["u", "v", "w"]], &["epson-uvw"]),
    (&[["ez", "ey", "ex"]], &["abb-ezeyex"]),
    (&[["roll", "pitch", "yaw"], ["r", "p", "y"]], &["fanuc-wpr", "yaskawa-rxryrz", "mitsubishi-abc", "denso-rxryrz"]),
];

const AXES: [&str; 3] = ["x", "y", "z"];

/// All meanings that a name can have; the columns beside it decide.
fn words(name: &str) -> Vec<Word> {
    let mut words = Vec::new();
    let numbered = |prefix: &str| {
        name.strip_prefix(prefix)
            .and_then(|digit| digit.parse::<usize>().ok())
            .filter(|_| name.len() == prefix.len() + 1)
    };
    for (idx, axis) in AXES.iter().enumerate() {
        let is_one_of =
            |prefixes: &[&str]| prefixes.iter().any(|p| name == format!("{p}{axis}") || name == format!("{axis}{p}"));
        if is_one_of(&["", "t", "pos", "position", "trans", "translation", "coord", "base", "位置"]) {
            words.push(Word::Position(idx));
        }
        if is_one_of(&["s", "p", "point", "sensor", "ball", "meas", "measured", "centre", "center"]) {
            words.push(Word::Point(idx));
        }
        if is_one_of(&["q", "quat", "quaternion", "orientation", "rot", "ori", "o"]) {
            words.push(Word::Quaternion(idx + 1));
        }
    }
    if ["w", "qw", "quatw", "quaternionw", "orientationw", "rotw", "oriw", "ow"].contains(&name) {
        words.push(Word::Quaternion(0));
    }
    if let Some(idx) = numbered("t").filter(|idx| (1..=3).contains(idx)) {
        words.push(Word::Position(idx - 1));
    }
    if let Some(idx) = numbered("q").or_else(|| numbered("quat")).filter(|idx| *idx <= 4) {
        words.push(Word::Numbered(idx));
    }
    for (family, (spellings, _)) in ANGLES.iter().enumerate() {
        for idx in 0..3 {
            if spellings.iter().any(|names| names[idx] == name) {
                words.push(Word::Angle { family, idx });
            }
        }
    }
    let other = match name {
        "label" | "name" | "no" | "nr" | "num" | "number" | "id" | "station" | "point" | "index" | "idx" | "#"
        | "序号" | "编号" | "名称" | "pose" | "posename" => Some(Role::Label),
        "side" => Some(Role::Side),
        "edge" => Some(Role::Edge),
        "use" | "used" | "enabled" | "enable" | "active" => Some(Role::Used),
        "step" => Some(Role::Step),
        "notation" => Some(Role::Notation),
        "profile" | "file" | "filename" | "scan" | "profilefile" => Some(Role::Profile),
        _ => None,
    };
    words.extend(other.map(Word::Other));
    words
}

/// What stands before the names of a target's pose.
const TARGETS: [&str; 6] = ["target", "object", "marker", "board", "tag", "sensor_from_target"];

/// A column's name without the target's in front of it; `None` of a column of something else.
fn of_target(cell: &str) -> Option<&str> {
    let cell = cell.trim();
    TARGETS.iter().find_map(|target| {
        let rest = cell.get(target.len()..).filter(|_| cell[..target.len()].eq_ignore_ascii_case(target))?;
        rest.strip_prefix(['_', ' ', '.', '-'])
    })
}

/// The roles of the columns that a header names, and what else it says; `None` for the cells that it does not explain. A
/// target's pose is named as the robot's, with the target in front: `target_x`, `marker.qw`.
///
/// `convention` and `written` are as in [`roles_of_robot`].
pub(super) fn roles(
    cells: &[&str],
    convention: &'static PoseConvention,
    written: Option<&'static PoseConvention>,
) -> (Vec<Option<Role>>, Said) {
    let targets: Vec<&str> = cells.iter().map(|cell| of_target(cell).unwrap_or("")).collect();
    if targets.iter().all(|cell| cell.is_empty()) {
        return roles_of_robot(cells, convention, written);
    }
    let others: Vec<&str> = cells.iter().map(|cell| if of_target(cell).is_some() { "" } else { cell }).collect();
    let (mut roles, mut said) = roles_of_robot(&others, convention, written);
    let (of_target, said_of_target) = roles_of_robot(&targets, convention, None);
    for (role, of_target) in roles.iter_mut().zip(of_target) {
        match of_target {
            Some(Role::Position(idx)) => *role = Some(Role::Target(idx)),
            Some(Role::Orientation(idx)) => *role = Some(Role::Target(3 + idx)),
            _ => {}
        }
    }
    said.target = TargetSaid { length_unit: said_of_target.length_unit, orientation: said_of_target.orientation };
    (roles, said)
}

/// The roles of the columns that a header names, and what else it says; `None` for the cells that it does not explain.
///
/// `convention` settles what several makers name alike; where the table itself says that its angles are of a maker, `written`,
/// they are the columns with that maker's names, in that order.
fn roles_of_robot(
    cells: &[&str],
    convention: &'static PoseConvention,
    written: Option<&'static PoseConvention>,
) -> (Vec<Option<Role>>, Said) {
    let named: Vec<(Vec<Word>, Option<String>)> = cells
        .iter()
        .map(|cell| {
            let (name, unit) = name_and_unit(cell);
            (words(&name), unit)
        })
        .collect();
    let mut roles: Vec<Option<Role>> = vec![None; cells.len()];
    let mut said = Said::default();
    let find = |roles: &[Option<Role>], wanted: Word| {
        (0..named.len()).find(|column| roles[*column].is_none() && named[*column].0.contains(&wanted))
    };
    // A block is taken as a whole or not at all; the first that fits wins.
    let take = |roles: &mut Vec<Option<Role>>, block: &[(Word, Role)]| -> Option<Vec<usize>> {
        let mut taken = roles.clone();
        let mut columns = Vec::new();
        for (word, role) in block {
            let column = find(&taken, *word)?;
            taken[column] = Some(*role);
            columns.push(column);
        }
        *roles = taken;
        Some(columns)
    };
    let position = [0, 1, 2].map(|idx| (Word::Position(idx), Role::Position(idx)));
    let point = [0, 1, 2].map(|idx| (Word::Point(idx), Role::Point(idx)));
    let positions = take(&mut roles, &position).or_else(|| {
        // Without any other, "px py pz" are the position.
        let as_position = [0, 1, 2].map(|idx| (Word::Point(idx), Role::Position(idx)));
        take(&mut roles, &as_position)
    });
    let quaternion =
        |first: usize, word: fn(usize) -> Word| [0, 1, 2, 3].map(|idx| (word(first + idx), Role::Orientation(idx)));
    let quaternions = [quaternion(0, Word::Quaternion), quaternion(0, Word::Numbered), quaternion(1, Word::Numbered)];
    let mut angles = None;
    if let Some(written) = written {
        let names = written.angle_names.map(|name| name_and_unit(name).0);
        let is_named =
            |column: &usize, name: &String| roles[*column].is_none() && name_and_unit(cells[*column]).0 == *name;
        let columns: Option<Vec<usize>> =
            names.iter().map(|name| (0..cells.len()).find(|column| is_named(column, name))).collect();
        for (idx, column) in columns.iter().flatten().enumerate() {
            roles[*column] = Some(Role::Orientation(idx));
        }
        said.orientation = columns.as_ref().map(|_| OrientationForm::Angles);
        said.convention = Some(written);
        angles = columns;
    } else if let Some(columns) = quaternions.iter().find_map(|block| take(&mut roles, block)) {
        let is_real_part_last = columns[0] > columns[3];
        said.orientation =
            Some(if is_real_part_last { OrientationForm::QuaternionXyzw } else { OrientationForm::QuaternionWxyz });
        if is_real_part_last {
            for (idx, column) in [3, 0, 1, 2].into_iter().zip(columns) {
                roles[column] = Some(Role::Orientation(idx));
            }
        }
    } else {
        for (family, (_, ids)) in ANGLES.iter().enumerate() {
            let block = [0, 1, 2].map(|idx| (Word::Angle { family, idx }, Role::Orientation(idx)));
            if let Some(columns) = take(&mut roles, &block) {
                said.orientation = Some(OrientationForm::Angles);
                said.convention =
                    if ids.contains(&convention.id) { Some(convention) } else { PoseConvention::by_id(ids[0]) };
                angles = Some(columns);
                break;
            }
        }
    }
    let points = take(&mut roles, &point).or_else(|| take(&mut roles, &[point[0], point[2]]));
    for (column, (words, _)) in named.iter().enumerate() {
        if roles[column].is_none()
            && let Some(Word::Other(role)) = words.iter().find(|word| matches!(word, Word::Other(_)))
            && !roles.contains(&Some(*role))
        {
            roles[column] = Some(*role);
        }
    }
    let unit_of = |columns: &Option<Vec<usize>>| {
        columns.as_ref().and_then(|columns| columns.iter().find_map(|column| named[*column].1.as_deref()))
    };
    said.length_unit = unit_of(&positions).and_then(length_unit);
    said.point_unit = unit_of(&points).and_then(length_unit);
    said.angle_unit = unit_of(&angles).and_then(angle_unit);
    (roles, said)
}

/// The units of a second row of a header.
pub(super) fn units(cells: &[&str], roles: &[Option<Role>], said: &mut Said) {
    for (cell, role) in cells.iter().zip(roles) {
        let unit = cell.trim().trim_matches(['[', ']', '(', ')']).to_lowercase();
        match role {
            Some(Role::Position(_)) => said.length_unit = said.length_unit.or_else(|| length_unit(&unit)),
            Some(Role::Point(_)) => said.point_unit = said.point_unit.or_else(|| length_unit(&unit)),
            Some(Role::Target(0..3)) => {
                said.target.length_unit = said.target.length_unit.or_else(|| length_unit(&unit));
            }
            Some(Role::Orientation(_)) => said.angle_unit = said.angle_unit.or_else(|| angle_unit(&unit)),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(header: &str, expected: &str, said: &str) {
        let cells: Vec<&str> = header.split(',').collect();
        let (roles, found) = roles(&cells, PoseConvention::default_convention(), None);
        let letters: String = roles
            .iter()
            .map(|role| match role {
                None => "?".to_owned(),
                Some(Role::Ignore) => "-".to_owned(),
                Some(Role::Label) => "L".to_owned(),
                Some(Role::Position(idx)) => format!("t{idx}"),
                Some(Role::Orientation(idx)) => format!("o{idx}"),
                Some(Role::Point(idx)) => format!("p{idx}"),
                Some(Role::Target(idx)) => format!("T{idx}"),
                Some(Role::Side) => "S".to_owned(),
                Some(Role::Edge) => "E".to_owned(),
                Some(Role::Used) => "U".to_owned(),
                Some(Role::Step) => "T".to_owned(),
                Some(Role::Profile) => "F".to_owned(),
                Some(Role::Notation) => "N".to_owned(),
            })
            .collect();
        let words = format!(
            "{} {} {} {}",
            found.length_unit.map_or("?", LengthUnit::symbol),
            found.angle_unit.map_or("?", AngleUnit::symbol),
            match found.orientation {
                None => "?",
                Some(OrientationForm::Angles) => "angles",
                Some(OrientationForm::QuaternionWxyz) => "wxyz",
                Some(OrientationForm::QuaternionXyzw) => "xyzw",
            },
            found.convention.map_or("?", |convention| convention.id)
        );
        assert_eq!((letters.as_str(), words.as_str()), (expected, said), "{header}");
    }

    #[test]
    fn columns_are_known_in_many_spellings() {
        check("x,y,z,rx,ry,rz", "t0t1t2o0o1o2", "? ? angles yaskawa-rxryrz");
        check("No.,X [mm],Y [mm],Z [mm],W [deg],P [deg],R [deg]", "Lt0t1t2o0o1o2", "mm ° angles fanuc-wpr");
        check("x/m,y/m,z/m,qx,qy,qz,qw", "t0t1t2o0o1o2o3", "m ? xyzw ?");
        check("x_m,y_m,z_m,qw,qx,qy,qz", "t0t1t2o0o1o2o3", "m ? wxyz ?");
        check("# timestamp,tx,ty,tz,qx,qy,qz,qw", "?t0t1t2o0o1o2o3", "? ? xyzw ?");
        check("q0,q1,q2,q3,t1,t2,t3,x_s,y_s,z_s", "o0o1o2o3t0t1t2p0p1p2", "? ? wxyz ?");
        check("name,x,y,z,q1,q2,q3,q4", "Lt0t1t2o0o1o2o3", "? ? wxyz ?");
        check("X,Y,Z,A (°),B,C,use,side", "t0t1t2o0o1o2US", "? ° angles kuka-abc");
        check("pos_x,pos_y,pos_z,roll (rad),pitch (rad),yaw (rad)", "t0t1t2o0o1o2", "? rad angles fanuc-wpr");
        check("x,y,z,yaw,pitch,roll", "t0t1t2o2o1o0", "? ? angles fanuc-wpr");
        check("label,edge,x,y,z,w,p,r", "LEt0t1t2o0o1o2", "? ? angles fanuc-wpr");
        check("x,y,z,w,p,r,px,py,pz,file", "t0t1t2o0o1o2p0p1p2F", "? ? angles fanuc-wpr");
        check("px,py,pz,qw,qx,qy,qz", "t0t1t2o0o1o2o3", "? ? wxyz ?");
        check(
            "position.x,position.y,position.z,orientation.x,orientation.y,orientation.z,orientation.w",
            "t0t1t2o0o1o2o3",
            "? ? xyzw ?",
        );
        check(
            "label,capture,side,enabled,step_mm,x_mm,y_mm,z_mm,W_deg,P_deg,R_deg,notation",
            "L?SUTt0t1t2o0o1o2N",
            "mm ° angles fanuc-wpr",
        );
        check(
            "x,y,z,qw,qx,qy,qz,target_x,target_y,target_z,target_qx,target_qy,target_qz,target_qw",
            "t0t1t2o0o1o2o3T0T1T2T3T4T5T6",
            "? ? wxyz ?",
        );
        check(
            "No,X,Y,Z,W,P,R,marker x [m],marker y,marker z,marker W,marker P,marker R",
            "Lt0t1t2o0o1o2T0T1T2T3T4T5",
            "? ? angles fanuc-wpr",
        );
        check("x,z", "??", "? ? ? ?");
    }
}
