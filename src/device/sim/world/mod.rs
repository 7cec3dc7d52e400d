//! The world that the servers of a cell share: the arm and its motions, the ball or part, and what the profiler sees when.

mod orders;
mod profiler;

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use nalgebra::Translation3;

use crate::calibrate::Edge;
use crate::geometry::{Rigid, Vec3, so3};
use crate::scene::{Dirt, Part, Random, Scene};

use super::fault::{Delivery, Fault, FaultPlan, FaultSpec, SimDevice};
use super::head::Head;
use super::layout::Layout;
use super::motion::{Motion, Speed, Way};
use super::subject::Subject;
use super::{SimOptions, SimTruth};

pub use orders::{ArmReport, MotionError, NUM_REGISTERS, Order, Step};

use profiler::Profiler;

/// Motions that are remembered, for profiles that were taken before the last one.
const MAX_MOTIONS: usize = 16;
/// Where the ball is pushed by [`Fault::BallMoved`], mm.
const PUSH_MM: Vec3 = Vec3::new(1.9, -1.2, 0.0);
/// Repeatability of the arm: mm, degrees. Usual for an arm of this size.
const POSE_STD_MM_DEG: [f64; 2] = [0.02, 0.005];
/// Noise of a point of a profile, mm.
const PROFILE_STD_MM: f64 = 0.01;

/// How fast the arm is jogged, as a part of full speed.
const JOG_SPEED_PART: f64 = 0.1;

/// The time over which speeds are told, s.
const SPEED_OVER_S: f64 = 1e-3;

/// Random streams, so that one kind of noise does not shift the others.
mod stream {
    pub const POSE: u64 = 1;
    /// And one more for each profile.
    pub const PROFILE: u64 = 1 << 32;
}

/// A motion, and how far the flange truly is from where the controller says.
#[derive(Clone, Debug)]
struct Leg {
    motion: Motion,
    /// At its start and its end.
    errors: [PoseError; 2],
}

/// An error of the pose, in the flange.
#[derive(Clone, Copy, Debug)]
struct PoseError {
    shift_mm: Vec3,
    turn: Vec3,
}

impl Leg {
    fn error_at(&self, time_s: f64) -> PoseError {
        let part = self.motion.part_at(time_s);
        let [from, to] = self.errors;
        PoseError { shift_mm: from.shift_mm.lerp(&to.shift_mm, part), turn: from.turn.lerp(&to.turn, part) }
    }
}

#[derive(Debug)]
struct State {
    /// The last motion, over or not.
    leg: Leg,
    /// Those before, in their order.
    past: VecDeque<Leg>,
    /// What is left of the program that runs, and when that began.
    program: VecDeque<Step>,
    program_at_s: f64,
    flange_from_tcp: Rigid,
    registers: [i32; NUM_REGISTERS],
    pose_noise: Random,
    faults: FaultPlan,
    profiler: Profiler,
}

/// The arm, the ball or part, the profiler.
#[derive(Debug)]
pub struct World {
    layout: Layout,
    head: Head,
    subject: Subject,
    radius_mm: f64,
    seed: u64,
    pose_std: [f64; 2],
    time_scale: f64,
    start: Instant,
    state: Mutex<State>,
}

impl World {
    /// Everything at its first place.
    #[must_use]
    pub fn new(options: &SimOptions) -> Self {
        let layout = Layout::new(options.robot, &options.head, options.radius_mm);
        let noise = if options.is_noisy { 1.0 } else { 0.0 };
        let [position_std_mm, orientation_std_deg] = POSE_STD_MM_DEG;
        let no_error = PoseError { shift_mm: Vec3::zeros(), turn: Vec3::zeros() };
        let leg = Leg { motion: Motion::standing(layout.home), errors: [no_error; 2] };
        let profile_std_mm = PROFILE_STD_MM * noise;
        let subject = match options.part {
            None => Subject::Ball(Scene {
                ball_in_world: layout.ball_in_base,
                radius_mm: options.radius_mm,
                num_points: usize::from(Head::NUM_POINTS),
                range_sign: 1.0,
                profile_std_mm,
                dirt: Dirt { has_table: true, has_holes: options.is_noisy, ..Dirt::default() },
                decimals: None,
            }),
            Some(kind) => {
                let part = Part::new(kind, layout.base_from_part(kind));
                Subject::Part { part, profile_std_mm, loses_points: options.is_noisy }
            }
        };
        Self {
            subject,
            radius_mm: options.radius_mm,
            layout,
            head: options.head,
            seed: options.seed,
            pose_std: [position_std_mm * noise, orientation_std_deg.to_radians() * noise],
            time_scale: options.time_scale,
            start: Instant::now(),
            state: Mutex::new(State {
                leg,
                past: VecDeque::new(),
                program: VecDeque::new(),
                program_at_s: 0.0,
                flange_from_tcp: options.flange_from_tcp,
                registers: [0; NUM_REGISTERS],
                pose_noise: Random::new(options.seed, stream::POSE),
                faults: FaultPlan::new(&options.faults),
                profiler: Profiler::default(),
            }),
        }
    }

