//! Circle fits and arc extraction on points whose circle is known.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]
#![expect(clippy::cast_precision_loss, reason = "small counts")]

use std::f64::consts::PI;

use handeye::fit::{ArcOptions, ArcRefusal, Circle, CircleMethod, FitError, PointClass, extract_arc, geometric};
use handeye::geometry::{Profile, stats};
use proptest::prelude::*;

const TRUTH: Circle = Circle { x_mm: 3.0, z_mm: 80.0, radius_mm: 12.0 };
const TRIALS: u64 = 400;
const BALL: ArcOptions = ArcOptions { ball_radius_mm: 15.0, profile_std_mm: None };

/// A repeatable sequence of normally distributed numbers (Lehmer's generator, Box and Muller's transform).
struct Normal(u64);

impl Normal {
    fn unit(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 0x7fff_ffff;
        self.0 as f64 / f64::from(0x7fff_ffff)
    }

    fn next(&mut self) -> f64 {
        (-2.0 * self.unit().ln()).sqrt() * (2.0 * PI * self.unit()).cos()
    }
}

/// Points over `angle_deg` about the side nearest to the sensor (z falls towards it).
fn arc(angle_deg: f64, num_points: usize, std_mm: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut normal = Normal(seed + 1);
    (0..num_points)
        .map(|idx| {
            let part = idx as f64 / (num_points - 1) as f64 - 0.5;
            let angle = (angle_deg * part).to_radians();
            let radius = TRUTH.radius_mm + std_mm * normal.next();
            (TRUTH.x_mm + radius * angle.sin(), TRUTH.z_mm - radius * angle.cos())
        })
        .unzip()
}

fn profile(x_mm: &[f64], z_mm: &[f64]) -> Profile {
    let z_mm: Vec<Option<f64>> = z_mm.iter().map(|z| Some(*z).filter(|z| !z.is_nan())).collect();
    Profile::new(x_mm.to_vec(), &z_mm).expect("a profile")
}

fn error_mm(found: Circle) -> f64 {
    (found.x_mm - TRUTH.x_mm).hypot(found.z_mm - TRUTH.z_mm).hypot(found.radius_mm - TRUTH.radius_mm)
}

#[test]
fn every_fit_finds_an_exact_circle() {
    for angle_deg in [20.0, 120.0, 350.0] {
        let (x, z) = arc(angle_deg, 101, 0.0, 0);
        for method in CircleMethod::ALL {
            let found = method.fit(&x, &z).expect("a circle");
            // Rounding, amplified by the shortness of the arc.
            assert!(error_mm(found) < 1e-8, "{method:?} at {angle_deg}°: {:e} mm", error_mm(found));
        }
    }
}

#[test]
fn kasa_shrinks_short_arcs_and_the_others_do_not() {
    let mut mean = [0.0; 6];
    for seed in 0..200 {
        let (x, z) = arc(40.0, 200, 0.05, 17 * seed);
        for (mean, method) in mean.iter_mut().zip(CircleMethod::ALL) {
            *mean += method.fit(&x, &z).expect("a circle").radius_mm / 200.0;
        }
    }
    for (mean, method) in mean.into_iter().zip(CircleMethod::ALL) {
        let bias_mm = mean - TRUTH.radius_mm;
        if method == CircleMethod::Kasa {
            assert!(bias_mm < -0.1, "Kåsa's bias: {bias_mm} mm");
        } else {
            // Three standard deviations of the mean of 200 fits.
            assert!(bias_mm.abs() < 0.06, "{method:?}: {bias_mm} mm");
        }
    }
}

#[test]
fn points_that_make_no_circle_are_refused_by_name() {
    let line: Vec<f64> = (0..50).map(f64::from).collect();
    for method in CircleMethod::ALL {
        assert_eq!(method.fit(&line[..2], &line[..2]), Err(FitError::TooFewPoints { found: 2, needed: 3 }));
        assert_eq!(method.fit(&line, &line), Err(FitError::Collinear), "{method:?}");
        assert_eq!(method.fit(&[1.0; 9], &[2.0; 9]), Err(FitError::Collinear), "{method:?}");
    }
}

#[test]
fn stated_covariance_is_that_of_repeated_fits() {
    let (mut errors, mut stated) = ([Vec::new(), Vec::new(), Vec::new()], [0.0; 3]);
    for seed in 0..TRIALS {
        let (x, z) = arc(100.0, 150, 0.02, 31 * seed);
        let fit = geometric::fit(&x, &z, TRUTH).expect("a circle");
        let found = fit.circle;
        for (errors, error) in
            errors.iter_mut().zip([found.x_mm - TRUTH.x_mm, found.z_mm - TRUTH.z_mm, found.radius_mm - TRUTH.radius_mm])
        {
            errors.push(error);
        }
        for (idx, stated) in stated.iter_mut().enumerate() {
            *stated += fit.covariance[(idx, idx)] / TRIALS as f64;
        }
    }
    for (errors, stated) in errors.into_iter().zip(stated) {
        let ratio = stats::rms(errors) / stated.sqrt();
        // 400 trials know a standard deviation to 3.5 %; three of them.
        assert!((0.9..1.1).contains(&ratio), "spread over stated: {ratio}");
    }
}

