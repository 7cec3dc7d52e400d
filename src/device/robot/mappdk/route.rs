//! A straight way cut into pieces; pure.

use crate::device::driver::LinearMove;
use crate::geometry::{Base, Flange, Rigid, Transform, so3};

/// A move of MAPPDK cannot be stopped before it has ended, so a stop has to wait for the piece under way: no piece takes
/// longer than this.
pub const MAX_PIECE_SECONDS: f64 = 0.5;
/// MAPPDK has no speed of turning: where the flange turns almost on the spot, a piece runs as fast as the controller turns
/// by itself. Such a piece turns no further than this, and the next waits until the time of this one is over.
pub const MAX_PIECE_TURN_DEG: f64 = 3.0;
/// The field of the speed has four digits.
const MAX_SPEED_MM_S: f64 = 9999.0;

/// A straight way from where the robot stands to a target, in pieces of equal length and turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    base_from_start: Rigid,
    target: Transform<Base, Flange>,
    speed_mm_s: u16,
    num_pieces: u32,
    num_given: u32,
    least_piece_seconds: f64,
}

impl Route {
    /// Plans the way. The speed is never above what was asked, except that the wire knows none below 1 mm/s.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped before")]
    pub fn new(start: &Transform<Base, Flange>, motion: &LinearMove) -> Self {
        /// Below this a turn takes no time to speak of; a speed of nothing must not divide.
        const LEAST_ROTATION_SPEED_DEG_S: f64 = 0.01;
        /// So that 50 mm/s, as a quotient, are not rounded down to 49, nor ten pieces up to eleven.
        const ROUNDING: f64 = 1e-9;
        let target = motion.base_from_flange;
        let distance_mm = (target.translation_mm() - start.translation_mm()).norm();
        let turn_deg = start.rotation().angle_to(&target.rotation()).to_degrees();
        let turn_seconds = turn_deg / motion.rotation_speed_deg_s.max(LEAST_ROTATION_SPEED_DEG_S);
        // Where the turn takes longer the point goes slower, so that both arrive together.
        let speed_for_turn_mm_s = if turn_seconds > 0.0 { distance_mm / turn_seconds } else { MAX_SPEED_MM_S };
        let asked_mm_s = motion.speed_mm_s.min(speed_for_turn_mm_s);
        let speed_mm_s = (asked_mm_s + ROUNDING).floor().clamp(1.0, MAX_SPEED_MM_S);
        let is_on_the_spot = speed_for_turn_mm_s < 1.0;
        let seconds = if is_on_the_spot { turn_seconds } else { distance_mm / speed_mm_s };
        let num_by_turn = if is_on_the_spot { turn_deg / MAX_PIECE_TURN_DEG } else { 0.0 };
        let num_pieces = ((seconds / MAX_PIECE_SECONDS).max(num_by_turn) - ROUNDING).ceil().clamp(1.0, 1e6);
        Self {
            base_from_start: *start.rigid(),
            target,
            speed_mm_s: speed_mm_s as u16,
            num_pieces: num_pieces as u32,
            num_given: 0,
            least_piece_seconds: if is_on_the_spot { seconds / num_pieces } else { 0.0 },
        }
    }

    /// Where it leads.
    #[must_use]
    pub const fn target(&self) -> &Transform<Base, Flange> {
        &self.target
    }

    /// The speed for the wire, mm/s: rounded down, at least 1.
    #[must_use]
    pub const fn speed_mm_s(&self) -> u16 {
        self.speed_mm_s
    }

    /// How long to wait from one piece to the next at least: nothing where the controller keeps the speed by itself.
    #[must_use]
    pub const fn least_piece_seconds(&self) -> f64 {
        self.least_piece_seconds
    }

