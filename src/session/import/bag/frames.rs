//! Frames that were sent around as transforms: from any number of them to the pose of one in another over time.

use std::collections::HashMap;

use super::messages::{TimedPose, TimedTransform};

/// Transforms that are kept; a robot that sends six of them 500 times a second fills it in a quarter of an hour.
const MAX_TRANSFORMS: usize = 3_000_000;
/// Between two transforms that are at most so many times as far apart as poses and profiles may be, a frame is believed
/// to have moved steadily.
pub(super) const MAX_GAP: u32 = 4;
/// Frames between a frame and the root; more are a circle.
const MAX_DEPTH: usize = 64;

/// Names of the frame that a robot's poses are in, the likeliest first.
const BASES: [&str; 4] = ["base_link", "base", "robot_base", "world"];
/// Names of the frame that they are of: the first is what controllers call tool 0.
const FLANGES: [&str; 4] = ["tool0", "flange", "ee_link", "tcp"];

/// A frame in its parent, over time.
#[derive(Debug)]
struct Edge {
    parent: String,
    is_static: bool,
    /// Ascending in time once [`Frames::sort`] was called.
    parent_from_child: Vec<TimedPose>,
}

/// A frame as it is listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListedFrame {
    /// Its name.
    pub name: String,
    /// The frame that it hangs below; none for a root.
    pub parent: Option<String>,
    /// Whether it never moves in that.
    pub is_static: bool,
}

/// All frames of a bag.
#[derive(Debug, Default)]
pub(super) struct Frames {
    /// By the child's name.
    edges: HashMap<String, Edge>,
    num_transforms: usize,
    /// Transforms that hang a frame below another parent than before, or fix one that moves: passed over.
    pub num_contradicting: usize,
    /// Transforms at a time at which the frame was sent already: passed over.
    pub num_of_same_time: usize,
}

impl Frames {
    /// Keeps a transform; answers whether there was room. One that contradicts others is passed over.
    pub fn add(&mut self, transform: TimedTransform, is_static: bool) -> bool {
        let TimedTransform { parent, child, parent_from_child } = transform;
        let edge = self.edges.entry(child).or_insert_with(|| Edge {
            parent: parent.clone(),
            is_static,
            parent_from_child: Vec::new(),
        });
        if edge.parent != parent || (is_static && !edge.is_static) {
            self.num_contradicting += 1;
            return true;
        }
        if !is_static && self.num_transforms >= MAX_TRANSFORMS {
            return false;
        }
        if edge.is_static {
            // A static frame that is sent again is the same frame; one that moves after all was never fixed.
            self.num_contradicting += if is_static { 0 } else { edge.parent_from_child.len() };
            edge.parent_from_child.clear();
            edge.is_static = is_static;
        }
        self.num_transforms += 1;
        edge.parent_from_child.push(parent_from_child);
        true
    }

    /// Brings each frame's transforms into the order of time, of equal times the first.
    pub fn sort(&mut self) {
        for edge in self.edges.values_mut() {
            let num_sent = edge.parent_from_child.len();
            edge.parent_from_child.sort_by_key(|pose| pose.time_ns);
            edge.parent_from_child.dedup_by_key(|pose| pose.time_ns);
            self.num_of_same_time += num_sent - edge.parent_from_child.len();
        }
    }

    /// Every frame's name, sorted.
    pub fn names(&self) -> Vec<String> {
        let both = self.edges.iter().flat_map(|(child, edge)| [child, &edge.parent]);
        let mut names: Vec<String> = both.cloned().collect();
        names.sort();
        names.dedup();
        names
    }

    /// Every frame with its parent, by name.
    pub fn listed(&self) -> Vec<ListedFrame> {
        let listed = |name: String| {
            let edge = self.edges.get(&name);
            let parent = edge.map(|edge| edge.parent.clone());
            ListedFrame { name, parent, is_static: edge.is_some_and(|edge| edge.is_static) }
        };
        self.names().into_iter().map(listed).collect()
    }

    /// The likeliest frame of the base: by its name, else a frame without a parent.
    pub fn likely_base(&self) -> Option<String> {
        self.named(&BASES).or_else(|| self.names().into_iter().find(|name| !self.edges.contains_key(name)))
    }

    /// The likeliest frame of the flange: by its name, else the end of the longest chain that moves.
    pub fn likely_flange(&self) -> Option<String> {
        self.named(&FLANGES).or_else(|| {
            let moving = |name: &String| self.edges.get(name).is_some_and(|edge| !edge.is_static);
            self.names().into_iter().filter(moving).max_by_key(|name| self.ancestors(name).len())
        })
    }

    /// The frame with the first of these names that there is, with or without something before it (`ur10_tool0`).
    fn named(&self, wanted: &[&str]) -> Option<String> {
        let names = self.names();
        wanted.iter().find_map(|wanted| {
            let exact = names.iter().find(|name| name.as_str() == *wanted);
            exact.or_else(|| names.iter().find(|name| name.ends_with(&format!("_{wanted}")))).cloned()
        })
    }

