//! A bag with its options to stations: poses first, then the profiles that belong to them.

use std::borrow::Cow;
use std::sync::Arc;

use crate::geometry::notation::{LengthUnit, OrientationForm};
use crate::geometry::{PoseNotation, Profile};
use crate::session::Reading;
use crate::session::import::gather::{Gathered, RawPose};
use crate::session::import::program::{MAX_PREVIEW_ROWS, head, show};
use crate::session::import::read::Progress;
use crate::session::import::{ImportError, ImportOptions, MAX_POSES, Preview, Role};
use crate::watch::Cancelled;

use super::cdr::BadMessage;
use super::frames::Frames;
use super::line;
use super::messages::{self, MessageKind, Points, TimedPose};
use super::settle::{Standing, Stillness, longest_gap_ns, pose_at, still};
use super::storage::{self, RawMessage};
use super::sweeps::{Straightness, sweeps};
use super::{Bag, BagError, BagOptions, BagReport, Clock, ProfileAxes, Taking, Topic, Unreadable};

/// Poses that are kept: at 500 Hz an hour and a half.
const MAX_BAG_POSES: usize = 3_000_000;
/// Points of profiles that are kept.
const MAX_POINTS: usize = 16_000_000;
/// Profiles of one stay that are kept for their median.
const MAX_OF_A_STAY: usize = 25;
/// Numbers of the preview are rounded to a part of this: a tenth of a micrometre in metres. What is read is not.
const SHOWN: f64 = 1e7;
/// Captures that follow each other within this are of one station, degrees: a sweep keeps its orientation.
const ONE_ORIENTATION_DEG: f64 = 0.5;
/// A robot that steps along a line keeps to it and to its orientation within these.
const STRAIGHT_WITHIN_MM: f64 = 0.2;
const STRAIGHT_WITHIN_DEG: f64 = 0.1;
/// Where a cloud does not say its unit, coordinates that all lie within are metres.
const MAX_METRES: f64 = 5.0;
/// Messages after which it is asked whether to go on.
const TICK_EVERY: usize = 256;
const NS_PER_MS: f64 = 1e6;

