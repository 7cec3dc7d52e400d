//! The session's own fields as text, and typed text back to an edit.

use crate::calibrate::Mount;
use crate::geometry::{Transform, Vec3};
use crate::session::table::parse_number;
use crate::session::{Edit, Known, Session, SetupField, Target};
use crate::text::digits::plain;
use crate::text::start as words;

/// A field that is typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Field {
    /// The session's name.
    Name,
    /// The notes.
    Notes,
    /// Make and type of the robot.
    RobotModel,
    /// Noise of positions.
    PositionStd,
    /// Noise of orientations.
    OrientationStd,
    /// Make and type of the profiler.
    SensorModel,
    /// Noise of profile points.
    ProfileStd,
    /// The distance for which accuracy is stated.
    ReferenceDistance,
    /// The ball's radius.
    BallRadius,
    /// How well it is known.
    BallRadiusStd,
    /// Noise of the seen place of a board.
    TargetTranslationStd,
    /// Noise of its seen orientation.
    TargetRotationStd,
    /// Where the tip was touched, three numbers.
    TouchedPoint,
    /// The angle between a workpiece's planes, from its certificate.
    NominalAngle,
    /// The distance of its teeth.
    NominalPitch,
    /// Their height.
    NominalHeight,
    /// The diameter of its cylinder or ball.
    NominalDiameter,
    /// Roughly how the sensor is mounted, six numbers in the session's convention.
    RoughMounting,
}

