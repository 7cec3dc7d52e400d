//! The real-time data exchange of a Universal Robots controller, version 2.

use std::time::{Duration, Instant};

use crate::device::robot::ur::rtde::{self, ClientPacket, NOT_FOUND, ServerPacket, VERSION, Value, encode_values};
use crate::device::robot::ur::script::UrPose;
use crate::device::sim::net::Connection;
use crate::device::sim::world::{ArmReport, World};
use crate::geometry::{Rigid, Transform};

/// The mode of a robot that runs.
pub const ROBOT_MODE_RUNNING: i32 = 7;
/// The mode of a robot that nothing holds up.
pub const SAFETY_MODE_NORMAL: i32 = 1;
/// The mode of a joint that runs.
pub const JOINT_MODE_RUNNING: i32 = 253;

/// The version that the controller says it has.
const CONTROLLER_VERSION: [u32; 4] = [5, 12, 6, 1_102_099];
/// Packets a second: the most, and the least that makes sense.
const FREQUENCY_HZ: [f64; 2] = [1.0, 500.0];
/// Most recipes of a client.
const MAX_RECIPES: usize = 16;

/// What a client wants to be told.
struct Recipe {
    id: u8,
    names: Vec<String>,
    period: Duration,
    next_at: Instant,
}

/// Talks to one client.
pub fn serve(world: &World, connection: &mut Connection) {
    let mut received = Vec::new();
    let mut recipes: Vec<Recipe> = Vec::new();
    let mut is_started = false;
    loop {
        let now = Instant::now();
        let mut next_at = now + Duration::from_secs(1);
        for recipe in recipes.iter_mut().filter(|_| is_started) {
            if now >= recipe.next_at {
                if !connection.send(&data(world, recipe)) {
                    return;
                }
                // What could not be sent in time is left out.
                recipe.next_at = (recipe.next_at + recipe.period).max(now);
            }
            next_at = next_at.min(recipe.next_at);
        }
        let Some(bytes) = connection.take_arrived(next_at.saturating_duration_since(Instant::now())) else { return };
        received.extend(bytes);
        loop {
            let Ok(len) = rtde::packet_len(&received) else { return };
            let Some(len) = len else { break };
            let rest = received.split_off(len);
            let packet = std::mem::replace(&mut received, rest);
            let Ok(packet) = ClientPacket::parse(&packet) else { return };
            let reply = answer(world, packet, &mut recipes, &mut is_started);
            if reply.is_some_and(|reply| !connection.send(&reply.encode())) {
                return;
            }
        }
    }
}

fn answer(
    world: &World,
    packet: ClientPacket,
    recipes: &mut Vec<Recipe>,
    is_started: &mut bool,
) -> Option<ServerPacket> {
    Some(match packet {
        ClientPacket::RequestVersion(version) => ServerPacket::VersionAccepted(version == VERSION),
        ClientPacket::ControllerVersion => ServerPacket::ControllerVersion(CONTROLLER_VERSION),
        ClientPacket::SetupOutputs { frequency_hz, names } => {
            let arm = world.arm();
            let types: Vec<String> = names.iter().map(|name| type_of(name, output(&arm, name)).to_owned()).collect();
            if recipes.len() >= MAX_RECIPES || types.iter().any(|name| name == NOT_FOUND) {
                return Some(ServerPacket::OutputTypes { recipe_id: 0, types });
            }
            let [least, most] = FREQUENCY_HZ;
            let frequency_hz = if frequency_hz.is_finite() { frequency_hz.clamp(least, most) } else { most };
            let id = u8::try_from(recipes.len() + 1).unwrap_or(u8::MAX);
            let period = Duration::from_secs_f64(1.0 / frequency_hz);
            recipes.push(Recipe { id, names, period, next_at: Instant::now() });
            ServerPacket::OutputTypes { recipe_id: id, types }
        }
        ClientPacket::SetupInputs { names } => {
            let types: Vec<String> = names.iter().map(|name| input_type(name).to_owned()).collect();
            let is_usable = types.iter().all(|name| name != NOT_FOUND);
            ServerPacket::InputTypes { recipe_id: u8::from(is_usable), types }
        }
        ClientPacket::Start => {
            *is_started = !recipes.is_empty();
            ServerPacket::Started(*is_started)
        }
        ClientPacket::Pause => {
            *is_started = false;
            ServerPacket::Paused(true)
        }
        // Inputs change nothing here, and messages are for the controller's log.
        ClientPacket::Data { .. } | ClientPacket::Message(_) => return None,
    })
}

fn data(world: &World, recipe: &Recipe) -> Vec<u8> {
    let arm = world.arm();
    let values: Vec<Value> = recipe.names.iter().filter_map(|name| output(&arm, name)).collect();
    ServerPacket::Data { recipe_id: recipe.id, values: encode_values(&values) }.encode()
}

/// A pose as the controller writes it: m, and the rotation vector.
pub fn pose_m(pose: &Rigid) -> [f64; 6] {
    UrPose::from_pose(&Transform::from_rigid(*pose)).0
}

