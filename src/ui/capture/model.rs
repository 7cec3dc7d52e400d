//! What the capture panel shows and offers, made without egui from the live cell and the open session.

use crate::app::cell::{CellCommand, CellSettings, CellView};
use crate::app::{Results, Workbench};
use crate::calibrate::SweepPoint;
use crate::calibrate::verdict::GOOD_UP_TO_MM;
use crate::device::safety::MOST_ROTATION_SPEED_DEG_S;
use crate::device::search::SearchPoint;
use crate::device::{LinkState, Readiness, RobotReport, SearchPhase, SearchReport};
use crate::geometry::{Base, Flange, PoseNotation, Transform};
use crate::plan::{Plan, PlannedStation};
use crate::report::figure::model::{Peak, ball_radius_mm};
use crate::session::{Edge, Reading, Session, Target, sought};
use crate::text::capture as words;
use crate::text::capture_edges as words_of_edges;
use crate::text::capture_settings::{self as words_of_settings, problem};
use crate::ui::widgets::fixed;

/// What the panel is a picture of.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The live cell.
    pub cell: &'a CellView,
    /// The open session.
    pub session: Option<&'a Session>,
    /// Whether some method has a solution, which knows the mounting better than a drawing.
    pub has_solution: bool,
    /// What the next stations will bring; `None` without a plan.
    pub outlook: Option<Outlook>,
    /// Whether the mounting that is remembered was given for another robot than the one that is connected.
    pub has_other_mounting: bool,
    /// What the methods made of the session.
    pub results: Option<&'a Results>,
}

/// So many captures an edge make a calibration that can be trusted ...
pub const FEWEST_ON_EDGE: usize = 6;
/// ... and so many of a tip.
pub const FEWEST_TIPS: usize = 4;

/// How well the calibration is known, and what it takes to be called good.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlook {
    /// σ of the workspace point, mm.
    pub std_mm: f64,
    /// About so many more stations make it good; `None` if the planned ones hardly help.
    pub num_to_good: Option<usize>,
}

impl Outlook {
    /// That of a plan; `None` where it is good already, or cannot be told.
    #[must_use]
    pub fn new(plan: &Plan) -> Option<Self> {
        let std_mm = plan.workspace_point_std_mm.filter(|std_mm| *std_mm > GOOD_UP_TO_MM)?;
        let stds_mm: Vec<f64> =
            plan.stations.iter().map_while(|station: &PlannedStation| station.workspace_point_std_mm).collect();
        let within_plan = stds_mm.iter().position(|std_mm| *std_mm <= GOOD_UP_TO_MM).map(|idx| idx + 1);
        let num_to_good = within_plan.or_else(|| beyond_plan(std_mm, &stds_mm));
        Some(Self { std_mm, num_to_good })
    }
}

/// As many stations as it takes if each of them tells as much as the planned ones do on average.
fn beyond_plan(now_mm: f64, stds_mm: &[f64]) -> Option<usize> {
    /// More than anybody measures.
    const MOST: f64 = 100.0;
    let information = |std_mm: f64| std_mm.powi(-2);
    #[expect(clippy::cast_precision_loss, reason = "a handful of stations")]
    let gain = (information(*stds_mm.last()?) - information(now_mm)) / stds_mm.len() as f64;
    let num = ((information(GOOD_UP_TO_MM) - information(now_mm)) / gain).ceil();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the limits")]
    (1.0..=MOST).contains(&num).then_some(num as usize)
}

impl<'a> View<'a> {
    /// The view of a workbench.
    #[must_use]
    pub fn of(workbench: &'a Workbench) -> Self {
        let has_solution =
            workbench.results().is_some_and(|results| results.methods.iter().any(|method| method.outcome.is_ok()));
        Self {
            cell: workbench.cell(),
            session: workbench.document().map(|document| document.session.as_ref()),
            has_solution,
            outlook: workbench.current_plan().and_then(Outlook::new),
            has_other_mounting: false,
            results: workbench.results(),
        }
    }

    /// Radius of the session's ball, mm; `None` without a session or with another target.
    #[must_use]
    pub fn ball_radius_mm(&self) -> Option<f64> {
        self.session.and_then(ball_radius_mm)
    }

    /// What is wrong with the settings for what is measured here; of a ball if there is no session yet.
    #[must_use]
    pub fn problems(&self) -> Vec<Problem> {
        let is_searched = !self.is_plate();
        let longest_step_mm = is_searched.then(|| self.ball_radius_mm().unwrap_or(f64::INFINITY));
        problems(&self.cell.settings, longest_step_mm, self.cell.robot.latest.as_ref())
    }