impl Field {
    /// Its label.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Name => words::NAME,
            Self::Notes => words::NOTES,
            Self::RobotModel => words::ROBOT,
            Self::PositionStd => words::POSITION_STD,
            Self::OrientationStd => words::ORIENTATION_STD,
            Self::SensorModel => words::SENSOR,
            Self::ProfileStd => words::PROFILE_STD,
            Self::ReferenceDistance => words::REFERENCE_DISTANCE,
            Self::BallRadius => words::BALL_RADIUS,
            Self::BallRadiusStd => words::BALL_RADIUS_STD,
            Self::TargetTranslationStd => words::TARGET_TRANSLATION_STD,
            Self::TargetRotationStd => words::TARGET_ROTATION_STD,
            Self::TouchedPoint => words::TOUCHED_POINT,
            Self::NominalAngle => words::NOMINAL_ANGLE,
            Self::NominalPitch => words::NOMINAL_PITCH,
            Self::NominalHeight => words::NOMINAL_HEIGHT,
            Self::NominalDiameter => words::NOMINAL_DIAMETER,
            Self::RoughMounting => words::ROUGH_MOUNTING,
        }
    }

    /// Its unit, for a number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Name | Self::Notes | Self::RobotModel | Self::SensorModel => "",
            Self::OrientationStd | Self::TargetRotationStd | Self::NominalAngle => "°",
            Self::RoughMounting => "mm °",
            Self::PositionStd
            | Self::ProfileStd
            | Self::ReferenceDistance
            | Self::BallRadius
            | Self::BallRadiusStd
            | Self::TargetTranslationStd
            | Self::TouchedPoint
            | Self::NominalPitch
            | Self::NominalHeight
            | Self::NominalDiameter => "mm",
        }
    }

    /// Whether several numbers stand in it, with blanks between them.
    #[must_use]
    pub const fn has_several_numbers(self) -> bool {
        matches!(self, Self::TouchedPoint | Self::RoughMounting)
    }

    /// What a target of this kind has of its own.
    #[must_use]
    pub const fn of_target(target: &Target) -> &'static [Self] {
        match target {
            Target::Ball { .. } => &[Self::BallRadius, Self::BallRadiusStd],
            Target::Point => &[Self::TouchedPoint],
            Target::Workpiece => &[Self::NominalAngle, Self::NominalPitch, Self::NominalHeight, Self::NominalDiameter],
            Target::Pose { .. } => &[Self::TargetTranslationStd, Self::TargetRotationStd],
            Target::RightAnglePlate | Target::Rgbd { .. } => &[],
        }
    }

    /// Whether it says something only where a target is seen in profiles. A camera has none, and its methods need no start.
    #[must_use]
    pub const fn is_of_a_profiler(self) -> bool {
        matches!(self, Self::ProfileStd | Self::RoughMounting)
    }

    /// Whether any text will do, so that it can be taken over while it is typed.
    #[must_use]
    pub const fn is_text(self) -> bool {
        matches!(self, Self::Name | Self::Notes | Self::RobotModel | Self::SensorModel)
    }

    /// What stands in the empty field.
    #[must_use]
    pub const fn hint(self) -> &'static str {
        match self {
            Self::Name => words::NO_NAME,
            Self::Notes => words::NOTES_HINT,
            Self::BallRadiusStd => words::EXACT,
            Self::TargetTranslationStd | Self::TargetRotationStd => words::FOUND_FROM_DATA,
            Self::TouchedPoint => words::TOUCHED_POINT_HINT,
            Self::RoughMounting => words::ROUGH_MOUNTING_HINT,
            _ => words::NOT_STATED,
        }
    }

    /// The field as it stands in the document.
    #[must_use]
    pub fn text(self, session: &Session) -> String {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let (radius_mm, radius_std_mm) = match session.target {
            Target::Ball { radius_mm, radius_std_mm } => (Some(radius_mm), radius_std_mm),
            _ => (None, None),
        };
        let (translation_std_mm, rotation_std_deg) = match session.target {
            Target::Pose { translation_std_mm, rotation_std_deg } => (translation_std_mm, rotation_std_deg),
            _ => (None, None),
        };
        match self {
            Self::Name => session.name.clone(),
            Self::Notes => session.notes.clone(),
            Self::RobotModel => session.robot.model.clone(),
            Self::SensorModel => session.sensor.model.clone(),
            Self::PositionStd => number(session.robot.position_std_mm),
            Self::OrientationStd => number(session.robot.orientation_std_deg),
            Self::ProfileStd => number(session.sensor.profile_std_mm),
            Self::ReferenceDistance => number(session.sensor.reference_distance_mm),
            Self::BallRadius => number(radius_mm),
            Self::BallRadiusStd => number(radius_std_mm),
            Self::TargetTranslationStd => number(translation_std_mm),
            Self::TargetRotationStd => number(rotation_std_deg),
            Self::TouchedPoint => {
                session.known.point_in_base_mm.map_or_else(String::new, |point| listed(point.as_slice()))
            }
            Self::NominalAngle => number(session.known.angle_deg),
            Self::NominalPitch => number(session.known.pitch_mm),
            Self::NominalHeight => number(session.known.height_mm),
            Self::NominalDiameter => number(session.known.diameter_mm),
            Self::RoughMounting => session.sensor.rough_flange_from_sensor.map_or_else(String::new, |rough| {
                let angles = session.robot.notation.convention.angles_deg_from_rotation(&rough.rotation());
                listed(&[rough.translation_mm().as_slice(), &angles].concat())
            }),
        }
    }

    /// What typing this text changes.
    ///
    /// # Errors
    /// Why the text cannot stand here, in a sentence.
    pub fn edit(self, text: &str, session: &Session) -> Result<Edit, String> {
        let number = || parse_number(text).map_err(|refusal| refusal.to_string());
        let optional = || if text.trim().is_empty() { Ok(None) } else { number().map(Some) };
        let ball = |change: &dyn Fn(&mut f64, &mut Option<f64>)| {
            let mut target = session.target.clone();
            if let Target::Ball { radius_mm, radius_std_mm } = &mut target {
                change(radius_mm, radius_std_mm);
            }
            SetupField::Target(target)
        };
        let board = |change: &dyn Fn(&mut Option<f64>, &mut Option<f64>)| {
            let mut target = session.target.clone();
            if let Target::Pose { translation_std_mm, rotation_std_deg } = &mut target {
                change(translation_std_mm, rotation_std_deg);
            }
            SetupField::Target(target)
        };
        let known = |change: &dyn Fn(&mut Known)| {
            let mut known = session.known;
            change(&mut known);
            Edit::SetKnown(known)
        };
        let field = match self {
            Self::TouchedPoint => {
                let point_mm = numbers::<3>(text)?.map(Vec3::from);
                return checked(known(&|known| known.point_in_base_mm = point_mm), session);
            }
            Self::RoughMounting => {
                let rough = numbers::<6>(text)?.map(|[x, y, z, a, b, c]| {
                    let rotation = session.robot.notation.convention.rotation_from_angles_deg([a, b, c]);
                    Transform::from_parts(Vec3::new(x, y, z), rotation)
                });
                return checked(Edit::SetRoughMounting(rough), session);
            }
            Self::NominalAngle | Self::NominalPitch | Self::NominalHeight | Self::NominalDiameter => {
                let typed = optional()?;
                let edit = known(&|known| match self {
                    Self::NominalAngle => known.angle_deg = typed,
                    Self::NominalPitch => known.pitch_mm = typed,
                    Self::NominalHeight => known.height_mm = typed,
                    _ => known.diameter_mm = typed,
                });
                return checked(edit, session);
            }
            Self::Name => SetupField::Name(text.to_owned()),
            Self::Notes => SetupField::Notes(text.to_owned()),
            Self::RobotModel => SetupField::RobotModel(text.to_owned()),
            Self::SensorModel => SetupField::SensorModel(text.to_owned()),
            Self::PositionStd => SetupField::PositionStdMm(optional()?),
            Self::OrientationStd => SetupField::OrientationStdDeg(optional()?),
            Self::ProfileStd => SetupField::ProfileStdMm(optional()?),
            Self::ReferenceDistance => SetupField::ReferenceDistanceMm(optional()?),
            Self::BallRadius => {
                let typed_mm = number()?;
                ball(&|radius_mm, _| *radius_mm = typed_mm)
            }
            Self::BallRadiusStd => {
                let typed_mm = optional()?;
                ball(&|_, radius_std_mm| *radius_std_mm = typed_mm)
            }
            Self::TargetTranslationStd => {
                let typed_mm = optional()?;
                board(&|translation_std_mm, _| *translation_std_mm = typed_mm)
            }
            Self::TargetRotationStd => {
                let typed_deg = optional()?;
                board(&|_, rotation_std_deg| *rotation_std_deg = typed_deg)
            }
        };
        checked(Edit::Setup(field), session)
    }
}

