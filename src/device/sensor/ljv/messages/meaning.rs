//! What the codes of refusals mean, and what to do.

use super::{code, command};

/// What a code in the header of a reply means, and what to do.
pub(super) fn of_header(code: u8) -> (String, &'static str) {
    match code {
        0x11 => (
            "0x11, the request came too slowly".to_owned(),
            "check the network between this computer and the controller",
        ),
        0x21 | 0x22 => (
            format!("0x{code:02X}, a fixed field of the header has another value"),
            "check that it is an LJ-V7000 controller; an LJ-X8000 speaks a later version",
        ),
        _ => (format!("header code 0x{code:02X}"), "look the code up in the controller's manual"),
    }
}

/// What a code in the body of a reply to a command means, and what to do.
pub(super) fn of_body(command: u8, code: u8) -> (String, &'static str) {
    match (command, code) {
        (_, code::UNDEFINED_COMMAND) => (
            "0x31, it does not know the command".to_owned(),
            "check that it is an LJ-V7000 controller, and bring its firmware up to date",
        ),
        (_, code::COMMAND_LENGTH) => (
            "0x32, the command has another length".to_owned(),
            "check that it is an LJ-V7000 controller, and bring its firmware up to date",
        ),
        (command::GET_PROFILE, code::STATUS) => (
            "0x41, the controller is in the advanced mode or batch mode is on".to_owned(),
            "set the operation mode to high-speed and batch measurement off in LJ-Navigator",
        ),
        (command::SOFTWARE_TRIGGER, code::STATUS) => (
            "0x41, the trigger mode is not external".to_owned(),
            "set the trigger mode to external or continuous in LJ-Navigator, and connect again",
        ),
        (_, code::STATUS) => (
            "0x41, not in this mode or state".to_owned(),
            "set the operation mode to high-speed and batch measurement off, and end other programs' streams",
        ),
        (_, code::PARAMETER) => (
            "0x42, a value is out of its range".to_owned(),
            "check that the controller has one head, and set its program to the factory's values if need be",
        ),
        _ => (
            format!("code 0x{code:02X} (0x{:04X} in the maker's library)", 0x8000 | u16::from(code)),
            "look the code up in the controller's manual",
        ),
    }
}
