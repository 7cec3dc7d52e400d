//! A watched folder: profiles that other software saves are picked up as they appear.
//!
//! What lies in the folder when it is connected is not new. A file counts once its size and time have stood still for a
//! while, so one that is being written is left alone; writing the file that was read last once more counts as another
//! profile. Trigger counts are our own: one a file.

use std::collections::{HashMap, HashSet};
use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use crate::device::driver::{ProfileReading, SensorDriver};
use crate::device::error::{DeviceError, system_words};
use crate::device::setup::SensorSetup;
use crate::geometry::Profile;
use crate::sheet::{natural_key, profile, text};

const DEVICE: &str = "Watched folder";
/// A file that has not changed for so long is complete: programs write a profile in one go.
const QUIET: Duration = Duration::from_millis(150);
/// One that cannot be read gets so long to become readable, for programs that write in several goes.
const PATIENCE: Duration = Duration::from_millis(1500);
/// Then it is told for so long, or until a profile comes; after that it is done with.
const TOLD_FOR: Duration = Duration::from_secs(10);
/// A folder whose time has not changed holds no new names, once two names of the same time would differ in it: drives
/// tell times apart to 2 s at worst.
const COARSEST_TIME: Duration = Duration::from_secs(3);
/// It is listed so often all the same, for drives that keep no such time.
const LIST_EVERY: Duration = Duration::from_secs(10);
/// No file of one profile is as large.
const MAX_FILE_BYTES: u64 = 16 << 20;
/// What profiles are saved as; everything else in the folder is left alone, such as pictures and files under way.
const ENDINGS: [&str; 6] = ["csv", "txt", "tsv", "dat", "asc", "xyz"];

/// What tells that a file has changed.
type Stamp = (u64, Option<SystemTime>);

fn stamp_of(metadata: &Metadata) -> Stamp {
    (metadata.len(), metadata.modified().ok())
}

/// A file that appeared or changed and is not read yet.
#[derive(Clone, Debug)]
struct Fresh {
    stamp: Stamp,
    /// Since when it has been so.
    since: Instant,
}

/// The newest file that is done with. Written over, it is another profile.
#[derive(Clone, Debug)]
struct Last {
    name: OsString,
    stamp: Stamp,
    /// When it was seen to change while it was not wanted any more: the rest of that writing is no profile either.
    under_way_at: Option<Instant>,
}

impl Last {
    /// Whether a file is another one, or this one written over.
    fn has_changed(&mut self, name: &OsString, stamp: Stamp, now: Instant) -> bool {
        if *name != self.name {
            return true;
        }
        let is_under_way = self.under_way_at.is_some_and(|at| now.saturating_duration_since(at) < QUIET);
        if self.stamp != stamp && is_under_way {
            (self.stamp, self.under_way_at) = (stamp, Some(now));
        }
        self.stamp != stamp
    }
}

/// The time of the folder, which changes with the names in it.
#[derive(Clone, Debug)]
struct FolderTime {
    modified: SystemTime,
    /// Since when it is known to be so.
    since: Instant,
    /// When the names were last read.
    listed_at: Instant,
}

/// A folder that is watched.
#[derive(Debug)]
pub struct FolderDriver {
    folder: PathBuf,
    z_sign: f64,
    /// Names that are done with: there from the beginning, forgotten, or read.
    seen: HashSet<OsString>,
    fresh: HashMap<OsString, Fresh>,
    last: Option<Last>,
    time: Option<FolderTime>,
    num_files: u32,
    newest: Option<ProfileReading>,
}

impl FolderDriver {
    /// Begins to watch. What is there already is not new.
    ///
    /// # Errors
    /// [`DeviceError::NotConnected`] without such a folder, [`DeviceError::Timeout`].
    pub fn connect(setup: &SensorSetup, deadline: Instant) -> Result<Self, DeviceError> {
        let mut driver = Self {
            folder: setup.folder.clone(),
            z_sign: if setup.is_z_inverted { -1.0 } else { 1.0 },
            seen: HashSet::new(),
            fresh: HashMap::new(),
            last: None,
            time: None,
            num_files: 0,
            newest: None,
        };
        driver.forget_at(Instant::now(), deadline)?;
        Ok(driver)
    }