    /// The session's target, if a calibration is measured on it.
    #[must_use]
    pub fn target(&self) -> Option<&'a Target> {
        self.session.map(|session| &session.target).filter(|target| sought(target, None).is_some())
    }

    /// Whether that is a right-angle plate.
    #[must_use]
    pub fn is_plate(&self) -> bool {
        self.target() == Some(&Target::RightAnglePlate)
    }

    /// Whether it is a plate or a tip.
    #[must_use]
    pub fn is_of_edges(&self) -> bool {
        matches!(self.target(), Some(Target::RightAnglePlate | Target::Point))
    }

    /// Stations that take part, of an edge or of none.
    #[must_use]
    pub fn num_on(&self, edge: Option<Edge>) -> usize {
        let stations = self.session.map_or(&[][..], |session| &session.stations);
        stations.iter().filter(|station| station.enabled && station.edge == edge).count()
    }

    /// The edge that has no capture yet, while the next stations are proposed by the first of each edge.
    #[must_use]
    pub fn edge_to_begin(&self) -> Option<Edge> {
        let chosen = self.cell.settings.edge;
        let edges = if chosen == Edge::P { [Edge::P, Edge::Q] } else { [Edge::Q, Edge::P] };
        let is_wanted = self.is_plate() && !self.has_solution;
        edges.into_iter().find(|edge| is_wanted && self.num_on(Some(*edge)) == 0)
    }

    /// Stations of the session.
    #[must_use]
    pub fn num_stations(&self) -> usize {
        self.session.map_or(0, |session| session.stations.len())
    }

    /// How the session's robot writes its poses.
    #[must_use]
    pub fn notation(&self) -> PoseNotation {
        self.session.map_or_else(PoseNotation::default, |session| session.robot.notation)
    }

    /// Whether the next stations can be proposed.
    #[must_use]
    pub const fn knows_mounting(&self) -> bool {
        self.has_solution || self.cell.settings.mounting.is_some() && !self.has_other_mounting
    }

    /// Whether somebody has to say first that the mounting is this robot's as well.
    #[must_use]
    pub const fn doubts_mounting(&self) -> bool {
        !self.has_solution && self.cell.settings.mounting.is_some() && self.has_other_mounting
    }

    fn has_profiles(&self) -> bool {
        let stations = self.session.map_or(&[][..], |session| &session.stations);
        stations
            .iter()
            .flat_map(|station| &station.captures)
            .any(|capture| matches!(capture.reading, Reading::Profile(_)))
    }
}

/// Whether something is under way that stop would end.
#[must_use]
pub fn is_running(cell: &CellView) -> bool {
    cell.is_busy() || cell.run.is_some_and(|run| run.is_paused || run.is_asking)
}

/// Whether there is something to stop: a robot that did not say that it stands may still be moving.
#[must_use]
pub fn may_be_moving(cell: &CellView) -> bool {
    is_running(cell) || cell.is_stop_unconfirmed()
}

/// Whether a run has measured all that it was to.
#[must_use]
pub fn is_run_over(cell: &CellView) -> bool {
    !is_running(cell) && cell.run.is_some_and(|run| run.num_done >= run.num_stations)
}

