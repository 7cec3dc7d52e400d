//! Planes, teeth, balls and cylinders of scanned parts whose sizes are known, and files of points.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

mod files;
mod parts;

use handeye::geometry::{Vec3, stats};
use handeye::scan::{
    Cloud, Deviation, PointSet, RoundKind, ScanError, SegmentOptions, angle_between, find_planes, fit_plane, fit_round,
    grow_plane, measure_teeth, random_distances,
};
use handeye::watch::Unwatched;
use parts::{Path, Surface, flange_from_sensor, rectangle, round, scan, teeth};

/// Estimates and truth differ by more than this many σ once in some ten thousand times.
const WITHIN_STD: f64 = 4.0;

fn cloud(surfaces: &[Surface], path: &Path, seed: u64) -> Cloud {
    Cloud::from_scan(&scan(surfaces, path, seed), &flange_from_sensor()).expect("points")
}

/// A block whose face A is x = 12.5 and whose face B is z = 170, on a table.
fn square_part() -> Vec<Surface> {
    vec![
        rectangle(Vec3::new(12.5, 0.0, 130.0), Vec3::y() * 60.0, Vec3::z() * 40.0),
        rectangle(Vec3::new(12.5, 0.0, 170.0), Vec3::y() * 60.0, Vec3::x() * 40.0),
        rectangle(Vec3::new(-60.0, -20.0, 130.0), Vec3::y() * 100.0, Vec3::x() * 200.0),
    ]
}

/// Along the edge of the block, seen from outside and above.
fn over_the_edge() -> Path {
    let edge = Vec3::new(12.5, 5.0, 170.0);
    Path::over(edge, edge + Vec3::y() * 50.0, Vec3::new(1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0))
}

#[test]
fn the_planes_of_a_square_part_are_found_and_stand_at_a_right_angle() {
    for seed in 1..=5 {
        let cloud = cloud(&square_part(), &over_the_edge(), seed);
        let regions =
            find_planes(&cloud, &PointSet::all(&cloud), &SegmentOptions::default(), &mut Unwatched).expect("no cancel");
        let fits: Vec<_> = regions.iter().map(|region| fit_plane(&cloud, region).expect("a plane")).collect();
        let find = |axis: usize, offset: f64| {
            let matches = |fit: &&handeye::scan::PlaneFit| {
                fit.plane.normal.iamax() == axis && (fit.equation().offset_mm - offset).abs() < 1.0
            };
            fits.iter().find(matches).unwrap_or_else(|| panic!("seed {seed}: {axis} = {offset} among {fits:#?}"))
        };
        let (a, b) = (find(0, 12.5), find(2, 170.0));
        for (fit, truth) in [(a, 12.5), (b, 170.0)] {
            let equation = fit.equation();
            // One number more than three σ off in twenty would be chance; four σ are none.
            assert!((equation.offset_mm - truth).abs() < WITHIN_STD * equation.offset_std_mm, "{seed}: {equation:?}");
            assert!(equation.offset_std_mm < 0.2, "{equation:?}");
            for axis in (0..3).filter(|axis| *axis != equation.leading) {
                let off = equation.coefficients[axis].abs();
                assert!(off < WITHIN_STD * equation.coefficient_stds[axis], "{seed}: {equation:?}");
            }
            assert!(fit.is_known_from_profiles() && fit.num_used * 10 > fit.num_points * 9, "{fit:?}");
        }
        let angle = angle_between(a, b);
        let off = (angle.angle_rad - std::f64::consts::FRAC_PI_2).abs();
        assert!(off < WITHIN_STD * angle.std_rad && angle.std_rad < 1e-3, "{angle:?}");
    }
}

#[test]
fn stated_uncertainty_is_that_of_repeated_scans() {
    // The noise of the robot is in whole profiles: a σ that took the points for independent would be ten times too small.
    let mut heights = Vec::new();
    let mut stds = Vec::new();
    for seed in 1..=60 {
        let part = [rectangle(Vec3::new(-100.0, -100.0, 50.0), Vec3::x() * 200.0, Vec3::y() * 200.0)];
        let path = Path {
            num_profiles: 40,
            num_points: 100,
            ..Path::over(Vec3::zeros(), Vec3::y() * 50.0, -Vec3::z(), Vec3::x())
        };
        let cloud = cloud(&part, &path, seed);
        let fit = fit_plane(&cloud, &PointSet::all(&cloud)).expect("a plane");
        heights.push(fit.plane.distance_mm(Vec3::new(0.0, 25.0, 50.0)));
        stds.push(fit.height_std_mm());
    }
    let ratio = stats::rms(heights) / stats::rms(stds);
    // Sixty samples tell a standard deviation to 9 %.
    assert!((0.72..1.28).contains(&ratio), "{ratio}");
}

