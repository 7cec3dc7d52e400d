//! YAML and JSON: lists of points, poses as maps, lists of numbers or matrices, in whatever structure they stand.

mod flow;
mod poses;
mod tree;

use std::borrow::Cow;
use std::sync::Arc;

use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{PoseNotation, Profile};
use crate::session::Reading;
use crate::watch::Cancelled;

use self::poses::{Found, find};
use super::gather::{Gathered, RawPose};
use super::profiles::NamedProfile;
use super::program::{head, show};
use super::read::Progress;
use super::{ImportOptions, Preview, Source};

/// What a file holds.
pub(super) struct Document {
    found: Found,
    problem: Option<tree::Problem>,
}

/// Whether a text is YAML or JSON: by the ending of its name, or by how it begins.
pub(super) fn is_yaml(name: &str, text: &str) -> bool {
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_lowercase());
    if matches!(ending.as_deref(), Some("yaml" | "yml" | "json")) {
        return true;
    }
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    first.is_some_and(|line| {
        let key = line.split_once(':').map(|(key, _)| key);
        let is_key = key.is_some_and(|key| {
            !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'))
        });
        line.starts_with(['{', '[']) || line == "---" || line.starts_with("- ") || is_key
    })
}

/// Looks for poses and profiles; `None` if there are neither and nothing is wrong.
pub(super) fn document(text: &str) -> Option<Document> {
    let (roots, problem) = tree::parse(text);
    let mut found = Found::default();
    for root in &roots {
        find(root, &mut found);
    }
    let document = Document { found, problem };
    (!document.is_empty() || document.problem.is_some()).then_some(document)
}

impl Document {
    /// Whether nothing was found in it.
    pub const fn is_empty(&self) -> bool {
        self.found.poses.is_empty() && self.found.profiles.is_empty()
    }

    pub const fn has_poses(&self) -> bool {
        !self.found.poses.is_empty()
    }

    /// How the poses are written: as the first of them says, else by the size of the numbers, else as the fallback has it.
    pub fn notation(&self, fallback: &PoseNotation) -> PoseNotation {
        /// As for tables.
        const LARGEST_METRES: f64 = 5.0;
        let Some(first) = self.found.poses.first() else { return *fallback };
        let largest = |part: std::ops::Range<usize>| {
            let numbers = self.found.poses.iter().flat_map(|pose| pose.numbers.get(part.clone()).unwrap_or_default());
            numbers.fold(0.0_f64, |largest, number| largest.max(number.abs()))
        };
        let is_in_metres = (f64::MIN_POSITIVE..=LARGEST_METRES).contains(&largest(0..3));
        let is_in_rad = (f64::MIN_POSITIVE..=std::f64::consts::TAU + 1e-3).contains(&largest(3..6));
        let said = &first.said;
        let orientation = said.orientation.unwrap_or(if first.numbers.len() == 7 {
            OrientationForm::QuaternionWxyz
        } else {
            OrientationForm::Angles
        });
        PoseNotation {
            convention: said.convention.unwrap_or(fallback.convention),
            orientation,
            angle_unit: said.angle_unit.unwrap_or(if orientation == OrientationForm::Angles && is_in_rad {
                AngleUnit::Radians
            } else {
                AngleUnit::Degrees
            }),
            length_unit: said.length_unit.unwrap_or(if is_in_metres {
                LengthUnit::Metres
            } else {
                LengthUnit::Millimetres
            }),
            ..*fallback
        }
    }

    /// Takes the poses, with the profiles that stand beside them, and gives the profiles that stand alone.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn read(
        self,
        source: &Source,
        options: &ImportOptions,
        gathered: &mut Gathered,
        preview: &mut Preview,
        progress: &mut Progress<'_>,
    ) -> Result<Vec<NamedProfile>, Cancelled> {
        if let Some(problem) = &self.problem {
            gathered.problem(&source.name, problem.at, &problem.found, problem.expected);
        }
        let unit = options.profile_length_unit.unwrap_or(LengthUnit::Millimetres);
        let z_sign = if options.is_z_mirrored { -1.0 } else { 1.0 };
        let profile_of = |points: &poses::Points| {
            let x_mm: Vec<f64> = points.x.iter().map(|x| x * unit.in_mm()).collect();
            let z_mm: Vec<Option<f64>> =
                points.z.iter().map(|z| (!z.is_nan()).then_some(z * unit.in_mm() * z_sign)).collect();
            Profile::new(x_mm, &z_mm)
        };
        if self.has_poses() {
            head(preview, gathered.notation());
        }
        for pose in &self.found.poses {
            progress.tick()?;
            let num_before = gathered.num_poses();
            show(preview, pose.at.0, pose.label.as_deref().unwrap_or_default(), &pose.numbers);
            let raw = RawPose {
                at: pose.at,
                label: pose.label.as_deref().map(Cow::Borrowed),
                numbers: &pose.numbers,
                point_in_sensor: pose.point_in_sensor,
                may_continue: true,
                ..RawPose::default()
            };
            gathered.take(&source.name, &raw);
            if let Some(points) = pose.points.as_ref().filter(|_| gathered.num_poses() > num_before) {
                match profile_of(points) {
                    Ok(profile) => gathered.set_last_reading(Reading::Profile(Arc::new(profile))),
                    Err(error) => {
                        gathered.problem(&source.name, points.at, &error.to_string(), "the points of a profile");
                    }
                }
            }
        }
        let mut profiles = Vec::with_capacity(self.found.profiles.len());
        let is_only = self.found.profiles.len() == 1;
        for (idx, points) in self.found.profiles.iter().enumerate() {
            progress.tick()?;
            let name = match &points.name {
                _ if is_only => source.name.clone(),
                Some(name) => format!("{}/{name}", source.name),
                None => format!("{}/{}", source.name, idx + 1),
            };
            match profile_of(points) {
                Ok(profile) => profiles.push(NamedProfile { name, profile }),
                Err(error) => {
                    gathered.problem(&source.name, points.at, &error.to_string(), "the points of a profile");
                }
            }
        }
        Ok(profiles)
    }
}
