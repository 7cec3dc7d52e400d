//! `handeye simulate`: writes a simulated session with its truth.

mod pose;
mod room;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::ValueEnum;
use thiserror::Error;

use crate::calibrate::Mount;
use crate::scene::PartKind;
use crate::session::{Session, save};
use crate::simulate::{Dirt, Fault, RoughMounting, SimulationOptions, SimulationTarget, simulate};

use super::{EXIT_WRONG_INPUT, fail};

pub use pose::PoseArgs;
pub use room::{FaultArg, RoomArgs};

/// What is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TargetArg {
    /// A ball of known radius.
    #[default]
    Ball,
    /// A right-angle plate.
    Plate,
    /// A tip or pin.
    Point,
    /// A part that is scanned to see what a calibration is worth; --part says which.
    Workpiece,
    /// A board whose whole pose a camera sees.
    Pose,
    /// A room, seen by an RGB-D camera: its images go into a folder beside the session file.
    Room,
}

impl TargetArg {
    const fn as_argument(self) -> &'static str {
        match self {
            Self::Ball => "--target ball",
            Self::Plate => "--target plate",
            Self::Point => "--target point",
            Self::Workpiece => "--target workpiece",
            Self::Pose => "--target pose",
            Self::Room => "--target room",
        }
    }
}

/// A workpiece.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PartArg {
    /// A square block, two faces of which are seen.
    #[default]
    Square,
    /// A row of teeth.
    Teeth,
    /// A lying cylinder.
    Cylinder,
}

impl PartArg {
    const fn kind(self) -> PartKind {
        match self {
            Self::Square => PartKind::Square,
            Self::Teeth => PartKind::Teeth,
            Self::Cylinder => PartKind::Cylinder,
        }
    }
}

/// Another target of the same sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FurtherArg {
    /// A ball of the same radius.
    Ball,
    /// A right-angle plate.
    Plate,
    /// A tip or pin.
    Point,
    /// A square block.
    Square,
    /// A row of teeth.
    Teeth,
    /// A lying cylinder.
    Cylinder,
}

impl FurtherArg {
    const fn target(self) -> SimulationTarget {
        match self {
            Self::Ball => SimulationTarget::Ball,
            Self::Plate => SimulationTarget::Part(PartKind::Plate),
            Self::Point => SimulationTarget::Part(PartKind::Pin),
            Self::Square => SimulationTarget::Part(PartKind::Square),
            Self::Teeth => SimulationTarget::Part(PartKind::Teeth),
            Self::Cylinder => SimulationTarget::Part(PartKind::Cylinder),
        }
    }
}

/// A rough mounting for the session, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughArg(Option<RoughMounting>);

/// Where the sensor is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MountArg {
    /// On the flange, the ball standing still.
    #[default]
    OnFlange,
    /// Beside the robot, the ball on the flange.
    Fixed,
}

/// Something that profiles hold besides the ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DirtArg {
    /// The table below the ball.
    Table,
    /// Single points that are off by millimetres.
    Spikes,
    /// Missing points.
    Holes,
    /// Steep flanks measured too high.
    Flanks,
    /// All of these.
    All,
}

