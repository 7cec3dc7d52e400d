//! Why an edit cannot be made: what was found, what was needed.

use thiserror::Error;

use super::Place;

/// Why an edit cannot be made; the session stays as it was.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EditRefusal {
    /// There is no such station or capture (any more).
    #[error("found no capture {} of station {}; it may have been removed", place.capture_idx + 1, place.station_idx + 1)]
    NoSuchPlace {
        /// Where it was looked for.
        place: Place,
    },
    /// A label that another station has.
    #[error("found the label \"{label}\" twice; each station needs one of its own")]
    LabelTaken {
        /// The label.
        label: String,
    },
    /// A label that cannot be shown.
    #[error("found a label that is empty or runs over a line's end; type some text on one line")]
    LabelUnusable,
    /// A number outside its limits.
    #[error("found {found}, needed {expected}")]
    OutOfRange {
        /// The number.
        found: f64,
        /// What it may be.
        expected: String,
    },
    /// An order that is none.
    #[error("found an order of {found} stations, needed each of the {needed} once")]
    NotAnOrder {
        /// How many it lists.
        found: usize,
        /// How many there are.
        needed: usize,
    },
    /// The numbers of a pose cannot be read in the other way.
    #[error("station {label}: {problem}")]
    NotAPose {
        /// The station.
        label: String,
        /// Why.
        problem: crate::geometry::notation::NotAPose,
    },
    /// A station without a pose and a reading.
    #[error("found station \"{label}\" without captures, needed a pose with what was measured there")]
    NoCaptures {
        /// The station.
        label: String,
    },
    /// A camera's sequence that is no folder beside the session.
    #[error("found the folder \"{found}\", needed that of a sequence, relative to the session's file")]
    NotASequence {
        /// The folder.
        found: String,
    },
    /// An RGB-D session has a sequence in place of stations.
    #[error("found a session of an RGB-D camera, which has no stations")]
    NoStationsHere,
    /// There is no such further target (any more).
    #[error("found no further target {}; it may have been removed", further_idx + 1)]
    NoSuchFurther {
        /// Where it was looked for.
        further_idx: usize,
    },
    /// There is no such station of a further target (any more).
    #[error("found no station {} of the further target {name}; it may have been removed", station_idx + 1)]
    NoSuchFurtherStation {
        /// The further target.
        name: String,
        /// Where the station was looked for.
        station_idx: usize,
    },
    /// A name that another further target has.
    #[error("found the name \"{name}\" twice; each further target needs one of its own")]
    NameTaken {
        /// The name.
        name: String,
    },
    /// Imported stations say which edge of a plate they saw, and the session is about something else.
    #[error(
        "found {num_stations} stations with an edge of a plate, needed a session of a right-angle plate; choose the plate as the target, or ignore the column edge"
    )]
    EdgesWithoutPlate {
        /// How many.
        num_stations: usize,
    },
    /// A sequence cannot stand beside other targets.
    #[error("found a sequence of an RGB-D camera as a further target, needed a target with stations")]
    NoSequenceAsFurther,
    /// Something known that a target of this kind does not have.
    #[error("found {field}, which a target of this kind does not have; needed {needed}")]
    NotKnownOfThis {
        /// The field, as the file names it.
        field: &'static str,
        /// What such a target has.
        needed: &'static str,
    },
}
