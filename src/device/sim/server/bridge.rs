//! The other side of the text bridge: a robot, and a profiler.

use crate::device::bridge::messages::{
    self, Answer, Ask, BridgePose, BridgeProfile, BridgedDevice, Hello, Reply, RobotState, VERSION,
};
use crate::device::sim::fault::Fault;
use crate::device::sim::head::Height;
use crate::device::sim::motion::Speed;
use crate::device::sim::net::Connection;
use crate::device::sim::world::{Order, World};
use crate::geometry::{Rigid, Transform};

/// The least step of a reported coordinate, mm.
const RESOLUTION_MM: f64 = 0.001;

/// Talks to one client of the robot.
pub fn serve_robot(world: &World, connection: &mut Connection) {
    serve(world, connection, answer_of_robot);
}

/// Talks to one client of the profiler.
pub fn serve_profiler(world: &World, connection: &mut Connection) {
    serve(world, connection, answer_of_profiler);
}

fn serve(world: &World, connection: &mut Connection, answer: fn(&World, &Ask) -> Answer) {
    while let Some(line) = connection.receive_line() {
        // A line that is no request ends the connection: it has no id to answer to.
        let Ok(request) = messages::parse_request(line.as_bytes()) else { return };
        let reply = Reply { bridge: VERSION, id: request.id, answer: answer(world, &request.ask) };
        let Ok(line) = messages::encode_line(&reply) else { return };
        if !connection.send(line.as_bytes()) {
            return;
        }
    }
}

fn answer_of_robot(world: &World, ask: &Ask) -> Answer {
    match ask {
        Ask::Hello { .. } => Answer::Hello(Hello {
            device: BridgedDevice::Robot,
            name: "simulated robot".to_owned(),
            can_move: true,
            resolution_mm: RESOLUTION_MM,
            tool: "flange in world".to_owned(),
            convention: None,
        }),
        Ask::State => {
            let arm = world.arm();
            Answer::State(RobotState {
                pose: BridgePose::from_pose(&Transform::from_rigid(arm.base_from_flange), None),
                joints_deg: arm.shown_deg.to_vec(),
                is_moving: arm.is_moving,
                not_ready: world.has(Fault::NotRemote).then(|| "the mode switch is on manual".to_owned()),
                move_failed: None,
            })
        }
        Ask::Move { pose, speed_mm_s, rotation_speed_deg_s } => {
            let speed = Speed { linear_mm_s: *speed_mm_s, turning_rad_s: rotation_speed_deg_s.to_radians() };
            let target = pose.pose(None).map_err(|error| error.to_string());
            let started = target.and_then(|target| {
                let flange_from_tcp = Rigid::identity();
                let order = Order::Straight { base_from_flange: *target.rigid(), flange_from_tcp, speed };
                world.start_motion(&order).map_err(|error| error.to_string())
            });
            match started {
                Ok(_) => Answer::Accepted,
                Err(found) => Answer::Refused { found, remedy: "choose another pose".to_owned() },
            }
        }
        Ask::Stop => {
            world.stop();
            Answer::Accepted
        }
        Ask::Newest | Ask::Forget => no_such_request(),
    }
}

fn answer_of_profiler(world: &World, ask: &Ask) -> Answer {
    match ask {
        Ask::Hello { .. } => Answer::Hello(Hello {
            device: BridgedDevice::Profiler,
            name: "simulated profiler".to_owned(),
            can_move: false,
            resolution_mm: 0.0,
            tool: String::new(),
            convention: None,
        }),
        Ask::Newest => {
            let (newest, first_held) = world.trigger_counts();
            if newest < first_held {
                return Answer::NoProfile;
            }
            let x_mm = (0..).map(|idx| world.head().x_mm(idx));
            let (x_mm, z_mm) = x_mm.zip(world.profile(newest)).map(|(x_mm, height)| (x_mm, measured(height))).unzip();
            Answer::Profile(BridgeProfile { trigger_count: newest, x_mm, z_mm })
        }
        Ask::Forget => {
            world.forget_profiles(world.trigger_counts().0);
            Answer::Accepted
        }
        Ask::State | Ask::Move { .. } | Ask::Stop => no_such_request(),
    }
}

fn measured(height: Height) -> Option<f64> {
    match height {
        Height::Measured { z_mm } => Some(z_mm),
        Height::NoPeak | Height::DeadZone => None,
    }
}

fn no_such_request() -> Answer {
    let remedy = "connect to the port of the other device".to_owned();
    Answer::Refused { found: "a request for the other device".to_owned(), remedy }
}
