//! The settings of ROS 2 bags: topics, frames, what becomes a capture, and how poses and profiles find each other.

use egui::Ui;

use crate::session::import::ImportOptions;
use crate::session::import::bag::{Bag, BagOptions, Clock, MessageKind, ProfileAxes, Taking, Topic};
use crate::session::table::number::parse_number;
use crate::text::import as import_words;
use crate::text::import_bag as words;
use crate::ui::theme;

use super::fields;
use super::settings::Set;

/// What is being typed.
#[derive(Debug, Default)]
pub struct Typed {
    base_frame: Text,
    flange_frame: Text,
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
pub fn show(ui: &mut Ui, bag: &Bag, current: &ImportOptions, typed: &mut Typed, set: Set<'_>) {
    let options = &current.bag;
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
        let base = options.base_frame.as_deref().unwrap_or_default();
        if let Some(frame) = typed.base_frame.row(ui, words::BASE_FRAME, base) {
            set(&|options| options.base_frame = Some(frame.clone()).filter(|frame| !frame.is_empty()));
        }
        let flange = options.flange_frame.as_deref().unwrap_or_default();
        if let Some(frame) = typed.flange_frame.row(ui, words::FLANGE_FRAME, flange) {
            set(&|options| options.flange_frame = Some(frame.clone()).filter(|frame| !frame.is_empty()));
        }
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
    }
    if let Some(number) = typed.pair_within.number_row(ui, words::PAIR_WITHIN, options.pair_within_ms) {
        set(&|options| options.pair_within_ms = number);
    }
    let clocks = [Clock::Header, Clock::Recording];
    if let Some(clock) = fields::row_choice(ui, words::CLOCK, options.clock, &clocks, |c| words::clock(c).to_owned()) {
        set(&|options| options.clock = clock);
    }
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
