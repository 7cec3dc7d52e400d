//! Robot, sensor, target, mount, noise and the stations used.

use crate::report::document::{Block, Fact, Options, SectionId};
use crate::report::evidence::Evidence;
use crate::session::{Session, Station, Target};
use crate::text::conventions::notation_in_full;
use crate::text::report as words;
use crate::text::start;
use crate::text::verify::further_figures;

pub(in crate::report::document) fn blocks(evidence: &Evidence, options: &Options) -> Vec<Block> {
    let session = &evidence.session;
    let Session { robot, sensor, .. } = session;
    let noise = evidence.answer().and_then(|(_, solution)| solution.noise.as_ref());
    let is_estimated = noise.is_some() && options.sections.contains(&SectionId::Validation);
    let mut target = start::target(&session.target);
    let is_centre = evidence.targets.first().is_some_and(|own| !own.uses_radius());
    if matches!(session.target, Target::Ball { .. }) && is_centre {
        target = format!("{target} ({})", words::RADIUS_NOT_USED);
    }
    let or_not_stated =
        |text: &str| if text.trim().is_empty() { words::NOT_STATED.to_owned() } else { text.to_owned() };
    let target_noise = match session.target {
        Target::Pose { translation_std_mm, rotation_std_deg } => {
            let noise = words::pose_noise(translation_std_mm, rotation_std_deg, is_estimated);
            Some(Fact::new(words::TARGET_NOISE, noise))
        }
        // The images say themselves how precise they are.
        Target::Rgbd { .. } => None,
        Target::Ball { .. } | Target::RightAnglePlate | Target::Point | Target::Workpiece => {
            Some(Fact::new(words::SENSOR_NOISE, words::sensor_noise(sensor.profile_std_mm)))
        }
    };
    let mut facts = vec![
        Fact::new(words::ROBOT, or_not_stated(&robot.model)),
        Fact::new(
            words::ROBOT_NOISE,
            words::pose_noise(robot.position_std_mm, robot.orientation_std_deg, is_estimated),
        ),
        Fact::new(words::POSES, notation_in_full(&robot.notation)),
        Fact::new(words::SENSOR, or_not_stated(&sensor.model)),
    ];
    facts.extend(target_noise);
    facts.extend([
        Fact::new(
            words::REFERENCE_DISTANCE,
            sensor
                .reference_distance_mm
                .map_or_else(|| words::NOT_STATED.to_owned(), |distance| format!("{distance} mm")),
        ),
        Fact::new(words::MOUNT, start::mount(session.mount)),
        Fact::new(words::TARGET_FACT, target),
    ]);
    let used = session.stations.iter().filter(|station| station.enabled);
    let num_used = used.clone().count();
    if !matches!(session.target, Target::Rgbd { .. }) {
        facts.push(Fact::new(words::STATIONS_FACT, start::stations_in_use(num_used, session.stations.len())));
        facts.push(Fact::new(words::CAPTURES, used.map(|station| station.captures.len()).sum::<usize>().to_string()));
    }
    let left_out: Vec<&str> = left_out(&session.stations).map(|station| station.label.as_str()).collect();
    if !left_out.is_empty() {
        facts.push(Fact::new(words::LEFT_OUT, left_out.join(", ")));
    }
    for further in &session.further {
        let used = further.stations.iter().filter(|station| station.enabled).count();
        let figures = further_figures(&further.target, used, further.stations.len());
        facts.push(Fact::new(words::of_target(words::FURTHER_TARGET, &further.name), figures));
    }
    for (name, notes) in [(words::NOTES, &session.notes), (words::REMARKS, &options.notes)] {
        if !notes.trim().is_empty() {
            facts.push(Fact::new(name, notes.trim()));
        }
    }
    vec![Block::Facts(facts)]
}

fn left_out(stations: &[Station]) -> impl Iterator<Item = &Station> {
    stations.iter().filter(|station| !station.enabled)
}
