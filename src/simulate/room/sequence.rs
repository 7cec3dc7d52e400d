//! A recording in the room, frame by frame.

use std::ops::Range;

use crate::geometry::{Sensor, Transform, Vec3, World, so3};
use crate::odometry::{Intrinsics, RgbdCamera, RgbdFrame};
use crate::scene::{Random, rounded};
use crate::session::sequence::TimedFlange;

use super::noise::CameraNoise;
use super::path::{Arm, Carrier, Path, written};
use super::render::Light;
use super::{Room, color_image, depth_image, stream};

/// Something that odometry has to notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoomFault {
    /// The light is off.
    Dark,
    /// Nothing but a wall of one colour.
    BlankWall,
    /// No depth anywhere.
    BlankDepth,
    /// The camera moves between two frames as far as otherwise in one and a half seconds.
    Jump,
    /// The images stay what they were.
    Frozen,
}

impl RoomFault {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Dark, Self::BlankWall, Self::BlankDepth, Self::Jump, Self::Frozen];

    /// As it is asked for.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Dark => "dark",
            Self::BlankWall => "blank-wall",
            Self::BlankDepth => "blank-depth",
            Self::Jump => "jump",
            Self::Frozen => "frozen",
        }
    }

    /// The fault of an [`Self::id`].
    #[must_use]
    pub fn by_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fault| fault.id() == id)
    }
}

/// What is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct RoomOptions {
    /// The same seed gives the same recording.
    pub seed: u64,
    /// Number of frames.
    pub num_frames: usize,
    /// Frames a second.
    pub frames_per_s: f64,
    /// The cameras.
    pub camera: RgbdCamera,
    /// What carries them.
    pub carrier: Carrier,
    /// Whether it stands still every now and then.
    pub has_stops: bool,
    /// The cameras' noise.
    pub noise: CameraNoise,
    /// How long the shutter is open, s: images of a moving camera are smeared. 0 for sharp ones.
    pub exposure_s: f64,
    /// Standard deviation of each coordinate of a reported flange position, mm.
    pub position_std_mm: f64,
    /// Standard deviation of a reported flange orientation about each axis, degrees.
    pub orientation_std_deg: f64,
    /// How far the robot's clock is ahead of the camera's, s.
    pub robot_clock_ahead_s: f64,
    /// What goes wrong, and in which frames.
    pub faults: Vec<(RoomFault, Range<usize>)>,
}

impl Default for RoomOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            num_frames: 120,
            frames_per_s: 30.0,
            camera: kinect(640, 480),
            carrier: Carrier::default(),
            has_stops: false,
            noise: CameraNoise::KINECT,
            exposure_s: 0.0,
            position_std_mm: 0.02,
            orientation_std_deg: 0.005,
            robot_clock_ahead_s: 0.0,
            faults: Vec::new(),
        }
    }
}

/// The cameras of a Kinect with images of another size.
#[must_use]
pub fn kinect(width: u32, height: u32) -> RgbdCamera {
    let [columns, rows] = [width, height].map(f64::from);
    let intrinsics = |focal_px: f64, off_px: [f64; 2]| Intrinsics {
        width,
        height,
        fx: focal_px * columns / 640.0,
        fy: focal_px * columns / 640.0,
        cx: 0.5 * (columns - 1.0) + off_px[0] * columns / 640.0,
        cy: 0.5 * (rows - 1.0) + off_px[1] * columns / 640.0,
    };
    RgbdCamera {
        color: intrinsics(525.0, [2.5, -4.0]),
        depth: intrinsics(580.0, [-3.0, 3.5]),
        color_from_depth: written(&Transform::from_parts(
            Vec3::new(-25.1, 0.3, -0.8),
            so3::exp(Vec3::new(0.004, -0.006, 0.002)),
        )),
        depth_units_per_m: 5000.0,
    }
}

/// What was recorded at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct RoomFrame {
    /// The images.
    pub images: RgbdFrame,
    /// Where the colour camera truly was.
    pub world_from_sensor: Transform<World, Sensor>,
    /// What the robot reported, and when by its own clock, s; where there is one.
    pub flange: Option<TimedFlange>,
}

/// A recording; an iterator of its frames, which are rendered one at a time.
#[derive(Clone, Debug)]
pub struct RoomRecording {
    options: RoomOptions,
    room: Room,
    blank: Room,
    path: Path,
    arm: Arm,
    next_idx: usize,
    /// The images before, for those that freeze.
    last: Option<RgbdFrame>,
}

impl RoomRecording {
    /// Prepares the recording.
    #[must_use]
    pub fn new(options: RoomOptions) -> Self {
        let path = Path::new(options.carrier, options.has_stops, options.seed);
        Self {
            room: Room::new(options.seed),
            blank: Room::blank(),
            path,
            arm: Arm::new(),
            next_idx: 0,
            last: None,
            options,
        }
    }

    /// What is recorded.
    #[must_use]
    pub const fn options(&self) -> &RoomOptions {
        &self.options
    }

    /// Where the robot stands and how the camera is truly mounted on it, where there is one.
    #[must_use]
    pub fn arm(&self) -> Option<&Arm> {
        (self.options.carrier == Carrier::Robot).then_some(&self.arm)
    }

