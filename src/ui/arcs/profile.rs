//! The profile in true scale and its residuals.

use egui::{Align2, Color32, Id, Stroke, Ui, vec2};
use egui_plot::MarkerShape;

use crate::fit::PointClass;
use crate::report::figure::model::{EdgeModel, Found, ProfileModel, SectionModel, extent, inliers, residual_extent};
use crate::text::arcs as text;
use crate::text::typeset::{decimals_of_std, with_std};
use crate::ui::charts::{self, Canvas, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::{theme, widgets};

/// The part of the height that the profile takes; its residuals get the rest.
const PROFILE_PART: f32 = 0.62;
/// Height of a plot that has room for the whole title of its z axis, points.
const TITLE_NEEDS: f32 = 200.0;
/// Radius of a point of a profile, points.
const POINT_RADIUS: f32 = 1.6;
/// Points closer than this, points on the screen, are painted once.
const THIN_TO: f32 = 0.75;

/// Shows both plots in the space available.
pub fn show(ui: &mut Ui, model: &ProfileModel, shows_whole: bool, is_fitted: &mut bool) {
    charts::legend(ui, &entries(ui, model));
    let group = Id::unique("arcs profile x");
    let height = ui.available_height();
    let has_strip = model.has_residuals();
    let profile_height = if has_strip { (height * PROFILE_PART).round() } else { height };
    let mut chart =
        Chart::new(Id::unique("arcs profile"), text::X_AXIS, text::Z_AXIS, profile_height, extent(model, shows_whole));
    chart.invert_y = model.z_grows_away;
    chart.has_equal_scales = true;
    chart.x_group = Some(group);
    let canvas = chart.show(ui, is_fitted);
    paint_profile(ui, &canvas, model);
    if let Err(reason) = &model.found {
        refusal(ui, &canvas, reason);
    }
    if has_strip {
        let mut strip_extent = residual_extent(model);
        let middle = match &model.found {
            Ok(Found::Section(section)) => section.circle.x_mm,
            Ok(Found::Edge(edge)) => edge.point_mm[0],
            Ok(Found::Scan(_)) | Err(_) => 0.0,
        };
        strip_extent.x = [middle - 1.0, middle + 1.0];
        let height = ui.available_height();
        let mut strip =
            Chart::new(Id::unique("arcs residuals"), text::X_AXIS, text::RESIDUAL_AXIS, height, strip_extent);
        strip.x_group = Some(group);
        strip.follows_x = true;
        rule(ui);
        let strip_canvas = strip.show(ui, is_fitted);
        paint_residuals(ui, &strip_canvas, model);
        readout(ui, &canvas, &strip_canvas, model);
    }
}

/// Shows the profile alone, in a view that the caller chooses; `name` tells its plot from others.
pub fn show_alone(ui: &mut Ui, name: &'static str, model: &ProfileModel, extent: Extent, is_fitted: &mut bool) {
    charts::legend(ui, &entries(ui, model));
    let height = ui.available_height();
    let z_title = if height < TITLE_NEEDS { text::Z_AXIS_SHORT } else { text::Z_AXIS };
    let mut chart = Chart::new(Id::unique(name), text::X_AXIS, z_title, height, extent);
    chart.invert_y = model.z_grows_away;
    chart.has_equal_scales = true;
    let canvas = chart.show(ui, is_fitted);
    paint_profile(ui, &canvas, model);
    if let Err(reason) = &model.found {
        refusal(ui, &canvas, reason);
    }
}

/// The hairline between two plots of a card.
pub fn rule(ui: &Ui) {
    let stroke = Stroke::new(1.0, theme::palette(ui).hairline);
    ui.painter().hline(ui.max_rect().x_range(), ui.cursor().top() - 2.0, stroke);
}

fn entries(ui: &Ui, model: &ProfileModel) -> Vec<LegendEntry> {
    let palette = theme::palette(ui);
    let mut entries = Vec::new();
    let mut add = |glyph, color, text| entries.push(LegendEntry { glyph, color, text });
    let circle = MarkerShape::Circle;
    if let Ok(Found::Scan(line)) = &model.found {
        add(LegendGlyph::Solid(circle), theme::INLIER, text::points(line.num_valid, line.num_points));
    } else if model.found.is_ok() {
        add(LegendGlyph::Solid(circle), theme::INLIER, text::inliers(model.count(PointClass::Inlier)));
        let num_outliers = model.count(PointClass::Outlier);
        if num_outliers > 0 {
            add(LegendGlyph::Hollow(circle), theme::OUTLIER, text::outliers(num_outliers));
        }
    }
    let num_unused = model.count(PointClass::Unused);
    if num_unused > 0 {
        add(LegendGlyph::Solid(circle), theme::UNUSED, text::unused(num_unused));
    }
    match &model.found {
        Ok(Found::Section(section)) => {
            add(LegendGlyph::Line, fit_color(), text::section(&radius_words(section)));
            if let Some(radius_mm) = model.ball_radius_mm {
                add(LegendGlyph::Dashed, palette.text_dim, text::ball(&widgets::fixed(radius_mm, 3)));
            }
        }
        Ok(Found::Edge(edge)) if !edge.flanks.is_empty() => {
            add(LegendGlyph::Line, fit_color(), text::flanks(edge.flanks.len()).to_owned());
        }
        Ok(Found::Edge(_) | Found::Scan(_)) | Err(_) => {}
    }
    entries
}

/// What is fitted to the points has one colour.
fn fit_color() -> Color32 {
    theme::method_color(crate::calibrate::Method::BallMaxArc)
}

fn paint_profile(ui: &Ui, canvas: &Canvas, model: &ProfileModel) {
    let palette = theme::palette(ui);
    if let Some(section) = model.section() {
        let circle = section.circle;
        let centre = canvas.at(circle.x_mm, circle.z_mm);
        if let Some(ball_radius_mm) = model.ball_radius_mm {
            let stroke = Stroke::new(1.0, palette.text_dim.gamma_multiply(0.7));
            charts::dashed_circle(&canvas.painter, centre, on_screen(canvas, ball_radius_mm), stroke);
        }
        canvas.painter.circle_stroke(centre, on_screen(canvas, circle.radius_mm), Stroke::new(1.5, fit_color()));
    }
    for (class, color, is_solid) in [
        (PointClass::Unused, theme::UNUSED, true),
        (PointClass::Inlier, theme::INLIER, true),
        (PointClass::Outlier, theme::OUTLIER, false),
    ] {
        let points = model.points.iter().filter(|point| point.class == class);
        let on_screen = points.map(|point| canvas.at(point.x_mm, point.z_mm));
        for at in charts::thinned(on_screen, canvas.rect(), THIN_TO) {
            if is_solid {
                canvas.painter.circle_filled(at, POINT_RADIUS, color);
            } else {
                canvas.painter.circle_stroke(at, POINT_RADIUS + 1.4, Stroke::new(1.2, color));
            }
        }
    }
    if let Some(edge) = model.edge() {
        paint_edge(ui, canvas, edge);
    }
    if let Some(section) = model.section() {
        let circle = section.circle;
        let centre = canvas.at(circle.x_mm, circle.z_mm);
        cross(canvas, centre, Stroke::new(1.8, fit_color()));
        let label = text::centre(&with_std(circle.x_mm, section.std_mm[0]), &with_std(circle.z_mm, section.std_mm[1]));
        let radius = on_screen(canvas, circle.radius_mm.max(model.ball_radius_mm.unwrap_or(0.0)));
        let (anchor, align) = beside_circle(ui, canvas, centre, radius, &label);
        canvas.note(ui, anchor, align, &label, palette.text);
    }
}

/// Where a text stands clear of a small circle: at its right, else at its left; inside of one that has room for it, or that
/// fills the plot.
fn beside_circle(ui: &Ui, canvas: &Canvas, centre: egui::Pos2, radius: f32, label: &str) -> (egui::Pos2, Align2) {
    let below = (centre + vec2(0.0, 10.0), Align2::CENTER_TOP);
    let size = canvas.note_rect(ui, below.0, below.1, label).size();
    let has_room_inside = vec2(0.5 * size.x, 10.0 + size.y).length() < 0.9 * radius;
    let aside = vec2(radius + 8.0, 0.0);
    if has_room_inside {
        below
    } else if (centre + aside).x + size.x < canvas.rect().right() - 4.0 {
        (centre + aside, Align2::LEFT_CENTER)
    } else if (centre - aside).x - size.x > canvas.rect().left() + 4.0 {
        (centre - aside, Align2::RIGHT_CENTER)
    } else {
        below
    }
}

/// A length of the profile on the screen, points.
fn on_screen(canvas: &Canvas, length_mm: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "screen coordinates")]
    let length = length_mm as f32 * canvas.scale();
    length
}

