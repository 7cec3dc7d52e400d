//! Scanned parts: points through a calibration, their regions and shapes, and their export. All work is in the background.

use std::path::PathBuf;
use std::sync::Arc;

use crate::app::jobs::{JobOutcome, JobWatch, Slot};
use crate::calibrate::{Method, best_available, solution_of};
use crate::geometry::{Flange, Sensor, Transform, Vec3};
use crate::report::best_solution;
use crate::report::calibration_file::{NamedCalibration, ReadCalibration, read_calibration};
use crate::scan::files::{CloudFormat, read_cloud, write_cloud};
use crate::scan::{
    Cloud, PointSet, Region, SegmentOptions, Shapes, Wanted, grow_plane, plane_regions, region_name, shapes,
    suitable_tolerance_mm,
};
use crate::session::{Known, Measured, Session, measure};
use crate::text::workpiece as words;
use crate::watch::Watch;

use super::{NoticeKind, Progress, Workbench};

/// Where the calibration comes from that a scan is seen through.
#[derive(Clone, Debug, PartialEq)]
pub enum ScanCalibration {
    /// The best of the session: of its own target, or of the first further one that has any.
    Best,
    /// That of a method on the session's own target.
    Of(Method),
    /// The truth of a simulated session.
    Truth,
    /// One of those under Verify that no method of the session's own target gave: from all targets, of a further one, pasted.
    Verified(NamedCalibration),
    /// A result file, or a text file with a matrix.
    File(PathBuf),
}

/// Points of a region to be added.
#[derive(Clone, Debug, PartialEq)]
pub enum RegionChoice {
    /// The plane about a point, mm.
    Plane(Vec3),
    /// What is inside a rectangle drawn over a view: right and down in the base, corners along them from the cloud's origin.
    Rectangle(Vec3, Vec3, [[f64; 2]; 4]),
}

/// What is asked of scans.
#[derive(Clone, Debug, PartialEq)]
pub enum ScanCommand {
    /// Sees a scan, by its index in [`Session::scans`], through a calibration, and finds its planes and shapes.
    Examine {
        /// Which scan.
        scan_idx: usize,
        /// Through what.
        calibration: ScanCalibration,
    },
    /// Sees the chosen scan through the calibration in a file.
    UseCalibration(PathBuf),
    /// Reads points from a file and finds their planes.
    OpenPoints(PathBuf),
    /// Finds the planes anew, in place of all regions.
    FindPlanes,
    /// Adds a region.
    AddRegion(RegionChoice),
    /// Gives a region another name.
    RenameRegion(usize, String),
    /// Takes a region off the list.
    RemoveRegion(usize),
    /// Takes back what was done to the list last: regions added, found anew or removed.
    UndoRegions,
    /// Looks for other shapes.
    Measure(Wanted),
    /// Writes the points to a PLY or CSV file.
    Export(PathBuf),
    /// Stops what is under way.
    Cancel,
}

/// A scan that was examined.
#[derive(Clone, Debug)]
pub struct ExaminedScan {
    /// Another number, other points.
    pub id: u64,
    /// Another number, other regions.
    pub regions_id: u64,
    /// The revision of the document.
    pub revision: u64,
    /// Its place among the session's scans; none for points from a file.
    pub scan_idx: Option<usize>,
    /// What it is called.
    pub name: String,
    /// The calibration and what it is called; none for points from a file.
    pub calibration: Option<(ScanCalibration, String)>,
    /// What is known of the part.
    pub known: Known,
    /// Profiles of the scan.
    pub num_profiles: Option<usize>,
    /// The points.
    pub cloud: Arc<Cloud>,
    /// The regions and their planes.
    pub regions: Vec<Region>,
    /// Teeth and diameters.
    pub shapes: Shapes,
    /// What was looked for.
    pub wanted: Wanted,
}

/// What a job brings back.
#[derive(Debug)]
enum Outcome {
    Examined(Box<ExaminedScan>),
    Regions { id: u64, regions: Vec<Region> },
    Shapes { id: u64, wanted: Wanted, shapes: Shapes },
    Exported(String),
    Cancelled,
}

/// Why nothing came of an examination.
#[derive(Clone, Debug)]
pub struct ScanFailure {
    /// The revision of the document.
    pub revision: u64,
    /// Why not.
    pub reason: String,
}