/// Reads a bag; fills in what was recognised.
pub(in crate::session::import) fn read(
    name: &str,
    bag: &Bag,
    options: &mut ImportOptions,
    fallback: &PoseNotation,
    gathered: &mut Gathered,
    preview: &mut Preview,
    progress: &mut Progress<'_>,
) -> Result<BagReport, ImportError> {
    let mut reader = Reader { name, bag, report: BagReport::default(), progress, num_messages: 0, num_expected: 0 };
    for (wanted, poses) in [(&options.bag.pose_topic, true), (&options.bag.profile_topic, false)] {
        let topic = reader.topic(wanted.as_deref(), poses)?;
        reader.num_expected += topic.map_or(0, |topic| usize::try_from(topic.num_messages).unwrap_or_default());
    }
    let said = options.notation.unwrap_or(PoseNotation { length_unit: LengthUnit::Metres, ..*fallback });
    // However poses are written elsewhere, messages have quaternions.
    let notation = PoseNotation { orientation: OrientationForm::QuaternionXyzw, ..said };
    gathered.set_notation(notation, options.base_from_user_frame, None);
    options.notation = Some(notation);

    let poses = reader.poses(&mut options.bag)?;
    let stillness = Stillness {
        for_ns: ns(options.bag.still_for_s * 1e3),
        within: options.bag.still_within_mm / notation.length_unit.in_mm(),
        within_rad: options.bag.still_within_deg.to_radians(),
        gap_ns: longest_gap_ns(&poses, ns(options.bag.pair_within_ms)),
    };
    let stays: Vec<Stay> = match options.bag.taking {
        Some(Taking::EveryProfile) => Vec::new(),
        _ => still(&poses, &stillness, &mut || reader.tick())?
            .into_iter()
            .map(|Standing { range, pose }| Stay {
                from_ns: poses[range.start].time_ns,
                to_ns: poses[range.end - 1].time_ns,
                pose,
                readings: Vec::new(),
            })
            .collect(),
    };
    // A robot that never stands still was scanning, or recorded a pose only where it measured.
    let recognised = if stays.is_empty() { Taking::EveryProfile } else { Taking::SettledMedian };
    let taking = *options.bag.taking.get_or_insert(recognised);
    let mut captures = Captures::new(taking, stays);
    reader.profiles(options, &poses, &mut captures)?;
    let mut report = reader.report;
    let taken = captures.finish(&poses, &mut report);

    head(preview, gathered.notation());
    preview.header.push("points".to_owned());
    preview.roles.push(Role::Ignore);
    let station_of = stations(&taken, taking, options.bag.joins_stays, notation.length_unit, &mut report);
    for (idx, (Taken { pose, profile }, station)) in taken.into_iter().zip(station_of).enumerate() {
        let label = (station + 1).to_string();
        let [x, y, z] = pose.translation.into();
        let [i, j, k, w] = pose.rotation.coords.into();
        let numbers = [x, y, z, i, j, k, w];
        if preview.rows.len() < MAX_PREVIEW_ROWS {
            show(preview, idx + 1, &label, &numbers.map(|number| (number * SHOWN).round() / SHOWN));
            if let Some((_, cells)) = preview.rows.last_mut() {
                cells.push(profile.as_ref().map_or(0, |profile| profile.valid_points().count()).to_string());
            }
        } else {
            preview.num_rows += 1;
        }
        let before = gathered.num_poses();
        let raw = RawPose {
            at: (idx + 1, 1),
            label: Some(Cow::Owned(label)),
            numbers: &numbers,
            may_continue: true,
            ..RawPose::default()
        };
        gathered.take(name, &raw);
        if let Some(profile) = profile.filter(|_| gathered.num_poses() > before) {
            gathered.set_last_reading(Reading::Profile(Arc::new(profile)));
        }
    }
    Ok(report)
}

/// Which station each capture is of.
fn stations(
    taken: &[Taken],
    taking: Taking,
    joins_stays: bool,
    unit: LengthUnit,
    report: &mut BagReport,
) -> Vec<usize> {
    let mut station_of = Vec::with_capacity(taken.len());
    if taking == Taking::EveryProfile {
        let mut station = 0;
        let mut first: Option<TimedPose> = None;
        for Taken { pose, .. } in taken {
            let turn = first.map(|first| first.rotation.angle_to(&pose.rotation));
            if turn.is_some_and(|turn| turn > ONE_ORIENTATION_DEG.to_radians()) {
                station += 1;
                first = None;
            }
            first.get_or_insert(*pose);
            station_of.push(station);
        }
        return station_of;
    }
    if !joins_stays {
        return (0..taken.len()).collect();
    }
    let poses: Vec<TimedPose> = taken.iter().map(|taken| taken.pose).collect();
    let straightness =
        Straightness { within: STRAIGHT_WITHIN_MM / unit.in_mm(), within_rad: STRAIGHT_WITHIN_DEG.to_radians() };
    for (station, sweep) in sweeps(&poses, &straightness).into_iter().enumerate() {
        if sweep.len() > 1 {
            report.num_sweeps += 1;
            report.num_joined_stays += sweep.len();
        }
        station_of.extend(sweep.map(|_| station));
    }
    station_of
}

#[expect(clippy::cast_possible_truncation, reason = "durations of minutes; beyond, it is cut off at the longest")]
fn ns(ms: f64) -> i64 {
    (ms * NS_PER_MS) as i64
}

/// A stay of the robot, and the profiles in it.
struct Stay {
    from_ns: i64,
    to_ns: i64,
    pose: TimedPose,
    readings: Vec<(i64, Profile)>,
}

/// A pose with its profile.
struct Taken {
    pose: TimedPose,
    profile: Option<Profile>,
}

/// What is gathered of the profiles.
struct Captures {
    taking: Taking,
    stays: Vec<Stay>,
    singles: Vec<(i64, TimedPose, Profile)>,
    num_points: usize,
}