#[test]
fn a_plane_is_fitted_through_points_of_something_else() {
    let cloud = cloud(&square_part(), &over_the_edge(), 3);
    // Face A with a corner of the table and the edge of B.
    let region = PointSet::in_box(&cloud, Vec3::new(-2.0, 0.0, 120.0), Vec3::new(20.0, 80.0, 175.0));
    let fit = fit_plane(&cloud, &region).expect("a plane");
    assert_eq!(fit.plane.normal.iamax(), 0, "{fit:?}");
    assert!((fit.equation().offset_mm - 12.5).abs() < 0.1, "{:?}", fit.equation());
    let grown = grow_plane(&cloud, &PointSet::all(&cloud), Vec3::new(12.5, 30.0, 160.0), 0.2).expect("a plane");
    let fit = fit_plane(&cloud, &grown).expect("a plane");
    assert!((fit.equation().offset_mm - 12.5).abs() < 0.1, "{:?}", fit.equation());
    let bounds = grown
        .indices()
        .map(|idx| cloud.point_mm(idx))
        .fold([f64::MAX, f64::MIN], |[low, high], point| [low.min(point.z), high.max(point.z)]);
    assert!(bounds[0] > 129.0 && bounds[1] < 171.0, "{bounds:?}");
    let distances = random_distances(&cloud, &grown, &fit.plane, 400, 1);
    assert_eq!(distances.len(), 400);
    // Within the tolerance that it was grown with, and a little of the edge.
    assert!(distances.iter().all(|distance| distance.abs() < 0.25));
}

#[test]
fn pitch_and_height_of_teeth_are_recovered() {
    let checks = [
        // Cut, the path's direction, the tilt of the sensor.
        (1.0, Vec3::x(), 0.0),
        (1.0, Vec3::y(), 0.0),
        (1.0, Vec3::x(), 0.1),
        (0.8, Vec3::x(), 0.0),
        (0.8, Vec3::y(), 0.05),
    ];
    for (number, (cut, along, tilt)) in (1..).zip(checks) {
        let height = 10.0 / cut;
        let surfaces = teeth(5, 15.0, height, cut, 40.0);
        let looks_along = Vec3::new(0.3 * tilt, tilt, -1.0);
        let path = if along == Vec3::x() {
            let from = Vec3::new(-1.0, 20.0, 5.0);
            Path { width: 30.0, num_profiles: 250, ..Path::over(from, from + Vec3::x() * 77.0, looks_along, Vec3::y()) }
        } else {
            let from = Vec3::new(37.5, 8.0, 5.0);
            Path { width: 78.0, num_profiles: 80, ..Path::over(from, from + Vec3::y() * 24.0, looks_along, Vec3::x()) }
        };
        let cloud = cloud(&surfaces, &path, number);
        let found = measure_teeth(&cloud, &PointSet::all(&cloud)).expect("teeth");
        assert_eq!(found.teeth.len(), 5, "{number}: {found:#?}");
        assert_eq!(found.pitches().count(), 4);
        assert!(found.along.x.abs() > 0.999 && found.up.z > 0.999 && found.ridge.y.abs() > 0.999, "{found:?}");
        for (nominal, values) in [(15.0, found.pitches().collect::<Vec<_>>()), (10.0, found.heights().collect())] {
            for measured in &values {
                let off = (measured.value_mm - nominal).abs();
                // Half a micrometre more: the tips are points of a grid, and not where the flanks meet.
                assert!(off < WITHIN_STD * measured.std_mm + 0.03, "{number}, {nominal}: {measured:?}");
                assert!(measured.std_mm < 0.05, "{number}, {nominal}: {measured:?}");
            }
            let deviation = Deviation::of(values.into_iter(), nominal).expect("values");
            assert!(deviation.mean_error_mm <= deviation.max_error_mm && deviation.max_error_mm < 0.1, "{deviation:?}");
        }
        assert!(found.teeth.iter().all(|tooth| tooth.is_sharp == (cut > 0.99)), "{number}: {found:#?}");
    }
}

/// Teeth with flat crests and roots: widths of crest, flank and root, mm.
fn flat_teeth(crest: f64, flank: f64, root: f64, height: f64) -> Vec<Surface> {
    let ridge = Vec3::y() * 40.0;
    let pitch = crest + root + 2.0 * flank;
    (0..5)
        .flat_map(|tooth| {
            let start = f64::from(tooth) * pitch;
            let corners =
                [[0.0, 0.0], [root, 0.0], [root + flank, height], [root + flank + crest, height], [pitch, 0.0]];
            let at = move |[place, up]: [f64; 2]| Vec3::new(start + place, 0.0, up);
            let sides: Vec<Surface> =
                corners.windows(2).map(|pair| rectangle(at(pair[0]), at(pair[1]) - at(pair[0]), ridge)).collect();
            sides
        })
        .collect()
}