/// Why a command cannot be given now; `None` if it can.
#[must_use]
pub fn refusal(view: &View<'_>, command: &CellCommand) -> Option<&'static str> {
    let cell = view.cell;
    let moves = matches!(
        command,
        CellCommand::FindLargestArc | CellCommand::FindTip | CellCommand::AcceptProposal | CellCommand::StartRun { .. }
    );
    let captures = moves || *command == CellCommand::CaptureStation;
    let proposes = matches!(command, CellCommand::ProposeStation | CellCommand::SkipProposal);
    let is_asked = *command == CellCommand::AcceptProposal || proposes;
    let is_waiting = cell.run.is_some_and(|run| run.is_asking);
    if *command == CellCommand::Arm(true) {
        return refusal_to_move(cell);
    }
    if *command == CellCommand::StartReplay {
        return (if is_running(cell) { Some(words::ROUTINE_RUNS) } else { None })
            .or_else(|| (!view.has_profiles()).then_some(words::NO_PROFILES));
    }
    if matches!(command, CellCommand::JogToEdge(_)) {
        return is_running(cell).then_some(words::ROUTINE_RUNS);
    }
    if !(captures || proposes) {
        return None;
    }
    if cell.replay.is_some() {
        return Some(words::REPLAY_RUNS);
    }
    if is_running(cell) && !(is_asked && is_waiting) {
        return Some(words::ROUTINE_RUNS);
    }
    if cell.robot.state != LinkState::Ready {
        return Some(words::NO_ROBOT);
    }
    if cell.sensor.state != LinkState::Ready && !proposes {
        return Some(words::NO_PROFILER);
    }
    if view.target().is_none() {
        return Some(words::NO_TARGET_SESSION);
    }
    if *command == CellCommand::FindLargestArc && view.ball_radius_mm().is_none() {
        return Some(words::NO_BALL);
    }
    if moves && !view.problems().is_empty() {
        return Some(words::SETTINGS_WRONG);
    }
    if (matches!(command, CellCommand::StartRun { .. }) || proposes) && view.edge_to_begin().is_some() {
        return Some(words_of_edges::BOTH_FIRST);
    }
    if (moves || proposes) && view.doubts_mounting() {
        return Some(words::OTHER_MOUNTING);
    }
    if proposes && !view.knows_mounting() {
        return Some(words::NEEDS_MOUNTING);
    }
    if moves && !cell.is_armed {
        return refusal_to_move(cell).or(Some(words::NOT_ARMED_YET));
    }
    None
}

fn refusal_to_move(cell: &CellView) -> Option<&'static str> {
    if cell.robot.state != LinkState::Ready {
        return Some(words::NO_ROBOT);
    }
    match cell.robot.latest.as_ref().map(|report| &report.readiness) {
        Some(Readiness::ReadOnly) => Some(words::ROBOT_ONLY_READS),
        Some(Readiness::NotReady { remedy, .. }) => Some(remedy),
        _ => None,
    }
}

/// A lamp: its shape says it, its colour only repeats it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamp {
    /// Not wanted.
    Off,
    /// Under way.
    Waiting,
    /// Fine.
    Good,
    /// To be looked at.
    Look,
    /// Broken.
    Bad,
}

/// A link's lamp, its word, and below it what happened and what to do.
#[must_use]
pub fn lamp(state: &LinkState) -> (Lamp, &'static str, Option<String>) {
    match state {
        LinkState::Off => (Lamp::Off, words::OFF, None),
        LinkState::Connecting => (Lamp::Waiting, words::CONNECTING, None),
        LinkState::Ready => (Lamp::Good, words::READY, None),
        LinkState::Failed { error, retry_in } => {
            let again = retry_in.map_or_else(|| words::NOT_AGAIN.to_owned(), words::again_in);
            (Lamp::Bad, words::FAILED, Some(format!("{error}. {again}")))
        }
    }
}

/// The robot's lamp: one that cannot be moved is not called ready.
#[must_use]
pub fn robot_lamp(cell: &CellView) -> (Lamp, &'static str, Option<String>) {
    match (&cell.robot.state, cell.robot.latest.as_ref().map(|report| &report.readiness)) {
        (LinkState::Ready, Some(Readiness::NotReady { remedy, .. })) => {
            (Lamp::Look, words::CONNECTED, Some((*remedy).to_owned()))
        }
        (LinkState::Ready, Some(Readiness::ReadOnly)) => (Lamp::Good, words::CONNECTED, None),
        (state, _) => lamp(state),
    }
}

/// The profiler's lamp.
#[must_use]
pub fn sensor_lamp(cell: &CellView) -> (Lamp, &'static str, Option<String>) {
    match (&cell.sensor.state, &cell.live) {
        (LinkState::Ready, None) => (Lamp::Look, words::NO_PROFILE_YET, None),
        (state, _) => lamp(state),
    }
}