impl Captures {
    const fn new(taking: Taking, stays: Vec<Stay>) -> Self {
        Self { taking, stays, singles: Vec::new(), num_points: 0 }
    }

    /// The stay at a time.
    fn stay_at(&mut self, time_ns: i64) -> Option<&mut Stay> {
        let behind = self.stays.partition_point(|stay| stay.from_ns <= time_ns);
        self.stays.get_mut(behind.checked_sub(1)?).filter(|stay| time_ns <= stay.to_ns)
    }

    /// Takes a profile, if there is a pose for it and room.
    fn take(
        &mut self,
        time_ns: i64,
        poses: &[TimedPose],
        tolerance_ns: i64,
        report: &mut BagReport,
        profile: impl FnOnce() -> Result<Profile, BadMessage>,
    ) -> Result<(), BadMessage> {
        let taking = self.taking;
        let is_full = self.num_points >= MAX_POINTS;
        if taking != Taking::EveryProfile
            && let Some(stay) = self.stay_at(time_ns)
        {
            report.num_paired += 1;
            let limit = if taking == Taking::SettledFirst { 1 } else { MAX_OF_A_STAY };
            let is_earlier = stay.readings.first().is_some_and(|(first, _)| time_ns < *first);
            if is_full || (stay.readings.len() >= limit && !is_earlier) {
                report.num_beyond += usize::from(is_full && stay.readings.is_empty());
                return Ok(());
            }
            let profile = profile()?;
            let num_points = profile.len();
            if stay.readings.len() >= limit {
                stay.readings.pop();
            }
            let at = stay.readings.partition_point(|(other, _)| *other <= time_ns);
            stay.readings.insert(at, (time_ns, profile));
            self.num_points += num_points;
            return Ok(());
        }
        match pose_at(poses, time_ns, tolerance_ns) {
            Ok(_) if taking != Taking::EveryProfile => report.num_moving += 1,
            Ok(_) if is_full || self.singles.len() >= MAX_POSES => report.num_beyond += 1,
            Ok(pose) => {
                let profile = profile()?;
                report.num_paired += 1;
                self.num_points += profile.len();
                self.singles.push((time_ns, pose, profile));
            }
            Err(nearest_ns) => {
                report.num_without_pose += 1;
                let nearest_ms = nearest_ns.map(|ns| ns / 1_000_000);
                report.nearest_pose_ms = report.nearest_pose_ms.into_iter().chain(nearest_ms).min();
            }
        }
        Ok(())
    }

    /// The captures in the order of time.
    fn finish(mut self, poses: &[TimedPose], report: &mut BagReport) -> Vec<Taken> {
        let has_profiles = report.profile_topic.is_some();
        if self.taking == Taking::EveryProfile {
            if !has_profiles {
                report.num_beyond += poses.len().saturating_sub(MAX_POSES);
                return poses.iter().take(MAX_POSES).map(|pose| Taken { pose: *pose, profile: None }).collect();
            }
            self.singles.sort_by_key(|(time_ns, _, _)| *time_ns);
            let singles = self.singles.into_iter();
            return singles.map(|(_, pose, profile)| Taken { pose, profile: Some(profile) }).collect();
        }
        report.num_stays = Some(self.stays.len());
        let num_stays = self.stays.len();
        let stays = self.stays.into_iter().filter(|stay| !has_profiles || !stay.readings.is_empty());
        let taken: Vec<Taken> = stays
            .map(|stay| {
                let profiles: Vec<Profile> = stay.readings.into_iter().map(|(_, profile)| profile).collect();
                Taken { pose: stay.pose, profile: (!profiles.is_empty()).then(|| line::median(profiles)) }
            })
            .collect();
        report.num_stays_without_profile = num_stays - taken.len();
        taken
    }
}

/// Reading along a bag.
struct Reader<'r, 'w> {
    name: &'r str,
    bag: &'r Bag,
    report: BagReport,
    progress: &'r mut Progress<'w>,
    num_messages: usize,
    /// Of the topics that are read, as far as that is known beforehand.
    num_expected: usize,
}

