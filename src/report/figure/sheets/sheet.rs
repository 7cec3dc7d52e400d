//! A page that plots are put on.

use crate::report::figure::Figure;
use crate::report::figure::frame;
use crate::report::figure::ink::Area;
use crate::report::figure::page::Page;
use crate::report::figure::plot::{Entry, Plot};

/// Width of a figure, points: that of the text on an A4 page.
pub(super) const WIDTH: f64 = 500.0;
/// Gap between plots, points.
pub(super) const GAP: f64 = 10.0;
/// The highest figure of which two fit on an A4 page with their captions, points.
pub(super) const HALF_PAGE: f64 = 318.0;
/// Gap between the rows of small plots, points.
const ROW_GAP: f64 = 8.0;

/// A page under way.
pub(super) struct Sheet {
    page: Page,
    height: f64,
}

impl Sheet {
    /// An empty page of a height in points.
    pub fn new(height: f64) -> Self {
        Self { page: Page::default(), height }
    }

    /// All of it.
    pub const fn area(&self) -> Area {
        Area::new([0.0, 0.0], [WIDTH, self.height])
    }

    /// A legend for all plots, at the top; answers two equally wide columns below it.
    pub fn legend_over_columns(&mut self, entries: &[Entry]) -> [Area; 2] {
        let below = self.legend(entries);
        let width = (WIDTH - 2.0 * GAP) / 2.0;
        [0.0, width + 2.0 * GAP].map(|left| Area::new([left, below.min[1]], [left + width, self.height]))
    }

    /// A legend for all plots, at the top; answers what is left.
    pub fn legend(&mut self, entries: &[Entry]) -> Area {
        let area = self.area();
        let height = self.page.legend(entries, &area);
        Area::new([0.0, if height > 0.0 { height + 4.0 } else { 0.0 }], area.max)
    }

    /// The page itself, for what is no plot.
    pub const fn page(&mut self) -> &mut Page {
        &mut self.page
    }

    /// A plot in an area.
    pub fn plot(&mut self, plot: &Plot, area: &Area) {
        let left = frame::left_room(plot, area);
        frame::draw(plot, area, left, &mut self.page);
    }

    /// Plots above each other, with one y axis below the other; each takes its part of the height.
    pub fn stack(&mut self, plots: &[(f64, &Plot)], area: &Area) {
        let sum: f64 = plots.iter().map(|(part, _)| part).sum();
        let left = plots.iter().map(|(_, plot)| frame::left_room(plot, area)).fold(0.0, f64::max);
        let mut top = area.min[1];
        for (place, (part, plot)) in plots.iter().enumerate() {
            const BETWEEN: f64 = 4.0;
            let bottom = top + area.height() * part / sum;
            let end = if place + 1 < plots.len() { bottom - BETWEEN } else { bottom };
            frame::draw(plot, &Area::new([area.min[0], top], [area.max[0], end]), left, &mut self.page);
            top = bottom;
        }
    }

    /// A plot above another that takes its x axis from it, with so much of the height for the first.
    pub fn stack_following(&mut self, part: f64, upper: &Plot, lower: &mut Plot, area: &Area) {
        let left = frame::left_room(upper, area).max(frame::left_room(lower, area));
        self.following(upper, lower, area, area.min[1] + area.height() * part, left);
    }

    fn following(&mut self, upper: &Plot, lower: &mut Plot, area: &Area, middle: f64, left: f64) {
        let above = Area::new(area.min, [area.max[0], middle]);
        lower.view.y = lower.view.with_margin().y;
        lower.view.x = frame::view_in(upper, &above, left).x;
        lower.is_view_final = true;
        frame::draw(upper, &above, left, &mut self.page);
        frame::draw(lower, &Area::new([area.min[0], middle], area.max), left, &mut self.page);
    }

    /// The finished figure.
    pub fn figure(self, id: impl Into<String>, title: impl Into<String>, alt: impl Into<String>) -> Figure {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the size of a page")]
        let size = [WIDTH, self.height].map(|length| length.round() as u32);
        Figure::new(id, title, alt, size, self.page.ink)
    }
}