/// Arguments of `handeye simulate`.
#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct SimulateArgs {
    /// The session file to write.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// What is measured.
    #[arg(long, value_enum, default_value_t)]
    pub target: TargetArg,
    /// The workpiece; a square block if not given.
    #[arg(long, value_enum)]
    pub part: Option<PartArg>,
    /// What else the same sensor measures on the same robot; may be given several times.
    #[arg(long, value_enum, value_name = "TARGET", value_delimiter = ',')]
    pub further: Vec<FurtherArg>,
    /// The same seed gives the same session.
    #[arg(long, default_value_t = SimulationOptions::default().seed)]
    pub seed: u64,
    /// Number of stations: 10 of a ball, 9 of each edge of a plate, 12 of a point, 2 scans of a workpiece if not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub stations: Option<u16>,
    /// Captures a station: of a ball 21, the first strike included, and 1 gives a fixed-point session; of a workpiece the
    /// profiles of a scan, over its whole length if not given; of a plate or point 1, more are taken standing still.
    #[arg(
        long, visible_alias = "captures", value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..=10_000)
    )]
    pub steps: Option<u16>,
    /// Points a profile; 800 if not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub points: Option<u32>,
    /// Radius of the ball, mm; 15 if not given.
    #[arg(long, value_name = "MM", value_parser = radius)]
    pub radius_mm: Option<f64>,
    /// Write points that are already reduced in place of the profiles of a plate or point.
    #[arg(long)]
    pub reduced: bool,
    /// How far the rough mounting in the session is off, degrees and mm, or none: 5,10 with a plate if not given.
    #[arg(long, value_name = "DEG,MM", value_parser = rough_mounting)]
    pub rough_mounting: Option<RoughArg>,
    /// Commanded step, mm; 0.05 R of a ball, 0.33 mm from profile to profile of a workpiece if not given.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub step_mm: Option<f64>,
    /// Distance of the first section from the ball's centre, mm; 0.6 R if not given.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub section_offset_mm: Option<f64>,
    /// Noise of a profile point along the range axis, mm.
    #[arg(
        long, value_name = "MM", default_value_t = SimulationOptions::default().profile_std_mm,
        value_parser = length_std
    )]
    pub profile_std_mm: f64,
    /// Noise of each coordinate of a reported position, mm.
    #[arg(
        long, value_name = "MM", default_value_t = SimulationOptions::default().position_std_mm,
        value_parser = length_std
    )]
    pub position_std_mm: f64,
    /// Noise of a reported orientation about each axis, degrees.
    #[arg(
        long, value_name = "DEG", default_value_t = SimulationOptions::default().orientation_std_deg,
        value_parser = orientation_std
    )]
    pub orientation_std_deg: f64,
    /// How far the stations tilt about two axes, degrees; 25 of a ball, otherwise 20 if not given.
    #[arg(long, value_name = "DEG", value_parser = tilt)]
    pub tilt_deg: Option<f64>,
    /// How far the stations turn about the vertical, degrees; 60 of a ball, otherwise 20 if not given.
    #[arg(long, value_name = "DEG", value_parser = spin)]
    pub spin_deg: Option<f64>,
    /// Angle between the robot's travel across a ball and the laser's normal, degrees; 0 if not given.
    #[arg(long, value_name = "DEG", value_parser = tilt)]
    pub travel_off_normal_deg: Option<f64>,
    /// Where the sensor is.
    #[arg(long, value_enum, default_value_t)]
    pub mount: MountArg,
    /// Let z grow towards the sensor instead of away from it.
    #[arg(long)]
    pub z_towards_sensor: bool,
    /// What the profiles hold besides the ball; may be given several times.
    #[arg(long, value_enum, value_name = "WHAT", value_delimiter = ',')]
    pub dirty: Vec<DirtArg>,
    /// The number of a station whose poses are wrong by 2 mm.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub bad_pose: Option<u16>,
    /// What else is wrong with the session, by the code that the diagnosis gives it, e.g. wrong-radius.
    #[arg(long, value_name = "NAME", value_parser = fault)]
    pub fault: Option<Fault>,
    /// Round points and positions to so many decimals.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=12))]
    pub decimals: Option<u8>,
    /// The session's name.
    #[arg(long)]
    pub name: Option<String>,
    /// The session's notes.
    #[arg(long)]
    pub notes: Option<String>,
    /// What a board is seen with.
    #[command(flatten)]
    pub pose: PoseArgs,
    /// What a room is recorded with.
    #[command(flatten)]
    pub room: RoomArgs,
}

/// Why nothing is simulated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SimulateRefusal {
    /// Nothing that is simulated depends on it.
    #[error("{option}: found it with {found}, where it has no effect, expected {expected} or no {option}")]
    NoEffect {
        /// The option.
        option: &'static str,
        /// What it was given with.
        found: &'static str,
        /// What it belongs to.
        expected: &'static str,
    },
    /// The faults are those of a ball session.
    #[error("--fault: found {found} with another target, expected --target ball")]
    FaultOfBall {
        /// The fault.
        found: &'static str,
    },
    /// Nothing of this target can be reduced to points.
    #[error("--reduced: found {found}, expected --target plate or point")]
    NotReduced {
        /// The target.
        found: &'static str,
    },
    /// A scan that stands still.
    #[error("--step-mm: found 0, expected more than 0 for a scan")]
    ScanStandsStill,
    /// The laser would miss the ball.
    #[error("--section-offset-mm: found {found_mm}, expected less than the radius of {radius_mm} mm")]
    SectionMissesBall {
        /// The distance of the section.
        found_mm: f64,
        /// The ball's radius.
        radius_mm: f64,
    },
    /// The sweep would leap over the ball.
    #[error("--step-mm: found {found_mm}, expected at most the radius of {radius_mm} mm")]
    StepTooLarge {
        /// The step.
        found_mm: f64,
        /// The ball's radius.
        radius_mm: f64,
    },
    /// There is no such station.
    #[error("--bad-pose: found station {found}, expected 1 to {num_stations}")]
    NoSuchStation {
        /// The number given.
        found: u16,
        /// How many stations there are.
        num_stations: usize,
    },
}