    /// The frame and all above it.
    fn ancestors(&self, frame: &str) -> Vec<String> {
        let mut ancestors = vec![frame.to_owned()];
        let mut frame = frame;
        while let Some(edge) = self.edges.get(frame).filter(|_| ancestors.len() < MAX_DEPTH) {
            frame = &edge.parent;
            ancestors.push(frame.to_owned());
        }
        ancestors
    }

    /// The flange in the base, at every time at which a frame between them was sent; and how many of these times are left
    /// out because another frame was not sent for too long.
    ///
    /// # Errors
    /// What is wrong with the two frames: `found …, needed …`.
    pub fn base_from_flange(
        &self,
        base: &str,
        flange: &str,
        tolerance_ns: i64,
    ) -> Result<(Vec<TimedPose>, usize), (String, String)> {
        let (above_base, above_flange) = (self.ancestors(base), self.ancestors(flange));
        let common = above_flange.iter().find(|frame| above_base.contains(frame)).ok_or_else(|| {
            let roots = [&above_base, &above_flange].map(|above| above.last().cloned().unwrap_or_default());
            (
                format!("{base} below {} and {flange} below {}, which are not connected", roots[0], roots[1]),
                "two frames of one tree".to_owned(),
            )
        })?;
        let chain = |above: &[String]| -> Vec<&Edge> {
            above.iter().take_while(|frame| *frame != common).filter_map(|frame| self.edges.get(frame)).collect()
        };
        let (to_base, to_flange) = (chain(&above_base), chain(&above_flange));
        let moving: Vec<&Edge> = to_base.iter().chain(&to_flange).copied().filter(|edge| !edge.is_static).collect();
        let first = moving.iter().filter_map(|edge| Some(edge.parent_from_child.first()?.time_ns)).max();
        let last = moving.iter().filter_map(|edge| Some(edge.parent_from_child.last()?.time_ns)).min();
        let (Some(first), Some(last)) = (first, last) else {
            return Err((
                format!("no frame between {base} and {flange} that was sent more than once"),
                "a chain of frames that moves with the robot".to_owned(),
            ));
        };
        let mut times: Vec<i64> = moving
            .iter()
            .flat_map(|edge| edge.parent_from_child.iter().map(|pose| pose.time_ns))
            .filter(|time_ns| (first..=last).contains(time_ns))
            .collect();
        times.sort_unstable();
        times.dedup();
        let mut to_base: Vec<Walker<'_>> = to_base.into_iter().map(Walker::new).collect();
        let mut to_flange: Vec<Walker<'_>> = to_flange.into_iter().map(Walker::new).collect();
        let pose = |walkers: &mut [Walker<'_>], time_ns: i64| -> Option<TimedPose> {
            let mut pose = TimedPose { time_ns, ..TimedPose::identity() };
            // From the frame upwards: each parent stands to the left.
            for walker in walkers {
                pose = walker.at(time_ns, tolerance_ns.unsigned_abs())?.then(&pose);
            }
            Some(pose)
        };
        let num_times = times.len();
        let poses: Vec<TimedPose> = times
            .into_iter()
            .filter_map(|time_ns| Some(pose(&mut to_base, time_ns)?.inverse().then(&pose(&mut to_flange, time_ns)?)))
            .collect();
        let num_in_gaps = num_times - poses.len();
        Ok((poses, num_in_gaps))
    }
}

/// Goes along an edge in the order of time.
struct Walker<'e> {
    edge: &'e Edge,
    next: usize,
}

impl<'e> Walker<'e> {
    const fn new(edge: &'e Edge) -> Self {
        Self { edge, next: 0 }
    }

