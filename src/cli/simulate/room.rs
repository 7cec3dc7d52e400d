//! `handeye simulate --target room`: a recording of an RGB-D camera in a simulated room, beside its session file.

use std::ops::Range;
use std::path::PathBuf;

use crate::cli::progress::watched;
use crate::session::{Session, save};
use crate::simulate::room::{CameraNoise, Carrier, RoomFault, RoomOptions, RoomRecording, kinect, write_folder};

use super::{MountArg, SimulateArgs, SimulateRefusal, named, within};

/// Something that goes wrong from one frame to another, both included.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultArg(RoomFault, Range<usize>);

/// Arguments of `handeye simulate --target room`.
#[derive(Clone, Debug, PartialEq, clap::Args)]
#[command(next_help_heading = "Options of --target room")]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct RoomArgs {
    /// Number of frames; 120 if not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Frames a second; 30 if not given.
    #[arg(long, value_name = "HZ", value_parser = frames_per_s)]
    pub frames_per_s: Option<f64>,
    /// Size of the images; 640x480 if not given.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Carry the camera on a robot's flange, whose poses are written as well; otherwise a vehicle does.
    #[arg(long)]
    pub on_robot: bool,
    /// Carry the camera by hand.
    #[arg(long, conflicts_with = "on_robot")]
    pub hand_held: bool,
    /// Stand still every now and then.
    #[arg(long)]
    pub stops: bool,
    /// Cameras without noise, rounding or holes.
    #[arg(long)]
    pub perfect_cameras: bool,
    /// Noise of a colour in the dark, levels of 255, in the light in proportion; 1 if not given.
    #[arg(long, value_name = "LEVELS", value_parser = color_std, conflicts_with = "perfect_cameras")]
    pub color_std: Option<f64>,
    /// How long the shutter is open: smears the images of a moving camera. 0 if not given.
    #[arg(long, value_name = "MS", value_parser = exposure)]
    pub exposure_ms: Option<f64>,
    /// How far the robot's clock is ahead of the camera's; 0 if not given.
    #[arg(long, value_name = "MS", value_parser = clock_ahead, requires = "on_robot")]
    pub robot_clock_ahead_ms: Option<f64>,
    /// What goes wrong in which frames, counted from 0, such as dark:20-29: dark, blank-wall, blank-depth, jump, frozen; may be
    /// given several times.
    #[arg(long, value_name = "NAME:FROM-TO", value_parser = fault)]
    pub frame_fault: Vec<FaultArg>,
}

impl RoomArgs {
    /// The first option that is given.
    pub(super) fn first_given(&self) -> Option<&'static str> {
        [
            ("--frames", self.frames.is_some()),
            ("--frames-per-s", self.frames_per_s.is_some()),
            ("--size", self.size.is_some()),
            ("--on-robot", self.on_robot),
            ("--hand-held", self.hand_held),
            ("--stops", self.stops),
            ("--perfect-cameras", self.perfect_cameras),
            ("--color-std", self.color_std.is_some()),
            ("--exposure-ms", self.exposure_ms.is_some()),
            ("--frame-fault", !self.frame_fault.is_empty()),
        ]
        .into_iter()
        .find_map(|(option, is_given)| is_given.then_some(option))
    }
}

/// Writes the folder of images, and then the session that names it.
///
/// # Errors
/// In one line.
pub(super) fn write(args: &SimulateArgs) -> Result<(), String> {
    let recording = recording(args).map_err(|refusal| refusal.to_string())?;
    let session = session(args, &recording);
    let folder = args.out.with_file_name(sequence(args));
    watched("rendering frame", |progress| write_folder(recording, &folder, progress))?;
    save(&session, &args.out).map_err(|error| error.to_string())
}

/// The session of a recording.
pub(super) fn session(args: &SimulateArgs, recording: &RoomRecording) -> Session {
    named(recording.session(&sequence(args).to_string_lossy()), args)
}

/// The folder's name, beside the session file.
fn sequence(args: &SimulateArgs) -> PathBuf {
    let mut name = args.out.file_stem().unwrap_or_default().to_owned();
    name.push("-sequence");
    name.into()
}