/// Simulates a session and writes it, a room with its folder of images.
#[must_use]
pub fn run(args: &SimulateArgs) -> ExitCode {
    match write(args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => fail(EXIT_WRONG_INPUT, &reason),
    }
}

/// # Errors
/// In one line.
fn write(args: &SimulateArgs) -> Result<(), String> {
    if args.target == TargetArg::Room {
        return room::write(args);
    }
    let session = simulated_session(args).map_err(|refusal| refusal.to_string())?;
    save(&session, &args.out).map_err(|error| error.to_string())
}

/// The session that the arguments ask for; that of a room names the folder that [`run`] writes.
///
/// # Errors
/// [`SimulateRefusal`] where the arguments do not go together.
pub fn simulated_session(args: &SimulateArgs) -> Result<Session, SimulateRefusal> {
    match target_of(args) {
        Some(target) => Ok(named(simulate(&options(args, target)?), args)),
        None if args.target == TargetArg::Pose => pose::session(args),
        None => Ok(room::session(args, &room::recording(args)?)),
    }
}

fn named(mut session: Session, args: &SimulateArgs) -> Session {
    if let Some(name) = &args.name {
        session.name.clone_from(name);
    }
    if let Some(notes) = &args.notes {
        session.notes.clone_from(notes);
    }
    session
}

/// What profiles are taken of; `None` for a board and a room, which a camera sees.
fn target_of(args: &SimulateArgs) -> Option<SimulationTarget> {
    match args.target {
        TargetArg::Ball => Some(SimulationTarget::Ball),
        TargetArg::Plate => Some(SimulationTarget::Part(PartKind::Plate)),
        TargetArg::Point => Some(SimulationTarget::Part(PartKind::Pin)),
        TargetArg::Workpiece => Some(SimulationTarget::Part(args.part.unwrap_or_default().kind())),
        TargetArg::Pose | TargetArg::Room => None,
    }
}

fn options(args: &SimulateArgs, target: SimulationTarget) -> Result<SimulationOptions, SimulateRefusal> {
    let further: Vec<SimulationTarget> = args.further.iter().map(|further| further.target()).collect();
    let usual = SimulationOptions::of(target);
    // Whatever a plate is measured along with, its methods have something to start from.
    let usual_rough = further.iter().find_map(|target| SimulationOptions::of(*target).rough_mounting);
    let is_ball = target == SimulationTarget::Ball;
    if let Some(fault) = args.fault.filter(|_| !is_ball) {
        return Err(SimulateRefusal::FaultOfBall { found: fault.id() });
    }
    if args.reduced && (is_ball || target.is_workpiece()) {
        return Err(SimulateRefusal::NotReduced { found: target.name() });
    }
    refuse_without_effect(args, target, &further)?;
    let radius_mm = args.radius_mm.unwrap_or(usual.radius_mm);
    let (step_mm, num_steps) = steps(args, target, radius_mm, &usual)?;
    let num_stations = args.stations.map_or(usual.num_stations, usize::from);
    let num_all = if target == SimulationTarget::Part(PartKind::Plate) { 2 * num_stations } else { num_stations };
    if let Some(found) = args.bad_pose.filter(|number| usize::from(*number) > num_all) {
        return Err(SimulateRefusal::NoSuchStation { found, num_stations: num_all });
    }
    let has = |dirt: DirtArg| args.dirty.contains(&dirt) || args.dirty.contains(&DirtArg::All);
    Ok(SimulationOptions {
        seed: args.seed,
        further,
        num_stations,
        num_steps,
        num_points: args.points.map_or(usual.num_points, |points| points as usize),
        radius_mm,
        step_mm,
        section_offset_mm: args.section_offset_mm,
        profile_std_mm: args.profile_std_mm,
        has_points: args.reduced,
        rough_mounting: args.rough_mounting.map_or(usual.rough_mounting.or(usual_rough), |RoughArg(given)| given),
        position_std_mm: args.position_std_mm,
        orientation_std_deg: args.orientation_std_deg,
        tilt_deg: args.tilt_deg.unwrap_or(usual.tilt_deg),
        spin_deg: args.spin_deg.unwrap_or(usual.spin_deg),
        travel_off_normal_deg: args.travel_off_normal_deg.unwrap_or(usual.travel_off_normal_deg),
        mount: match args.mount {
            MountArg::OnFlange => Mount::OnFlange,
            MountArg::Fixed => Mount::Fixed,
        },
        z_towards_sensor: args.z_towards_sensor,
        dirt: Dirt {
            has_table: has(DirtArg::Table),
            has_spikes: has(DirtArg::Spikes),
            has_holes: has(DirtArg::Holes),
            has_flank_bias: has(DirtArg::Flanks),
        },
        bad_pose_station: args.bad_pose.map(|number| usize::from(number) - 1),
        fault: args.fault,
        decimals: args.decimals,
        ..usual
    })
}

