//! What a profile shows: corners and ends of its pieces, and which of them is the one meant.

use super::corner::MIN_CORNER_DEG;
use super::pieces::{End, Piece};
use super::points::Points;
use super::{Feature, Sighting};

/// A piece that begins within this part of the profile from its border has its end out of view.
const BORDER_PART: f64 = 0.02;
/// The same in points, for short profiles.
const BORDER_POINTS: usize = 5;
/// Two pieces meet in a corner if both ends are within so many pitches of their crossing …
const REACH_PITCHES: f64 = 10.0;
/// … or within this part of the shorter one: edges are bevelled, rounded and burred.
const REACH_PART: f64 = 0.1;
/// What follows goes on without a jump where it is within so many tolerances of the line.
const SMOOTH_TOLERANCES: f64 = 8.0;
/// Points looked at beyond an end, and how many of them it takes to tell.
const LOOKED_AT: usize = 5;
const TELLING: usize = 3;
/// A flank of a corner that is steeper than this is a side, whose own end is not the one looked for.
const SIDE_DEG: f64 = 30.0;
/// A surface narrower than this part of the profile, with both ends in view, is a pin rather than a plate.
const NARROW_PART: f64 = 0.15;

/// A place where the surface does something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Seen {
    /// Two neighbouring pieces meet.
    Corner {
        /// The first of the two.
        before: usize,
        /// Where, mm.
        x_mm: f64,
        /// Whether it points to the sensor.
        is_convex: bool,
    },
    /// A piece ends.
    End {
        /// The piece.
        piece: usize,
        /// Which end of it.
        end: End,
        /// The piece that follows at another height.
        far: Option<usize>,
        /// Where, mm.
        x_mm: f64,
    },
}

impl Seen {
    pub(super) const fn sighting(&self) -> Sighting {
        let (Self::Corner { x_mm, .. } | Self::End { x_mm, .. }) = self;
        Sighting { feature: self.feature(), x_mm: *x_mm }
    }

    /// Whether all pieces that make it are such.
    pub(super) fn is_of(&self, is_such: impl Fn(usize) -> bool) -> bool {
        match *self {
            Self::Corner { before, .. } => is_such(before) && is_such(before + 1),
            Self::End { piece, .. } => is_such(piece),
        }
    }

    pub(super) const fn feature(&self) -> Feature {
        match self {
            Self::Corner { .. } => Feature::Corner,
            Self::End { far: Some(_), .. } => Feature::Step,
            Self::End { far: None, .. } => Feature::Edge,
        }
    }

    /// Whether this is what was asked for. A step is where a surface ends, too.
    pub(super) fn answers(&self, wanted: Option<Feature>) -> bool {
        match wanted {
            None => true,
            Some(Feature::Step | Feature::Edge) => matches!(self, Self::End { .. }),
            Some(wanted) => self.feature() == wanted,
        }
    }
}

/// What is seen, without what only belongs to something else that is seen; and the angle of the flattest bend, rad.
pub(super) fn all(points: &Points, pieces: &[Piece]) -> (Vec<Seen>, Option<f64>) {
    let mut seen = Vec::new();
    let mut flattest: Option<f64> = None;
    seen.extend(free_end(points, pieces, 0, End::First));
    for before in 0..pieces.len().saturating_sub(1) {
        match meeting(points, pieces, before) {
            Meeting::Seen(found) => seen.push(found),
            Meeting::Flat(angle_rad) => flattest = Some(flattest.map_or(angle_rad, |known| known.max(angle_rad))),
        }
    }
    seen.extend(free_end(points, pieces, pieces.len().wrapping_sub(1), End::Last));
    (without_dependent(pieces, &seen), flattest)
}

/// Whether a piece is narrow with both ends in view.
pub(super) fn is_narrow(points: &Points, piece: &Piece) -> bool {
    #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
    let part = piece.grid_width(points) as f64 / points.num_grid as f64;
    part < NARROW_PART && !is_at_border(points, piece, End::First) && !is_at_border(points, piece, End::Last)
}

fn is_at_border(points: &Points, piece: &Piece, end: End) -> bool {
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of the number of points"
    )]
    let border = BORDER_POINTS.max((BORDER_PART * points.num_grid as f64) as usize);
    let grid = points.grid[piece.end(end)];
    match end {
        End::First => grid < border,
        End::Last => grid + border >= points.num_grid,
    }
}

fn free_end(points: &Points, pieces: &[Piece], idx: usize, end: End) -> Option<Seen> {
    let piece = pieces.get(idx)?;
    let is_end = !is_at_border(points, piece, end) && !goes_on(points, piece, end);
    is_end.then(|| Seen::End { piece: idx, end, far: None, x_mm: points.x_mm[piece.end(end)] })
}

