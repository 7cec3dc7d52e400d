//! One way to read the poses of a session, and what it makes of them.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::geometry::{AngleOrder, PoseConvention, Rigid, Transform, Vec3};
use crate::session::{Capture, Session, Station, WrittenAngles};

/// The numbers of an orientation in another order or unit.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleReading {
    /// How the numbers were read to get the rotations that the session has. Where a pose keeps its written numbers, these
    /// are used as they stand.
    pub from: AngleOrder,
    /// How they are to be read.
    pub to: AngleOrder,
    /// What their unit is.
    pub unit: AngleUnit,
    /// A rotation has two triples of numbers. At these stations (by index in the session) it is the second one that is read;
    /// empty where the numbers are known.
    pub second_at_station_idxs: Vec<usize>,
}

/// What the three numbers, taken for degrees, are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    #[default]
    Degrees,
    /// Radians.
    Radians,
    /// Degrees that were taken for radians and converted once more.
    DegreesConvertedTwice,
}

impl AngleUnit {
    /// Degrees a unit.
    #[must_use]
    pub fn factor(self) -> f64 {
        match self {
            Self::Degrees => 1.0,
            Self::Radians => 1.0_f64.to_degrees(),
            Self::DegreesConvertedTwice => 1.0_f64.to_radians(),
        }
    }
}

/// In which order the four numbers, taken for w x y z, stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuaternionOrder {
    /// x y z w: taken for w x y z as they stood.
    Xyzw,
    /// w x y z, but they had been put in order as if they were x y z w.
    WxyzReordered,
}

/// What becomes of the rotations.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum RotationReading {
    /// They stay.
    #[default]
    AsGiven,
    /// Their three numbers are read in another way.
    Angles(AngleReading),
    /// Their four numbers are read in another order.
    Quaternion(QuaternionOrder),
}

/// Which way round the poses are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inversion {
    /// As the session has it.
    #[default]
    AsGiven,
    /// What is given is `flange_from_base`.
    WholePose,
    /// The position is that of the flange in the base, the rotation the other way round.
    RotationAlone,
}

/// What the positions, taken for millimetres, are in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    #[default]
    Millimetres,
    /// Metres.
    Metres,
    /// Inches.
    Inches,
    /// Micrometres.
    Micrometres,
}

impl LengthUnit {
    /// All units.
    pub const ALL: [Self; 4] = [Self::Millimetres, Self::Metres, Self::Inches, Self::Micrometres];

    /// Millimetres a unit.
    #[must_use]
    pub const fn factor(self) -> f64 {
        match self {
            Self::Millimetres => 1.0,
            Self::Metres => 1000.0,
            Self::Inches => 25.4,
            Self::Micrometres => 1e-3,
        }
    }
}

/// One way to read the poses of a session; the default is as given. The numbers of an orientation are read first, then the
/// position is converted, then the pose is turned round.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseReading {
    /// What becomes of the rotations.
    pub rotation: RotationReading,
    /// Which way round the poses are.
    pub inversion: Inversion,
    /// What the positions are in.
    pub length_unit: LengthUnit,
}

impl PoseReading {
    /// Whether everything stays.
    #[must_use]
    pub fn is_as_given(&self) -> bool {
        *self == Self::default()
    }

    /// How many parts differ from the session as given.
    #[must_use]
    pub fn num_changes(&self) -> usize {
        let angles = match &self.rotation {
            RotationReading::AsGiven => 0,
            RotationReading::Quaternion(_) => 1,
            RotationReading::Angles(angles) => {
                usize::from(angles.to != angles.from) + usize::from(angles.unit != AngleUnit::Degrees)
            }
        };
        angles
            + usize::from(self.inversion != Inversion::AsGiven)
            + usize::from(self.length_unit != LengthUnit::Millimetres)
    }

    /// The order in which the angles are read, where that is what changes.
    #[must_use]
    pub fn angle_order(&self) -> Option<AngleOrder> {
        match &self.rotation {
            RotationReading::Angles(angles) => Some(angles.to),
            RotationReading::AsGiven | RotationReading::Quaternion(_) => None,
        }
    }

