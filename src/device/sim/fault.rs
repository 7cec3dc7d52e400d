//! Faults on request: which of them is on, decided by counting requests and moves. Pure.

use std::str::FromStr;

use thiserror::Error;

/// Something that goes wrong in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Messages arrive in pieces.
    SplitFrames,
    /// Messages arrive late.
    Slow,
    /// No answer.
    Silent,
    /// Answers of random bytes.
    Garbage,
    /// The connection is closed in the middle of an answer.
    Disconnect,
    /// The robot refuses to move.
    RobotRefuses,
    /// The ball was pushed.
    BallMoved,
    /// The profiler takes no further profiles, and goes on to hand out the last one.
    StaleProfile,
    /// The robot was taken out of its remote mode.
    NotRemote,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::SplitFrames,
        Self::Slow,
        Self::Silent,
        Self::Garbage,
        Self::Disconnect,
        Self::RobotRefuses,
        Self::BallMoved,
        Self::StaleProfile,
        Self::NotRemote,
    ];

    /// Its name on the command line.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::SplitFrames => "split-frames",
            Self::Slow => "slow",
            Self::Silent => "silent",
            Self::Garbage => "garbage",
            Self::Disconnect => "disconnect",
            Self::RobotRefuses => "robot-refuses",
            Self::BallMoved => "ball-moved",
            Self::StaleProfile => "stale-profile",
            Self::NotRemote => "not-remote",
        }
    }

    /// The device that it befalls where that is not said.
    #[must_use]
    pub const fn usual_device(self) -> SimDevice {
        match self {
            Self::BallMoved | Self::StaleProfile => SimDevice::Sensor,
            _ => SimDevice::Robot,
        }
    }
}

/// A device of the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimDevice {
    /// The robot's controller.
    Robot,
    /// The profiler's controller.
    Sensor,
}

/// When a fault begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultStart {
    /// Once its device has answered so many requests; messages that a device sends by itself count too.
    AfterRequests(u32),
    /// Once the robot was sent somewhere so many times.
    AfterMoves(u32),
}

/// A fault to come. As text: `silent`, `silent:sensor`, `garbage:robot:after-moves=3:for=2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultSpec {
    /// What goes wrong.
    pub fault: Fault,
    /// Where.
    pub device: SimDevice,
    /// When.
    pub start: FaultStart,
    /// How many requests of its device it lasts; `None`: for good.
    pub num_requests: Option<u32>,
}

impl FaultSpec {
    /// At once and for good, on the device that it usually befalls.
    #[must_use]
    pub const fn now(fault: Fault) -> Self {
        Self { fault, device: fault.usual_device(), start: FaultStart::AfterRequests(0), num_requests: None }
    }

    /// The same on this device.
    #[must_use]
    pub const fn on(self, device: SimDevice) -> Self {
        Self { device, ..self }
    }

    /// The same from then on.
    #[must_use]
    pub const fn starting(self, start: FaultStart) -> Self {
        Self { start, ..self }
    }

    /// The same for so many requests.
    #[must_use]
    pub const fn lasting(self, num_requests: u32) -> Self {
        Self { num_requests: Some(num_requests), ..self }
    }
}

/// Why a text is no fault.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "found '{found}', expected a fault ({}), then :robot or :sensor, :after=N requests or :after-moves=N, :for=N requests",
    Fault::ALL.map(Fault::id).join(", ")
)]
pub struct FaultSpecError {
    found: String,
}

impl FromStr for FaultSpec {
    type Err = FaultSpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let error = || FaultSpecError { found: text.to_owned() };
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default();
        let fault = Fault::ALL.into_iter().find(|fault| fault.id() == name).ok_or_else(error)?;
        let mut spec = Self::now(fault);
        for part in parts {
            let (key, number) = match part.split_once('=') {
                Some((key, number)) => (key, Some(number.parse().map_err(|_| error())?)),
                None => (part, None),
            };
            spec = match (key, number) {
                ("robot", None) => spec.on(SimDevice::Robot),
                ("sensor", None) => spec.on(SimDevice::Sensor),
                ("after", Some(num)) => spec.starting(FaultStart::AfterRequests(num)),
                ("after-moves", Some(num)) => spec.starting(FaultStart::AfterMoves(num)),
                ("for", Some(num)) => spec.lasting(num),
                _ => return Err(error()),
            };
        }
        Ok(spec)
    }
}

/// What becomes of a message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Delivery {
    /// Sent whole and at once.
    #[default]
    Whole,
    /// Sent in pieces.
    Split,
    /// Sent late.
    Late,
    /// Not sent.
    Never,
    /// Replaced by random bytes.
    Garbage,
    /// Half of it, then the connection is closed.
    CutOff,
}

/// A fault with when it began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Scheduled {
    spec: FaultSpec,
    /// Requests of its device at that time.
    begun_at: Option<u32>,
}

/// All faults of a cell, and what they are counted by.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaultPlan {
    scheduled: Vec<Scheduled>,
    num_requests: [u32; 2],
    num_moves: u32,
}

impl FaultPlan {
    /// Nothing has been asked yet.
    #[must_use]
    pub fn new(specs: &[FaultSpec]) -> Self {
        let mut plan = Self::default();
        plan.scheduled.extend(specs.iter().map(|spec| Scheduled { spec: *spec, begun_at: None }));
        plan.begin_due();
        plan
    }

