//! Session files: what is refused and how, what survives, and that saving never costs the old file.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::fs;

use handeye::calibrate::{Mount, Side, SideChoice};
use handeye::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use handeye::geometry::{PoseConvention, PoseNotation, Transform, Vec3, so3};
use handeye::session::format::{load_with_notes, parse_with_notes};
use handeye::session::{Edge, Known, Reading, Session, SessionError, Target, check, load, parse, save, to_json};

/// A small session with every kind of field; the broken files below are made from it by one replacement each.
const VALID: &str = include_str!("data/every_field.json");

/// A session of a point with everything that further targets and other kinds have.
const TARGETS: &str = include_str!("data/every_target.json");

fn valid() -> Session {
    parse(VALID.as_bytes(), "valid.json").expect("the base of the tests is valid")
}

#[track_caller]
fn check_refused(json: &str, fragments: &[&str]) {
    let refusal = match parse(json.as_bytes(), "cell.json") {
        Ok(_) => panic!("accepted, but expected a refusal with {fragments:?}"),
        Err(refusal) => refusal.to_string(),
    };
    assert!(!refusal.contains('\n'), "one line: {refusal}");
    assert!(refusal.contains("cell.json"), "names the file: {refusal}");
    for fragment in fragments {
        assert!(refusal.contains(fragment), "{fragment:?} is not in: {refusal}");
    }
}

#[rustfmt::skip]
/// Refusals of [`TARGETS`] with one piece replaced.
const BROKEN_TARGETS: &[(&str, &str, &[&str])] = &[
    ("[400, -20.5, 61.25]", "[400, -20.5]", &["target.touched_in_base_mm: found a list of 2, expected a list of 3 numbers"]),
    ("[400, -20.5, 61.25]", "[400, -20.5, 1e9]", &["target.touched_in_base_mm[2]: found 1000000000, expected a position in mm"]),
    ("\"rough_flange_from_sensor\": {", "\"rough_flange_from_sensor\": 4, \"x\": {", &["sensor.rough_flange_from_sensor: found 4, expected an object with translation_mm"]),
    ("\"euler_deg\": [0, 90, 0]", "\"euler_deg\": [0, 90]", &["sensor.rough_flange_from_sensor.euler_deg: found a list of 2"]),
    (", \"convention\": \"kuka-abc\"", "", &["sensor.rough_flange_from_sensor.convention: found nothing"]),
    ("\"point_in_base_mm\"", "\"ball_in_base_mm\"", &["truth.point_in_base_mm: found nothing, expected the true point"]),
    ("\"further\": [", "\"further\": 3, \"x\": [", &["further: found 3, expected a list of further targets"]),
    ("\"name\": \"plate\", \"target\"", "\"target\"", &["further[0].name: found nothing, expected text on one line"]),
    ("\"name\": \"plate\"", "\"name\": \"a\\nb\"", &["further[0].name: found", "expected text on one line"]),
    ("\"name\": \"block\"", "\"name\": \"plate\"", &["further[1].name: found \"plate\", which further[0] has too, expected a name of its own for each further target"]),
    ("\"kind\": \"right-angle-plate\"", "\"kind\": \"rgbd\"", &["further[0].target.kind: found \"rgbd\", expected \"ball\", \"right-angle-plate\", \"point\", \"pose\" or \"workpiece\""]),
    ("\"kind\": \"right-angle-plate\"", "\"kind\": \"ball\"", &["further[0].target.radius_mm: found nothing"]),
    ("\"edge\": \"p\", ", "", &["further[0].stations[0].edge: found nothing, expected \"p\" or \"q\""]),
    ("\"edge\": \"p\"", "\"edge\": \"P\"", &["further[0].stations[0].edge: found \"P\", expected \"p\" or \"q\""]),
    ("\"edge\": \"q\"", "\"edge\": \"q \"", &["further[0].stations[1].edge: found \"q \", expected \"p\" or \"q\""]),
    ("\"euler_deg\": [0, 90, 0], \"convention\": \"kuka-abc\"", "\"quaternion_wxyz\": [0.5, 0.1, 0, 0]", &["sensor.rough_flange_from_sensor.quaternion_wxyz: found a quaternion of norm 0.509902, expected norm 1"]),
    ("\"pitch_mm\": 15", "\"pitch_mm\": NaN", &["line 18, column", "found NaN, expected a finite number"]),
    ("\"height_mm\": 10", "\"height_mm\": 1e9", &["further[1].target.height_mm: found 1000000000", "expected a part's size in mm"]),
    ("\"diameter_mm\": 40", "\"diameter_mm\": \"40\"", &["further[1].target.diameter_mm: found \"40\""]),
    ("\"stations\": [], \"their 4\"", "\"their 4\"", &["further[1].stations: found nothing, expected a list of stations"]),
    ("\"label\": \"q1\"", "\"label\": \"p1\"", &["further[0].stations[1].label: found \"p1\", which further[0].stations[0] has too"]),
    ("\"point_mm\": [1, 0, 80]", "\"point_mm\": [1, 0]", &["further[0].stations[0].captures[0].point_mm: found a list of 2"]),
    ("\"pitch_mm\": 15", "\"pitch_mm\": -15", &["further[1].target.pitch_mm: found -15, expected a part's size in mm"]),
    ("\"angle_deg\": 90", "\"angle_deg\": 190", &["further[1].target.angle_deg: found 190, expected an angle between two planes in degrees from 0 to 180"]),
];

