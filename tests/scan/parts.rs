//! Parts of known size, and a sensor that scans them: rays against surfaces, so that nothing here knows how they are measured.

use std::sync::Arc;

use handeye::geometry::{Base, Flange, Profile, Sensor, Transform, Vec3};
use handeye::scan::ScanCapture;
use nalgebra::{UnitQuaternion, Vector3};

/// A seeded source of normally distributed numbers (splitmix64, sums of twelve).
pub struct Noise(pub u64);

impl Noise {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from(u32::try_from((bits ^ (bits >> 31)) >> 32).expect("32 bits")) / f64::from(u32::MAX)
    }

    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    pub fn normal3(&mut self) -> Vec3 {
        Vec3::new(self.normal(), self.normal(), self.normal())
    }
}

/// A surface: how far along a ray it is first met.
pub type Surface = Box<dyn Fn(Vec3, Vec3) -> Option<f64>>;

/// A rectangle: a corner and two sides.
pub fn rectangle(corner: Vec3, a: Vec3, b: Vec3) -> Surface {
    let normal = a.cross(&b);
    Box::new(move |from, along| {
        let slope = normal.dot(&along);
        let distance = normal.dot(&(corner - from)) / slope;
        let at = from + along * distance - corner;
        let is_inside = |side: &Vec3| (0.0..=1.0).contains(&(at.dot(side) / side.norm_squared()));
        (slope.abs() > 1e-12 && is_inside(&a) && is_inside(&b)).then_some(distance)
    })
}

/// A ball; with an axis a cylinder.
pub fn round(centre: Vec3, axis: Option<Vec3>, radius: f64) -> Surface {
    let across = move |v: Vec3| axis.map_or(v, |axis: Vec3| v - axis * axis.dot(&v));
    Box::new(move |from, along| {
        let (away, along) = (across(from - centre), across(along));
        let (a, b, c) = (along.norm_squared(), along.dot(&away), away.norm_squared() - radius * radius);
        let root = b * b - a * c;
        (root > 0.0).then(|| (-b - root.sqrt()) / a)
    })
}

/// A row of teeth along x, ridges along y, from the origin: triangles of a pitch and height, cut off at a part of the height.
pub fn teeth(num: u8, pitch: f64, height: f64, cut: f64, length: f64) -> Vec<Surface> {
    let ridge = Vec3::y() * length;
    (0..num)
        .flat_map(|tooth| {
            let at = |place: f64, up: f64| Vec3::new((f64::from(tooth) + place) * pitch, 0.0, up * height);
            let half = cut / 2.0;
            let sides = [
                (at(0.0, 0.0), at(half, cut)),
                (at(1.0 - half, cut), at(1.0, 0.0)),
                (at(half, cut), at(1.0 - half, cut)),
            ];
            sides.into_iter().filter(|(a, b)| (b - a).norm() > 1e-9).map(move |(a, b)| rectangle(a, b - a, ridge))
        })
        .collect()
}

/// How a part is scanned.
pub struct Path {
    /// Where the sensor's middle looks first and last.
    pub from: Vec3,
    pub to: Vec3,
    /// Where the sensor looks.
    pub looks_along: Vec3,
    /// The direction of the laser line.
    pub line_along: Vec3,
    pub num_profiles: u16,
    pub num_points: u16,
    pub width: f64,
    pub profile_std: f64,
    pub pose_std: f64,
}

impl Path {
    pub fn over(from: Vec3, to: Vec3, looks_along: Vec3, line_along: Vec3) -> Self {
        let (num_profiles, num_points) = (120, 400);
        Self {
            from,
            to,
            looks_along,
            line_along,
            num_profiles,
            num_points,
            width: 60.0,
            profile_std: 0.02,
            pose_std: 0.02,
        }
    }
}

/// Of an ordinary mounting.
pub fn flange_from_sensor() -> Transform<Flange, Sensor> {
    Transform::from_parts(Vec3::new(-7.8, 123.9, -79.4), UnitQuaternion::from_euler_angles(0.3, -0.2, 1.1))
}

/// Scans: poses as the robot reports them, with its noise.
pub fn scan(surfaces: &[Surface], path: &Path, seed: u64) -> Vec<ScanCapture> {
    const DISTANCE: f64 = 150.0;
    let mut noise = Noise(seed);
    let z = path.looks_along.normalize();
    let x = (path.line_along - z * z.dot(&path.line_along)).normalize();
    let rotation = nalgebra::Rotation3::from_basis_unchecked(&[x, z.cross(&x), z]);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    (0..path.num_profiles)
        .map(|number| {
            let part = f64::from(number) / f64::from(path.num_profiles - 1);
            let middle = path.from + (path.to - path.from) * part;
            let base_from_sensor = Transform::<Base, Sensor>::from_parts(middle - z * DISTANCE, rotation);
            let xs: Vec<f64> = (0..path.num_points)
                .map(|idx| path.width * (f64::from(idx) / f64::from(path.num_points - 1) - 0.5))
                .collect();
            let zs: Vec<Option<f64>> = xs
                .iter()
                .map(|x| {
                    let from = base_from_sensor.map_point(Vector3::new(*x, 0.0, 0.0));
                    let hits = surfaces.iter().filter_map(|surface| surface(from, z)).filter(|hit| *hit > 0.0);
                    let hit = hits.min_by(f64::total_cmp)?;
                    Some(hit + path.profile_std * noise.normal())
                })
                .collect();
            let mut base_from_flange = base_from_sensor * flange_from_sensor().inverse();
            let shift = noise.normal3() * path.pose_std;
            base_from_flange =
                Transform::from_parts(base_from_flange.translation_mm() + shift, base_from_flange.rotation());
            ScanCapture { base_from_flange, profile: Arc::new(Profile::new(xs, &zs).expect("valid")) }
        })
        .collect()
}
