//! The messages that hold poses and profiles: `PoseStamped`, `TFMessage`, `LaserScan`, `PointCloud2`.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::geometry::Vec3;
use crate::geometry::notation::QUATERNION_NORM_TOLERANCE;

use super::cdr::{BadMessage, Cdr};

/// What a topic's messages are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageKind {
    /// `geometry_msgs/msg/PoseStamped`.
    Pose,
    /// `tf2_msgs/msg/TFMessage`.
    Transforms,
    /// `sensor_msgs/msg/LaserScan`.
    LaserScan,
    /// `sensor_msgs/msg/PointCloud2`.
    PointCloud,
}

impl MessageKind {
    /// By the name of the message type; `None` for those that hold neither poses nor profiles.
    #[must_use]
    pub fn of_type(name: &str) -> Option<Self> {
        match name {
            "geometry_msgs/msg/PoseStamped" => Some(Self::Pose),
            "tf2_msgs/msg/TFMessage" => Some(Self::Transforms),
            "sensor_msgs/msg/LaserScan" => Some(Self::LaserScan),
            "sensor_msgs/msg/PointCloud2" => Some(Self::PointCloud),
            _ => None,
        }
    }

    /// Whether it is where poses come from.
    #[must_use]
    pub const fn has_poses(self) -> bool {
        matches!(self, Self::Pose | Self::Transforms)
    }

    /// Whether it is where profiles come from.
    #[must_use]
    pub const fn has_profiles(self) -> bool {
        !self.has_poses()
    }
}

/// A pose at a time; lengths as the message has them, which is metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimedPose {
    pub time_ns: i64,
    pub translation: Vec3,
    pub rotation: UnitQuaternion<f64>,
}

/// A frame in its parent.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TimedTransform {
    pub parent: String,
    pub child: String,
    pub parent_from_child: TimedPose,
}

/// The points of a reading; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Points {
    /// As the header says; `None` where it says nothing.
    pub stamp_ns: Option<i64>,
    pub points: Vec<[f64; 3]>,
}

impl Points {
    /// Whether any is there.
    pub fn has_any(&self) -> bool {
        self.points.iter().any(|point| point.iter().all(|value| value.is_finite()))
    }
}

/// Nanoseconds of a header; 0 is no time.
fn stamp(cdr: &mut Cdr<'_>) -> Result<Option<i64>, BadMessage> {
    let (seconds, nanoseconds) = (cdr.i32()?, cdr.u32()?);
    let stamp_ns = i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds);
    Ok((stamp_ns != 0).then_some(stamp_ns))
}

fn finite(value: f64, what: &'static str) -> Result<f64, BadMessage> {
    if value.is_finite() { Ok(value) } else { Err(BadMessage::Value { found: value.to_string(), needed: what }) }
}

/// Position, then the quaternion with the real part last.
fn pose(cdr: &mut Cdr<'_>, time_ns: i64) -> Result<TimedPose, BadMessage> {
    let mut numbers = [0.0; 7];
    for number in &mut numbers {
        *number = finite(cdr.f64()?, "a finite number in a pose")?;
    }
    let [x, y, z, i, j, k, w] = numbers;
    let quaternion = Quaternion::new(w, i, j, k);
    if (quaternion.norm() - 1.0).abs() > QUATERNION_NORM_TOLERANCE {
        let found = format!("a quaternion of norm {:.4}", quaternion.norm());
        return Err(BadMessage::Value { found, needed: "norm 1" });
    }
    Ok(TimedPose { time_ns, translation: Vec3::new(x, y, z), rotation: UnitQuaternion::new_normalize(quaternion) })
}

/// A `PoseStamped` with the frame that it is in; where its header has no time that of the recording counts.
pub(super) fn pose_stamped(message: &[u8], log_time_ns: i64, header: bool) -> Result<(String, TimedPose), BadMessage> {
    let mut cdr = Cdr::new(message)?;
    let stamp_ns = stamp(&mut cdr)?.filter(|_| header);
    let frame = frame_name(&cdr.string()?);
    Ok((frame, pose(&mut cdr, stamp_ns.unwrap_or(log_time_ns))?))
}

/// The transforms of a `TFMessage`.
pub(super) fn transforms(message: &[u8], log_time_ns: i64, header: bool) -> Result<Vec<TimedTransform>, BadMessage> {
    /// Two times, two texts, seven numbers.
    const MIN_BYTES: usize = 8 + 4 + 4 + 56;
    let mut cdr = Cdr::new(message)?;
    let count = cdr.count(MIN_BYTES)?;
    let mut transforms = Vec::with_capacity(count);
    for _ in 0..count {
        let stamp_ns = stamp(&mut cdr)?.filter(|_| header);
        let parent = frame_name(&cdr.string()?);
        let child = frame_name(&cdr.string()?);
        let parent_from_child = pose(&mut cdr, stamp_ns.unwrap_or(log_time_ns))?;
        transforms.push(TimedTransform { parent, child, parent_from_child });
    }
    Ok(transforms)
}

/// Old writers put a slash before names of frames.
fn frame_name(name: &str) -> String {
    name.trim_start_matches('/').to_owned()
}

