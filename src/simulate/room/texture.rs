//! What surfaces look like: patches and noise of many sizes, filtered to the width that a pixel sees of them.

use crate::scene::Random;

/// Side of the lattice of random values, a power of two; patterns repeat after so many patches.
const LATTICE_SIDE: usize = 256;
/// Keeps coordinates in patches above zero, so that they can be cut to whole numbers.
const POSITIVE: f64 = 65_536.0;

/// Random values at whole coordinates, shared by all patterns.
#[derive(Clone, Debug)]
pub(super) struct Lattice(Vec<f32>);

impl Lattice {
    pub fn new(random: &mut Random) -> Self {
        Self((0..LATTICE_SIDE * LATTICE_SIDE).map(|_| f32::from(random.byte()) / 127.5 - 1.0).collect())
    }

    fn at(&self, column: usize, row: usize) -> f32 {
        self.0[(row % LATTICE_SIDE) * LATTICE_SIDE + column % LATTICE_SIDE]
    }

    /// Patches of constant value about the whole coordinates, seen through a box of `width` patches; −1 to 1.
    ///
    /// A box is exact as long as it covers two patches at most. A width of 1 is plain interpolation, and so smooth noise.
    fn patches(&self, at: [f64; 2], width: [f32; 2]) -> f32 {
        let (column, right) = neighbours(at[0], width[0]);
        let (row, below) = neighbours(at[1], width[1]);
        let upper = self.at(column, row) * (1.0 - right) + self.at(column + 1, row) * right;
        let lower = self.at(column, row + 1) * (1.0 - right) + self.at(column + 1, row + 1) * right;
        upper * (1.0 - below) + lower * below
    }
}

/// The patch before a coordinate, and how much the box shows of the next.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "coordinates are positive and below 2^31")]
fn neighbours(at: f64, width: f32) -> (usize, f32) {
    let before = at as u32;
    let between = (at - f64::from(before)) as f32;
    (before as usize, ((between - 0.5) / width + 0.5).clamp(0.0, 1.0))
}

/// One pattern of a surface.
#[derive(Clone, Debug)]
struct Pattern {
    /// Patches in a millimetre, along the turned axes.
    patches_per_mm: f64,
    /// The turn: cosine and sine.
    turn: [f64; 2],
    /// Where in the lattice it begins.
    offset: [f64; 2],
    /// Whether its patches have borders; otherwise they flow into each other.
    has_borders: bool,
    /// What it adds to the colour.
    tint: [f32; 3],
}

impl Pattern {
    fn new(patch_mm: f64, strength: f64, has_borders: bool, random: &mut Random) -> Self {
        // By a half-angle's tangent: exact wherever it is computed.
        let half = random.signed_unit();
        let turn = [(1.0 - half * half) / (1.0 + half * half), 2.0 * half / (1.0 + half * half)];
        Self {
            patches_per_mm: 1.0 / patch_mm,
            turn,
            offset: [POSITIVE + 256.0 * random.unit(), POSITIVE + 256.0 * random.unit()],
            has_borders,
            tint: [0; 3].map(|_| narrow(strength * (0.75 + 0.25 * random.signed_unit()))),
        }
    }

    /// Adds what a box of `width_mm` about a place shows.
    fn add(&self, lattice: &Lattice, place: &Place, color: &mut [f32; 3]) {
        let [cos, sin] = self.turn;
        let [u, v] = place.at_mm;
        let [width_u, width_v] = place.width_mm;
        let scale = self.patches_per_mm;
        let width = [
            narrow((cos.abs() * width_u + sin.abs() * width_v) * scale),
            narrow((sin.abs() * width_u + cos.abs() * width_v) * scale),
        ];
        // What is finer than the box averages out; noise sooner, as the interpolation does not see the box.
        let wider = width[0].max(width[1]);
        let left = if self.has_borders { 2.0 - wider } else { 2.0 - 2.0 * wider }.clamp(0.0, 1.0);
        if left <= 0.0 {
            return;
        }
        let at = [(cos * u + sin * v) * scale + self.offset[0], (cos * v - sin * u) * scale + self.offset[1]];
        let width = if self.has_borders { width.map(|width| width.clamp(1e-3, 1.0)) } else { [1.0; 2] };
        let value = left * lattice.patches(at, width);
        for (channel, tint) in color.iter_mut().zip(self.tint) {
            *channel += value * tint;
        }
    }
}

