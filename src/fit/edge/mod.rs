//! The edge of a plate in a real profile: where its surface ends, breaks or turns, and a reason where that is not seen.

mod corner;
mod end;
mod pieces;
mod points;
mod sighting;
mod tip;

use nalgebra::Matrix2;

use crate::geometry::Profile;

use super::{EdgeRefusal, PointClass};

use pieces::Piece;
use points::Points;
use sighting::Seen;

/// A tilted surface leaves the field of view on one side nearer to its middle than on the other, but not by this factor.
const CLEARLY_INSIDE_PART: f64 = 0.8;

/// What the surface does at the place looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// It ends: nothing, or a background far off, follows. A plate's free edge.
    Edge,
    /// Two flanks meet at an angle.
    Corner,
    /// It jumps to another height and goes on. A plate lying on a table.
    Step,
    /// A narrow thing sticks out of the profile: a pin or a tip. Its top is what counts.
    Tip,
}

impl Feature {
    /// All features, in the order in which they are tried and shown.
    pub const ALL: [Self; 4] = [Self::Corner, Self::Step, Self::Edge, Self::Tip];
}

/// Something that a profile shows, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// What it is.
    pub feature: Feature,
    /// Where across the line, mm.
    pub x_mm: f64,
}

/// What is known before looking at a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EdgeOptions {
    /// What to look for; `None`: whatever there is, where there is only one.
    pub feature: Option<Feature>,
    /// Noise of a point along the range axis, mm, where known; estimated otherwise.
    pub profile_std_mm: Option<f64>,
}

/// A straight piece of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flank {
    /// Where it begins and ends, (x, z), mm: the end next to the feature first.
    pub ends_mm: [[f64; 2]; 2],
    /// Root mean square distance of its points, mm.
    pub rms_mm: f64,
    /// Points that it rests on.
    pub num_points: usize,
}

/// The point where the laser line crosses an edge.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeFit {
    /// What was found.
    pub feature: Feature,
    /// Where it is in the laser plane, (x, z), mm.
    pub point_mm: [f64; 2],
    /// Its covariance, mm². For a free edge the pitch of the points counts as well.
    pub covariance: Matrix2<f64>,
    /// From the point along its flank to where the surface behind a step begins, (x, z), mm: the shadow of the step, or a hole
    /// in the measurement that hides where the edge is. Zero where nothing is missing between them, or nothing follows.
    pub gap_mm: [f64; 2],
    /// The flanks that it was found from: an edge and a step have one, a corner and a pointed tip two, a rounded tip none.
    pub flanks: Vec<Flank>,
    /// Noise of a point across its flank, mm.
    pub point_std_mm: f64,
    /// One class a point of the profile.
    pub classes: Vec<PointClass>,
}

impl EdgeFit {
    /// Standard deviations of (x, z), mm.
    #[must_use]
    pub fn std_mm(&self) -> [f64; 2] {
        [0, 1].map(|idx| self.covariance[(idx, idx)].max(0.0).sqrt())
    }
}

