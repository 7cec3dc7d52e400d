//! The two-dimensional RGB-D picture of the patent: a frame after steps 2 and 3.

use image::RgbImage;

use super::align::aligned;
use super::camera::{DepthImage, RgbdCamera, RgbdFrame};
use super::depth_filter::{DepthFilter, depth_at, valid_ratio};
use super::grey::Grey;
use super::outcome::Failure;
use super::smooth::{pyramid, smoothed};

/// Sizes of the picture: the whole one, a half, a quarter, an eighth.
const NUM_LEVELS: usize = 4;
/// Darker pictures show only noise, of 255.
const LEAST_MEAN: f64 = 6.0;
/// With less depth too few points have one, %.
const LEAST_DEPTH_PERCENT: f64 = 1.0;

/// A frame as motion is estimated from it.
#[derive(Clone, Debug)]
pub struct View {
    /// The smoothed picture and its halves, finest first.
    pub levels: Vec<Grey>,
    /// Depth as the colour camera sees it, 0 where it is not to be used.
    pub depth: DepthImage,
    mm_per_unit: f64,
}

impl View {
    /// Aligns, cleans and smooths a frame.
    ///
    /// # Errors
    /// [`Failure`] where nothing could be seen in it.
    pub fn of(frame: &RgbdFrame, camera: &RgbdCamera, filter: &DepthFilter) -> Result<Self, Failure> {
        let (color, depth) = (&camera.color, &camera.depth);
        let needed = [color.width, color.height, depth.width, depth.height];
        let found = [frame.color.width(), frame.color.height(), frame.depth.width(), frame.depth.height()];
        if found != needed {
            return Err(Failure::WrongSize { found, needed });
        }
        let grey = grey_of(&frame.color)?;
        let depth = filter.clean(&aligned(&frame.depth, camera), camera.mm_per_unit());
        let found_percent = 100.0 * valid_ratio(&depth);
        if found_percent < LEAST_DEPTH_PERCENT {
            return Err(Failure::BlankDepth { found_percent, needed_percent: LEAST_DEPTH_PERCENT });
        }
        let levels = pyramid(smoothed(&grey), NUM_LEVELS);
        Ok(Self { levels, depth, mm_per_unit: camera.mm_per_unit() })
    }

    /// The depth at a place, mm.
    #[must_use]
    pub fn depth_mm(&self, pixel: [f32; 2]) -> Option<f64> {
        depth_at(&self.depth, pixel.map(f64::from), self.mm_per_unit)
    }
}

fn grey_of(color: &RgbImage) -> Result<Grey, Failure> {
    let grey = Grey::of(color);
    let sum: f64 = grey.values().chunks(1024).map(|part| f64::from(part.iter().sum::<f32>())).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count of pixels")]
    let mean = sum / grey.values().len().max(1) as f64;
    if mean < LEAST_MEAN { Err(Failure::TooDark { mean, needed: LEAST_MEAN }) } else { Ok(grey) }
}
