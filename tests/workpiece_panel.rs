//! The Workpiece section of the Verify step, driven by the names that screen readers see, in the whole window.
#![expect(clippy::expect_used, reason = "helpers of tests may fail as tests do")]

mod step_window;

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::Command;
use handeye::app::workbench::scans::{ExaminedScan, RegionChoice, ScanCalibration, ScanCommand};
use handeye::scan::files::read_cloud;
use handeye::scene::{PITCH_MM, PartKind};
use handeye::session::Session;
use handeye::simulate::{SimulationOptions, SimulationTarget, simulate};
use handeye::text::arcs as arcs_words;
use handeye::text::workpiece as words;
use handeye::ui::{Step, Window};
use handeye::watch::Unwatched;
use step_window::{apply, click, settle, window_of_size, window_on, workbench};

/// A block and a toothed part, each scanned twice with a profile every 2 mm.
fn parts(seed: u64) -> Session {
    let usual = SimulationOptions::of(SimulationTarget::Part(PartKind::Square));
    let further = vec![SimulationTarget::Part(PartKind::Teeth)];
    let num_steps = SimulationOptions::steps_to_scan(PartKind::Square, 2.0);
    simulate(&SimulationOptions { seed, further, num_steps, step_mm: 2.0, num_points: 160, ..usual })
}

fn examined<'a>(harness: &'a Harness<'static, Window>) -> &'a ExaminedScan {
    workbench(harness).scans().examined().expect("examined")
}

fn scan(harness: &mut Harness<'static, Window>, command: ScanCommand) {
    apply(harness, Command::Scan(Box::new(command)));
}

fn press(harness: &mut Harness<'static, Window>, name: &str, key: Key) {
    harness.get_by_label(name).focus();
    harness.run_steps(2);
    harness.key_press(key);
    settle(harness);
}

fn names(harness: &Harness<'static, Window>) -> Vec<String> {
    examined(harness).regions.iter().map(|region| region.name.clone()).collect()
}

#[test]
fn a_part_shows_its_planes_and_their_angle_at_once() {
    let harness = window_on(parts(1));
    assert!(harness.query_by_label(words::CLOUD).is_some());
    let scan = examined(&harness);
    assert!(scan.regions.len() >= 2, "{}", scan.regions.len());
    for region in &scan.regions {
        assert!(harness.query_by_label(&words::show_region(&region.name)).is_some());
        let fit = region.plane.as_ref().expect("a plane");
        let equation = words::equation(&fit.equation()).replace('-', "−");
        assert!(harness.query_by_label(&equation).is_some(), "{equation}");
    }
    let [a, b] = [0, 1].map(|idx| scan.regions[idx].plane.as_ref().expect("a plane"));
    let angle = words::angle(a, b, scan.known.angle_deg).replace('-', "−");
    assert!(angle.contains("off 90°"), "{angle}");
    assert!(harness.query_by_label(&angle).is_some(), "{angle}");
}

#[test]
fn regions_are_chosen_removed_and_had_back() {
    let mut harness = window_on(parts(2));
    let before = names(&harness);
    let (first, title) = (before[0].clone(), |shown: &str| words::histogram_title(400, shown));
    assert!(harness.query_by_label(&title(words::ALL_REGIONS)).is_some());
    // By the keyboard alone, and back.
    press(&mut harness, &words::show_region(&first), Key::Enter);
    assert!(harness.query_by_label(&title(&first)).is_some());
    press(&mut harness, &words::show_region(&first), Key::Space);
    assert!(harness.query_by_label(&title(words::ALL_REGIONS)).is_some());
    // By the mouse.
    click(&mut harness, &words::show_region(&first));
    assert!(harness.query_by_label(&title(&first)).is_some());
    click(&mut harness, &words::remove_region(&first));
    assert_eq!(names(&harness), before[1..]);
    click(&mut harness, words::UNDO_REGIONS);
    assert_eq!(names(&harness), before);
    assert!(!workbench(&harness).scans().can_undo_regions());
    // Found anew the planes are the same; that can be taken back as well.
    click(&mut harness, &words::remove_region(&first));
    click(&mut harness, words::FIND_PLANES);
    assert_eq!(names(&harness), before);
    click(&mut harness, words::UNDO_REGIONS);
    assert_eq!(names(&harness), before[1..]);
}