impl Reader<'_, '_> {
    /// Asks whether to go on.
    fn tick(&mut self) -> Result<(), Cancelled> {
        self.progress.tick_within(self.num_messages, self.num_expected)
    }

    fn error(&self, found: String, needed: &str, remedy: &str) -> ImportError {
        let (needed, remedy) = (needed.to_owned(), remedy.to_owned());
        ImportError::Bag(BagError { file: self.name.to_owned(), found, needed, remedy })
    }

    /// The topic that was asked for, else the one with the most messages, of the first kind that there is.
    fn topic(&self, wanted: Option<&str>, poses: bool) -> Result<Option<Topic>, ImportError> {
        let Some(wanted) = wanted else {
            let rank = |topic: &&Topic| (topic.kind != Some(MessageKind::Transforms), topic.num_messages);
            let candidates = self.bag.topics_with(poses).filter(|topic| topic.num_messages > 0);
            // Static frames alone are no poses of a robot.
            let candidates = candidates.filter(|topic| !is_static(&topic.name));
            // Of equals the first by name.
            let best = candidates.fold(None, |best: Option<&Topic>, topic| {
                if best.is_none_or(|best| rank(&topic) > rank(&best)) { Some(topic) } else { best }
            });
            return Ok(best.cloned());
        };
        let found = self.bag.topics_with(poses).find(|topic| topic.name == wanted);
        found.cloned().map(Some).ok_or_else(|| {
            let names: Vec<&str> = self.bag.topics_with(poses).map(|topic| topic.name.as_str()).collect();
            let needed = match (names.is_empty(), poses) {
                (true, true) => "a topic of PoseStamped or TFMessage".to_owned(),
                (true, false) => "a topic of LaserScan or PointCloud2".to_owned(),
                (false, _) => names.join(" or "),
            };
            self.error(format!("no such topic as {wanted}"), &needed, "choose one of the topics that the bag lists")
        })
    }