/// What is asked for and would change nothing is a mistake somewhere else.
fn refuse_without_effect(
    args: &SimulateArgs,
    target: SimulationTarget,
    further: &[SimulationTarget],
) -> Result<(), SimulateRefusal> {
    let is_ball = target == SimulationTarget::Ball;
    let is_of_a_sweep = is_ball && args.steps != Some(1);
    let has_profiles =
        !args.reduced || further.iter().any(|further| *further == SimulationTarget::Ball || further.is_workpiece());
    let has_ball = is_ball || further.contains(&SimulationTarget::Ball);
    let ball = "--target ball";
    let own = args.target.as_argument();
    if let Some(option) = args.room.first_given() {
        return Err(SimulateRefusal::NoEffect { option, found: own, expected: "--target room" });
    }
    if let Some(option) = args.pose.first_given() {
        return Err(SimulateRefusal::NoEffect { option, found: own, expected: "--target pose" });
    }
    let reduced = "--reduced";
    [
        ("--part", args.part.is_some(), args.target == TargetArg::Workpiece, own, "--target workpiece"),
        ("--radius-mm", args.radius_mm.is_some(), has_ball, own, ball),
        ("--section-offset-mm", args.section_offset_mm.is_some(), is_ball, own, ball),
        ("--travel-off-normal-deg", args.travel_off_normal_deg.is_some(), has_ball, own, ball),
        ("--step-mm", args.step_mm.is_some(), is_ball || target.is_workpiece(), own, "--target ball or workpiece"),
        ("--step-mm", args.step_mm.is_some(), !is_ball || is_of_a_sweep, "--steps 1", "more steps"),
        ("--points", args.points.is_some(), has_profiles, reduced, "profiles"),
        ("--dirty", !args.dirty.is_empty(), has_profiles, reduced, "profiles"),
    ]
    .into_iter()
    .find(|(_, is_given, has_effect, ..)| *is_given && !has_effect)
    .map_or(Ok(()), |(option, _, _, found, expected)| Err(SimulateRefusal::NoEffect { option, found, expected }))
}

/// The commanded step and the number of captures a station.
fn steps(
    args: &SimulateArgs,
    target: SimulationTarget,
    radius_mm: f64,
    usual: &SimulationOptions,
) -> Result<(f64, usize), SimulateRefusal> {
    /// So that 21 captures from 0.6 R reach well past the largest arc.
    const STEP_RATIO: f64 = 0.05;
    let given = args.steps.map(usize::from);
    match target {
        SimulationTarget::Ball => {
            if let Some(found_mm) = args.section_offset_mm.filter(|offset_mm| *offset_mm >= radius_mm) {
                return Err(SimulateRefusal::SectionMissesBall { found_mm, radius_mm });
            }
            let step_mm = args.step_mm.unwrap_or(STEP_RATIO * radius_mm);
            if step_mm > radius_mm {
                return Err(SimulateRefusal::StepTooLarge { found_mm: step_mm, radius_mm });
            }
            Ok((step_mm, given.unwrap_or(usual.num_steps)))
        }
        SimulationTarget::Part(kind) if target.is_workpiece() => {
            let step_mm = args.step_mm.unwrap_or(usual.step_mm);
            if step_mm <= 0.0 {
                return Err(SimulateRefusal::ScanStandsStill);
            }
            Ok((step_mm, given.unwrap_or_else(|| SimulationOptions::steps_to_scan(kind, step_mm))))
        }
        SimulationTarget::Part(_) => Ok((usual.step_mm, given.unwrap_or(usual.num_steps))),
    }
}

