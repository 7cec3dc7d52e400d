//! `camera.json`: both cameras, how they are mounted to each other, and what a unit of depth is.

use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion};
use serde_json::{Value, json};

use crate::geometry::notation::QUATERNION_NORM_TOLERANCE;
use crate::geometry::{Transform, Vec3};
use crate::odometry::{CameraError, Intrinsics, RgbdCamera};
use crate::session::error::{on_one_line, system_words};

use super::SequenceError;

/// Larger files are something else.
const MAX_BYTES: u64 = 1 << 20;
/// Units of depth in a metre, where the file does not say: those of the benchmark.
const DEPTH_SCALE: f64 = 5000.0;

const NEEDED: &str = "it says what the pictures' sizes and the cameras' focal lengths are: \
    {\"color\": {\"width\", \"height\", \"fx\", \"fy\", \"cx\", \"cy\"}, \"depth\": {…}, \
    \"color_from_depth\": {\"translation_mm\", \"quaternion_wxyz\"}, \"depth_scale\": 5000}";

/// Reads the camera. Without `depth` its pictures are aligned with those of colour already.
pub(super) fn read(path: &Path) -> Result<RgbdCamera, SequenceError> {
    let unreadable = |problem: String| SequenceError::Unreadable { file: path.to_owned(), problem, needed: NEEDED };
    let metadata = std::fs::metadata(path).map_err(|error| unreadable(system_words(&error)))?;
    if metadata.len() > MAX_BYTES {
        return Err(unreadable(format!("it has {} bytes, a camera's file at most {MAX_BYTES}", metadata.len())));
    }
    let text = std::fs::read_to_string(path).map_err(|error| unreadable(system_words(&error)))?;
    let file: Value = serde_json::from_str(text.trim_start_matches('\u{feff}'))
        .map_err(|error| unreadable(format!("it is no JSON: {error}")))?;
    let reader = Reader { path, file: &file };
    let color = reader.intrinsics("color")?;
    let depth = if file.get("depth").is_some() { reader.intrinsics("depth")? } else { color };
    let color_from_depth =
        if file.get("color_from_depth").is_some() { reader.color_from_depth()? } else { Transform::identity() };
    let depth_units_per_m = match file.get("depth_scale") {
        None => DEPTH_SCALE,
        Some(_) => reader.number("depth_scale", "/depth_scale", "the units of depth in a metre, above 0", |value| {
            (1e-3..=1e7).contains(&value)
        })?,
    };
    Ok(RgbdCamera { color, depth, color_from_depth, depth_units_per_m })
}

/// The camera as a file.
pub(super) fn written(camera: &RgbdCamera) -> Value {
    let intrinsics = |of: &Intrinsics| {
        json!({
            "width": of.width, "height": of.height, "fx": of.fx, "fy": of.fy, "cx": of.cx, "cy": of.cy,
        })
    };
    json!({
        "color": intrinsics(&camera.color),
        "depth": intrinsics(&camera.depth),
        "color_from_depth": {
            "translation_mm": camera.color_from_depth.translation_mm().as_slice(),
            "quaternion_wxyz": camera.color_from_depth.quaternion_wxyz(),
        },
        "depth_scale": camera.depth_units_per_m,
    })
}

struct Reader<'a> {
    path: &'a Path,
    file: &'a Value,
}

impl Reader<'_> {
    fn refused(&self, place: &str, found: &str, needed: &str) -> SequenceError {
        SequenceError::Camera {
            file: self.path.to_owned(),
            place: place.to_owned(),
            found: found.to_owned(),
            needed: needed.to_owned(),
        }
    }

    fn number(
        &self,
        place: &str,
        pointer: &str,
        needed: &str,
        is_right: impl Fn(f64) -> bool,
    ) -> Result<f64, SequenceError> {
        let found = self.file.pointer(pointer);
        found
            .and_then(Value::as_f64)
            .filter(|value| is_right(*value))
            .ok_or_else(|| self.refused(place, &described(found), needed))
    }

    fn intrinsics(&self, camera: &str) -> Result<Intrinsics, SequenceError> {
        let number = |field: &str| {
            self.number(&format!("{camera}.{field}"), &format!("/{camera}/{field}"), "a number", f64::is_finite)
        };
        let side = |field: &str| {
            let (place, pointer) = (format!("{camera}.{field}"), format!("/{camera}/{field}"));
            let needed = "a whole number of pixels";
            let value =
                self.number(&place, &pointer, needed, |value| value.fract() == 0.0 && (0.0..1e9).contains(&value))?;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and below a billion")]
            Ok(value as u32)
        };
        let size = [side("width")?, side("height")?];
        Intrinsics::new(size, [number("fx")?, number("fy")?], [number("cx")?, number("cy")?]).map_err(|error| {
            match error {
                CameraError::Size { width, height } => {
                    let needed = format!("1 to {} each", Intrinsics::MAX_SIDE_PX);
                    self.refused(camera, &format!("{width} × {height} pixels"), &needed)
                }
                CameraError::Value { name, value, needed } => {
                    self.refused(&format!("{camera}.{name}"), &value.to_string(), needed)
                }
            }
        })
    }

    fn color_from_depth(
        &self,
    ) -> Result<Transform<crate::geometry::Sensor, crate::geometry::DepthCamera>, SequenceError> {
        let numbers = |field: &str, count: usize, most: f64| {
            let place = format!("color_from_depth.{field}");
            let found = self.file.pointer(&format!("/color_from_depth/{field}"));
            let values: Option<Vec<f64>> =
                found.and_then(Value::as_array).and_then(|list| list.iter().map(Value::as_f64).collect());
            values.filter(|list| list.len() == count && list.iter().all(|value| value.abs() <= most)).ok_or_else(|| {
                self.refused(&place, &described(found), &format!("a list of {count} numbers up to {most}"))
            })
        };
        let translation = numbers("translation_mm", 3, 1e4)?;
        let wxyz = numbers("quaternion_wxyz", 4, 1.1)?;
        let quaternion = Quaternion::new(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
        if (quaternion.norm() - 1.0).abs() > QUATERNION_NORM_TOLERANCE {
            let found = format!("one of length {}", quaternion.norm());
            return Err(self.refused("color_from_depth.quaternion_wxyz", &found, "a unit quaternion"));
        }
        Ok(Transform::from_parts(Vec3::from_row_slice(&translation), UnitQuaternion::new_normalize(quaternion)))
    }
}

fn described(found: Option<&Value>) -> String {
    const MOST: usize = 40;
    match found {
        None => "nothing".to_owned(),
        Some(value) => on_one_line(&value.to_string()).chars().take(MOST).collect(),
    }
}
