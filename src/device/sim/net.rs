//! How the servers of a cell listen, answer (or fail to, as the faults ask), and end: on loopback only.

use std::io::{Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::scene::Random;

use super::fault::{Delivery, SimDevice};
use super::world::World;

/// Bytes that are taken from the system at once.
const CHUNK: usize = 4096;
/// A client that sends this much without a whole message is none of ours.
const MAX_PENDING: usize = 1 << 16;
/// Connections to one port at the same time.
const MAX_CONNECTIONS: usize = 16;
/// How late a late message is, and how far apart pieces are, ms.
const LATE_MS: u64 = 400;
const PIECES_APART_MS: u64 = 2;
/// Size of a piece, bytes; long messages come in larger ones, so that they come at all.
const PIECE: usize = 7;
const MAX_PIECES: usize = 40;

/// Random stream of garbage.
const GARBAGE_STREAM: u64 = 9;

/// How many clients a port serves at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clients {
    /// One; further ones wait until it goes.
    One,
    /// Several.
    Many,
}

/// What talks to one client until that goes.
pub type Service = fn(&World, &mut Connection);

/// What all threads of a cell share.
#[derive(Debug)]
struct Hub {
    world: World,
    ending: Mutex<Ending>,
    ended: Condvar,
}

#[derive(Debug, Default)]
struct Ending {
    is_over: bool,
    /// Connections, to be shut when it is over.
    open: Vec<(u64, TcpStream)>,
    num_connections: u64,
}

impl Hub {
    fn ending(&self) -> MutexGuard<'_, Ending> {
        self.ending.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The servers of a cell; they end when it is dropped.
#[derive(Debug)]
pub struct Servers {
    hub: Arc<Hub>,
    threads: Vec<(SocketAddr, JoinHandle<()>)>,
}

impl Servers {
    /// None yet.
    #[must_use]
    pub fn new(world: World) -> Self {
        Self { hub: Arc::new(Hub { world, ending: Mutex::default(), ended: Condvar::new() }), threads: Vec::new() }
    }

    /// The world that they serve.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.hub.world
    }

    /// Serves a port from now on.
    ///
    /// # Errors
    /// If the system has no thread left.
    pub fn serve(
        &mut self,
        listener: TcpListener,
        device: SimDevice,
        clients: Clients,
        service: Service,
    ) -> std::io::Result<()> {
        let address = listener.local_addr()?;
        let hub = Arc::clone(&self.hub);
        let thread = thread::Builder::new()
            .name(format!("sim-{}", address.port()))
            .spawn(move || listen(&hub, &listener, device, clients, service))?;
        self.threads.push((address, thread));
        Ok(())
    }
}

impl Drop for Servers {
    fn drop(&mut self) {
        {
            let mut ending = self.hub.ending();
            ending.is_over = true;
            for (_, stream) in ending.open.drain(..) {
                // A connection that is gone already needs no shutting.
                stream.shutdown(Shutdown::Both).ok();
            }
        }
        self.hub.ended.notify_all();
        for (address, thread) in self.threads.drain(..) {
            // Wakes the one that waits for clients; if it does not wait, nobody has to be woken.
            drop(TcpStream::connect_timeout(&address, Duration::from_secs(1)));
            thread.join().ok();
        }
    }
}

/// A port of loopback.
///
/// # Errors
/// What the system says.
pub fn bind(port: u16) -> std::io::Result<TcpListener> {
    TcpListener::bind((Ipv4Addr::LOCALHOST, port))
}

fn listen(hub: &Arc<Hub>, listener: &TcpListener, device: SimDevice, clients: Clients, service: Service) {
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    while let Ok((stream, _)) = listener.accept() {
        let Some(mut connection) = Connection::open(hub, stream, device) else { break };
        threads.retain(|thread| !thread.is_finished());
        if clients == Clients::One {
            service(&hub.world, &mut connection);
        } else if threads.len() < MAX_CONNECTIONS {
            let hub = Arc::clone(hub);
            let spawned = thread::Builder::new()
                .name(format!("sim-client-{}", connection.id))
                .spawn(move || service(&hub.world, &mut connection));
            threads.extend(spawned);
        }
    }
    for thread in threads {
        thread.join().ok();
    }
}