#[test]
fn planes_are_picked_by_mouse_and_keyboard() {
    let mut harness = window_on(parts(3));
    let first = names(&harness)[0].clone();
    let before = examined(&harness).regions[0].set.len();
    click(&mut harness, &words::remove_region(&first));
    let num_left = names(&harness).len();
    click(&mut harness, words::TOOL_POINT);
    // From the front the middle of the picture is on the block.
    click(&mut harness, &words::look_along("z"));
    press(&mut harness, words::CLOUD, Key::Enter);
    assert_eq!(names(&harness).len(), num_left + 1, "{:?}", workbench(&harness).notices());
    let picked = examined(&harness).regions.last().expect("picked");
    assert_eq!(picked.name, first, "the free name");
    let fit = picked.plane.as_ref().expect("a plane");
    assert!(fit.rms_mm < 0.1 && picked.set.len() * 10 > before * 8, "{fit:?}");
    click(&mut harness, words::UNDO_REGIONS);
    let place = harness.get_by_label(words::CLOUD).rect().center();
    harness.hover_at(place);
    harness.run_steps(1);
    harness.drag_at(place);
    harness.drop_at(place);
    settle(&mut harness);
    assert_eq!(names(&harness).len(), num_left + 1, "a click picks as well");
    // The middle of the picture as a rectangle.
    click(&mut harness, words::TOOL_RECTANGLE);
    press(&mut harness, words::CLOUD, Key::Enter);
    assert_eq!(names(&harness).len(), num_left + 2);
}

#[test]
fn a_plane_is_no_region_twice_and_all_angles_can_be_reached() {
    let mut harness = window_on(parts(9));
    let scan = examined(&harness);
    let before = names(&harness);
    // A point of the largest plane, near its midst.
    let region = &scan.regions[0];
    let middle = region.plane.as_ref().expect("a plane").centroid_mm;
    let from_middle = |idx: &usize| (scan.cloud.point_mm(*idx) - middle).norm();
    let nearest = region.set.indices().min_by(|a, b| from_middle(a).total_cmp(&from_middle(b))).expect("points");
    let picked = RegionChoice::Plane(scan.cloud.point_mm(nearest));
    let num_pairs = before.len() * (before.len() - 1) / 2;
    assert!(num_pairs > 0);
    for (second, name) in before.iter().enumerate() {
        for first in &before[..second] {
            assert!(harness.query_by_label(&words::angle_label(first, name)).is_some(), "{first}, {name}");
        }
    }
    self::scan(&mut harness, ScanCommand::AddRegion(picked));
    assert_eq!(names(&harness), before);
    let said = &workbench(&harness).notices().last().expect("said so").message;
    assert_eq!(*said, words::region_is_known(&before[0]));
}

#[test]
fn teeth_are_shown_with_their_errors() {
    let mut harness = window_on(parts(4));
    let names: Vec<String> =
        workbench(&harness).document().expect("open").session.scans().iter().map(words::scan_name).collect();
    let scan_idx = names.iter().position(|name| name.contains("toothed")).expect("simulated");
    scan(&mut harness, ScanCommand::Examine { scan_idx, calibration: ScanCalibration::Truth });
    let shapes = &examined(&harness).shapes;
    let teeth = shapes.teeth.as_ref().expect("asked for").as_ref().expect("teeth").clone();
    assert_eq!(teeth.teeth.len(), 5);
    let deviation = handeye::scan::Deviation::of(teeth.pitches(), PITCH_MM).expect("pitches");
    assert!(deviation.max_error_mm < 0.1, "{deviation:?}");
    assert!(harness.query_by_label(&words::mean_label(words::PITCH, PITCH_MM)).is_some());
    assert!(harness.query_all_by_label(&words::mm(deviation.max_error_mm)).next().is_some());
    let first = teeth.teeth[0].pitch.expect("a pitch").value_mm;
    assert!(harness.query_all_by_label(&format!("{first:.3}")).next().is_some());
}