    /// Streams the messages of some topics.
    fn each(
        &mut self,
        topics: &[&Topic],
        is_first: bool,
        take: &mut dyn FnMut(&mut BagReport, RawMessage<'_>) -> Result<(), BadMessage>,
    ) -> Result<(), ImportError> {
        for (path, storage) in &self.bag.files {
            let wanted = |name: &str, type_name: &str| {
                topics.iter().position(|topic| topic.name == name && topic.type_name == type_name)
            };
            let (report, num_messages, progress) = (&mut self.report, &mut self.num_messages, &mut *self.progress);
            let num_expected = self.num_expected;
            let damage = storage::stream(path, *storage, &wanted, &mut |message| {
                *num_messages += 1;
                if num_messages.is_multiple_of(TICK_EVERY) {
                    progress.tick_within(*num_messages, num_expected)?;
                }
                if let Err(bad) = take(report, message) {
                    let topic = topics.get(message.topic_idx).map_or("", |topic| topic.name.as_str());
                    match report.unreadable.iter_mut().find(|unreadable| unreadable.topic == topic) {
                        Some(unreadable) => unreadable.num_messages += 1,
                        None => report.unreadable.push(Unreadable {
                            topic: topic.to_owned(),
                            num_messages: 1,
                            first: bad.to_string(),
                        }),
                    }
                }
                Ok(())
            })?;
            // Both readings of a file end at the same place.
            if let Some(damage) = damage.filter(|_| is_first) {
                let file = path.file_name().map_or_else(|| self.name.into(), |name| name.to_string_lossy());
                self.report.cut_short.push((file.into_owned(), damage));
            }
        }
        Ok(())
    }

    /// The poses of the flange, ascending in time.
    fn poses(&mut self, options: &mut BagOptions) -> Result<Vec<TimedPose>, ImportError> {
        let has_header = options.clock == Clock::Header;
        let Some(topic) = self.topic(options.pose_topic.as_deref(), true)? else {
            let found = match self.bag.topics.as_slice() {
                [] => "no topics".to_owned(),
                topics => {
                    const MAX_NAMED: usize = 6;
                    let named =
                        topics.iter().take(MAX_NAMED).map(|topic| format!("{} ({})", topic.name, topic.type_name));
                    format!("only {}", named.collect::<Vec<_>>().join(", "))
                }
            };
            let needed = "a topic of geometry_msgs/msg/PoseStamped or tf2_msgs/msg/TFMessage in CDR";
            return Err(self.error(found, needed, "record the robot's pose together with the profiles"));
        };
        options.pose_topic = Some(topic.name.clone());
        self.report.pose_topic.clone_from(&topic.name);
        let mut poses: Vec<TimedPose> = Vec::new();
        if topic.kind == Some(MessageKind::Pose) {
            self.each(&[&topic], true, &mut |report, message| {
                if poses.len() >= MAX_BAG_POSES {
                    report.num_beyond += 1;
                    return Ok(());
                }
                let (frame, pose) = messages::pose_stamped(message.data, message.log_time_ns, has_header)?;
                report.pose_frame.get_or_insert(frame);
                poses.push(pose);
                Ok(())
            })?;
            poses.sort_by_key(|pose| pose.time_ns);
            let num_sent = poses.len();
            poses.dedup_by_key(|pose| pose.time_ns);
            self.report.num_of_same_time = num_sent - poses.len();
        } else {
            poses = self.poses_of_frames(&topic, options, has_header)?;
        }
        self.report.num_poses = poses.len();
        if poses.is_empty() {
            let found = match self.report.unreadable.first() {
                Some(unreadable) => format!("no readable pose on {} ({})", topic.name, unreadable.first),
                None if self.report.num_in_gaps > 0 => {
                    format!("no time on {} around which every frame of the chain was sent", topic.name)
                }
                None => format!("no pose on {}", topic.name),
            };
            return Err(self.error(found, "poses of the robot", "choose another topic, or record again"));
        }
        Ok(poses)
    }

    fn poses_of_frames(
        &mut self,
        topic: &Topic,
        options: &mut BagOptions,
        has_header: bool,
    ) -> Result<Vec<TimedPose>, ImportError> {
        let bag = self.bag;
        let topics = frames_with(&bag.topics, &topic.name);
        let mut frames = Frames::default();
        self.each(&topics, true, &mut |report, message| {
            let is_static = topics.get(message.topic_idx).is_some_and(|topic| is_static(&topic.name));
            for transform in messages::transforms(message.data, message.log_time_ns, has_header)? {
                report.num_beyond += usize::from(!frames.add(transform, is_static));
            }
            Ok(())
        })?;
        frames.sort();
        self.report.listed_frames = frames.listed();
        (self.report.num_contradicting, self.report.num_of_same_time) =
            (frames.num_contradicting, frames.num_of_same_time);
        let base = options.base_frame.clone().or_else(|| frames.likely_base());
        let flange = options.flange_frame.clone().or_else(|| frames.likely_flange());
        let (Some(base), Some(flange)) = (base, flange) else {
            let needed = "frames that move with the robot";
            return Err(self.error("no frames".to_owned(), needed, "choose another topic of poses, or record again"));
        };
        let remedy = || format!("name the two frames (--base-frame, --flange-frame); there are {}", listed(&frames));
        if let Some(unknown) = [&base, &flange].into_iter().find(|frame| !frames.names().contains(frame)) {
            return Err(self.error(format!("no frame {unknown}"), "a frame of the bag", &remedy()));
        }
        let (poses, num_in_gaps) = frames
            .base_from_flange(&base, &flange, ns(options.pair_within_ms))
            .map_err(|(found, needed)| self.error(found, &needed, &remedy()))?;
        self.report.num_in_gaps = num_in_gaps;
        self.report.frames = Some([base.clone(), flange.clone()]);
        (options.base_frame, options.flange_frame) = (Some(base), Some(flange));
        Ok(poses)
    }

    fn profiles(
        &mut self,
        options: &mut ImportOptions,
        poses: &[TimedPose],
        captures: &mut Captures,
    ) -> Result<(), ImportError> {
        let Some(topic) = self.topic(options.bag.profile_topic.as_deref(), false)? else { return Ok(()) };
        options.bag.profile_topic = Some(topic.name.clone());
        self.report.profile_topic = Some(topic.name.clone());
        let tolerance_ns = ns(options.bag.pair_within_ms);
        let clock = options.bag.clock;
        let mut axes: Option<ProfileAxes> = options.bag.axes;
        let mut unit: Option<LengthUnit> = options.profile_length_unit;
        let z_sign = if options.is_z_mirrored { -1.0 } else { 1.0 };
        self.each(&[&topic], false, &mut |report, message| {
            let points: Points = match topic.kind {
                Some(MessageKind::LaserScan) => messages::laser_scan(message.data)?,
                _ => messages::point_cloud(message.data)?,
            };
            let spreads = line::spreads(&points);
            if let Some(spreads) = spreads {
                if axes.is_none() {
                    axes = Some(line::detect(spreads)?);
                }
                let is_metres = topic.kind == Some(MessageKind::LaserScan) || line::largest(&points) <= MAX_METRES;
                unit.get_or_insert(if is_metres { LengthUnit::Metres } else { LengthUnit::Millimetres });
            }
            let time_ns = points.stamp_ns.filter(|_| clock == Clock::Header).unwrap_or(message.log_time_ns);
            report.num_profiles += 1;
            captures.take(time_ns, poses, tolerance_ns, report, || {
                match (axes, unit) {
                    (Some(axes), Some(unit)) => line::profile(&points, axes, unit.in_mm(), z_sign),
                    // What the axes and the unit are cannot be told before a line was seen.
                    _ if points.has_any() => Err(BadMessage::Value {
                        found: "too few points to tell the axes and the unit".to_owned(),
                        needed: "a line in an earlier reading; or name the axes and the unit",
                    }),
                    _ => Ok(Profile::default()),
                }
            })
        })?;
        options.bag.axes = axes;
        options.profile_length_unit = unit;
        Ok(())
    }
}

/// The topic that was chosen, and those with the frames that never change of the same robot, or of all robots.
fn frames_with<'t>(topics: &'t [Topic], chosen: &str) -> Vec<&'t Topic> {
    let namespace = chosen.rsplit_once('/').map_or("", |(namespace, _)| namespace);
    let belongs = |name: &str| name == chosen || name == "/tf_static" || name == format!("{namespace}/tf_static");
    topics.iter().filter(|topic| topic.kind == Some(MessageKind::Transforms) && belongs(&topic.name)).collect()
}

/// Where frames are sent that never change.
fn is_static(topic: &str) -> bool {
    topic.ends_with("tf_static")
}

/// The names of frames, for a message.
fn listed(frames: &Frames) -> String {
    const MAX_NAMED: usize = 12;
    let names = frames.names();
    let more = if names.len() > MAX_NAMED { ", …" } else { "" };
    format!("{}{more}", names[..names.len().min(MAX_NAMED)].join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_another_robot_are_not_mixed_in() {
        let names = ["/r1/tf", "/r1/tf_static", "/r2/tf", "/r2/tf_static", "/tf", "/tf_static"];
        let topics = names.map(|name| Topic {
            name: name.to_owned(),
            type_name: "tf2_msgs/msg/TFMessage".to_owned(),
            kind: Some(MessageKind::Transforms),
            num_messages: 1,
            recorded_ns: None,
        });
        let with = |chosen: &str| -> Vec<&str> {
            frames_with(&topics, chosen).into_iter().map(|topic| topic.name.as_str()).collect()
        };
        assert_eq!(with("/r1/tf"), ["/r1/tf", "/r1/tf_static", "/tf_static"]);
        assert_eq!(with("/tf"), ["/tf", "/tf_static"]);
    }
}
