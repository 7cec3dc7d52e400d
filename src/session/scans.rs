//! The scans that a session holds: paths of captures over a workpiece, of its own target or of a further one.

use std::sync::Arc;

use crate::calibrate::Mount;
use crate::geometry::Transform;
use crate::scan::ScanCapture;

use super::{Known, Reading, Session, Station, Target};

/// A scan of a session, or all scans of a part together.
#[derive(Clone, Debug)]
pub struct SessionScan {
    /// The further target whose part was scanned; the session's own without.
    pub target_name: Option<String>,
    /// The label of its station; none for all scans of the part together.
    pub station_label: Option<String>,
    /// What is known of the part.
    pub known: Known,
    /// Its profiles; poses are inverted for a sensor beside the robot.
    pub captures: Vec<ScanCapture>,
}

impl Session {
    /// All scans in it, of enabled stations only; for a part with several scans, all of them together come first. None where
    /// no target is a workpiece.
    #[must_use]
    pub fn scans(&self) -> Vec<SessionScan> {
        let own = (self.target == Target::Workpiece).then_some((None, &self.known, &self.stations));
        let further = self.further.iter().filter(|further| further.target == Target::Workpiece);
        let further = further.map(|further| (Some(&further.name), &further.known, &further.stations));
        own.into_iter()
            .chain(further)
            .flat_map(|(name, known, stations)| self.scans_of(name, known, stations))
            .collect()
    }

    fn scans_of(&self, target_name: Option<&String>, known: &Known, stations: &[Station]) -> Vec<SessionScan> {
        let scan = |stations: &[&Station], station_label| SessionScan {
            target_name: target_name.cloned(),
            station_label,
            known: *known,
            captures: stations.iter().flat_map(|station| captures_of(self.mount, station)).collect(),
        };
        let used: Vec<&Station> = stations.iter().filter(|station| station.enabled).collect();
        let together = (used.len() > 1).then(|| scan(&used, None));
        let single = used.iter().map(|station| scan(&[*station], Some(station.label.clone())));
        together.into_iter().chain(single).collect()
    }
}

fn captures_of(mount: Mount, station: &Station) -> impl Iterator<Item = ScanCapture> {
    station.captures.iter().filter_map(move |capture| match &capture.reading {
        Reading::Profile(profile) => Some(ScanCapture {
            base_from_flange: match mount {
                Mount::OnFlange => capture.base_from_flange,
                Mount::Fixed => Transform::from_rigid(capture.base_from_flange.rigid().inverse()),
            },
            profile: Arc::clone(profile),
        }),
        Reading::Point(_) | Reading::Pose(_) => None,
    })
}
