//! Edges, corners, steps and tips in simulated profiles whose edge is known.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]
#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts, none below zero"
)]

use handeye::fit::{EdgeOptions, EdgeRefusal, Feature, PointClass, extract_edge};
use handeye::geometry::{Profile, Rigid, Vec3, so3};
use handeye::scene::{Dirt as SceneDirt, Line, Part, PartKind, Random};

const SEEDS: u64 = 300;
const PITCH_MM: f64 = 0.05;
const NUM_POINTS: usize = 800;
const NOISE_MM: f64 = 0.02;

/// What falls on the profile besides noise.
#[derive(Clone, Copy, Default)]
struct Dirt {
    spike_part: f64,
    missing_part: f64,
    /// Missing points, in one run, as a part of the profile.
    hole: Option<(f64, f64)>,
}

const CLEAN: Dirt = Dirt { spike_part: 0.0, missing_part: 0.0, hole: None };
const DIRTY: Dirt = Dirt { spike_part: 0.05, missing_part: 0.02, hole: Some((0.15, 0.05)) };

/// How the axes run.
#[derive(Clone, Copy)]
struct Axes {
    x_falls: bool,
    z_sign: f64,
}

const AXES: [Axes; 4] = [
    Axes { x_falls: false, z_sign: 1.0 },
    Axes { x_falls: true, z_sign: 1.0 },
    Axes { x_falls: false, z_sign: -1.0 },
    Axes { x_falls: true, z_sign: -1.0 },
];

/// A profile of the range at each place across the line, and the place of its grid.
fn profile(range_mm: impl Fn(f64) -> Option<f64>, random: &mut Random, dirt: Dirt, axes: Axes) -> Profile {
    let start_mm = -0.5 * NUM_POINTS as f64 * PITCH_MM;
    let mut points: Vec<(f64, Option<f64>)> = (0..NUM_POINTS)
        .map(|idx| {
            let x = start_mm + PITCH_MM * idx as f64;
            let noise = NOISE_MM * random.normal();
            let (spike, size, missing) = (random.unit(), random.signed_unit(), random.unit());
            let in_hole = dirt.hole.is_some_and(|(from, width)| {
                let part = idx as f64 / NUM_POINTS as f64;
                (from..from + width).contains(&part)
            });
            let z = range_mm(x).filter(|_| missing >= dirt.missing_part && !in_hole).map(|z| {
                let spike = if spike < dirt.spike_part { 0.5 * size.signum() + 5.0 * size } else { 0.0 };
                axes.z_sign * (z + noise + spike)
            });
            (x, z)
        })
        .collect();
    if axes.x_falls {
        points.reverse();
    }
    let (x_mm, z_mm): (Vec<f64>, Vec<Option<f64>>) = points.into_iter().unzip();
    Profile::new(x_mm, &z_mm).expect("a profile")
}

/// What many trials say: mean normalised error, and mean error over its standard deviation along x and z.
struct Trials {
    chi_squared: f64,
    bias: [f64; 2],
    bias_in_stds: [f64; 2],
    largest_mm: f64,
}

fn run(wanted: Feature, options: EdgeOptions, one: impl Fn(&mut Random, u64) -> (Profile, [f64; 2])) -> Trials {
    let (mut chi, mut sum, mut variance, mut largest_mm) = (0.0, [0.0; 2], [0.0; 2], 0.0_f64);
    for seed in 0..SEEDS {
        let (profile, truth_mm) = one(&mut Random::new(seed, 7), seed);
        let found = extract_edge(&profile, &options).unwrap_or_else(|refusal| panic!("seed {seed}: {refusal}"));
        assert_eq!(found.feature, wanted, "seed {seed}");
        let error = nalgebra::Vector2::new(found.point_mm[0] - truth_mm[0], found.point_mm[1] - truth_mm[1]);
        let weight = found.covariance.try_inverse().expect("a covariance of full rank");
        let normalised = (error.transpose() * weight * error)[0] / 2.0;
        chi += normalised / SEEDS as f64;
        largest_mm = largest_mm.max(error.norm());
        for axis in 0..2 {
            sum[axis] += error[axis] / SEEDS as f64;
            variance[axis] += found.covariance[(axis, axis)] / SEEDS as f64;
        }
    }
    let bias_in_stds = [0, 1].map(|axis| sum[axis] / (variance[axis] / SEEDS as f64).sqrt());
    Trials { chi_squared: chi, bias: sum, bias_in_stds, largest_mm }
}