/// Number and unit of every part of a pose in the session's notation, with no more digits than the robot gives.
#[must_use]
pub fn pose_rows(
    notation: &PoseNotation,
    base_from_flange: &Transform<Base, Flange>,
    resolution_mm: f64,
) -> Vec<(String, String)> {
    let decimals = decimals_of(resolution_mm);
    let of_length = decimals_of(resolution_mm / notation.length_unit.in_mm());
    let numbers = notation.numbers(base_from_flange);
    let names = ["x", "y", "z"].into_iter().chain(notation.orientation_names().iter().copied());
    // A degree has about as many digits as a millimetre; radians and parts of a quaternion need two more.
    let (of_angle, unit) = match notation.orientation {
        crate::geometry::notation::OrientationForm::Angles if notation.angle_unit.in_degrees() < 2.0 => {
            (decimals, notation.angle_unit.symbol())
        }
        crate::geometry::notation::OrientationForm::Angles => (decimals + 2, notation.angle_unit.symbol()),
        _ => (decimals + 2, ""),
    };
    names
        .zip(numbers)
        .enumerate()
        .map(|(idx, (name, value))| {
            let value = if idx < 3 {
                format!("{} {}", fixed(value, of_length), notation.length_unit.symbol())
            } else {
                format!("{} {unit}", fixed(value, of_angle))
            };
            (name.to_owned(), value.trim_end().to_owned())
        })
        .collect()
}

/// Decimals that a number in steps of `resolution` has; three where that is not known, as for recorded poses.
fn decimals_of(resolution: f64) -> usize {
    if resolution <= 0.0 {
        return 3;
    }
    let mut decimals = 0;
    let mut step = 1.0;
    while decimals < 6 && step > resolution * 1.5 {
        step /= 10.0;
        decimals += 1;
    }
    decimals
}

/// How far a box of the state machine is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxState {
    /// Not entered.
    Ahead,
    /// Where the search is.
    Now,
    /// Passed.
    Done,
    /// The end, reached as hoped.
    Found,
    /// The end, reached otherwise.
    GaveUp,
}

/// The boxes of the paper's Fig. 3 in the order in which they are drawn.
pub const PHASES: [SearchPhase; 6] = [
    SearchPhase::First,
    SearchPhase::Probe,
    SearchPhase::Reverse,
    SearchPhase::Climb,
    SearchPhase::Pass,
    SearchPhase::Ended,
];

/// How far each of [`PHASES`] is.
#[must_use]
pub fn boxes(search: Option<&SearchReport>) -> [BoxState; 6] {
    let Some(search) = search else { return [BoxState::Ahead; 6] };
    let place = |phase: SearchPhase| PHASES.iter().position(|known| *known == phase).unwrap_or(0);
    let has_turned = search.sign < 0.0;
    // A search that gave up went as far as its captures show.
    let reached = match (search.phase, &search.end) {
        (SearchPhase::Ended, Some(end)) if !end.is_found() => match search.points.len() {
            0 | 1 => place(SearchPhase::First),
            2 => place(SearchPhase::Probe),
            _ if search.curve.is_some() => place(SearchPhase::Pass),
            _ => place(SearchPhase::Climb),
        },
        (phase, _) => place(phase),
    };
    PHASES.map(|phase| {
        let idx = place(phase);
        match (&search.end, phase) {
            (Some(end), SearchPhase::Ended) => {
                if end.is_found() {
                    BoxState::Found
                } else {
                    BoxState::GaveUp
                }
            }
            (_, SearchPhase::Reverse) if search.phase != SearchPhase::Reverse => {
                if has_turned {
                    BoxState::Done
                } else {
                    BoxState::Ahead
                }
            }
            (None, _) if idx == reached => BoxState::Now,
            _ if idx < reached || (search.end.is_some() && idx == reached) => BoxState::Done,
            _ => BoxState::Ahead,
        }
    })
}

/// A search as a curve to draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SearchCurve {
    /// Its steps with an arc.
    pub points: Vec<SweepPoint>,
    /// The curve through them.
    pub peak: Option<Peak>,
    /// Where the published rule would have stopped, mm.
    pub published_stop_mm: Option<f64>,
}

/// The curve of a search.
#[must_use]
pub fn search_curve(search: &SearchReport, ball_radius_mm: f64) -> SearchCurve {
    let peak = search.curve.map(|curve| Peak {
        travel_mm: curve.peak_mm,
        std_mm: curve.peak_std_mm,
        curvature: curve.curvature,
    });
    let point = |(capture_idx, seen): (usize, &SearchPoint)| {
        let [section_radius_mm, section_radius_std_mm] = seen.radius_and_std_mm?;
        let residual_mm =
            peak.map_or(f64::NAN, |peak| section_radius_mm - peak.section_radius_mm(seen.travelled_mm, ball_radius_mm));
        let travel_mm = seen.travelled_mm;
        Some(SweepPoint { capture_idx, travel_mm, section_radius_mm, section_radius_std_mm, residual_mm })
    };
    let published = search.published_stop_idx.and_then(|idx| search.points.get(idx));
    SearchCurve {
        points: search.points.iter().enumerate().filter_map(point).collect(),
        peak,
        published_stop_mm: published.map(|point| point.travelled_mm),
    }
}