    /// One more, its counts from now on.
    pub fn add(&mut self, spec: FaultSpec) {
        let start = match spec.start {
            FaultStart::AfterRequests(num) => {
                FaultStart::AfterRequests(num.saturating_add(self.num_requests[spec.device as usize]))
            }
            FaultStart::AfterMoves(num) => FaultStart::AfterMoves(num.saturating_add(self.num_moves)),
        };
        self.scheduled.push(Scheduled { spec: FaultSpec { start, ..spec }, begun_at: None });
        self.begin_due();
    }

    /// None any more.
    pub fn clear(&mut self) {
        self.scheduled.clear();
    }

    /// A device is to send a message: what becomes of it.
    pub fn next_delivery(&mut self, device: SimDevice) -> Delivery {
        let delivery = self.active(device).find_map(|fault| match fault {
            Fault::SplitFrames => Some(Delivery::Split),
            Fault::Slow => Some(Delivery::Late),
            Fault::Silent => Some(Delivery::Never),
            Fault::Garbage => Some(Delivery::Garbage),
            Fault::Disconnect => Some(Delivery::CutOff),
            _ => None,
        });
        let num = &mut self.num_requests[device as usize];
        *num = num.saturating_add(1);
        self.begin_due();
        delivery.unwrap_or_default()
    }

    /// The robot is sent somewhere: whether it refuses.
    pub fn refuses_next_move(&mut self) -> bool {
        let refuses = self.has(Fault::RobotRefuses);
        self.num_moves = self.num_moves.saturating_add(1);
        self.begin_due();
        refuses
    }

    /// Whether a fault is on.
    #[must_use]
    pub fn has(&self, fault: Fault) -> bool {
        [SimDevice::Robot, SimDevice::Sensor]
            .into_iter()
            .any(|device| self.active(device).any(|active| active == fault))
    }

    fn active(&self, device: SimDevice) -> impl Iterator<Item = Fault> + '_ {
        let now = self.num_requests[device as usize];
        self.scheduled
            .iter()
            .filter(move |scheduled| {
                scheduled.spec.device == device
                    && scheduled.begun_at.is_some_and(|begun_at| {
                        scheduled.spec.num_requests.is_none_or(|num| now < begun_at.saturating_add(num))
                    })
            })
            .map(|scheduled| scheduled.spec.fault)
    }

    fn begin_due(&mut self) {
        for scheduled in &mut self.scheduled {
            let requests = self.num_requests[scheduled.spec.device as usize];
            let is_due = match scheduled.spec.start {
                FaultStart::AfterRequests(num) => requests >= num,
                FaultStart::AfterMoves(num) => self.num_moves >= num,
            };
            if is_due && scheduled.begun_at.is_none() {
                scheduled.begun_at = Some(requests);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_name_fault_device_start_and_length() {
        let silent = FaultSpec::now(Fault::Silent);
        for (text, expected) in [
            ("silent", silent),
            ("silent:sensor", silent.on(SimDevice::Sensor)),
            ("stale-profile", FaultSpec::now(Fault::StaleProfile).on(SimDevice::Sensor)),
            (
                "garbage:robot:after-moves=3:for=2",
                FaultSpec::now(Fault::Garbage).starting(FaultStart::AfterMoves(3)).lasting(2),
            ),
            ("slow:after=7", FaultSpec::now(Fault::Slow).starting(FaultStart::AfterRequests(7))),
        ] {
            assert_eq!(text.parse(), Ok(expected), "{text}");
        }
        for wrong in ["", "mute", "silent:door", "silent:after", "silent:after=x", "silent:for=-1", "silent:robot=1"] {
            let refusal = wrong.parse::<FaultSpec>().expect_err(wrong).to_string();
            assert!(refusal.contains("split-frames, slow, silent") && !refusal.contains('\n'), "{refusal}");
        }
    }

    #[test]
    fn a_fault_begins_and_ends_by_the_requests_of_its_device() {
        let spec = FaultSpec::now(Fault::Silent).starting(FaultStart::AfterRequests(2)).lasting(3);
        let mut plan = FaultPlan::new(&[spec]);
        let mut deliveries = Vec::new();
        for _ in 0..7 {
            assert_eq!(plan.next_delivery(SimDevice::Sensor), Delivery::Whole);
            deliveries.push(plan.next_delivery(SimDevice::Robot));
        }
        let [whole, never] = [Delivery::Whole, Delivery::Never];
        assert_eq!(deliveries, [whole, whole, never, never, never, whole, whole]);
    }

    #[test]
    fn moves_start_faults_and_added_ones_count_from_now() {
        let mut plan = FaultPlan::new(&[FaultSpec::now(Fault::BallMoved).starting(FaultStart::AfterMoves(2))]);
        assert!(!plan.refuses_next_move());
        assert!(!plan.has(Fault::BallMoved));
        assert!(!plan.refuses_next_move());
        assert!(plan.has(Fault::BallMoved));
        plan.add(FaultSpec::now(Fault::RobotRefuses).starting(FaultStart::AfterMoves(1)));
        assert!(!plan.refuses_next_move());
        assert!(plan.refuses_next_move());
        plan.clear();
        assert!(!plan.refuses_next_move() && !plan.has(Fault::BallMoved));
    }
}