fn cross(canvas: &Canvas, at: egui::Pos2, stroke: Stroke) {
    canvas.painter.line_segment([at - vec2(6.0, 0.0), at + vec2(6.0, 0.0)], stroke);
    canvas.painter.line_segment([at - vec2(0.0, 6.0), at + vec2(0.0, 6.0)], stroke);
}

/// The flanks, up to the point where they end or meet, and that point with its σ.
fn paint_edge(ui: &Ui, canvas: &Canvas, edge: &EdgeModel) {
    let [x_mm, z_mm] = edge.point_mm;
    let at = canvas.at(x_mm, z_mm);
    for flank in &edge.flanks {
        let [_, far] = flank.ends_mm;
        canvas.painter.line_segment([at, canvas.at(far[0], far[1])], Stroke::new(1.5, fit_color()));
    }
    let palette = theme::palette(ui);
    let stroke = Stroke::new(1.4, palette.text);
    let [x_std, z_std] = edge.std_mm;
    charts::error_bar(&canvas.painter, canvas.at(x_mm, z_mm - z_std), canvas.at(x_mm, z_mm + z_std), stroke);
    canvas.painter.line_segment([canvas.at(x_mm - x_std, z_mm), canvas.at(x_mm + x_std, z_mm)], stroke);
    cross(canvas, at, Stroke::new(1.8, palette.text));
    canvas.painter.circle_stroke(at, 9.0, stroke);
    let label = text::centre(&with_std(x_mm, x_std), &with_std(z_mm, z_std));
    // Towards the sensor there is nothing that the label could cover.
    canvas.note(ui, at - vec2(0.0, 14.0), Align2::CENTER_BOTTOM, &label, palette.text);
}