#[rustfmt::skip]
/// Refusals of [`VALID`] with one piece replaced: the piece, what stands there instead, what the message holds.
const BROKEN: &[(&str, &str, &[&str])] = &[
    ("\"handeye-session\"", "\"handeye-result\"", &["format: found \"handeye-result\", expected \"handeye-session\""]),
    ("\"format\": \"handeye-session\",", "", &["format: found nothing, expected \"handeye-session\""]),
    ("\"format\": \"handeye-session\"", "\"format\": 7", &["format: found 7"]),
    ("\"version\": 1", "\"version\": 2", &["version: found 2, expected at most 1", "newer Handeye"]),
    ("\"version\": 1", "\"version\": 0", &["version: found 0, expected the version of the format"]),
    ("\"version\": 1", "\"version\": -1", &["version: found -1"]),
    ("\"version\": 1", "\"version\": 1.5", &["version: found 1.5"]),
    ("\"version\": 1", "\"version\": \"1\"", &["version: found \"1\""]),
    ("\"version\": 1,", "", &["version: found nothing"]),
    ("\"name\": \"cell 3\"", "\"name\": 3", &["name: found 3, expected text"]),
    ("\"name\": \"cell 3\",", "\"name\": \"cell 3\", \"name\": \"\",", &["line 4", "\"name\" stands twice"]),
    ("\"model\": \"FANUC\"", "\"model\": [1]", &["robot.model: found a list of 1, expected text"]),
    ("\"pose_convention\": \"fanuc-wpr\"", "\"pose_convention\": \"fanuc\"", &["robot.pose_convention: found \"fanuc\"", "\"fanuc-wpr\", \"abb-ezeyex\"", "\"epson-uvw\"", "or \"rotation-vector\""]),
    ("\"orientation\": \"quaternion-xyzw\"", "\"orientation\": \"quaternion\"", &["robot.pose_notation.orientation: found \"quaternion\", expected \"angles\", \"quaternion-wxyz\" or \"quaternion-xyzw\""]),
    ("\"angle_unit\": \"rad\"", "\"angle_unit\": 1", &["robot.pose_notation.angle_unit: found 1, expected \"deg\" or \"rad\""]),
    ("\"length_unit\": \"m\"", "\"length_unit\": \"inch\"", &["robot.pose_notation.length_unit: found \"inch\", expected \"mm\" or \"m\""]),
    ("\"inverse\": true", "\"inverse\": \"yes\"", &["robot.pose_notation.inverse: found \"yes\", expected true or false"]),
    ("[-4, 0, 120.5]", "[-4, 0, 1e7]", &["robot.pose_notation.flange_from_tcp.translation_mm[2]: found 10000000"]),
    ("[0.8, 0, 0, 0.6]", "[0.8, 0, 0, 0]", &["robot.pose_notation.flange_from_tcp.quaternion_wxyz: found a quaternion of norm 0.800000"]),
    ("\"flange_from_tcp\": {", "\"flange_from_tcp\": 4, \"x\": {", &["robot.pose_notation.flange_from_tcp: found 4"]),
    ("\"pose_notation\": {", "\"pose_notation\": \"m\", \"x\": {", &["robot.pose_notation: found \"m\", expected an object"]),
    ("\"position_std_mm\": 0.02", "\"position_std_mm\": 0", &["robot.position_std_mm: found 0, expected a standard deviation in mm"]),
    ("\"position_std_mm\": 0.02", "\"position_std_mm\": -0.02", &["robot.position_std_mm: found -0.02"]),
    ("\"orientation_std_deg\": 0.005", "\"orientation_std_deg\": 400", &["robot.orientation_std_deg: found 400"]),
    ("\"profile_std_mm\": 0.01", "\"profile_std_mm\": 1e9", &["sensor.profile_std_mm: found 1000000000"]),
    ("\"profile_std_mm\": 0.01", "\"profile_std_mm\": \"fine\"", &["sensor.profile_std_mm: found \"fine\""]),
    ("\"reference_distance_mm\": 60", "\"reference_distance_mm\": -60", &["sensor.reference_distance_mm: found -60"]),
    ("\"radius_mm\": 15.0", "\"radius_mm\": -15", &["target.radius_mm: found -15, expected a ball's radius in mm from 0.001 to 10000"]),
    ("\"radius_mm\": 15.0", "\"radius_mm\": 0", &["target.radius_mm: found 0"]),
    ("\"radius_mm\": 15.0", "\"radius_mm\": 1e300", &["target.radius_mm: found 1e+300"]),
    ("\"radius_mm\": 15.0", "\"radius_mm\": 1e999", &["line 11, column", "found 1e999, expected a finite number"]),
    ("\"radius_mm\": 15.0", "\"radius_mm\": NaN", &["line 11, column", "found NaN, expected a finite number"]),
    ("\"radius_mm\": 15.0", "\"radius_mm\": Infinity", &["line 11, column", "found Infinity, expected a finite number"]),
    ("\"radius_mm\": 15.0", "\"radius_mm\": null", &["target.radius_mm: found nothing, expected a ball's radius"]),
    ("\"kind\": \"ball\"", "\"kind\": \"cube\"", &["target.kind: found \"cube\"", "\"ball\", \"right-angle-plate\", \"point\", \"pose\", \"workpiece\" or \"rgbd\""]),
    ("\"kind\": \"ball\", ", "", &["target.kind: found nothing"]),
    ("{ \"kind\": \"ball\", \"radius_mm\": 15.0 }", "\"ball\"", &["target: found \"ball\", expected an object like"]),
    ("\"target\": { \"kind\": \"ball\", \"radius_mm\": 15.0 },", "", &["target: found nothing"]),
    ("\"kind\": \"ball\"", "\"kind\": \"right-angle-plate\"", &["stations[0].edge: found nothing, expected \"p\" or \"q\""]),
    ("\"kind\": \"ball\"", "\"kind\": \"rgbd\"", &["sequence: found nothing, expected the sequence's folder"]),
    ("\"target\": { \"kind\": \"ball\", \"radius_mm\": 15.0 }", "\"target\": { \"kind\": \"rgbd\" }, \"sequence\": \"/etc\"", &["sequence: found \"/etc\"", "relative"]),
    ("\"target\": { \"kind\": \"ball\", \"radius_mm\": 15.0 }", "\"target\": { \"kind\": \"rgbd\" }, \"sequence\": \"a/b\"", &["stations: found a list of 2, expected no stations"]),
    ("\"mount\": \"on-flange\"", "\"mount\": \"ceiling\"", &["mount: found \"ceiling\", expected \"on-flange\" or \"fixed\""]),
    ("\"side\": \"+\"", "\"side\": \"left\"", &["stations[0].side: found \"left\", expected \"auto\", \"+\" or \"-\""]),
    ("\"side\": \"+\"", "\"edge\": \"r\"", &["stations[0].edge: found \"r\", expected \"p\" or \"q\""]),
    ("\"enabled\": false", "\"enabled\": \"no\"", &["stations[0].enabled: found \"no\", expected true or false"]),
    ("\"label\": \"first\"", "\"label\": 1", &["stations[0].label: found 1, expected text"]),
    ("\"label\": \"first\"", "\"label\": \" \"", &["stations[0].label: found \" \""]),
    ("\"label\": \"first\"", "\"label\": \"a\\nb\"", &["stations[0].label: found \"a\u{fffd}b\""]),
    ("\"label\": \"first\"", "\"label\": \"2\"", &["stations[1].label: found \"2\", which stations[0] has too"]),
    ("{ \"captures\": [\n        { \"base_from_flange\": { \"translation_mm\": [7, 8, 9]", "{ \"captures\": [], \"x\": [\n        { \"base_from_flange\": { \"translation_mm\": [7, 8, 9]", &["stations[1].captures: found an empty list, expected at least one capture"]),
    ("\"side\": \"+\",\n      \"captures\"", "\"side\": \"+\",\n      \"capture\"", &["stations[0].captures: found nothing"]),
    ("\"published\"", "\"stations\": 5, \"published\"", &["\"stations\" stands twice"]),
    ("[1, 2, 3], \"quaternion", "[1, 2], \"quaternion", &["stations[0].captures[0].base_from_flange.translation_mm: found a list of 2, expected a list of 3 numbers"]),
    ("[1, 2, 3], \"quaternion", "[1, 1e8, 3], \"quaternion", &["stations[0].captures[0].base_from_flange.translation_mm[1]: found 100000000"]),
    ("[1, 2, 3], \"quaternion", "[1, null, 3], \"quaternion", &["stations[0].captures[0].base_from_flange.translation_mm[1]: found null"]),
    ("[1, 2, 3], \"quaternion", "[1, \"2\", 3], \"quaternion", &["stations[0].captures[0].base_from_flange.translation_mm[1]: found \"2\""]),
    ("\"translation_mm\": [1, 2, 4], ", "", &["stations[0].captures[1].base_from_flange.translation_mm: found nothing"]),
    ("\"translation_mm\": [1, 2, 4], \"quaternion_wxyz\": [0.6, 0.8, 0, 0]", "\"translation_mm\": [1, 2, 4], \"quaternion_wxyz\": [0.6, 0.8, 0.1, 0]", &["stations[0].captures[1].base_from_flange.quaternion_wxyz: found a quaternion of norm 1.004988, expected norm 1 within 0.001"]),
    ("\"translation_mm\": [1, 2, 4], \"quaternion_wxyz\": [0.6, 0.8, 0, 0]", "\"translation_mm\": [1, 2, 4], \"quaternion_wxyz\": [0, 0, 0, 0]", &["quaternion_wxyz: found a quaternion of norm 0.000000"]),
    ("\"translation_mm\": [1, 2, 4], \"quaternion_wxyz\": [0.6, 0.8, 0, 0]", "\"translation_mm\": [1, 2, 4], \"quaternion_wxyz\": [0.6, 0.8, 0]", &["quaternion_wxyz: found a list of 3, expected a list of 4 numbers"]),
    ("\"translation_mm\": [1, 2, 4], \"quaternion_wxyz\": [0.6, 0.8, 0, 0]", "\"translation_mm\": [1, 2, 4]", &["stations[0].captures[1].base_from_flange: found no orientation"]),
    ("\"translation_mm\": [1, 2, 4],", "\"translation_mm\": [1, 2, 4], \"euler_deg\": [1, 2, 3],", &["base_from_flange: found both quaternion_wxyz and euler_deg"]),
    ("\"convention\": \"kuka-abc\"", "\"convention\": \"kuka\"", &["stations[1].captures[0].base_from_flange.convention: found \"kuka\"", "\"kuka-abc\""]),
    (", \"convention\": \"kuka-abc\"", "", &["stations[1].captures[0].base_from_flange.convention: found nothing, expected \"fanuc-wpr\""]),
    ("\"euler_deg\": [180, 10, 20]", "\"euler_deg\": [180, 1e7, 20]", &["stations[1].captures[0].base_from_flange.euler_deg[1]: found 10000000, expected an angle in degrees"]),
    ("\"written\": { \"euler_deg\": [106.26020470831196, 0, 0], \"convention\": \"staubli-rxryrz\" }", "\"written\": \"staubli-rxryrz\"", &["stations[0].captures[1].base_from_flange.written: found \"staubli-rxryrz\", expected an object with euler_deg and convention"]),
    ("\"euler_deg\": [106.26020470831196, 0, 0], ", "", &["stations[0].captures[1].base_from_flange.written.euler_deg: found nothing, expected a list of 3 angles"]),
    ("[106.26020470831196, 0, 0]", "[106.26020470831196, 0]", &["base_from_flange.written.euler_deg: found a list of 2, expected a list of 3 numbers"]),
    ("[106.26020470831196, 0, 0]", "[106.26020470831196, null, 0]", &["base_from_flange.written.euler_deg[1]: found null"]),
    (", \"convention\": \"staubli-rxryrz\"", "", &["base_from_flange.written.convention: found nothing, expected \"fanuc-wpr\""]),
    ("\"convention\": \"staubli-rxryrz\"", "\"convention\": \"staubli\"", &["base_from_flange.written.convention: found \"staubli\""]),
    ("\"quaternion_wxyz\": [0.6, 0.8, 0, 0],\n", "\"euler_deg\": [1, 2, 3], \"convention\": \"fanuc-wpr\",\n", &["base_from_flange.written: found both euler_deg and written, expected written only beside"]),
    ("{ \"base_from_flange\": { \"translation_mm\": [1, 2, 3], \"quaternion_wxyz\": [0.6, 0.8, 0, 0] },", "{", &["stations[0].captures[0].base_from_flange: found nothing"]),
    ("\"z_mm\": [0.25, null]", "\"z_mm\": [0.25]", &["stations[0].captures[0].profile.z_mm: found a list of 1, expected a list of 2, as many as x_mm has"]),
    ("\"z_mm\": [0.25, null]", "\"z_mm\": [0.25, -1e6]", &["stations[0].captures[0].profile.z_mm[1]: found -1000000"]),
    ("\"z_mm\": [0.25, null]", "\"z_mm\": [0.25, true]", &["stations[0].captures[0].profile.z_mm[1]: found true"]),
    ("\"z_mm\": [0.25, null]", "\"z_mm\": 0.25", &["stations[0].captures[0].profile.z_mm: found 0.25, expected a list of numbers"]),
    ("\"x_mm\": [-1, 0.5]", "\"x_mm\": [-1, null]", &["stations[0].captures[0].profile.x_mm[1]: found null"]),
    (", \"z_mm\": [0.25, null]", "", &["stations[0].captures[0].profile.z_mm: found nothing"]),
    ("\"step\": -0.5, \"point_mm\"", "\"step\": -0.5, \"profile\": { \"x_mm\": [], \"z_mm\": [] }, \"point_mm\"", &["stations[0].captures[1]: found both profile and point_mm, expected one of profile, point_mm and sensor_from_target"]),
    ("\"step\": -0.5, \"point_mm\": [4, 5, 6]", "\"step\": -0.5", &["stations[0].captures[1]: found neither profile nor point_mm"]),
    ("\"step\": -0.5", "\"step\": [0.5]", &["stations[0].captures[1].step: found a list of 1, expected a move in mm"]),
    ("\"point_mm\": [4, 5, 6]", "\"point_mm\": [4, 5, {}]", &["stations[0].captures[1].point_mm[2]: found an object"]),
    ("\"ball_in_base_mm\": [[1, 2, 3], [4, 5, 6]]", "\"ball_in_base_mm\": [[1, 2, 3]]", &["published.ball_in_base_mm: found a list of 1, expected a list of 2, one a station"]),
    ("\"error_from_first_mm\": [[0, 0, 0], [3, 3, 3]]", "\"error_from_first_mm\": [[0, 0, 0], [3, 3]]", &["published.error_from_first_mm[1]: found a list of 2"]),
    ("\"ball_in_base_mm\": [0, 0, 0] }", "\"ball\": [0, 0, 0] }", &["truth.ball_in_base_mm: found nothing"]),
    ("\"truth\": { \"flange_from_sensor\":", "\"truth\": { \"sensor\":", &["truth.flange_from_sensor: found nothing"]),
    ("\"truth\": {", "\"truth\": [", &["line 28, column 34: found `: { \"translation_mm\"", "expected JSON: expected `,` or `]`"]),
    ("\"notes\": \"line 1\\nline 2\",", "\"notes\": \"line 1\\nline 2\"", &["line 6, column 3: found `\"robot\"", "expected JSON: expected `,` or `}`"]),
];

