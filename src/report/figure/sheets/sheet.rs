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
/// The highest figure that fits a page with its caption, points.
const MOST_HEIGHT: f64 = 660.0;
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

    /// Its columns, equally wide.
    pub fn columns<const N: usize>(&self) -> [Area; N] {
        let width = (WIDTH - GAP * frame::whole(N - 1)) / frame::whole(N);
        std::array::from_fn(|idx| {
            let left = frame::whole(idx) * (width + GAP);
            Area::new([left, 0.0], [left + width, self.height])
        })
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
        for (part, plot) in plots {
            let bottom = top + area.height() * part / sum;
            frame::draw(plot, &Area::new([area.min[0], top], [area.max[0], bottom]), left, &mut self.page);
            top = bottom;
        }
    }

    /// A profile above its residuals: the same x in both, the view of the first.
    pub fn stack_following(&mut self, part: f64, upper: &Plot, lower: &mut Plot, area: &Area) {
        let left = frame::left_room(upper, area).max(frame::left_room(lower, area));
        let middle = area.min[1] + area.height() * part;
        let above = Area::new(area.min, [area.max[0], middle]);
        lower.view.x = frame::view_in(upper, &above, left).x;
        let margin = (lower.view.y[1] - lower.view.y[0]) * 0.06;
        lower.view.y = [lower.view.y[0] - margin, lower.view.y[1] + margin];
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
    /// What the signs mean in all of them.
    pub legend: Vec<Entry>,
}

/// The place of a small plot among the others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Its place in the list.
    pub idx: usize,
    /// Its area.
    pub area: Area,
    /// Whether it is the first of its row: there stand the titles of the y axes.
    pub is_first: bool,
    /// Whether no other stands below it: there stand the titles of the x axes.
    pub is_last: bool,
}

impl Multiples {
    /// The pages, each drawn cell by cell.
    pub fn pages(&self, count: usize, mut draw: impl FnMut(&mut Sheet, Cell)) -> Vec<Sheet> {
        const LEGEND_ROOM: f64 = 18.0;
        let num_columns = match count {
            0 => return Vec::new(),
            1..=2 => 2,
            3..=9 => 3,
            _ => 4,
        };
        let most_rows = rows_within(MOST_HEIGHT - LEGEND_ROOM, self.height);
        let num_pages = count.div_ceil(num_columns * most_rows);
        // Pages are about equally full.
        let rows_a_page = count.div_ceil(num_columns).div_ceil(num_pages);
        let a_page = rows_a_page * num_columns;
        let width = (WIDTH - GAP * frame::whole(num_columns - 1)) / frame::whole(num_columns);
        let mut pages = Vec::new();
        for first in (0..count).step_by(a_page) {
            let on_page = a_page.min(count - first);
            let num_rows = on_page.div_ceil(num_columns);
            let height = LEGEND_ROOM + frame::whole(num_rows) * (self.height + ROW_GAP) - ROW_GAP;
            let mut sheet = Sheet::new(height);
            let area = sheet.area();
            sheet.page().legend(&self.legend, &area);
            for place in 0..on_page {
                let (row, column) = (place / num_columns, place % num_columns);
                let left = frame::whole(column) * (width + GAP);
                let top = LEGEND_ROOM + frame::whole(row) * (self.height + ROW_GAP);
                let cell = Cell {
                    idx: first + place,
                    area: Area::new([left, top], [left + width, top + self.height]),
                    is_first: column == 0,
                    is_last: place + num_columns >= on_page,
                };
                draw(&mut sheet, cell);
            }
            pages.push(sheet);
        }
        pages
    }
}

fn rows_within(height: f64, each: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a handful")]
    let rows = ((height + ROW_GAP) / (each + ROW_GAP)).floor().max(1.0) as usize;
    rows
}