fn paint_residuals(ui: &Ui, canvas: &Canvas, model: &ProfileModel) {
    let zero = canvas.at(0.0, 0.0).y;
    canvas.painter.hline(
        canvas.rect().x_range(),
        zero,
        Stroke::new(1.0, theme::palette(ui).text_dim.gamma_multiply(0.6)),
    );
    let on_screen = inliers(model).map(|point| canvas.at(point.x_mm, point.residual_um));
    for at in charts::thinned(on_screen, canvas.rect(), THIN_TO) {
        canvas.painter.circle_filled(at, POINT_RADIUS, theme::INLIER);
    }
}

/// The inlier under the pointer, marked in both plots.
fn readout(ui: &Ui, profile: &Canvas, strip: &Canvas, model: &ProfileModel) {
    let in_profile = profile.hovered(inliers(model).map(|point| (point, [point.x_mm, point.z_mm])));
    let in_strip = strip.hovered(inliers(model).map(|point| (point, [point.x_mm, point.residual_um])));
    let Some(point) = in_profile.or(in_strip) else { return };
    let ring = Stroke::new(1.5, theme::palette(ui).text);
    for (canvas, at) in
        [(profile, profile.at(point.x_mm, point.z_mm)), (strip, strip.at(point.x_mm, point.residual_um))]
    {
        canvas.painter.circle(at, POINT_RADIUS + 2.0, Color32::TRANSPARENT, ring);
    }
    let words = text::point_readout(
        &widgets::fixed(point.x_mm, 3),
        &widgets::fixed(point.z_mm, 3),
        &widgets::signed(point.residual_um, 1),
    );
    let (canvas, at) = if in_profile.is_some() {
        (profile, profile.at(point.x_mm, point.z_mm))
    } else {
        (strip, strip.at(point.x_mm, point.residual_um))
    };
    canvas.note(ui, at + vec2(10.0, -8.0), Align2::LEFT_BOTTOM, &words, theme::palette(ui).text);
}

fn refusal(ui: &mut Ui, canvas: &Canvas, reason: &str) {
    let palette = theme::palette(ui);
    let width = (canvas.rect().width() - 32.0).max(80.0);
    let words = format!("! {reason}");
    let galley = ui.painter().layout(words.clone(), egui::FontId::proportional(theme::BODY_SIZE), palette.warn, width);
    let rect = egui::Rect::from_min_size(canvas.rect().left_top() + vec2(12.0, 8.0), galley.size());
    canvas.painter.rect_filled(rect.expand(6.0), f32::from(theme::RADIUS), palette.surface.gamma_multiply(0.92));
    canvas.painter.galley(rect.min, galley, palette.warn);
    let response = ui.interact(rect, Id::unique("arcs refusal"), egui::Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, reason));
}

/// The shift of another fit against the robust one, in words.
#[must_use]
pub fn shift_words(section: &SectionModel) -> String {
    let [dx, dz, dl] = section.shift_um.map(|shift| widgets::signed(shift, 2));
    text::fit_shift(&dx, &dz, &dl)
}

/// The section's radius; no ± stands beside it, so its last digit is the first that its standard deviation reaches.
fn radius_words(section: &SectionModel) -> String {
    widgets::fixed(section.circle.radius_mm, decimals_of_std(section.std_mm[2]).saturating_sub(1))
}
