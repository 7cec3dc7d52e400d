//! What the poses alone show: too little rotation, one axis, twins, travel and steps.

use crate::calibrate::ball::MIN_STATIONS;
use crate::calibrate::rotation_start::{PoseGeometry, rotation_span};
use crate::calibrate::{
    BallProblem, Capture, Method, Mount, ONE_AXIS_RATIO, RECOMMENDED_SPAN_DEG, Reading, SolveError, Station,
    best_available, solution_of,
};
use crate::geometry::so3::{self, nearest_rotation};
use crate::geometry::{Mat3, Rigid, Vec3, stats};
use crate::session::check::{STEP_TOLERANCE_MM, STEP_TOLERANCE_RATIO, TWIN_ANGLE_DEG, TWIN_DISTANCE_MM};

use super::Case;
use super::finding::{Evidence, Fault, Finding, Plot, Severity};
use super::model::FAR_OFF_PART;

/// Travel may be off the laser's normal by this, degrees, before it is worth a finding.
const OFF_NORMAL_DEG: f64 = 2.0;
/// A deviation counts from so many times what the noise makes of it.
const AT_STDS: f64 = 5.0;

/// What there is to find.
#[must_use]
pub fn examine(case: Case<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> = rotation(case).into_iter().collect();
    findings.extend(twin_poses(case));
    findings.extend(travel_off_normal(case));
    findings.extend(step_differs_from_pose(case.problem));
    findings
}

fn finding(fault: Fault, severity: Severity, plot: Option<Plot>) -> Finding {
    Finding { fault, severity, explains: 1.0, evidence: Evidence { residual_mm: None, plot }, remedy: None }
}

/// The poses of the stations that show something, or of all where too few do.
fn first_poses(problem: &BallProblem) -> Vec<Rigid> {
    let first = |station: &Station| station.captures.first().map(|capture| *capture.base_from_flange.rigid());
    let shows =
        |station: &&Station| station.captures.iter().any(|capture| !matches!(capture.reading, Reading::Refused(_)));
    let usable: Vec<Rigid> = problem.stations.iter().filter(shows).filter_map(first).collect();
    if usable.len() >= MIN_STATIONS { usable } else { problem.stations.iter().filter_map(first).collect() }
}

fn rotation(case: Case<'_>) -> Option<Finding> {
    let poses = first_poses(case.problem);
    if poses.len() < 2 {
        return None;
    }
    let span_deg = rotation_span(&poses).to_degrees();
    let principal = PrincipalRotations::new(&poses);
    let plot = |in_flange: Vec3| {
        let rotations_deg = principal.as_ref().map_or([0.0; 3], |principal| principal.rms_deg);
        Some(Plot::Direction { in_flange, rotations_deg })
    };
    match PoseGeometry::new(&poses) {
        Err(SolveError::NoRotation { span_deg }) => {
            Some(finding(Fault::NoRotation { span_deg }, Severity::Wrong, None))
        }
        Err(SolveError::RotationsAboutOneAxis { axis_x, axis_y, axis_z }) => {
            let axis_in_flange = Vec3::new(axis_x, axis_y, axis_z);
            Some(finding(Fault::OneAxis { axis_in_flange, ratio: None }, Severity::Wrong, plot(axis_in_flange)))
        }
        Err(_) => None,
        Ok(geometry) => {
            let [least, _, most] = geometry.axis_movements;
            let ratio = (most / least).sqrt();
            let axis_in_flange = geometry.common_axis_in_flange;
            if ratio > ONE_AXIS_RATIO {
                let fault = Fault::OneAxis { axis_in_flange, ratio: Some(ratio) };
                return Some(finding(fault, Severity::Doubtful, plot(axis_in_flange)));
            }
            let weakest = best_available(case.results)
                .and_then(|solution| solution.uncertainty.as_ref())
                .map(crate::calibrate::Uncertainty::weakest_direction);
            let in_flange = weakest.map_or(axis_in_flange, |(direction, _)| direction);
            let fault = Fault::LittleRotation { span_deg, recommended_deg: RECOMMENDED_SPAN_DEG, weakest };
            (span_deg < RECOMMENDED_SPAN_DEG).then(|| finding(fault, Severity::Doubtful, plot(in_flange)))
        }
    }
}

/// How far the orientations turn from their mean.
struct PrincipalRotations {
    /// RMS about the principal axes, least first, degrees.
    rms_deg: [f64; 3],
}