#[test]
fn teeth_that_few_profiles_meet_are_measured() {
    // A profile every 2 mm along the ridges: one or two a flank. Upright sensors see both flanks, tilted ones hide one, and
    // upright walls are seen by nobody.
    let checks: [(&str, [f64; 2], &[f64], f64); 4] = [
        ("from above", [4.0, 4.0], &[0.0, 0.0], 0.15),
        ("from both sides", [4.0, 4.0], &[0.5, -0.5], 0.15),
        ("one side in the shadow", [4.0, 4.0], &[0.5, 0.5], 0.2),
        // The gap between two profiles tells no more.
        ("upright walls", [8.0, 0.0], &[0.0, 0.05], 2.0),
    ];
    for (name, [crest, flank], tilts, within_mm) in checks {
        for seed in 1..=3 {
            let surfaces = flat_teeth(crest, flank, 15.0 - crest - 2.0 * flank, 10.0);
            let captures: Vec<_> = (0_u32..)
                .zip(tilts)
                .flat_map(|(number, tilt)| {
                    let from = Vec3::new(-2.0 + 0.8 * f64::from(number), 20.0, 5.0);
                    let path = Path::over(from, from + Vec3::x() * 78.0, Vec3::new(*tilt, 0.0, -1.0), Vec3::y());
                    scan(
                        &surfaces,
                        &Path { width: 36.0, num_profiles: 40, num_points: 150, ..path },
                        10 * seed + u64::from(number),
                    )
                })
                .collect();
            let cloud = Cloud::from_scan(&captures, &flange_from_sensor()).expect("points");
            let found = measure_teeth(&cloud, &PointSet::all(&cloud)).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!((4..=5).contains(&found.teeth.len()), "{name}, {seed}: {found:#?}");
            assert!(found.along.x.abs() > 0.999 && found.ridge.y.abs() > 0.999, "{name}, {seed}: {found:?}");
            for measured in found.pitches() {
                let off = (measured.value_mm - 15.0).abs();
                assert!(off < within_mm && off < WITHIN_STD * measured.std_mm + 0.05, "{name}, {seed}: {measured:?}");
            }
            assert!(found.heights().count() >= 4, "{name}, {seed}: {found:#?}");
            for measured in found.heights() {
                let off = (measured.value_mm - 10.0).abs();
                assert!(off < 0.15 && off < WITHIN_STD * measured.std_mm + 0.05, "{name}, {seed}: {measured:?}");
            }
            assert!(found.teeth.iter().all(|tooth| !tooth.is_sharp), "{name}, {seed}");
        }
    }
}

#[test]
fn upright_walls_are_found_by_a_line_across_them() {
    // Nobody sees the walls, but their edges are in every profile.
    let from = Vec3::new(37.5, 8.0, 5.0);
    let path = Path::over(from, from + Vec3::y() * 24.0, -Vec3::z(), Vec3::x());
    let path = Path { width: 80.0, num_profiles: 60, num_points: 800, ..path };
    let cloud = cloud(&flat_teeth(8.0, 0.0, 7.0, 10.0), &path, 1);
    let found = measure_teeth(&cloud, &PointSet::all(&cloud)).expect("teeth");
    // Behind the last crest the part ends without a wall.
    assert_eq!(found.teeth.len(), 4);
    // To a point's distance from the next one.
    assert!(found.pitches().all(|pitch| (pitch.value_mm - 15.0).abs() < 0.1), "{found:#?}");
    assert!(found.heights().all(|height| (height.value_mm - 10.0).abs() < 0.02), "{found:#?}");
}

