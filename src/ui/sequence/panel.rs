//! The panel: the player above, picture and way side by side, curves over time below.

use std::rc::Rc;
use std::sync::Arc;

use egui::{ColorImage, Rect, Ui, UiBuilder, vec2};

use crate::app::Command;
use crate::app::workbench::sequence::{FramePictures, SequenceBench, SequenceCommand, TrackOptions};
use crate::odometry::{DepthImage, Match};
use crate::report::figure::model::Values;
use crate::session::sequence::Sequence;
use crate::text::sequence as words;
use crate::ui::eye::Eye;
use crate::ui::save_picture::saveable;
use crate::ui::{PanelContext, theme, widgets};

use super::controls;
use super::model::Model;
use super::over_time::{Curve, OverTime};
use super::picture::{Distances, Picture, Pixel, Scene, Shown, Way, distances_image};
use super::player::Player;
use super::trajectory as way;

/// The part of what is left that picture and way take.
const UPPER_PART: f32 = 0.56;
/// Below this width the cards stand above each other.
const SIDE_BY_SIDE_FROM: f32 = 640.0;
/// Height of each card when they stand above each other.
const STACKED_HEIGHT: f32 = 360.0;

/// How the way is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum WayView {
    #[default]
    Plan,
    Space,
}

/// What the panel remembers between frames.
#[derive(Debug)]
pub struct SequenceState {
    /// The document that it belongs to.
    document_id: Option<u64>,
    /// The run that the player goes through.
    run: u64,
    player: Player,
    shown: Shown,
    way_view: WayView,
    eye: Eye,
    picture: Picture,
    is_plan_fitted: bool,
    are_curves_fitted: bool,
    /// What was made of the frames so far, and whether that was all of them.
    model: Option<Rc<Model>>,
    /// Distances of the frame in sight.
    distances: Option<(Shown, Arc<FramePictures>, Option<Rc<Distances>>)>,
    /// As they are being typed.
    options: Option<TrackOptions>,
    /// Another number, other pictures on the screen.
    picture_key: u64,
}

impl Default for SequenceState {
    fn default() -> Self {
        Self {
            document_id: None,
            run: 0,
            player: Player::following(),
            shown: Shown::default(),
            way_view: WayView::default(),
            eye: Eye::new(way::AT_FIRST),
            picture: Picture::default(),
            is_plan_fitted: true,
            are_curves_fitted: true,
            model: None,
            distances: None,
            options: None,
            picture_key: 0,
        }
    }
}

impl SequenceState {
    fn model(&mut self, sequence: &Sequence, bench: &SequenceBench) -> Rc<Model> {
        match &self.model {
            Some(model) if model.is_of(bench) => Rc::clone(model),
            _ => {
                let model = Rc::new(Model::of(sequence, bench));
                self.model = Some(Rc::clone(&model));
                model
            }
        }
    }

    /// Distances at the pixels that are shown; made once a frame.
    fn distances(&mut self, sequence: &Sequence, pictures: &Arc<FramePictures>) -> Option<Rc<Distances>> {
        let of = if self.shown == Shown::Depth { Shown::Depth } else { Shown::Aligned };
        if let Some((shown, known, distances)) = &self.distances
            && *shown == of
            && Arc::ptr_eq(known, pictures)
        {
            return distances.clone();
        }
        let mm_per_unit = sequence.camera.mm_per_unit();
        let distances = pictures.pictures.as_ref().ok().map(|(frame, aligned)| {
            Rc::new(distances_of(if of == Shown::Depth { &frame.depth } else { aligned }, mm_per_unit))
        });
        self.picture_key += 1;
        self.distances = Some((of, Arc::clone(pictures), distances.clone()));
        distances
    }
}

/// Shows the panel.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut SequenceState) {
    let workbench = context.workbench;
    let Some(document) = workbench.document() else {
        widgets::nothing(ui, words::NO_SESSION);
        return;
    };
    if state.document_id != Some(document.id()) {
        *state = SequenceState { document_id: Some(document.id()), shown: state.shown, ..SequenceState::default() };
    }
    let bench = workbench.sequence();
    let Some(sequence) = bench.sequence() else {
        let refusal = workbench.results().and_then(|results| results.refusal.as_deref());
        let is_under_way = workbench.solve_progress().is_some();
        widgets::nothing(ui, if is_under_way { words::OPENING } else { refusal.unwrap_or(words::OPENING) });
        return;
    };
    if state.run != bench.run() {
        // Tracked anew: what is shown is the newest again.
        state.run = bench.run();
        state.player = Player::following();
    }
    let model = state.model(sequence, bench);
    let is_growing = workbench.solve_progress().is_some() && bench.tracked().is_none();
    state.player.advance(ui, &model.journey.times_s, is_growing);
    state.player.keys(ui, &model.journey.times_s);
    let frame_idx = state.player.frame_idx;
    if !model.journey.times_s.is_empty() && !bench.is_looking_for(frame_idx) {
        context.commands.push(Command::Sequence(SequenceCommand::Look(frame_idx)));
    }
    let area = ui.available_rect_before_wrap();
    let mut top = ui.new_child(UiBuilder::new().max_rect(area));
    controls::card(&mut top, context, sequence, &model, &mut state.player, &mut state.options);
    let rest = area.with_min_y(top.min_rect().bottom() + theme::GAP);
    let mut rest_ui = ui.new_child(UiBuilder::new().max_rect(rest));
    rest_ui.spacing_mut().item_spacing = vec2(theme::GAP, theme::GAP);
    cards(&mut rest_ui, rest, sequence, bench, &model, state);
    ui.advance_cursor_after_rect(area);
}