#[test]
fn a_cancelled_examination_is_not_begun_again_by_itself() {
    let mut harness = window_on(parts(5));
    let bench = harness.state_mut().shell_mut().workbench_mut();
    bench.apply(Command::Scan(Box::new(ScanCommand::Examine { scan_idx: 1, calibration: ScanCalibration::Truth })));
    bench.apply(Command::Scan(Box::new(ScanCommand::Cancel)));
    settle(&mut harness);
    assert_eq!(workbench(&harness).scans().failure().map(|failure| failure.reason.as_str()), Some(words::CANCELLED));
    assert_eq!(examined(&harness).scan_idx, Some(0), "what was there stays");
    click(&mut harness, words::EXAMINE_AGAIN);
    assert!(workbench(&harness).scans().failure().is_none());
    assert_eq!(examined(&harness).scan_idx, Some(1));
}

#[test]
fn points_go_to_a_file_and_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window_on(parts(6));
    let (num_points, num_regions) = (examined(&harness).cloud.len(), examined(&harness).regions.len());
    for name in ["part.ply", "part.csv"] {
        let path = folder.path().join(name);
        scan(&mut harness, ScanCommand::Export(path.clone()));
        let read = read_cloud(&path, &mut Unwatched).expect("readable");
        assert_eq!(read.cloud.len(), num_points, "{name}");
        assert_eq!(read.cloud.point_mm(0).map(f64::round), examined(&harness).cloud.point_mm(0).map(f64::round));
        let said = workbench(&harness).notices().last().expect("said so").message.clone();
        assert!(said.contains(name) && said.contains(&words::grouped(num_points)), "{said}");
    }
    scan(&mut harness, ScanCommand::OpenPoints(folder.path().join("part.ply")));
    assert_eq!((examined(&harness).cloud.len(), examined(&harness).regions.len()), (num_points, num_regions));
    assert!(harness.query_by_label(&words::picture_title("part.ply", num_points, None)).is_some());
    scan(&mut harness, ScanCommand::Export(folder.path().join("part.obj")));
    let said = workbench(&harness).notices().last().expect("said so").message.clone();
    assert!(said.contains(".obj") && said.contains(".ply"), "{said}");
}

#[test]
fn the_profiles_of_a_scan_are_no_refused_arcs() {
    let mut harness = window_on(parts(7));
    harness.state_mut().shell_mut().go_to(Step::Arcs);
    settle(&mut harness);
    assert!(harness.query_by_label(arcs_words::RANGES).is_some());
    let session = &workbench(&harness).document().expect("open").session;
    let handeye::session::Reading::Profile(profile) = &session.stations[0].captures[0].reading else {
        panic!("a scan holds profiles")
    };
    let (num_valid, num_points) = (profile.valid_points().count(), profile.len());
    assert!(harness.query_by_label_contains(&format!("{num_valid} of {num_points} points, x ")).is_some());
    let results = workbench(&harness).results().expect("measured");
    let line = results.measured.scan_line(0, 0).expect("a line");
    assert_eq!((line.num_valid, line.num_points), (num_valid, num_points));
    assert!(results.measured.reading(0, 0).is_none() && results.measured.further_reading(0, 0, 0).is_none());
    assert_eq!(harness.query_all_by_label_contains("found no").count(), 0);
}

#[test]
fn equations_are_whole_at_every_size() {
    for size in [[1024.0, 768.0], [1440.0, 900.0], [1900.0, 1100.0]] {
        let harness = window_of_size(parts(8), size);
        for region in &examined(&harness).regions {
            let fit = region.plane.as_ref().expect("a plane");
            let equation = words::equation(&fit.equation()).replace('-', "−");
            let label = harness.get_by_label(&equation).rect();
            let room = harness.ctx.fonts_mut(|fonts| {
                let font = handeye::ui::theme::number_font();
                fonts.layout_no_wrap(equation.clone(), font, egui::Color32::WHITE).size().x
            });
            assert!(label.width() >= room - 0.5, "{equation} has {} of {room} at {size:?}", label.width());
        }
    }
}
