//! Wording of imports from ROS 2 bags, in the window and on the command line.

use crate::geometry::notation::LengthUnit;
use crate::session::import::bag::{Bag, BagReport, Clock, ListedFrame, MessageKind, ProfileAxes, Taking, Topic};

use super::shell::count;

/// Heading.
pub const BAG: &str = "Bag";
/// Row.
pub const POSE_TOPIC: &str = "poses from";
/// Row.
pub const PROFILE_TOPIC: &str = "profiles from";
/// Row.
pub const BASE_FRAME: &str = "base frame";
/// Row.
pub const FLANGE_FRAME: &str = "flange frame";
/// Row.
pub const TAKING: &str = "take";
/// Row.
pub const AXES: &str = "x, z of profiles";
/// Row.
pub const CLOCK: &str = "times";
/// Row.
pub const PAIR_WITHIN: &str = "pair within / ms";
/// Row.
pub const STILL_FOR: &str = "still for / s";
/// Row.
pub const STILL_WITHIN_MM: &str = "still within / mm";
/// Row.
pub const STILL_WITHIN_DEG: &str = "still within / °";
/// Checkbox.
pub const JOIN: &str = "join stays along a line into sweeps";
/// What it does.
pub const JOIN_HINT: &str =
    "At least three stays with one orientation, each a step ahead on a line, become one station: a sweep over the ball";
/// Title of the card with the topics.
pub const TOPICS: &str = "What the bag holds, and what becomes of it";
/// Heads of its table.
pub const TOPIC_COLUMNS: [&str; 6] = ["topic", "type", "messages", "first / s", "last / s", "gives"];
/// What the times are counted from.
pub const TIMES_FROM: &str = "seconds from the beginning of the recording";
/// Why a number is not taken.
pub const NEGATIVE: &str = "type a number from 0 on";
/// Where a bag has no such topic.
pub const NO_TOPIC: &str = "none";

/// What becomes a capture.
#[must_use]
pub const fn taking(taking: Taking) -> &'static str {
    match taking {
        Taking::SettledMedian => "stays, median profile",
        Taking::SettledFirst => "stays, first profile",
        Taking::EveryProfile => "every profile, as a scan",
    }
}

/// Which time counts.
#[must_use]
pub const fn clock(clock: Clock) -> &'static str {
    match clock {
        Clock::Header => "of the headers",
        Clock::Recording => "of the recording",
    }
}

/// Which axes of the messages are those of the profiles, and their unit.
#[must_use]
pub fn axes(axes: ProfileAxes, unit: LengthUnit) -> String {
    format!("x and z of the profiles are {} and {} of the messages, in {}", axes.x, axes.z, unit.symbol())
}

/// A frame as it is offered: with the one that it hangs below.
#[must_use]
pub fn frame_choice(frame: &ListedFrame) -> String {
    match &frame.parent {
        Some(parent) if frame.is_static => format!("{} (fixed in {parent})", frame.name),
        Some(parent) => format!("{} (in {parent})", frame.name),
        None => frame.name.clone(),
    }
}

/// The frame that poses are in by their headers.
#[must_use]
pub fn pose_frame(frame: &str) -> String {
    if frame.is_empty() { "poses name no frame".to_owned() } else { format!("poses are in {frame}") }
}

/// The type without the package, which all messages of a kind share.
#[must_use]
pub fn short_type(type_name: &str) -> &str {
    type_name.rsplit('/').next().unwrap_or(type_name)
}

/// A time of the recording in seconds from its beginning.
#[must_use]
pub fn seconds(time_ns: i64, start_ns: i64) -> String {
    #[expect(clippy::cast_precision_loss, reason = "shown to a tenth of a second")]
    let seconds = time_ns.saturating_sub(start_ns) as f64 / 1e9;
    format!("{seconds:.1}")
}

/// What will come of a bag.
#[must_use]
pub fn will_become(report: &BagReport, num_stations: usize, num_captures: usize) -> String {
    let what = if report.profile_topic.is_some() { (report.num_paired, "pair") } else { (report.num_poses, "pose") };
    let pairs = count(what.0, what.1);
    format!("{pairs} → {}, {}", count(num_stations, "station"), count(num_captures, "capture"))
}

/// What a topic gives.
#[must_use]
pub const fn gives(kind: Option<MessageKind>) -> &'static str {
    match kind {
        Some(MessageKind::Pose) => "poses",
        Some(MessageKind::Transforms) => "frames, from which poses",
        Some(MessageKind::LaserScan | MessageKind::PointCloud) => "profiles",
        None => "not read",
    }
}