    /// What is true in it.
    #[must_use]
    pub fn truth(&self) -> SimTruth {
        SimTruth {
            flange_from_sensor: self.layout.flange_from_sensor,
            ball_in_base: self.layout.ball_in_base,
            radius_mm: self.radius_mm,
            base_from_part: self.subject.base_from_part(),
            push_mm: PUSH_MM,
            rough_flange_from_sensor: self.layout.rough_flange_from_sensor,
            pose_std_mm_deg: [self.pose_std[0], self.pose_std[1].to_degrees()],
            profile_std_mm: self.subject.profile_std_mm(),
            reference_distance_mm: self.head.reference_mm,
        }
    }

    /// The head.
    #[must_use]
    pub const fn head(&self) -> &Head {
        &self.head
    }

    /// What the controller says of the arm now.
    #[must_use]
    pub fn arm(&self) -> ArmReport {
        let (state, time_s) = self.now();
        let motion = &state.leg.motion;
        let joints = motion.joints_at(time_s);
        let is_moving = time_s < motion.end_s();
        let base_from_flange = motion.pose_at(&self.layout.chain, time_s);
        let before = motion.pose_at(&self.layout.chain, time_s - SPEED_OVER_S);
        let flange_from_tcp = state.flange_from_tcp;
        let [tcp, tcp_before] = [base_from_flange, before].map(|flange| (flange * flange_from_tcp).translation.vector);
        ArmReport {
            base_from_flange,
            flange_from_tcp,
            velocity_mm_s: (tcp - tcp_before) / SPEED_OVER_S,
            turning_rad_s: so3::log(&(base_from_flange.rotation * before.rotation.inverse())) / SPEED_OVER_S,
            joints,
            shown_deg: self.layout.chain.shown_deg(&joints),
            is_moving,
            is_running: is_moving || !state.program.is_empty(),
            registers: state.registers,
            time_s,
        }
    }

    /// Where the flange is at joint angles as the controller shows them, degrees.
    #[must_use]
    pub fn flange_at(&self, shown_deg: [f64; 6]) -> Rigid {
        let chain = &self.layout.chain;
        chain.base_from_flange(&chain.joints_from_shown_deg(shown_deg))
    }

    /// Sends the arm off from where it is, and says after how long, in real time, it will have arrived.
    ///
    /// # Errors
    /// [`MotionError`]; the arm goes on with what it did before.
    pub fn start_motion(&self, order: &Order) -> Result<Duration, MotionError> {
        let (mut state, time_s) = self.now();
        self.start_leg(&mut state, order, time_s)?;
        state.program.clear();
        Ok(self.real(state.leg.motion.end_s() - time_s))
    }

    /// Sends the arm to where the line is on an edge of the plate; or says why not.
    pub fn jog_to_edge(&self, edge: Edge) -> Result<(), String> {
        if !self.subject.is_plate() {
            return Err("there is no plate".to_owned());
        }
        let order = Order::ByJoints {
            base_from_flange: self.layout.base_from_flange_at_edge(edge),
            speed_part: JOG_SPEED_PART,
        };
        self.start_motion(&order).map(drop).map_err(|error| error.to_string())
    }

    /// Runs a program instead of the one that runs. A step that cannot be done ends it.
    pub fn run_program(&self, steps: impl IntoIterator<Item = Step>) {
        let (mut state, time_s) = self.now();
        state.leg.motion.stop_at(time_s);
        state.program = steps.into_iter().collect();
        state.program_at_s = time_s;
        self.advance(&mut state, time_s);
    }

    /// Stops the arm where it is, and the program with it.
    pub fn stop(&self) {
        self.run_program([]);
    }

