//! The points of a scan in the base, and the way there from profiles, poses and a calibration.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread;

use crate::geometry::{Base, Flange, Profile, Sensor, Transform, Vec3};

use super::lanes::num_threads;
use super::{PointSet, ScanError};

/// One capture of a scan.
#[derive(Clone, Debug)]
pub struct ScanCapture {
    /// The pose that the controller reported; inverted for a sensor beside the robot, as everywhere in
    /// [`calibrate`](crate::calibrate).
    pub base_from_flange: Transform<Base, Flange>,
    /// What the sensor saw there.
    pub profile: Arc<Profile>,
}

/// Points in the base, profile after profile.
///
/// Coordinates are held as 32-bit offsets from an origin in their midst: over 2 m they keep 0.1 µm, at half the memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    origin_mm: Vec3,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    profile_idx: Vec<u32>,
    toward_sensor: Option<Vec3>,
}

/// Indices of points are 32 bits wide.
const MOST_POINTS: usize = u32::MAX as usize;

impl Cloud {
    /// A cloud to which points are added about an origin.
    #[must_use]
    pub fn about(origin_mm: Vec3) -> Self {
        Self { origin_mm, ..Self::default() }
    }

    /// Adds a point, mm, of a profile.
    ///
    /// # Errors
    /// [`ScanError::TooManyPoints`].
    pub fn push(&mut self, point_mm: Vec3, profile_idx: u32) -> Result<(), ScanError> {
        if self.x.len() == MOST_POINTS {
            return Err(ScanError::TooManyPoints { found: MOST_POINTS + 1, most: MOST_POINTS });
        }
        let offset = point_mm - self.origin_mm;
        self.x.push(narrow(offset.x));
        self.y.push(narrow(offset.y));
        self.z.push(narrow(offset.z));
        self.profile_idx.push(profile_idx);
        Ok(())
    }

    /// The points of a scan in the base: `base_from_flange * flange_from_sensor * (x, 0, z)`. Points without a valid range
    /// are left out.
    ///
    /// # Errors
    /// [`ScanError::NoProfiles`], [`ScanError::NoPoints`] or [`ScanError::TooManyPoints`].
    pub fn from_scan(
        captures: &[ScanCapture],
        flange_from_sensor: &Transform<Flange, Sensor>,
    ) -> Result<Self, ScanError> {
        if captures.is_empty() {
            return Err(ScanError::NoProfiles);
        }
        let base_from_sensor: Vec<Transform<Base, Sensor>> =
            captures.iter().map(|capture| capture.base_from_flange * *flange_from_sensor).collect();
        let counts = num_valid(captures);
        let num_points: usize = counts.iter().sum();
        if num_points > MOST_POINTS {
            return Err(ScanError::TooManyPoints { found: num_points, most: MOST_POINTS });
        }
        let (origin_mm, toward_sensor) =
            midst(captures, &base_from_sensor).ok_or(ScanError::NoPoints { num_profiles: captures.len() })?;
        let zeros = || vec![0.0_f32; num_points];
        let mut cloud = Self {
            origin_mm,
            x: zeros(),
            y: zeros(),
            z: zeros(),
            profile_idx: vec![0; num_points],
            toward_sensor: Some(toward_sensor),
        };
        cloud.fill(captures, &base_from_sensor, &counts);
        Ok(cloud)
    }

    fn fill(&mut self, captures: &[ScanCapture], base_from_sensor: &[Transform<Base, Sensor>], counts: &[usize]) {
        let share = self.len().div_ceil(num_threads()).max(1);
        let origin_mm = self.origin_mm;
        thread::scope(|scope| {
            let (mut x, mut y, mut z) = (&mut self.x[..], &mut self.y[..], &mut self.z[..]);
            let mut profile_idx = &mut self.profile_idx[..];
            let mut first = 0;
            while first < captures.len() {
                let mut last = first;
                let mut num = 0;
                while last < captures.len() && (num < share || num == 0) {
                    num += counts[last];
                    last += 1;
                }
                let out = Out {
                    x: x.split_off_mut(..num).unwrap_or_default(),
                    y: y.split_off_mut(..num).unwrap_or_default(),
                    z: z.split_off_mut(..num).unwrap_or_default(),
                    profile_idx: profile_idx.split_off_mut(..num).unwrap_or_default(),
                };
                let range = first..last;
                scope.spawn(move || {
                    let mut out = out;
                    for idx in range {
                        out.write(idx, &captures[idx].profile, &base_from_sensor[idx], origin_mm, counts[idx]);
                    }
                });
                first = last;
            }
        });
    }

    /// Number of points.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// What the offsets are from, mm.
    #[must_use]
    pub const fn origin_mm(&self) -> Vec3 {
        self.origin_mm
    }

