//! A thousand frames take no more memory than a few.

use handeye::odometry::{Odometry, OdometryOptions, RgbdFrame, Tracking};
use handeye::simulate::room::{Carrier, RoomOptions, RoomRecording, kinect};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

#[test]
fn a_thousand_frames_take_no_more_memory_than_fifty() {
    const NUM_RENDERED: usize = 16;
    let camera = kinect(160, 120);
    let options = RoomOptions { num_frames: NUM_RENDERED, camera, carrier: Carrier::Hand, ..RoomOptions::default() };
    let rendered: Vec<RgbdFrame> = RoomRecording::new(options).map(|frame| frame.images).collect();
    let mut odometry = Odometry::new(camera, OdometryOptions::default());
    let mut push = |number: usize| {
        // There and back again.
        let step = number % (2 * NUM_RENDERED - 2);
        let idx = if step < NUM_RENDERED { step } else { 2 * NUM_RENDERED - 2 - step };
        let time_s = f64::from(u32::try_from(number).expect("small")) / 30.0;
        let outcome = odometry.push(&RgbdFrame { time_s, ..rendered[idx].clone() });
        assert!(!matches!(outcome.tracking, Tracking::Lost(_)), "{number}: {:?}", outcome.tracking);
    };
    (0..50).for_each(&mut push);
    let early = MEMORY.peak_usage();
    (50..1000).for_each(&mut push);
    let late = MEMORY.peak_usage();
    // The greatest of more frames may be a little greater.
    assert!(late < early + early / 10, "{early} bytes at most for 50 frames, {late} for 1000");
}
