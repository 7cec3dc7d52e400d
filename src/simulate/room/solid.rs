//! The shapes of the room and its furniture, and where rays meet them.
//!
//! Only sums, products, quotients and square roots: the same bits on every machine.

use super::texture::{Material, Place};

/// A point or direction in the room, mm. Plain numbers: a ray is traced for every pixel.
pub(super) type Point = [f64; 3];

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `origin + distance * direction`.
pub(super) fn along(origin: Point, distance: f64, direction: Point) -> Point {
    [0, 1, 2].map(|axis| origin[axis] + distance * direction[axis])
}

/// The faces of a shape show different parts of one pattern, so far apart.
const FACE_SHIFT_MM: f64 = 1e4;

/// A ray; its direction need not have unit length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub origin: Point,
    pub direction: Point,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    /// Its inside is seen if `is_room`, otherwise its outside.
    Block { half: Point, is_room: bool },
    /// A ball.
    Ball { radius: f64 },
    /// An upright cylinder without lids: it reaches from the floor to the ceiling.
    Column { radius: f64, half_height: f64 },
}

/// A shape that stands somewhere, turned about the vertical.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    shape: Shape,
    centre: Point,
    /// Cosine and sine of the turn.
    turn: [f64; 2],
    /// Of a ball about the centre that holds it all.
    reach: f64,
    /// One for each face, or one for all.
    materials: Vec<Material>,
}

/// What a ray met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// Unit normal, towards the side that is seen.
    pub normal: Point,
    /// Cosine of the angle between the ray and the normal, at least a little.
    pub incidence_cos: f64,
    /// Where on the surface.
    pub place: Place,
}

impl Solid {
    /// A room that is seen from inside, with a material for each face or one for all.
    pub fn room(half: Point, centre: Point, materials: Vec<Material>) -> Self {
        Self { shape: Shape::Block { half, is_room: true }, centre, turn: [1.0, 0.0], reach: f64::INFINITY, materials }
    }

    /// Turned by twice the angle whose tangent is `half_turn_tan`.
    pub fn block(half: Point, centre: Point, half_turn_tan: f64, material: Material) -> Self {
        let squared = half_turn_tan * half_turn_tan;
        let turn = [(1.0 - squared) / (1.0 + squared), 2.0 * half_turn_tan / (1.0 + squared)];
        Self {
            shape: Shape::Block { half, is_room: false },
            centre,
            turn,
            reach: dot(half, half).sqrt(),
            materials: vec![material],
        }
    }

    pub fn ball(radius: f64, centre: Point, material: Material) -> Self {
        Self { shape: Shape::Ball { radius }, centre, turn: [1.0, 0.0], reach: radius, materials: vec![material] }
    }

    pub fn column(radius: f64, half_height: f64, centre: Point, material: Material) -> Self {
        let reach = (radius * radius + half_height * half_height).sqrt();
        Self {
            shape: Shape::Column { radius, half_height },
            centre,
            turn: [1.0, 0.0],
            reach,
            materials: vec![material],
        }
    }

