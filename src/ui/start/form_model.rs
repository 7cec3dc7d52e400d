//! The session's own fields as text, and typed text back to an edit.

use crate::calibrate::Mount;
use crate::session::table::parse_number;
use crate::session::{Edit, Session, SetupField, Target};
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
        }
    }

    /// Its unit, for a number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Name | Self::Notes | Self::RobotModel | Self::SensorModel => "",
            Self::OrientationStd => "°",
            Self::PositionStd | Self::ProfileStd | Self::ReferenceDistance | Self::BallRadius | Self::BallRadiusStd => {
                "mm"
            }
        }
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
        let field = match self {
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
        };
        let edit = Edit::Setup(field);
        edit.apply(session).map_err(|refusal| refusal.to_string())?;
        Ok(edit)
    }
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
}

impl TargetKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Ball, Self::Plate, Self::Point];

    /// That of a target; `None` for a camera's sequence, which cannot be chosen.
    #[must_use]
    pub const fn of(target: &Target) -> Option<Self> {
        match target {
            Target::Ball { .. } => Some(Self::Ball),
            Target::RightAnglePlate => Some(Self::Plate),
            Target::Point => Some(Self::Point),
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
        }
    }

    /// A target of this kind, with the usual ball.
    #[must_use]
    pub const fn target(self) -> Target {
        match self {
            Self::Ball => Target::ball(USUAL_RADIUS_MM),
            Self::Plate => Target::RightAnglePlate,
            Self::Point => Target::Point,
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
        ] {
            let edit = field.edit(&field.text(&session), &session).expect("valid");
            assert_eq!(edit.apply(&session).as_ref(), Ok(&session), "{field:?}");
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
