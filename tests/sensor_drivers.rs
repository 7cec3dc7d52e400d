//! Profiler drivers against servers of the test on loopback: good ones, broken ones, and bytes of all kinds.
#![expect(clippy::expect_used, reason = "a test that cannot set itself up must fail")]

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use handeye::device::bridge::messages as bridge;
use handeye::device::sensor::connect;
use handeye::device::sensor::ljv::messages::{
    ProfileReply, ProfileRequest, RawProfile, Reply, Request, SettingRequest, VERSION_LJX, code, command,
};
use handeye::device::sensor::ljv::packing::NO_PEAK;
use handeye::device::{DeviceError, Endpoint, SensorDriver, SensorKind, SensorSetup};
use peak_alloc::PeakAlloc;
use rand_core::{RngCore as _, SeedableRng as _};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// For answers that come: no machine is so slow.
const NO_HURRY: Duration = Duration::from_secs(30);
/// For answers that never come.
const IMPATIENT: Duration = Duration::from_millis(60);

/// What a server does with a request.
enum Act {
    Send(Vec<u8>),
    /// One byte a segment.
    Dribble(Vec<u8>),
    /// Sends, then closes.
    Hang(Vec<u8>),
    /// Says nothing, and keeps the connection.
    Silence,
}

/// A server on a free port; `len_in` says how many bytes make a request.
fn serve(
    len_in: fn(&[u8]) -> Option<usize>,
    mut act: impl FnMut(&[u8]) -> Act + Send + 'static,
) -> (Endpoint, Arc<AtomicUsize>) {
    let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a free port");
    let port = listener.local_addr().expect("an address").port();
    let num_connections = Arc::new(AtomicUsize::new(0));
    let counter = Arc::clone(&num_connections);
    thread::spawn(move || {
        for stream in listener.incoming() {
            counter.fetch_add(1, Ordering::SeqCst);
            let mut stream = stream.expect("a connection");
            stream.set_nodelay(true).expect("set");
            // A client that is gone ends its connection, not the server.
            while let Some(request) = take_request(&mut stream, len_in) {
                let is_over = match act(&request) {
                    Act::Send(bytes) => stream.write_all(&bytes).is_err(),
                    Act::Dribble(bytes) => bytes.iter().any(|byte| stream.write_all(&[*byte]).is_err()),
                    Act::Hang(bytes) => {
                        stream.write_all(&bytes).ok();
                        true
                    }
                    Act::Silence => false,
                };
                if is_over {
                    break;
                }
            }
        }
    });
    (Endpoint { host: "127.0.0.1".to_owned(), port }, num_connections)
}

fn take_request(stream: &mut TcpStream, len_in: fn(&[u8]) -> Option<usize>) -> Option<Vec<u8>> {
    let mut received = Vec::new();
    let mut byte = [0];
    loop {
        if let Some(len) = len_in(&received) {
            received.truncate(len);
            return Some(received);
        }
        if stream.read(&mut byte).ok()? == 0 {
            return None;
        }
        received.push(byte[0]);
    }
}

fn setup(kind: SensorKind, endpoint: Endpoint) -> SensorSetup {
    SensorSetup { kind, endpoint, folder: PathBuf::new(), is_z_inverted: false }
}

fn soon() -> Instant {
    Instant::now() + NO_HURRY
}

fn profiles(counts: &[u32]) -> ProfileReply {
    let profile = |count: u32| RawProfile {
        trigger_count: count,
        ranges: (0..800).map(|idx| if idx < 10 { NO_PEAK } else { idx * 20 }).collect(),
        ..RawProfile::default()
    };
    ProfileReply {
        num_points: 800,
        range_unit: 50,
        first_x: -800_000,
        x_pitch: 2000,
        profiles: counts.iter().map(|count| profile(*count)).collect(),
        ..ProfileReply::default()
    }
}

/// What a good controller answers: the trigger count grows with each profile.
fn good_reply(request: &Request, count: &mut u32) -> Vec<u8> {
    let data = match request.command {
        command::GET_PROFILE => {
            let wanted = ProfileRequest::parse(&request.data).expect("a request for profiles");
            let counts: Vec<u32> = (0..wanted.count).map(|_| *count).collect();
            *count = count.wrapping_add(u32::from(wanted.count));
            profiles(&counts).encode()
        }
        command::GET_SETTING => vec![0],
        _ => Vec::new(),
    };
    Reply::new(request.command, 0, data).encode()
}

