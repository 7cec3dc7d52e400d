//! The capture panel of a plate or a tip: which edge is measured, what is still needed, the simulated pendant.

use super::plural;
use crate::calibrate::Edge;

/// Card.
pub const EDGES: &str = "Edges";
/// Card.
pub const TIP: &str = "Tip";
/// Name of an edge's box, with its captures.
#[must_use]
pub fn choose(edge: &str, count: usize) -> String {
    format!("Line on edge {edge}, {count} capture{}", plural(count))
}
/// In the box.
#[must_use]
pub fn line_on(edge: &str, is_chosen: bool) -> String {
    if is_chosen { format!("Line on edge {edge}") } else { format!("Edge {edge}") }
}
/// On hover.
pub const CHOOSE_HINT: &str =
    "Which edge the next capture is of. The letters are yours to give; keys P and Q choose as well";
/// How many there are, of how many.
#[must_use]
pub fn count(count: usize, fewest: usize) -> String {
    if count < fewest { format!("{count} of {fewest} captures") } else { format!("{count} capture{}", plural(count)) }
}
/// What the two edges lack, p first.
#[must_use]
pub fn needed_on_edges(missing: [usize; 2]) -> String {
    match missing {
        [0, 0] => {
            "Enough for a calibration; more make it better. Spread them along the edges, from other sides.".to_owned()
        }
        [p, 0] => format!("Still needed: {p} on edge p."),
        [0, q] => format!("Still needed: {q} on edge q."),
        [p, q] => format!("Still needed: {p} on edge p and {q} on edge q, from other sides and along the whole edge."),
    }
}
/// What the tip lacks.
#[must_use]
pub fn needed_of_tip(missing: usize) -> String {
    match missing {
        0 => "Enough for a calibration; more make it better. Turn the sensor about all its axes.".to_owned(),
        missing => {
            format!("Still needed: {missing} pose{} with the line on the tip, from other sides.", plural(missing))
        }
    }
}
/// Beside the buttons of the simulated pendant.
pub const PENDANT: &str = "Simulated pendant";
/// On hover.
pub const PENDANT_HINT: &str =
    "At a real cell somebody jogs the robot by its pendant. The simulated one goes there by itself";
/// A button of it.
#[must_use]
pub const fn jog_button(edge: Edge) -> &'static str {
    match edge {
        Edge::P => "to p",
        Edge::Q => "to q",
    }
}
/// Name of the button.
#[must_use]
pub const fn jog_to(edge: Edge) -> &'static str {
    match edge {
        Edge::P => "Jog to edge p",
        Edge::Q => "Jog to edge q",
    }
}
/// In place of the points.
pub const NO_POINTS: &str = "The points of all captures appear here.";
/// The live profile does not show what is to be captured.
pub const NOT_SEEN: &str = "A capture now would not count: see above the profile.";
/// Why no further station is proposed.
pub const BOTH_FIRST: &str =
    "Capture each edge once first: the next stations are turned about these points and moved along the edges.";
/// Button of the search for a tip.
pub const FIND: &str = "Find the tip";
/// On hover.
pub const FIND_HINT: &str =
    "Steps the robot across the tip, sees from the heights of the profiles where it is, and captures it there";
/// Choice of what a run measures.
pub const SEARCHED_TIP: &str = "search the tip";
/// All is ready.
pub const READY_TO_FIND: &str = "Ready to search the tip where the robot stands.";