#[track_caller]
fn check(name: &str, trials: &Trials, bias_limit_mm: f64) {
    // Two coordinates over 300 seeds: the mean of χ²/2 scatters by 0.06.
    assert!(
        (0.8..=1.3).contains(&trials.chi_squared),
        "{name}: χ² {}, largest {} mm",
        trials.chi_squared,
        trials.largest_mm
    );
    for bias in trials.bias {
        assert!(bias.abs() <= bias_limit_mm, "{name}: bias {bias} mm");
    }
}

/// A corner of the given flanks' slopes, at a random place.
fn corner(slopes: [f64; 2], dirt: Dirt) -> impl Fn(&mut Random, u64) -> (Profile, [f64; 2]) {
    move |random, seed| {
        let axes = AXES[(seed % 4) as usize];
        let corner = [4.0 * random.signed_unit(), 80.0 + random.signed_unit()];
        let range = |x: f64| {
            let slope = if x < corner[0] { slopes[0] } else { slopes[1] };
            Some(corner[1] + slope * (x - corner[0]))
        };
        (profile(range, random, dirt, axes), [corner[0], axes.z_sign * corner[1]])
    }
}

/// A plate over `behind`, ending at a random place.
fn plate(
    slope: f64,
    behind: Option<f64>,
    shadow_mm: f64,
    dirt: Dirt,
) -> impl Fn(&mut Random, u64) -> (Profile, [f64; 2]) {
    move |random, seed| {
        let axes = AXES[(seed % 4) as usize];
        let edge = [4.0 * random.signed_unit(), 80.0 + random.signed_unit()];
        let range = |x: f64| {
            if x < edge[0] {
                Some(edge[1] + slope * (x - edge[0]))
            } else if x < edge[0] + shadow_mm {
                None
            } else {
                behind.map(|behind| edge[1] + behind + slope * (x - edge[0]))
            }
        };
        (profile(range, random, dirt, axes), [edge[0], axes.z_sign * edge[1]])
    }
}

const ANY: EdgeOptions = EdgeOptions { feature: None, profile_std_mm: None };

#[test]
fn a_corner_is_found_within_what_is_said_of_it() {
    for (name, slopes, dirt) in [
        ("corner 90°", [-1.0, 1.0], CLEAN),
        ("corner 30°", [0.0, 0.577], CLEAN),
        ("corner, valley", [1.0, -1.0], CLEAN),
        ("corner, steep side", [-0.1, 3.0], CLEAN),
        ("corner 90°, dirty", [-1.0, 1.0], DIRTY),
        ("corner 20°, dirty", [-0.1, 0.26], DIRTY),
    ] {
        for feature in [None, Some(Feature::Corner)] {
            let trials = run(Feature::Corner, EdgeOptions { feature, ..ANY }, corner(slopes, dirt));
            check(name, &trials, 0.003);
            assert!(trials.bias_in_stds.iter().all(|bias| bias.abs() < 4.0), "{name}: {:?}", trials.bias_in_stds);
        }
    }
}

#[test]
fn the_end_of_a_plate_is_found_within_the_pitch() {
    for (name, slope, dirt) in [("edge", 0.0, CLEAN), ("edge, tilted", 0.5, CLEAN), ("edge, dirty", 0.1, DIRTY)] {
        for feature in [None, Some(Feature::Edge)] {
            let trials = run(Feature::Edge, EdgeOptions { feature, ..ANY }, plate(slope, None, 0.0, dirt));
            check(name, &trials, PITCH_MM / 5.0);
        }
    }
}

#[test]
fn a_plate_on_a_table_ends_at_the_step_on_its_own_side() {
    for (name, slope, behind, shadow_mm, dirt) in [
        ("step", 0.0, 8.0, 0.0, CLEAN),
        ("step, thin plate", 0.1, 0.4, 0.0, CLEAN),
        ("step, shadow", 0.2, 8.0, 1.7, CLEAN),
        ("step, dirty", 0.0, 8.0, 0.0, DIRTY),
        ("step, dirty, shadow", -0.3, 5.0, 2.0, DIRTY),
    ] {
        for feature in [None, Some(Feature::Step)] {
            let trials =
                run(Feature::Step, EdgeOptions { feature, ..ANY }, plate(slope, Some(behind), shadow_mm, dirt));
            check(name, &trials, PITCH_MM / 5.0);
        }
    }
}

