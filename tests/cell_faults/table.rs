//! Which faults are tried when, and which ends each of them may have.

use handeye::device::sim::{Fault, FaultSpec, SimDevice};
use handeye::device::{DeviceError, MotionRefusal, RobotKind, RoutineEnd, SearchEnd, SearchPhase, SensorKind};

/// When a fault is to set in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// In a phase of the search.
    Phase(SearchPhase),
    /// On a long way to a station.
    Moving,
    /// After a step, before its capture.
    Settling,
}

const MOMENTS: [Moment; 7] = [
    Moment::Phase(SearchPhase::First),
    Moment::Phase(SearchPhase::Probe),
    Moment::Phase(SearchPhase::Reverse),
    Moment::Phase(SearchPhase::Climb),
    Moment::Phase(SearchPhase::Pass),
    Moment::Moving,
    Moment::Settling,
];

/// One fault at one moment in one cell.
#[derive(Clone, Debug)]
pub struct Case {
    pub robot: RobotKind,
    pub sensor: SensorKind,
    pub spec: FaultSpec,
    pub moment: Moment,
}

/// Every fault of every device at every moment over the first pair of protocols, and the rest of them more coarsely.
pub fn all_cases() -> Vec<Case> {
    const WIRE: [Fault; 5] = [Fault::SplitFrames, Fault::Slow, Fault::Silent, Fault::Garbage, Fault::Disconnect];
    const OTHERS: [Fault; 4] = [Fault::RobotRefuses, Fault::BallMoved, Fault::StaleProfile, Fault::NotRemote];
    /// So many late answers slow a search down and are no reason to give it up.
    const SOME: u32 = 4;
    let of_wire = WIRE.map(FaultSpec::now).into_iter().flat_map(|spec| {
        let both = [spec.on(SimDevice::Robot), spec.on(SimDevice::Sensor)];
        both.into_iter().chain(both.map(|spec| spec.lasting(SOME)).into_iter().filter(|spec| spec.fault == Fault::Slow))
    });
    let specs: Vec<_> = of_wire.chain(OTHERS.map(FaultSpec::now)).collect();
    let full = (RobotKind::FanucMappdk, SensorKind::KeyenceLjv, &MOMENTS[..]);
    let some = [Moment::Phase(SearchPhase::Climb), Moment::Moving];
    let coarse = [
        (RobotKind::UniversalRobots, SensorKind::KeyenceLjv, &some[..]),
        (RobotKind::Bridge, SensorKind::Bridge, &some[..]),
    ];
    let mut cases = Vec::new();
    for (robot, sensor, moments) in std::iter::once(full).chain(coarse) {
        for spec in &specs {
            cases.extend(moments.iter().map(|moment| Case { robot, sensor, spec: *spec, moment: *moment }));
        }
    }
    cases
}

impl Case {
    fn is_of_wire(&self) -> bool {
        matches!(self.spec.fault, Fault::SplitFrames | Fault::Slow | Fault::Silent | Fault::Garbage | Fault::Disconnect)
    }

    /// Whether the fault may end so. Where the peak may have been known before it set in, it may have been found, too.
    pub fn admits(&self, end: &RoutineEnd) -> bool {
        let is_found = matches!(end, RoutineEnd::Searched(SearchEnd::Found { .. }));
        let failed = |is_expected: fn(&DeviceError) -> bool| matches!(end, RoutineEnd::Failed { error, .. } if is_of(self.spec.device, error) && is_expected(error));
        match self.spec.fault {
            Fault::SplitFrames => is_found,
            Fault::Slow if self.spec.num_requests.is_some() => is_found,
            Fault::Slow | Fault::Silent => failed(|error| matches!(error, DeviceError::Timeout { .. })),
            // Random bytes may look like the beginning of a message, of which the rest does not come.
            Fault::Garbage => {
                failed(|error| matches!(error, DeviceError::Unexpected { .. } | DeviceError::Timeout { .. }))
            }
            Fault::Disconnect => failed(|error| matches!(error, DeviceError::Closed { .. })),
            Fault::RobotRefuses => failed(|error| matches!(error, DeviceError::Refused { .. })),
            Fault::StaleProfile => matches!(end, RoutineEnd::StaleProfiles { .. }),
            // After some steps the search sees two balls. With one of them in a single capture, or none, it finds the other:
            // whether that is true is checked by the cell's truth.
            Fault::BallMoved => {
                matches!(end, RoutineEnd::Searched(SearchEnd::ResidualGrew { .. }))
                    || is_found && self.moment != Moment::Phase(SearchPhase::Climb)
            }
            // The program that serves MAPPDK ends with the remote mode.
            Fault::NotRemote if self.robot == RobotKind::FanucMappdk => {
                failed(|error| matches!(error, DeviceError::Closed { .. }))
            }
            Fault::NotRemote => {
                matches!(end, RoutineEnd::NotAllowed(MotionRefusal::NotReady { .. }))
                    || failed(|error| matches!(error, DeviceError::NotReady { .. } | DeviceError::Refused { .. }))
            }
        }
    }

    /// Whether the robot can be told to stop, and says that it did.
    pub fn robot_takes_stop(&self) -> bool {
        let is_deaf = self.is_of_wire() && self.spec.device == SimDevice::Robot;
        // Out of its remote mode only a bridge still does what we ask.
        let is_local = self.spec.fault == Fault::NotRemote && self.robot != RobotKind::Bridge;
        !is_deaf && !is_local
    }

    /// Whether a fault on the way keeps the robot from its end. The rest shows after it, or cannot be helped: of a robot
    /// that hears nothing, or a program that runs on in local control.
    pub fn breaks_off_way(&self) -> bool {
        let is_in_pieces = self.robot == RobotKind::FanucMappdk;
        match self.spec.fault {
            Fault::SplitFrames | Fault::BallMoved | Fault::StaleProfile => false,
            Fault::Slow if self.spec.num_requests.is_some() => false,
            Fault::Slow | Fault::Silent | Fault::Garbage | Fault::Disconnect => {
                self.spec.device == SimDevice::Sensor || is_in_pieces
            }
            Fault::RobotRefuses => is_in_pieces,
            Fault::NotRemote => self.robot != RobotKind::UniversalRobots,
        }
    }
}

/// Whether an error names the device.
pub fn is_of(device: SimDevice, error: &DeviceError) -> bool {
    let names: &[&str] = match device {
        SimDevice::Robot => &["Robot", "FANUC (MAPPDK)", "Universal Robots"],
        SimDevice::Sensor => &["Profiler", "Keyence LJ-V7000"],
    };
    let told = error.to_string();
    names.iter().any(|name| told.starts_with(name))
}
