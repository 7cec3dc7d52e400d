//! The dashboard of a Universal Robots controller: a line to ask, a line to answer.

use crate::device::robot::ur::dashboard::{GREETING, Question};
use crate::device::sim::fault::Fault;
use crate::device::sim::net::Connection;
use crate::device::sim::world::World;

/// Talks to one client.
pub fn serve(world: &World, connection: &mut Connection) {
    let mut goes_on = connection.send(format!("{GREETING}\n").as_bytes());
    while goes_on {
        let Some(line) = connection.receive_line() else { return };
        let question = Question::parse(&line);
        goes_on = connection.send(format!("{}\n", answer(world, &question)).as_bytes()) && question != Question::Quit;
    }
}

fn answer(world: &World, question: &Question) -> String {
    match question {
        Question::RobotMode => "Robotmode: RUNNING".to_owned(),
        Question::SafetyStatus => "Safetystatus: NORMAL".to_owned(),
        Question::IsInRemoteControl => (!world.has(Fault::NotRemote)).to_string(),
        Question::Running => format!("Program running: {}", world.arm().is_running),
        Question::PolyscopeVersion => "URSoftware 5.12.6.1102099 (simulated)".to_owned(),
        Question::SerialNumber => "00000000000".to_owned(),
        Question::Quit => "Disconnected".to_owned(),
        Question::Other(words) => match words.to_ascii_lowercase().as_str() {
            "programstate" => {
                let state = if world.arm().is_running { "PLAYING" } else { "STOPPED" };
                format!("{state} <unnamed>")
            }
            "get robot model" => "UR5".to_owned(),
            "get loaded program" => "No program loaded".to_owned(),
            "stop" => {
                world.stop();
                "Stopped".to_owned()
            }
            _ => format!("could not understand: '{words}'"),
        },
    }
}
