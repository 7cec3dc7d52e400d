//! The odometry as a whole: alignment against a plain reference, both estimators in the simulated room, and frames in which
//! nothing can be tracked.

use handeye::geometry::stats::SplitMix;
use handeye::geometry::{Transform, Vec3, so3};
use handeye::odometry::align::aligned;
use handeye::odometry::{
    DepthImage, Estimator, Failure, FrameOutcome, Intrinsics, Odometry, OdometryOptions, RgbdCamera, TimedPose,
    Tracking, evaluate,
};
use handeye::simulate::room::{CameraNoise, Carrier, RoomFault, RoomOptions, RoomRecording, kinect};

/// Equations (1) to (5) one pixel after the other, in double precision: the nearest of all depth pixels whose footprint
/// covers a colour pixel.
fn plainly_aligned(depth: &DepthImage, camera: &RgbdCamera) -> DepthImage {
    let mut nearest = DepthImage::new(camera.color.width, camera.color.height);
    for (x, y, value) in depth.enumerate_pixels() {
        let z_mm = f64::from(value.0[0]) * camera.mm_per_unit();
        let in_depth = camera.depth.point_at([f64::from(x), f64::from(y)], z_mm);
        let in_color = camera.color_from_depth.map_point(in_depth);
        let Some([u, v]) = camera.color.pixel_of(&in_color).filter(|_| z_mm > 0.0) else { continue };
        let half = |color: f64, depth: f64| 0.5 * 1.15 * (color / depth).abs() * z_mm / in_color.z;
        let (half_u, half_v) = (half(camera.color.fx, camera.depth.fx), half(camera.color.fy, camera.depth.fy));
        for (column, row, seen) in nearest.enumerate_pixels_mut() {
            let covers = (f64::from(column) - u).abs() < half_u && (f64::from(row) - v).abs() < half_v;
            let units = (in_color.z / camera.mm_per_unit()).round();
            if covers && (seen.0[0] == 0 || units < f64::from(seen.0[0])) {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a depth of the image")]
                {
                    seen.0[0] = units as u16;
                }
            }
        }
    }
    nearest
}

#[test]
fn alignment_agrees_with_the_equations() {
    let mut random = SplitMix::new(9);
    let mut part = || f64::from(u32::try_from(random.below(2001)).expect("small")) / 1000.0 - 1.0;
    for fy in [70.0, -70.0] {
        for _ in 0..4 {
            let camera = RgbdCamera {
                color: Intrinsics::new([64, 48], [75.0, fy], [31.0 + part(), 24.0 + part()]).expect("valid"),
                depth: Intrinsics::new([60, 44], [60.0, fy * 0.8], [29.0 + part(), 22.0 + part()]).expect("valid"),
                color_from_depth: Transform::from_parts(
                    Vec3::new(60.0 * part(), 20.0 * part(), 20.0 * part()),
                    so3::exp(Vec3::new(0.05 * part(), 0.05 * part(), 0.3 * part())),
                ),
                depth_units_per_m: 1000.0,
            };
            let depth = DepthImage::from_fn(60, 44, |x, y| {
                image::Luma([match (x, y) {
                    (10..15, 5..9) => 0,
                    (20..40, 12..30) => 900,
                    _ => u16::try_from(1500 + 6 * x + 3 * y).expect("small"),
                }])
            });
            let (found, expected) = (aligned(&depth, &camera), plainly_aligned(&depth, &camera));
            let pairs = || found.iter().zip(expected.iter());
            let different = pairs().filter(|(found, expected)| found.abs_diff(**expected) > 1).count();
            // Single precision decides otherwise only where a footprint ends within a hair of a pixel's centre.
            assert!(different <= 6, "{different} of {} pixels differ", found.len());
            assert!(pairs().filter(|(found, _)| **found > 0).count() > 1500, "most of the picture has depth");
        }
    }
}

#[test]
fn a_surface_has_no_holes_after_alignment() {
    let camera = kinect(160, 120);
    let plane = DepthImage::from_pixel(160, 120, image::Luma([10_000]));
    let seen = aligned(&plane, &camera);
    // Away from the border, which the depth camera does not see.
    let holes = seen
        .enumerate_pixels()
        .filter(|(x, y, depth)| (20..140).contains(x) && (20..100).contains(y) && depth.0[0] == 0);
    assert_eq!(holes.count(), 0);
    assert_eq!(aligned(&DepthImage::new(160, 120), &camera), DepthImage::new(160, 120));
    let same = RgbdCamera { depth: camera.color, color_from_depth: Transform::identity(), ..camera };
    assert_eq!(aligned(&plane, &same), plane);
}

fn room(num_frames: usize, width: u32) -> RoomOptions {
    let camera = kinect(width, width * 3 / 4);
    RoomOptions { num_frames, camera, carrier: Carrier::Hand, ..RoomOptions::default() }
}

fn tracked(options: &RoomOptions, odometry: OdometryOptions) -> (Vec<FrameOutcome>, Vec<TimedPose>) {
    let mut odometry = Odometry::new(options.camera, odometry);
    RoomRecording::new(options.clone())
        .map(|frame| {
            let outcome = odometry.push(&frame.images);
            (outcome, TimedPose { time_s: frame.images.time_s, world_from_sensor: frame.world_from_sensor })
        })
        .unzip()
}