#[test]
fn broken_files_are_refused_with_place_found_and_expected() {
    for (piece, instead, fragments) in BROKEN {
        assert_eq!(VALID.matches(piece).count(), 1, "{piece:?} must occur once");
        check_refused(&VALID.replacen(piece, instead, 1), fragments);
    }
}

#[test]
fn broken_targets_are_refused_with_place_found_and_expected() {
    for (piece, instead, fragments) in BROKEN_TARGETS {
        assert_eq!(TARGETS.matches(piece).count(), 1, "{piece:?} must occur once");
        check_refused(&TARGETS.replacen(piece, instead, 1), fragments);
    }
}

#[test]
fn what_is_known_of_targets_is_read_as_written_and_saved_as_read() {
    let session = parse(TARGETS.as_bytes(), "targets.json").expect("valid");
    assert_eq!(session.known, Known { point_in_base_mm: Some(Vec3::new(400.0, -20.5, 61.25)), ..Known::default() });
    let rough = session.sensor.rough_flange_from_sensor.expect("it is given");
    assert!(rough.rotation().angle_to(&so3::exp(Vec3::y() * std::f64::consts::FRAC_PI_2)) < 1e-12);
    assert_eq!(session.truth.as_ref().expect("given").target_in_base_mm, Vec3::new(401.0, -20.0, 61.0));
    let [plate, block] = session.further.as_slice() else { panic!("{:?}", session.further) };
    assert_eq!((plate.name.as_str(), &plate.target), ("plate", &Target::RightAnglePlate));
    assert_eq!([plate.stations[0].edge, plate.stations[1].edge], [Some(Edge::P), Some(Edge::Q)]);
    assert!(!plate.stations[1].enabled);
    let sizes = Known {
        angle_deg: Some(90.0),
        pitch_mm: Some(15.0),
        height_mm: Some(10.0),
        diameter_mm: Some(40.0),
        point_in_base_mm: None,
    };
    assert_eq!((&block.target, block.known), (&Target::Workpiece, sizes));
    let saved = to_json(&session);
    assert_eq!(parse(saved.as_bytes(), "again.json"), Ok(session));
    for line in [
        "  \"target\": { \"kind\": \"point\", \"touched_in_base_mm\": [400, -20.5, 61.25], \"their 2\": 2 },",
        "      \"name\": \"block\",",
        "      \"target\": { \"kind\": \"workpiece\", \"angle_deg\": 90, \"pitch_mm\": 15, \"height_mm\": 10, \"diameter_mm\": 40 },",
    ] {
        assert!(saved.lines().any(|found| found == line), "{line:?} is no line of\n{saved}");
    }
    for piece in ["their 1", "their 2", "their 3", "their 4"] {
        assert_eq!(saved.matches(piece).count(), 1, "{piece} survives in {saved}");
    }
}

