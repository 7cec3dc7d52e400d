//! Figures for print: a drawing held as data, given its place on a page once, and drawn with plotters into an SVG with vector
//! text or into pixels. The same data give the same bytes.
//!
//! Data flows domain data → `model` (what a plot is made from; the window draws from it too) → `sheets` (which plots stand on
//! a page) → `plot` (axes, marks, legend) → `frame` (places on the page) → `ink` → `render`.

mod frame;
pub mod ink;
pub mod model;
mod orbit;
mod page;
pub mod palette;
mod plot;
mod render;
mod scale;
mod sheets;
pub mod typeface;

use image::RgbImage;
use thiserror::Error;

pub use orbit::Orbit;
pub use scale::{Extent, multiples, round_step, tick_label};
pub use sheets::figures_of;

use ink::Ink;

/// Why a figure was not drawn.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FigureError {
    /// No picture has so few or so many pixels.
    #[error(
        "found a resolution of {pixels_per_point} pixels a point, needed one above 0 that a picture can have; use 1 to 8"
    )]
    Resolution {
        /// What was asked for.
        pixels_per_point: f64,
    },
    /// The backend gave up.
    #[error("the figure could not be drawn: {reason}")]
    NotDrawn {
        /// Its reason.
        reason: String,
    },
}

/// A figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its name, fit for a file.
    pub id: String,
    /// What it shows, as a caption.
    pub title: String,
    /// The same for readers who do not see it.
    pub alt: String,
    size: [u32; 2],
    ink: Vec<Ink>,
}

impl Figure {
    /// A figure of ink on a page of a size in points.
    pub fn new(
        id: impl Into<String>,
        title: impl Into<String>,
        alt: impl Into<String>,
        size: [u32; 2],
        ink: Vec<Ink>,
    ) -> Self {
        Self { id: id.into(), title: title.into(), alt: alt.into(), size, ink }
    }

    /// Width and height, points of 1/72 inch.
    #[must_use]
    pub const fn size_points(&self) -> [u32; 2] {
        self.size
    }

    /// What it is drawn with, from below to above.
    #[must_use]
    pub fn ink(&self) -> &[Ink] {
        &self.ink
    }

    /// As an SVG document with vector text and without references to anything outside.
    ///
    /// # Errors
    /// [`FigureError`] if the backend gives up.
    pub fn svg(&self) -> Result<String, FigureError> {
        render::svg(self.size.map(f64::from), &self.ink, &self.alt)
    }

    /// As pixels on white.
    ///
    /// # Errors
    /// [`FigureError`] for a resolution that no picture has, or if the backend gives up.
    pub fn png(&self, pixels_per_point: f64) -> Result<RgbImage, FigureError> {
        render::png(self.size.map(f64::from), &self.ink, pixels_per_point)
    }
}