/// Small plots of the same kind, side by side and below each other, on as many pages as they need.
pub(super) struct Multiples {
    /// Height of each, points.
    pub height: f64,
    /// Part of the height that the upper plot of each takes, where there is one below it.
    pub upper_part: f64,
    /// What the signs mean in all of them.
    pub legend: Vec<Entry>,
    /// Title of all x axes: it stands only where no other plot is below.
    pub x_title: &'static str,
}

/// A small plot, or one above another that shares its x axis. Titles of y axes stand only in the first column.
pub(super) struct Small {
    pub upper: Plot,
    pub lower: Option<Plot>,
}

impl Multiples {
    /// The pages.
    pub fn pages(&self, mut plots: Vec<Small>) -> Vec<Sheet> {
        const LEGEND_ROOM: f64 = 18.0;
        let count = plots.len();
        let num_columns = match count {
            0 => return Vec::new(),
            1..=2 => 2,
            3..=6 => 3,
            _ => 4,
        };
        let most_rows = rows_within(HALF_PAGE - LEGEND_ROOM - frame::TITLE_HEIGHT, self.height);
        let num_pages = count.div_ceil(num_columns * most_rows);
        // Pages are about equally full.
        let rows_a_page = count.div_ceil(num_columns).div_ceil(num_pages);
        let width = (WIDTH - GAP * frame::whole(num_columns - 1)) / frame::whole(num_columns);
        let mut pages = Vec::new();
        for on_page in plots.chunks_mut(rows_a_page * num_columns) {
            let num_rows = on_page.len().div_ceil(num_columns);
            let height = LEGEND_ROOM + frame::whole(num_rows) * (self.height + ROW_GAP) - ROW_GAP + frame::TITLE_HEIGHT;
            let mut sheet = Sheet::new(height);
            let area = sheet.area();
            sheet.page.legend(&self.legend, &area);
            let count = on_page.len();
            for (place, small) in on_page.iter_mut().enumerate() {
                if place % num_columns > 0 {
                    small.upper.y.title.clear();
                    small.lower.iter_mut().for_each(|lower| lower.y.title.clear());
                }
                let lowest = small.lower.as_mut().unwrap_or(&mut small.upper);
                lowest.x.title = if place + num_columns >= count { self.x_title.to_owned() } else { String::new() };
            }
            // One room at the left for each column, so that its plots line up.
            let cell = Area::new([0.0, 0.0], [width, self.height]);
            let mut lefts = vec![0.0_f64; num_columns];
            for (place, small) in on_page.iter().enumerate() {
                for plot in std::iter::once(&small.upper).chain(&small.lower) {
                    lefts[place % num_columns] = lefts[place % num_columns].max(frame::left_room(plot, &cell));
                }
            }
            for (place, small) in on_page.iter_mut().enumerate() {
                let (row, column) = (place / num_columns, place % num_columns);
                let left = frame::whole(column) * (width + GAP);
                let top = LEGEND_ROOM + frame::whole(row) * (self.height + ROW_GAP);
                // The title goes below the cell, so that all plots are equally high.
                let title = if place + num_columns >= count { frame::TITLE_HEIGHT } else { 0.0 };
                let area = Area::new([left, top], [left + width, top + self.height + title]);
                match &mut small.lower {
                    Some(lower) => {
                        let middle = top + self.upper_part * self.height;
                        sheet.following(&small.upper, lower, &area, middle, lefts[column]);
                    }
                    None => frame::draw(&small.upper, &area, lefts[column], &mut sheet.page),
                }
            }
            pages.push(sheet);
        }
        pages
    }

    /// The pages as figures; `title` gets the number of the page and that of all.
    pub fn figures(&self, plots: Vec<Small>, id: &str, title: impl Fn(usize, usize) -> String) -> Vec<Figure> {
        let pages = self.pages(plots);
        let num_pages = pages.len();
        let numbered = pages.into_iter().zip(1..);
        numbered
            .map(|(sheet, number)| {
                let title = title(number, num_pages);
                let id = if num_pages > 1 { format!("{id}-{number}") } else { id.to_owned() };
                sheet.figure(id, title.clone(), title)
            })
            .collect()
    }
}

fn rows_within(height: f64, each: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a handful")]
    let rows = ((height + ROW_GAP) / (each + ROW_GAP)).floor().max(1.0) as usize;
    rows
}