#[test]
fn diameters_are_recovered() {
    let centre = Vec3::new(400.0, -200.0, 100.0);
    let axis = Vec3::new(0.1, 1.0, 0.05).normalize();
    for seed in 1..=4 {
        for (kind, axis, diameter) in [(RoundKind::Ball, None, 40.0), (RoundKind::Cylinder, Some(axis), 30.0)] {
            let table = rectangle(Vec3::new(300.0, -300.0, 75.0), Vec3::x() * 200.0, Vec3::y() * 200.0);
            let part = [round(centre, axis, diameter / 2.0), table];
            let from = centre - Vec3::y() * 18.0;
            let path = Path::over(from, from + Vec3::y() * 36.0, -Vec3::z(), Vec3::x());
            let cloud = cloud(&part, &path, seed);
            let found = fit_round(&cloud, &PointSet::all(&cloud), kind).expect("round");
            let off = (found.diameter_mm - diameter).abs();
            assert!(off < WITHIN_STD * found.diameter_std_mm && found.diameter_std_mm < 0.1, "{seed}: {found:?}");
            assert!(axis.is_none_or(|axis| axis.dot(&found.axis.expect("one")).abs() > 0.9999), "{found:?}");
        }
    }
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let nothing = Cloud::from_scan(&[], &flange_from_sensor());
    assert_eq!(nothing, Err(ScanError::NoProfiles));
    let path = Path { num_profiles: 5, num_points: 20, ..over_the_edge() };
    let empty = Cloud::from_scan(&scan(&[], &path, 1), &flange_from_sensor());
    assert_eq!(empty, Err(ScanError::NoPoints { num_profiles: 5 }));
    let mut line = Cloud::about(Vec3::zeros());
    for idx in 0..500 {
        line.push(Vec3::new(f64::from(idx), 2.0 * f64::from(idx), 3.0), 0).expect("room");
    }
    let all = PointSet::all(&line);
    assert!(matches!(fit_plane(&line, &all), Err(ScanError::Line { .. })));
    assert!(matches!(fit_plane(&line, &PointSet::default()), Err(ScanError::TooFewPoints { found: 0, .. })));
    assert!(measure_teeth(&line, &all).is_err());
    assert!(fit_round(&line, &all, RoundKind::Ball).is_err());
    assert!(fit_round(&line, &all, RoundKind::Cylinder).is_err());
    let flat = cloud(
        &[rectangle(Vec3::new(-100.0, -100.0, 50.0), Vec3::x() * 200.0, Vec3::y() * 200.0)],
        &Path::over(Vec3::zeros(), Vec3::y() * 50.0, -Vec3::z(), Vec3::x()),
        1,
    );
    let all = PointSet::all(&flat);
    assert!(measure_teeth(&flat, &all).is_err());
    assert!(fit_round(&flat, &all, RoundKind::Ball).is_err());
    assert!(fit_round(&flat, &all, RoundKind::Cylinder).is_err());
}

#[test]
fn a_rectangle_takes_what_is_seen_and_not_what_is_behind() {
    // A plate 40 mm above another one that is wider: from above, the half of the lower one that is free is seen.
    let surfaces = vec![
        rectangle(Vec3::new(0.0, 0.0, 140.0), Vec3::y() * 60.0, Vec3::x() * 30.0),
        rectangle(Vec3::new(0.0, 0.0, 100.0), Vec3::y() * 60.0, Vec3::x() * 60.0),
    ];
    // Seen obliquely from two sides, so that points are on both where they lie above one another.
    let middle = Vec3::new(20.0, 5.0, 120.0);
    let mut captures = Vec::new();
    for lean in [-0.9, 0.9] {
        let path = Path::over(middle, middle + Vec3::y() * 50.0, Vec3::new(lean, 0.0, -1.0), Vec3::x());
        captures.extend(scan(&surfaces, &path, 3));
    }
    let cloud = Cloud::from_scan(&captures, &flange_from_sensor()).expect("points");
    let height =
        |set: &PointSet, above: bool| set.indices().filter(|idx| (cloud.point_mm(*idx).z > 120.0) == above).count();
    let corners = |from: [f64; 2], to: [f64; 2]| {
        let origin = cloud.origin_mm();
        // Right is x, and down is −y where the view is from above.
        let at = |x: f64, y: f64| [x - origin.x, -(y - origin.y)];
        [at(from[0], from[1]), at(to[0], from[1]), at(to[0], to[1]), at(from[0], to[1])]
    };
    let drawn = |from, to| PointSet::in_polygon(&cloud, Vec3::x(), -Vec3::y(), &corners(from, to)).expect("a polygon");
    let all = PointSet::all(&cloud);
    let in_box = |low, high| height(&PointSet::in_box(&cloud, low, high), false);
    let hidden = in_box(Vec3::new(3.0, 10.0, 90.0), Vec3::new(27.0, 50.0, 110.0));
    assert!(hidden > 500, "{hidden} points behind the plate above");
    let over = drawn([3.0, 10.0], [27.0, 50.0]);
    assert!(height(&over, true) > 1000 && height(&over, false) * 50 < hidden, "{} of {hidden}", height(&over, false));
    // Where nothing is above it, it is seen whole.
    let free = drawn([35.0, 10.0], [55.0, 50.0]);
    assert_eq!(free.len(), in_box(Vec3::new(35.0, 10.0, 90.0), Vec3::new(55.0, 50.0, 110.0)));
    assert!(free.len() > 500 && (all.shared_with(&all) - 1.0).abs() < 1e-12);
}