/// The edit, if it can be made.
fn checked(edit: Edit, session: &Session) -> Result<Edit, String> {
    edit.apply(session).map_err(|refusal| refusal.to_string())?;
    Ok(edit)
}

/// Numbers with blanks between them, as they are typed back.
fn listed(numbers: &[f64]) -> String {
    /// A touched point and a rough mounting are known less well.
    const DECIMALS: usize = 4;
    numbers.iter().map(|number| plain(*number, DECIMALS)).collect::<Vec<_>>().join("  ")
}

/// So many numbers with blanks or semicolons between them, or none at all.
fn numbers<const N: usize>(text: &str) -> Result<Option<[f64; N]>, String> {
    let parts: Vec<&str> =
        text.split(|c: char| c.is_whitespace() || c == ';').filter(|part| !part.is_empty()).collect();
    if parts.is_empty() {
        return Ok(None);
    }
    let numbers = parts.iter().map(|part| parse_number(part)).collect::<Result<Vec<f64>, _>>();
    let numbers = numbers.map_err(|refusal| refusal.to_string())?;
    numbers.try_into().map(Some).map_err(|_| words::numbers_missing(parts.len(), N))
}

/// A kind of target to choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetKind {
    /// A ball.
    Ball,
    /// Two perpendicular edges.
    Plate,
    /// A tip or pin.
    Point,
    /// A marker or board whose whole pose a camera sees.
    Board,
}

impl TargetKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Ball, Self::Plate, Self::Point, Self::Board];

    /// That of a target; `None` for scanned parts and a camera's sequence, which cannot be chosen.
    #[must_use]
    pub const fn of(target: &Target) -> Option<Self> {
        match target {
            Target::Ball { .. } => Some(Self::Ball),
            Target::RightAnglePlate => Some(Self::Plate),
            Target::Point => Some(Self::Point),
            Target::Pose { .. } => Some(Self::Board),
            Target::Workpiece | Target::Rgbd { .. } => None,
        }
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ball => words::BALL,
            Self::Plate => words::PLATE,
            Self::Point => words::POINT,
            Self::Board => words::BOARD,
        }
    }

    /// How it is measured.
    #[must_use]
    pub const fn hint(self) -> &'static str {
        match self {
            Self::Ball => words::BALL_HINT,
            Self::Plate => words::PLATE_HINT,
            Self::Point => words::POINT_HINT,
            Self::Board => words::BOARD_HINT,
        }
    }

    /// A target of this kind, with the usual ball.
    #[must_use]
    pub const fn target(self) -> Target {
        match self {
            Self::Ball => Target::ball(USUAL_RADIUS_MM),
            Self::Plate => Target::RightAnglePlate,
            Self::Point => Target::Point,
            Self::Board => Target::pose(),
        }
    }
}

/// The ball that the papers use.
pub const USUAL_RADIUS_MM: f64 = 15.0;