    /// How far along the ray, in lengths of its direction, and which face; faces are numbered for finding edges.
    pub fn meets(&self, ray: &Ray) -> Option<(f64, u8)> {
        let to_centre = minus(self.centre, ray.origin);
        let squared = dot(ray.direction, ray.direction);
        let ahead = dot(to_centre, ray.direction);
        // Whether the ray passes the ball about it all, which few do.
        if ahead < 0.0 && dot(to_centre, to_centre) > self.reach * self.reach
            || dot(to_centre, to_centre) * squared - ahead * ahead > self.reach * self.reach * squared
        {
            return None;
        }
        match self.shape {
            Shape::Block { half, is_room } => block_distance(half, is_room, &self.in_own(ray)),
            Shape::Ball { radius } => {
                let discriminant = ahead * ahead - squared * (dot(to_centre, to_centre) - radius * radius);
                let distance = (discriminant >= 0.0).then(|| (ahead - discriminant.sqrt()) / squared)?;
                let own = minus(along(ray.origin, distance, ray.direction), self.centre);
                (distance > 0.0).then(|| (distance, main_axis(own)))
            }
            Shape::Column { radius, half_height } => {
                let flat = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1];
                let (squared, ahead) = (flat(ray.direction, ray.direction), flat(to_centre, ray.direction));
                let discriminant = ahead * ahead - squared * (flat(to_centre, to_centre) - radius * radius);
                let distance = (discriminant >= 0.0).then(|| (ahead - discriminant.sqrt()) / squared)?;
                let own = minus(along(ray.origin, distance, ray.direction), self.centre);
                (distance > 0.0 && own[2].abs() <= half_height).then(|| (distance, main_axis([own[0], own[1], 0.0])))
            }
        }
    }

    /// The surface where a ray met it, seen through a pixel that is `pixel_mm` wide there across the ray.
    pub fn surface(&self, ray: &Ray, (distance, face): (f64, u8), pixel_mm: f64) -> Surface {
        /// Steeper places are filtered as if they were this steep.
        const LEAST_COS: f64 = 0.04;
        let own_ray = self.in_own(ray);
        let at = along(own_ray.origin, distance, own_ray.direction);
        let axis = usize::from(face / 2);
        let side = if face % 2 == 0 { 1.0 } else { -1.0 };
        let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
        let length = dot(ray.direction, ray.direction).sqrt();
        let (own_normal, at_mm) = match self.shape {
            Shape::Block { is_room, .. } => {
                let mut normal = [0.0; 3];
                normal[axis] = if is_room { -side } else { side };
                let shift = FACE_SHIFT_MM * f64::from(face);
                (normal, [at[first] + shift, at[second]])
            }
            // Seen from the centre onto the faces of a cube about it: no angles are needed.
            Shape::Ball { radius } => {
                let scale = radius / at[axis].abs();
                (
                    at.map(|value| value / radius),
                    [at[first] * scale + FACE_SHIFT_MM * f64::from(face), at[second] * scale],
                )
            }
            Shape::Column { radius, .. } => {
                let flat = if axis == 0 { at[1] } else { at[0] };
                let around = flat * radius / at[axis].abs();
                ([at[0] / radius, at[1] / radius, 0.0], [around + FACE_SHIFT_MM * f64::from(face), at[2]])
            }
        };
        let incidence_cos = (-dot(own_normal, own_ray.direction) / length).max(LEAST_COS);
        // Across the ray a pixel is as wide as it is, along the slope it is stretched.
        let stretch = pixel_mm / incidence_cos / length;
        let width = |axis: usize| {
            let slope = own_ray.direction[axis] + own_normal[axis] * incidence_cos * length;
            pixel_mm + stretch * slope.abs()
        };
        let width_mm = match self.shape {
            Shape::Block { .. } => [width(first), width(second)],
            Shape::Ball { .. } | Shape::Column { .. } => [pixel_mm / incidence_cos; 2],
        };
        Surface { normal: self.in_room(own_normal), incidence_cos, place: Place { at_mm, width_mm } }
    }

    /// What a face is made of.
    pub fn material(&self, face: u8) -> &Material {
        &self.materials[usize::from(face) % self.materials.len()]
    }

    /// The whole of a face of a block.
    pub fn face_of_block(half: Point, face: u8) -> Place {
        let axis = usize::from(face / 2);
        let width_mm = [2.0 * half[(axis + 1) % 3], 2.0 * half[(axis + 2) % 3]];
        Place { at_mm: [FACE_SHIFT_MM * f64::from(face), 0.0], width_mm }
    }

    /// How far a place is from the surface, found without a ray.
    #[cfg(test)]
    pub fn off_surface_mm(&self, at: Point) -> f64 {
        let own = self.in_own(&Ray { origin: at, direction: [0.0; 3] }).origin;
        let off_box = |half: Point| {
            let beyond = [0, 1, 2].map(|axis| own[axis].abs() - half[axis]);
            let outside = beyond.map(|beyond| beyond.max(0.0));
            dot(outside, outside).sqrt() + beyond.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0)
        };
        match self.shape {
            Shape::Block { half, .. } => off_box(half).abs(),
            Shape::Ball { radius } => (dot(own, own).sqrt() - radius).abs(),
            Shape::Column { radius, .. } => (own[0].hypot(own[1]) - radius).abs(),
        }
    }

    fn in_own(&self, ray: &Ray) -> Ray {
        let [cos, sin] = self.turn;
        let turned = |v: Point| [cos * v[0] + sin * v[1], cos * v[1] - sin * v[0], v[2]];
        Ray { origin: turned(minus(ray.origin, self.centre)), direction: turned(ray.direction) }
    }

    fn in_room(&self, v: Point) -> Point {
        let [cos, sin] = self.turn;
        [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]]
    }
}

/// Even for the positive side of an axis, odd for the negative.
fn face_of(axis: u8, is_positive: bool) -> u8 {
    2 * axis + u8::from(!is_positive)
}

fn main_axis(v: Point) -> u8 {
    let size = v.map(f64::abs);
    let axis = if size[0] >= size[1] && size[0] >= size[2] {
        0
    } else if size[1] >= size[2] {
        1
    } else {
        2
    };
    face_of(axis, v[usize::from(axis)] > 0.0)
}

fn block_distance(half: Point, is_room: bool, own: &Ray) -> Option<(f64, u8)> {
    let (mut enters, mut leaves) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
    for (axis, number) in [(0, 0_u8), (1, 1), (2, 2)] {
        let direction = own.direction[axis];
        if direction == 0.0 {
            if own.origin[axis].abs() > half[axis] {
                return None;
            }
            continue;
        }
        let inverse = 1.0 / direction;
        let near = (-half[axis] * direction.signum() - own.origin[axis]) * inverse;
        let far = (half[axis] * direction.signum() - own.origin[axis]) * inverse;
        if near > enters.0 {
            enters = (near, face_of(number, direction < 0.0));
        }
        if far < leaves.0 {
            leaves = (far, face_of(number, direction > 0.0));
        }
    }
    if is_room {
        return Some(leaves);
    }
    (enters.0 > 0.0 && enters.0 <= leaves.0).then_some(enters)
}
