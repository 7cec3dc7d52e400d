//! ROS 2 bags: the topics that there are with what comes of them, and the settings: topics, frames, what becomes a capture,
//! and how poses and profiles find each other.

use egui::{Align2, Frame, Margin, ScrollArea, Ui};

use crate::session::import::bag::{
    Bag, BagOptions, BagReport, Clock, ListedFrame, MessageKind, ProfileAxes, Taking, Topic,
};
use crate::session::import::{ImportOptions, Imported, Note};
use crate::session::table::number::parse_number;
use crate::text::import as import_words;
use crate::text::import_bag as words;
use crate::ui::compare::table::RowCells;
use crate::ui::{theme, widgets};

use super::fields;
use super::settings::Set;

/// Parts of a row of the topics: name, type, messages, first, last, what it gives.
const TOPIC_PARTS: [f32; 6] = [0.26, 0.2, 0.12, 0.11, 0.11, 0.2];
/// Rows of topics in sight at once.
const MOST_TOPICS: f32 = 6.5;

/// What is being typed.
#[derive(Debug, Default)]
pub struct Typed {
    /// The frames of the bag as they were listed last: where two that do not hang together are chosen, nothing is read.
    frames: Vec<ListedFrame>,
    pair_within: Text,
    still_for: Text,
    still_within_mm: Text,
    still_within_deg: Text,
}

/// A text as it is typed, and what it was when it was last taken from the options.
#[derive(Debug, Default)]
struct Text {
    typed: String,
    shown: String,
}

impl Text {
    /// Draws the row; answers what was typed once the field is left.
    fn row(&mut self, ui: &mut Ui, label: &str, value: &str) -> Option<String> {
        if self.shown != value {
            value.clone_into(&mut self.shown);
            value.clone_into(&mut self.typed);
        }
        let response = fields::row(ui, label, |ui| {
            let width = ui.available_width();
            fields::text_field(ui, &import_words::setting(label), "", &mut self.typed, width)
        });
        (response.lost_focus() && self.typed.trim() != self.shown).then(|| self.typed.trim().to_owned())
    }

    /// A number that cannot be negative; what is none stays as it was typed, and says why.
    fn number_row(&mut self, ui: &mut Ui, label: &str, value: f64) -> Option<f64> {
        let typed = self.row(ui, label, &value.to_string());
        match parse_number(&self.typed) {
            Ok(number) if number >= 0.0 => typed.map(|_| number),
            Ok(_) => {
                warn(ui, words::NEGATIVE);
                None
            }
            Err(problem) => {
                warn(ui, &problem.to_string());
                None
            }
        }
    }
}

fn warn(ui: &mut Ui, problem: &str) {
    ui.label(egui::RichText::new(format!("! {problem}")).color(theme::palette(ui).warn).small());
}

/// Draws the settings of a bag.
pub fn show(
    ui: &mut Ui,
    bag: &Bag,
    imported: Option<&Imported>,
    current: &ImportOptions,
    typed: &mut Typed,
    set: Set<'_>,
) {
    let options = &current.bag;
    let report = imported.and_then(report_of);
    if let Some(report) = report {
        typed.frames.clone_from(&report.listed_frames);
    }
    let mut set = |change: &dyn Fn(&mut BagOptions)| set(&|options: &mut ImportOptions| change(&mut options.bag));
    fields::heading(ui, words::BAG);
    if let Some(name) = topic(ui, words::POSE_TOPIC, bag, true, options.pose_topic.as_deref()) {
        // Frames belong to the topic they were found in.
        set(&|options| {
            options.pose_topic = Some(name.clone());
            (options.base_frame, options.flange_frame) = (None, None);
        });
    }
    let pose_kind = bag.topics.iter().find(|topic| Some(&topic.name) == options.pose_topic.as_ref());
    if pose_kind.is_some_and(|topic| topic.kind == Some(MessageKind::Transforms)) {
        if let Some(frame) = frame(ui, words::BASE_FRAME, &typed.frames, options.base_frame.as_deref()) {
            set(&|options| options.base_frame = Some(frame.clone()));
        }
        if let Some(frame) = frame(ui, words::FLANGE_FRAME, &typed.frames, options.flange_frame.as_deref()) {
            set(&|options| options.flange_frame = Some(frame.clone()));
        }
    } else if let Some(frame) = report.and_then(|report| report.pose_frame.as_deref()) {
        fields::remark(ui, &words::pose_frame(frame));
    }
    if let Some(name) = topic(ui, words::PROFILE_TOPIC, bag, false, options.profile_topic.as_deref()) {
        set(&|options| {
            options.profile_topic = Some(name.clone());
            options.axes = None;
        });
    }
    let all = ProfileAxes::all().map(Some);
    let named = |axes: Option<ProfileAxes>| axes.map_or_else(|| words::NO_TOPIC.to_owned(), |axes| axes.to_string());
    if let Some(axes) = fields::row_choice(ui, words::AXES, options.axes, &all, named) {
        set(&|options| options.axes = axes);
    }
    let takings = [Taking::SettledMedian, Taking::SettledFirst, Taking::EveryProfile];
    let taking = options.taking.unwrap_or(Taking::SettledMedian);
    if let Some(taking) = fields::row_choice(ui, words::TAKING, taking, &takings, |t| words::taking(t).to_owned()) {
        set(&|options| options.taking = Some(taking));
    }
    if taking != Taking::EveryProfile {
        if let Some(number) = typed.still_for.number_row(ui, words::STILL_FOR, options.still_for_s) {
            set(&|options| options.still_for_s = number);
        }
        if let Some(number) = typed.still_within_mm.number_row(ui, words::STILL_WITHIN_MM, options.still_within_mm) {
            set(&|options| options.still_within_mm = number);
        }
        if let Some(number) = typed.still_within_deg.number_row(ui, words::STILL_WITHIN_DEG, options.still_within_deg) {
            set(&|options| options.still_within_deg = number);
        }
        let mut joins_stays = options.joins_stays;
        if ui.checkbox(&mut joins_stays, words::JOIN).on_hover_text(words::JOIN_HINT).changed() {
            set(&|options| options.joins_stays = joins_stays);
        }
    }
    if let Some(number) = typed.pair_within.number_row(ui, words::PAIR_WITHIN, options.pair_within_ms) {
        set(&|options| options.pair_within_ms = number);
    }
    let clocks = [Clock::Header, Clock::Recording];
    if let Some(clock) = fields::row_choice(ui, words::CLOCK, options.clock, &clocks, |c| words::clock(c).to_owned()) {
        set(&|options| options.clock = clock);
    }
}

