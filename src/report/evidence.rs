//! All that is computed of a session: what the methods make of each of its targets, what is wrong with it, what the
//! calibration is worth on other data, and the parts that were scanned.

use crate::calibrate::{MethodResult, Problem, Solution, best_available};
use crate::diagnose::{Diagnosis, diagnose_any};
use crate::geometry::{Flange, Sensor, Transform};
use crate::plan::{Limits, Plan, next_stations};
use crate::scan::{Cloud, PointSet, Region, ScanError, SegmentOptions, Shapes, plane_regions, shapes};
use crate::session::{self, FurtherTarget, Known, Measured, Session, SessionScan, measure};
use crate::text::verify::own_target_name;
use crate::text::workpiece as scan_words;
use crate::verify::{Calibration, Verification};
use crate::watch::{Cancelled, Watch};

use super::calibration_file::NamedCalibration;
use super::result_file::Examination;
use super::verification::{SolvedTarget, verification};

/// What is wrong with a session, and where to measure next.
#[derive(Clone, Debug)]
pub struct Examined {
    /// What is wrong with it.
    pub diagnosis: Diagnosis,
    /// The pose that would help most; `None` without a solution, or where something has to be mended first.
    pub plan: Option<Plan>,
}

impl Examined {
    /// Looks for faults, and plans one station where that makes sense.
    ///
    /// # Errors
    /// [`Cancelled`] if `watch` says so.
    pub fn new(
        session: &Session,
        problem: &Problem,
        results: &[MethodResult],
        watch: &mut dyn Watch,
    ) -> Result<Self, Cancelled> {
        /// One pose is a hint; `handeye plan` plans more.
        const NUM_PLANNED: usize = 1;
        let diagnosis = diagnose_any(session, problem, results, watch)?;
        let plan = best_available(results)
            .filter(|_| diagnosis.allows_planning())
            .and_then(|solution| next_stations(solution, &Limits::default(), NUM_PLANNED).ok());
        Ok(Self { diagnosis, plan })
    }

    /// As result files hold it.
    #[must_use]
    pub const fn examination(&self) -> Examination<'_> {
        Examination { diagnosis: &self.diagnosis, plan: self.plan.as_ref(), bootstrap: None }
    }
}

/// What was computed from one target.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Its data.
    pub problem: Problem,
    /// One entry a method.
    pub results: Vec<MethodResult>,
    /// What is wrong with it.
    pub examined: Examined,
}

/// One of the targets of a session.
#[derive(Clone, Debug)]
pub struct TargetEvidence {
    /// What it is called.
    pub name: String,
    /// The session as if this were its only target.
    pub session: Session,
    /// Its readings.
    pub measured: Measured,
    /// What was computed from it, or why nothing can be.
    pub outcome: Result<Solved, String>,
}

impl TargetEvidence {
    fn new(name: String, session: Session, known: Option<&Measured>, watch: &mut dyn Watch) -> Result<Self, Cancelled> {
        let measured = measure(&session, known, watch)?;
        let outcome = match session::problem(&session, &measured) {
            Err(refusal) => Err(refusal.to_string()),
            Ok(problem) => {
                let results = problem.solve_all(problem.methods(), watch)?;
                let examined = Examined::new(&session, &problem, &results, watch)?;
                Ok(Solved { problem, results, examined })
            }
        };
        Ok(Self { name, session, measured, outcome })
    }

    /// The results of its methods; none where nothing can be computed from it.
    #[must_use]
    pub fn results(&self) -> &[MethodResult] {
        self.outcome.as_ref().map_or(&[], |solved| &solved.results)
    }

    /// The result to use.
    #[must_use]
    pub fn best(&self) -> Option<&Solution> {
        best_available(self.results())
    }

    /// Whether a ball's radius was computed with: it is not where all readings in use are centres already.
    #[must_use]
    pub fn uses_radius(&self) -> bool {
        let in_use = self.session.stations.iter().filter(|station| station.enabled);
        let mut readings = in_use.flat_map(|station| &station.captures).map(|capture| &capture.reading);
        matches!(self.session.target, session::Target::Ball { .. })
            && readings.any(|reading| matches!(reading, session::Reading::Profile(_)))
    }

    /// What is wrong with it.
    #[must_use]
    pub fn diagnosis(&self) -> Option<&Diagnosis> {
        self.outcome.as_ref().ok().map(|solved| &solved.examined.diagnosis)
    }
}

/// A scanned part, seen through a calibration.
#[derive(Clone, Debug)]
pub struct PartEvidence {
    /// What the scan is called.
    pub name: String,
    /// Its profiles.
    pub num_profiles: usize,
    /// What the calibration is called.
    pub calibration: String,
    /// What is known of the part.
    pub known: Known,
    /// What was measured on it, or why nothing can be.
    pub outcome: Result<MeasuredPart, ScanError>,
}

/// What was measured on a scanned part.
#[derive(Clone, Debug)]
pub struct MeasuredPart {
    /// Its points in the base.
    pub cloud: Cloud,
    /// Its planes.
    pub regions: Vec<Region>,
    /// Its teeth and diameters.
    pub shapes: Shapes,
}

