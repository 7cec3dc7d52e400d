//! Everything that is asked of a scan, together.

use crate::geometry::Vec3;
use crate::watch::{Cancelled, Watch};

use super::{
    Cloud, NUM_DRAWN, PlaneFit, PointSet, Round, RoundKind, ScanError, SegmentOptions, Teeth, find_planes, fit_plane,
    fit_round, measure_teeth, random_distances, suitable_tolerance_mm,
};

/// The same scan, the same points drawn.
const SEED: u64 = 1;

/// A region of a cloud and the plane fitted to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// What it is called.
    pub name: String,
    /// Its points.
    pub set: PointSet,
    /// Its plane, or why there is none.
    pub plane: Result<PlaneFit, ScanError>,
    /// Distances of points drawn at random from the plane, mm, signed.
    pub distances_mm: Vec<f64>,
}

impl Region {
    /// Fits a plane to a region and draws its points.
    #[must_use]
    pub fn new(cloud: &Cloud, name: String, set: PointSet) -> Self {
        let plane = fit_plane(cloud, &set);
        let distances_mm =
            plane.as_ref().map(|fit| random_distances(cloud, &set, &fit.plane, NUM_DRAWN, SEED)).unwrap_or_default();
        Self { name, set, plane, distances_mm }
    }
}

/// The name of the so-many-th region: A, B, … as in the paper, then A1, B1, …
#[must_use]
pub fn region_name(idx: usize) -> String {
    let letter = char::from(b'A' + u8::try_from(idx % 26).unwrap_or(0));
    if idx < 26 { letter.to_string() } else { format!("{letter}{}", idx / 26) }
}

/// All planes that a cloud has, named in the order of their size. Of points on a ball or cylinder that was found there is none:
/// any part of it is flat to some tolerance.
///
/// # Errors
/// [`Cancelled`].
pub fn plane_regions(
    cloud: &Cloud,
    options: &SegmentOptions,
    found: &Shapes,
    watch: &mut dyn Watch,
) -> Result<Vec<Region>, Cancelled> {
    let all = PointSet::all(cloud);
    let set = match &found.round {
        Some(Ok(round)) => {
            let tolerance_mm = options.tolerance_mm.unwrap_or_else(|| suitable_tolerance_mm(cloud, &all));
            let is_off = |offset: Vec3| round.distance_mm(offset + cloud.origin_mm()).abs() > tolerance_mm;
            all.filter(cloud, is_off)
        }
        _ => all.clone(),
    };
    #[expect(clippy::cast_precision_loss, reason = "counts of points")]
    if (set.len() as f64) < options.least_share * all.len() as f64 {
        return Ok(Vec::new());
    }
    let sets = find_planes(cloud, &set, options, watch)?;
    Ok(sets.into_iter().enumerate().map(|(idx, set)| Region::new(cloud, region_name(idx), set)).collect())
}

/// What else is looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The teeth.
    pub teeth: bool,
    /// A diameter: of a ball or cylinder, whichever more points are of.
    pub diameter: bool,
    /// The diameter of this kind only.
    pub round: Option<RoundKind>,
}

/// What was found beside planes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes {
    /// The teeth, where they were asked for.
    pub teeth: Option<Result<Teeth, ScanError>>,
    /// The ball or cylinder, where one was asked for.
    pub round: Option<Result<Round, ScanError>>,
}

/// Looks for teeth and diameters among points.
#[must_use]
pub fn shapes(cloud: &Cloud, set: &PointSet, wanted: Wanted) -> Shapes {
    let round = match wanted.round {
        Some(kind) => Some(fit_round(cloud, set, kind)),
        None if wanted.diameter => {
            let found = [RoundKind::Ball, RoundKind::Cylinder].map(|kind| fit_round(cloud, set, kind));
            found.into_iter().max_by_key(|found| found.as_ref().map_or(0, |round| round.num_used))
        }
        None => None,
    };
    Shapes { teeth: wanted.teeth.then(|| measure_teeth(cloud, set)), round }
}
