//! The scans that a session holds: paths of captures over a workpiece, of its own target or of a further one.

use std::sync::Arc;

use crate::calibrate::Mount;
use crate::geometry::Transform;
use crate::scan::ScanCapture;

use super::{Known, Reading, Session, Station, Target};

/// One scan of a session.
#[derive(Clone, Debug)]
pub struct SessionScan {
    /// Its station's label, with the further target's name before it where it is one's.
    pub name: String,
    /// What is known of the part.
    pub known: Known,
    /// Its profiles; poses are inverted for a sensor beside the robot.
    pub captures: Vec<ScanCapture>,
}

impl Session {
    /// All scans in it, enabled stations only; none where no target is a workpiece.
    #[must_use]
    pub fn scans(&self) -> Vec<SessionScan> {
        let own = (self.target == Target::Workpiece).then_some((None, &self.known, &self.stations));
        let further = self.further.iter().filter(|further| further.target == Target::Workpiece);
        let further = further.map(|further| (Some(further.name.as_str()), &further.known, &further.stations));
        own.into_iter()
            .chain(further)
            .flat_map(|(name, known, stations)| scans_of(self.mount, name, known, stations))
            .collect()
    }
}

fn scans_of<'a>(
    mount: Mount,
    target_name: Option<&'a str>,
    known: &'a Known,
    stations: &'a [Station],
) -> impl Iterator<Item = SessionScan> + 'a {
    stations.iter().filter(|station| station.enabled).map(move |station| SessionScan {
        name: match target_name {
            Some(target) if stations.len() > 1 => format!("{target}, {}", station.label),
            Some(target) => target.to_owned(),
            None => station.label.clone(),
        },
        known: *known,
        captures: station
            .captures
            .iter()
            .filter_map(|capture| match &capture.reading {
                Reading::Profile(profile) => Some(ScanCapture {
                    base_from_flange: match mount {
                        Mount::OnFlange => capture.base_from_flange,
                        Mount::Fixed => Transform::from_rigid(capture.base_from_flange.rigid().inverse()),
                    },
                    profile: Arc::clone(profile),
                }),
                Reading::Point(_) => None,
            })
            .collect(),
    })
}