/// How far below its top a tip is, at a distance from the top across the line.
type Shape = fn(f64) -> Option<f64>;

#[test]
fn a_tip_is_found_within_what_is_said_of_it() {
    // A cone with its tip up, a pin with a round top, and a flat pin of a few points; in air and above a table.
    let shapes: [(&str, Shape); 3] = [
        ("cone", |u| (u.abs() < 2.0).then_some(2.5 * u.abs())),
        ("round", |u| (u.abs() < 1.2).then(|| 1.5 - (1.5_f64 * 1.5 - u * u).sqrt())),
        ("flat", |u| (u.abs() < 0.4).then_some(0.0)),
    ];
    for (name, shape) in shapes {
        for table in [None, Some(30.0)] {
            for dirt in [CLEAN, Dirt { hole: None, ..DIRTY }] {
                for feature in [None, Some(Feature::Tip)] {
                    // A dozen points with strays among them do not tell their noise: the session states it.
                    let profile_std_mm = (dirt.spike_part > 0.0).then_some(NOISE_MM);
                    let trials = run(Feature::Tip, EdgeOptions { feature, profile_std_mm }, |random, seed| {
                        let axes = AXES[(seed % 4) as usize];
                        let top = [4.0 * random.signed_unit(), 80.0 + random.signed_unit()];
                        // Widths of a whole number of pitches would have both ends err alike.
                        let scale = 1.0 + 0.1 * random.signed_unit();
                        let range = |x: f64| {
                            shape((x - top[0]) * scale)
                                .map(|below| top[1] + below)
                                .or(table.map(|table| top[1] + table))
                        };
                        (profile(range, random, dirt, axes), [top[0], axes.z_sign * top[1]])
                    });
                    check(
                        &format!("{name}, table {table:?}, {feature:?}, spikes {}", dirt.spike_part),
                        &trials,
                        PITCH_MM / 5.0,
                    );
                }
            }
        }
    }
}

/// A pin that tilts by up to 20° about each axis, so that one of its sides may hardly be seen: found at coarse pitches as well,
/// refused where it cannot be told, and never a shoulder of it taken for its point.
#[test]
fn a_pin_is_found_at_coarse_pitches_or_refused() {
    // A flank of 2 mm has ten points at 0.2 mm, and fewer where it tilts away.
    for (num_points, least_part, dirt) in [
        (800, 0.98, SceneDirt::default()),
        (200, 0.9, SceneDirt::default()),
        (160, 0.85, SceneDirt::default()),
        (800, 0.85, SceneDirt::all()),
        (200, 0.8, SceneDirt::all()),
    ] {
        let [mut poses, mut noise, mut strays] = [1, 2, 3].map(|stream| Random::new(11, stream));
        let pin = Part::new(PartKind::Pin, Rigid::identity());
        let line = Line { num_points, width_mm: 40.0, profile_std_mm: NOISE_MM, dirt, decimals: None };
        let (mut num_found, mut chi_squared, mut largest_mm) = (0, 0.0, 0.0_f64);
        for _ in 0..SEEDS {
            let tilt = Vec3::new(poses.signed_unit(), poses.signed_unit(), poses.signed_unit()) * 0.35;
            let rotation = so3::exp(tilt) * so3::exp(Vec3::x() * std::f64::consts::PI);
            let point = Vec3::new(6.0 * poses.signed_unit(), 0.0, 80.0 + 10.0 * poses.signed_unit());
            let world_from_sensor = Rigid::from_parts((-(rotation * point)).into(), rotation);
            let profile = line.profile(&mut noise, &mut strays, |x| pin.seen_z_mm(x, 1.0, &world_from_sensor));
            let Ok(found) = extract_edge(&profile, &EdgeOptions { feature: Some(Feature::Tip), ..ANY }) else {
                continue;
            };
            let error = nalgebra::Vector2::new(found.point_mm[0] - point.x, found.point_mm[1] - point.z);
            let weight = found.covariance.try_inverse().expect("a covariance of full rank");
            num_found += 1;
            chi_squared += (error.transpose() * weight * error)[0] / 2.0;
            largest_mm = largest_mm.max(error.norm());
        }
        let found_part = f64::from(num_found) / SEEDS as f64;
        assert!(found_part >= least_part, "{num_points} points: {found_part} found");
        let chi_squared = chi_squared / f64::from(num_found);
        assert!((0.4..1.6).contains(&chi_squared), "{num_points} points: χ² {chi_squared}");
        // A shoulder is 3 mm from the point.
        assert!(largest_mm < 0.5, "{num_points} points: {largest_mm} mm");
    }
}