#[test]
fn two_outliers_in_a_hundred_cost_the_robust_fit_next_to_nothing() {
    let (mut robust, mut clean) = (Vec::new(), Vec::new());
    for seed in 0..200 {
        let (x, mut z) = arc(110.0, 800, 0.01, 13 * seed);
        clean.push(error_mm(CircleMethod::Geometric.fit(&x, &z).expect("a circle")));
        let mut normal = Normal(seed + 7);
        for z in z.iter_mut().step_by(50) {
            *z += normal.next().abs() + 0.2;
        }
        robust.push(error_mm(CircleMethod::Robust.fit(&x, &z).expect("a circle")));
    }
    let efficiency = stats::rms(robust) / stats::rms(clean);
    assert!(efficiency < 1.06, "error over that of clean points: {efficiency}");
}

/// An arc with a table beside it, spikes and holes, as a sensor with z towards or away from it and x rising or falling.
fn dirty(mirror_x: bool, mirror_z: bool) -> (Profile, Circle) {
    let mut normal = Normal(5);
    let (mut x_mm, mut z_mm) = (Vec::new(), Vec::new());
    for idx in 0..600 {
        let x = -30.0 + 0.1 * f64::from(idx);
        let across = x - TRUTH.x_mm;
        let on_ball = across.abs() < TRUTH.radius_mm;
        let z = if on_ball { TRUTH.z_mm - (TRUTH.radius_mm.powi(2) - across * across).sqrt() } else { 95.0 };
        x_mm.push(x);
        z_mm.push(match idx % 97 {
            40 => f64::NAN,
            41 => z - 3.0,
            _ if (300..310).contains(&idx) => f64::NAN,
            _ => z + 0.01 * normal.next(),
        });
    }
    let mut circle = TRUTH;
    if mirror_x {
        for x in &mut x_mm {
            *x = -*x;
        }
        circle.x_mm = -circle.x_mm;
    }
    if mirror_z {
        for z in &mut z_mm {
            *z = -*z;
        }
        circle.z_mm = -circle.z_mm;
    }
    (profile(&x_mm, &z_mm), circle)
}

#[test]
fn the_arc_is_found_in_a_dirty_profile_whichever_way_the_axes_run() {
    for (mirror_x, mirror_z) in [(false, false), (true, false), (false, true), (true, true)] {
        let (profile, truth) = dirty(mirror_x, mirror_z);
        let arc = extract_arc(&profile, &BALL).expect("an arc");
        let found = arc.circle;
        // Five standard deviations of a fit to 220 points with 0.01 mm.
        assert!((found.x_mm - truth.x_mm).abs() < 0.01, "{found:?}");
        assert!((found.z_mm - truth.z_mm).abs() < 0.02, "{found:?}");
        assert!((found.radius_mm - truth.radius_mm).abs() < 0.02, "{found:?}");
        assert_eq!(arc.classes.len(), profile.len());
        assert_eq!(arc.classes.iter().filter(|class| **class == PointClass::Inlier).count(), arc.num_inliers());
        assert!((0.008..0.012).contains(&arc.point_std_mm), "{}", arc.point_std_mm);
        // The spike on the ball is an outlier, the table is unused.
        assert_eq!(arc.classes[97 * 3 + 41], PointClass::Outlier);
        assert_eq!(arc.classes[0], PointClass::Unused);
        assert_eq!(arc.classes[305], PointClass::Missing);
    }
}

#[test]
fn profiles_without_a_usable_arc_say_why() {
    let refusal =
        |x: &[f64], z: &[f64], options: &ArcOptions| extract_arc(&profile(x, z), options).expect_err("no arc");
    assert_eq!(refusal(&[], &[], &BALL), ArcRefusal::TooFewPoints { found: 0, needed: 8 });
    assert_eq!(refusal(&[0.0; 20], &[f64::NAN; 20], &BALL), ArcRefusal::TooFewPoints { found: 0, needed: 8 });
    let x: Vec<f64> = (0..400).map(|idx| 0.1 * f64::from(idx)).collect();
    let mut normal = Normal(3);
    let table: Vec<f64> = x.iter().map(|_| 95.0 + 0.01 * normal.next()).collect();
    let on_table = refusal(&x, &table, &BALL);
    assert!(matches!(on_table, ArcRefusal::NoArc { .. } | ArcRefusal::TooShort { .. }), "{on_table}");
    let (x, z) = arc(120.0, 300, 0.01, 1);
    let smaller = ArcOptions { ball_radius_mm: 9.0, profile_std_mm: None };
    let refused = refusal(&x, &z, &smaller);
    assert!(
        matches!(refused, ArcRefusal::LargerThanBall { found_mm, .. } if (found_mm - 12.0).abs() < 0.05),
        "{refused}"
    );
    let (x, z) = arc(10.0, 100, 0.0, 1);
    let short = refusal(&x, &z, &BALL);
    assert!(matches!(short, ArcRefusal::TooShort { .. }), "{short}");
}

#[test]
fn the_same_profile_gives_the_same_bits() {
    let (profile, _) = dirty(false, false);
    assert_eq!(extract_arc(&profile, &BALL), extract_arc(&profile, &BALL));
}

proptest! {
    #[test]
    fn no_profile_makes_the_extraction_panic(
        points in proptest::collection::vec((-200.0..200.0_f64, proptest::option::of(-200.0..200.0_f64)), 0..120),
        ball_radius_mm in 0.1..500.0_f64,
    ) {
        let (x_mm, z_mm): (Vec<f64>, Vec<Option<f64>>) = points.into_iter().unzip();
        let profile = Profile::new(x_mm, &z_mm).expect("finite");
        if let Ok(arc) = extract_arc(&profile, &ArcOptions { ball_radius_mm, profile_std_mm: None }) {
            prop_assert!(arc.circle.radius_mm <= 1.06 * ball_radius_mm);
            prop_assert!(arc.std_mm().iter().all(|std| std.is_finite()));
        }
    }
}