    /// The end of the next piece; `None` once all were given.
    pub fn next_piece(&mut self) -> Option<Transform<Base, Flange>> {
        if self.num_given >= self.num_pieces {
            return None;
        }
        self.num_given += 1;
        if self.num_given == self.num_pieces {
            // The target itself, without what interpolation rounds.
            return Some(self.target);
        }
        let share = f64::from(self.num_given) / f64::from(self.num_pieces);
        let (start, end) = (&self.base_from_start, self.target.rigid());
        let turn = so3::log(&(start.rotation.inverse() * end.rotation));
        let position = start.translation.vector.lerp(&end.translation.vector, share);
        Some(Transform::from_parts(position, start.rotation * so3::exp(turn * share)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{PoseConvention, Vec3};

    fn pose(position_mm: [f64; 3], wpr_deg: [f64; 3]) -> Transform<Base, Flange> {
        let rotation = PoseConvention::default_convention().rotation_from_angles_deg(wpr_deg);
        Transform::from_parts(Vec3::from(position_mm), rotation)
    }

    /// Follows a route; checks what must hold of every one.
    #[track_caller]
    fn check(target: Transform<Base, Flange>, speed_mm_s: f64, rotation_speed_deg_s: f64, expected: (usize, u16)) {
        let start = pose([500.0, 0.0, 300.0], [180.0, 0.0, 0.0]);
        let motion = LinearMove { base_from_flange: target, speed_mm_s, rotation_speed_deg_s };
        let mut route = Route::new(&start, &motion);
        let mut before = start;
        let mut pieces = 0;
        while let Some(piece) = route.next_piece() {
            let distance_mm = (piece.translation_mm() - before.translation_mm()).norm();
            let turn_deg = before.rotation().angle_to(&piece.rotation()).to_degrees();
            let seconds = (distance_mm / f64::from(route.speed_mm_s())).max(route.least_piece_seconds());
            assert!(seconds <= MAX_PIECE_SECONDS + 1e-9, "{seconds} s in a piece");
            assert!(turn_deg / seconds.max(1e-9) <= rotation_speed_deg_s + 1e-6, "{turn_deg}° in {seconds} s");
            before = piece;
            pieces += 1;
        }
        assert_eq!(before, target, "the last piece ends at the target itself");
        assert_eq!((pieces, route.speed_mm_s()), expected);
        assert!(f64::from(route.speed_mm_s()) <= speed_mm_s.max(1.0));
    }

    #[test]
    fn no_piece_takes_longer_than_a_stop_may_wait() {
        let ahead = |y_mm: f64| pose([500.0, y_mm, 300.0], [180.0, 0.0, 0.0]);
        check(ahead(0.75), 10.0, 10.0, (1, 10));
        check(ahead(100.0), 50.0, 10.0, (4, 50));
        check(ahead(100.0), 49.9, 10.0, (5, 49));
        check(ahead(5.45), 10.9, 10.0, (2, 10));
        check(ahead(1.0), 0.3, 10.0, (2, 1));
        check(ahead(0.0), 10.0, 10.0, (1, 10));
    }

    #[test]
    fn a_turn_slows_the_point_down() {
        // 30° at 10 °/s take 3 s, 30 mm in that time are 10 mm/s.
        check(pose([500.0, 30.0, 300.0], [180.0, 0.0, 30.0]), 50.0, 10.0, (6, 10));
        // 20° at 10 °/s take 2 s, 50 mm at 10 mm/s take 5 s.
        check(pose([500.0, 50.0, 300.0], [180.0, 0.0, 20.0]), 10.0, 10.0, (10, 10));
    }

    #[test]
    fn a_turn_on_the_spot_is_cut_small_and_takes_its_time() {
        check(pose([500.0, 0.0, 300.0], [-150.0, 0.0, 0.0]), 50.0, 1000.0, (10, 1));
        check(pose([500.0, 1.0, 300.0], [180.0, 0.0, 30.0]), 50.0, 10.0, (10, 1));
        // Half a turn has no shortest way; any is good.
        check(pose([500.0, 0.0, 300.0], [0.0, 0.0, 0.0]), 50.0, 360.0, (60, 1));
    }
}
