//! The calibration as text that a controller, a program or a person takes: each format with its convention in a comment, and
//! each text read back and compared.

mod field;
mod formats;
mod template;

#[cfg(test)]
mod tests;

use thiserror::Error;

use crate::calibrate::{Mount, Solution};
use crate::geometry::{Flange, PoseConvention, Sensor, Transform, Vec3};
use crate::text::tool_frame::heading;

pub use formats::formats;

use template::Numbers;

/// What is written.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolFrame {
    /// The calibration; `base_from_sensor` where the sensor stands beside the robot.
    pub flange_from_sensor: Transform<Flange, Sensor>,
    /// What it is fixed to.
    pub parent: Parent,
    /// Whether the sensor is a camera that sees whole poses, and no profiler.
    pub is_camera: bool,
    /// What it is called: letters, digits and underscores, beginning with a letter.
    pub name: Name,
    /// The number of the tool in the controller.
    pub number: u8,
    /// One standard deviation of the translation along the parent's axes, mm, and of the rotation about the sensor's, degrees.
    pub std_mm_deg: Option<[Vec3; 2]>,
}

impl ToolFrame {
    /// What a solution says, with what is known of its σ.
    #[must_use]
    pub fn of_solution(solution: &Solution, name: Name, number: u8) -> Self {
        let known = solution.uncertainty.as_ref();
        Self {
            flange_from_sensor: solution.flange_from_sensor,
            parent: Parent::of(solution.mount),
            is_camera: solution.motion.is_some(),
            name,
            number,
            std_mm_deg: known.map(|known| [known.translation_std_mm, known.rotation_std_rad.map(f64::to_degrees)]),
        }
    }
}

impl Parent {
    /// What a sensor so mounted is fixed to.
    #[must_use]
    pub const fn of(mount: Mount) -> Self {
        match mount {
            Mount::OnFlange => Self::Flange,
            Mount::Fixed => Self::Base,
        }
    }
}

/// What the sensor is fixed to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parent {
    /// It is carried: its frame is a tool frame.
    Flange,
    /// It stands in the cell: its frame is no tool.
    Base,
}

/// A name that every language takes: a letter, then letters, digits and underscores, no more than 16.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name(String);

impl Name {
    /// The nearest such name to any words.
    #[must_use]
    pub fn from_words(words: &str) -> Self {
        const LONGEST: usize = 16;
        let allowed = words.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' });
        let joined: String = allowed.collect();
        let parts = joined.split('_').filter(|part| !part.is_empty());
        let mut name = parts.collect::<Vec<_>>().join("_");
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            name = if name.is_empty() { "scanner".to_owned() } else { format!("s_{name}") };
        }
        name.truncate(LONGEST);
        Self(name)
    }

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// What a format is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Programs and data of robot controllers.
    Controller,
    /// Six numbers to be typed on a pendant.
    Pendant,
    /// ROS and its tools.
    Ros,
    /// Matrices and quaternions for programs of one's own.
    Program,
}

/// How comments are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comment {
    /// From here to the end of the line.
    Line(&'static str),
    /// Between these two, on lines of their own.
    Between(&'static str, &'static str),
    /// The format has none.
    None,
}

/// One way of writing a calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Format {
    /// Its name on the command line.
    pub id: &'static str,
    /// Its name in a list.
    pub label: &'static str,
    /// What it is for.
    pub group: Group,
    /// How its three angles are meant, where it has three.
    pub convention: Option<&'static PoseConvention>,
    /// Units of its numbers.
    pub units: &'static str,
    /// What to mind, where there is something.
    pub remark: Option<&'static str>,
    /// The ending of a file's name.
    pub extension: &'static str,
    /// Whether it can only say where a carried sensor is.
    needs_flange: bool,
    comment: Comment,
    template: &'static str,
}

/// Why a text is not of a format.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum NotThisFormat {
    /// Something else than the format has there.
    #[error("found “{found}” where the format has “{expected}”")]
    Literal {
        /// The text there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// No number.
    #[error("found “{found}” where the format has a number")]
    NoNumber {
        /// The text there.
        found: String,
    },
    /// The numbers are no pose.
    #[error("its numbers are no rotation")]
    NoRotation,
}

/// How far a text read back is from what was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundTrip {
    /// Between the two origins, mm.
    pub translation_mm: f64,
    /// Between the two orientations, degrees.
    pub rotation_deg: f64,
    /// What the printed digits allow, mm and degrees.
    pub allowed: [f64; 2],
}

impl RoundTrip {
    /// Whether nothing but rounding was lost.
    #[must_use]
    pub fn is_good(&self) -> bool {
        self.translation_mm <= self.allowed[0] && self.rotation_deg <= self.allowed[1]
    }
}

impl Format {
    /// The format of this name.
    #[must_use]
    pub fn by_id(id: &str) -> Option<Self> {
        formats().find(|format| format.id == id)
    }

    /// Whether it can say where a sensor is that is fixed to this.
    #[must_use]
    pub fn suits(&self, parent: Parent) -> bool {
        parent == Parent::Flange || !self.needs_flange
    }

    /// Whether it is for the controller, or the pendant, of the robots whose angles are written so.
    #[must_use]
    pub fn is_for_robots_of(&self, convention: &PoseConvention) -> bool {
        let maker = |id: &'static str| id.split('-').next();
        self.id == convention.id || (self.group == Group::Controller && maker(self.id) == maker(convention.id))
    }

    /// The text, its convention in a comment where the format has comments.
    #[must_use]
    pub fn write(&self, frame: &ToolFrame) -> String {
        let numbers = Numbers::of(&frame.flange_from_sensor, self.convention);
        let body = template::fill(self.template, &numbers, frame, self.convention);
        let mut text = String::new();
        let std = frame.std_mm_deg.map(|std| std.map(|std| std.amax()));
        let is_carried = frame.parent == Parent::Flange;
        for line in heading(is_carried, frame.is_camera, self.convention, self.units, self.remark, std) {
            match self.comment {
                Comment::Line(mark) => text.extend([mark, " ", &line, "\n"]),
                Comment::Between(open, close) => text.extend([open, " ", &line, " ", close, "\n"]),
                Comment::None => {}
            }
        }
        text.push_str(&body);
        text
    }

    /// Whether the text itself says its convention.
    #[must_use]
    pub fn has_comments(&self) -> bool {
        self.comment != Comment::None
    }

    /// Reads such a text, as a controller would: comments do not count, nor does white space.
    ///
    /// # Errors
    /// [`NotThisFormat`].
    pub fn read(&self, text: &str) -> Result<Transform<Flange, Sensor>, NotThisFormat> {
        let is_comment = |line: &&str| match self.comment {
            Comment::Line(mark) | Comment::Between(mark, _) => line.trim_start().starts_with(mark),
            Comment::None => false,
        };
        let body: String = text.lines().filter(|line| !is_comment(line)).flat_map(|line| [line, "\n"]).collect();
        template::read(self.template, &body, self.convention)?.pose(self.convention).ok_or(NotThisFormat::NoRotation)
    }

    /// Writes, reads back, and compares.
    ///
    /// # Errors
    /// [`NotThisFormat`] if what was written cannot be read: a bug.
    pub fn check(&self, frame: &ToolFrame) -> Result<RoundTrip, NotThisFormat> {
        let again = self.read(&self.write(frame))?;
        let off = frame.flange_from_sensor.inverse() * again;
        Ok(RoundTrip {
            translation_mm: (frame.flange_from_sensor.translation_mm() - again.translation_mm()).norm(),
            rotation_deg: off.rotation().angle().to_degrees(),
            allowed: template::resolution(self.template),
        })
    }
}