fn rough_mounting(text: &str) -> Result<RoughArg, String> {
    if text == "none" {
        return Ok(RoughArg(None));
    }
    let [max_deg, max_mm] = SimulationOptions::MAX_ROUGH;
    let number = |text: &str, max: f64| text.trim().parse().ok().filter(|value| (0.0..=max).contains(value));
    text.split_once(',')
        .and_then(|(deg, mm)| Some(RoughMounting { off_deg: number(deg, max_deg)?, off_mm: number(mm, max_mm)? }))
        .map(|rough| RoughArg(Some(rough)))
        .ok_or_else(|| format!("expected degrees up to {max_deg} and mm up to {max_mm}, such as 5,10, or none"))
}

fn radius(text: &str) -> Result<f64, String> {
    within(text, SimulationOptions::RADIUS_MM)
}

fn length(text: &str) -> Result<f64, String> {
    within(text, [0.0, SimulationOptions::RADIUS_MM[1]])
}

fn length_std(text: &str) -> Result<f64, String> {
    within(text, [0.0, SimulationOptions::MAX_STD_MM])
}

fn orientation_std(text: &str) -> Result<f64, String> {
    within(text, [0.0, SimulationOptions::MAX_STD_DEG])
}

fn tilt(text: &str) -> Result<f64, String> {
    within(text, [0.0, SimulationOptions::MAX_TILT_DEG])
}

fn spin(text: &str) -> Result<f64, String> {
    within(text, [0.0, 180.0])
}

fn fault(text: &str) -> Result<Fault, String> {
    Fault::by_id(text).ok_or_else(|| format!("expected one of {}", Fault::ALL.map(Fault::id).join(", ")))
}