/// What a profile without noise gives.
fn extract(
    range_mm: impl Fn(f64) -> Option<f64>,
    feature: Option<Feature>,
) -> Result<handeye::fit::EdgeFit, EdgeRefusal> {
    let profile = profile(range_mm, &mut Random::new(5, 7), CLEAN, AXES[0]);
    extract_edge(&profile, &EdgeOptions { feature, ..ANY })
}

fn on_plate(x: f64, from: f64, to: f64, behind: Option<f64>) -> Option<f64> {
    if (from..to).contains(&x) { Some(60.0) } else { behind.map(|behind| 60.0 + behind) }
}

#[test]
fn what_cannot_be_told_is_refused_by_name() {
    let both_ends = extract(|x| on_plate(x, -8.0, 8.0, None), None);
    assert!(matches!(&both_ends, Err(EdgeRefusal::Ambiguous { seen }) if seen.len() == 2), "{both_ends:?}");
    let both_steps = extract(|x| on_plate(x, -8.0, 8.0, Some(5.0)), Some(Feature::Step));
    assert!(matches!(&both_steps, Err(EdgeRefusal::Ambiguous { seen }) if seen.len() == 2), "{both_steps:?}");
    let no_end = extract(|_| Some(60.0), Some(Feature::Edge));
    assert!(matches!(no_end, Err(EdgeRefusal::NoFeature { feature: Some(Feature::Edge), .. })), "{no_end:?}");
    let no_corner = extract(|x| on_plate(x, -100.0, 3.0, Some(5.0)), Some(Feature::Corner));
    let refusal = no_corner.expect_err("a step is no corner");
    assert!(matches!(&refusal, EdgeRefusal::OtherFeature { wanted: Feature::Corner, .. }), "{refusal:?}");
    assert!(refusal.to_string().contains("a step at x = "), "{refusal}");
    let flat = extract(|x| Some(60.0 + 0.05 * x.abs()), None);
    assert!(matches!(flat, Err(EdgeRefusal::TooFlat { found_deg, .. }) if (4.0..7.0).contains(&found_deg)), "{flat:?}");
    let wide = extract(|x| (x.abs() < 7.0).then(|| 70.0 - (100.0 - x * x).sqrt()), Some(Feature::Tip));
    assert!(
        matches!(wide, Err(EdgeRefusal::TipTooWide { found_mm, .. }) if (13.0..15.0).contains(&found_mm)),
        "{wide:?}"
    );
    let no_tip = extract(|_| Some(60.0), Some(Feature::Tip));
    assert!(matches!(no_tip, Err(EdgeRefusal::NoFeature { feature: Some(Feature::Tip), .. })), "{no_tip:?}");
    let empty = extract(|x| (x.abs() < 0.1).then_some(60.0), Some(Feature::Edge));
    assert!(matches!(empty, Err(EdgeRefusal::TooFewPoints { .. })), "{empty:?}");
    let mut random = Random::new(8, 7);
    let x_mm: Vec<f64> = (0..NUM_POINTS).map(|idx| idx as f64 * PITCH_MM).collect();
    let z_mm: Vec<Option<f64>> = x_mm.iter().map(|_| Some(60.0 + 20.0 * random.unit())).collect();
    let rubbish = extract_edge(
        &Profile::new(x_mm, &z_mm).expect("a profile"),
        &EdgeOptions { profile_std_mm: Some(0.01), ..ANY },
    );
    assert!(rubbish.is_err(), "{rubbish:?}");
}

