//! `handeye cell`: a simulated robot and profiler that speak the real protocols on loopback.

use std::fmt::Write as _;
use std::process::ExitCode;
use std::time::Duration;

use clap::ValueEnum;

use crate::device::sim::{FaultSpec, Head, SimCell, SimOptions};
use crate::device::{RobotKind, SensorKind};
use crate::geometry::{PoseConvention, Rigid};
use crate::scene::PartKind;

use super::{EXIT_WRONG_INPUT, fail, print};

/// The robot to simulate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RobotArg {
    /// FANUC with the MAPPDK server, and its web pages where the system lets them be served.
    #[default]
    Mappdk,
    /// FANUC's web page CURPOS.DG, and the MAPPDK server to move it with.
    Curpos,
    /// Universal Robots.
    Ur,
    /// The text bridge.
    Bridge,
}

impl RobotArg {
    const fn kind(self) -> RobotKind {
        match self {
            Self::Mappdk => RobotKind::FanucMappdk,
            Self::Curpos => RobotKind::FanucPage,
            Self::Ur => RobotKind::UniversalRobots,
            Self::Bridge => RobotKind::Bridge,
        }
    }

    /// How its pendant writes an orientation.
    fn convention(self) -> &'static PoseConvention {
        let id = match self {
            Self::Mappdk | Self::Curpos | Self::Bridge => "fanuc-wpr",
            Self::Ur => "ur-rotvec",
        };
        PoseConvention::by_id(id).unwrap_or_else(PoseConvention::default_convention)
    }
}

/// The profiler to simulate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SensorArg {
    /// Keyence LJ-V7000.
    #[default]
    Ljv,
    /// The text bridge.
    Bridge,
}

impl SensorArg {
    const fn kind(self) -> SensorKind {
        match self {
            Self::Ljv => SensorKind::KeyenceLjv,
            Self::Bridge => SensorKind::Bridge,
        }
    }
}

/// What stands before the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TargetArg {
    /// A ball on a post.
    #[default]
    Ball,
    /// A right-angle plate on a table.
    Plate,
    /// A pin that ends in a point.
    Pin,
    /// A square block on one of its edges.
    Square,
    /// A row of teeth.
    Teeth,
}

impl TargetArg {
    const fn part(self) -> Option<PartKind> {
        match self {
            Self::Ball => None,
            Self::Plate => Some(PartKind::Plate),
            Self::Pin => Some(PartKind::Pin),
            Self::Square => Some(PartKind::Square),
            Self::Teeth => Some(PartKind::Teeth),
        }
    }
}

/// Arguments of `handeye cell`.
#[derive(Clone, Debug, clap::Args)]
pub struct CellArgs {
    /// The robot.
    #[arg(long, value_enum, default_value_t)]
    pub robot: RobotArg,
    /// The profiler.
    #[arg(long, value_enum, default_value_t)]
    pub sensor: SensorArg,
    /// The profiler's head: lj-v7060, lj-v7080, lj-v7200 or lj-v7300.
    #[arg(long, value_name = "NAME", default_value = Head::default().id, value_parser = head)]
    pub head: Head,
    /// What stands before the robot.
    #[arg(long, value_enum, default_value_t)]
    pub target: TargetArg,
    /// Radius of the ball, mm.
    #[arg(long, value_name = "MM", default_value_t = SimOptions::default().radius_mm, value_parser = radius_mm, allow_negative_numbers = true)]
    pub radius_mm: f64,
    /// Added to every port of the real devices.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub port_offset: u16,
    /// The same seed gives the same noise.
    #[arg(long, default_value_t = SimOptions::default().seed)]
    pub seed: u64,
    /// How much faster than real time the cell runs.
    #[arg(long, value_name = "FACTOR", default_value_t = SimOptions::default().time_scale)]
    pub time_scale: f64,
    /// Leave out all noise, and the points that profiles lose.
    #[arg(long)]
    pub noise_free: bool,
    /// Something that goes wrong, such as silent or garbage:sensor:after=20:for=3; may be given several times.
    #[arg(long, value_name = "FAULT")]
    pub fault: Vec<FaultSpec>,
    /// Print what is true in the cell: the calibration and the ball.
    #[arg(long)]
    pub truth: bool,
    /// End after so many seconds.
    #[arg(long, value_name = "N")]
    pub seconds: Option<u32>,
}

/// Serves until it is stopped.
#[must_use]
pub fn run(args: &CellArgs) -> ExitCode {
    let cell = match SimCell::start(&options(args)) {
        Ok(cell) => cell,
        Err(error) => return fail(EXIT_WRONG_INPUT, &error),
    };
    if let Err(exit_code) = print(&description(args, &cell)) {
        return exit_code;
    }
    match args.seconds {
        Some(seconds) => std::thread::sleep(Duration::from_secs(seconds.into())),
        None => loop {
            // The servers have their own threads; this one may be woken for no reason.
            std::thread::park();
        },
    }
    ExitCode::SUCCESS
}