    /// The frame at a time, no earlier than the last that was asked for; `None` in a gap.
    fn at(&mut self, time_ns: i64, tolerance_ns: u64) -> Option<TimedPose> {
        let poses = &self.edge.parent_from_child;
        while poses.get(self.next).is_some_and(|pose| pose.time_ns < time_ns) {
            self.next += 1;
        }
        let away = |pose: &TimedPose| pose.time_ns.abs_diff(time_ns);
        match (self.next.checked_sub(1).and_then(|before| poses.get(before)), poses.get(self.next)) {
            _ if self.edge.is_static => poses.last().map(|pose| TimedPose { time_ns, ..*pose }),
            (_, Some(now)) if now.time_ns == time_ns => Some(*now),
            (Some(before), Some(after))
                if before.time_ns.abs_diff(after.time_ns) <= tolerance_ns.saturating_mul(u64::from(MAX_GAP)) =>
            {
                Some(before.towards(after, time_ns))
            }
            (before, after) => {
                let nearest = before.into_iter().chain(after).min_by_key(|pose| away(pose));
                nearest.filter(|pose| away(pose) <= tolerance_ns).map(|pose| TimedPose { time_ns, ..*pose })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Vec3, so3};

    fn pose(time_ns: i64, x: f64, about_z: f64) -> TimedPose {
        TimedPose { time_ns, translation: Vec3::new(x, 0.0, 0.0), rotation: so3::exp(Vec3::new(0.0, 0.0, about_z)) }
    }

    fn frames(transforms: &[(&str, &str, bool, TimedPose)]) -> Frames {
        let mut frames = Frames::default();
        for (parent, child, is_static, parent_from_child) in transforms {
            let transform = TimedTransform {
                parent: (*parent).to_owned(),
                child: (*child).to_owned(),
                parent_from_child: *parent_from_child,
            };
            assert!(frames.add(transform, *is_static));
        }
        frames.sort();
        frames
    }

    #[test]
    fn the_chain_is_looked_up_over_time_with_what_lies_between() {
        let half_turn = std::f64::consts::FRAC_PI_2;
        let frames = frames(&[
            ("world", "base_link", true, pose(0, 7.0, 0.3)),
            ("base_link", "arm", false, pose(0, 1.0, 0.0)),
            ("base_link", "arm", false, pose(100, 1.0, half_turn)),
            ("arm", "tool0", false, pose(0, 2.0, 0.0)),
            ("arm", "tool0", false, pose(50, 3.0, 0.0)),
            ("arm", "tool0", false, pose(90, 3.0, 0.0)),
        ]);
        assert_eq!(frames.likely_base().as_deref(), Some("base_link"));
        assert_eq!(frames.likely_flange().as_deref(), Some("tool0"));
        let (poses, num_in_gaps) = frames.base_from_flange("base_link", "tool0", 50).expect("connected");
        assert_eq!(num_in_gaps, 0);
        // The arm goes on to 100, but of tool0 nothing is known after 90.
        assert_eq!(poses.iter().map(|pose| pose.time_ns).collect::<Vec<_>>(), [0, 50, 90]);
        let expected = Vec3::new(1.0 + 3.0 * (half_turn / 2.0).cos(), 3.0 * (half_turn / 2.0).sin(), 0.0);
        assert!((poses[1].translation - expected).norm() < 1e-12, "{:?}", poses[1]);
    }

    #[test]
    fn a_static_frame_does_not_wipe_one_that_moves_and_what_is_passed_over_is_counted() {
        let moving = [0, 100, 100].map(|time_ns| ("base", "tool0", false, pose(time_ns, 1.0, 0.0)));
        let fixed = [("base", "tool0", true, pose(0, 9.0, 0.0))];
        let other = [("table", "tool0", false, pose(50, 9.0, 0.0))];
        for order in [[&fixed[..], &moving[..], &other[..]].concat(), [&moving[..], &other[..], &fixed[..]].concat()] {
            let frames = frames(&order);
            let (poses, _) = frames.base_from_flange("base", "tool0", 50).expect("connected");
            assert_eq!(poses.iter().map(|pose| pose.translation.x).collect::<Vec<_>>(), [1.0, 1.0]);
            assert_eq!((frames.num_contradicting, frames.num_of_same_time), (2, 1));
        }
    }

    #[test]
    fn a_frame_that_was_not_sent_for_long_is_not_made_up() {
        let arm = [0, 400, 800].map(|time_ns| ("base_link", "arm", false, pose(time_ns, 0.001, 0.0)));
        // The tool is sent five times, then nothing until 800.
        let tool = [0, 100, 200, 300, 800].map(|time_ns| ("arm", "tool0", false, pose(time_ns, 1.0, 0.0)));
        let frames = frames(&[&arm[..], &tool[..]].concat());
        let at = |tolerance_ns: i64| {
            let (poses, num_in_gaps) = frames.base_from_flange("base_link", "tool0", tolerance_ns).expect("connected");
            (poses.iter().map(|pose| pose.time_ns).collect::<Vec<_>>(), num_in_gaps)
        };
        // The arm's transforms are 400 apart, and at 400 the tool's last is 100 old.
        assert_eq!(at(99), (vec![0, 800], 4));
        assert_eq!(at(100), (vec![0, 100, 200, 300, 400, 800], 0));
        assert_eq!(at(10), (vec![0, 800], 4));
    }

    #[test]
    fn frames_that_do_not_hang_together_or_go_in_a_circle_are_named() {
        let apart = frames(&[("a", "b", false, pose(0, 0.0, 0.0)), ("c", "d", false, pose(0, 0.0, 0.0))]);
        let (found, _) = apart.base_from_flange("b", "d", 50).expect_err("two trees");
        assert!(found.contains("not connected"), "{found}");
        let circle = frames(&[("a", "b", false, pose(0, 0.0, 0.0)), ("b", "a", false, pose(0, 0.0, 0.0))]);
        assert!(circle.base_from_flange("a", "b", 50).is_ok_and(|(poses, _)| poses.len() == 1));
        let rigid = frames(&[("a", "b", true, pose(0, 0.0, 0.0))]);
        assert!(rigid.base_from_flange("a", "b", 50).expect_err("rigid").1.contains("moves"));
    }
}
