//! A TCP connection with deadlines: every wait ends, messages are read by length, a closed connection is an error.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, SocketAddr, TcpStream, ToSocketAddrs as _};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use super::error::{DeviceError, system_words};
use super::setup::Endpoint;

/// What is left until a deadline, at least this: a timeout of zero means none to the system.
const LEAST_WAIT: Duration = Duration::from_millis(1);
/// Bytes that are taken from the system at once.
const CHUNK: usize = 16 * 1024;
/// More than any message of any device: a device that sends on without end must not fill the memory.
const MAX_RECEIVED: usize = 8 * 1024 * 1024;

/// A connection to one port of a device.
#[derive(Debug)]
pub struct Wire {
    device: &'static str,
    stream: TcpStream,
    /// What has arrived and was not asked for yet.
    received: Vec<u8>,
}

/// What one look at the connection showed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Arrival {
    Bytes,
    Nothing,
    End,
}

impl Wire {
    /// Connects; `remedy` says what to do where nobody answers.
    ///
    /// # Errors
    /// [`DeviceError::NotConnected`].
    pub fn connect(
        device: &'static str,
        endpoint: &Endpoint,
        deadline: Instant,
        remedy: &'static str,
    ) -> Result<Self, DeviceError> {
        let address = format!("{}:{}", endpoint.host, endpoint.port);
        let failed = |reason: String| DeviceError::NotConnected { device, address: address.clone(), reason, remedy };
        let mut reason = "the name has no address".to_owned();
        for socket_address in resolve(endpoint, deadline).map_err(failed)? {
            match TcpStream::connect_timeout(&socket_address, left_until(deadline)) {
                Ok(stream) => {
                    // Requests are small and wait for their answer; to hold them back only costs time.
                    stream.set_nodelay(true).map_err(|error| failed(system_words(&error)))?;
                    return Ok(Self { device, stream, received: Vec::new() });
                }
                Err(error) => reason = system_words(&error),
            }
        }
        Err(failed(reason))
    }

    /// Sends all of it.
    ///
    /// # Errors
    /// [`DeviceError::Timeout`], [`DeviceError::Closed`].
    pub fn send(&mut self, request: &str, bytes: &[u8], deadline: Instant) -> Result<(), DeviceError> {
        let start = Instant::now();
        let mut sent = 0;
        while sent < bytes.len() {
            if Instant::now() >= deadline {
                return Err(self.timeout(request, start));
            }
            let written = self
                .stream
                .set_write_timeout(Some(left_until(deadline)))
                .and_then(|()| self.stream.write(&bytes[sent..]));
            match written {
                Ok(0) => return Err(self.closed(request)),
                Ok(num) => sent += num,
                Err(error) if is_no_news(error.kind()) => {}
                Err(_) => return Err(self.closed(request)),
            }
        }
        Ok(())
    }

    /// Waits until `complete` says how many of the bytes that are there make the message, and takes these.
    ///
    /// `complete` sees everything that has arrived: `Ok(None)` asks for more, `Err` gives up.
    ///
    /// # Errors
    /// [`DeviceError::Timeout`], [`DeviceError::Closed`], and what `complete` says.
    pub fn receive(
        &mut self,
        request: &str,
        deadline: Instant,
        mut complete: impl FnMut(&[u8]) -> Result<Option<usize>, DeviceError>,
    ) -> Result<Vec<u8>, DeviceError> {
        self.receive_or_end(request, deadline, |bytes, _| complete(bytes))
    }

