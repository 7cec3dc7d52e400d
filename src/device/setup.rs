//! Which driver at which address.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// A driver for robots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RobotKind {
    /// FANUC with the MAPPDK server: moves, three decimals.
    #[default]
    FanucMappdk,
    /// FANUC's web page `CURPOS.DG`: reads only, two decimals.
    FanucPage,
    /// Universal Robots: RTDE for the pose, `URScript` for motion.
    UniversalRobots,
    /// Any other controller by the text bridge.
    Bridge,
}

impl RobotKind {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 4] = [Self::FanucMappdk, Self::FanucPage, Self::UniversalRobots, Self::Bridge];

    /// The port that an [`Endpoint`] names; further ports of the same protocol keep their distance from it.
    #[must_use]
    pub const fn default_port(self) -> u16 {
        match self {
            Self::FanucMappdk => 18735,
            Self::FanucPage => 80,
            Self::UniversalRobots => 30004,
            Self::Bridge => 27015,
        }
    }
}

/// A driver for profilers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SensorKind {
    /// Keyence LJ-V7000 by its command port.
    #[default]
    KeyenceLjv,
    /// Any other profiler by the text bridge.
    Bridge,
    /// Files that the vendor's software writes into a folder.
    Folder,
}

impl SensorKind {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::KeyenceLjv, Self::Bridge, Self::Folder];

    /// The port that an [`Endpoint`] names; 0 where there is none.
    #[must_use]
    pub const fn default_port(self) -> u16 {
        match self {
            Self::KeyenceLjv => 24691,
            Self::Bridge => 27016,
            Self::Folder => 0,
        }
    }
}

/// Host and port.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Endpoint {
    /// Name or address.
    pub host: String,
    /// The port that stands for the protocol; see [`RobotKind::default_port`].
    pub port: u16,
}

/// A robot to connect to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RobotSetup {
    /// By which driver.
    pub kind: RobotKind,
    /// Where.
    pub endpoint: Endpoint,
}

/// A profiler to connect to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SensorSetup {
    /// By which driver.
    pub kind: SensorKind,
    /// Where; not used by [`SensorKind::Folder`].
    pub endpoint: Endpoint,
    /// The watched folder of [`SensorKind::Folder`].
    pub folder: PathBuf,
    /// Whether z is turned about, so that it grows away from the sensor.
    pub is_z_inverted: bool,
}
