//! What the robot programs of all makers have in common: frames that poses are in, and how their poses are shown.

use std::collections::BTreeMap;

use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{Base, Flange, PoseConvention, PoseNotation, Tcp, Transform, Vec3};
use crate::sheet::text::excerpt;

use super::gather::Gathered;
use super::{Note, Preview, Role};

/// Rows of the preview.
pub(super) const MAX_PREVIEW_ROWS: usize = 50;

/// What a program says beside its poses, before any pose is converted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frames {
    /// The one tool that all poses are for, where the program says what it is.
    pub flange_from_tcp: Option<Transform<Flange, Tcp>>,
    /// The one frame that all poses are in, likewise.
    pub base_from_user: Option<Transform<Base, Base>>,
}

/// Tools and user frames that poses refer to and that are not known.
#[derive(Clone, Debug, Default)]
pub(super) struct Unknown {
    tools: BTreeMap<String, usize>,
    frames: BTreeMap<String, usize>,
    /// Those that are taken so whatever the user gave.
    undecided_tools: BTreeMap<&'static str, usize>,
    undecided_frames: BTreeMap<&'static str, usize>,
    num_joint_poses: usize,
    num_other_groups: usize,
}

impl Unknown {
    pub fn tool(&mut self, name: &str) {
        *self.tools.entry(name.to_owned()).or_default() += 1;
    }

    pub fn frame(&mut self, name: &str) {
        *self.frames.entry(name.to_owned()).or_default() += 1;
    }

    /// As [`Self::tool`], noted even where the user gave a tool for the others.
    pub fn tool_in_any_case(&mut self, name: &'static str) {
        *self.undecided_tools.entry(name).or_default() += 1;
    }

    /// As [`Self::frame`], likewise.
    pub fn frame_in_any_case(&mut self, name: &'static str) {
        *self.undecided_frames.entry(name).or_default() += 1;
    }

    pub const fn joint_pose(&mut self) {
        self.num_joint_poses += 1;
    }

    pub const fn other_group(&mut self) {
        self.num_other_groups += 1;
    }

    /// Notes what was taken for something else, frame by frame; those that the user gave are known.
    pub fn note(self, gathered: &mut Gathered) {
        let has_tool = gathered.notation().flange_from_tcp.is_some();
        let has_frame = gathered.has_user_frame();
        // One frame for several is a mixture even where it is known.
        if !has_frame || self.frames.len() > 1 {
            let frames = self.frames.into_iter();
            gathered.notes.extend(frames.map(|(frame, num_poses)| Note::UserFrameTakenAsBase { frame, num_poses }));
        }
        if !has_tool || self.tools.len() > 1 {
            let tools = self.tools.into_iter();
            gathered.notes.extend(tools.map(|(tool, num_poses)| Note::ToolTakenAsFlange { tool, num_poses }));
        }
        let frames = self.undecided_frames.into_iter().map(|(frame, num_poses)| (frame.to_owned(), num_poses));
        gathered.notes.extend(frames.map(|(frame, num_poses)| Note::UserFrameTakenAsBase { frame, num_poses }));
        let tools = self.undecided_tools.into_iter().map(|(tool, num_poses)| (tool.to_owned(), num_poses));
        gathered.notes.extend(tools.map(|(tool, num_poses)| Note::ToolTakenAsFlange { tool, num_poses }));
        if self.num_joint_poses > 0 {
            gathered.notes.push(Note::JointPoses { num_poses: self.num_joint_poses });
        }
        if self.num_other_groups > 0 {
            gathered.notes.push(Note::OtherGroups { num_poses: self.num_other_groups });
        }
    }
}

/// How a maker's programs write poses, with what the program and the fallback say of the tool.
pub(super) fn notation(
    convention_id: &str,
    orientation: OrientationForm,
    (angle_unit, length_unit): (AngleUnit, LengthUnit),
    frames: &Frames,
    fallback: &PoseNotation,
) -> PoseNotation {
    PoseNotation {
        convention: PoseConvention::by_id(convention_id).unwrap_or(fallback.convention),
        orientation,
        angle_unit,
        length_unit,
        flange_from_tcp: frames.flange_from_tcp.or(fallback.flange_from_tcp),
        is_inverse: false,
    }
}

/// A tool's frame from a position and a quaternion, the real part first.
pub(super) fn tool_frame(position_mm: [f64; 3], quaternion_wxyz: [f64; 4]) -> Option<Transform<Flange, Tcp>> {
    let notation = PoseNotation { orientation: OrientationForm::QuaternionWxyz, ..PoseNotation::default() };
    let numbers = [position_mm.as_slice(), quaternion_wxyz.as_slice()].concat();
    let frame = notation.base_from_flange(&numbers).ok()?;
    let is_flange = frame.translation_mm() == Vec3::zeros() && frame.rotation().angle() == 0.0;
    (!is_flange).then(|| Transform::from_rigid(*frame.rigid()))
}

/// Names the columns of a program's preview: the label, then the numbers of a pose.
pub(super) fn head(preview: &mut Preview, notation: &PoseNotation) {
    let numbers = ["x", "y", "z"].into_iter().chain(notation.orientation_names().iter().copied());
    preview.header = std::iter::once("name").chain(numbers).map(str::to_owned).collect();
    let num_orientation = notation.num_numbers() - 3;
    preview.roles = std::iter::once(Role::Label)
        .chain((0..3).map(Role::Position))
        .chain((0..num_orientation).map(Role::Orientation))
        .collect();
}

/// Adds a pose to a program's preview.
pub(super) fn show(preview: &mut Preview, line: usize, label: &str, numbers: &[f64]) {
    preview.num_rows += 1;
    if preview.rows.len() < MAX_PREVIEW_ROWS {
        let cells = std::iter::once(excerpt(label).into_owned());
        preview.rows.push((line, cells.chain(numbers.iter().map(f64::to_string)).collect()));
    }
}