/// The scans of the workbench.
#[derive(Debug, Default)]
pub struct Scans {
    examined: Option<ExaminedScan>,
    failure: Option<ScanFailure>,
    working: Slot<Result<Outcome, String>>,
    exporting: Slot<Result<Outcome, String>>,
    /// The scan and calibration that the user chose last.
    chosen: Option<(usize, ScanCalibration)>,
    /// Whether an examination of that is under way.
    is_examining: bool,
    /// The regions before each change to them, the last one at the end.
    regions_before: Vec<Vec<Region>>,
    last_id: u64,
}

/// Regions that share more than this part of their points are the same.
const SAME_REGION: f64 = 0.7;
/// So many changes to the regions can be taken back.
const MOST_UNDONE: usize = 50;

impl Scans {
    /// The scan on the bench.
    #[must_use]
    pub const fn examined(&self) -> Option<&ExaminedScan> {
        self.examined.as_ref()
    }

    /// The scan and the calibration that were asked for last.
    #[must_use]
    pub const fn chosen(&self) -> Option<&(usize, ScanCalibration)> {
        self.chosen.as_ref()
    }

    /// Why the last examination brought nothing.
    #[must_use]
    pub const fn failure(&self) -> Option<&ScanFailure> {
        self.failure.as_ref()
    }

    /// Whether a scan, its regions or shapes are being worked on.
    #[must_use]
    pub const fn is_working(&self) -> bool {
        self.working.is_running()
    }

    /// Whether a change to the regions can be taken back.
    #[must_use]
    pub const fn can_undo_regions(&self) -> bool {
        !self.regions_before.is_empty()
    }

    /// How far the export is, while there is one.
    #[must_use]
    pub fn export_progress(&self) -> Option<Progress> {
        self.exporting.progress().map(|(done, total)| Progress { done, total })
    }

    pub(super) const fn is_busy(&self) -> bool {
        self.working.is_running() || self.exporting.is_running()
    }

    /// Other regions for the scan on the bench; what they replace can be had back.
    fn set_regions(&mut self, regions: Vec<Region>) {
        let id = self.next_id();
        if let Some(scan) = &mut self.examined {
            scan.regions_id = id;
            self.regions_before.push(std::mem::replace(&mut scan.regions, regions));
            let num_forgotten = self.regions_before.len().saturating_sub(MOST_UNDONE);
            self.regions_before.drain(..num_forgotten);
        }
    }

    const fn next_id(&mut self) -> u64 {
        self.last_id += 1;
        self.last_id
    }
}

impl Workbench {
    /// Scanned parts.
    #[must_use]
    pub const fn scans(&self) -> &Scans {
        &self.scans
    }

    pub(super) fn command_scans(&mut self, command: ScanCommand) {
        match command {
            ScanCommand::Examine { scan_idx, calibration } => self.examine_scan(scan_idx, calibration),
            ScanCommand::UseCalibration(path) => {
                let scan_idx = self.scans.chosen.as_ref().map_or(0, |(scan_idx, _)| *scan_idx);
                self.examine_scan(scan_idx, ScanCalibration::File(path));
            }
            ScanCommand::OpenPoints(path) => self.open_points(path),
            ScanCommand::FindPlanes => {
                let found = self.scans.examined.as_ref().map(|scan| scan.shapes.clone()).unwrap_or_default();
                self.change_regions(move |_, cloud, watch| {
                    Ok(plane_regions(cloud, &SegmentOptions::default(), &found, watch).ok())
                });
            }
            ScanCommand::AddRegion(choice) => self.change_regions(move |mut regions, cloud, _| {
                let set = match choice {
                    RegionChoice::Plane(seed_mm) => {
                        let all = PointSet::all(cloud);
                        grow_plane(cloud, &all, seed_mm, suitable_tolerance_mm(cloud, &all))
                    }
                    RegionChoice::Rectangle(right, down, corners) => PointSet::in_polygon(cloud, right, down, &corners),
                };
                let set = set.map_err(|error| error.to_string())?;
                if set.is_empty() {
                    return Err(words::EMPTY_REGION.to_owned());
                }
                if let Some(known) = regions.iter().find(|known| known.set.shared_with(&set) > SAME_REGION) {
                    return Err(words::region_is_known(&known.name));
                }
                let is_free = |name: &String| regions.iter().all(|region| region.name != *name);
                let name = (0..=regions.len()).map(region_name).find(is_free);
                regions.push(Region::new(cloud, name.unwrap_or_default(), set));
                Ok(Some(regions))
            }),
            ScanCommand::RenameRegion(idx, name) => {
                if let Some(region) = self.scans.examined.as_mut().and_then(|scan| scan.regions.get_mut(idx)) {
                    region.name = name;
                }
            }
            ScanCommand::RemoveRegion(idx) => {
                let regions = self.scans.examined.as_ref().map(|scan| scan.regions.clone()).unwrap_or_default();
                if idx < regions.len() {
                    let mut regions = regions;
                    regions.remove(idx);
                    self.scans.set_regions(regions);
                }
            }
            ScanCommand::UndoRegions => {
                if let Some(regions) = self.scans.regions_before.pop() {
                    self.scans.set_regions(regions);
                    // Taking back is no change that could be taken back.
                    self.scans.regions_before.pop();
                }
            }
            ScanCommand::Measure(wanted) => {
                let Some(scan) = &self.scans.examined else { return };
                let (id, cloud) = (scan.id, Arc::clone(&scan.cloud));
                self.scans.working.start("measure shapes", &self.wake, move |_| {
                    Ok(Outcome::Shapes { id, wanted, shapes: shapes(&cloud, &PointSet::all(&cloud), wanted) })
                });
            }
            ScanCommand::Export(path) => self.export_points(path),
            ScanCommand::Cancel => {
                self.scans.working.cancel();
                self.scans.exporting.cancel();
                if std::mem::take(&mut self.scans.is_examining) {
                    // It is not begun again by itself.
                    let revision = self.document.as_ref().map_or(0, |document| document.revision);
                    self.scans.failure = Some(ScanFailure { revision, reason: words::CANCELLED.to_owned() });
                }
            }
        }
    }

