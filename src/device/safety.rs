//! Which motion is allowed. Pure: checked before anything is sent.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Where the flange may be, in the base, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkspaceBox {
    /// The least corner.
    pub min_mm: [f64; 3],
    /// The greatest corner.
    pub max_mm: [f64; 3],
}

/// What the robot may be asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionLimits {
    /// Where the flange may be; `None`: anywhere within reach of one move of the pose at arming.
    pub workspace: Option<WorkspaceBox>,
    /// Greatest speed of the flange, mm/s.
    pub max_speed_mm_s: f64,
    /// Greatest speed of its turning, degrees a second.
    pub max_rotation_speed_deg_s: f64,
    /// Longest single move, mm.
    pub max_move_mm: f64,
    /// Greatest single turn, degrees.
    pub max_turn_deg: f64,
    /// Speed on the way to a station, mm/s.
    pub transit_speed_mm_s: f64,
    /// Speed of the steps of a search, mm/s.
    pub search_speed_mm_s: f64,
}

impl Default for MotionLimits {
    fn default() -> Self {
        Self {
            workspace: None,
            max_speed_mm_s: 100.0,
            max_rotation_speed_deg_s: 30.0,
            max_move_mm: 400.0,
            max_turn_deg: 100.0,
            transit_speed_mm_s: 50.0,
            search_speed_mm_s: 10.0,
        }
    }
}

/// Why a motion is not sent.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MotionRefusal {
    /// The arm switch is off.
    #[error("motion is not armed; switch it on once nobody is in reach of the robot")]
    NotArmed,
    /// A target outside the box.
    #[error(
        "the target is at {axis} = {found_mm:.1} mm, needed {min_mm:.1} to {max_mm:.1} mm; widen the workspace box or choose another pose"
    )]
    OutsideWorkspace {
        /// x, y or z.
        axis: char,
        /// Where the target is, mm.
        found_mm: f64,
        /// The least, mm.
        min_mm: f64,
        /// The greatest, mm.
        max_mm: f64,
    },
    /// Too far in one move.
    #[error(
        "the move is {found_mm:.1} mm long, allowed are {max_mm:.1} mm; jog the robot nearer or allow longer moves"
    )]
    TooFar {
        /// Its length, mm.
        found_mm: f64,
        /// The most, mm.
        max_mm: f64,
    },
    /// Too great a turn in one move.
    #[error(
        "the move turns the flange by {found_deg:.1}°, allowed are {max_deg:.1}°; jog the robot nearer or allow greater turns"
    )]
    TurnsTooFar {
        /// The turn, degrees.
        found_deg: f64,
        /// The most, degrees.
        max_deg: f64,
    },
    /// Too fast.
    #[error("the move is to run at {found_mm_s:.1} mm/s, allowed are {max_mm_s:.1} mm/s")]
    TooFast {
        /// Its speed, mm/s.
        found_mm_s: f64,
        /// The most, mm/s.
        max_mm_s: f64,
    },
}