/// What became of the bag's messages.
pub fn report_of(imported: &Imported) -> Option<&BagReport> {
    imported.notes.iter().find_map(|note| match note {
        Note::Bag(report) => Some(&**report),
        _ => None,
    })
}

/// The topics, and what will come of the bag.
pub fn overview(ui: &mut Ui, bag: &Bag, imported: Option<&Imported>) {
    let report = imported.and_then(report_of);
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, words::TIMES_FROM).small());
    };
    widgets::card(ui, words::TOPICS, right, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let widths = TOPIC_PARTS.map(|part| part * ui.available_width());
        let mut head = RowCells::new(ui, theme::ROW_HEIGHT);
        for (idx, (width, name)) in widths.iter().zip(words::TOPIC_COLUMNS).enumerate() {
            let is_number = (2..5).contains(&idx);
            head.head(*width, name, if is_number { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER });
        }
        let most = MOST_TOPICS * theme::ROW_HEIGHT;
        ScrollArea::vertical().id_salt("bag topics").max_height(most).auto_shrink([false, true]).show(ui, |ui| {
            for topic in &bag.topics {
                topic_row(ui, topic, bag.start_ns(), &widths, report);
            }
        });
        let (Some(imported), Some(report)) = (imported, report) else { return };
        Frame::new().inner_margin(Margin::symmetric(12, 6)).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            let palette = *theme::palette(ui);
            let captures: usize = imported.stations.iter().map(|station| station.captures.len()).sum();
            let is_any = captures > 0;
            let (mark, color) = if is_any { ("✔", palette.good) } else { ("!", palette.warn) };
            fields::marked(ui, mark, color, &words::will_become(report, imported.stations.len(), captures));
            let note = import_words::note(&Note::Bag(Box::new(report.clone())));
            fields::marked(ui, "·", palette.text_dim, &note);
        });
    });
}

fn topic_row(ui: &mut Ui, topic: &Topic, start_ns: Option<i64>, widths: &[f32; 6], report: Option<&BagReport>) {
    let is_in_use = report
        .is_some_and(|report| report.pose_topic == topic.name || report.profile_topic.as_ref() == Some(&topic.name));
    let cells = RowCells::new(ui, theme::ROW_HEIGHT);
    let mut cells = if topic.kind.is_none() { cells.faded() } else { cells };
    if is_in_use {
        let rect = cells.rect();
        let selected = theme::palette(cells.ui()).selected;
        cells.ui().painter().rect_filled(rect.shrink2(egui::vec2(1.0, 0.5)), 0.0, selected);
    }
    let color =
        if topic.kind.is_none() { theme::palette(cells.ui()).text_dim } else { theme::palette(cells.ui()).text };
    cells.text(widths[0], &topic.name);
    cells.text(widths[1], words::short_type(&topic.type_name));
    cells.word(widths[2], &topic.num_messages.to_string(), color);
    for (end, width) in widths[3..5].iter().enumerate() {
        let time = topic.recorded_ns.zip(start_ns).map(|(times, start_ns)| words::seconds(times[end], start_ns));
        cells.word(*width, time.as_deref().unwrap_or("–"), color);
    }
    cells.text(widths[5], &words::gives_in_table(topic.kind, is_in_use));
}

/// The list of frames, each with its parent; answers another one that was picked.
fn frame(ui: &mut Ui, label: &str, frames: &[ListedFrame], current: Option<&str>) -> Option<String> {
    let choices: Vec<Option<usize>> = (0..frames.len()).map(Some).collect();
    let place = current.and_then(|name| frames.iter().position(|frame| frame.name == name));
    let named = |idx: Option<usize>| match idx.and_then(|idx| frames.get(idx)) {
        Some(frame) => words::frame_choice(frame),
        None => current.unwrap_or(words::NO_TOPIC).to_owned(),
    };
    let picked = fields::row_choice(ui, label, place, &choices, named)??;
    frames.get(picked).map(|frame| frame.name.clone())
}

/// The list of topics with poses, or with profiles; answers another one that was picked.
fn topic(ui: &mut Ui, label: &str, bag: &Bag, poses: bool, current: Option<&str>) -> Option<String> {
    let topics: Vec<&Topic> = bag.topics_with(poses).collect();
    let choices: Vec<Option<usize>> = (0..topics.len()).map(Some).collect();
    let current = current.and_then(|name| topics.iter().position(|topic| topic.name == name));
    let named = |idx: Option<usize>| match idx.and_then(|idx| topics.get(idx)) {
        Some(topic) => format!("{} ({})", topic.name, topic.num_messages),
        None => words::NO_TOPIC.to_owned(),
    };
    let picked = fields::row_choice(ui, label, current, &choices, named)??;
    topics.get(picked).map(|topic| topic.name.clone())
}
