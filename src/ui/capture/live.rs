//! What comes from the profiler, with the arc in it, and the curve that the search draws.

use std::rc::Rc;
use std::sync::Arc;

use egui::{Color32, RichText, Ui, UiBuilder, vec2};

use crate::app::cell::LiveProfile;
use crate::calibrate::Reading;
use crate::device::LinkState;
use crate::fit::{CircleMethod, Found};
use crate::report::figure::model::{Curve, ProfileModel, extent, profile_model};
use crate::text::arcs::edge_found;
use crate::text::capture as words;
use crate::text::edges::feature_name;
use crate::text::typeset::with_std;
use crate::ui::arcs::curve::{self, CurveLook};
use crate::ui::arcs::profile;
use crate::ui::charts::Extent;
use crate::ui::save_picture::saveable;
use crate::ui::theme;
use crate::ui::widgets::{card_with_height, fixed, nothing};

use super::edges;
use super::model::{SearchCurve, search_curve, steady};
use super::panel::Desk;

/// The part of the width that the profile takes.
const PROFILE_PART: f32 = 0.54;

/// Shows both side by side.
pub fn show(ui: &mut Ui, height: f32, desk: &mut Desk<'_>) {
    let area = ui.available_rect_before_wrap();
    let area = area.with_max_y(area.top() + height);
    let (left, right) = area.split_left_right_at_x(area.left() + (area.width() * PROFILE_PART).round());
    let mut left = ui.new_child(UiBuilder::new().max_rect(left));
    live_card(&mut left, height, desk);
    let mut right = ui.new_child(UiBuilder::new().max_rect(right.with_min_x(right.left() + theme::GAP)));
    if desk.view.is_of_edges() {
        edges::spread(&mut right, height, desk);
    } else {
        curve_card(&mut right, height, desk);
    }
    ui.allocate_rect(area, egui::Sense::hover());
}

fn live_card(ui: &mut Ui, height: f32, desk: &mut Desk<'_>) {
    let cell = desk.view.cell;
    let is_fitted = desk.state.is_profile_fitted;
    // Nothing comes any more from a link that is broken; what is replayed needs none.
    let is_past = cell.live.is_some() && cell.replay.is_none() && cell.sensor.state != LinkState::Ready;
    let mut fits = false;
    let right = |ui: &mut Ui| {
        ui.spacing_mut().interact_size.y = 22.0;
        ui.spacing_mut().button_padding = vec2(8.0, 2.0);
        if cell.live.is_some() && !is_fitted {
            fits = ui.button(words::FIT_VIEW).on_hover_text(words::FIT_VIEW_HINT).clicked();
        }
        if is_past {
            ui.label(theme::dim(ui, words::LAST_PROFILE));
        } else if let Some(live) = &cell.live {
            ui.label(theme::dim(ui, words::rate(&fixed(live.rate_hz, 0))));
        }
    };
    let ball_radius_mm = desk.view.ball_radius_mm();
    card_with_height(ui, words::LIVE, height, right, |ui| {
        let Some(live) = &cell.live else {
            let watched = cell.watched_folder.as_ref().map(|folder| folder.display().to_string());
            return match (cell.sensor.state == LinkState::Ready, watched) {
                (true, Some(folder)) => nothing(ui, &words::live_nothing_in(&folder)),
                (true, None) => nothing(ui, words::LIVE_NOTHING),
                (false, _) => nothing(ui, words::LIVE_OFF),
            };
        };
        if is_past {
            ui.multiply_opacity(theme::PAST_OPACITY);
        }
        let model = desk.state.profile_of(live, ball_radius_mm);
        found_line(ui, live);
        let extent = extent(&model, true);
        let steady = steady(desk.state.view, [extent.x, extent.y]);
        desk.state.view = Some(steady);
        let extent = Extent { x: steady[0], y: steady[1] };
        let is_fitted = &mut desk.state.is_profile_fitted;
        saveable(ui, words::LIVE, |ui| profile::show_alone(ui, "live profile", &model, extent, is_fitted));
    });
    if fits {
        desk.state.is_profile_fitted = true;
    }
}