fn cards(
    ui: &mut Ui,
    area: Rect,
    sequence: &Sequence,
    bench: &SequenceBench,
    model: &Model,
    state: &mut SequenceState,
) {
    if area.width() < SIDE_BY_SIDE_FROM {
        egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            picture_card(ui, STACKED_HEIGHT, sequence, bench, state);
            way_card(ui, STACKED_HEIGHT, bench, model, state);
            travel_card(ui, STACKED_HEIGHT, model, state);
            effort_card(ui, STACKED_HEIGHT, model, state);
        });
        return;
    }
    let upper = ((area.height() - theme::GAP) * UPPER_PART).round();
    let half = (area.width() - theme::GAP) / 2.0;
    let place = |right: bool, lower: bool| {
        let min =
            area.min + vec2(if right { half + theme::GAP } else { 0.0 }, if lower { upper + theme::GAP } else { 0.0 });
        let height = if lower { area.height() - upper - theme::GAP } else { upper };
        Rect::from_min_size(min, vec2(half, height))
    };
    let child = |ui: &mut Ui, rect: Rect| ui.new_child(UiBuilder::new().max_rect(rect));
    let rect = place(false, false);
    picture_card(&mut child(ui, rect), rect.height(), sequence, bench, state);
    let rect = place(true, false);
    way_card(&mut child(ui, rect), rect.height(), bench, model, state);
    let rect = place(false, true);
    travel_card(&mut child(ui, rect), rect.height(), model, state);
    let rect = place(true, true);
    effort_card(&mut child(ui, rect), rect.height(), model, state);
}

fn picture_card(ui: &mut Ui, height: f32, sequence: &Sequence, bench: &SequenceBench, state: &mut SequenceState) {
    let mut shown = state.shown;
    let tabs = |ui: &mut Ui| {
        ui.spacing_mut().button_padding.x = 6.0;
        ui.spacing_mut().item_spacing.x = 2.0;
        // From right to left.
        for kind in Shown::ALL.into_iter().rev() {
            ui.selectable_value(&mut shown, kind, kind.name()).on_hover_text(kind.hint());
        }
    };
    widgets::card_with_height(ui, words::PICTURE, height, tabs, |ui| {
        let Some(pictures) = bench.pictures() else {
            widgets::nothing(ui, words::READING);
            return;
        };
        let (frame, _) = match &pictures.pictures {
            Ok(pictures) => pictures,
            Err(error) => {
                widgets::nothing(ui, &error.to_string());
                return;
            }
        };
        let distances = state.distances(sequence, pictures);
        let seen = bench.seen().get(pictures.frame_idx);
        let features: &[Pixel] = seen.map_or(&[], |seen| &seen.features);
        let ways: Vec<Way> = seen.map_or_else(Vec::new, |seen| {
            let way = |found: &Match| Way { from: found.before, to: found.now, is_inlier: found.is_inlier };
            seen.matches.iter().map(way).collect()
        });
        let of = state.shown;
        let color = || {
            let [width, height] =
                [frame.color.width(), frame.color.height()].map(|side| usize::try_from(side).unwrap_or(0));
            ColorImage::from_rgb([width, height], frame.color.as_raw())
        };
        let image = || match (of, distances.as_deref()) {
            (Shown::Depth, Some(distances)) => distances_image(distances, None),
            (Shown::Aligned, Some(distances)) => distances_image(distances, Some(&color())),
            _ => color(),
        };
        let scene = Scene {
            shown: of,
            frame_key: state.picture_key,
            image: &image,
            distances: distances.as_deref(),
            features,
            ways: &ways,
        };
        saveable(ui, words::PICTURE, |ui| state.picture.show(ui, &scene));
    });
    state.shown = shown;
}