/// A `LaserScan` as points in its frame: x ahead, y to the left, z = 0.
pub(super) fn laser_scan(message: &[u8]) -> Result<Points, BadMessage> {
    let mut cdr = Cdr::new(message)?;
    let stamp_ns = stamp(&mut cdr)?;
    cdr.string()?;
    let mut head = [0.0; 7];
    for number in &mut head {
        *number = f64::from(cdr.f32()?);
    }
    let [angle_min, _, step, _, _, range_min, range_max] = head;
    for angle in [angle_min, step] {
        finite(angle, "a finite angle")?;
    }
    let count = cdr.count(4)?;
    let mut points = Vec::with_capacity(count);
    for idx in 0..count {
        let range = f64::from(cdr.f32()?);
        // A scan has thousands of rays, not 2⁵³.
        #[expect(clippy::cast_precision_loss, reason = "see above")]
        let angle = step.mul_add(idx as f64, angle_min);
        // Drivers write 0 where nothing came back, also where they leave the limits at 0.
        let is_valid =
            range.is_finite() && range > 0.0 && range >= range_min && !(range > range_max && range_max > 0.0);
        points.push(if is_valid { [range * angle.cos(), range * angle.sin(), 0.0] } else { [f64::NAN; 3] });
    }
    Ok(Points { stamp_ns, points })
}

/// Points of a cloud; a line has thousands.
const MAX_POINTS_OF_A_CLOUD: usize = 16_000_000;

/// Where a coordinate stands in a point of a cloud.
#[derive(Clone, Copy, Debug)]
struct Field {
    offset: usize,
    is_double: bool,
}

/// The points of a `PointCloud2` row after row.
pub(super) fn point_cloud(message: &[u8]) -> Result<Points, BadMessage> {
    /// A name, an offset, a type and a count.
    const MIN_FIELD_BYTES: usize = 4 + 4 + 1 + 4;
    const FLOAT32: u8 = 7;
    const FLOAT64: u8 = 8;
    let mut cdr = Cdr::new(message)?;
    let stamp_ns = stamp(&mut cdr)?;
    cdr.string()?;
    let (height, width) = (cdr.u32()? as usize, cdr.u32()? as usize);
    let mut fields = [None; 3];
    for _ in 0..cdr.count(MIN_FIELD_BYTES)? {
        let name = cdr.string()?;
        let (offset, datatype) = (cdr.u32()? as usize, cdr.u8()?);
        cdr.u32()?;
        let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == name) else { continue };
        match datatype {
            FLOAT32 | FLOAT64 => fields[axis] = Some(Field { offset, is_double: datatype == FLOAT64 }),
            other => {
                let found = format!("field {name} of type {other}");
                return Err(BadMessage::Value { found, needed: "x, y and z of type 7 (float32) or 8 (float64)" });
            }
        }
    }
    let [Some(x), Some(y), Some(z)] = fields else {
        return Err(BadMessage::Value { found: "a cloud without x, y or z".to_owned(), needed: "all three fields" });
    };
    let is_big_endian = cdr.u8()? != 0;
    let (point_step, row_step) = (cdr.u32()? as usize, cdr.u32()? as usize);
    let count = cdr.count(1)?;
    let data = cdr.bytes(count)?;
    let layout = |found: String| BadMessage::Value { found, needed: "rows of points that lie within the data" };
    let ends = [x, y, z].map(|field| field.offset.saturating_add(if field.is_double { 8 } else { 4 }));
    let row_bytes = width.checked_mul(point_step).filter(|bytes| *bytes <= row_step);
    let all_bytes = row_step.checked_mul(height).filter(|bytes| *bytes <= data.len());
    if ends.iter().any(|end| *end > point_step) || row_bytes.is_none() || all_bytes.is_none() {
        return Err(layout(format!(
            "{height} rows of {row_step} bytes with {width} points of {point_step} bytes each in {} bytes",
            data.len()
        )));
    }
    let mut order: Vec<(usize, usize)> = [x, y, z].iter().map(|field| field.offset).zip(ends).collect();
    order.sort_unstable();
    if order.windows(2).any(|pair| pair[0].1 > pair[1].0) {
        return Err(layout(format!("x, y and z that overlap, at {}, {} and {}", x.offset, y.offset, z.offset)));
    }
    let num_points = width.saturating_mul(height);
    if num_points > MAX_POINTS_OF_A_CLOUD {
        return Err(BadMessage::Value { found: format!("{num_points} points"), needed: "no more than 16 million" });
    }
    let read = |point: &[u8], field: Field| -> f64 {
        let bytes = point.get(field.offset..).unwrap_or_default();
        if field.is_double {
            let number = bytes.first_chunk::<8>().copied().unwrap_or([0xff; 8]);
            if is_big_endian { f64::from_be_bytes(number) } else { f64::from_le_bytes(number) }
        } else {
            let number = bytes.first_chunk::<4>().copied().unwrap_or([0xff; 4]);
            f64::from(if is_big_endian { f32::from_be_bytes(number) } else { f32::from_le_bytes(number) })
        }
    };
    // No more points than there are bytes: every point has at least twelve.
    let mut points = Vec::with_capacity(num_points);
    for row in data.chunks_exact(row_step.max(1)).take(height) {
        points.extend(row.chunks_exact(point_step).take(width).map(|point| {
            let point = [x, y, z].map(|field| read(point, field));
            // Clouds that are to have no NaN have the origin where nothing was seen.
            if point.iter().all(|value| *value == 0.0) { [f64::NAN; 3] } else { point }
        }));
    }
    Ok(Points { stamp_ns, points })
}
