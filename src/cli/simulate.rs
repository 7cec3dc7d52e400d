//! `handeye simulate`: writes a simulated session with its truth.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::ValueEnum;
use thiserror::Error;

use crate::calibrate::Mount;
use crate::session::{Session, save};
use crate::simulate::{Dirt, Fault, SimulationOptions, simulate};

use super::{EXIT_WRONG_INPUT, fail};

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
}

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
    /// The same seed gives the same session.
    #[arg(long, default_value_t = SimulationOptions::default().seed)]
    pub seed: u64,
    /// Number of stations.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub stations: u16,
    /// Captures a station, the first strike included; 1 gives a fixed-point session.
    #[arg(long, value_name = "N", default_value_t = 21, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub steps: u16,
    /// Points a profile.
    #[arg(long, value_name = "N", default_value_t = 800, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub points: u32,
    /// Radius of the ball, mm.
    #[arg(long, value_name = "MM", default_value_t = SimulationOptions::default().radius_mm, value_parser = radius)]
    pub radius_mm: f64,
    /// Commanded step, mm; 0.05 R if not given.
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
    /// How far the stations tilt about two axes, degrees.
    #[arg(long, value_name = "DEG", default_value_t = SimulationOptions::default().tilt_deg, value_parser = tilt)]
    pub tilt_deg: f64,
    /// How far the stations turn about the vertical, degrees.
    #[arg(long, value_name = "DEG", default_value_t = SimulationOptions::default().spin_deg, value_parser = spin)]
    pub spin_deg: f64,
    /// Angle between the robot's travel and the laser's normal, degrees.
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = tilt)]
    pub travel_off_normal_deg: f64,
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
}

/// Why nothing is simulated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SimulateRefusal {
    /// Only the ball can be simulated so far.
    #[error("--target {found}: not available yet, found {found}, expected ball")]
    TargetNotAvailable {
        /// The target asked for.
        found: &'static str,
    },
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
        num_stations: u16,
    },
}

/// Simulates a session and writes it.
#[must_use]
pub fn run(args: &SimulateArgs) -> ExitCode {
    match simulated_session(args) {
        Ok(session) => match save(&session, &args.out) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => fail(EXIT_WRONG_INPUT, &error),
        },
        Err(refusal) => fail(EXIT_WRONG_INPUT, &refusal),
    }
}

/// The session that the arguments ask for.
///
/// # Errors
/// [`SimulateRefusal`] where the arguments do not go together.
pub fn simulated_session(args: &SimulateArgs) -> Result<Session, SimulateRefusal> {
    let mut session = simulate(&options(args)?);
    if let Some(name) = &args.name {
        session.name.clone_from(name);
    }
    if let Some(notes) = &args.notes {
        session.notes.clone_from(notes);
    }
    Ok(session)
}

fn options(args: &SimulateArgs) -> Result<SimulationOptions, SimulateRefusal> {
    /// So that 21 captures from 0.6 R reach well past the largest arc.
    const STEP_RATIO: f64 = 0.05;
    match args.target {
        TargetArg::Ball => {}
        TargetArg::Plate => return Err(SimulateRefusal::TargetNotAvailable { found: "plate" }),
        TargetArg::Point => return Err(SimulateRefusal::TargetNotAvailable { found: "point" }),
    }
    let radius_mm = args.radius_mm;
    if let Some(found_mm) = args.section_offset_mm.filter(|offset_mm| *offset_mm >= radius_mm) {
        return Err(SimulateRefusal::SectionMissesBall { found_mm, radius_mm });
    }
    let step_mm = args.step_mm.unwrap_or(STEP_RATIO * radius_mm);
    if step_mm > radius_mm {
        return Err(SimulateRefusal::StepTooLarge { found_mm: step_mm, radius_mm });
    }
    if let Some(found) = args.bad_pose.filter(|number| *number > args.stations) {
        return Err(SimulateRefusal::NoSuchStation { found, num_stations: args.stations });
    }
    let has = |dirt: DirtArg| args.dirty.contains(&dirt) || args.dirty.contains(&DirtArg::All);
    Ok(SimulationOptions {
        seed: args.seed,
        num_stations: args.stations.into(),
        num_steps: args.steps.into(),
        num_points: args.points as usize,
        radius_mm,
        step_mm,
        section_offset_mm: args.section_offset_mm,
        profile_std_mm: args.profile_std_mm,
        position_std_mm: args.position_std_mm,
        orientation_std_deg: args.orientation_std_deg,
        tilt_deg: args.tilt_deg,
        spin_deg: args.spin_deg,
        travel_off_normal_deg: args.travel_off_normal_deg,
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
        ..SimulationOptions::default()
    })
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

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: SimulateArgs,
    }

    fn parsed(arguments: &str) -> Result<SimulateArgs, clap::Error> {
        Line::try_parse_from(format!("simulate --out x.json {arguments}").split_whitespace()).map(|line| line.args)
    }

    #[test]
    fn without_arguments_it_simulates_the_defaults() {
        let options = options(&parsed("").expect("valid")).expect("valid");
        assert_eq!(options, SimulationOptions::default());
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
            ("--fault gremlin", "expected one of pose-convention, quaternion-order"),
        ] {
            let refusal = parsed(arguments).expect_err(arguments).to_string();
            assert!(refusal.contains(culprit), "{arguments}: {refusal}");
        }
    }

    #[test]
    fn arguments_that_do_not_go_together_are_refused_in_one_line() {
        for (arguments, fragment) in [
            ("--target plate", "not available yet"),
            ("--target point", "not available yet"),
            ("--section-offset-mm 15", "expected less than the radius of 15 mm"),
            ("--step-mm 16", "expected at most the radius of 15 mm"),
            ("--stations 5 --bad-pose 6", "expected 1 to 5"),
        ] {
            let refusal = options(&parsed(arguments).expect("well formed")).expect_err(arguments).to_string();
            assert!(refusal.contains(fragment) && !refusal.contains('\n'), "{arguments}: {refusal}");
        }
    }
}