fn request_len(bytes: &[u8]) -> Option<usize> {
    Request::len_in(bytes).expect("a request of ours")
}

/// A controller that answers the questions of connecting well, and then as `act` says.
fn controller(mut act: impl FnMut(&Request, Vec<u8>) -> Act + Send + 'static) -> (Endpoint, Arc<AtomicUsize>) {
    let mut count = u32::MAX;
    let mut num_requests = 0;
    serve(request_len, move |bytes| {
        let request = Request::parse(bytes).expect("a request of ours");
        let good = good_reply(&request, &mut count);
        num_requests += 1;
        if num_requests <= 2 { Act::Send(good) } else { act(&request, good) }
    })
}

fn connect_ljv(endpoint: Endpoint) -> Box<dyn SensorDriver> {
    connect(&setup(SensorKind::KeyenceLjv, endpoint), soon()).expect("connected")
}

#[test]
fn profiles_come_over_one_connection_with_growing_counts() {
    let (endpoint, num_connections) = controller(|_, good| Act::Send(good));
    let mut driver = connect_ljv(endpoint);
    for expected in [u32::MAX, 0, 1] {
        let reading = driver.newest(soon()).expect("no error").expect("a profile");
        assert_eq!(reading.trigger_count, expected);
        assert_eq!(reading.profile.len(), 800);
        assert!(reading.profile.z_mm()[9].is_nan());
        // 10 · 20 · 50 · 0.01 µm, and −8 mm + 10 · 20 µm.
        assert!((reading.profile.z_mm()[10] - 0.1).abs() < 1e-12);
        assert!((reading.profile.x_mm()[10] + 7.8).abs() < 1e-12);
        driver.forget(soon()).expect("forgotten");
    }
    assert_eq!(num_connections.load(Ordering::SeqCst), 1);
}

#[test]
fn z_is_turned_about_where_it_is_asked_for() {
    let (endpoint, _) = controller(|_, good| Act::Send(good));
    let setup = SensorSetup { is_z_inverted: true, ..setup(SensorKind::KeyenceLjv, endpoint) };
    let mut driver = connect(&setup, soon()).expect("connected");
    let reading = driver.newest(soon()).expect("no error").expect("a profile");
    assert!((reading.profile.z_mm()[10] + 0.1).abs() < 1e-12);
}

#[test]
fn replies_in_single_bytes_are_put_together() {
    let (endpoint, _) = controller(|_, good| Act::Dribble(good));
    let mut driver = connect_ljv(endpoint);
    for _ in 0..3 {
        assert_eq!(driver.newest(soon()).expect("no error").expect("a profile").profile.len(), 800);
    }
}

#[test]
fn a_controller_without_a_new_profile_leaves_the_last_with_its_count() {
    let mut num_asked = 0;
    let (endpoint, _) = controller(move |request, good| {
        num_asked += usize::from(request.command == command::GET_PROFILE);
        let is_none = request.command == command::GET_PROFILE && num_asked != 2;
        let none = Reply::new(command::GET_PROFILE, 0, profiles(&[]).encode()).encode();
        Act::Send(if is_none { none } else { good })
    });
    let mut driver = connect_ljv(endpoint);
    assert_eq!(driver.newest(soon()), Ok(None));
    let first = driver.newest(soon()).expect("no error").expect("a profile");
    assert_eq!(driver.newest(soon()), Ok(Some(first)));
    driver.forget(soon()).expect("forgotten");
    assert_eq!(driver.newest(soon()), Ok(None));
}

#[test]
fn an_external_trigger_is_given_from_here() {
    let (sender, commands) = std::sync::mpsc::channel();
    let mut count = 7;
    let (endpoint, _) = serve(request_len, move |bytes| {
        let request = Request::parse(bytes).expect("a request of ours");
        sender.send(request.command).expect("heard");
        if request.command == command::GET_SETTING {
            assert_eq!(SettingRequest::parse(&request.data), Some(SettingRequest::trigger_mode(0)));
            return Act::Send(Reply::new(request.command, 0, vec![SettingRequest::EXTERNAL_TRIGGER]).encode());
        }
        Act::Send(good_reply(&request, &mut count))
    });
    let mut driver = connect_ljv(endpoint);
    driver.newest(soon()).expect("no error").expect("a profile");
    driver.forget(soon()).expect("forgotten");
    let heard: Vec<u8> = commands.try_iter().collect();
    let expected = [
        command::GET_PROFILE,
        command::GET_SETTING,
        command::SOFTWARE_TRIGGER,
        command::GET_PROFILE,
        command::CLEAR_MEMORY,
    ];
    assert_eq!(heard, expected);
}

