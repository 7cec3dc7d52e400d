//! A TCP connection with deadlines: every wait ends, messages are read by length, a closed connection is an error.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::time::{Duration, Instant};

use super::error::DeviceError;
use super::setup::Endpoint;

/// What is left until a deadline, at least this: a timeout of zero means none to the system.
const LEAST_WAIT: Duration = Duration::from_millis(1);
/// Bytes that are taken from the system at once.
const CHUNK: usize = 4096;

/// A connection to one port of a device.
#[derive(Debug)]
pub struct Wire {
    device: &'static str,
    stream: TcpStream,
    /// What has arrived and was not asked for yet.
    received: Vec<u8>,
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
        let found =
            (endpoint.host.as_str(), endpoint.port).to_socket_addrs().map_err(|error| failed(error.to_string()))?;
        let mut reason = "the name has no address".to_owned();
        for socket_address in found {
            match TcpStream::connect_timeout(&socket_address, left_until(deadline)) {
                Ok(stream) => {
                    // Requests are small and wait for their answer; to hold them back only costs time.
                    stream.set_nodelay(true).map_err(|error| failed(error.to_string()))?;
                    return Ok(Self { device, stream, received: Vec::new() });
                }
                Err(error) => reason = error.to_string(),
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
        let start = Instant::now();
        loop {
            if let Some(len) = complete(&self.received)? {
                let rest = self.received.split_off(len.min(self.received.len()));
                return Ok(std::mem::replace(&mut self.received, rest));
            }
            if Instant::now() >= deadline {
                return Err(self.timeout(request, start));
            }
            self.read_more(request, left_until(deadline))?;
        }
    }

    /// Takes what has arrived, without waiting for more than `patience`.
    ///
    /// # Errors
    /// [`DeviceError::Closed`].
    pub fn take_arrived(&mut self, request: &str, patience: Duration) -> Result<Vec<u8>, DeviceError> {
        self.read_more(request, patience.max(LEAST_WAIT))?;
        Ok(std::mem::take(&mut self.received))
    }

    /// Reads once; nothing within `patience` is no error.
    fn read_more(&mut self, request: &str, patience: Duration) -> Result<(), DeviceError> {
        let mut chunk = [0; CHUNK];
        let read = self.stream.set_read_timeout(Some(patience)).and_then(|()| self.stream.read(&mut chunk));
        match read {
            Ok(0) => Err(self.closed(request)),
            Ok(num) => {
                self.received.extend_from_slice(&chunk[..num]);
                Ok(())
            }
            Err(error) if is_no_news(error.kind()) => Ok(()),
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

fn left_until(deadline: Instant) -> Duration {
    deadline.saturating_duration_since(Instant::now()).max(LEAST_WAIT)
}

fn is_no_news(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