/// Whether what follows bends away rather than jumps.
fn goes_on(points: &Points, piece: &Piece, end: End) -> bool {
    let last = piece.end(end);
    let beyond = match end {
        End::First => last.saturating_sub(LOOKED_AT)..last,
        End::Last => (last + 1).min(points.len())..(last + 1 + LOOKED_AT).min(points.len()),
    };
    let near = beyond.filter(|place| points.grid[*place].abs_diff(points.grid[last]) <= 2 * LOOKED_AT);
    let smooth_mm = SMOOTH_TOLERANCES * points.tolerance_mm;
    near.filter(|place| piece.fit.line.distance_mm(points.at(*place)).abs() <= smooth_mm).count() >= TELLING
}

enum Meeting {
    Seen(Seen),
    Flat(f64),
}

/// What there is between a piece and the next.
fn meeting(points: &Points, pieces: &[Piece], before: usize) -> Meeting {
    let (first, second) = (&pieces[before], &pieces[before + 1]);
    let (end_mm, start_mm) = (points.at(first.last), points.at(second.first));
    let angle_rad = first.fit.line.angle_to_rad(&second.fit.line);
    if angle_rad.to_degrees() >= MIN_CORNER_DEG
        && let Some(crossing_mm) = first.fit.line.crossing_mm(&second.fit.line)
    {
        let shorter_mm = first.length_mm(points).min(second.length_mm(points));
        let reach_mm = (REACH_PITCHES * points.pitch_mm).max(REACH_PART * shorter_mm);
        let from_crossing = |at: [f64; 2]| (at[0] - crossing_mm[0]).hypot(at[1] - crossing_mm[1]);
        if from_crossing(end_mm) <= reach_mm && from_crossing(start_mm) <= reach_mm {
            let is_convex = points_to_sensor(points, first, second, crossing_mm);
            return Meeting::Seen(Seen::Corner { before, x_mm: crossing_mm[0], is_convex });
        }
    }
    let jumps = [first.fit.line.distance_mm(start_mm), second.fit.line.distance_mm(end_mm)];
    if jumps.iter().any(|jump| jump.abs() <= 2.0 * points.tolerance_mm) {
        return Meeting::Flat(angle_rad);
    }
    let is_first_nearer = (start_mm[1] - end_mm[1]) * points.away > 0.0;
    let (near, end, far) =
        if is_first_nearer { (before, End::Last, before + 1) } else { (before + 1, End::First, before) };
    Meeting::Seen(Seen::End { piece: near, end, far: Some(far), x_mm: points.x_mm[pieces[near].end(end)] })
}

/// Whether both flanks of a corner, taken together, run away from the sensor.
fn points_to_sensor(points: &Points, first: &Piece, second: &Piece, corner_mm: [f64; 2]) -> bool {
    let away: f64 = [points.at(first.first), points.at(second.last)]
        .iter()
        .map(|far| (far[1] - corner_mm[1]) / (far[0] - corner_mm[0]).hypot(far[1] - corner_mm[1]))
        .sum();
    away * points.away > 0.0
}

/// Leaves out what is there only because something else is: the end of the table beside a plate, the lower end of a side,
/// the corner between a side and the table.
fn without_dependent(pieces: &[Piece], seen: &[Seen]) -> Vec<Seen> {
    let has_convex = seen.iter().any(|seen| !matches!(seen, Seen::Corner { is_convex: false, .. }));
    let is_far = |idx: usize| seen.iter().any(|seen| matches!(seen, Seen::End { far: Some(far), .. } if *far == idx));
    let in_corner = |idx: usize, wanted_convex: bool| {
        seen.iter().any(|seen| {
            matches!(seen, Seen::Corner { before, is_convex, .. }
                if *is_convex == wanted_convex && (*before == idx || before + 1 == idx))
        })
    };
    let is_side = |idx: usize| {
        let [dx, dz] = pieces[idx].fit.line.direction;
        dz.abs().atan2(dx.abs()).to_degrees() > SIDE_DEG
    };
    let is_dependent = |seen: &Seen| match *seen {
        Seen::Corner { is_convex, .. } => !is_convex && has_convex,
        Seen::End { far: Some(_), .. } => false,
        Seen::End { piece, .. } => {
            is_far(piece) || in_corner(piece, false) || (in_corner(piece, true) && is_side(piece))
        }
    };
    seen.iter().copied().filter(|seen| !is_dependent(seen)).collect()
}