#[test]
fn what_belongs_to_something_else_is_not_taken_for_the_edge() {
    // The table ends in view, as the range of the sensor does.
    let table_ends =
        extract(|x| on_plate(x, -100.0, 3.0, Some(5.0)).filter(|_| x < 15.0), None).expect("the plate's step");
    assert_eq!(table_ends.feature, Feature::Step);
    assert!((table_ends.point_mm[0] - 3.0).abs() < PITCH_MM && (table_ends.point_mm[1] - 60.0).abs() < 0.02);
    // A tilted plate shows its side, and below it the table.
    let side = |x: f64| match x {
        x if x < 2.0 => Some(60.0 + 0.3 * x),
        x if x < 4.0 => Some(60.6 + 3.0 * (x - 2.0)),
        _ => Some(66.6 + 0.3 * (x - 4.0)),
    };
    let upper = extract(side, None).expect("the upper corner");
    assert_eq!(upper.feature, Feature::Corner);
    assert!((upper.point_mm[0] - 2.0).abs() < 0.02 && (upper.point_mm[1] - 60.6).abs() < 0.02, "{:?}", upper.point_mm);
    // A square bar in the air: its corner counts, not where its sides end.
    let bar = extract(|x| (x.abs() < 10.0).then(|| 60.0 + x.abs()), None).expect("the corner");
    assert_eq!(bar.feature, Feature::Corner);
}

#[test]
fn every_point_has_its_class() {
    let found =
        extract(|x| on_plate(x, -100.0, 3.0, Some(5.0)).filter(|_| !(5.0..7.0).contains(&x)), None).expect("a step");
    let class_at = |x: f64| found.classes[((x + 20.0) / PITCH_MM).round() as usize];
    assert_eq!([0.0, 4.0, 6.0].map(class_at), [PointClass::Inlier, PointClass::Unused, PointClass::Missing]);
    assert_eq!(found.flanks.len(), 1);
    // The end next to the edge comes first.
    assert!((found.flanks[0].ends_mm[0][0] - 3.0).abs() < 2.0 * PITCH_MM, "{:?}", found.flanks[0]);
}

/// What is missing behind an edge is told, as far as more is missing than points drop out.
#[test]
fn a_gap_behind_a_step_is_measured() {
    for (from_mm, to_mm) in [(3.0, 4.0), (1.0, 3.5)] {
        let step = |x: f64| on_plate(x, -100.0, 3.0, Some(5.0)).filter(|_| !(from_mm..to_mm).contains(&x));
        let found = extract(step, None).expect("a step");
        let behind_mm = found.point_mm[0] + found.gap_mm[0];
        assert!((behind_mm - to_mm).abs() < 1.5 * PITCH_MM, "{:?} {:?}", found.point_mm, found.gap_mm);
        assert!(found.gap_mm[1].abs() < 0.02, "{:?}", found.gap_mm);
    }
    let closed = extract(|x| on_plate(x, -100.0, 3.0, Some(5.0)), None).expect("a step");
    assert!(closed.gap_mm.iter().all(|gap| *gap == 0.0), "{:?}", closed.gap_mm);
    let free = extract(|x| on_plate(x, -100.0, 3.0, None), None).expect("an edge");
    assert!(free.gap_mm.iter().all(|gap| *gap == 0.0), "{:?}", free.gap_mm);
}

#[test]
fn the_same_profile_gives_the_same_bits() {
    let once = || {
        let (profile, _) = corner([-0.3, 0.8], DIRTY)(&mut Random::new(3, 7), 0);
        extract_edge(&profile, &ANY).expect("a corner")
    };
    assert_eq!(once(), once());
}

#[test]
fn stray_numbers_never_panic() {
    for seed in 0..400 {
        let mut random = Random::new(seed, 9);
        let num = (random.unit() * 60.0) as usize;
        let wild =
            |random: &mut Random| (random.signed_unit() * 10.0).round() * 10.0_f64.powi((random.unit() * 4.0) as i32);
        let x_mm: Vec<f64> = (0..num).map(|_| wild(&mut random)).collect();
        let z_mm: Vec<Option<f64>> = (0..num).map(|_| (random.unit() < 0.8).then(|| wild(&mut random))).collect();
        let profile = Profile::new(x_mm, &z_mm).expect("finite numbers");
        for feature in [None].into_iter().chain(Feature::ALL.map(Some)) {
            for profile_std_mm in [None, Some(0.0), Some(0.1)] {
                if let Ok(found) = extract_edge(&profile, &EdgeOptions { feature, profile_std_mm }) {
                    assert!(found.point_mm.iter().all(|value| value.is_finite()), "seed {seed}");
                }
            }
        }
    }
}