/// A sheet of strong marks on a surface.
#[derive(Clone, Debug)]
struct Poster {
    centre_mm: [f64; 2],
    half_mm: [f64; 2],
    marks: Pattern,
}

impl Poster {
    /// How much of the box is covered.
    fn coverage(&self, place: &Place) -> f32 {
        let along = |axis: usize| {
            let inside_mm = self.half_mm[axis] - (place.at_mm[axis] - self.centre_mm[axis]).abs();
            (inside_mm / place.width_mm[axis] + 0.5).clamp(0.0, 1.0)
        };
        narrow(along(0) * along(1))
    }
}

/// A place of a surface, and how wide a field about it is seen, by a pixel for one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub at_mm: [f64; 2],
    pub width_mm: [f64; 2],
}

/// The look of a surface.
#[derive(Clone, Debug)]
pub(super) struct Material {
    base: [f32; 3],
    patterns: Vec<Pattern>,
    posters: Vec<Poster>,
}

impl Material {
    /// Patterns from the size of a cupboard to that of a grain of sand, so that there is something to follow at every distance.
    pub fn patterned(random: &mut Random) -> Self {
        const PATTERNS: [(f64, f64, bool); 8] = [
            (850.0, 0.10, false),
            (290.0, 0.10, true),
            (130.0, 0.10, false),
            (61.0, 0.12, true),
            (27.0, 0.10, true),
            (12.0, 0.10, false),
            (5.3, 0.09, true),
            (2.1, 0.08, false),
        ];
        Self {
            base: [0; 3].map(|_| narrow(0.55 + 0.12 * random.signed_unit())),
            patterns: PATTERNS
                .iter()
                .map(|(patch_mm, strength, has_borders)| {
                    Pattern::new(patch_mm * (1.0 + 0.15 * random.signed_unit()), *strength, *has_borders, random)
                })
                .collect(),
            posters: Vec::new(),
        }
    }

    /// The same with posters within a field of the surface.
    pub fn with_posters(mut self, num_posters: usize, field: &Place, random: &mut Random) -> Self {
        for _ in 0..num_posters {
            let half_mm = [140.0 + 160.0 * random.unit(), 140.0 + 160.0 * random.unit()];
            let centre_mm = [0, 1].map(|axis| {
                let play_mm = 0.5 * field.width_mm[axis] - half_mm[axis];
                field.at_mm[axis] + play_mm.max(0.0) * random.signed_unit()
            });
            let marks = Pattern::new(35.0 + 40.0 * random.unit(), 0.42, true, random);
            self.posters.push(Poster { centre_mm, half_mm, marks });
        }
        self
    }

    /// One colour everywhere.
    pub fn plain() -> Self {
        Self { base: [0.7; 3], patterns: Vec::new(), posters: Vec::new() }
    }

    /// The share of the light that comes back, by channel; about 0 to 1.
    pub fn albedo(&self, lattice: &Lattice, place: &Place) -> [f32; 3] {
        let mut color = self.base;
        for pattern in &self.patterns {
            pattern.add(lattice, place, &mut color);
        }
        for poster in &self.posters {
            let coverage = poster.coverage(place);
            if coverage > 0.0 {
                let mut sheet = [0.5; 3];
                poster.marks.add(lattice, place, &mut sheet);
                for (channel, sheet) in color.iter_mut().zip(sheet) {
                    *channel += coverage * (sheet - *channel);
                }
            }
        }
        color
    }
}

/// Colours need no more than single precision.
#[expect(clippy::cast_possible_truncation, reason = "colours need no more")]
pub(super) const fn narrow(value: f64) -> f32 {
    value as f32
}
