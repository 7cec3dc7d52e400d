//! A settled capture: the robot stands still before and after, and the profiles are later than the move.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::device::driver::ProfileReading;
use crate::device::error::DeviceError;
use crate::device::sensor::average::average;
use crate::device::settle::is_later;
use crate::geometry::{Base, Flange, Profile, Transform};

use super::StepCapture;
use super::run::{Break, Runner};

/// Between two questions for a later profile.
const ASK_EVERY: Duration = Duration::from_millis(5);

impl Runner {
    /// Waits until everything is still, and captures; tries again where the robot moved meanwhile.
    pub(super) fn capture(&self, step_mm: Option<f64>) -> Result<StepCapture, Break> {
        let settle = &self.task.settle;
        let mut moved_mm = None;
        for _ in 0..=settle.num_retries {
            self.control.wait(Duration::from_millis(settle.settle_ms.into()))?;
            let before = self.robot.report()?;
            let profiles = self.later_profiles()?;
            let after = self.robot.report()?;
            moved_mm = settle.moved_mm(&before.base_from_flange, &after.base_from_flange);
            if moved_mm.is_none() && after.is_moving != Some(true) {
                return Ok(capture_of(&profiles, after.base_from_flange, step_mm)?);
            }
        }
        Err(Break::NeverStill { moved_mm })
    }

    /// As many profiles as are wanted, each later than the one before, and the first later than this call.
    fn later_profiles(&self) -> Result<Vec<Arc<Profile>>, Break> {
        self.sensor.forget()?;
        let mut newest_count = self.sensor.newest()?.map(|reading| reading.trigger_count);
        let num_wanted = usize::from(self.task.settle.num_profiles.max(1));
        let mut profiles = Vec::new();
        while profiles.len() < num_wanted {
            let reading = self.profile_later_than(newest_count)?;
            newest_count = Some(reading.trigger_count);
            profiles.push(reading.profile);
        }
        Ok(profiles)
    }

    fn profile_later_than(&self, trigger_count: Option<u32>) -> Result<ProfileReading, Break> {
        let deadline = Instant::now() + self.sensor.deadlines().profile;
        loop {
            let newest = self.sensor.newest()?;
            let is_new =
                |reading: &ProfileReading| trigger_count.is_none_or(|count| is_later(reading.trigger_count, count));
            if let Some(reading) = newest.filter(is_new) {
                return Ok(reading);
            }
            if Instant::now() >= deadline {
                return Err(Break::StaleProfiles { trigger_count: trigger_count.unwrap_or_default() });
            }
            self.control.wait(ASK_EVERY)?;
        }
    }
}

fn capture_of(
    profiles: &[Arc<Profile>],
    base_from_flange: Transform<Base, Flange>,
    step_mm: Option<f64>,
) -> Result<StepCapture, DeviceError> {
    let mean = average(profiles).map_err(|error| DeviceError::System {
        device: "Profiler",
        what: "taking the mean of its profiles".to_owned(),
        reason: error.to_string(),
    })?;
    let num_profiles = u16::try_from(profiles.len()).unwrap_or(u16::MAX);
    Ok(StepCapture {
        base_from_flange,
        profile: mean.profile,
        step_mm,
        repeat_std_mm: mean.repeat_std_mm,
        num_profiles,
    })
}
