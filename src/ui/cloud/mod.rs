//! A cloud of points in space, to be turned, moved and zoomed: thinned to what the screen can show, and drawn into a picture
//! with a depth buffer by ourselves, which is quick on every machine.

mod camera;
mod marks;
mod raster;
mod thinned;
mod view;

pub use camera::Camera;
pub use raster::{Canvas, draw};
pub use thinned::{AT_REST, IN_MOTION, Thinned};
pub use view::{CloudResponse, CloudScene, CloudView, Legend, Tool};