#[test]
fn what_is_not_set_is_not_written() {
    let saved = to_json(&valid());
    for field in ["further", "touched_in_base_mm", "rough_flange_from_sensor", "angle_deg"] {
        assert!(!saved.contains(field), "{field} in {saved}");
    }
}

#[test]
fn files_that_are_no_session_at_all_are_refused() {
    check_refused("", &["found an empty file"]);
    check_refused(" \n\t", &["found an empty file"]);
    check_refused("[]", &["top level: found an empty list, expected a session"]);
    check_refused("null", &["top level: found null"]);
    check_refused("{\"format\": \"handeye-session\"", &["line 1, column 28: found the end of the file"]);
    check_refused(
        &VALID[..VALID.len() / 2],
        &["found the end of the file", "the file was cut off", "take it from a copy"],
    );
    check_refused(&format!("{VALID} x"), &["found `x`", "trailing characters"]);
    check_refused(&"[".repeat(100_000), &["recursion limit exceeded"]);
    check_refused(&format!("{{\"deep\": {}", "{\"a\":".repeat(10_000)), &["recursion limit exceeded"]);
    check_refused(
        "x,y,z\n1,2,3\n",
        &["line 1, column 1: found `x,y,z`", "a number, text in quotes, a list or an object"],
    );
    for (written, shown) in [
        ("NaN", "NaN"),
        ("nan", "nan"),
        ("-Infinity", "-Infinity"),
        ("inf", "inf"),
        ("1e999", "1e999"),
        ("-2.5E400", "-2.5E400"),
    ] {
        let json = VALID.replacen("\"z_mm\": [0.25", &format!("\"z_mm\": [{written}"), 1);
        assert!(json.contains(written), "the valid session has changed");
        check_refused(&json, &[&format!("found {shown}, expected a finite number"), "write null in z_mm", "line "]);
    }
}

