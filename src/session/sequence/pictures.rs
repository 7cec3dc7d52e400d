//! The pictures of a frame, as PNG files.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{ColorType, DynamicImage, ImageDecoder, Limits, RgbImage};

use crate::odometry::DepthImage;
use crate::session::error::{on_one_line, system_words};

use super::FrameError;

/// Eight bits of grey or colour of the size given.
pub(super) fn color(folder: &Path, name: &Path, size: [u32; 2]) -> Result<RgbImage, FrameError> {
    let is_color =
        |kind: ColorType| matches!(kind, ColorType::Rgb8 | ColorType::Rgba8 | ColorType::L8 | ColorType::La8);
    let picture = decoded(&folder.join(name), size, is_color, "a picture of 8 bits a channel")?;
    Ok(picture.into_rgb8())
}

/// Sixteen bits of depth of the size given.
pub(super) fn depth(folder: &Path, name: &Path, size: [u32; 2]) -> Result<DepthImage, FrameError> {
    let picture = decoded(&folder.join(name), size, |kind| kind == ColorType::L16, "depth as one channel of 16 bits")?;
    Ok(picture.into_luma16())
}

fn decoded(
    path: &Path,
    [width, height]: [u32; 2],
    is_kind: impl Fn(ColorType) -> bool,
    kind: &str,
) -> Result<DynamicImage, FrameError> {
    let file = || path.to_owned();
    let opened =
        File::open(path)
            .and_then(|opened| {
                if opened.metadata()?.is_file() { Ok(opened) } else { Err(std::io::ErrorKind::InvalidInput.into()) }
            })
            .map_err(|error| FrameError::Unreadable { file: file(), problem: system_words(&error) })?;
    let broken =
        |error: &dyn std::fmt::Display| FrameError::Broken { file: file(), problem: on_one_line(&error.to_string()) };
    // This reads the header only; a picture is set aside for once its size is as it should be.
    let reader = BufReader::with_capacity(1 << 16, opened);
    let decoder = PngDecoder::with_limits(reader, Limits::default()).map_err(|error| broken(&error))?;
    let found = decoder.dimensions();
    if found != (width, height) {
        return Err(FrameError::Wrong {
            file: file(),
            found: format!("{} × {} pixels", found.0, found.1),
            needed: format!("{width} × {height} as in {}", super::CAMERA_FILE),
        });
    }
    if !is_kind(decoder.color_type()) {
        let found = format!("{:?}", decoder.color_type());
        return Err(FrameError::Wrong { file: file(), found, needed: kind.to_owned() });
    }
    DynamicImage::from_decoder(decoder).map_err(|error| broken(&error))
}