    /// Another document: its scans are others.
    pub(super) fn forget_scans(&mut self) {
        self.scans = Scans { last_id: self.scans.last_id, ..Scans::default() };
    }

    fn examine_scan(&mut self, scan_idx: usize, calibration: ScanCalibration) {
        let Some(document) = &self.document else { return };
        let (session, revision) = (Arc::clone(&document.session), document.revision);
        let results = self.results.as_ref().filter(|results| self.is_current(results.revision)).cloned();
        let id = self.scans.next_id();
        self.scans.chosen = Some((scan_idx, calibration.clone()));
        self.scans.is_examining = true;
        self.scans.failure = None;
        let known = self.known_readings();
        self.scans.working.start("examine scan", &self.wake, move |watch| {
            let found = match (&calibration, results) {
                (ScanCalibration::Best, Some(results)) if best_available(&results.methods).is_some() => {
                    best_available(&results.methods).map(NamedCalibration::of)
                }
                (ScanCalibration::Of(method), Some(results)) => {
                    solution_of(&results.methods, *method).map(NamedCalibration::of)
                }
                _ => None,
            };
            let found = match found {
                Some(found) => found,
                None => calibration_of(&session, known.as_deref(), &calibration, watch)?,
            };
            let scans = session.scans();
            let scan = scans.get(scan_idx).ok_or_else(|| words::NO_SCAN.to_owned())?;
            let cloud =
                Cloud::from_scan(&scan.captures, &found.flange_from_sensor).map_err(|error| error.to_string())?;
            let wanted = scan.known.wanted();
            let cloud = Arc::new(cloud);
            let shapes = shapes(&cloud, &PointSet::all(&cloud), wanted);
            let Ok(regions) = plane_regions(&cloud, &SegmentOptions::default(), &shapes, watch) else {
                return Ok(Outcome::Cancelled);
            };
            Ok(Outcome::Examined(Box::new(ExaminedScan {
                id,
                regions_id: id,
                revision,
                scan_idx: Some(scan_idx),
                name: words::scan_name(scan),
                calibration: Some((calibration, found.name)),
                known: scan.known,
                num_profiles: Some(scan.captures.len()),
                cloud,
                regions,
                shapes,
                wanted,
            })))
        });
    }

    fn open_points(&mut self, path: PathBuf) {
        let revision = self.document.as_ref().map_or(0, |document| document.revision);
        let id = self.scans.next_id();
        self.scans.is_examining = false;
        self.scans.failure = None;
        self.scans.working.start("read points", &self.wake, move |watch| {
            let read = read_cloud(&path, watch).map_err(|error| error.to_string())?;
            let cloud = Arc::new(read.cloud);
            let Ok(regions) = plane_regions(&cloud, &SegmentOptions::default(), &Shapes::default(), watch) else {
                return Ok(Outcome::Cancelled);
            };
            Ok(Outcome::Examined(Box::new(ExaminedScan {
                id,
                regions_id: id,
                revision,
                scan_idx: None,
                name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
                calibration: None,
                known: Known::default(),
                num_profiles: None,
                cloud,
                regions,
                shapes: Shapes::default(),
                wanted: Wanted::default(),
            })))
        });
    }