    fn has(&self, fault: RoomFault, idx: usize) -> bool {
        self.options.faults.iter().any(|(other, frames)| *other == fault && frames.contains(&idx))
    }

    /// The time on the path, which a jump puts forward.
    fn path_time_s(&self, idx: usize) -> f64 {
        const JUMP_S: f64 = 1.5;
        let is_past = |(fault, frames): &&(RoomFault, Range<usize>)| *fault == RoomFault::Jump && frames.start <= idx;
        self.time_s(idx) + JUMP_S * whole(self.options.faults.iter().filter(is_past).count())
    }

    fn time_s(&self, idx: usize) -> f64 {
        rounded(whole(idx) / self.options.frames_per_s, Some(6))
    }

    fn images(&self, idx: usize) -> RgbdFrame {
        let RoomOptions { camera, noise, .. } = &self.options;
        let room = if self.has(RoomFault::BlankWall, idx) { &self.blank } else { &self.room };
        let path_time_s = self.path_time_s(idx);
        let world_from_sensor = self.path.world_from_sensor(path_time_s);
        let random = |stream: u64| {
            Random::new(self.options.seed, stream.wrapping_add(stream::FRAME.wrapping_mul(idx as u64 + 1)))
        };
        let mut light = self.smeared(room, path_time_s);
        let time_s = self.time_s(idx);
        let wander = (0.45 * time_s + self.path.start_angle()).sin();
        let lamp = if self.has(RoomFault::Dark, idx) { 0.02 } else { 1.0 };
        let exposure = lamp * (1.0 + rounded(noise.exposure_change * wander, Some(4)));
        let bands_per_s = 7.3;
        let color = &mut random(stream::COLOR);
        noise.expose(&mut light, camera.color.width as usize, exposure, bands_per_s * time_s, color);
        let z_mm = if self.has(RoomFault::BlankDepth, idx) {
            vec![0.0; camera.depth.width as usize * camera.depth.height as usize]
        } else {
            let range = room.range(&camera.depth, &(world_from_sensor * camera.color_from_depth));
            noise.depth.measure(&range, camera.depth.width as usize, camera.depth.fx, &mut random(stream::DEPTH))
        };
        RgbdFrame { time_s, color: color_image(camera, &light), depth: depth_image(camera, &z_mm) }
    }

    /// The mean over the time that the shutter is open.
    fn smeared(&self, room: &Room, path_time_s: f64) -> Light {
        const NUM_PARTS: u32 = 8;
        let RoomOptions { camera, exposure_s, .. } = &self.options;
        if *exposure_s <= 0.0 {
            return room.light(&camera.color, &self.path.world_from_sensor(path_time_s));
        }
        let part = |idx: u32| {
            let share = (f64::from(idx) + 0.5) / f64::from(NUM_PARTS) - 0.5;
            room.light(&camera.color, &self.path.world_from_sensor(path_time_s + exposure_s * share))
        };
        let Light(mut sum) = part(0);
        for idx in 1..NUM_PARTS {
            let Light(light) = part(idx);
            for (sum, light) in sum.iter_mut().flatten().zip(light.iter().flatten()) {
                *sum += light;
            }
        }
        sum.iter_mut().flatten().for_each(|sum| *sum /= 8.0);
        Light(sum)
    }

    fn reported(&self, idx: usize, world_from_sensor: &Transform<World, Sensor>) -> TimedFlange {
        let mut random =
            Random::new(self.options.seed, stream::POSE.wrapping_add(stream::FRAME.wrapping_mul(idx as u64 + 1)));
        let exact = self.arm.base_from_flange(world_from_sensor);
        let shift_mm = random.normal3() * self.options.position_std_mm;
        let turn = random.normal3() * self.options.orientation_std_deg.to_radians();
        let noisy = Transform::from_parts(exact.translation_mm() + shift_mm, exact.rotation() * so3::exp(turn));
        let time_s = rounded(self.time_s(idx) + self.options.robot_clock_ahead_s, Some(6));
        TimedFlange { time_s, base_from_flange: written(&noisy) }
    }
}

impl Iterator for RoomRecording {
    type Item = RoomFrame;

    fn next(&mut self) -> Option<RoomFrame> {
        let idx = self.next_idx;
        if idx >= self.options.num_frames {
            return None;
        }
        self.next_idx += 1;
        let world_from_sensor = self.path.world_from_sensor(self.path_time_s(idx));
        let images = match &self.last {
            Some(last) if self.has(RoomFault::Frozen, idx) => RgbdFrame { time_s: self.time_s(idx), ..last.clone() },
            _ => self.images(idx),
        };
        if self.has(RoomFault::Frozen, idx + 1) {
            self.last = Some(images.clone());
        }
        let flange = (self.options.carrier == Carrier::Robot).then(|| self.reported(idx, &world_from_sensor));
        Some(RoomFrame { images, world_from_sensor, flange })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.options.num_frames - self.next_idx;
        (left, Some(left))
    }
}

impl ExactSizeIterator for RoomRecording {}

#[expect(clippy::cast_precision_loss, reason = "a recording has far fewer than 2^52 frames")]
fn whole(idx: usize) -> f64 {
    idx as f64
}
