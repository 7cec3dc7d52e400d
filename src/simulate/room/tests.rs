//! The room is where it says, looks the same from everywhere, and is as noisy as stated.

use nalgebra::{Matrix2, Vector2};

use super::path::Path;
use super::render::{Light, Range};
use super::*;
use crate::geometry::{Vec3, so3};
use crate::odometry::Intrinsics;
use crate::session::sequence::{Sequence, SequenceError, TimedFlange};
use crate::watch::{Cancelled, Unwatched, Watch};

/// A camera whose depth pixels are its colour pixels.
fn aligned(width: u32, height: u32) -> RgbdCamera {
    let color = kinect(width, height).color;
    RgbdCamera { color, depth: color, color_from_depth: Transform::identity(), depth_units_per_m: 5000.0 }
}

fn recording(options: RoomOptions) -> RoomRecording {
    RoomRecording::new(RoomOptions { camera: kinect(160, 120), ..options })
}

fn angle_deg(a: &RoomFrame, b: &RoomFrame) -> f64 {
    a.world_from_sensor.rotation().angle_to(&b.world_from_sensor.rotation()).to_degrees()
}

fn distance_mm(a: &RoomFrame, b: &RoomFrame) -> f64 {
    (a.world_from_sensor.translation_mm() - b.world_from_sensor.translation_mm()).norm()
}

#[test]
fn without_noise_every_depth_lies_on_a_surface() {
    let options = RoomOptions { noise: CameraNoise::NONE, num_frames: 4, frames_per_s: 0.2, ..RoomOptions::default() };
    for carrier in [Carrier::Vehicle, Carrier::Hand, Carrier::Robot] {
        let recording = recording(RoomOptions { carrier, ..options.clone() });
        let (camera, room) = (recording.options().camera, Room::new(options.seed));
        for frame in recording {
            let world_from_depth = frame.world_from_sensor * camera.color_from_depth;
            for (column, row, unit) in frame.images.depth.enumerate_pixels().step_by(7) {
                assert!(unit.0[0] > 0, "the room is closed");
                let z_mm = f64::from(unit.0[0]) * camera.mm_per_unit();
                let in_camera = camera.depth.point_at([f64::from(column), f64::from(row)], z_mm);
                let point = world_from_depth.map_point(in_camera);
                let off_mm =
                    room.solids.iter().map(|solid| solid.off_surface_mm(point.into())).fold(f64::MAX, f64::min);
                // Half a unit along the axis, in a corner of the image longer by its slope.
                let rounding_mm = 0.5 * camera.mm_per_unit() * in_camera.norm() / z_mm;
                assert!(off_mm <= rounding_mm + 1e-9, "{off_mm} mm off at {column}, {row}");
            }
        }
    }
}

/// A point of a wall, its brightness in one image and in another, and how that one changes with the place.
struct Seen {
    before: f64,
    after: f64,
    slope: Vector2<f64>,
}