    /// The makers whose controllers write orientations in that order: they tie.
    #[must_use]
    pub fn makers(&self) -> Vec<&'static PoseConvention> {
        self.angle_order().map_or_else(Vec::new, |order| PoseConvention::of_order(order).collect())
    }

    /// The code of the fault that this reading mends. If several parts differ it is that of the part which says most about
    /// where the poses come from: the order of the numbers, then the unit of the angles, the inversion, the unit of length.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match &self.rotation {
            RotationReading::Angles(angles) if angles.to != angles.from => "pose-convention",
            RotationReading::Quaternion(_) => "quaternion-order",
            RotationReading::Angles(angles) if angles.unit != AngleUnit::Degrees => "angle-unit",
            _ if self.inversion != Inversion::AsGiven => "inverted-poses",
            _ if self.length_unit != LengthUnit::Millimetres => "position-unit",
            _ => "pose-convention",
        }
    }

    /// Reads the poses of a session in this way. Written angles stay where they still say what the rotation is. They are
    /// shown as before, but in an order that is found to be the true one, and the right way round.
    pub fn apply(&self, session: &mut Session) {
        let notation = &mut session.robot.notation;
        if let Some(order) = self.angle_order().filter(|order| *order != notation.convention.order) {
            let maker = PoseConvention::of_order(order).next();
            notation.convention = maker.unwrap_or_else(|| PoseConvention::neutral(order));
        }
        if self.inversion == Inversion::WholePose {
            // Numbers of the base in the flange that turn out to be those of the flange in the base.
            notation.is_inverse = false;
        }
        let convention = notation.convention;
        for (station_idx, station) in session.stations.iter_mut().enumerate() {
            let poses: Vec<Rigid> =
                (0..station.captures.len()).map(|idx| self.pose(station, station_idx, idx)).collect();
            for (capture, pose) in station.captures.iter_mut().zip(poses) {
                capture.base_from_flange = Transform::from_rigid(pose);
                capture.written_angles = self.written(capture.written_angles, convention);
            }
        }
    }

    fn written(&self, written: Option<WrittenAngles>, convention: &'static PoseConvention) -> Option<WrittenAngles> {
        if self.inversion != Inversion::AsGiven {
            return None;
        }
        match &self.rotation {
            RotationReading::AsGiven => written,
            RotationReading::Quaternion(_) => None,
            RotationReading::Angles(angles) => {
                let angles_deg = written?.angles_deg.map(|angle| angle * angles.unit.factor());
                Some(WrittenAngles { angles_deg, convention })
            }
        }
    }

    /// A capture's `base_from_flange` read in this way.
    pub(in crate::diagnose) fn pose(&self, station: &Station, station_idx: usize, capture_idx: usize) -> Rigid {
        let given = &station.captures[capture_idx].base_from_flange;
        let rotation = match &self.rotation {
            RotationReading::AsGiven => given.rotation(),
            RotationReading::Angles(angles) => {
                let takes_second = angles.second_at_station_idxs.contains(&station_idx);
                let numbers = numbers(station, capture_idx, angles.from, takes_second);
                angles.to.rotation_from_angles(numbers.map(|number| number * angles.unit.factor()))
            }
            RotationReading::Quaternion(order) => reordered(&given.rotation(), *order),
        };
        self.inversion.applied(given.translation_mm() * self.length_unit.factor(), rotation)
    }
}

impl Inversion {
    /// All ways round.
    pub const ALL: [Self; 3] = [Self::AsGiven, Self::WholePose, Self::RotationAlone];

    fn applied(self, translation_mm: Vec3, rotation: UnitQuaternion<f64>) -> Rigid {
        let pose = Rigid::from_parts(translation_mm.into(), rotation);
        match self {
            Self::AsGiven => pose,
            Self::WholePose => pose.inverse(),
            Self::RotationAlone => Rigid::from_parts(pose.translation, rotation.inverse()),
        }
    }
}

/// The numbers (rad) that a capture's rotation was made of: as written, or those that `from` gives. Along a sweep the
/// orientation hardly changes, so the numbers stay near those of the first capture.
pub(super) fn numbers(station: &Station, capture_idx: usize, from: AngleOrder, takes_second: bool) -> [f64; 3] {
    let known = |capture: &Capture| capture.written_angles.map(|written| written.angles_deg.map(f64::to_radians));
    let capture = &station.captures[capture_idx];
    if let Some(written) = known(capture) {
        return written;
    }
    let numbers = from.angles_from_rotation(&capture.base_from_flange.rotation());
    let second = from.second_angles(numbers);
    if capture_idx == 0 {
        return if takes_second { second } else { numbers };
    }
    let first = self::numbers(station, 0, from, takes_second);
    if apart(from, first, second) < apart(from, first, numbers) { second } else { numbers }
}

/// How far two triples are from each other; whole turns count for nothing but in a rotation vector.
pub(super) fn apart(order: AngleOrder, first: [f64; 3], second: [f64; 3]) -> f64 {
    let difference = |(a, b): (f64, f64)| match order {
        AngleOrder::RotationVector => (a - b) * (a - b),
        AngleOrder::Intrinsic(_) | AngleOrder::Extrinsic(_) => 2.0 - 2.0 * (a - b).cos(),
    };
    first.into_iter().zip(second).map(difference).sum()
}

fn reordered(rotation: &UnitQuaternion<f64>, order: QuaternionOrder) -> UnitQuaternion<f64> {
    let [first, second, third, fourth] = [rotation.w, rotation.i, rotation.j, rotation.k];
    UnitQuaternion::new_unchecked(match order {
        QuaternionOrder::Xyzw => Quaternion::new(fourth, first, second, third),
        QuaternionOrder::WxyzReordered => Quaternion::new(second, third, fourth, first),
    })
}
