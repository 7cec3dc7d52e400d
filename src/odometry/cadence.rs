//! Step 4 of the patent: frames are taken every T.

/// Which frames are taken.
#[derive(Clone, Debug, Default)]
pub struct Cadence {
    period_s: Option<f64>,
    next_s: Option<f64>,
}

impl Cadence {
    /// One frame every so many seconds; all frames without a period.
    #[must_use]
    pub const fn new(period_s: Option<f64>) -> Self {
        Self { period_s, next_s: None }
    }

    /// Whether a frame is taken. Times that jump back start the period anew.
    pub fn takes(&mut self, time_s: f64) -> bool {
        /// A camera's clock jitters: a frame that comes this part of the period early is the one that was meant.
        const EARLY: f64 = 0.1;
        let Some(period_s) = self.period_s.filter(|period_s| *period_s > 0.0) else { return true };
        let is_due = self
            .next_s
            .is_none_or(|next_s| time_s >= next_s - EARLY * period_s || time_s < next_s - (1.0 + EARLY) * period_s);
        if is_due {
            // The period goes on from when the frame was due, so that being early or late does not add up.
            let due_s = self.next_s.filter(|next_s| (time_s - next_s).abs() < period_s).unwrap_or(time_s);
            self.next_s = Some(due_s + period_s);
        }
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_third_of_thirty_a_second() {
        let mut cadence = Cadence::new(Some(0.1));
        let taken: Vec<u32> = (0..31).filter(|idx| cadence.takes(5.0 + f64::from(*idx) / 30.0)).collect();
        assert_eq!(taken, (0..31).step_by(3).collect::<Vec<u32>>());
        assert!(cadence.takes(0.0), "a clock that was set back");
        assert!(!cadence.takes(0.05));
        assert!(cadence.takes(9.0) && !cadence.takes(9.05) && cadence.takes(9.1));
        let mut all = Cadence::new(None);
        assert!((0..5).all(|_| all.takes(1.0)));
    }
}