/// The same in a table, and whether it is in use.
#[must_use]
pub fn gives_in_table(kind: Option<MessageKind>, is_in_use: bool) -> String {
    let gives = if kind == Some(MessageKind::Transforms) { "frames" } else { gives(kind) };
    if is_in_use { format!("{gives}, in use") } else { gives.to_owned() }
}

/// A topic in a line.
fn topic_line(topic: &Topic, start_ns: Option<i64>) -> String {
    let Topic { name, type_name, kind, num_messages, .. } = topic;
    let times = topic.recorded_ns.zip(start_ns).map_or_else(String::new, |([first, last], start_ns)| {
        format!("  {} to {} s", seconds(first, start_ns), seconds(last, start_ns))
    });
    format!("  {name}  {type_name}  {num_messages}{times}  {}\n", gives(*kind))
}

/// The topics of a bag.
#[must_use]
pub fn topics(name: &str, bag: &Bag) -> String {
    let lines: String = bag.topics.iter().map(|topic| topic_line(topic, bag.start_ns())).collect();
    format!("{name}: {}\n{lines}", count(bag.topics.len(), "topic"))
}

/// What became of the messages of a bag.
#[must_use]
pub fn report(report: &BagReport) -> String {
    let frames = report.frames.as_ref().map(|[base, flange]| format!(", {flange} in {base}")).unwrap_or_default();
    let mut said = vec![format!("{} from {}{frames}", count(report.num_poses, "pose"), report.pose_topic)];
    if let Some(num_stays) = report.num_stays {
        said.push(format!("the robot stood still {}", times(num_stays)));
    }
    if report.num_sweeps > 0 {
        let (stays, sweeps) = (count(report.num_joined_stays, "stay"), count(report.num_sweeps, "sweep"));
        said.push(format!("{stays} along lines joined into {sweeps}"));
    }
    if let Some(topic) = &report.profile_topic {
        said.push(format!("{} from {topic}, {} paired", count(report.num_profiles, "profile"), report.num_paired));
    }
    let mut left_out = Vec::new();
    if report.num_of_same_time > 0 {
        let poses = count(report.num_of_same_time, "pose");
        left_out
            .push(format!("{poses} at the time of another: where headers stand still, use the times of the recording"));
    }
    if report.num_contradicting > 0 {
        let transforms = count(report.num_contradicting, "transform");
        left_out.push(format!("{transforms} of a frame that had another parent, or that both moves and is static"));
    }
    if report.num_in_gaps > 0 {
        let poses = count(report.num_in_gaps, "pose");
        left_out.push(format!("{poses} at times around which a frame between the two was not sent"));
    }
    if report.num_moving > 0 {
        left_out.push(format!("{} taken while the robot moved", count(report.num_moving, "profile")));
    }
    if report.num_without_pose > 0 {
        let nearest = match report.nearest_pose_ms {
            // A clock that is off by more than a day is another clock.
            Some(ms) if ms > 86_400_000 => {
                "; the clocks of poses and profiles differ: use the times of the recording".to_owned()
            }
            Some(ms) => format!("; the nearest is {ms} ms away"),
            None => String::new(),
        };
        left_out.push(format!("{} without a pose in reach{nearest}", count(report.num_without_pose, "profile")));
    }
    if report.num_stays_without_profile > 0 {
        left_out.push(format!("{} without a profile", count(report.num_stays_without_profile, "stay")));
    }
    if report.num_beyond > 0 {
        left_out.push(format!("{} beyond what is kept: cut the bag into parts", count(report.num_beyond, "message")));
    }
    for unreadable in &report.unreadable {
        let messages = count(unreadable.num_messages, "message");
        left_out.push(format!("{messages} of {} that could not be read ({})", unreadable.topic, unreadable.first));
    }
    let mut sentence = said.join("; ");
    if !left_out.is_empty() {
        sentence.push_str(". Left out: ");
        sentence.push_str(&left_out.join("; "));
    }
    let cut_short = report.cut_short.iter().map(|(file, damage)| {
        format!(
            ". {file} is damaged or was cut off ({damage}): what stands before was read; \
             mend it with `mcap recover` or `ros2 bag reindex`, or record it again"
        )
    });
    sentence.extend(cut_short);
    sentence
}

fn times(number: usize) -> String {
    match number {
        1 => "once".to_owned(),
        number => format!("{number} times"),
    }
}
