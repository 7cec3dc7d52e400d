//! Going through the frames: by hand, or as they were recorded.

use std::time::Duration;

use egui::{Key, Modifiers, Slider, Ui, WidgetInfo};

use crate::text::sequence as words;
use crate::ui::widgets;

/// Where in the sequence one looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Player {
    /// The frame in sight.
    pub frame_idx: usize,
    /// Since when it plays, in the time of the window, s, and from which time of the sequence on, s.
    playing: Option<[f64; 2]>,
    /// Whether the newest frame is shown while frames are being tracked.
    pub follows: bool,
}

/// Frames that come slower than this are still played in their time, those that come faster are left out, s.
const LEAST_STEP: Duration = Duration::from_millis(15);

impl Player {
    /// At the beginning of a sequence that is about to be tracked.
    pub const fn following() -> Self {
        Self { frame_idx: 0, playing: None, follows: true }
    }

    /// Goes to a frame; stops playing.
    pub const fn go_to(&mut self, frame_idx: usize) {
        *self = Self { frame_idx, playing: None, follows: false };
    }

    /// Moves on while it plays or follows; `times_s` are those of the frames that can be shown.
    pub fn advance(&mut self, ui: &Ui, times_s: &[f64], is_growing: bool) {
        let last_idx = times_s.len().saturating_sub(1);
        if self.follows {
            self.frame_idx = last_idx;
            self.follows = is_growing;
        }
        if let Some([since_s, from_s]) = self.playing {
            let now_s = from_s + ui.input(|input| input.time) - since_s;
            self.frame_idx = times_s.partition_point(|time_s| *time_s <= now_s).saturating_sub(1);
            match times_s.get(self.frame_idx + 1) {
                Some(next_s) => {
                    let wait = Duration::try_from_secs_f64(next_s - now_s).unwrap_or_default();
                    ui.ctx().request_repaint_after(wait.max(LEAST_STEP));
                }
                None => self.playing = None,
            }
        }
        self.frame_idx = self.frame_idx.min(last_idx);
    }

    /// Begins to play, from the start where it is at the end; or stops.
    fn toggle(&mut self, ui: &Ui, times_s: &[f64]) {
        self.follows = false;
        if self.playing.take().is_none() {
            let is_at_end = self.frame_idx + 1 >= times_s.len();
            let from_idx = if is_at_end { 0 } else { self.frame_idx };
            self.frame_idx = from_idx;
            let from_s = times_s.get(from_idx).copied().unwrap_or(0.0);
            self.playing = Some([ui.input(|input| input.time), from_s]);
        }
    }

    /// The keys: space plays, the arrows step, Home and End go to the ends.
    pub fn keys(&mut self, ui: &Ui, times_s: &[f64]) {
        if times_s.is_empty() || ui.ctx().text_edit_focused() || ui.memory(|memory| memory.focused().is_some()) {
            return;
        }
        let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        if pressed(Key::Space) {
            self.toggle(ui, times_s);
        }
        let last_idx = times_s.len() - 1;
        for (key, frame_idx) in [
            (Key::ArrowLeft, self.frame_idx.saturating_sub(1)),
            (Key::ArrowRight, (self.frame_idx + 1).min(last_idx)),
            (Key::Home, 0),
            (Key::End, last_idx),
        ] {
            if pressed(key) {
                self.go_to(frame_idx);
            }
        }
    }

    /// The buttons and the slider in so many points of width.
    pub fn show(&mut self, ui: &mut Ui, times_s: &[f64], width: f32) {
        let last_idx = times_s.len().saturating_sub(1);
        let frame_idx = self.frame_idx;
        let place = ui.cursor().left();
        ui.add_enabled_ui(!times_s.is_empty(), |ui| {
            if widgets::symbol_button(ui, "⏮", words::FIRST_FRAME).clicked() {
                self.go_to(0);
            }
            if widgets::symbol_button(ui, "⏴", words::FRAME_BEFORE).clicked() {
                self.go_to(frame_idx.saturating_sub(1));
            }
            let (symbol, name) = if self.playing.is_some() { ("⏸", words::PAUSE) } else { ("▶", words::PLAY) };
            if widgets::symbol_button(ui, symbol, name).on_hover_text(words::KEYS_HINT).clicked() {
                self.toggle(ui, times_s);
            }
            if widgets::symbol_button(ui, "⏵", words::FRAME_AFTER).clicked() {
                self.go_to((frame_idx + 1).min(last_idx));
            }
            if widgets::symbol_button(ui, "⏭", words::LAST_FRAME).clicked() {
                self.go_to(last_idx);
            }
            let mut number = frame_idx + 1;
            ui.spacing_mut().slider_width = (width - (ui.cursor().left() - place)).max(60.0);
            let slider = ui.add(Slider::new(&mut number, 1..=last_idx + 1).show_value(false));
            slider.widget_info(|| WidgetInfo::slider(true, value_of(number), words::FRAME_SLIDER));
            if slider.changed() {
                self.go_to(number - 1);
            }
        });
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of a frame")]
const fn value_of(number: usize) -> f64 {
    number as f64
}