    /// Begins the steps of the program that are due, each when the one before was over.
    ///
    /// Nothing else drives the program: between two looks at the world nobody can tell.
    fn advance(&self, state: &mut State, time_s: f64) {
        while state.leg.motion.end_s() <= time_s {
            match state.program.pop_front() {
                Some(Step::Go(order)) => {
                    let start_s = state.leg.motion.end_s().max(state.program_at_s);
                    if self.start_leg(state, &order, start_s).is_err() {
                        state.program.clear();
                    }
                }
                Some(Step::SetTcp { flange_from_tcp }) => state.flange_from_tcp = flange_from_tcp,
                Some(Step::SetRegister { register, value }) => {
                    if let Some(place) = state.registers.get_mut(usize::from(register)) {
                        *place = value;
                    }
                }
                None => break,
            }
        }
    }

    /// The motion that an order makes from a time on.
    fn start_leg(&self, state: &mut State, order: &Order, time_s: f64) -> Result<(), MotionError> {
        if state.faults.refuses_next_move() {
            return Err(MotionError::Refused);
        }
        if state.faults.has(Fault::NotRemote) {
            return Err(MotionError::NotRemote);
        }
        let chain = &self.layout.chain;
        let joints = state.leg.motion.joints_at(time_s);
        let (way, cruise_s) = match *order {
            Order::Straight { base_from_flange, flange_from_tcp, speed } => {
                let way = Way::straight(chain, &joints, &base_from_flange, &flange_from_tcp)?;
                let cruise_s = way.cruise_s(speed, 1.0);
                (way, cruise_s)
            }
            Order::ByJoints { base_from_flange, speed_part } => {
                let way = Way::by_joints(chain, &joints, &chain.joints_near(&joints, &base_from_flange)?)?;
                let cruise_s = way.cruise_s(Speed::FULL, speed_part);
                (way, cruise_s)
            }
            Order::ToJoints { shown_deg, speed_part } => {
                let way = Way::by_joints(chain, &joints, &chain.joints_from_shown_deg(shown_deg))?;
                let cruise_s = way.cruise_s(Speed::FULL, speed_part);
                (way, cruise_s)
            }
        };
        if !cruise_s.is_finite() || cruise_s < 0.0 {
            return Err(MotionError::NoSpeed);
        }
        state.leg.motion.stop_at(time_s);
        let [position_std_mm, orientation_std_rad] = self.pose_std;
        let error = PoseError {
            shift_mm: state.pose_noise.normal3() * position_std_mm,
            turn: state.pose_noise.normal3() * orientation_std_rad,
        };
        let errors = [state.leg.error_at(time_s), error];
        let leg = Leg { motion: Motion::new(way, time_s, cruise_s), errors };
        let before = std::mem::replace(&mut state.leg, leg);
        state.past.push_back(before);
        if state.past.len() > MAX_MOTIONS {
            state.past.pop_front();
        }
        Ok(())
    }

    /// What becomes of the next message of a device.
    pub fn next_delivery(&self, device: SimDevice) -> Delivery {
        self.now().0.faults.next_delivery(device)
    }

    /// Whether a fault is on.
    #[must_use]
    pub fn has(&self, fault: Fault) -> bool {
        self.now().0.faults.has(fault)
    }

    /// One more fault, counted from now on.
    pub fn inject(&self, spec: FaultSpec) {
        self.now().0.faults.add(spec);
    }

    /// Ends all faults.
    pub fn clear_faults(&self) {
        self.now().0.faults.clear();
    }

    /// How long so many seconds of the cell's own clock are in real time.
    #[must_use]
    pub fn real(&self, time_s: f64) -> Duration {
        Duration::try_from_secs_f64(time_s / self.time_scale).unwrap_or(Duration::MAX)
    }

    /// The state as it has become by now, and the time on the cell's own clock.
    fn now(&self) -> (MutexGuard<'_, State>, f64) {
        // Nothing panics while it holds the lock; if something did, the state would still be whole.
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let time_s = self.start.elapsed().as_secs_f64() * self.time_scale;
        self.advance(&mut state, time_s);
        (state, time_s)
    }

    /// Where the flange truly is at a time.
    fn true_pose(&self, state: &State, time_s: f64) -> Rigid {
        let mut later = std::iter::once(&state.leg).chain(state.past.iter().rev());
        let leg = later.find(|leg| leg.motion.start_s() <= time_s);
        let leg = leg.or_else(|| state.past.front()).unwrap_or(&state.leg);
        let error = leg.error_at(time_s);
        let off = Rigid::from_parts(Translation3::from(error.shift_mm), so3::exp(error.turn));
        leg.motion.pose_at(&self.layout.chain, time_s) * off
    }
}