/// Where the sensor may be.
pub const MOUNTS: [Mount; 2] = [Mount::OnFlange, Mount::Fixed];

#[cfg(test)]
mod tests {
    use super::*;

    fn session() -> Session {
        Session::new(Target::Ball { radius_mm: 15.0, radius_std_mm: Some(0.01) })
    }

    #[test]
    fn what_is_shown_is_taken_back_unchanged() {
        let mut session = session();
        session.robot.position_std_mm = Some(0.02);
        session.notes = "two\nlines".to_owned();
        for field in [
            Field::Name,
            Field::Notes,
            Field::RobotModel,
            Field::PositionStd,
            Field::OrientationStd,
            Field::SensorModel,
            Field::ProfileStd,
            Field::ReferenceDistance,
            Field::BallRadius,
            Field::BallRadiusStd,
            Field::RoughMounting,
        ] {
            let edit = field.edit(&field.text(&session), &session).expect("valid");
            assert_eq!(edit.apply(&session).as_ref(), Ok(&session), "{field:?}");
        }
    }

    #[test]
    fn what_is_known_of_a_target_and_the_rough_mounting_are_typed_and_taken_back() {
        let of = Session::new;
        for (mut session, field, text, shown) in [
            (of(Target::Point), Field::TouchedPoint, "452,02 -118; 96.5", "452.02  -118  96.5"),
            (of(Target::Point), Field::TouchedPoint, " ", ""),
            (of(Target::Workpiece), Field::NominalAngle, "90", "90"),
            (of(Target::Workpiece), Field::NominalPitch, "15", "15"),
            (of(Target::Workpiece), Field::NominalHeight, "10,5", "10.5"),
            (of(Target::Workpiece), Field::NominalDiameter, "", ""),
            (of(Target::pose()), Field::TargetTranslationStd, "0,2", "0.2"),
            (of(Target::pose()), Field::TargetRotationStd, "0.1", "0.1"),
            (of(Target::pose()), Field::TargetRotationStd, "", ""),
            (of(Target::RightAnglePlate), Field::RoughMounting, "10 0 120 1 -2 90", "10  0  120  1  -2  90"),
            (of(Target::RightAnglePlate), Field::RoughMounting, "", ""),
        ] {
            let edit = field.edit(text, &session).expect("valid");
            session = edit.apply(&session).expect("valid");
            assert_eq!(field.text(&session), shown, "{field:?}");
        }
        for (target, field, text, expected) in [
            (Target::Point, Field::TouchedPoint, "1 2", "found 2 numbers, needed 3"),
            (Target::Point, Field::TouchedPoint, "1 2 x", "found"),
            (Target::Point, Field::TouchedPoint, "1 2 1e9", "found 1000000000, needed a position in mm"),
            (Target::Workpiece, Field::NominalPitch, "-3", "found -3, needed a part's size in mm"),
            (Target::Workpiece, Field::NominalAngle, "NaN", "found"),
            (Target::pose(), Field::TargetTranslationStd, "-0.1", "needed"),
            (Target::RightAnglePlate, Field::RoughMounting, "1 2 3 4 5", "found 5 numbers, needed 6"),
        ] {
            let refusal = field.edit(text, &of(target)).expect_err(text);
            assert!(refusal.contains(expected), "{refusal}");
        }
    }

    #[test]
    fn numbers_are_read_with_either_decimal_sign_and_refused_with_a_reason() {
        let session = session();
        for (field, text, expected) in [
            (
                Field::BallRadius,
                "12,7",
                Some(SetupField::Target(Target::Ball { radius_mm: 12.7, radius_std_mm: Some(0.01) })),
            ),
            (Field::BallRadiusStd, " ", Some(SetupField::Target(Target::ball(15.0)))),
            (Field::PositionStd, "0.02", Some(SetupField::PositionStdMm(Some(0.02)))),
            (Field::PositionStd, "", Some(SetupField::PositionStdMm(None))),
            (Field::BallRadius, "", None),
            (Field::BallRadius, "0", None),
            (Field::OrientationStd, "91", None),
            (Field::ProfileStd, "-0.1", None),
            (Field::ReferenceDistance, "far", None),
        ] {
            let edit = field.edit(text, &session);
            assert_eq!(edit.as_ref().ok(), expected.map(Edit::Setup).as_ref(), "{field:?} {text}");
            if let Err(reason) = edit {
                assert!(reason.contains("found") && reason.contains("needed"), "{reason}");
            }
        }
    }
}
