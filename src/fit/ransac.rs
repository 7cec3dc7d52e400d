//! Seeded random search for a circle among points of which most may belong to something else.

use crate::geometry::stats::SplitMix;

use super::{Circle, windows};

/// Hypotheses tried. With an arc over a fifth of the profile one in eight is clean, so 96 miss it once in 10⁵ times.
const HYPOTHESES: usize = 96;
/// Points that a hypothesis is scored on.
const SCORED_POINTS: usize = 160;
/// Half-widths of the three-point windows, as parts of the profile.
const WINDOWS: [f64; 6] = [0.04, 0.07, 0.11, 0.16, 0.24, 0.35];

/// What to look for.
#[derive(Clone, Copy, Debug)]
pub struct CircleSearch {
    /// Smallest radius, mm.
    pub min_radius_mm: f64,
    /// Largest radius, mm.
    pub max_radius_mm: f64,
    /// A point this near counts, mm.
    pub tolerance_mm: f64,
}

/// The circle that most points agree on, with the part of all points that do; `None` if no hypothesis was in range.
///
/// Three points are taken from a window of neighbours, as neighbours along the line mostly lie on the same thing;
/// drawn from everywhere they would rarely all lie on a short arc.
#[must_use]
pub fn find_circle(x_mm: &[f64], z_mm: &[f64], search: &CircleSearch) -> Option<(Circle, f64)> {
    let num_points = x_mm.len().min(z_mm.len());
    if num_points < 3 {
        return None;
    }
    let [scored_x, scored_z] = [x_mm, z_mm].map(|values| windows::thinned(values, num_points, SCORED_POINTS));
    let mut random = SplitMix::new(0x005e_ed0f_a2c5);
    let mut best: Option<(Circle, usize)> = None;
    for hypothesis in 0..HYPOTHESES {
        let half_width = windows::width(num_points, WINDOWS[hypothesis % WINDOWS.len()], (num_points - 1) / 2);
        let middle = half_width + random.below(num_points - 2 * half_width);
        let indices = [middle - half_width, middle, middle + half_width];
        let Some(circle) = circle_through(indices.map(|idx| (x_mm[idx], z_mm[idx]))) else {
            continue;
        };
        if !(search.min_radius_mm..=search.max_radius_mm).contains(&circle.radius_mm) {
            continue;
        }
        let score = count_near(&scored_x, &scored_z, circle, search.tolerance_mm);
        if best.is_none_or(|(_, most)| score > most) {
            best = Some((circle, score));
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "a part of the number of points")]
    best.map(|(circle, score)| (circle, score as f64 / scored_x.len() as f64))
}

/// Points within `tolerance_mm` of the circle, without a root: |d² − r²| ≤ 2 r τ.
fn count_near(x_mm: &[f64], z_mm: &[f64], circle: Circle, tolerance_mm: f64) -> usize {
    let radius_squared = circle.radius_mm * circle.radius_mm;
    let limit = 2.0 * circle.radius_mm * tolerance_mm;
    let mut count = 0_u32;
    for (x, z) in x_mm.iter().zip(z_mm) {
        let (dx, dz) = (x - circle.x_mm, z - circle.z_mm);
        count += u32::from((dx * dx + dz * dz - radius_squared).abs() <= limit);
    }
    count as usize
}

fn circle_through([a, b, c]: [(f64, f64); 3]) -> Option<Circle> {
    let (bx, bz) = (b.0 - a.0, b.1 - a.1);
    let (cx, cz) = (c.0 - a.0, c.1 - a.1);
    let cross = 2.0 * (bx * cz - bz * cx);
    let (bb, cc) = (bx * bx + bz * bz, cx * cx + cz * cz);
    let (x, z) = ((cz * bb - bz * cc) / cross, (bx * cc - cx * bb) / cross);
    let circle = Circle { x_mm: a.0 + x, z_mm: a.1 + z, radius_mm: (x * x + z * z).sqrt() };
    circle.radius_mm.is_finite().then_some(circle)
}
