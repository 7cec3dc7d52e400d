//! What the fake devices have in common: ports, faults, a gate, and what a test asks of every driver.

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use handeye::device::{DeviceError, Endpoint, LinearMove, MoveState, RobotDriver};
use handeye::geometry::{Base, Flange, PoseConvention, Transform, Vec3};

/// Far beyond what any answer over loopback takes, on a busy machine too.
pub const PATIENCE: Duration = Duration::from_secs(20);
/// A deadline that a test lets pass.
pub const BRIEF: Duration = Duration::from_millis(150);

pub fn soon() -> Instant {
    Instant::now() + PATIENCE
}

/// What a fake device does.
#[derive(Clone, Debug)]
pub enum Act {
    /// Answers at once.
    Send(Vec<u8>),
    /// Answers byte by byte, each in a segment of its own.
    Dribble(Vec<u8>),
    /// Answers, and closes the connection.
    SendAndClose(Vec<u8>),
    /// Says nothing, and stays.
    Silence,
}

impl Act {
    /// `false` if the connection is to be closed.
    fn perform(&self, stream: &mut TcpStream) -> bool {
        match self {
            Self::Send(bytes) => stream.write_all(bytes).is_ok(),
            Self::Dribble(bytes) => bytes.chunks(1).all(|byte| {
                // Long enough for a segment of its own, short enough for a reply of some hundred bytes.
                thread::sleep(Duration::from_micros(200));
                stream.write_all(byte).is_ok()
            }),
            Self::SendAndClose(bytes) => {
                let _ = stream.write_all(bytes);
                false
            }
            Self::Silence => true,
        }
    }
}

/// Free ports at these distances from the port of the endpoint.
pub fn listen(distances: &[i32]) -> (Vec<TcpListener>, Endpoint) {
    for _ in 0..1000 {
        let first = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let port = i32::from(first.local_addr().expect("bound").port()) - distances[0];
        let others = distances[1..].iter().map(|distance| {
            let port = u16::try_from(port + distance).ok()?;
            TcpListener::bind(("127.0.0.1", port)).ok()
        });
        if let (Some(others), Ok(port)) = (others.collect::<Option<Vec<_>>>(), u16::try_from(port)) {
            let endpoint = Endpoint { host: "127.0.0.1".to_owned(), port };
            return ([first].into_iter().chain(others).collect(), endpoint);
        }
    }
    panic!("no free ports side by side");
}

/// Serves every connection in a thread of its own: a greeting, then an act for each message that `len_of_first` cuts off.
pub fn serve(
    listener: TcpListener,
    greeting: Act,
    len_of_first: impl Fn(&[u8]) -> Option<usize> + Clone + Send + 'static,
    respond: impl FnMut(&[u8]) -> Act + Clone + Send + 'static,
) {
    thread::spawn(move || {
        for stream in listener.incoming() {
            let Ok(mut stream) = stream else { return };
            stream.set_nodelay(true).expect("a socket");
            let (greeting, len_of_first, mut respond) = (greeting.clone(), len_of_first.clone(), respond.clone());
            thread::spawn(move || {
                let mut received = Vec::new();
                let mut chunk = [0; 4096];
                let mut is_open = greeting.perform(&mut stream);
                while is_open {
                    if let Some(len) = len_of_first(&received) {
                        let message: Vec<u8> = received.drain(..len).collect();
                        is_open = respond(&message).perform(&mut stream);
                        continue;
                    }
                    match stream.read(&mut chunk) {
                        Ok(num) if num > 0 => received.extend_from_slice(&chunk[..num]),
                        _ => return,
                    }
                }
            });
        }
    });
}

/// A line, its end included.
pub fn line(bytes: &[u8]) -> Option<usize> {
    bytes.iter().position(|byte| *byte == b'\n').map(|end| end + 1)
}

/// Holds a move up until the test lets it go on.
#[derive(Clone, Debug, Default)]
pub struct Gate(Arc<(Mutex<u32>, Condvar)>);

impl Gate {
    /// Lets so many through.
    pub fn open(&self, num: u32) {
        let (passes, changed) = &*self.0;
        *passes.lock().unwrap_or_else(PoisonError::into_inner) += num;
        changed.notify_all();
    }

    /// Waits until there is a pass, and takes it.
    pub fn pass(&self) {
        let (passes, changed) = &*self.0;
        let passes = passes.lock().unwrap_or_else(PoisonError::into_inner);
        let mut passes = changed.wait_while(passes, |passes| *passes == 0).unwrap_or_else(PoisonError::into_inner);
        *passes -= 1;
    }
}

/// A pose by FANUC's numbers.
pub fn pose(position_mm: [f64; 3], wpr_deg: [f64; 3]) -> Transform<Base, Flange> {
    let rotation = PoseConvention::default_convention().rotation_from_angles_deg(wpr_deg);
    Transform::from_parts(Vec3::from(position_mm), rotation)
}

pub fn linear(base_from_flange: Transform<Base, Flange>, speed_mm_s: f64) -> LinearMove {
    LinearMove { base_from_flange, speed_mm_s, rotation_speed_deg_s: 30.0 }
}

#[track_caller]
pub fn assert_near(found: &Transform<Base, Flange>, expected: &Transform<Base, Flange>, tolerance_mm: f64) {
    let distance_mm = (found.translation_mm() - expected.translation_mm()).norm();
    let turn_deg = found.rotation().angle_to(&expected.rotation()).to_degrees();
    assert!(distance_mm <= tolerance_mm && turn_deg <= tolerance_mm, "{distance_mm} mm, {turn_deg}° apart");
}

/// Waits for what another thread does.
#[track_caller]
pub fn wait_until(mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < PATIENCE, "it never comes");
        thread::yield_now();
    }
}

/// Waits for the end of a move.
pub fn finish(robot: &mut dyn RobotDriver) -> Result<(), DeviceError> {
    let start = Instant::now();
    while robot.move_state(soon())? == MoveState::Moving {
        assert!(start.elapsed() < PATIENCE, "the move does not end");
    }
    Ok(())
}

/// What must hold of a connection to something broken: an error of this kind, and long before the deadline.
#[track_caller]
pub fn expect_error<T>(
    outcome: impl FnOnce(Instant) -> Result<T, DeviceError>,
    is_expected: impl FnOnce(&DeviceError) -> bool,
) -> String {
    let Err(error) = outcome(soon()) else { panic!("it went well") };
    assert!(is_expected(&error), "{error:?}");
    error.to_string()
}

/// What must hold of a connection to something silent: the error that says so, at the deadline and not before.
#[track_caller]
pub fn expect_timeout<T>(outcome: impl FnOnce(Instant) -> Result<T, DeviceError>) {
    let start = Instant::now();
    let Err(error) = outcome(start + BRIEF) else { panic!("it went well") };
    assert!(matches!(error, DeviceError::Timeout { .. }), "{error:?}");
    assert!((BRIEF..PATIENCE).contains(&start.elapsed()), "{:?} instead of {BRIEF:?}", start.elapsed());
}