impl PrincipalRotations {
    fn new(poses: &[Rigid]) -> Option<Self> {
        let sum: Mat3 = poses.iter().map(|pose| *pose.rotation.to_rotation_matrix().matrix()).sum();
        let mean_inverse = nearest_rotation(&sum)?.inverse();
        let spread: Mat3 = poses
            .iter()
            .map(|pose| {
                let turn = so3::log(&(mean_inverse * pose.rotation));
                turn * turn.transpose()
            })
            .sum();
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        let count = poses.len() as f64;
        let mut squares: Vec<f64> = (spread / count).symmetric_eigenvalues().iter().copied().collect();
        squares.sort_by(f64::total_cmp);
        Some(Self { rms_deg: [0, 1, 2].map(|idx| squares[idx].max(0.0).sqrt().to_degrees()) })
    }
}

/// Every station that stands where an earlier one stood, once.
fn twin_poses(case: Case<'_>) -> Vec<Finding> {
    let poses: Vec<(usize, Rigid)> = case
        .session
        .stations
        .iter()
        .enumerate()
        .filter(|(_, station)| station.enabled)
        .filter_map(|(idx, station)| Some((idx, *station.captures.first()?.base_from_flange.rigid())))
        .collect();
    let twins: Vec<Fault> = poses
        .iter()
        .enumerate()
        .filter_map(|(at, (idx, pose))| {
            poses[..at].iter().find_map(|(earlier_idx, earlier)| {
                let distance_mm = (pose.translation.vector - earlier.translation.vector).norm();
                let angle_deg = pose.rotation.angle_to(&earlier.rotation).to_degrees();
                (distance_mm < TWIN_DISTANCE_MM && angle_deg < TWIN_ANGLE_DEG).then_some(Fault::TwinPoses {
                    station_idxs: [*earlier_idx, *idx],
                    distance_mm,
                    angle_deg,
                })
            })
        })
        .collect();
    let severity = if poses.len() < MIN_STATIONS + twins.len() { Severity::Wrong } else { Severity::Note };
    twins.into_iter().map(|fault| finding(fault, severity, None)).collect()
}

