//! The connection itself.

use std::io::Write as _;
use std::net::TcpListener;
use std::sync::mpsc;
use std::thread;
use std::time::Instant;

use handeye::device::wire::Wire;
use handeye::device::{DeviceError, Endpoint};

use super::fake::{Act, expect_timeout, listen, serve, soon};

const DEVICE: &str = "Test";

/// Connects to a server that performs this and then says nothing more.
fn connect_to(act: Act) -> Wire {
    let (mut listeners, endpoint) = listen(&[0]);
    serve(listeners.remove(0), act, |_| None, |_| Act::Silence);
    Wire::connect(DEVICE, &endpoint, soon(), "").expect("it listens")
}

/// A byte that says how many follow.
#[expect(clippy::unnecessary_wraps, reason = "the shape that Wire asks for")]
fn counted(bytes: &[u8]) -> Result<Option<usize>, DeviceError> {
    Ok(bytes.first().map(|len| 1 + usize::from(*len)).filter(|len| bytes.len() >= *len))
}

#[test]
fn messages_are_cut_by_length_however_they_arrive() {
    let two = b"\x03abc\x00\x02de".to_vec();
    for act in [Act::Send(two.clone()), Act::Dribble(two.clone()), Act::SendAndClose(two)] {
        let mut wire = connect_to(act);
        for expected in [&b"\x03abc"[..], b"\x00", b"\x02de"] {
            assert_eq!(wire.receive("a message", soon(), counted).as_deref(), Ok(expected));
        }
    }
}

#[test]
fn a_message_that_is_cut_by_the_end_is_an_error() {
    for cut in [&b""[..], b"\x03", b"\x03ab"] {
        let mut wire = connect_to(Act::SendAndClose(cut.to_vec()));
        let closed = DeviceError::Closed { device: DEVICE, request: "a message".to_owned() };
        assert_eq!(wire.receive("a message", soon(), counted), Err(closed.clone()));
        assert_eq!(wire.receive("a message", soon(), counted), Err(closed));
    }
}

#[test]
fn a_message_may_end_with_the_connection_where_its_protocol_says_so() {
    let mut wire = connect_to(Act::SendAndClose(b"all of it".to_vec()));
    let all = wire.receive_or_end("a page", soon(), |bytes, is_closed| Ok(is_closed.then_some(bytes.len())));
    assert_eq!(all.as_deref(), Ok(&b"all of it"[..]));
}

#[test]
fn silence_ends_at_the_deadline() {
    for act in [Act::Silence, Act::Send(b"\x03ab".to_vec())] {
        let mut wire = connect_to(act);
        expect_timeout(|deadline| wire.receive("a message", deadline, counted));
    }
}

#[test]
fn what_came_before_the_deadline_counts_after_it() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let endpoint = Endpoint { host: "localhost".to_owned(), port: listener.local_addr().expect("bound").port() };
    let (sent, was_sent) = mpsc::channel();
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a client");
        stream.write_all(b"\x03abc").expect("it reads");
        sent.send(stream).expect("it waits");
    });
    let mut wire = Wire::connect(DEVICE, &endpoint, soon(), "").expect("it listens");
    // Loopback delivers at once; the connection stays open as long as the stream does.
    let _stream = was_sent.recv().expect("it sends");
    assert_eq!(wire.receive("a message", Instant::now(), counted).as_deref(), Ok(&b"\x03abc"[..]));
}

#[test]
fn a_device_that_sends_without_end_does_not_fill_the_memory() {
    let mut wire = connect_to(Act::Send(vec![b'x'; 12 * 1024 * 1024]));
    let outcome = wire.receive("a message", soon(), |_| Ok(None));
    assert!(matches!(outcome, Err(DeviceError::Unexpected { .. })), "{outcome:?}");
}

#[test]
fn a_device_that_does_not_read_cannot_hold_up_the_sender() {
    // Nobody accepts: the system takes some, and then no more.
    let (_listeners, endpoint) = listen(&[0]);
    let mut wire = Wire::connect(DEVICE, &endpoint, soon(), "").expect("it listens");
    let bytes = vec![0; 64 * 1024 * 1024];
    expect_timeout(|deadline| wire.send("much", &bytes, deadline));
}

#[test]
fn nobody_there_is_said_with_a_remedy() {
    let (listeners, endpoint) = listen(&[0]);
    drop(listeners);
    let error = Wire::connect(DEVICE, &endpoint, soon(), "switch it on").expect_err("nobody listens");
    let text = error.to_string();
    assert!(text.contains(&format!("127.0.0.1:{}", endpoint.port)) && text.ends_with("switch it on"), "{text}");
}