/// What was found, or why nothing was, in the line above the plot.
fn found_line(ui: &mut Ui, live: &LiveProfile) {
    egui::Frame::new().inner_margin(egui::Margin { left: 12, right: 12, top: 6, bottom: 0 }).show(ui, |ui| {
        let um = |std_mm: f64| fixed(std_mm * 1000.0, 1);
        let (line, short) = match &live.found {
            Ok(Found::Arc(arc)) => {
                let radius = with_std(arc.circle.radius_mm, arc.std_mm()[2]);
                let angle_deg = fixed(arc.angle_rad.to_degrees(), 0);
                let line = words::arc(&radius, &angle_deg, &um(arc.point_std_mm));
                (line, words::arc_short(&radius, &angle_deg))
            }
            Ok(Found::Edge(edge)) => {
                let [x, z] = [0, 1].map(|axis| with_std(edge.point_mm[axis], edge.std_mm()[axis]));
                let short = edge_found(feature_name(edge.feature), &x, &z);
                (words::edge_line(&short, &um(edge.point_std_mm)), short)
            }
            Err(refusal) => {
                let line = format!("! {}", words::sentence(&refusal.to_string()));
                ui.add(egui::Label::new(RichText::new(line).color(theme::palette(ui).warn)).truncate());
                return;
            }
        };
        let whole = ui.painter().layout_no_wrap(line.clone(), theme::number_font(), Color32::PLACEHOLDER);
        if whole.size().x <= ui.available_width() {
            ui.label(RichText::new(line).font(theme::number_font()));
        } else {
            let short = RichText::new(short).font(theme::number_font());
            ui.add(egui::Label::new(short).truncate()).on_hover_text(line);
        }
    });
}

impl super::panel::CaptureState {
    /// Made once a profile: frames come more often than profiles.
    fn profile_of(&mut self, live: &LiveProfile, ball_radius_mm: Option<f64>) -> Rc<ProfileModel> {
        let profile = &live.reading.profile;
        if let Some((known, has_target, model)) = &self.profile
            && Arc::ptr_eq(known, profile)
            && *has_target == live.found.is_ok()
            && model.ball_radius_mm == ball_radius_mm
        {
            return Rc::clone(model);
        }
        let reading = Reading::from(live.found.clone());
        let model = Rc::new(profile_model(profile, Some(&reading), ball_radius_mm, CircleMethod::Robust));
        self.profile = Some((Arc::clone(profile), live.found.is_ok(), Rc::clone(&model)));
        model
    }

    fn curve_of(&mut self, search: &Arc<crate::device::SearchReport>, ball_radius_mm: f64) -> Rc<SearchCurve> {
        if let Some((known, curve)) = &self.curve
            && Arc::ptr_eq(known, search)
        {
            return Rc::clone(curve);
        }
        let curve = Rc::new(search_curve(search, ball_radius_mm));
        self.curve = Some((Arc::clone(search), Rc::clone(&curve)));
        curve
    }
}

fn curve_card(ui: &mut Ui, height: f32, desk: &mut Desk<'_>) {
    let ball_radius_mm = desk.view.ball_radius_mm();
    let is_past = desk.view.cell.is_search_past();
    card_with_height(
        ui,
        words::RADIUS_AGAINST_STEP,
        height,
        |ui| {
            if is_past {
                ui.label(theme::dim(ui, words::LAST_STATION));
            }
        },
        |ui| {
            if is_past {
                ui.multiply_opacity(theme::PAST_OPACITY);
            }
            let (Some(search), Some(ball_radius_mm)) = (&desk.view.cell.search, ball_radius_mm) else {
                return nothing(ui, words::NO_SEARCH);
            };
            let shown = desk.state.curve_of(search, ball_radius_mm);
            if shown.points.is_empty() {
                return nothing(ui, words::NO_STEP_YET);
            }
            let look = CurveLook {
                name: "live search",
                ball_radius_mm,
                x_title: words::TRAVEL_AXIS,
                selected_capture: shown.points.last().map(|point| point.capture_idx),
                hovered_capture: None,
                has_residuals: false,
            };
            let curve = Curve { points: &shown.points, peak: shown.peak, published_stop_mm: shown.published_stop_mm };
            let is_fitted = &mut desk.state.is_curve_fitted;
            saveable(ui, words::RADIUS_AGAINST_STEP, |ui| curve::show(ui, &curve, &look, is_fitted));
        },
    );
}
