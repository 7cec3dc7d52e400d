//! The colours of the points: by height, by region, or by their distance from their region's plane.

use egui::Color32;

use crate::app::workbench::scans::ExaminedScan;
use crate::report::figure::palette;
use crate::text::workpiece as words;
use crate::ui::cloud::Legend;
use crate::ui::theme;

/// What the colours say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ColorBy {
    /// Height in the base.
    Height,
    /// The region.
    #[default]
    Region,
    /// The distance from the region's plane.
    Distance,
}

impl ColorBy {
    pub(super) const ALL: [(Self, &'static str); 3] =
        [(Self::Height, words::BY_HEIGHT), (Self::Region, words::BY_REGION), (Self::Distance, words::BY_DISTANCE)];
}

/// Dark to light, as even to the eye as the well-known viridis.
const HEIGHTS: [Color32; 5] = [
    Color32::from_rgb(0x46, 0x24, 0x7a),
    Color32::from_rgb(0x35, 0x63, 0x8d),
    Color32::from_rgb(0x21, 0x98, 0x8b),
    Color32::from_rgb(0x62, 0xc4, 0x60),
    Color32::from_rgb(0xf0, 0xdf, 0x32),
];
/// Below, on and above a plane.
const DISTANCES: [Color32; 3] =
    [Color32::from_rgb(0x00, 0x5a, 0x9e), Color32::from_rgb(0xd8, 0xda, 0xdd), Color32::from_rgb(0xc0, 0x4a, 0x00)];

/// The colour of the so-many-th region.
pub(super) fn region_color(idx: usize) -> Color32 {
    theme::color_of(palette::region_color(idx))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "a place among a few colours"
)]
fn between(colors: &[Color32], part: f32) -> Color32 {
    let last = colors.len() - 1;
    let place = part.clamp(0.0, 1.0) * last as f32;
    let below = (place as usize).min(last - 1);
    colors[below].lerp_to_gamma(colors[below + 1], place - below as f32)
}

fn height_color(part: f32) -> Color32 {
    between(&HEIGHTS, part)
}

fn distance_color(part: f32) -> Color32 {
    between(&DISTANCES, part)
}

/// The colours of a scan as it is now.
#[derive(Debug)]
pub(super) struct Colors {
    by: ColorBy,
    is_dark: bool,
    scan_id: u64,
    regions_id: u64,
    /// Least and greatest value of the scale.
    ends: [f64; 2],
}

impl Colors {
    pub(super) fn new(scan: &ExaminedScan, by: ColorBy, is_dark: bool) -> Self {
        /// So many root mean squares hold all but wild points.
        const SPAN: f64 = 3.0;
        let ends = match by {
            ColorBy::Height => scan.cloud.bounds_mm().map_or([0.0, 1.0], |[low, high]| [low.z, high.z]),
            ColorBy::Region => [0.0, 1.0],
            ColorBy::Distance => {
                let rms = scan.regions.iter().filter_map(|region| Some(region.plane.as_ref().ok()?.rms_mm));
                let reach = SPAN * rms.fold(1e-3, f64::max);
                [-reach, reach]
            }
        };
        Self { by, is_dark, scan_id: scan.id, regions_id: scan.regions_id, ends }
    }

    pub(super) fn is_of(&self, scan: &ExaminedScan, by: ColorBy, is_dark: bool) -> bool {
        let is_same = self.by == by && self.is_dark == is_dark;
        is_same && self.scan_id == scan.id && self.regions_id == scan.regions_id
    }

    /// Another number, other colours.
    pub(super) const fn key(&self) -> u64 {
        let by = match self.by {
            ColorBy::Height => 0,
            ColorBy::Region => 1,
            ColorBy::Distance => 2,
        };
        (self.regions_id * 3 + by) * 2 + self.is_dark as u64
    }

    /// The colour of a point.
    pub(super) fn of(&self, scan: &ExaminedScan, idx: usize) -> Color32 {
        let region = || scan.regions.iter().position(|region| region.set.contains(idx));
        match self.by {
            ColorBy::Height => height_color(self.part(scan.cloud.point_mm(idx).z)),
            ColorBy::Region => region().map_or_else(|| self.nowhere(), region_color),
            ColorBy::Distance => {
                let plane = region().and_then(|region| scan.regions[region].plane.as_ref().ok());
                let distance = plane.map(|fit| fit.plane.distance_mm(scan.cloud.point_mm(idx)));
                distance.map_or_else(|| self.nowhere(), |distance| distance_color(self.part(distance)))
            }
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "a part of a scale")]
    fn part(&self, value: f64) -> f32 {
        ((value - self.ends[0]) / (self.ends[1] - self.ends[0]).max(1e-9)) as f32
    }

    /// Of points in no region: there, but not in the foreground.
    const fn nowhere(&self) -> Color32 {
        if self.is_dark { Color32::from_rgb(0x5c, 0x66, 0x73) } else { Color32::from_rgb(0xb9, 0xc0, 0xc9) }
    }

    pub(super) fn legend(&self, scan: &ExaminedScan) -> Legend {
        let scale = |title: &str, color| Legend::Scale { title: title.to_owned(), ends: self.ends, color };
        match self.by {
            ColorBy::Height => scale(words::HEIGHT_SCALE, height_color),
            ColorBy::Distance => scale(words::DISTANCE_SCALE, distance_color),
            ColorBy::Region => {
                let names = scan.regions.iter().enumerate();
                Legend::Names(names.map(|(idx, region)| (region.name.clone(), region_color(idx))).collect())
            }
        }
    }
}