    /// Works out other regions; `None` where nobody wants them any more.
    fn change_regions(
        &mut self,
        change: impl FnOnce(Vec<Region>, &Cloud, &mut JobWatch) -> Result<Option<Vec<Region>>, String> + Send + 'static,
    ) {
        let Some(scan) = &self.scans.examined else { return };
        let (id, cloud, regions) = (scan.id, Arc::clone(&scan.cloud), scan.regions.clone());
        self.scans.working.start("regions", &self.wake, move |watch| {
            let regions = change(regions, &cloud, watch)?;
            Ok(regions.map_or(Outcome::Cancelled, |regions| Outcome::Regions { id, regions }))
        });
    }

    fn export_points(&mut self, path: PathBuf) {
        let Some(scan) = &self.scans.examined else { return };
        let cloud = Arc::clone(&scan.cloud);
        self.scans.exporting.start("export points", &self.wake, move |watch| {
            let written = CloudFormat::of(&path).and_then(|format| write_cloud(&cloud, &path, format, watch));
            written.map_err(|error| error.to_string())?;
            Ok(Outcome::Exported(words::wrote_cloud(&path.display().to_string(), cloud.len())))
        });
    }

    pub(super) fn poll_scans(&mut self) -> bool {
        let outcomes = [self.scans.working.poll(), self.scans.exporting.poll()];
        let mut changed = false;
        for outcome in outcomes.into_iter().flatten() {
            changed = true;
            match outcome {
                JobOutcome::Done(Ok(outcome)) => self.take_scan_outcome(outcome),
                JobOutcome::Done(Err(reason)) => {
                    if std::mem::take(&mut self.scans.is_examining) {
                        let revision = self.document.as_ref().map_or(0, |document| document.revision);
                        self.scans.failure = Some(ScanFailure { revision, reason });
                    } else {
                        self.notify(NoticeKind::Error, reason);
                    }
                }
                broken => self.notify_broken("the examination of the scan", &broken),
            }
        }
        changed
    }

    fn take_scan_outcome(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Examined(scan) => {
                self.scans.is_examining = false;
                self.scans.examined = Some(*scan);
                self.scans.regions_before.clear();
            }
            Outcome::Regions { id: scan_id, regions } => {
                if self.scans.examined.as_ref().is_some_and(|scan| scan.id == scan_id) {
                    self.scans.set_regions(regions);
                }
            }
            Outcome::Shapes { id: scan_id, wanted, shapes } => {
                if let Some(scan) = self.scans.examined.as_mut().filter(|scan| scan.id == scan_id) {
                    scan.wanted = wanted;
                    scan.shapes = shapes;
                }
            }
            Outcome::Exported(message) => self.notify(NoticeKind::Done, message.trim_end().to_owned()),
            Outcome::Cancelled => {}
        }
    }
}

fn calibration_of(
    session: &Session,
    known: Option<&Measured>,
    calibration: &ScanCalibration,
    watch: &mut dyn Watch,
) -> Result<NamedCalibration, String> {
    match calibration {
        ScanCalibration::Truth => {
            let truth: Option<Transform<Flange, Sensor>> = session.truth.as_ref().map(|truth| truth.flange_from_sensor);
            let flange_from_sensor = truth.ok_or_else(|| words::no_calibration(words::NO_TRUTH))?;
            Ok(NamedCalibration { name: words::TRUTH.to_owned(), flange_from_sensor })
        }
        ScanCalibration::File(path) => {
            read_calibration(path).map(ReadCalibration::named).map_err(|error| error.to_string())
        }
        ScanCalibration::Verified(named) => Ok(named.clone()),
        ScanCalibration::Of(method) => Err(words::no_calibration(&words::no_result_of(*method))),
        ScanCalibration::Best => measure(session, known, watch)
            .and_then(|measured| best_solution(session, &measured, watch))
            .map_err(|cancelled| cancelled.to_string())?
            .map(|solution| NamedCalibration::of(&solution))
            .map_err(|reason| words::no_calibration(&reason)),
    }
}
