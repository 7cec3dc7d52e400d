//! What the window remembers of the cell: where robots and profilers were, a setup a driver, and what is set before motion.

use std::path::PathBuf;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::app::cell::CellSettings;
use crate::device::{Endpoint, RobotKind, RobotSetup, SensorKind, SensorSetup};
use crate::text::cell::make_of_robot;

/// The setups used last, one a driver, and the settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CellMemory {
    /// The driver that is chosen.
    pub robot_kind: RobotKind,
    robots: Vec<RobotSetup>,
    /// The driver that is chosen.
    pub sensor_kind: SensorKind,
    sensors: Vec<SensorSetup>,
    /// What is set before motion.
    pub settings: CellSettings,
    /// The robot that the mounting in the settings was given for; `None` while no robot was there.
    pub mounting_of: Option<RobotSetup>,
    /// Stations of a run.
    pub num_stations: NumStations,
}

/// Stations of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NumStations(pub u16);

impl Default for NumStations {
    fn default() -> Self {
        // As many as the paper measures, and enough for every axis to be turned about.
        Self(8)
    }
}

impl CellMemory {
    /// The setup of the chosen driver, to be edited.
    pub fn robot(&mut self) -> &mut RobotSetup {
        let kind = self.robot_kind;
        let idx = self.robots.iter().position(|setup| setup.kind == kind).unwrap_or_else(|| {
            let endpoint = Endpoint { host: String::new(), port: kind.default_port() };
            self.robots.push(RobotSetup { kind, endpoint });
            self.robots.len() - 1
        });
        &mut self.robots[idx]
    }

    /// Whether the mounting was given for another robot than this one: another make, or at another address.
    #[must_use]
    pub fn has_mounting_of_other(&self, robot: &RobotSetup) -> bool {
        self.mounting_of.as_ref().is_some_and(|known| {
            let is_same_make = known.kind == robot.kind || make_of_robot(known.kind) == make_of_robot(robot.kind);
            !is_same_make || known.endpoint.host.trim() != robot.endpoint.host.trim()
        })
    }

    /// The setup of the chosen driver, to be edited.
    pub fn sensor(&mut self) -> &mut SensorSetup {
        let kind = self.sensor_kind;
        let idx = self.sensors.iter().position(|setup| setup.kind == kind).unwrap_or_else(|| {
            let endpoint = Endpoint { host: String::new(), port: kind.default_port() };
            // On the LJ-V's wire z grows towards the head; whoever writes a bridge or a file mostly has it the other way.
            let is_z_inverted = kind == SensorKind::KeyenceLjv;
            self.sensors.push(SensorSetup { kind, endpoint, folder: PathBuf::new(), is_z_inverted });
            self.sensors.len() - 1
        });
        &mut self.sensors[idx]
    }

    /// The robot to connect to; `None` while its address is missing.
    #[must_use]
    pub fn robot_to_connect(&self) -> Option<RobotSetup> {
        let setup = self.robots.iter().find(|setup| setup.kind == self.robot_kind)?;
        (!setup.endpoint.host.trim().is_empty()).then(|| RobotSetup { endpoint: trimmed(&setup.endpoint), ..*setup })
    }

    /// The profiler to connect to; `None` while its address or folder is missing.
    #[must_use]
    pub fn sensor_to_connect(&self) -> Option<SensorSetup> {
        let setup = self.sensors.iter().find(|setup| setup.kind == self.sensor_kind)?;
        let is_given = match setup.kind {
            SensorKind::Folder => !setup.folder.as_os_str().is_empty(),
            SensorKind::KeyenceLjv | SensorKind::Bridge => !setup.endpoint.host.trim().is_empty(),
        };
        is_given.then(|| SensorSetup { endpoint: trimmed(&setup.endpoint), ..setup.clone() })
    }

    /// Takes the folder that was chosen.
    pub fn watch(&mut self, folder: PathBuf) {
        self.sensor_kind = SensorKind::Folder;
        self.sensor().folder = folder;
    }
}

/// A copied address often brings a blank along.
fn trimmed(endpoint: &Endpoint) -> Endpoint {
    Endpoint { host: endpoint.host.trim().to_owned(), port: endpoint.port }
}

/// Stored as a text of its own: a name that this version does not know costs this, and not all that is remembered.
///
/// # Errors
/// Those of the serializer.
pub fn to_text<S: Serializer>(memory: &CellMemory, serializer: S) -> Result<S::Ok, S::Error> {
    serde_json::to_string(memory).map_err(serde::ser::Error::custom)?.serialize(serializer)
}

/// The other way.
///
/// # Errors
/// Those of the deserializer.
pub fn from_text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<CellMemory, D::Error> {
    let text = String::deserialize(deserializer)?;
    Ok(serde_json::from_str(&text).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::sim::{SimCell, SimOptions};
    use crate::ui::persisted::Persisted;

    #[test]
    fn every_driver_keeps_its_own_address() {
        let mut memory = CellMemory::default();
        assert_eq!(memory.robot_to_connect(), None);
        memory.robot().endpoint.host = " 10.0.0.5 ".to_owned();
        memory.robot_kind = RobotKind::UniversalRobots;
        assert_eq!(memory.robot_to_connect(), None, "another driver, another address");
        assert_eq!(memory.robot().endpoint.port, 30004);
        memory.robot_kind = RobotKind::FanucMappdk;
        let setup = memory.robot_to_connect().expect("its address is kept");
        assert_eq!((setup.endpoint.host.as_str(), setup.endpoint.port), ("10.0.0.5", 18735));
        memory.watch(PathBuf::from("/profiles"));
        assert_eq!(memory.sensor_to_connect().expect("a folder").folder, PathBuf::from("/profiles"));
    }

    #[test]
    fn z_is_turned_about_as_the_simulated_cell_needs_it() {
        for kind in [SensorKind::KeyenceLjv, SensorKind::Bridge] {
            let options = SimOptions { sensor: kind, ..SimOptions::default() };
            let sim = SimCell::start(&options).expect("ports are free");
            let mut memory = CellMemory { sensor_kind: kind, ..CellMemory::default() };
            assert_eq!(memory.sensor().is_z_inverted, sim.sensor_setup.is_z_inverted, "{kind:?}");
        }
    }

    #[test]
    fn what_another_version_has_written_costs_no_more_than_itself() {
        let mut persisted = Persisted { scale: 1.25, ..Persisted::default() };
        persisted.cell.robot().endpoint.host = "robot".to_owned();
        let text = serde_json::to_string(&persisted).expect("plain data");
        let read: Persisted = serde_json::from_str(&text).expect("as written");
        assert_eq!(read, persisted);
        let other = text.replace("fanuc-mappdk", "a-robot-of-tomorrow");
        let read: Persisted = serde_json::from_str(&other).expect("all but the cell");
        assert_eq!((read.scale, read.cell), (1.25, CellMemory::default()));
    }
}