fn options(args: &CellArgs) -> SimOptions {
    SimOptions {
        robot: args.robot.kind(),
        sensor: args.sensor.kind(),
        port_offset: Some(args.port_offset),
        seed: args.seed,
        time_scale: args.time_scale,
        head: args.head,
        radius_mm: args.radius_mm,
        part: args.target.part(),
        is_noisy: !args.noise_free,
        faults: args.fault.clone(),
        ..SimOptions::default()
    }
}

/// One line a port, then what a person would know of the cell, and on request what only the cell knows.
fn description(args: &CellArgs, cell: &SimCell) -> String {
    let convention = args.robot.convention();
    let truth = &cell.truth;
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (port, what) in &cell.ports {
        let _ = writeln!(text, "127.0.0.1:{port} {what}");
    }
    let _ = writeln!(text, "head: {}, {} mm to the middle of its range", args.head.id, truth.reference_distance_mm);
    if cell.sensor_setup.is_z_inverted {
        text.push_str("profiles: z grows towards the head; turn it about for what follows\n");
    }
    match args.target.to_possible_value().filter(|_| truth.base_from_part.is_some()) {
        Some(part) => {
            let _ = writeln!(text, "target: {}", part.get_name());
        }
        None => {
            let _ = writeln!(text, "ball: radius {} mm", truth.radius_mm);
        }
    }
    let _ = writeln!(text, "drawing: flange_from_sensor {}", pose(&truth.rough_flange_from_sensor, convention, 1));
    if args.truth {
        let _ = writeln!(text, "truth: flange_from_sensor {}", pose(&truth.flange_from_sensor, convention, 4));
        if let Some(base_from_part) = &truth.base_from_part {
            let _ = writeln!(text, "truth: base_from_part {}", pose(base_from_part, convention, 4));
        } else {
            let [x, y, z] = truth.ball_in_base.into();
            let _ = writeln!(text, "truth: ball_in_base x {x:.4} y {y:.4} z {z:.4} mm");
        }
        let [position_mm, orientation_deg] = truth.pose_std_mm_deg;
        let _ = writeln!(
            text,
            "truth: noise (1 σ) {position_mm} mm and {orientation_deg}° of a pose, {} mm of a point",
            truth.profile_std_mm
        );
    }
    text.push_str("ready\n");
    text
}

fn pose(pose: &Rigid, convention: &PoseConvention, decimals: usize) -> String {
    let [x, y, z] = pose.translation.vector.into();
    let angles = convention.angles_deg_from_rotation(&pose.rotation);
    let names = convention.angle_names;
    let angles: Vec<String> =
        names.iter().zip(angles).map(|(name, angle)| format!("{name} {angle:.decimals$}")).collect();
    format!("x {x:.decimals$} y {y:.decimals$} z {z:.decimals$} mm, {}°", angles.join(" "))
}

fn radius_mm(text: &str) -> Result<f64, String> {
    let radius_mm = text.parse().ok().filter(|radius_mm: &f64| radius_mm.is_finite() && *radius_mm > 0.0);
    radius_mm.ok_or_else(|| "expected a radius above 0 mm".to_owned())
}

fn head(text: &str) -> Result<Head, String> {
    Head::by_id(text).ok_or_else(|| format!("expected one of {}", Head::ALL.map(|head| head.id).join(", ")))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: CellArgs,
    }

    fn parsed(arguments: &str) -> Result<CellArgs, clap::Error> {
        Line::try_parse_from(format!("cell {arguments}").split_whitespace()).map(|line| line.args)
    }

    #[test]
    fn without_arguments_it_serves_the_real_ports() {
        let options = options(&parsed("").expect("valid"));
        assert_eq!(options, SimOptions { port_offset: Some(0), ..SimOptions::default() });
    }

    #[test]
    fn wrong_arguments_are_refused_by_name() {
        for (arguments, culprit) in [
            ("--robot abb", "--robot"),
            ("--target moon", "--target"),
            ("--sensor folder", "--sensor"),
            ("--head lj-v1", "expected one of lj-v7060"),
            ("--fault mute", "expected a fault (split-frames"),
            ("--port-offset -1", "-1"),
            ("--radius-mm -3", "expected a radius above 0 mm"),
        ] {
            let refusal = parsed(arguments).expect_err(arguments).to_string();
            assert!(refusal.contains(culprit), "{arguments}: {refusal}");
        }
    }

    #[test]
    fn every_robot_names_its_own_angles() {
        for robot in [RobotArg::Mappdk, RobotArg::Curpos, RobotArg::Ur, RobotArg::Bridge] {
            let options = SimOptions { robot: robot.kind(), ..SimOptions::default() };
            let cell = SimCell::start(&options).expect("free ports");
            let args = CellArgs { robot, truth: true, ..parsed("").expect("valid") };
            let text = description(&args, &cell);
            let names = robot.convention().angle_names;
            assert!(text.lines().any(|line| line.starts_with("drawing:") && line.contains(names[0])), "{text}");
            assert!(text.starts_with("127.0.0.1:") && text.ends_with("ready\n"), "{text}");
            assert_eq!(robot == RobotArg::Ur, robot.convention() != PoseConvention::default_convention());
        }
    }
}
