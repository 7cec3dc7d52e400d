//! The profiler of a simulated cell: which profiles there are, and what each shows.

use crate::device::sim::fault::Fault;
use crate::device::sim::head::Height;
use crate::geometry::Vec3;
use crate::scene::Random;

use super::{PUSH_MM, State, World, stream};

/// Profiles a second of the cell's own clock. Faster than clients ask: one that reads and forgets, or two of them, would
/// else be told most of the time that there is none.
const TRIGGERS_PER_S: f64 = 1000.0;
/// What the profiler's controller was told.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Profiler {
    /// Profiles up to this count were forgotten.
    forgotten: u32,
    /// The last profile before the head went stale.
    stale_at: Option<u32>,
    /// The program that is active.
    program: u8,
    stream: Stream,
}

/// The high-speed stream that was started last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stream {
    /// Which it is: a client that has been served one is not served another's.
    pub number: u64,
    /// Its first profile; `None` once it was stopped.
    pub from: Option<u32>,
}

impl World {
    /// The count of the newest profile; the least one that is held.
    #[must_use]
    pub fn trigger_counts(&self) -> (u32, u32) {
        let (mut state, time_s) = self.now();
        let newest = Self::newest_count(&mut state, time_s);
        (newest, state.profiler.forgotten.saturating_add(1))
    }

    /// Forgets every profile up to a count.
    pub fn forget_profiles(&self, up_to: u32) {
        let (mut state, _) = self.now();
        state.profiler.forgotten = state.profiler.forgotten.max(up_to);
    }

    /// The program of the profiler that is active.
    #[must_use]
    pub fn program(&self) -> u8 {
        self.now().0.profiler.program
    }

    /// Changes that.
    pub fn change_program(&self, program: u8) {
        self.now().0.profiler.program = program;
    }

    /// The high-speed stream that was started last.
    #[must_use]
    pub fn stream(&self) -> Stream {
        self.now().0.profiler.stream
    }

    /// Starts another from a profile on.
    pub fn start_stream(&self, from: u32) {
        let stream = &mut self.now().0.profiler.stream;
        *stream = Stream { number: stream.number + 1, from: Some(from) };
    }

    /// Ends the stream of a number, unless another has taken its place.
    pub fn end_stream(&self, number: u64) {
        let stream = &mut self.now().0.profiler.stream;
        if stream.number == number {
            stream.from = None;
        }
    }

    /// The profile of a count; the same count gives the same profile.
    #[must_use]
    pub fn profile(&self, trigger_count: u32) -> Vec<Height> {
        let time_s = f64::from(trigger_count) / TRIGGERS_PER_S;
        let (base_from_flange, is_pushed) = {
            let (state, _) = self.now();
            (self.true_pose(&state, time_s), state.faults.has(Fault::BallMoved))
        };
        let push_mm = if is_pushed { PUSH_MM } else { Vec3::zeros() };
        let mut noise = Random::new(self.seed, stream::PROFILE + u64::from(trigger_count));
        let base_from_sensor = base_from_flange * self.layout.flange_from_sensor;
        self.head.see(&self.subject.shifted_by(push_mm), &base_from_sensor, &mut noise)
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast of a float saturates")]
    fn newest_count(state: &mut State, time_s: f64) -> u32 {
        let count = (time_s * TRIGGERS_PER_S) as u32;
        if state.faults.has(Fault::StaleProfile) {
            *state.profiler.stale_at.get_or_insert(count)
        } else {
            state.profiler.stale_at = None;
            count
        }
    }
}