#[test]
fn text_must_be_utf8_and_may_begin_with_a_byte_order_mark() {
    let mut bytes = b"\xef\xbb\xbf".to_vec();
    bytes.extend_from_slice(VALID.as_bytes());
    assert_eq!(parse(&bytes, "bom.json"), Ok(valid()));
    let broken = b"{\n  \"name\": \"\xff\" }";
    let refusal = parse(broken, "latin.json").expect_err("not UTF-8").to_string();
    assert!(refusal.contains("latin.json, line 2, column 12: found bytes that are not UTF-8"), "{refusal}");
}

#[test]
fn the_valid_session_is_read_as_written() {
    let session = valid();
    assert_eq!(session.notes, "line 1\nline 2");
    assert_eq!(session.target, Target::ball(15.0));
    assert_eq!(session.robot.orientation_std_deg, Some(0.005));
    let turn = so3::exp(Vec3::z() * 2.0 * 0.6_f64.asin());
    let notation = session.robot.notation;
    assert_eq!(
        PoseNotation { flange_from_tcp: None, ..notation },
        PoseNotation {
            convention: PoseConvention::default_convention(),
            orientation: OrientationForm::QuaternionXyzw,
            angle_unit: AngleUnit::Radians,
            length_unit: LengthUnit::Metres,
            flange_from_tcp: None,
            is_inverse: true,
        }
    );
    let flange_from_tcp = notation.flange_from_tcp.expect("there is a tool point");
    assert_eq!(flange_from_tcp.translation_mm(), Vec3::new(-4.0, 0.0, 120.5));
    assert!(flange_from_tcp.rotation().angle_to(&turn) < 1e-15);
    assert_eq!(session.stations[0].side, SideChoice::Given(Side::Plus));
    assert!(!session.stations[0].enabled && session.stations[1].enabled);
    assert_eq!(session.stations[1].label, "2", "the label is its number by default");
    assert_eq!(session.stations[0].captures[1].step_mm, Some(-0.5));
    assert_eq!(session.stations[0].captures[1].reading, Reading::Point(Vec3::new(4.0, 5.0, 6.0)));
    let kuka = PoseConvention::by_id("kuka-abc").expect("known").rotation_from_angles_deg([180.0, 10.0, 20.0]);
    assert!(session.stations[1].captures[0].base_from_flange.rotation().angle_to(&kuka) < 1e-12);
    let written = |station: usize, capture: usize| {
        session.stations[station].captures[capture].written_angles.map(|w| (w.angles_deg, w.convention.id))
    };
    assert_eq!(written(0, 0), None);
    assert_eq!(written(0, 1), Some(([106.260_204_708_311_96, 0.0, 0.0], "staubli-rxryrz")));
    assert_eq!(written(1, 0), Some(([180.0, 10.0, 20.0], "kuka-abc")));
    assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session));
}