#[test]
fn a_controller_that_does_not_tell_its_trigger_runs_continuously() {
    let mut count = 7;
    let (endpoint, _) = serve(request_len, move |bytes| {
        let request = Request::parse(bytes).expect("a request of ours");
        if request.command == command::GET_SETTING {
            return Act::Send(Reply::refusal(request.command, 0, code::UNDEFINED_COMMAND).encode());
        }
        assert_ne!(request.command, command::SOFTWARE_TRIGGER);
        Act::Send(good_reply(&request, &mut count))
    });
    assert!(connect_ljv(endpoint).newest(soon()).expect("no error").is_some());
}

#[test]
fn a_controller_in_another_mode_is_told_on_connecting() {
    let (endpoint, _) = serve(request_len, |bytes| {
        let request = Request::parse(bytes).expect("a request of ours");
        Act::Send(Reply::refusal(request.command, 0, code::STATUS).encode())
    });
    let error = connect(&setup(SensorKind::KeyenceLjv, endpoint), soon()).map(|_| ()).expect_err("refused");
    assert!(matches!(error, DeviceError::Refused { .. }));
    assert!(error.to_string().contains("advanced mode or batch mode is on"), "{error}");
}

#[test]
fn nobody_at_the_address_is_told_with_a_remedy() {
    for kind in [SensorKind::KeyenceLjv, SensorKind::Bridge] {
        let free = TcpListener::bind(("127.0.0.1", 0)).expect("a free port").local_addr().expect("an address").port();
        let endpoint = Endpoint { host: "127.0.0.1".to_owned(), port: free };
        let error = connect(&setup(kind, endpoint), soon()).map(|_| ()).expect_err("nobody");
        assert!(matches!(error, DeviceError::NotConnected { .. }), "{error}");
        assert!(error.to_string().contains(&free.to_string()), "{error}");
    }
}

/// Asks once with what the server does to the first reply after connecting.
fn newest_after(act: impl FnMut(&Request, Vec<u8>) -> Act + Send + 'static, patience: Duration) -> DeviceError {
    let (endpoint, _) = controller(act);
    connect_ljv(endpoint).newest(Instant::now() + patience).expect_err("a broken reply")
}

fn patched(mut bytes: Vec<u8>, at: usize, patch: &[u8]) -> Vec<u8> {
    bytes[at..at + patch.len()].copy_from_slice(patch);
    bytes
}

#[track_caller]
fn check_unexpected(act: impl FnMut(&Request, Vec<u8>) -> Act + Send + 'static, words: &[&str]) {
    let error = newest_after(act, NO_HURRY);
    assert!(matches!(error, DeviceError::Unexpected { .. }), "{error}");
    for word in words {
        assert!(error.to_string().contains(word), "\"{error}\" does not say \"{word}\"");
    }
}

#[test]
fn a_connection_that_closes_is_an_error() {
    for len in [0, 3, 30, 2091] {
        let error = newest_after(move |_, good| Act::Hang(good[..len].to_vec()), NO_HURRY);
        assert!(matches!(error, DeviceError::Closed { .. }), "{error}");
    }
}

#[test]
fn silence_ends_at_the_deadline() {
    for len in [0, 3, 30, 2091] {
        let act = move |_: &Request, good: Vec<u8>| {
            if len == 0 { Act::Silence } else { Act::Send(good[..len].to_vec()) }
        };
        let start = Instant::now();
        let error = newest_after(act, IMPATIENT);
        assert!(matches!(error, DeviceError::Timeout { .. }), "{error}");
        assert!(start.elapsed() < NO_HURRY);
    }
}

