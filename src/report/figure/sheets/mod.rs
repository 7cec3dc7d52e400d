//! Which plots stand on a page: one figure or a few for each question, from what was computed of a session.

mod arcs;
mod bars;
mod findings;
mod methods;
mod other_data;
mod reliance;
mod sequence;
mod setup;
mod sheet;
mod space;
mod workpiece;

use crate::report::evidence::Evidence;
use crate::text::figures as words;

use super::Figure;

/// The figures that the data allow, in the order of a report: the set-up, what was measured, what the methods made of it, how
/// far that can be relied on, what it is worth on other data, and the parts that were scanned.
#[must_use]
pub fn figures_of(evidence: &Evidence) -> Vec<Figure> {
    let mut figures = setup::figures(evidence);
    let has_several = evidence.targets.len() > 1;
    for (target, number) in evidence.targets.iter().zip(1..) {
        let makers = [sequence::figures, arcs::figures, methods::figures, reliance::figures, findings::figures];
        let of_target = makers.into_iter().flat_map(|make| make(target));
        figures.extend(of_target.map(|mut figure| {
            if has_several {
                figure.id = format!("target-{number}-{}", figure.id);
                figure.title = words::of_target(&figure.title, &target.name);
                figure.alt = words::of_target(&figure.alt, &target.name);
            }
            figure
        }));
    }
    figures.extend(evidence.verification.iter().flat_map(other_data::figures));
    let has_several = evidence.parts.len() > 1;
    for (part, number) in evidence.parts.iter().zip(1..) {
        figures.extend(workpiece::figures(part).into_iter().map(|mut figure| {
            if has_several {
                figure.id = format!("part-{number}-{}", figure.id);
            }
            figure
        }));
    }
    figures
}