#[test]
fn a_session_without_stations_and_optional_fields_is_fine() {
    let json = r#"{"format": "handeye-session", "version": 1, "target": {"kind": "point"}, "stations": [],
                   "robot": null, "published": null}"#;
    let session = parse(json.as_bytes(), "empty.json").expect("valid");
    assert_eq!((session.name.as_str(), session.stations.len(), session.mount), ("", 0, Mount::OnFlange));
    assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session));
}

#[test]
fn plate_and_sequence_sessions_are_read_and_kept() {
    let plate = VALID
        .replace(
            "\"ball_in_base_mm\": [0, 0, 0]",
            "\"base_from_plate\": { \"translation_mm\": [1, 2, 3], \"quaternion_wxyz\": [0.8, 0, 0, 0.6] }",
        )
        .replace("\"kind\": \"ball\", \"radius_mm\": 15.0", "\"kind\": \"right-angle-plate\"")
        .replace("\"side\": \"+\"", "\"edge\": \"q\"")
        .replace(
            "{ \"captures\": [\n        { \"base_from_flange\": { \"translation_mm\": [7",
            "{ \"edge\": \"p\", \"captures\": [\n        { \"base_from_flange\": { \"translation_mm\": [7",
        );
    let session = parse(plate.as_bytes(), "plate.json").expect("valid");
    assert_eq!(session.stations[0].edge, Some(Edge::Q));
    let truth = session.truth.as_ref().expect("there is one");
    assert_eq!(truth.target_in_base_mm, Vec3::new(1.0, 2.0, 3.0), "the plate's corner");
    assert_eq!(truth.base_from_plate.expect("read").translation.vector, truth.target_in_base_mm);
    assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session));
    let sequence = r#"{"format": "handeye-session", "version": 1, "target": {"kind": "rgbd"},
        "sequence": "desk/run 1", "truth": {"their": 1}}"#;
    let session = parse(sequence.as_bytes(), "rgbd.json").expect("valid");
    assert_eq!(session.target, Target::Rgbd { sequence: "desk/run 1".to_owned() });
    assert_eq!(session.truth, None, "another program's truth is not ours to read");
    assert!(to_json(&session).contains("\"truth\""), "but it is kept");
    assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session));
    let pose = |x: u32| format!(r#"{{"translation_mm": [{x}, 2, 3], "quaternion_wxyz": [1, 0, 0, 0]}}"#);
    let of_robot = format!(r#"{{"flange_from_sensor": {}, "base_from_world": {}, "late_s": 0.5}}"#, pose(1), pose(9));
    let session = parse(sequence.replace(r#"{"their": 1}"#, &of_robot).as_bytes(), "rgbd.json").expect("valid");
    let truth = session.truth.as_ref().expect("there is one");
    assert_eq!(truth.flange_from_sensor.translation_mm(), Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(truth.base_from_target.expect("read").translation.vector, Vec3::new(9.0, 2.0, 3.0));
    assert!(truth.unknown.contains_key("late_s"));
    assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session));
}

#[test]
fn a_fixed_sensors_truth_has_the_names_of_its_frames_and_either_is_read() {
    let on_flange_names = VALID.replace("\"mount\": \"on-flange\"", "\"mount\": \"fixed\"");
    let fixed_names = on_flange_names
        .replace("flange_from_sensor", "base_from_sensor")
        .replace("\"ball_in_base_mm\": [0", "\"ball_in_flange_mm\": [0");
    let session = parse(fixed_names.as_bytes(), "fixed.json").expect("valid");
    assert_eq!(parse(on_flange_names.as_bytes(), "fixed.json").as_ref(), Ok(&session));
    let saved = to_json(&session);
    assert!(saved.contains("\"base_from_sensor\"") && saved.contains("\"ball_in_flange_mm\""), "{saved}");
    let of_point =
        TARGETS.replace("\"stations\": [],\n  \"further\"", "\"mount\": \"fixed\", \"stations\": [], \"further\"");
    let session = parse(of_point.as_bytes(), "fixed.json").expect("valid");
    assert!(to_json(&session).contains("\"point_in_flange_mm\": [401, -20, 61]"));
    assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session));
}