#[test]
fn what_is_no_reply_is_an_error_at_once_and_takes_no_memory() {
    check_unexpected(|_, _| Act::Send(b"HTTP/1.1 400 Bad Request\r\n\r\n".to_vec()), &["1347703880 bytes", "24691"]);
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    check_unexpected(|_, good| Act::Send(patched(good, 0, &[0xff; 4])), &["4294967295 bytes"]);
    check_unexpected(|_, good| Act::Send(patched(good, 12, &[0xff; 4])), &["a body of 4294967295"]);
    // Other tests run beside this one; none of them needs a hundredth of the announced length.
    assert!(MEMORY.peak_usage() < before + (40 << 20));
    check_unexpected(|_, good| Act::Send(patched(good, 6, &[0xf0, 0])), &["direction 0x00F0"]);
    check_unexpected(|_, good| Act::Send(patched(good, 16, &[0x39])), &["change program (0x39)", "get profile (0x42)"]);
    check_unexpected(|_, good| Act::Send(patched(good, 4, &VERSION_LJX.to_le_bytes())), &["LJ-X8000"]);
    check_unexpected(
        |_, good| Act::Send(patched(good, 40, &[2])),
        &["found 2064 bytes", "4092 bytes, those of 2 profiles"],
    );
    check_unexpected(|_, good| Act::Send(patched(good, 54, &[0, 0])), &["none of them 0"]);
    let two_heads = |_: &Request, _: Vec<u8>| {
        let mut data = profiles(&[1]).encode();
        let second = data[24..].to_vec();
        data.extend(second);
        Act::Send(Reply::new(command::GET_PROFILE, 0, data).encode())
    };
    check_unexpected(two_heads, &["two heads", "unplug"]);
}

#[test]
fn refusals_leave_the_connection_good() {
    let mut num_asked = 0;
    let (endpoint, num_connections) = controller(move |request, good| {
        num_asked += 1;
        Act::Send(if num_asked == 1 { Reply::refusal(request.command, 0, code::STATUS).encode() } else { good })
    });
    let mut driver = connect_ljv(endpoint);
    let error = driver.newest(soon()).expect_err("refused");
    assert!(
        matches!(error, DeviceError::Refused { .. }) && error.to_string().contains("batch measurement off"),
        "{error}"
    );
    assert!(driver.newest(soon()).expect("no error").is_some());
    assert_eq!(num_connections.load(Ordering::SeqCst), 1);
}

#[test]
fn damaged_messages_never_panic_and_take_no_memory() {
    /// What 4 MiB of packed ranges become, several times over.
    const MOST_BYTES: usize = 64 << 20;
    let goldens = [
        Reply::new(command::GET_PROFILE, 0, profiles(&[5, 6]).encode()).encode(),
        Reply::new(command::GET_PROFILE, 0, profiles(&[]).encode()).encode(),
        Reply::refusal(command::GET_PROFILE, 0, code::STATUS).encode(),
        Request::new(command::GET_PROFILE, ProfileRequest::NEWEST.encode()).encode(),
        Request::new(command::GET_SETTING, SettingRequest::trigger_mode(0).encode()).encode(),
    ];
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(24691);
    let mut next = |below: usize| random.next_u32() as usize % below;
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    for idx in 0..20_000 {
        let mut bytes = goldens[idx % goldens.len()].clone();
        for _ in 0..next(6) {
            let at = next(bytes.len().clamp(1, 80));
            match next(4) {
                0 => bytes.truncate(at),
                1 => bytes.insert(at.min(bytes.len()), u8::try_from(next(256)).unwrap()),
                _ if !bytes.is_empty() => {
                    let at = at.min(bytes.len() - 1);
                    bytes[at] = [0, 1, 0x7f, 0x80, 0xff, u8::try_from(next(256)).unwrap()][next(6)];
                }
                _ => {}
            }
        }
        let _ = Request::len_in(&bytes);
        if let Ok(request) = Request::parse(&bytes) {
            let _ = (ProfileRequest::parse(&request.data), SettingRequest::parse(&request.data));
        }
        if let Ok(Some(len)) = Reply::len_in(&bytes, command::GET_PROFILE) {
            assert!(len <= bytes.len());
        }
        let data = Reply::parse(&bytes, command::GET_PROFILE).map_or(bytes, |reply| reply.data);
        if let Ok(reply) = ProfileReply::parse(&data) {
            for raw in &reply.profiles {
                let _ = reply.in_mm(raw, idx % 2 == 0);
            }
        }
    }
    assert!(MEMORY.peak_usage() < before + MOST_BYTES);
}

