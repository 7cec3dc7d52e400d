//! FANUC by its web page.

use std::time::Instant;

use handeye::device::robot::connect;
use handeye::device::robot::curpos::http::{self, Response};
use handeye::device::{DeviceError, Endpoint, MoveState, Readiness, RobotKind, RobotSetup};

use super::fake::{Act, assert_near, expect_error, expect_timeout, linear, listen, pose, serve, soon};

/// As an R-30iA writes it: blank lines, no zero before the point, a second group.
const PAGE: &str = "<HTML>\r\n<BODY><PRE>\r\nF Number: F12345\r\nVERSION : HandlingTool\r\n$VERSION: V7.7027\r\nDATE:  08-MAY-20\r\n\r\nCURRENT ROBOT POSITION::\r\nGroup #:  1\r\n \r\nCURRENT JOINT POSITION:\r\nJoint   1:     86.75\r\nJoint   2:      -.50\r\nJoint   3:    -12.00\r\nJoint   4:       .00\r\nJoint   5:    -78.00\r\nJoint   6:      1.25\r\n\r\nFrame #:  3  Tool #:  7\r\nCURRENT USER FRAME POSITION:\r\nX:      1.00\r\nY:      2.00\r\nZ:      3.00\r\nW:      4.00\r\nP:      5.00\r\nR:      6.00\r\nCFG: N U T, 0, 0, 0\r\n\r\nTool #:  7\r\nCURRENT WORLD POSITION:\r\n\r\nX:    622.47\r\nY:      -.06\r\nZ:   -140.50\r\nW:   -179.99\r\nP:      -.00\r\nR:    -87.46\r\nCFG: N U T, 0, 0, 0\r\n\r\nGroup #:  2\r\nCURRENT WORLD POSITION:\r\nX:      9.00\r\n</PRE></BODY></HTML>\r\n";

fn chunked(page: &str) -> Vec<u8> {
    let mut bytes = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n".to_vec();
    for chunk in page.as_bytes().chunks(100) {
        bytes.extend(format!("{:X};ext=1\r\n", chunk.len()).into_bytes());
        bytes.extend(chunk);
        bytes.extend(b"\r\n");
    }
    bytes.extend(b"0\r\n\r\n");
    bytes
}

fn start(act: Act) -> Endpoint {
    let (mut listeners, endpoint) = listen(&[0]);
    let len_of_request = |bytes: &[u8]| match http::parse_get(bytes) {
        Ok(Some(path)) => {
            assert_eq!(path, "/MD/CURPOS.DG");
            Some(bytes.len())
        }
        _ => None,
    };
    serve(listeners.remove(0), Act::Silence, len_of_request, move |_| act.clone());
    endpoint
}

fn setup(endpoint: Endpoint) -> RobotSetup {
    RobotSetup { kind: RobotKind::FanucPage, endpoint }
}

fn connect_to(act: Act) -> impl FnOnce(Instant) -> Result<(), DeviceError> {
    let endpoint = start(act);
    move |deadline| connect(&setup(endpoint), deadline).map(drop)
}

#[test]
fn the_world_pose_of_the_first_group_is_read_however_the_page_is_sent() {
    let page = Response { status: 200, body: PAGE.as_bytes().to_vec() }.encode();
    let until_close = [b"HTTP/1.0 200 OK\r\n\r\n", PAGE.as_bytes()].concat();
    let bare = [b"HTTP/1.1 200\n\n", PAGE.as_bytes()].concat();
    for act in [
        Act::Send(page.clone()),
        Act::Dribble(page.clone()),
        Act::SendAndClose(page),
        Act::SendAndClose(until_close),
        Act::SendAndClose(bare),
        Act::Send(chunked(PAGE)),
        Act::Dribble(chunked(PAGE)),
    ] {
        let mut robot = connect(&setup(start(act)), soon()).expect("a page");
        let report = robot.report(soon()).expect("a pose");
        assert_near(&report.base_from_flange, &pose([622.47, -0.06, -140.5], [-179.99, 0.0, -87.46]), 1e-9);
        assert_eq!(report.joints_deg, [86.75, -0.5, -12.0, 0.0, -78.0, 1.25]);
        assert_eq!((report.tool.as_str(), report.readiness), ("UTOOL 7 in WORLD", Readiness::ReadOnly));
        assert_eq!((report.is_moving, report.resolution_mm), (None, 0.01));
    }
}

#[test]
fn the_page_cannot_move_the_robot() {
    let page = Response { status: 200, body: PAGE.as_bytes().to_vec() }.encode();
    let mut robot = connect(&setup(start(Act::Send(page))), soon()).expect("a page");
    let sent = robot.start_move(&linear(pose([0.0; 3], [0.0; 3]), 1.0), soon());
    assert!(matches!(sent, Err(DeviceError::CannotMove { .. })));
    assert!(matches!(robot.stop(soon()), Err(DeviceError::CannotMove { .. })));
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Done));
}

#[test]
fn pages_without_a_pose_are_refused_by_name() {
    let is_unexpected = |error: &DeviceError| matches!(error, DeviceError::Unexpected { .. });
    let page = |text: &str| Act::Send(Response { status: 200, body: text.as_bytes().to_vec() }.encode());
    let cases = [
        (String::new(), "Group #: 1"),
        (PAGE.replace("CURRENT WORLD POSITION", "CURRENT OTHER POSITION"), "CURRENT WORLD POSITION"),
        (PAGE.replace("Tool #:  7", "Tool: ?"), "Tool #"),
        (PAGE.replace("Z:   -140.50", "Z:   ********"), "Z: and a number"),
        (PAGE.replace("X:    622.47", "Cartesian position cannot be calculated"), "wrist"),
    ];
    for (text, words) in cases {
        let error = expect_error(connect_to(page(&text)), is_unexpected);
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn broken_servers_end_in_a_named_error_by_the_deadline() {
    let is_unexpected = |error: &DeviceError| matches!(error, DeviceError::Unexpected { .. });
    let is_closed = |error: &DeviceError| matches!(error, DeviceError::Closed { .. });
    let cut = Response { status: 200, body: PAGE.as_bytes().to_vec() }.encode()[..500].to_vec();
    let long = b"HTTP/1.0 200 OK\r\nContent-Length: 999999999999\r\n\r\n".to_vec();
    expect_timeout(connect_to(Act::Silence));
    expect_timeout(connect_to(Act::Send(cut.clone())));
    expect_error(connect_to(Act::SendAndClose(cut)), |error| is_unexpected(error) || is_closed(error));
    expect_error(connect_to(Act::SendAndClose(Vec::new())), |error| is_unexpected(error) || is_closed(error));
    expect_error(connect_to(Act::Send(b"0:success".to_vec())), is_unexpected);
    expect_error(connect_to(Act::Send(long)), is_unexpected);
    let endless = format!("HTTP/1.0 200 OK\r\n\r\n{}", "x".repeat(300_000)).into_bytes();
    expect_error(connect_to(Act::Send(endless)), is_unexpected);
    for (status, words) in [(401, "unlock"), (404, "address"), (500, "browser")] {
        let act = Act::Send(Response { status, body: Vec::new() }.encode());
        let error = expect_error(connect_to(act), |error| matches!(error, DeviceError::Refused { .. }));
        assert!(error.contains(words) && error.contains(&status.to_string()), "{error}");
    }
}