/// All that is computed of a session.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// The session.
    pub session: Session,
    /// Its targets: its own, whatever it is, then the further ones that are more than scanned parts.
    pub targets: Vec<TargetEvidence>,
    /// Every calibration on every target; `None` where there is no calibration.
    pub verification: Option<Verification>,
    /// The parts that were scanned; empty where there is no calibration to see them through.
    pub parts: Vec<PartEvidence>,
}

impl Evidence {
    /// Computes everything of a session and its readings. Calibrations that are `given` are judged along.
    ///
    /// # Errors
    /// [`Cancelled`] if `watch` says so.
    pub fn gather(
        session: &Session,
        measured: &Measured,
        given: &[Calibration],
        watch: &mut dyn Watch,
    ) -> Result<Self, Cancelled> {
        let own = own_target_name(&session.target).to_owned();
        let mut targets = vec![TargetEvidence::new(own, only_own(session), Some(measured), watch)?];
        for further in &session.further {
            if further.target != session::Target::Workpiece {
                targets.push(TargetEvidence::new(further.name.clone(), only(session, further), None, watch)?);
            }
        }
        let verification = found_on_other_data(session, measured, &targets, given, watch)?;
        let mut evidence = Self { session: session.clone(), targets, verification, parts: Vec::new() };
        if let Some(calibration) = evidence.calibration_for_scans() {
            let scans = session.scans();
            // A part's scans together, and each by itself only where it is the only one.
            let first_of_each = scans.chunk_by(|a, b| a.target_name == b.target_name).filter_map(<[_]>::first);
            evidence.parts =
                first_of_each.map(|scan| examined_part(scan, &calibration, watch)).collect::<Result<_, _>>()?;
        }
        Ok(evidence)
    }

    /// The target whose calibration is the answer: the first that has one, the session's own before others.
    #[must_use]
    pub fn answer(&self) -> Option<(&TargetEvidence, &Solution)> {
        self.targets.iter().find_map(|target| Some((target, target.best()?)))
    }

    /// Why there is no calibration: the own target's reason.
    #[must_use]
    pub fn refusal(&self) -> Option<String> {
        if self.answer().is_some() {
            return None;
        }
        let own = self.targets.first()?;
        own.outcome.as_ref().err().cloned().or_else(|| {
            let reason = |result: &MethodResult| result.outcome.as_ref().err().map(ToString::to_string);
            own.results().iter().find_map(reason)
        })
    }

    /// The answer, else the first calibration given, else the truth of a simulated session.
    fn calibration_for_scans(&self) -> Option<NamedCalibration> {
        let named = |name: &str, flange_from_sensor: &Transform<Flange, Sensor>| NamedCalibration {
            name: name.to_owned(),
            flange_from_sensor: *flange_from_sensor,
        };
        let answer = self.answer().map(|(_, solution)| NamedCalibration::of(solution));
        let given = || {
            let verification = self.verification.as_ref()?;
            let first = verification.calibrations.first()?;
            Some(named(&crate::text::verify::calibration_name(&first.origin, verification), &first.flange_from_sensor))
        };
        let truth = || Some(named(scan_words::TRUTH, &self.session.truth.as_ref()?.flange_from_sensor));
        answer.or_else(given).or_else(truth)
    }
}

fn only_own(session: &Session) -> Session {
    Session { further: Vec::new(), ..session.clone() }
}

/// The session as if a further target were its only one.
fn only(session: &Session, further: &FurtherTarget) -> Session {
    let mut alone = Session { published: None, ..only_own(session) };
    alone.target = further.target.clone();
    alone.known = further.known;
    alone.stations.clone_from(&further.stations);
    alone.sensor.profile_std_mm = further.profile_std_mm.or(session.sensor.profile_std_mm);
    alone
}

fn found_on_other_data(
    session: &Session,
    measured: &Measured,
    targets: &[TargetEvidence],
    given: &[Calibration],
    watch: &mut dyn Watch,
) -> Result<Option<Verification>, Cancelled> {
    let mut solved = targets.iter().map(|target| target.outcome.as_ref().ok());
    let own = solved.next().flatten().map(|own| (&own.problem, own.results.as_slice()));
    let further: Vec<SolvedTarget> = solved
        .flatten()
        .map(|solved| SolvedTarget { problem: solved.problem.clone(), results: solved.results.clone() })
        .collect();
    let found = verification(session, measured, own, given, &further, watch)?;
    Ok((!found.calibrations.is_empty()).then_some(found))
}

fn examined_part(
    scan: &SessionScan,
    calibration: &NamedCalibration,
    watch: &mut dyn Watch,
) -> Result<PartEvidence, Cancelled> {
    let known = scan.known;
    let outcome = match Cloud::from_scan(&scan.captures, &calibration.flange_from_sensor) {
        Err(error) => Err(error),
        Ok(cloud) => {
            let shapes = shapes(&cloud, &PointSet::all(&cloud), known.wanted());
            let regions = plane_regions(&cloud, &SegmentOptions::default(), &shapes, watch)?;
            Ok(MeasuredPart { cloud, regions, shapes })
        }
    };
    Ok(PartEvidence {
        name: scan_words::scan_name(scan),
        num_profiles: scan.captures.len(),
        calibration: calibration.name.clone(),
        known,
        outcome,
    })
}
