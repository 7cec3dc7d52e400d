//! What to do next at every moment: a sentence, with the button that does it.

use crate::app::cell::{Activity, CellCommand, CellView};
use crate::device::{LinkState, Readiness, SensorKind};
use crate::session::{Edge, Target};
use crate::text::capture as words;
use crate::text::capture_edges as words_of_edges;

use super::memory::CellMemory;
use super::model::{View, is_run_over};

/// Something that a button of the panel asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Deed {
    /// A command for the cell.
    Cell(CellCommand),
    /// A session for the ball of the radius in the field.
    NewSession,
    /// To type an address: the name of the field.
    Enter(&'static str),
    /// To see the settings of the mounting.
    ShowMounting,
    /// To use the mounting that was given for another robot.
    KeepMounting,
    /// To go to the comparison.
    Compare,
}

/// What to do next, in a sentence, with one button that stands out, and another one beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Next {
    /// The sentence.
    pub sentence: String,
    /// What the primary button says and does.
    pub button: Option<(&'static str, Deed)>,
    /// What can be done as well, or instead.
    pub other: Option<(&'static str, Deed)>,
}

impl Next {
    fn wait(sentence: impl Into<String>) -> Self {
        Self { sentence: sentence.into(), button: None, other: None }
    }

    fn offer(sentence: impl Into<String>, label: &'static str, deed: Deed) -> Self {
        Self { button: Some((label, deed)), ..Self::wait(sentence) }
    }

    fn command(sentence: impl Into<String>, label: &'static str, command: CellCommand) -> Self {
        Self::offer(sentence, label, Deed::Cell(command))
    }

    fn or(self, label: &'static str, deed: Deed) -> Self {
        Self { other: Some((label, deed)), ..self }
    }

    /// After a run nobody may think of the switch any more.
    fn reminding_of_switch(self, cell: &CellView) -> Self {
        if cell.run.is_none() || !cell.is_armed {
            return self;
        }
        let sentence = words::now::still_armed(&self.sentence);
        Self { sentence, ..self.or(words::DISARM, Deed::Cell(CellCommand::Arm(false))) }
    }
}

/// The one obvious next thing at this moment: for an operator in gloves.
#[must_use]
pub fn next(view: &View<'_>, memory: &CellMemory) -> Next {
    let cell = view.cell;
    if let Some(next) = next_while_running(view).or_else(|| next_connection(view, memory)) {
        return next;
    }
    if is_run_over(cell) && cell.proposal.is_none() {
        return Next::offer(words::now::COMPARE, words::COMPARE, Deed::Compare).reminding_of_switch(cell);
    }
    let Some(target) = view.target() else {
        let sentence = if view.session.is_some() { words::now::OTHER_TARGET } else { words::now::SESSION };
        return Next::offer(sentence, words::NEW_SESSION, Deed::NewSession);
    };
    let Some(live) = &cell.live else { return Next::wait(words::now::PROFILE) };
    let readiness = cell.robot.latest.as_ref().map(|report| &report.readiness);
    if let Some(Readiness::NotReady { found, remedy }) = readiness {
        return Next::wait(words::not_ready(found, remedy));
    }
    if let Some(problem) = view.problems().first() {
        return Next::wait(words::now::settings(problem.sentence));
    }
    if let Some(proposal) = &cell.proposal {
        return match (&proposal.refusal, cell.is_armed) {
            (_, false) => Next::command(words::now::ARM_FOR_PROPOSAL, words::ARM, CellCommand::Arm(true)),
            (None, true) => Next::command(words::now::ACCEPT, words::ACCEPT, CellCommand::AcceptProposal),
            (Some(_), true) => Next::command(words::now::SKIP, words::ANOTHER, CellCommand::SkipProposal),
        };
    }
    if live.found.is_err() {
        return Next::wait(words::now::jog(target));
    }
    if readiness == Some(&Readiness::ReadOnly) {
        let sentence = words::now::capture(target, cell.settings.edge);
        return Next::command(sentence, words::capture_name(target), CellCommand::CaptureStation);
    }
    if view.doubts_mounting() {
        return Next::offer(words::OTHER_MOUNTING, words::KEEP_MOUNTING, Deed::KeepMounting)
            .or(words::SET_MOUNTING, Deed::ShowMounting);
    }
    if view.num_stations() > 0 && !view.knows_mounting() {
        return Next::offer(words::now::MOUNT, words::SET_MOUNTING, Deed::ShowMounting);
    }
    if let Some(edge) = view.edge_to_begin() {
        return begin_edge(cell, edge);
    }
    if !cell.is_armed {
        return Next::command(words::now::arm(target), words::ARM, CellCommand::Arm(true));
    }
    if view.knows_mounting() {
        let start = CellCommand::StartRun { num_stations: memory.num_stations.0 };
        return Next::command(words::now::RUN, words::START_RUN, start).reminding_of_switch(cell);
    }
    if view.is_plate() {
        let sentence = words::now::capture(target, cell.settings.edge);
        return Next::command(sentence, words::capture_name(target), CellCommand::CaptureStation);
    }
    if *target == Target::Point {
        return Next::command(words_of_edges::READY_TO_FIND, words_of_edges::FIND, CellCommand::FindTip)
            .reminding_of_switch(cell);
    }
    Next::command(words::now::FIND, words::FIND, CellCommand::FindLargestArc).reminding_of_switch(cell)
}

/// The first capture of an edge is taken where the operator has brought the line onto it.
fn begin_edge(cell: &CellView, edge: Edge) -> Next {
    if cell.settings.edge == edge {
        let sentence = words::now::first_on_edge(edge);
        return Next::command(sentence, words::capture_name(&Target::RightAnglePlate), CellCommand::CaptureStation);
    }
    let sentence = words::now::other_edge(edge);
    if cell.is_practice {
        return Next::command(sentence, words_of_edges::jog_to(edge), CellCommand::JogToEdge(edge));
    }
    Next::wait(sentence)
}

fn next_while_running(view: &View<'_>) -> Option<Next> {
    let cell = view.cell;
    if let Some(replay) = cell.replay {
        let told = if replay.is_over { None } else { replay_words(view) };
        let sentence = told.unwrap_or_else(|| words::REPLAY_OVER.to_owned());
        return Some(Next::command(sentence, words::END_REPLAY, CellCommand::EndReplay));
    }
    if let Some(run) = cell.run {
        if run.is_asking {
            let is_refused = cell.proposal.as_ref().is_some_and(|proposal| proposal.refusal.is_some());
            return Some(if is_refused {
                Next::command(words::now::SKIP, words::ANOTHER, CellCommand::SkipProposal)
            } else {
                Next::command(words::now::ACCEPT, words::ACCEPT, CellCommand::AcceptProposal)
            });
        }
        // While the next step is worked out, nothing moves either.
        if run.is_paused && matches!(cell.activity, Activity::Idle | Activity::Thinking) {
            return Some(Next::command(words::now::RESUME, words::RESUME, CellCommand::ResumeRun));
        }
    }
    let waits_for_file = cell.activity == Activity::Settling && cell.watched_folder.is_some();
    let told = if waits_for_file { Some(words::SETTLING_BY_FOLDER) } else { activity(cell.activity) };
    Some(Next::wait(told?))
}

const fn activity(activity: Activity) -> Option<&'static str> {
    match activity {
        Activity::Idle => None,
        Activity::Moving => Some(words::MOVING),
        Activity::Settling => Some(words::SETTLING),
        Activity::Thinking => Some(words::THINKING),
        Activity::Stopping => Some(words::STOPPING),
    }
}