    /// The coordinates x, y and z of all points from [`Self::origin_mm`], mm.
    #[must_use]
    pub fn offsets_mm(&self) -> [&[f32]; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// The profile that each point is of: its index in the scan. Never falling.
    #[must_use]
    pub fn profile_idx(&self) -> &[u32] {
        &self.profile_idx
    }

    /// A point from [`Self::origin_mm`], mm.
    #[must_use]
    pub fn offset_mm(&self, idx: usize) -> Vec3 {
        Vec3::new(f64::from(self.x[idx]), f64::from(self.y[idx]), f64::from(self.z[idx]))
    }

    /// A point in the base, mm.
    #[must_use]
    pub fn point_mm(&self, idx: usize) -> Vec3 {
        self.origin_mm + self.offset_mm(idx)
    }

    /// The direction in which the sensor was, seen from the points; not known of a cloud from elsewhere.
    #[must_use]
    pub const fn toward_sensor(&self) -> Option<Vec3> {
        self.toward_sensor
    }

    /// The least and the greatest coordinates in the base, mm; `None` without points.
    #[must_use]
    pub fn bounds_mm(&self) -> Option<[Vec3; 2]> {
        self.bounds_of_mm(&PointSet::all(self))
    }

    /// The same of some of the points.
    #[must_use]
    pub fn bounds_of_mm(&self, set: &PointSet) -> Option<[Vec3; 2]> {
        if set.is_empty() {
            return None;
        }
        let ends = |values: &[f32]| {
            set.runs().fold([f32::INFINITY, f32::NEG_INFINITY], |ends, run| {
                values[run].iter().fold(ends, |[low, high], value| [low.min(*value), high.max(*value)])
            })
        };
        let [x, y, z] = self.offsets_mm().map(ends);
        let corner = |end: usize| self.origin_mm + Vec3::new(x[end].into(), y[end].into(), z[end].into());
        Some([corner(0), corner(1)])
    }
}

/// The part of a cloud that one thread fills.
struct Out<'a> {
    x: &'a mut [f32],
    y: &'a mut [f32],
    z: &'a mut [f32],
    profile_idx: &'a mut [u32],
}

impl Out<'_> {
    /// Writes the valid points of a profile to the front of what is left.
    fn write(
        &mut self,
        idx: usize,
        profile: &Profile,
        from_sensor: &Transform<Base, Sensor>,
        origin: Vec3,
        num: usize,
    ) {
        let rotation = from_sensor.rotation().to_rotation_matrix();
        let (across, along) = (rotation.matrix().column(0).into_owned(), rotation.matrix().column(2).into_owned());
        let shift = from_sensor.translation_mm() - origin;
        let mut axes = [&mut self.x, &mut self.y, &mut self.z];
        for (axis, out) in axes.iter_mut().enumerate() {
            let Some(out) = out.split_off_mut(..num) else { return };
            let map = |x: f64, z: f64| narrow(across[axis] * x + along[axis] * z + shift[axis]);
            let pairs = profile.x_mm().iter().zip(profile.z_mm());
            if num == profile.len() {
                for (out, (x, z)) in out.iter_mut().zip(pairs) {
                    *out = map(*x, *z);
                }
            } else {
                for (out, (x, z)) in out.iter_mut().zip(pairs.filter(|(_, z)| !z.is_nan())) {
                    *out = map(*x, *z);
                }
            }
        }
        if let Some(out) = self.profile_idx.split_off_mut(..num) {
            out.fill(u32::try_from(idx).unwrap_or(u32::MAX));
        }
    }
}

fn num_valid(captures: &[ScanCapture]) -> Vec<usize> {
    let count = |captures: &[ScanCapture]| -> Vec<usize> {
        captures.iter().map(|capture| capture.profile.z_mm().iter().filter(|z| !z.is_nan()).count()).collect()
    };
    let share = captures.len().div_ceil(num_threads());
    thread::scope(|scope| {
        let parts: Vec<_> = captures.chunks(share).map(|part| scope.spawn(move || count(part))).collect();
        parts.into_iter().flat_map(|part| part.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}

/// A point in the midst of a scan, mm, and the direction from there to the sensor; `None` without any point.
fn midst(captures: &[ScanCapture], base_from_sensor: &[Transform<Base, Sensor>]) -> Option<(Vec3, Vec3)> {
    let (mut sum, mut sensors, mut count) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    for (capture, base_from_sensor) in captures.iter().zip(base_from_sensor) {
        let middle = capture.profile.len() / 2;
        let valid = |(_, x, z): (usize, f64, f64)| base_from_sensor.map_point(Vec3::new(x, 0.0, z));
        let found = capture.profile.valid_points().find(|(idx, _, _)| *idx >= middle);
        if let Some(point) = found.or_else(|| capture.profile.valid_points().last()).map(valid) {
            sum += point;
            sensors += base_from_sensor.translation_mm();
            count += 1.0;
        }
    }
    let to_sensor = (sensors - sum).try_normalize(0.0).unwrap_or_else(Vec3::z);
    (count > 0.0).then(|| (sum / count, to_sensor))
}

/// To the 32 bits in which offsets are held.
#[expect(clippy::cast_possible_truncation, reason = "a cloud's offsets are 32 bits wide, see its description")]
pub(super) const fn narrow(offset_mm: f64) -> f32 {
    offset_mm as f32
}