fn within(text: &str, [min, max]: [f64; 2]) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|value| (min..=max).contains(value))
        .ok_or_else(|| format!("expected a number from {min} to {max}"))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use crate::session::Target;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: SimulateArgs,
    }

    fn parsed(arguments: &str) -> Result<SimulateArgs, clap::Error> {
        Line::try_parse_from(format!("simulate --out x.json {arguments}").split_whitespace()).map(|line| line.args)
    }

    fn options(args: &SimulateArgs) -> Result<SimulationOptions, SimulateRefusal> {
        super::options(args, target_of(args).expect("it has stations"))
    }

    #[test]
    fn without_arguments_it_simulates_the_defaults() {
        let options = options(&parsed("").expect("valid")).expect("valid");
        assert_eq!(options, SimulationOptions::default());
    }

    #[test]
    fn each_target_has_its_usual_options() {
        for (arguments, kind) in [
            ("--target plate", PartKind::Plate),
            ("--target point", PartKind::Pin),
            ("--target workpiece", PartKind::Square),
            ("--target workpiece --part teeth", PartKind::Teeth),
        ] {
            let options = options(&parsed(arguments).expect("valid")).expect("valid");
            assert_eq!(options, SimulationOptions::of(SimulationTarget::Part(kind)), "{arguments}");
        }
        let rough = |arguments: &str| options(&parsed(arguments).expect("valid")).expect("valid").rough_mounting;
        assert_eq!(rough("--further point,plate"), Some(RoughMounting { off_deg: 5.0, off_mm: 10.0 }));
        assert_eq!(rough("--target plate --rough-mounting none"), None);
        let radius_mm = |arguments: &str| options(&parsed(arguments).expect("valid")).expect("valid").radius_mm;
        assert!(radius_mm("--target plate --further ball --radius-mm 12").to_bits() == 12.0_f64.to_bits());
        assert_eq!(rough("--rough-mounting 2,3.5"), Some(RoughMounting { off_deg: 2.0, off_mm: 3.5 }));
    }

    #[test]
    fn values_out_of_range_are_refused_by_name() {
        for (arguments, culprit) in [
            ("--radius-mm -1", "--radius-mm"),
            ("--radius-mm nan", "--radius-mm"),
            ("--stations 0", "--stations"),
            ("--steps 0", "--steps"),
            ("--points 1", "--points"),
            ("--profile-std-mm inf", "--profile-std-mm"),
            ("--tilt-deg 90", "--tilt-deg"),
            ("--dirty mud", "--dirty"),
            ("--rough-mounting 5", "expected degrees up to 90 and mm up to 1000"),
            ("--rough-mounting 5,nan", "--rough-mounting"),
            ("--further mud", "--further"),
            ("--target room --size 320", "expected a width and a height of 32 to 2048 pixels"),
            ("--target room --frames 0", "--frames"),
            ("--target room --frame-fault dark:9-3", "expected one of dark, blank-wall"),
            ("--target room --on-robot --hand-held", "--hand-held"),
            ("--target room --robot-clock-ahead-ms 20", "--on-robot"),
            ("--fault gremlin", "expected one of pose-convention, quaternion-order"),
        ] {
            let refusal = parsed(arguments).expect_err(arguments).to_string();
            assert!(refusal.contains(culprit), "{arguments}: {refusal}");
        }
    }

    #[test]
    fn a_room_takes_no_arguments_of_other_targets() {
        let refused = |arguments: &str| {
            let args = parsed(&format!("--target room {arguments}")).expect("well formed");
            simulated_session(&args).expect_err(arguments).to_string()
        };
        for (arguments, fragment) in [
            (
                "--stations 5",
                "--stations: found it with --target room, where it has no effect, expected a target with stations",
            ),
            ("--mount fixed", "--mount: found it with --target room"),
            ("--fault drift", "expected --target ball or no --fault"),
        ] {
            assert!(refused(arguments).contains(fragment), "{}", refused(arguments));
        }
    }

    #[test]
    fn a_board_takes_no_arguments_of_other_targets() {
        let session =
            |arguments: &str| simulated_session(&parsed(&format!("--target pose {arguments}")).expect("well formed"));
        for (arguments, fragment) in [
            ("--steps 5", "--steps: found it with --target pose, where it has no effect"),
            ("--frames 9", "expected --target room or no --frames"),
            ("--stations 5 --bad-pose 6", "expected 1 to 5"),
        ] {
            let refusal = session(arguments).expect_err(arguments).to_string();
            assert!(refusal.contains(fragment), "{arguments}: {refusal}");
        }
        let session = session("--stations 4 --mount fixed --target-std-mm 0.3").expect("valid");
        assert_eq!((session.stations.len(), session.mount), (4, Mount::Fixed));
        assert!(session.target.is_pose());
    }

    #[test]
    fn the_session_of_a_room_names_the_folder_beside_it() {
        let args = parsed("--target room --on-robot --name arm").expect("well formed");
        let session = simulated_session(&args).expect("valid");
        assert_eq!(session.target, Target::Rgbd { sequence: "x-sequence".to_owned() });
        assert_eq!(session.name, "arm");
        assert!(session.truth.is_some());
    }

    #[test]
    fn arguments_that_do_not_go_together_are_refused_in_one_line() {
        for (arguments, fragment) in [
            ("--target plate --fault drift", "--fault: found drift with another target"),
            ("--target plate --part teeth", "--part: found it with --target plate, where it has no effect"),
            ("--target plate --radius-mm 12 --steps 5", "expected --target ball or no --radius-mm"),
            ("--target point --section-offset-mm 3", "--section-offset-mm: found it with"),
            ("--target workpiece --travel-off-normal-deg 3", "--travel-off-normal-deg: found it with"),
            ("--target plate --step-mm 3", "expected --target ball or workpiece or no --step-mm"),
            ("--steps 1 --step-mm 1.5", "--step-mm: found it with --steps 1"),
            ("--target point --reduced --points 100", "--points: found it with --reduced"),
            ("--target plate --reduced --dirty holes", "--dirty: found it with --reduced"),
            ("--reduced", "--reduced: found ball, expected --target plate or point"),
            ("--target workpiece --reduced", "--reduced: found square block"),
            ("--target workpiece --step-mm 0", "--step-mm: found 0"),
            ("--target plate --stations 5 --bad-pose 11", "expected 1 to 10"),
            ("--section-offset-mm 15", "expected less than the radius of 15 mm"),
            ("--step-mm 16", "expected at most the radius of 15 mm"),
            ("--stations 5 --bad-pose 6", "expected 1 to 5"),
            ("--target-std-mm 1", "--target-std-mm: found it with --target ball, where it has no effect"),
            ("--size 320x240", "--size: found it with --target ball, where it has no effect"),
            ("--target plate --frame-fault dark:3", "expected --target room or no --frame-fault"),
        ] {
            let refusal = options(&parsed(arguments).expect("well formed")).expect_err(arguments).to_string();
            assert!(refusal.contains(fragment) && !refusal.contains('\n'), "{arguments}: {refusal}");
        }
    }
}
