//! What `handeye import` takes for ROS 2 bags.

use clap::ValueEnum;

use crate::session::import::bag::{BagOptions, Clock, ProfileAxes, Taking};

/// How a bag is to be read; what is not said is recognised.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "ROS 2 bags")]
pub struct BagArgs {
    /// List the topics of the bags, and import nothing.
    #[arg(long)]
    pub list_topics: bool,
    /// The topic of the poses.
    #[arg(long, value_name = "TOPIC")]
    pub pose_topic: Option<String>,
    /// The topic of the profiles.
    #[arg(long, value_name = "TOPIC")]
    pub profile_topic: Option<String>,
    /// The frame that the poses are in, of a topic of transforms.
    #[arg(long, value_name = "FRAME")]
    pub base_frame: Option<String>,
    /// The frame that the poses are of, of a topic of transforms.
    #[arg(long, value_name = "FRAME")]
    pub flange_frame: Option<String>,
    /// Which axes of the messages are x and z of the profile, e.g. y,x or x,-z.
    #[arg(long, value_name = "AXES", allow_hyphen_values = true)]
    pub profile_axes: Option<ProfileAxes>,
    /// Which time of a message counts: its header's, or that of the recording.
    #[arg(long, value_enum)]
    pub clock: Option<ClockArg>,
    /// A pose and a profile belong together if no more lies between them, ms (50).
    #[arg(long, value_name = "MS", value_parser = positive)]
    pub pair_within_ms: Option<f64>,
    /// What becomes a capture.
    #[arg(long, value_enum)]
    pub take: Option<TakeArg>,
    /// The robot stands still if it does so for as long, s (0.5).
    #[arg(long, value_name = "S", value_parser = positive)]
    pub still_for_s: Option<f64>,
    /// Standing still, it moves no further, mm (0.05).
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub still_within_mm: Option<f64>,
    /// Standing still, it turns no further, degrees (0.02).
    #[arg(long, value_name = "DEG", value_parser = positive)]
    pub still_within_deg: Option<f64>,
    /// Stays along a line, with one orientation, are stations each, and not one sweep.
    #[arg(long)]
    pub separate_stays: bool,
}

/// Which time counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ClockArg {
    /// That of the header, and where this is 0 that of the recording.
    Header,
    /// That of the recording.
    Recording,
}

/// What becomes a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TakeArg {
    /// Every stay of the robot with the median of its profiles.
    Stays,
    /// Every stay of the robot with its first profile.
    FirstOfStays,
    /// Every profile; those of one orientation that follow each other are one station.
    Every,
}

fn positive(text: &str) -> Result<f64, String> {
    // A day, a kilometre or a turn is a mistake.
    const MAX: f64 = 86_400_000.0;
    let value = text.parse().ok().filter(|value: &f64| (0.0..=MAX).contains(value));
    value.ok_or_else(|| format!("found {text}, expected a number from 0 to {MAX}"))
}

impl BagArgs {
    /// As the import takes it.
    #[must_use]
    pub fn options(&self) -> BagOptions {
        let usual = BagOptions::default();
        BagOptions {
            pose_topic: self.pose_topic.clone(),
            profile_topic: self.profile_topic.clone(),
            base_frame: self.base_frame.clone(),
            flange_frame: self.flange_frame.clone(),
            axes: self.profile_axes,
            clock: match self.clock {
                Some(ClockArg::Recording) => Clock::Recording,
                Some(ClockArg::Header) | None => Clock::Header,
            },
            pair_within_ms: self.pair_within_ms.unwrap_or(usual.pair_within_ms),
            taking: self.take.map(|take| match take {
                TakeArg::Stays => Taking::SettledMedian,
                TakeArg::FirstOfStays => Taking::SettledFirst,
                TakeArg::Every => Taking::EveryProfile,
            }),
            still_for_s: self.still_for_s.unwrap_or(usual.still_for_s),
            still_within_mm: self.still_within_mm.unwrap_or(usual.still_within_mm),
            still_within_deg: self.still_within_deg.unwrap_or(usual.still_within_deg),
            joins_stays: !self.separate_stays,
        }
    }
}