    /// The same for messages that may end with the connection: `complete` is also told whether it has ended.
    ///
    /// # Errors
    /// As [`Self::receive`]; [`DeviceError::Closed`] if `complete` asks for more after the end.
    pub fn receive_or_end(
        &mut self,
        request: &str,
        deadline: Instant,
        mut complete: impl FnMut(&[u8], bool) -> Result<Option<usize>, DeviceError>,
    ) -> Result<Vec<u8>, DeviceError> {
        let start = Instant::now();
        let mut arrival = Arrival::Bytes;
        let mut is_over = false;
        loop {
            if arrival != Arrival::Nothing
                && let Some(len) = complete(&self.received, arrival == Arrival::End)?
            {
                let rest = self.received.split_off(len.min(self.received.len()));
                return Ok(std::mem::replace(&mut self.received, rest));
            }
            if arrival == Arrival::End {
                return Err(self.closed(request));
            }
            if is_over {
                return Err(self.timeout(request, start));
            }
            // At the deadline there is one more look, without a wait: what came in time counts.
            is_over = Instant::now() >= deadline;
            arrival = self.read_more(request, (!is_over).then(|| left_until(deadline)))?;
        }
    }

    /// Takes all that has arrived; if that is nothing, waits for `patience` at most.
    ///
    /// # Errors
    /// [`DeviceError::Closed`].
    pub fn take_arrived(&mut self, request: &str, patience: Duration) -> Result<Vec<u8>, DeviceError> {
        let mut patience = (self.received.is_empty() && !patience.is_zero()).then_some(patience);
        loop {
            match self.read_more(request, patience)? {
                Arrival::Bytes if self.received.len() < MAX_RECEIVED / 2 => patience = None,
                Arrival::End if self.received.is_empty() => return Err(self.closed(request)),
                _ => return Ok(std::mem::take(&mut self.received)),
            }
        }
    }

    /// Reads once; without `patience` only what is there.
    fn read_more(&mut self, request: &str, patience: Option<Duration>) -> Result<Arrival, DeviceError> {
        let mut chunk = [0; CHUNK];
        let read = if let Some(patience) = patience {
            self.stream.set_read_timeout(Some(patience.max(LEAST_WAIT))).and_then(|()| self.stream.read(&mut chunk))
        } else {
            let read = self.stream.set_nonblocking(true).and_then(|()| self.stream.read(&mut chunk));
            self.stream.set_nonblocking(false).and(read)
        };
        match read {
            Ok(0) => Ok(Arrival::End),
            Ok(num) if self.received.len() + num > MAX_RECEIVED => Err(DeviceError::Unexpected {
                device: self.device,
                request: request.to_owned(),
                found: format!("more than {MAX_RECEIVED} bytes without an end"),
                expected: "a message of this protocol".to_owned(),
                remedy: "check that the port is the right one",
            }),
            Ok(num) => {
                self.received.extend_from_slice(&chunk[..num]);
                Ok(Arrival::Bytes)
            }
            Err(error) if is_no_news(error.kind()) => Ok(Arrival::Nothing),
            Err(_) => Err(self.closed(request)),
        }
    }

    fn timeout(&self, request: &str, start: Instant) -> DeviceError {
        DeviceError::Timeout { device: self.device, request: request.to_owned(), waited: start.elapsed() }
    }

    fn closed(&self, request: &str) -> DeviceError {
        DeviceError::Closed { device: self.device, request: request.to_owned() }
    }
}

/// Looks the name up. The system's look-up knows no deadline: it gets a thread of its own, which is left behind when it
/// takes too long.
fn resolve(endpoint: &Endpoint, deadline: Instant) -> Result<Vec<SocketAddr>, String> {
    if let Ok(address) = endpoint.host.parse::<IpAddr>() {
        return Ok(vec![SocketAddr::new(address, endpoint.port)]);
    }
    let (sender, receiver) = mpsc::channel();
    let (host, port) = (endpoint.host.clone(), endpoint.port);
    thread::Builder::new()
        .name("look-up".to_owned())
        .spawn(move || {
            let found = (host.as_str(), port).to_socket_addrs().map(Iterator::collect);
            // Nobody waits any more if the deadline has passed.
            let _ = sender.send(found);
        })
        .map_err(|error| error.to_string())?;
    match receiver.recv_timeout(left_until(deadline)) {
        Ok(found) => found.map_err(|error| error.to_string()),
        Err(_) => Err("the name was not found in time".to_owned()),
    }
}

fn left_until(deadline: Instant) -> Duration {
    deadline.saturating_duration_since(Instant::now()).max(LEAST_WAIT)
}

fn is_no_news(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