    fn newest_at(&mut self, now: Instant, deadline: Instant) -> Result<Option<ProfileReading>, DeviceError> {
        self.look(now, deadline)?;
        self.take_complete(now)?;
        Ok(self.newest.clone())
    }

    /// A file that is under way now shows what was before, as do those that are complete.
    fn forget_at(&mut self, now: Instant, deadline: Instant) -> Result<(), DeviceError> {
        self.look(now, deadline)?;
        self.see_all(now);
        self.newest = None;
        Ok(())
    }

    /// Looks for files that are not done with.
    fn look(&mut self, now: Instant, deadline: Instant) -> Result<(), DeviceError> {
        let modified = fs::metadata(&self.folder).map_err(|error| self.lost(&error))?.modified().ok();
        if self.may_have_new_names(modified, now) {
            return self.list(now, deadline);
        }
        if let Some(last) = &mut self.last
            && let Ok(metadata) = fs::metadata(self.folder.join(&last.name))
            && last.has_changed(&last.name.clone(), stamp_of(&metadata), now)
        {
            self.fresh.insert(last.name.clone(), Fresh { stamp: stamp_of(&metadata), since: now });
        }
        Ok(())
    }

    fn may_have_new_names(&mut self, modified: Option<SystemTime>, now: Instant) -> bool {
        let is_passed = |since: Instant, time: Duration| now.saturating_duration_since(since) >= time;
        match (&mut self.time, modified) {
            (Some(time), Some(modified)) if time.modified == modified => {
                let was_listed_late = time.listed_at.saturating_duration_since(time.since) >= COARSEST_TIME;
                let is_due = !self.fresh.is_empty() || !was_listed_late || is_passed(time.listed_at, LIST_EVERY);
                if is_due {
                    time.listed_at = now;
                }
                is_due
            }
            _ => {
                self.time = modified.map(|modified| FolderTime { modified, since: now, listed_at: now });
                true
            }
        }
    }

    fn lost(&self, error: &io::Error) -> DeviceError {
        DeviceError::NotConnected {
            device: DEVICE,
            address: self.folder.display().to_string(),
            reason: system_words(error),
            remedy: "check that the folder exists and may be read, and that its drive is connected",
        }
    }

    fn list(&mut self, now: Instant, deadline: Instant) -> Result<(), DeviceError> {
        let mut fresh = HashMap::new();
        let (mut names, mut num_seen) = (Vec::new(), 0);
        for entry in fs::read_dir(&self.folder).map_err(|error| self.lost(&error))? {
            if Instant::now() >= deadline {
                let request = format!("list of {}", self.folder.display());
                return Err(DeviceError::Timeout { device: DEVICE, request, waited: now.elapsed() });
            }
            let entry = entry.map_err(|error| self.lost(&error))?;
            let name = entry.file_name();
            let is_last = self.last.as_ref().is_some_and(|last| last.name == name);
            let is_seen = self.seen.contains(&name);
            num_seen += usize::from(is_seen);
            // Of what is done with only the name is looked at, so that thousands of old files cost next to nothing.
            if is_last || !(is_seen || is_left_alone(&name)) {
                // A file that is gone again is no error: programs rename what they have written.
                let Ok(metadata) = fs::metadata(entry.path()) else { continue };
                if metadata.is_file()
                    && self.last.as_mut().is_none_or(|last| last.has_changed(&name, stamp_of(&metadata), now))
                {
                    fresh.insert(name.clone(), self.fresh_of(&name, stamp_of(&metadata), now));
                }
            }
            names.push(name);
        }
        self.fresh = fresh;
        // A name may be used again once its file is gone.
        if num_seen < self.seen.len() {
            let here: HashSet<OsString> = names.into_iter().collect();
            self.seen.retain(|name| here.contains(name));
        }
        Ok(())
    }