fn poses(outcomes: &[FrameOutcome]) -> Vec<TimedPose> {
    let pose = |outcome: &FrameOutcome| {
        outcome.world_from_sensor.map(|world_from_sensor| TimedPose { time_s: outcome.time_s, world_from_sensor })
    };
    outcomes.iter().filter_map(pose).collect()
}

#[test]
fn ours_follows_a_hand_to_a_fraction_of_a_millimetre_and_the_published_method_to_centimetres() {
    let options = room(12, 320);
    let errors = [Estimator::Ours, Estimator::Published].map(|estimator| {
        let (outcomes, truth) = tracked(&options, OdometryOptions { estimator, ..OdometryOptions::default() });
        let found = poses(&outcomes);
        assert_eq!(found.len(), 12, "{estimator:?}");
        for outcome in &outcomes[1..] {
            let Tracking::Tracked(motion) = &outcome.tracking else { panic!("{:?}", outcome.tracking) };
            assert_eq!(motion.previous + 1, outcome.number);
            assert_eq!(motion.num_matches, outcome.matches.len());
            let inliers = outcome.matches.iter().filter(|found| found.is_inlier).count();
            assert!(motion.num_inliers == inliers && inliers > 10);
        }
        evaluate(&truth, &found).expect("poses")
    });
    // At 320 × 240 pixels, seen: 0.3 mm and 20 mm.
    assert!(errors[0].rpe_translation_rmse_mm < 0.65 && errors[0].ate_rmse_mm < 1.5, "{errors:?}");
    assert!(errors[1].rpe_translation_rmse_mm < 60.0, "{errors:?}");
}

#[test]
fn the_same_frames_give_the_same_bits() {
    let options = room(5, 160);
    for estimator in [Estimator::Ours, Estimator::Published] {
        let once = tracked(&options, OdometryOptions { estimator, ..OdometryOptions::default() });
        let again = tracked(&options, OdometryOptions { estimator, ..OdometryOptions::default() });
        assert_eq!(once, again);
    }
}

#[test]
fn frames_in_which_nothing_can_be_tracked_say_why_and_are_survived() {
    let faults = vec![
        (RoomFault::Dark, 3..5),
        (RoomFault::BlankWall, 8..10),
        (RoomFault::BlankDepth, 13..15),
        (RoomFault::Frozen, 17..19),
    ];
    let options = RoomOptions { faults, ..room(21, 240) };
    let (outcomes, truth) = tracked(&options, OdometryOptions::default());
    for (number, outcome) in outcomes.iter().enumerate() {
        let is_right = match (number, &outcome.tracking) {
            (3..5, Tracking::Lost(failure)) => matches!(failure, Failure::TooDark { .. }),
            (8..10, Tracking::Lost(failure)) => matches!(failure, Failure::TooFewFeatures { .. }),
            (13..15, Tracking::Lost(failure)) => matches!(failure, Failure::BlankDepth { .. }),
            (0, tracking) => *tracking == Tracking::Started { is_after_gap: false },
            (_, tracking) => matches!(tracking, Tracking::Tracked(_)),
        };
        assert!(is_right, "{number}: {:?}", outcome.tracking);
        assert_eq!(outcome.world_from_sensor.is_some(), !matches!(outcome.tracking, Tracking::Lost(_)));
    }
    // Frames that were lost leave no error behind: the next one is found from the last keyframe. The frozen frames are where
    // the camera was, not where it is.
    let found: Vec<TimedPose> = poses(&outcomes).into_iter().filter(|pose| pose.time_s < 16.5 / 30.0).collect();
    let error = evaluate(&truth, &found).expect("poses");
    assert!(error.ate_rmse_mm < 2.0, "{error:?}");
}

#[test]
fn after_too_long_a_loss_the_trajectory_has_a_gap() {
    let options = RoomOptions { faults: vec![(RoomFault::Dark, 2..20)], ..room(23, 160) };
    let (outcomes, _) = tracked(&options, OdometryOptions::default());
    assert_eq!(outcomes[20].tracking, Tracking::Started { is_after_gap: true });
    assert_eq!(outcomes[20].world_from_sensor, outcomes[1].world_from_sensor, "it goes on from the last known pose");
    assert!(matches!(outcomes[21].tracking, Tracking::Tracked(_)), "{:?}", outcomes[21].tracking);
}

#[test]
fn a_period_leaves_frames_out_and_a_wrong_size_is_refused() {
    let options = RoomOptions { noise: CameraNoise::NONE, ..room(7, 160) };
    let (outcomes, _) = tracked(&options, OdometryOptions { period_s: Some(0.1), ..OdometryOptions::default() });
    let is_left_out: Vec<bool> = outcomes.iter().map(|outcome| outcome.tracking == Tracking::LeftOut).collect();
    assert_eq!(is_left_out, [false, true, true, false, true, true, false]);
    let mut odometry = Odometry::new(kinect(320, 240), OdometryOptions::default());
    let frame = RoomRecording::new(options).next().expect("a frame");
    let outcome = odometry.push(&frame.images);
    assert!(matches!(outcome.tracking, Tracking::Lost(Failure::WrongSize { .. })), "{:?}", outcome.tracking);
}