fn type_of(name: &str, value: Option<Value>) -> &'static str {
    match value {
        None => NOT_FOUND,
        Some(Value::U8(_)) if name.contains("_bit_register_") => "BOOL",
        Some(Value::U8(_)) => "UINT8",
        Some(Value::U32(_)) => "UINT32",
        Some(Value::U64(_)) => "UINT64",
        Some(Value::I32(_)) => "INT32",
        Some(Value::F64(_)) => "DOUBLE",
        Some(Value::Vector3(_)) => "VECTOR3D",
        Some(Value::Vector6(_)) => "VECTOR6D",
        Some(Value::Vector6I32(_)) => "VECTOR6INT32",
        Some(Value::Vector6U32(_)) => "VECTOR6UINT32",
    }
}

/// What is known of the robot under a name; what a simulated robot does not have is zero.
fn output(arm: &ArmReport, name: &str) -> Option<Value> {
    const STILL: Value = Value::Vector6([0.0; 6]);
    if let Some((kind, number)) = name.rsplit_once('_')
        && let Ok(number) = number.parse::<usize>()
        && let Some(value) = register(arm, kind, number)
    {
        return Some(value);
    }
    Some(match name {
        "timestamp" => Value::F64(arm.time_s),
        "actual_q" | "target_q" => Value::Vector6(arm.joints.into()),
        "actual_TCP_pose" | "target_TCP_pose" => Value::Vector6(pose_m(&arm.base_from_tcp())),
        "tcp_offset" => Value::Vector6(pose_m(&arm.flange_from_tcp)),
        "actual_TCP_speed" | "target_TCP_speed" => {
            let [x, y, z] = arm.velocity_mm_s.map(|value| value / 1000.0).into();
            let [rx, ry, rz] = arm.turning_rad_s.into();
            Value::Vector6([x, y, z, rx, ry, rz])
        }
        "target_qd"
        | "target_qdd"
        | "target_current"
        | "target_moment"
        | "actual_qd"
        | "actual_current"
        | "actual_current_window"
        | "joint_control_output"
        | "actual_TCP_force"
        | "joint_temperatures"
        | "actual_joint_voltage"
        | "ft_raw_wrench"
        | "payload_inertia" => STILL,
        "elbow_position" | "elbow_velocity" | "actual_tool_accelerometer" | "payload_cog" => Value::Vector3([0.0; 3]),
        "joint_mode" => Value::Vector6I32([JOINT_MODE_RUNNING; 6]),
        "robot_mode" => Value::I32(ROBOT_MODE_RUNNING),
        "safety_mode" | "safety_status" => Value::I32(SAFETY_MODE_NORMAL),
        "runtime_state" => Value::U32(if arm.is_running { 2 } else { 1 }),
        // Power is on; and a program runs.
        "robot_status_bits" => Value::U32(1 | (u32::from(arm.is_running) << 1)),
        "safety_status_bits" => Value::U32(1),
        "speed_scaling" | "target_speed_fraction" => Value::F64(1.0),
        "actual_execution_time"
        | "actual_momentum"
        | "actual_main_voltage"
        | "actual_robot_voltage"
        | "actual_robot_current"
        | "standard_analog_input0"
        | "standard_analog_input1"
        | "standard_analog_output0"
        | "standard_analog_output1"
        | "io_current"
        | "tool_analog_input0"
        | "tool_analog_input1"
        | "tool_output_current"
        | "tool_temperature"
        | "tcp_force_scalar"
        | "payload" => Value::F64(0.0),
        "actual_digital_input_bits" | "actual_digital_output_bits" => Value::U64(0),
        "analog_io_types"
        | "tool_mode"
        | "tool_analog_input_types"
        | "script_control_line"
        | "output_bit_registers0_to_31"
        | "output_bit_registers32_to_63" => Value::U32(0),
        "tool_output_voltage" | "time_scale_source" => Value::I32(0),
        "tool_output_mode" => Value::U8(0),
        _ => return None,
    })
}

fn register(arm: &ArmReport, kind: &str, number: usize) -> Option<Value> {
    match kind {
        "output_int_register" => arm.registers.get(number).map(|value| Value::I32(*value)),
        "input_int_register" => (number < arm.registers.len()).then_some(Value::I32(0)),
        "output_double_register" | "input_double_register" => (number < arm.registers.len()).then_some(Value::F64(0.0)),
        "output_bit_register" | "input_bit_register" => (64..128).contains(&number).then_some(Value::U8(0)),
        _ => None,
    }
}

fn input_type(name: &str) -> &'static str {
    let starts = |prefix: &str| name.starts_with(prefix);
    match name {
        "speed_slider_mask" | "input_bit_registers0_to_31" | "input_bit_registers32_to_63" => "UINT32",
        "speed_slider_fraction" => "DOUBLE",
        "external_force_torque" => "VECTOR6D",
        _ if starts("standard_analog_output_") && !name.ends_with("mask") && !name.ends_with("type") => "DOUBLE",
        _ if starts("standard_") || starts("configurable_digital_output") || starts("tool_digital_output") => "UINT8",
        _ if starts("input_int_register_") => "INT32",
        _ if starts("input_double_register_") => "DOUBLE",
        _ if starts("input_bit_register_") => "BOOL",
        _ => NOT_FOUND,
    }
}