    /// Since when a file stands as it is.
    fn fresh_of(&self, name: &OsString, stamp: Stamp, now: Instant) -> Fresh {
        let before = self.fresh.get(name).filter(|fresh| fresh.stamp == stamp);
        before.cloned().unwrap_or(Fresh { stamp, since: now })
    }

    /// Is done with all that was found.
    fn see_all(&mut self, now: Instant) {
        let newest = self.fresh.iter().max_by_key(|(name, fresh)| order_of(name, fresh));
        if let Some((name, fresh)) = newest {
            self.last = Some(Last { name: name.clone(), stamp: fresh.stamp, under_way_at: Some(now) });
        }
        self.seen.extend(self.fresh.drain().map(|(name, _)| name));
    }

    /// Takes up the files that are complete; the newest of them becomes the profile.
    fn take_complete(&mut self, now: Instant) -> Result<(), DeviceError> {
        let mut complete: Vec<(OsString, Fresh)> = self
            .fresh
            .iter()
            .filter(|(_, fresh)| now.saturating_duration_since(fresh.since) >= QUIET)
            .map(|(name, fresh)| (name.clone(), fresh.clone()))
            .collect();
        complete.sort_by_cached_key(|(name, fresh)| order_of(name, fresh));
        let Some((name, fresh)) = complete.last() else { return Ok(()) };
        let profile = match read(&self.folder.join(name), self.z_sign) {
            Ok(profile) => Arc::new(profile),
            Err(error) => {
                let stands_for = now.saturating_duration_since(fresh.since);
                if stands_for >= PATIENCE + TOLD_FOR {
                    self.see_all(now);
                }
                return if (PATIENCE..PATIENCE + TOLD_FOR).contains(&stands_for) { Err(error) } else { Ok(()) };
            }
        };
        self.last = Some(Last { name: name.clone(), stamp: fresh.stamp, under_way_at: None });
        self.num_files = self.num_files.wrapping_add(u32::try_from(complete.len()).unwrap_or(u32::MAX));
        for (name, _) in complete {
            self.fresh.remove(&name);
            self.seen.insert(name);
        }
        self.newest = Some(ProfileReading { profile, trigger_count: self.num_files, received_at: now });
        Ok(())
    }
}

/// By its time, and by its name where programs number what they save faster than the clock of the drive ticks.
fn order_of(name: &OsString, fresh: &Fresh) -> (Option<SystemTime>, Vec<(String, Option<u64>)>) {
    (fresh.stamp.1, natural_key(&name.to_string_lossy()))
}

fn is_left_alone(name: &OsString) -> bool {
    let is_hidden = name.to_string_lossy().starts_with(['.', '~']);
    let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy().to_lowercase());
    is_hidden || !ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}

fn read(path: &Path, z_sign: f64) -> Result<Profile, DeviceError> {
    let file_name = || path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    // The folder is watched on: what cannot be read is told like a refusal, which stands as long as it holds.
    let refused = |found: String, remedy: &str| DeviceError::Refused {
        device: DEVICE,
        request: format!("the file {}", file_name()),
        found,
        remedy: remedy.to_owned(),
    };
    let failed = |error: io::Error| refused(error.to_string(), "see that it may be read, then save the profile anew");
    let unexpected = |found: String| {
        let remedy = "let the software save profiles alone into this folder, as text: a row a point with x and z in mm";
        refused(format!("found {found}, needed one profile"), remedy)
    };
    let mut bytes = Vec::new();
    // One byte more than allowed tells that there are more.
    File::open(path).and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(unexpected(format!("more than {} MiB", MAX_FILE_BYTES >> 20)));
    }
    profile::of_sheet(&text::decode(bytes), z_sign).map_err(unexpected)
}

impl SensorDriver for FolderDriver {
    fn name(&self) -> &'static str {
        DEVICE
    }

    fn newest(&mut self, deadline: Instant) -> Result<Option<ProfileReading>, DeviceError> {
        self.newest_at(Instant::now(), deadline)
    }

    fn forget(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        self.forget_at(Instant::now(), deadline)
    }
}

#[cfg(test)]
mod tests;