#[test]
fn a_file_saved_into_a_watched_folder_becomes_the_newest_profile() {
    let folder = tempfile::TempDir::new().expect("a folder");
    std::fs::write(folder.path().join("old.csv"), "x,z\n0,1\n").expect("written");
    let nowhere = Endpoint { host: String::new(), port: 0 };
    let setup = SensorSetup { folder: folder.path().to_owned(), ..setup(SensorKind::Folder, nowhere) };
    let mut driver = connect(&setup, soon()).expect("connected");
    assert_eq!(driver.newest(soon()), Ok(None));
    std::fs::write(folder.path().join("new.csv"), "x [mm];z [mm]\n-0,5;2,25\n0,5;\n").expect("written");
    let deadline = soon();
    let reading = loop {
        if let Some(reading) = driver.newest(deadline).expect("no error") {
            break reading;
        }
        assert!(Instant::now() < deadline, "the file was not picked up");
        thread::sleep(Duration::from_millis(5));
    };
    assert_eq!((reading.trigger_count, reading.profile.x_mm()), (1, [-0.5, 0.5].as_slice()));
    driver.forget(soon()).expect("forgotten");
    assert_eq!(driver.newest(soon()), Ok(None));
}

fn line_len(bytes: &[u8]) -> Option<usize> {
    bridge::line_len(bytes).expect("a line of ours")
}

fn bridge_server(mut answer: impl FnMut(&bridge::Ask) -> bridge::Answer + Send + 'static) -> Endpoint {
    let server = serve(line_len, move |line| {
        let request = bridge::parse_request(line).expect("a request of ours");
        let hello = bridge::Hello {
            device: bridge::BridgedDevice::Profiler,
            name: "test".to_owned(),
            can_move: false,
            resolution_mm: 0.0,
            tool: String::new(),
            convention: None,
        };
        let answer = match request.ask {
            bridge::Ask::Hello { .. } => bridge::Answer::Hello(hello),
            ask => answer(&ask),
        };
        let reply = bridge::Reply { bridge: bridge::VERSION, id: request.id, answer };
        Act::Dribble(bridge::encode_line(&reply).expect("a line").into_bytes())
    });
    server.0
}

#[test]
fn a_bridge_gives_profiles_and_forgets() {
    let mut count = 0;
    let endpoint = bridge_server(move |ask| {
        count += 1;
        match (ask, count) {
            (bridge::Ask::Forget, _) => bridge::Answer::Accepted,
            (_, 1) => bridge::Answer::NoProfile,
            _ => bridge::Answer::Profile(bridge::BridgeProfile {
                trigger_count: count,
                x_mm: vec![0.0, 0.5],
                z_mm: vec![Some(2.5), None],
            }),
        }
    });
    let setup = SensorSetup { is_z_inverted: true, ..setup(SensorKind::Bridge, endpoint) };
    let mut driver = connect(&setup, soon()).expect("connected");
    assert_eq!(driver.newest(soon()), Ok(None));
    let reading = driver.newest(soon()).expect("no error").expect("a profile");
    assert_eq!((reading.trigger_count, reading.profile.x_mm()), (2, [0.0, 0.5].as_slice()));
    assert!((reading.profile.z_mm()[0] + 2.5).abs() < 1e-12 && reading.profile.z_mm()[1].is_nan());
    driver.forget(soon()).expect("forgotten");
}

#[test]
fn a_bridge_with_a_broken_profile_or_another_answer_is_told() {
    let broken = |z_mm: Vec<Option<f64>>| {
        let profile = bridge::BridgeProfile { trigger_count: 1, x_mm: vec![0.0], z_mm };
        let endpoint = bridge_server(move |_| bridge::Answer::Profile(profile.clone()));
        let mut driver = connect(&setup(SensorKind::Bridge, endpoint), soon()).expect("connected");
        (driver.newest(soon()).expect_err("broken"), driver.forget(soon()).expect_err("no answer to that"))
    };
    for z_mm in [vec![], vec![Some(1e9)]] {
        let (newest, forget) = broken(z_mm);
        assert!(matches!(newest, DeviceError::Unexpected { .. }), "{newest}");
        assert!(matches!(forget, DeviceError::Unexpected { .. }), "{forget}");
    }
}