#[test]
fn unknown_fields_survive_at_every_level() {
    let mut json = VALID.to_owned();
    let objects = [
        "\"format\": ",
        "\"model\": \"FANUC\"",
        "\"orientation\": \"quat",
        "\"translation_mm\": [-4",
        "\"model\": \"Keyence\"",
        "\"kind\": ",
        "\"label\": ",
        "\"base_from_flange\": { \"translation_mm\": [1, 2, 4]",
        "\"translation_mm\": [1, 2, 3]",
        "\"euler_deg\": [106",
        "\"x_mm\": [-1",
        "\"caption\": ",
        "\"flange_from_sensor\": ",
        "\"translation_mm\": [0",
    ];
    for (idx, object) in objects.iter().enumerate() {
        assert_eq!(json.matches(object).count(), 1, "{object}");
        json = json.replacen(
            object,
            &format!("\"their {idx}\": {{\"id\": 12345678901234567890, \"list\": [{idx}, null, [\"x\"]]}}, {object}"),
            1,
        );
    }
    let session = parse(json.as_bytes(), "theirs.json").expect("valid");
    let saved = to_json(&session);
    for idx in 0..objects.len() {
        let field = format!("\"their {idx}\": {{\"id\":12345678901234567890,\"list\":[{idx},null,[\"x\"]]}}");
        assert_eq!(saved.matches(&field).count(), 1, "{field} in {saved}");
    }
    assert_eq!(parse(saved.as_bytes(), "again.json"), Ok(session));
}

