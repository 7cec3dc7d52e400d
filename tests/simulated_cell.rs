//! The simulated cell, held against raw sockets and against the drivers.
#![expect(clippy::expect_used, reason = "a test that gets no answer must fail")]

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::Duration;

use handeye::device::sim::{SimCell, SimOptions};

/// Far more than anything here takes: only a server that does not answer is told by it.
const PATIENCE: Duration = Duration::from_secs(20);

fn quick() -> SimOptions {
    SimOptions { time_scale: 50.0, ..SimOptions::default() }
}

fn connect(port: u16) -> TcpStream {
    let stream = TcpStream::connect(("127.0.0.1", port)).expect("a server");
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    stream
}

fn ask_until(stream: &mut TcpStream, request: &[u8], end: impl Fn(&[u8]) -> bool) -> Vec<u8> {
    stream.write_all(request).expect("sent");
    let mut answer = Vec::new();
    while !end(&answer) {
        let mut chunk = [0; 4096];
        let num = stream.read(&mut chunk).expect("an answer in time");
        assert!(num > 0, "closed after {answer:?}");
        answer.extend_from_slice(&chunk[..num]);
    }
    answer
}

fn ask_line(stream: &mut TcpStream, line: &str, num: usize) -> String {
    let bytes = ask_until(stream, line.as_bytes(), |answer| answer.len() >= num);
    String::from_utf8(bytes).expect("text")
}

#[test]
fn mappdk_greets_answers_moves_and_refuses() {
    let cell = SimCell::start(&quick()).expect("free ports");
    let mut client = connect(cell.robot_setup.endpoint.port);
    assert_eq!(ask_line(&mut client, "", 9), "0:success");
    assert_eq!(ask_line(&mut client, "ver\n", 15), "1:wrong-command");
    let position = |client: &mut TcpStream| {
        let bytes = ask_until(client, b"curpos\n", |answer| {
            let text = String::from_utf8_lossy(answer);
            text.matches('=').count() == 6 && text.rsplit('.').next().is_some_and(|decimals| decimals.len() == 3)
        });
        String::from_utf8(bytes).expect("text")
    };
    let values = |text: &str| -> Vec<f64> {
        let fields = text.split(',').map(|field| field.split_once('=').expect("a field").1.trim());
        fields.map(|value| value.parse().expect("a number")).collect()
    };
    let before = position(&mut client);
    assert!(before.starts_with("0:x= "), "{before}");
    let mut target = values(&before);
    target[1] += 0.5;
    let fields: String = target.iter().map(|value| format!(":{value:+014.6}")).collect();
    assert_eq!(ask_line(&mut client, &format!("movep:0020:0100:000:1:6{fields}\n"), 9), "0:success");
    let after = values(&position(&mut client));
    for (found, expected) in after.iter().zip(&target) {
        // Half of the last decimal, and the rounding of the target.
        assert!((found - expected).abs() < 0.0011, "{after:?} instead of {target:?}");
    }
    target[0] += 2000.0;
    let fields: String = target.iter().map(|value| format!(":{value:+014.6}")).collect();
    let refusal = "1:position-is-not-reachable";
    assert_eq!(ask_line(&mut client, &format!("movep:0020:0100:000:1:6{fields}\n"), refusal.len()), refusal);
}

#[test]
fn ljv_answers_golden_bytes_and_whole_profiles() {
    let cell = SimCell::start(&quick()).expect("free ports");
    let mut client = connect(cell.sensor_setup.endpoint.port);
    let program = hex("18000000 0100f000 00000000 08000000 39000000 07000000".replacen("18", "14", 1).as_str());
    let reply = ask_until(&mut client, &program, |answer| answer.len() >= 28);
    assert_eq!(reply, hex("18000000 010000f0 00000000 0c000000 39000000 00000000 07000000"));
    // A new connection for one command, with a reply of one profile of 800 points.
    std::thread::sleep(Duration::from_millis(5));
    let mut other = connect(cell.sensor_setup.endpoint.port);
    let golden = hex("20000000 0100f000 00000000 14000000 42000000 00000000 00000000 01000000 01010000");
    let reply = ask_until(&mut other, &golden, |answer| answer.len() >= 2092);
    assert_eq!(reply.len(), 2092);
    assert_eq!(&reply[..4], &2088_u32.to_le_bytes());
    assert_eq!(reply[40], 1);
    let unknown = hex("10000000 0100f000 00000000 04000000 99000000");
    let reply = ask_until(&mut other, &unknown, |answer| answer.len() >= 28);
    assert_eq!((reply.len(), reply[17]), (28, 0x31));
}

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_hexdigit).collect();
    let pair = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).expect("digits"), 16).expect("a byte");
    digits.chunks(2).map(pair).collect()
}

#[test]
fn a_dropped_cell_frees_its_ports() {
    let cell = SimCell::start(&quick()).expect("free ports");
    let ports: Vec<u16> = cell.ports.iter().map(|(port, _)| *port).collect();
    let _client = connect(ports[0]);
    let offset = ports[0] - cell.robot_setup.kind.default_port();
    drop(cell);
    for port in &ports {
        std::net::TcpListener::bind(("127.0.0.1", *port)).expect("the port is free again");
    }
    let _ = offset;
}