/// Finds where the laser line crosses an edge, or a tip.
///
/// Straight pieces are searched for and fitted one after the other; where two of them meet is a corner, where one ends an edge
/// or, with another surface behind it, a step. What is there only because something else is does not count: the end of the
/// table, the lower end of a plate's side. What is left has to be one thing.
///
/// x may fall as well as rise. z may run either way where the sensor's origin is in its head, so that all ranges have one
/// sign; else it is taken to grow away from the sensor. Which side of a step is the plate depends on that.
///
/// # Frame and units
/// Laser plane of the sensor, mm.
///
/// # Errors
/// [`EdgeRefusal`], with the reason in words.
pub fn extract_edge(profile: &Profile, options: &EdgeOptions) -> Result<EdgeFit, EdgeRefusal> {
    let points = Points::of(profile, options);
    let needed = if options.feature == Some(Feature::Tip) { tip::MIN_TIP_POINTS } else { pieces::MIN_FLANK_POINTS };
    if points.len() < needed {
        return Err(EdgeRefusal::TooFewPoints { found: points.len(), needed });
    }
    let pieces = pieces::find(&points);
    if options.feature == Some(Feature::Tip) {
        return tip::find(&points, &pieces, options);
    }
    let (seen, flattest_rad) = sighting::all(&points, &pieces);
    let of_plate: Vec<Seen> =
        seen.into_iter().filter(|seen| !seen.is_of(|piece| sighting::is_narrow(&points, &pieces[piece]))).collect();
    let mut wanted: Vec<Seen> = of_plate.iter().copied().filter(|seen| seen.answers(options.feature)).collect();
    leave_out_borders(profile, &mut wanted, options);
    match wanted.as_slice() {
        [found] => fit(&points, &pieces, found, options)
            .ok_or(EdgeRefusal::NoFeature { feature: options.feature, num_points: points.len() }),
        [] => nothing(&points, &pieces, &of_plate, flattest_rad, options),
        several => Err(EdgeRefusal::Ambiguous { seen: several.iter().map(Seen::sighting).collect() }),
    }
}

/// Where a head's field of view is narrower than its profile, a surface ends at its border as at a free edge. Beside anything
/// else, and beside an end that is clearly further inside, such an end tells nothing.
fn leave_out_borders(profile: &Profile, wanted: &mut Vec<Seen>, options: &EdgeOptions) {
    let is_free_end = |seen: &Seen| seen.feature() == Feature::Edge;
    if options.feature != Some(Feature::Edge) && wanted.iter().any(|seen| !is_free_end(seen)) {
        wanted.retain(|seen| !is_free_end(seen));
        return;
    }
    let (Some(first), Some(last)) = (profile.x_mm().first(), profile.x_mm().last()) else { return };
    let middle_mm = f64::midpoint(*first, *last);
    let off_middle = |seen: &Seen| (seen.sighting().x_mm - middle_mm).abs();
    let outermost = wanted.iter().map(off_middle).fold(0.0, f64::max);
    let has_end_inside = wanted.iter().any(|seen| off_middle(seen) < CLEARLY_INSIDE_PART * outermost);
    if wanted.len() == 2 && wanted.iter().all(is_free_end) && has_end_inside {
        wanted.retain(|seen| off_middle(seen) < outermost);
    }
}

fn fit(points: &Points, pieces: &[Piece], seen: &Seen, options: &EdgeOptions) -> Option<EdgeFit> {
    match *seen {
        Seen::Corner { before, .. } => corner::fit(points, &pieces[before], &pieces[before + 1], options),
        Seen::End { piece, end, far, .. } => {
            let far_place = far.map(|far| pieces[far].end(end.other()));
            end::fit(points, &pieces[piece], end, far_place, seen.feature(), options)
        }
    }
}

/// What else there is where nothing of a plate was found: a tip, or a reason.
fn nothing(
    points: &Points,
    pieces: &[Piece],
    seen: &[Seen],
    flattest_rad: Option<f64>,
    options: &EdgeOptions,
) -> Result<EdgeFit, EdgeRefusal> {
    let num_points = points.len();
    if options.feature.is_none()
        && let found @ (Ok(_) | Err(EdgeRefusal::Ambiguous { .. })) = tip::find(points, pieces, options)
    {
        return found;
    }
    Err(match (options.feature, flattest_rad) {
        (Some(wanted), _) if !seen.is_empty() => {
            EdgeRefusal::OtherFeature { wanted, seen: seen.iter().map(Seen::sighting).collect() }
        }
        _ if pieces.is_empty() => EdgeRefusal::NoFlank { num_points, needed: pieces::MIN_FLANK_POINTS },
        (None | Some(Feature::Corner), Some(angle_rad)) => {
            EdgeRefusal::TooFlat { found_deg: angle_rad.to_degrees(), needed_deg: corner::MIN_CORNER_DEG }
        }
        (feature, _) => EdgeRefusal::NoFeature { feature, num_points },
    })
}