/// What the arguments ask for.
///
/// # Errors
/// [`SimulateRefusal::NoEffect`] for what belongs to other targets.
pub(super) fn recording(args: &SimulateArgs) -> Result<RoomRecording, SimulateRefusal> {
    refuse_without_effect(args)?;
    let room = &args.room;
    let usual = RoomOptions::default();
    let [width, height] = room.size.unwrap_or([640, 480]);
    Ok(RoomRecording::new(RoomOptions {
        seed: args.seed,
        num_frames: room.frames.map_or(usual.num_frames, |frames| frames as usize),
        frames_per_s: room.frames_per_s.unwrap_or(usual.frames_per_s),
        camera: kinect(width, height),
        carrier: match (room.on_robot, room.hand_held) {
            (true, _) => Carrier::Robot,
            (false, true) => Carrier::Hand,
            (false, false) => Carrier::Vehicle,
        },
        has_stops: room.stops,
        noise: if room.perfect_cameras {
            CameraNoise::NONE
        } else {
            room.color_std.map_or(CameraNoise::KINECT, |std| CameraNoise::KINECT.with_color_std(std))
        },
        exposure_s: room.exposure_ms.unwrap_or_default() / 1000.0,
        position_std_mm: args.position_std_mm,
        orientation_std_deg: args.orientation_std_deg,
        robot_clock_ahead_s: room.robot_clock_ahead_ms.unwrap_or_default() / 1000.0,
        faults: room.frame_fault.iter().map(|FaultArg(fault, frames)| (*fault, frames.clone())).collect(),
    }))
}

/// What is asked for and belongs to other targets is a mistake somewhere else.
fn refuse_without_effect(args: &SimulateArgs) -> Result<(), SimulateRefusal> {
    let of_pose = args.pose.first_given();
    let (of_workpiece, of_ball, of_stations) = ("--target workpiece", "--target ball", "a target with stations");
    [
        ("--part", args.part.is_some(), of_workpiece),
        ("--further", !args.further.is_empty(), of_stations),
        ("--stations", args.stations.is_some(), of_stations),
        ("--steps", args.steps.is_some(), of_stations),
        ("--points", args.points.is_some(), of_stations),
        ("--radius-mm", args.radius_mm.is_some(), of_ball),
        ("--reduced", args.reduced, "--target plate or point"),
        ("--rough-mounting", args.rough_mounting.is_some(), of_stations),
        ("--step-mm", args.step_mm.is_some(), of_stations),
        ("--section-offset-mm", args.section_offset_mm.is_some(), of_ball),
        ("--tilt-deg", args.tilt_deg.is_some(), of_stations),
        ("--spin-deg", args.spin_deg.is_some(), of_stations),
        ("--travel-off-normal-deg", args.travel_off_normal_deg.is_some(), of_ball),
        ("--mount", args.mount != MountArg::OnFlange, of_stations),
        ("--z-towards-sensor", args.z_towards_sensor, of_stations),
        ("--dirty", !args.dirty.is_empty(), of_stations),
        ("--bad-pose", args.bad_pose.is_some(), of_stations),
        ("--fault", args.fault.is_some(), of_ball),
        ("--decimals", args.decimals.is_some(), of_stations),
        (of_pose.unwrap_or_default(), of_pose.is_some(), "--target pose"),
    ]
    .into_iter()
    .find(|(_, is_given, _)| *is_given)
    .map_or(Ok(()), |(option, _, expected)| {
        Err(SimulateRefusal::NoEffect { option, found: args.target.as_argument(), expected })
    })
}

fn size(text: &str) -> Result<[u32; 2], String> {
    const LIMITS: Range<u32> = 32..2049;
    let side = |text: &str| text.parse().ok().filter(|side| LIMITS.contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| "expected a width and a height of 32 to 2048 pixels, such as 320x240".to_owned())
}

fn fault(text: &str) -> Result<FaultArg, String> {
    let read = || {
        let (name, frames) = text.split_once(':')?;
        let (first, last) = frames.split_once('-').unwrap_or((frames, frames));
        let [first, last] = [first, last].map(|number| number.parse().ok().filter(|number| *number < 100_000_usize));
        let frames = first?..last? + 1;
        Some(FaultArg(RoomFault::by_id(name)?, frames)).filter(|FaultArg(_, frames)| !frames.is_empty())
    };
    read().ok_or_else(|| {
        let names = RoomFault::ALL.map(RoomFault::id).join(", ");
        format!("expected one of {names}, and frames, such as dark:20-29")
    })
}

fn frames_per_s(text: &str) -> Result<f64, String> {
    within(text, [0.1, 1000.0])
}

fn color_std(text: &str) -> Result<f64, String> {
    within(text, [0.0, 50.0])
}

fn exposure(text: &str) -> Result<f64, String> {
    within(text, [0.0, 1000.0])
}

fn clock_ahead(text: &str) -> Result<f64, String> {
    within(text, [-10_000.0, 10_000.0])
}