fn way_card(ui: &mut Ui, height: f32, bench: &SequenceBench, model: &Model, state: &mut SequenceState) {
    let mut view = state.way_view;
    let tabs = |ui: &mut Ui| {
        ui.selectable_value(&mut view, WayView::Space, words::IN_SPACE);
        ui.selectable_value(&mut view, WayView::Plan, words::IN_PLAN).on_hover_text(words::IN_PLAN_HINT);
    };
    let clicked = widgets::card_with_height(ui, words::WAY, height, tabs, |ui| {
        if model.journey.ways.frames.is_empty() {
            widgets::nothing(ui, words::NO_WAY);
            return None;
        }
        let ways = &model.journey.ways;
        let camera = model.camera_at(bench, state.player.frame_idx);
        saveable(ui, words::WAY, |ui| match state.way_view {
            WayView::Plan => way::plan(ui, ways, camera.as_ref(), &mut state.is_plan_fitted),
            WayView::Space => way::space(ui, ways, camera.as_ref(), &mut state.eye),
        })
    });
    state.way_view = view;
    if let Some(frame_idx) = clicked {
        state.player.go_to(frame_idx);
    }
}

fn curve(name: &'static str, color: egui::Color32, values: &Values) -> Curve {
    Curve { name, color, is_dashed: false, values: values.clone() }
}

fn travel_card(ui: &mut Ui, height: f32, model: &Model, state: &mut SequenceState) {
    let truth = theme::palette(ui).text;
    let with_truth = |found: &Values, true_values: &Values| {
        let mut curves = vec![curve(words::TRACKED_WAY, theme::INLIER, found)];
        if !true_values.is_empty() {
            curves.push(Curve { is_dashed: true, ..curve(words::TRUE_WAY, truth, true_values) });
        }
        curves
    };
    two_curves(
        ui,
        height,
        words::TRAVEL,
        model,
        state,
        [
            (
                "sequence distance",
                words::DISTANCE_AXIS,
                3,
                with_truth(&model.journey.distance_m, &model.journey.true_distance_m),
                true,
            ),
            (
                "sequence heading",
                words::HEADING_AXIS,
                2,
                with_truth(&model.journey.heading_deg, &model.journey.true_heading_deg),
                false,
            ),
        ],
    );
}

fn effort_card(ui: &mut Ui, height: f32, model: &Model, state: &mut SequenceState) {
    let palette = theme::palette(ui);
    let counts = vec![
        curve(words::SEEN, palette.text_dim, &model.journey.features),
        curve(words::MATCHED, palette.accent, &model.journey.matches),
        curve(words::AGREEING, palette.good, &model.journey.inliers),
    ];
    let times = vec![curve(words::MOTION_TIME, palette.accent, &model.journey.motion_ms)];
    two_curves(
        ui,
        height,
        words::EFFORT,
        model,
        state,
        [
            ("sequence features", words::FEATURES_AXIS, 0, counts, true),
            ("sequence time", words::DURATION_AXIS, 1, times, true),
        ],
    );
}

type Plotted<'a> = (&'static str, &'a str, usize, Vec<Curve>, bool);

/// Two plots above each other; a click goes to a frame.
fn two_curves(
    ui: &mut Ui,
    height: f32,
    title: &str,
    model: &Model,
    state: &mut SequenceState,
    plotted: [Plotted<'_>; 2],
) {
    let current_s = model.journey.times_s.get(state.player.frame_idx).copied();
    let clicked = widgets::card_with_height(
        ui,
        title,
        height,
        |_| {},
        |ui| {
            if model.journey.times_s.is_empty() {
                widgets::nothing(ui, words::NO_WAY);
                return None;
            }
            saveable(ui, title, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                let half = ui.available_height() / 2.0;
                let mut clicked_s = None;
                for (idx, (id, y_title, decimals, curves, is_from_zero)) in plotted.into_iter().enumerate() {
                    let plot = OverTime {
                        id,
                        y_title,
                        decimals,
                        curves,
                        lost_s: &model.journey.lost_s,
                        current_s,
                        is_from_zero,
                        has_legend: idx == 0,
                    };
                    let found = plot.show(ui, half, idx == 0, &mut state.are_curves_fitted);
                    clicked_s = clicked_s.or(found);
                }
                clicked_s
            })
        },
    );
    if let Some(frame_idx) = clicked.and_then(|time_s| model.journey.frame_at(time_s)) {
        state.player.go_to(frame_idx);
    }
}

fn distances_of(depth: &DepthImage, mm_per_unit: f64) -> Distances {
    #[expect(clippy::cast_possible_truncation, reason = "to be seen as colours")]
    let z_mm = depth.pixels().map(|pixel| (f64::from(pixel.0[0]) * mm_per_unit) as f32).collect();
    Distances::new(usize::try_from(depth.width()).unwrap_or(0), z_mm)
}