#[test]
fn the_text_is_stable_and_readable() {
    let saved = to_json(&valid());
    for line in [
        "  \"robot\": { \"model\": \"FANUC\", \"pose_convention\": \"fanuc-wpr\", \
         \"pose_notation\": { \"orientation\": \"quaternion-xyzw\", \"angle_unit\": \"rad\", \"length_unit\": \"m\", \
         \"flange_from_tcp\": { \"translation_mm\": [-4, 0, 120.5], \"quaternion_wxyz\": [0.8, 0, 0, 0.6] }, \"inverse\": true }, \
         \"position_std_mm\": 0.02, \"orientation_std_deg\": 0.005 },",
        "  \"target\": { \"kind\": \"ball\", \"radius_mm\": 15 },",
        "    { \"label\": \"first\", \"enabled\": false, \"side\": \"+\",",
        "      \"captures\": [",
        "            \"z_mm\": [0.25, null]",
        "        { \"base_from_flange\": { \"translation_mm\": [1, 2, 4], \"quaternion_wxyz\": [0.6, 0.8, 0, 0], \
         \"written\": { \"euler_deg\": [106.26020470831196, 0, 0], \"convention\": \"staubli-rxryrz\" } }, \
         \"step\": -0.5, \"point_mm\": [4, 5, 6] }",
    ] {
        assert!(saved.lines().any(|found| found == line), "{line:?} is no line of\n{saved}");
    }
    assert_eq!(to_json(&parse(saved.as_bytes(), "again.json").expect("valid")), saved);
    let mut usual = valid();
    usual.robot.notation = PoseNotation::of(usual.robot.notation.convention);
    assert!(!to_json(&usual).contains("pose_notation"), "what is usual is not written");
}

#[test]
fn a_rounded_quaternion_is_normalised_and_only_a_badly_rounded_one_is_noted() {
    let with_quaternion = |quaternion: &str| {
        let json = VALID.replacen("[0.6, 0.8, 0, 0]", quaternion, 1);
        parse_with_notes(json.as_bytes(), "rounded.json").expect("valid")
    };
    let rounded = with_quaternion("[-0.6000001, -0.8, 0, 0]");
    assert_eq!(rounded.notes, []);
    let quaternion = rounded.session.stations[0].captures[0].base_from_flange.quaternion_wxyz();
    assert!((quaternion.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-15 && quaternion[0] > 0.0);
    let noted = with_quaternion("[0.6004, 0.8, 0, 0]");
    let [check::Finding::QuaternionsNormalised { num_poses: 1, worst_path, .. }] = noted.notes.as_slice() else {
        panic!("{:?}", noted.notes);
    };
    assert_eq!(worst_path, "stations[0].captures[0].base_from_flange.quaternion_wxyz");
}

#[test]
fn saving_and_opening_gives_the_same_session_through_unknown_permissions_and_links() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cell 3.json");
    save(&valid(), &path).expect("saved");
    assert_eq!(load(&path), Ok(valid()));
    let other = Session { name: "other".to_owned(), ..valid() };
    #[cfg(unix)]
    let path = {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("set");
        let link = folder.path().join("link.json");
        std::os::unix::fs::symlink(&path, &link).expect("linked");
        save(&other, &link).expect("saved");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        assert_eq!(fs::metadata(&path).expect("there").permissions().mode() & 0o777, 0o640);
        path
    };
    #[cfg(not(unix))]
    save(&other, &path).expect("saved");
    assert_eq!(load_with_notes(&path).map(|loaded| loaded.session), Ok(other));
    let leftovers = fs::read_dir(folder.path())
        .expect("listed")
        .flatten()
        .any(|entry| entry.file_name().to_string_lossy().ends_with(".tmp"));
    assert!(!leftovers);
}

#[test]
fn a_failed_save_leaves_the_old_file_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cell.json");
    save(&valid(), &path).expect("saved");
    let before = fs::read(&path).expect("there");
    let mut broken = valid();
    broken.stations[0].captures[0].base_from_flange =
        Transform::from_parts(Vec3::new(f64::NAN, 0.0, 0.0), so3::exp(Vec3::zeros()));
    let refusal = save(&broken, &path).expect_err("could not be opened again");
    assert!(matches!(refusal, SessionError::WouldNotReadBack { .. }), "{refusal}");
    assert!(refusal.to_string().contains("stations[0].captures[0].base_from_flange.translation_mm[0]: found null"));
    assert_eq!(fs::read(&path).expect("there"), before);

    let in_the_way = folder.path().join("folder.json");
    fs::create_dir(&in_the_way).expect("made");
    for target in [in_the_way.clone(), folder.path().join("missing").join("cell.json"), path.join("cell.json")] {
        let refusal = save(&valid(), &target).expect_err("cannot be written");
        assert!(matches!(refusal, SessionError::Unwritable { .. }), "{refusal}");
        assert!(refusal.to_string().contains("cannot save") && !refusal.to_string().contains('\n'), "{refusal}");
    }
    assert_eq!(fs::read_dir(folder.path()).expect("listed").count(), 2, "nothing is left behind");
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let refusal = load(folder.path()).expect_err("a folder").to_string();
    assert!(refusal.contains("found a folder, expected a session file"), "{refusal}");
    let refusal = load(&folder.path().join("none.json")).expect_err("missing").to_string();
    assert!(refusal.starts_with("cannot read ") && refusal.contains("none.json"), "{refusal}");
    let huge = folder.path().join("huge.json");
    fs::File::create(&huge).expect("made").set_len(600 << 20).expect("sparse");
    let refusal = load(&huge).expect_err("huge").to_string();
    assert!(refusal.contains("found 629145600 bytes, expected a session of at most 536870912"), "{refusal}");
}
