//! Comparisons and histories in sentences: what the commands print, and what the window says.

use crate::text::compare_results as words;
use crate::text::digits::signed;
use crate::verify::drift::Trend;

use super::{ComparedPoints, Comparison, Course, History, Order, Shared};

/// A comparison as `compare` prints it.
#[must_use]
pub fn comparison_text(comparison: &Comparison) -> String {
    let Comparison { from, to, difference, points, .. } = comparison;
    let mut said = words::compare_head(&from.name, &to.name);
    for remark in remarks(comparison) {
        said.push_str(&remark);
        said.push('\n');
    }
    said.push('\n');
    said.push_str(&words::difference_lines(difference));
    let ComparedPoints { reference, given, .. } = points;
    if let Some(shift) = reference {
        said.push_str(&words::point_line(words::REFERENCE_POINT, shift, difference.known));
    }
    for shift in given {
        said.push_str(&words::point_line(words::GIVEN_POINT, shift, difference.known));
    }
    if let Some((mean_mm, max_mm)) = points.measured_mm() {
        said.push_str(&words::measured_line(points.measured.len(), mean_mm, max_mm));
        said.push('\n');
    }
    said
}

/// What to know before the numbers: that both are from the same data, or that one is no rotation.
#[must_use]
pub fn remarks(comparison: &Comparison) -> Vec<String> {
    let shared = match comparison.shared {
        Shared::Nothing => None,
        Shared::File => Some(words::SAME_FILE),
        Shared::Data => Some(words::SAME_DATA),
    };
    let nearest = [&comparison.from, &comparison.to].into_iter().filter(|calibration| calibration.is_nearest);
    shared.map(str::to_owned).into_iter().chain(nearest.map(|calibration| words::nearest(&calibration.name))).collect()
}

/// A row of a history: name, date, the way from the first along x, y, z in mm, the turn in degrees, the way of the point in
/// mm, and that from the previous one.
#[must_use]
pub fn history_rows(history: &History) -> Vec<[String; 8]> {
    let drift = &history.drift;
    history
        .calibrations
        .iter()
        .zip(&drift.from_first)
        .enumerate()
        .map(|(idx, (calibration, change))| {
            let moved = change.difference.translation_mm;
            let previous = idx.checked_sub(1).and_then(|previous| drift.from_previous.get(previous));
            let from_previous =
                previous.map_or_else(|| "-".to_owned(), |step| format!("{:.4}", step.shift.shift_mm.norm()));
            let mark = if drift.jumps.contains(&idx) { words::JUMP_MARK } else { "" };
            [
                calibration.name.clone(),
                calibration.date().unwrap_or_else(|| "-".to_owned()),
                signed(moved.x, 4),
                signed(moved.y, 4),
                signed(moved.z, 4),
                format!("{:.5}", change.difference.angle_rad().to_degrees()),
                format!("{:.4}", change.shift.shift_mm.norm()),
                from_previous + mark,
            ]
        })
        .collect()
}

/// What a history comes to, in a sentence.
#[must_use]
pub fn verdict(history: &History) -> String {
    let is_drift = |trend: &Trend| trend.is_significant == Some(true);
    let trends: Vec<Trend> = history.shown_trends().collect();
    let axes = words::POINT_AXES.iter().chain(&words::TREND_AXES);
    let drifting: Vec<String> = axes
        .zip(&trends)
        .filter(|(_, trend)| is_drift(trend))
        .map(|(axis, trend)| words::drifting_axis(axis, trend, history.order == Order::Dates))
        .collect();
    words::history_verdict(&drifting, history.drift.jumps.len(), history.course() == Course::Unknown)
}

/// Something to say of a history.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sentence {
    /// As it is printed.
    pub text: String,
    /// Whether somebody should look: a jump, a drift, a file that was left out.
    pub is_remarkable: bool,
}

/// What there is to say of jumps and trends, and of files that were left out.
#[must_use]
pub fn history_sentences(history: &History) -> Vec<Sentence> {
    let plain = |text: String| Sentence { text, is_remarkable: false };
    let remarkable = |text: String| Sentence { text, is_remarkable: true };
    let is_by_dates = history.order == Order::Dates;
    let drift = &history.drift;
    let mut said = Vec::new();
    for jump in &drift.jumps {
        let (Some(step), Some(previous), Some(calibration)) =
            (drift.from_previous.get(jump - 1), history.calibrations.get(jump - 1), history.calibrations.get(*jump))
        else {
            continue;
        };
        let moved_mm = step.shift.shift_mm.norm();
        said.push(remarkable(words::jump_line(&calibration.name, &previous.name, moved_mm, step.shift.p_value)));
    }
    if drift.jumps.is_empty() {
        said.push(plain(words::NO_JUMP.to_owned()));
    }
    let axes = words::POINT_AXES.iter().chain(&words::TREND_AXES);
    said.extend(axes.zip(history.shown_trends()).map(|(axis, trend)| Sentence {
        text: words::trend_line(axis, &trend, is_by_dates),
        is_remarkable: trend.is_significant == Some(true),
    }));
    if drift.trends.is_empty() {
        said.push(plain(words::no_trend_line(history.calibrations.len())));
    }
    said.extend(history.left_out.iter().map(|reason| remarkable(words::left_out_line(reason))));
    said
}

/// A history as `history` prints it.
#[must_use]
pub fn history_text(history: &History) -> String {
    let mut rows = vec![words::HISTORY_COLUMNS.map(str::to_owned)];
    rows.extend(history_rows(history));
    let widths: [usize; 8] =
        std::array::from_fn(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or_default());
    let mut said = words::history_head(history.calibrations.len(), history.order == Order::Dates);
    said.push_str("\n\n");
    for row in rows {
        let cells: Vec<String> = row
            .iter()
            .zip(widths)
            .enumerate()
            .map(
                |(column, (cell, width))| {
                    if column < 2 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
                },
            )
            .collect();
        said.push_str(cells.join("  ").trim_end());
        said.push('\n');
    }
    said.push('\n');
    said.push_str(&verdict(history));
    said.push_str("\n\n");
    for sentence in history_sentences(history) {
        said.push_str(&sentence.text);
        said.push('\n');
    }
    said
}