fn travel_off_normal(case: Case<'_>) -> Option<Finding> {
    let solution = solution_of(case.results, Method::BallMaxArc)?;
    if solution.scatter.rms_mm > FAR_OFF_PART * case.problem.radius_mm {
        // The laser's normal is that of a solution which says nothing.
        return None;
    }
    let noise_mm = across_travel_std_mm(case.problem);
    let (station_idx, angle_deg) = solution
        .stations
        .iter()
        .filter_map(|station| {
            let sweep = station.sweep.as_ref()?;
            let extent_mm = stats::max(sweep.points.iter().map(|point| point.travel_mm.abs()));
            // The direction is that of a line through the first capture, whose noise turns it most.
            let noise_deg = (1.5 * noise_mm / extent_mm).to_degrees();
            let angle_deg = sweep.travel_off_normal_rad.to_degrees();
            (angle_deg > OFF_NORMAL_DEG.max(AT_STDS * noise_deg)).then_some((station.station_idx, angle_deg))
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let published_only = best_available(case.results).is_some_and(|best| best.method == Method::BallMaxArcStep);
    let severity = if published_only { Severity::Doubtful } else { Severity::Note };
    Some(finding(Fault::TravelOffNormal { station_idx, angle_deg }, severity, None))
}

/// Standard deviation of the robot's positions across the straight lines of the sweeps, a coordinate, mm; 0 without any.
fn across_travel_std_mm(problem: &BallProblem) -> f64 {
    let (mut squares, mut freedom) = (0.0, 0.0);
    for station in problem.stations.iter().filter(|station| station.captures.len() > 2) {
        let positions: Vec<Vec3> = station.captures.iter().map(|capture| position(capture, problem.mount)).collect();
        #[expect(clippy::cast_precision_loss, reason = "a sweep has few steps")]
        let count = positions.len() as f64;
        let mean = positions.iter().sum::<Vec3>() / count;
        let spread: Mat3 = positions.iter().map(|at| (at - mean) * (at - mean).transpose()).sum();
        let eigenvalues = spread.symmetric_eigenvalues();
        squares += eigenvalues.sum() - eigenvalues.max();
        freedom += 2.0 * (count - 2.0);
    }
    if freedom > 0.0 { (squares / freedom).max(0.0).sqrt() } else { 0.0 }
}

/// Where the robot is in its base.
fn position(capture: &Capture, mount: Mount) -> Vec3 {
    let pose = capture.base_from_flange.rigid();
    match mount {
        Mount::OnFlange => pose.translation.vector,
        Mount::Fixed => pose.inverse().translation.vector,
    }
}

/// Commanded travel and travel by the poses, from the first capture of a station, mm.
struct Travel {
    station_idx: usize,
    commanded_mm: f64,
    moved_mm: f64,
}

fn travels(problem: &BallProblem) -> Vec<Travel> {
    problem.stations.iter().flat_map(|station| station_travels(station, problem.mount)).collect()
}

fn station_travels(station: &Station, mount: Mount) -> Vec<Travel> {
    let Some(first) = station.captures.first().map(|capture| position(capture, mount)) else {
        return Vec::new();
    };
    let moves: Vec<(f64, Vec3)> = station
        .captures
        .iter()
        .skip(1)
        .filter_map(|capture| Some((capture.commanded_travel_mm?, position(capture, mount) - first)))
        .collect();
    // Along the station's own direction, as the distances themselves grow by the noise across it.
    let direction = moves.iter().map(|(commanded, moved)| moved * *commanded).sum::<Vec3>();
    let direction = direction.try_normalize(1e-9).unwrap_or_else(Vec3::zeros);
    let travel = |(commanded_mm, moved): (f64, Vec3)| Travel {
        station_idx: station.idx,
        commanded_mm,
        moved_mm: direction.dot(&moved),
    };
    moves.into_iter().map(travel).collect()
}

fn step_differs_from_pose(problem: &BallProblem) -> Option<Finding> {
    let travels = travels(problem);
    let squares: f64 = travels.iter().map(|travel| travel.commanded_mm.powi(2)).sum();
    let ratio = travels.iter().map(|travel| travel.commanded_mm * travel.moved_mm).sum::<f64>() / squares;
    if !ratio.is_finite() {
        return None;
    }
    let difference = |travel: &Travel| (travel.moved_mm - travel.commanded_mm).abs();
    let worst = travels.iter().max_by(|a, b| difference(a).total_cmp(&difference(b)))?;
    let mut about_line: Vec<f64> = travels.iter().map(|travel| travel.moved_mm - ratio * travel.commanded_mm).collect();
    let noise_mm = stats::robust_std_about_zero(&mut about_line);
    let mut steps: Vec<f64> = step_lengths(problem);
    let step_mm = stats::median(&mut steps);
    let tolerance_mm = STEP_TOLERANCE_MM.max(STEP_TOLERANCE_RATIO * step_mm).max(AT_STDS * noise_mm);
    let (station_idx, difference_mm) = (worst.station_idx, difference(worst));
    (difference_mm > tolerance_mm).then(|| {
        let steps = travels.iter().map(|travel| [travel.commanded_mm, travel.moved_mm]).collect();
        let fault = Fault::StepDiffersFromPose { station_idx, ratio, difference_mm };
        finding(fault, Severity::Doubtful, Some(Plot::Steps(steps)))
    })
}

fn step_lengths(problem: &BallProblem) -> Vec<f64> {
    problem
        .stations
        .iter()
        .flat_map(|station| station.captures.windows(2))
        .filter_map(|pair| Some((pair[1].commanded_travel_mm? - pair[0].commanded_travel_mm?).abs()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::solve_all;
    use crate::session::{Session, ball_problem, measure};
    use crate::simulate::{self, SimulationOptions, simulate};
    use crate::watch::Unwatched;

    fn options(mount: Mount) -> SimulationOptions {
        SimulationOptions {
            seed: 5,
            mount,
            num_steps: 9,
            step_mm: 1.8,
            num_points: 200,
            ..SimulationOptions::default()
        }
    }

    fn found(session: &Session, methods: &[Method]) -> Vec<Finding> {
        let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
        let problem = ball_problem(session, &measured).expect("a ball");
        let results = solve_all(&problem, methods, &mut Unwatched).expect("not cancelled");
        examine(Case { session, problem: &problem, results: &results })
    }

    #[track_caller]
    fn only_finding(options: &SimulationOptions, methods: &[Method]) -> Finding {
        let mut findings = found(&simulate(options), methods);
        assert_eq!(findings.len(), 1, "{findings:#?} in {options:?}");
        findings.remove(0)
    }

    fn with_fault(fault: simulate::Fault) -> impl Iterator<Item = SimulationOptions> {
        [Mount::OnFlange, Mount::Fixed]
            .into_iter()
            .map(move |mount| SimulationOptions { fault: Some(fault), ..options(mount) })
    }

    #[test]
    fn clean_sessions_are_silent() {
        for mount in [Mount::OnFlange, Mount::Fixed] {
            let options = options(mount);
            let noisy = SimulationOptions { position_std_mm: 0.2, orientation_std_deg: 0.05, ..options.clone() };
            let short = SimulationOptions { num_steps: 4, step_mm: 0.3, ..noisy.clone() };
            for options in [options, noisy, short] {
                assert_eq!(found(&simulate(&options), &[Method::BallMaxArc]), [], "{options:?}");
            }
        }
    }

    #[test]
    fn poor_rotations_are_found_from_the_poses_alone() {
        for options in with_fault(simulate::Fault::NoRotation) {
            let finding = only_finding(&options, &[]);
            assert!(matches!(finding.fault, Fault::NoRotation { span_deg } if span_deg < 0.1), "{finding:?}");
            assert_eq!(finding.severity, Severity::Wrong);
        }
        for options in with_fault(simulate::Fault::LittleRotation) {
            let finding = only_finding(&options, &[]);
            assert!(matches!(finding.fault, Fault::LittleRotation { span_deg, weakest: None, .. } if span_deg < 20.0));
            let finding = only_finding(&options, &[Method::BallMaxArc]);
            let Fault::LittleRotation { weakest: Some((direction, std_mm)), .. } = finding.fault else {
                panic!("{finding:?}")
            };
            assert!((direction.norm() - 1.0).abs() < 1e-9 && std_mm > 0.0);
        }
    }

    #[test]
    fn rotations_about_one_axis_show_the_axis() {
        for fault_options in with_fault(simulate::Fault::OneAxis) {
            let finding = only_finding(&fault_options, &[]);
            let Fault::OneAxis { axis_in_flange, ratio: None } = finding.fault else { panic!("{finding:?}") };
            // The stations turn about the world's vertical, which is how the sensor looks.
            let upright = simulate(&SimulationOptions { num_stations: 1, ..options(fault_options.mount) });
            let pose = *upright.stations[0].captures[0].base_from_flange.rigid();
            let vertical_in_flange = match fault_options.mount {
                Mount::OnFlange => pose.rotation.inverse() * Vec3::z(),
                Mount::Fixed => pose.rotation * Vec3::z(),
            };
            assert!(axis_in_flange.cross(&vertical_in_flange).norm() < 1e-3, "{axis_in_flange} {vertical_in_flange}");
            let Some(Plot::Direction { rotations_deg, .. }) = finding.evidence.plot else { panic!("{finding:?}") };
            assert!(rotations_deg[1] < 0.1 && rotations_deg[2] > 20.0, "{rotations_deg:?}");
        }
        let nearly = SimulationOptions { tilt_deg: 2.0, ..options(Mount::OnFlange) };
        let finding = only_finding(&nearly, &[]);
        assert!(matches!(finding.fault, Fault::OneAxis { ratio: Some(ratio), .. } if ratio > 8.0), "{finding:?}");
        assert_eq!(finding.severity, Severity::Doubtful);
    }

    #[test]
    fn twins_are_a_note_until_too_few_stations_are_left() {
        for options in with_fault(simulate::Fault::TwinPoses) {
            let finding = only_finding(&options, &[]);
            let Fault::TwinPoses { station_idxs: [first, second], distance_mm, .. } = finding.fault else {
                panic!("{finding:?}")
            };
            assert!(first < second && distance_mm < TWIN_DISTANCE_MM && finding.severity == Severity::Note);
            let few = SimulationOptions { num_stations: 4, tilt_deg: 25.0, ..options };
            assert_eq!(only_finding(&few, &[]).severity, Severity::Wrong);
        }
    }

    #[test]
    fn travel_off_the_normal_shows_its_angle() {
        for options in with_fault(simulate::Fault::TravelOffNormal) {
            let finding = only_finding(&options, &[Method::BallMaxArc]);
            let Fault::TravelOffNormal { angle_deg, .. } = finding.fault else { panic!("{finding:?}") };
            // The largest of ten, each off by a tenth of a degree.
            assert!((angle_deg - 5.0).abs() < 0.5, "{angle_deg}");
        }
    }

    #[test]
    fn steps_that_the_robot_did_not_make_are_found() {
        for options in with_fault(simulate::Fault::StepDiffersFromPose) {
            let finding = only_finding(&options, &[]);
            let Fault::StepDiffersFromPose { ratio, difference_mm, .. } = finding.fault else { panic!("{finding:?}") };
            // The file's steps are 1.1 times the robot's, over a sweep of 8 × 1.8 mm.
            assert!((ratio - 1.0 / 1.1).abs() < 0.005 && (difference_mm - 1.44).abs() < 0.2, "{finding:?}");
            let Some(Plot::Steps(steps)) = &finding.evidence.plot else { panic!("{finding:?}") };
            assert_eq!(steps.len(), 10 * 8);
        }
    }
}
