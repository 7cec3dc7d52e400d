//! The coordinate frames, as types, so that a transform's type says what it maps.

use std::fmt::Debug;

/// A coordinate frame that a [`Transform`](super::Transform) maps from or to.
pub trait Frame: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// The frame's name as used in files and in the window.
    const NAME: &'static str;
}

/// The robot's base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Base;

/// The frame whose pose the controller reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flange;

/// The profiler: laser plane `y = 0`, `x` across the line, `z` along the range axis; or the colour camera: `x` right, `y`
/// down, `z` forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sensor;

/// The active tool point of the controller, where that is another frame than the flange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tcp;

/// The depth camera beside a colour camera: `x` right, `y` down, `z` forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DepthCamera;

/// Where a camera's poses are given in: the camera's first pose, or the frame of a ground truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct World;

/// A target whose whole pose is measured, such as a marker or a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target;

impl Frame for Base {
    const NAME: &'static str = "base";
}

impl Frame for Flange {
    const NAME: &'static str = "flange";
}

impl Frame for Sensor {
    const NAME: &'static str = "sensor";
}

impl Frame for Tcp {
    const NAME: &'static str = "tool point";
}

impl Frame for DepthCamera {
    const NAME: &'static str = "depth camera";
}

impl Frame for World {
    const NAME: &'static str = "world";
}

impl Frame for Target {
    const NAME: &'static str = "target";
}