/// Something that is wrong with the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Problem {
    /// What, and what to do.
    pub sentence: &'static str,
    /// The names of the fields that it is about.
    pub fields: &'static [&'static str],
}

/// What is wrong with the settings; empty if nothing is. Steps are to be below the ball's radius; without a longest step
/// nothing is searched.
#[must_use]
pub fn problems(settings: &CellSettings, most_step_mm: Option<f64>, robot: Option<&RobotReport>) -> Vec<Problem> {
    const BOX: &[&str] = words_of_settings::SIDES.as_flattened();
    let (search, limits) = (&settings.search, &settings.limits);
    let longest_step_mm = search.step_mm.max(search.coarse_step_mm);
    let has_coarse_steps = search.coarse_step_mm > search.step_mm;
    let longest_step: &[&str] =
        if has_coarse_steps { &[words_of_settings::COARSE_STEP] } else { &[words_of_settings::STEP] };
    let mut found = Vec::new();
    let mut check = |is_wrong: bool, sentence, fields| {
        if is_wrong {
            found.push(Problem { sentence, fields });
        }
    };
    let is_above_cap = |speed_mm_s: f64| speed_mm_s > limits.max_speed_mm_s;
    let [transit, step] = [&[words_of_settings::TRANSIT_SPEED], &[words_of_settings::SEARCH_SPEED]];
    if let Some(most_step_mm) = most_step_mm {
        let has_no_direction = search.direction.iter().all(|part| *part == 0.0);
        check(has_no_direction, problem::NO_DIRECTION, &words_of_settings::PARTS);
        check(search.max_travel_mm < 2.0 * search.step_mm, problem::LITTLE_TRAVEL, &[words_of_settings::MAX_TRAVEL]);
        check(search.coarse_step_mm < search.step_mm, problem::COARSE_IS_FINER, &[words_of_settings::COARSE_STEP]);
        check(longest_step_mm > most_step_mm, problem::STEP_BEYOND_BALL, longest_step);
        check(longest_step_mm > limits.max_move_mm, problem::STEP_TOO_LONG, longest_step);
        check(is_above_cap(limits.search_speed_mm_s), problem::SEARCH_TOO_FAST, step);
    }
    check(is_above_cap(limits.transit_speed_mm_s), problem::TRANSIT_TOO_FAST, transit);
    // Settings that were kept may be from a time when more was allowed.
    let turns_too_fast = limits.max_rotation_speed_deg_s > MOST_ROTATION_SPEED_DEG_S;
    check(turns_too_fast, problem::TURNS_TOO_FAST, &[words_of_settings::TURN_CAP]);
    if let Some(workspace) = &limits.workspace {
        let sides = || workspace.min_mm.iter().zip(&workspace.max_mm);
        let is_empty = sides().any(|(min, max)| min >= max);
        check(is_empty, problem::EMPTY_BOX, BOX);
        let is_outside = robot.is_some_and(|report| {
            let place = report.base_from_flange.translation_mm();
            place.iter().zip(sides()).any(|(place, (min, max))| place < min || place > max)
        });
        check(!is_empty && is_outside, problem::OUTSIDE_BOX, BOX);
    }
    found
}

/// A view that follows what comes 30 times a second without trembling: it stays while it holds what is to be seen and
/// does not waste most of its room.
#[must_use]
pub fn steady(kept: Option<[[f64; 2]; 2]>, wanted: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    /// Room around what is seen when the view is chosen anew, as a part of it.
    const ROOM: f64 = 0.12;
    /// A view so much wider than needed is chosen anew.
    const WASTE: f64 = 1.6;
    let holds = |kept: &[[f64; 2]; 2]| {
        kept.iter().zip(&wanted).all(|(kept, wanted)| {
            kept[0] <= wanted[0] && wanted[1] <= kept[1] && kept[1] - kept[0] <= WASTE * (wanted[1] - wanted[0])
        })
    };
    kept.filter(holds).unwrap_or_else(|| {
        wanted.map(|[low, high]| {
            let room = (high - low) * ROOM;
            [low - room, high + room]
        })
    })
}

#[cfg(test)]
#[path = "model_tests.rs"]
mod tests;
