//! `handeye simulate --target pose`: a camera that sees the whole pose of a board.

use crate::calibrate::Mount;
use crate::session::Session;
use crate::simulate::poses::{PoseOptions, simulate_poses};

use super::{MountArg, SimulateArgs, SimulateRefusal, length_std, named, orientation_std};

/// Arguments of `handeye simulate --target pose`.
#[derive(Clone, Debug, PartialEq, clap::Args)]
#[command(next_help_heading = "Options of --target pose")]
pub struct PoseArgs {
    /// Noise of each coordinate of the target's origin in the camera, mm; 0.2 if not given.
    #[arg(long, value_name = "MM", value_parser = length_std)]
    pub target_std_mm: Option<f64>,
    /// Noise of the target's orientation about each axis, degrees; 0.1 if not given.
    #[arg(long, value_name = "DEG", value_parser = orientation_std)]
    pub target_std_deg: Option<f64>,
}

impl PoseArgs {
    /// The first option that is given.
    pub(super) fn first_given(&self) -> Option<&'static str> {
        [("--target-std-mm", self.target_std_mm), ("--target-std-deg", self.target_std_deg)]
            .into_iter()
            .find_map(|(option, given)| given.map(|_| option))
    }
}

/// The session that the arguments ask for.
///
/// # Errors
/// [`SimulateRefusal`] for what belongs to other targets, or a station that there is not.
pub(super) fn session(args: &SimulateArgs) -> Result<Session, SimulateRefusal> {
    refuse_without_effect(args)?;
    let usual = PoseOptions::default();
    let num_stations = args.stations.map_or(usual.num_stations, usize::from);
    if let Some(found) = args.bad_pose.filter(|number| usize::from(*number) > num_stations) {
        return Err(SimulateRefusal::NoSuchStation { found, num_stations });
    }
    let options = PoseOptions {
        seed: args.seed,
        num_stations,
        tilt_deg: args.tilt_deg.unwrap_or(usual.tilt_deg),
        spin_deg: args.spin_deg.unwrap_or(usual.spin_deg),
        position_std_mm: args.position_std_mm,
        orientation_std_deg: args.orientation_std_deg,
        target_std_mm: args.pose.target_std_mm.unwrap_or(usual.target_std_mm),
        target_std_deg: args.pose.target_std_deg.unwrap_or(usual.target_std_deg),
        mount: match args.mount {
            MountArg::OnFlange => Mount::OnFlange,
            MountArg::Fixed => Mount::Fixed,
        },
        bad_pose_station: args.bad_pose.map(|number| usize::from(number) - 1),
        decimals: args.decimals,
    };
    Ok(named(simulate_poses(&options), args))
}

/// What is asked for and belongs to other targets is a mistake somewhere else.
fn refuse_without_effect(args: &SimulateArgs) -> Result<(), SimulateRefusal> {
    let of_profiles = "a target that profiles are taken of";
    let of_room = args.room.first_given();
    [
        ("--part", args.part.is_some(), "--target workpiece"),
        ("--further", !args.further.is_empty(), of_profiles),
        ("--steps", args.steps.is_some(), of_profiles),
        ("--points", args.points.is_some(), of_profiles),
        ("--radius-mm", args.radius_mm.is_some(), "--target ball"),
        ("--reduced", args.reduced, "--target plate or point"),
        ("--rough-mounting", args.rough_mounting.is_some(), of_profiles),
        ("--step-mm", args.step_mm.is_some(), of_profiles),
        ("--section-offset-mm", args.section_offset_mm.is_some(), "--target ball"),
        ("--travel-off-normal-deg", args.travel_off_normal_deg.is_some(), "--target ball"),
        ("--z-towards-sensor", args.z_towards_sensor, of_profiles),
        ("--dirty", !args.dirty.is_empty(), of_profiles),
        ("--fault", args.fault.is_some(), "--target ball"),
        (of_room.unwrap_or_default(), of_room.is_some(), "--target room"),
    ]
    .into_iter()
    .find(|(_, is_given, _)| *is_given)
    .map_or(Ok(()), |(option, _, expected)| {
        Err(SimulateRefusal::NoEffect { option, found: args.target.as_argument(), expected })
    })
}