fn seen_twice(camera: &RgbdCamera, before: &RoomFrame, after: &RoomFrame) -> Vec<Seen> {
    let [width, height] = [camera.color.width, camera.color.height].map(f64::from);
    let after_from_before = after.world_from_sensor.inverse() * before.world_from_sensor;
    let pixels = before.images.depth.enumerate_pixels();
    pixels
        .filter_map(|(column, row, unit)| {
            let z_mm = f64::from(unit.0[0]) * camera.mm_per_unit();
            let point = after_from_before.map_point(camera.color.point_at([f64::from(column), f64::from(row)], z_mm));
            let [u, v] = camera.color.pixel_of(&point)?;
            let is_inside = (2.0..width - 3.0).contains(&u) && (2.0..height - 3.0).contains(&v);
            // Where something else stands before it, or an edge is near, the depth differs.
            let is_same = is_inside && is_flat(camera, after, [u, v], point.z);
            is_same.then(|| Seen {
                before: grey(before, column, row),
                after: interpolated(after, u, v),
                slope: Vector2::new(
                    0.5 * (interpolated(after, u + 1.0, v) - interpolated(after, u - 1.0, v)),
                    0.5 * (interpolated(after, u, v + 1.0) - interpolated(after, u, v - 1.0)),
                ),
            })
        })
        .collect()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a pixel inside the image")]
fn is_flat(camera: &RgbdCamera, frame: &RoomFrame, [u, v]: [f64; 2], z_mm: f64) -> bool {
    let (u, v) = (u as u32, v as u32);
    (u - 1..=u + 2).all(|column| {
        (v - 1..=v + 2).all(|row| {
            let found_mm = f64::from(frame.images.depth.get_pixel(column, row).0[0]) * camera.mm_per_unit();
            (found_mm - z_mm).abs() < 0.01 * z_mm
        })
    })
}

fn grey(frame: &RoomFrame, column: u32, row: u32) -> f64 {
    frame.images.color.get_pixel(column, row).0.iter().copied().map(f64::from).sum::<f64>() / 3.0
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a pixel inside the image")]
fn interpolated(frame: &RoomFrame, u: f64, v: f64) -> f64 {
    let (column, row) = (u as u32, v as u32);
    let (right, below) = (u - f64::from(column), v - f64::from(row));
    let line = |row: u32| grey(frame, column, row) * (1.0 - right) + grey(frame, column + 1, row) * right;
    line(row) * (1.0 - below) + line(row + 1) * below
}

#[test]
fn a_place_has_the_same_colour_in_every_frame_and_lies_where_the_truth_says() {
    let camera = aligned(320, 240);
    let options = RoomOptions { camera, noise: CameraNoise::NONE, num_frames: 4, ..RoomOptions::default() };
    for carrier in [Carrier::Vehicle, Carrier::Robot] {
        let frames: Vec<RoomFrame> = RoomRecording::new(RoomOptions { carrier, ..options.clone() }).collect();
        let seen = seen_twice(&camera, &frames[0], &frames[3]);
        assert!(seen.len() > 20_000, "{}", seen.len());
        let mut off: Vec<f64> = seen.iter().map(|seen| (seen.after - seen.before).abs()).collect();
        off.sort_by(f64::total_cmp);
        // Interpolation blurs a little, rounding is a quarter of a level; the patterns themselves are of some 15 levels.
        assert!(off[off.len() / 2] < 1.8, "{carrier:?}: median {}", off[off.len() / 2]);
        // The shift that explains the differences best, as a tracker would find it.
        let normal: Matrix2<f64> = seen.iter().map(|seen| seen.slope * seen.slope.transpose()).sum();
        let right: Vector2<f64> = seen.iter().map(|seen| seen.slope * (seen.before - seen.after)).sum();
        let shift_px = normal.try_inverse().expect("there is texture") * right;
        assert!(shift_px.norm() < 0.01, "{carrier:?}: {shift_px}");
    }
}

fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for value in values {
        // From the first one, so that no digits are lost.
        let off = value - values[0];
        count += 1.0;
        sum += off;
        squares += off * off;
    }
    (values[0] + sum / count, squares / count - (sum / count) * (sum / count))
}

#[test]
fn depth_is_as_noisy_as_published() {
    const NUM: usize = 40_000;
    let noise = DepthNoise { lost_share: 0.0, projector_mm: 0.0, ..CameraNoise::KINECT.depth };
    for z_mm in [600.0, 1000.0, 2500.0, 5000.0] {
        let range = Range { z_mm: vec![z_mm; NUM], incidence_cos: vec![1.0; NUM] };
        let measured = noise.measure(&range, 200, 580.0, &mut Random::new(1, 0));
        let (mean, variance) = mean_and_variance(&measured);
        let std = variance.sqrt();
        // Half a unit of 2.85e-6 of an inverse millimetre. Rounding makes it depend a little on where the units lie.
        let expected = 0.5 * 2.85e-6 * z_mm * z_mm;
        assert!((std / expected - 1.0).abs() < 0.06, "{z_mm} mm: {std}, expected {expected}");
        assert!((mean - z_mm).abs() < 0.1 * expected, "{z_mm} mm: mean {mean}");
    }
}

#[test]
fn depth_is_missing_out_of_range_at_grazing_angles_and_in_shadows() {
    let noise = DepthNoise { lost_share: 0.0, beside_std_px: 0.0, ..CameraNoise::KINECT.depth };
    let lost = |z_mm: [f64; 4], incidence_cos: f32| {
        let range = Range { z_mm: z_mm.repeat(1000), incidence_cos: vec![incidence_cos; 4000] };
        let measured = noise.measure(&range, 4, 580.0, &mut Random::new(1, 0));
        [0, 1, 2, 3].map(|column| measured.iter().skip(column).step_by(4).filter(|z| **z <= 0.0).count())
    };
    assert_eq!(lost([390.0, 410.0, 7900.0, 8100.0], 1.0)[..1], [1000]);
    assert_eq!(lost([1000.0; 4], 1.0), [0; 4]);
    assert!(lost([8100.0; 4], 1.0) == [1000; 4]);
    let grazing = lost([1000.0; 4], 0.125)[0];
    assert!((450..550).contains(&grazing), "half of them: {grazing}");
    // 75 mm beside the camera the projector sees 43.5 px at 1 m and 21.8 px at 2 m: the shadow is wider than these columns.
    assert_eq!(lost([1000.0, 1000.0, 2000.0, 2000.0], 1.0), [0, 0, 1000, 1000]);
}

#[test]
fn colours_are_as_noisy_as_stated_and_follow_the_exposure() {
    const NUM: usize = 60_000;
    let noise = CameraNoise { rolling_bands: 0.0, ..CameraNoise::KINECT };
    for level in [0.0_f32, 100.0, 200.0] {
        let mut light = Light(vec![[level; 3]; NUM]);
        noise.expose(&mut light, 300, 1.1, 0.0, &mut Random::new(1, 0));
        let values: Vec<f64> = light.0.iter().flatten().map(|value| f64::from(*value)).collect();
        let (mean, variance) = mean_and_variance(&values);
        let exposed = 1.1 * f64::from(level);
        let expected = noise.color_std.powi(2) + noise.color_variance_per_level * exposed;
        // Five standard deviations of the estimates.
        assert!((mean - exposed).abs() < 5.0 * (expected / 180_000.0).sqrt(), "{mean}");
        assert!((variance / expected - 1.0).abs() < 0.02, "{level}: {variance}, expected {expected}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let frames = |seed: u64| {
        recording(RoomOptions { seed, num_frames: 3, carrier: Carrier::Robot, ..RoomOptions::default() })
            .collect::<Vec<_>>()
    };
    assert_eq!(frames(5), frames(5));
    let (one, other) = (&frames(5)[2], &frames(6)[2]);
    assert_ne!(one.images.color, other.images.color);
    assert_ne!(one.world_from_sensor, other.world_from_sensor);
}

#[test]
fn the_camera_moves_smoothly_and_turns_about_all_axes_on_a_robot() {
    let arm = Arm::new();
    for (carrier, seed) in [Carrier::Vehicle, Carrier::Hand, Carrier::Robot].into_iter().flat_map(|c| [(c, 1), (c, 2)])
    {
        let path = Path::new(carrier, false, seed);
        let places: Vec<_> = (0..600).map(|idx| path.world_from_sensor(f64::from(idx) / 30.0)).collect();
        let moves = places.windows(2).map(|pair| pair[0].inverse() * pair[1]);
        for step in moves {
            // 30 frames a second: half a metre and half a radian each second, with the shaking of a hand.
            assert!(step.translation_mm().norm() < 25.0, "{carrier:?}: {}", step.translation_mm());
            assert!(step.rotation().angle().to_degrees() < 1.8, "{carrier:?}: {}", step.rotation().angle());
        }
        if carrier == Carrier::Robot {
            let first = arm.base_from_flange(&places[0]);
            let turns =
                places.iter().map(|place| so3::log(&(first.inverse() * arm.base_from_flange(place)).rotation()));
            let [low, high] = turns.fold([Vec3::zeros(); 2], |[low, high], turn| [low.inf(&turn), high.sup(&turn)]);
            assert!((high - low).iter().all(|range| range.to_degrees() > 20.0), "{}", high - low);
        }
    }
}

#[test]
fn flange_poses_are_those_of_the_camera_with_their_noise_and_clock() {
    let quiet = RoomOptions {
        carrier: Carrier::Robot,
        num_frames: 3,
        position_std_mm: 0.0,
        orientation_std_deg: 0.0,
        robot_clock_ahead_s: 0.04,
        ..RoomOptions::default()
    };
    for (position_std_mm, orientation_std_deg) in [(0.0, 0.0), (0.5, 0.1)] {
        let recording = recording(RoomOptions { position_std_mm, orientation_std_deg, ..quiet.clone() });
        let arm = *recording.arm().expect("it is on a robot");
        for frame in recording {
            let TimedFlange { time_s, base_from_flange } = frame.flange.expect("it is on a robot");
            assert!((time_s - frame.images.time_s - 0.04).abs() < 1e-9);
            let off =
                frame.world_from_sensor.inverse() * arm.world_from_base * base_from_flange * arm.flange_from_sensor;
            let (off_mm, off_deg) = (off.translation_mm().norm(), off.rotation().angle().to_degrees());
            // Rounding is 0.0005 mm and 1e-9; the noise is that of three axes, and the lever is below 100 mm.
            let [max_mm, max_deg] = if position_std_mm > 0.0 { [4.0, 0.5] } else { [0.002, 1e-6] };
            assert!(off_mm < max_mm && off_deg < max_deg, "{off_mm} mm, {off_deg} deg");
            assert!(position_std_mm <= 0.0 || off_mm > 0.01 && off_deg > 0.001);
        }
    }
    assert!(recording(RoomOptions::default()).arm().is_none());
}

#[test]
fn a_camera_with_stops_stands_still_every_now_and_then() {
    let path = Path::new(Carrier::Robot, true, 1);
    let places: Vec<_> = (0..90).map(|idx| path.world_from_sensor(f64::from(idx) / 30.0)).collect();
    let num_still = places.windows(2).filter(|pair| pair[0] == pair[1]).count();
    // A third of the time.
    assert!((25..=31).contains(&num_still), "{num_still}");
}

#[test]
fn faults_are_seen_in_their_frames_only() {
    let usual = RoomOptions { num_frames: 4, carrier: Carrier::Hand, ..RoomOptions::default() };
    let plain: Vec<RoomFrame> = recording(usual.clone()).collect();
    for fault in RoomFault::ALL {
        let frames: Vec<RoomFrame> = recording(RoomOptions { faults: vec![(fault, 2..3)], ..usual.clone() }).collect();
        assert_eq!(frames[..2], plain[..2], "{fault:?}");
        let spoilt = &frames[2];
        let values = || spoilt.images.color.iter().copied();
        match fault {
            RoomFault::Dark => assert!(values().max() < Some(15)),
            RoomFault::BlankWall => {
                let (low, high) = (values().min().expect("pixels"), values().max().expect("pixels"));
                assert!(high - low < 25, "{low} to {high}");
            }
            RoomFault::BlankDepth => assert!(spoilt.images.depth.iter().all(|unit| *unit == 0)),
            RoomFault::Jump => {
                assert!(distance_mm(&frames[1], spoilt) > 5.0 * distance_mm(&plain[1], &plain[2]));
                assert!(angle_deg(&frames[2], &frames[3]) < 1.8);
            }
            RoomFault::Frozen => {
                assert_eq!(spoilt.images.color, frames[1].images.color);
                assert_eq!(spoilt.world_from_sensor, plain[2].world_from_sensor);
            }
        }
        if fault != RoomFault::Jump {
            assert_eq!(frames[3], plain[3], "{fault:?}");
        }
        assert_eq!(RoomFault::by_id(fault.id()), Some(fault));
    }
}

#[test]
fn a_moving_camera_smears_what_it_sees_while_the_shutter_is_open() {
    let sharpness = |exposure_s: f64| {
        let options = RoomOptions { noise: CameraNoise::NONE, num_frames: 1, exposure_s, ..RoomOptions::default() };
        let frame = recording(options).next().expect("a frame");
        let columns = 0..frame.images.color.width() - 1;
        columns.map(|column| (grey(&frame, column + 1, 60) - grey(&frame, column, 60)).abs()).sum::<f64>()
    };
    assert!(sharpness(0.2) < 0.8 * sharpness(0.0));
}

#[test]
fn cameras_of_any_size_see_the_same_field() {
    for (width, height) in [(640, 480), (320, 240), (160, 120)] {
        let Intrinsics { fx, cx, .. } = kinect(width, height).color;
        assert!((fx / f64::from(width) - 525.0 / 640.0).abs() < 1e-12);
        assert!((cx - 0.5 * f64::from(width - 1) - 2.5 * f64::from(width) / 640.0).abs() < 1e-9);
    }
}

#[test]
fn a_written_folder_reads_back_as_it_was_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let options =
        RoomOptions { num_frames: 3, carrier: Carrier::Robot, robot_clock_ahead_s: -0.02, ..RoomOptions::default() };
    let recording = recording(options);
    write_folder(recording.clone(), folder.path(), &mut Unwatched).expect("written");
    let sequence = Sequence::open(folder.path()).expect("it is a sequence");
    assert!(sequence.notes.is_empty(), "{:?}", sequence.notes);
    let camera = recording.options().camera;
    assert_eq!((sequence.camera.color, sequence.camera.depth), (camera.color, camera.depth));
    assert!(is_alike(&sequence.camera.color_from_depth, &camera.color_from_depth));
    let (truth, flange) = (sequence.ground_truth.clone().expect("truth"), sequence.flange.clone().expect("poses"));
    let entries = sequence.frames.clone();
    assert_eq!(entries.len(), recording.len());
    for (((frame, entry), truth), flange) in recording.zip(&entries).zip(&truth).zip(&flange) {
        assert_eq!(sequence.frame(entry).expect("it can be decoded"), frame.images);
        assert!(is_alike(&truth.world_from_sensor, &frame.world_from_sensor));
        let reported = frame.flange.expect("it is on a robot");
        assert!((flange.time_s - reported.time_s).abs() < 1e-9);
        assert!(is_alike(&flange.base_from_flange, &reported.base_from_flange));
    }
}

/// Within what is left of metres with nine decimals.
fn is_alike<Dst: crate::geometry::Frame, Src: crate::geometry::Frame>(
    one: &Transform<Dst, Src>,
    other: &Transform<Dst, Src>,
) -> bool {
    (one.translation_mm() - other.translation_mm()).norm() < 1e-5 && one.rotation().angle_to(&other.rotation()) < 1e-8
}

#[test]
fn a_folder_with_files_in_it_is_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("mine.txt"), "mine").expect("written");
    let refusal = write_folder(recording(RoomOptions::default()), folder.path(), &mut Unwatched).expect_err("refused");
    assert!(matches!(refusal, FolderError::Sequence(SequenceError::NotEmpty { .. })), "{refusal}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("readable").count(), 1);
}

#[test]
fn writing_ends_when_nobody_wants_it() {
    struct Impatient;
    impl Watch for Impatient {
        fn report(&mut self, done: usize, _total: usize) -> Result<(), Cancelled> {
            if done < 2 { Ok(()) } else { Err(Cancelled) }
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let refusal =
        write_folder(recording(RoomOptions::default()), folder.path(), &mut Impatient).expect_err("cancelled");
    assert_eq!(refusal, FolderError::Cancelled(Cancelled));
}