/// A client.
#[derive(Debug)]
pub struct Connection {
    hub: Arc<Hub>,
    id: u64,
    device: SimDevice,
    stream: TcpStream,
    /// What has arrived and was not taken yet.
    received: Vec<u8>,
    garbage: Random,
}

impl Connection {
    /// `None` once the cell is over.
    fn open(hub: &Arc<Hub>, stream: TcpStream, device: SimDevice) -> Option<Self> {
        let mut ending = hub.ending();
        if ending.is_over {
            return None;
        }
        let id = ending.num_connections;
        ending.num_connections += 1;
        // Without these a client would have to wait a little longer, no more.
        stream.set_nodelay(true).ok();
        ending.open.push((id, stream.try_clone().ok()?));
        drop(ending);
        let garbage = Random::new(id, GARBAGE_STREAM);
        Some(Self { hub: Arc::clone(hub), id, device, stream, received: Vec::new(), garbage })
    }

    /// Waits until `complete` says how many of the bytes that are there make a message, and takes these; `None` when the
    /// client has gone, or sends what cannot become one.
    pub fn receive(&mut self, mut complete: impl FnMut(&[u8]) -> Option<usize>) -> Option<Vec<u8>> {
        loop {
            if let Some(len) = complete(&self.received) {
                let rest = self.received.split_off(len.min(self.received.len()));
                return Some(std::mem::replace(&mut self.received, rest));
            }
            if !self.read_more() {
                return None;
            }
        }
    }

    /// A line without its end; `None` when the client has gone.
    pub fn receive_line(&mut self) -> Option<String> {
        let line = self.receive(|bytes| bytes.iter().position(|byte| *byte == b'\n').map(|at| at + 1))?;
        Some(String::from_utf8_lossy(&line).trim_end_matches(['\r', '\n']).to_owned())
    }

    /// What has arrived within a while; `None` when the client has gone.
    pub fn take_arrived(&mut self, patience: Duration) -> Option<Vec<u8>> {
        self.stream.set_read_timeout(Some(patience.max(Duration::from_millis(1)))).ok()?;
        let mut chunk = [0; CHUNK];
        let read = self.stream.read(&mut chunk);
        self.stream.set_read_timeout(None).ok()?;
        match read {
            Ok(0) => return None,
            Ok(num) => self.received.extend_from_slice(&chunk[..num]),
            Err(error) if matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut) => {}
            Err(_) => return None,
        }
        (self.received.len() <= MAX_PENDING).then(|| std::mem::take(&mut self.received))
    }

    fn read_more(&mut self) -> bool {
        let mut chunk = [0; CHUNK];
        match self.stream.read(&mut chunk) {
            Ok(0) | Err(_) => false,
            Ok(num) => {
                self.received.extend_from_slice(&chunk[..num]);
                self.received.len() <= MAX_PENDING
            }
        }
    }

    /// Waits; false once the cell is over.
    #[must_use]
    pub fn wait(&self, duration: Duration) -> bool {
        let ending = self.hub.ending();
        let waited = self.hub.ended.wait_timeout_while(ending, duration, |ending| !ending.is_over);
        !waited.unwrap_or_else(PoisonError::into_inner).0.is_over
    }

    /// Sends a message as the faults of the device have it; false when the connection is to be given up.
    #[must_use]
    pub fn send(&mut self, message: &[u8]) -> bool {
        match self.hub.world.next_delivery(self.device) {
            Delivery::Whole => self.write(message),
            Delivery::Split => message
                .chunks(PIECE.max(message.len().div_ceil(MAX_PIECES)))
                .all(|piece| self.write(piece) && self.wait(Duration::from_millis(PIECES_APART_MS))),
            Delivery::Late => self.wait(Duration::from_millis(LATE_MS)) && self.write(message),
            Delivery::Never => true,
            Delivery::Garbage => {
                let garbage: Vec<u8> = message.iter().map(|_| self.garbage.byte()).collect();
                self.write(&garbage)
            }
            Delivery::CutOff => {
                let _ = self.write(&message[..message.len() / 2]);
                false
            }
        }
    }

    fn write(&mut self, bytes: &[u8]) -> bool {
        self.stream.write_all(bytes).is_ok()
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.stream.shutdown(Shutdown::Both).ok();
        self.hub.ending().open.retain(|(id, _)| *id != self.id);
    }
}