/// Where the replay is, in words.
#[must_use]
pub fn replay_words(view: &View<'_>) -> Option<String> {
    let replay = view.cell.replay?;
    let station = view.session?.stations.get(replay.station_idx)?;
    Some(words::replaying(&station.label, replay.capture_idx + 1, station.captures.len()))
}

fn next_connection(view: &View<'_>, memory: &CellMemory) -> Option<Next> {
    let cell = view.cell;
    let (robot, sensor) = (&cell.robot.state, &cell.sensor.state);
    let again = |sentence, command: Option<CellCommand>| match command.filter(|_| !cell.is_practice) {
        Some(command) => Next::command(sentence, words::RETRY, command),
        None => Next::wait(sentence),
    };
    // Why is told where the link is.
    if matches!(robot, LinkState::Failed { .. }) {
        return Some(again(words::now::ROBOT_FAILED, cell.robot.setup.clone().map(CellCommand::ConnectRobot)));
    }
    if matches!(sensor, LinkState::Failed { .. }) {
        return Some(again(words::now::PROFILER_FAILED, cell.sensor.setup.clone().map(CellCommand::ConnectSensor)));
    }
    if [robot, sensor].into_iter().any(|state| *state == LinkState::Connecting) {
        return Some(Next::wait(words::now::CONNECTING));
    }
    if *robot == LinkState::Off {
        let is_nothing_connected = *sensor == LinkState::Off;
        let next = if let Some(setup) = memory.robot_to_connect() {
            Next::command(words::now::CONNECT_ROBOT, words::CONNECT_ROBOT, CellCommand::ConnectRobot(setup))
        } else {
            let sentence = if is_nothing_connected { words::now::BEGIN } else { words::now::ENTER_ROBOT };
            Next::offer(sentence, words::CONNECT_ROBOT, Deed::Enter(words::ROBOT_HOST))
        };
        let practise = Deed::Cell(CellCommand::Practise(None));
        return Some(if is_nothing_connected { next.or(words::PRACTISE_SHORT, practise) } else { next });
    }
    if *sensor == LinkState::Off {
        let Some(setup) = memory.sensor_to_connect() else {
            let is_folder = memory.sensor_kind == SensorKind::Folder;
            let field = if is_folder { words::FOLDER } else { words::PROFILER_HOST };
            return Some(Next::offer(words::now::ENTER_PROFILER, words::CONNECT_PROFILER, Deed::Enter(field)));
        };
        let command = CellCommand::ConnectSensor(setup);
        return Some(Next::command(words::now::CONNECT_PROFILER, words::CONNECT_PROFILER, command));
    }
    None
}
