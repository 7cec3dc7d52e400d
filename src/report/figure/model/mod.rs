//! What plots are made from, without a page or a window: shared by both, so that the same plot looks the same in either.

mod curve;
mod journey;
mod profile;
mod stations;

pub use curve::{Curve, Peak, curve_extent, curve_points, residual_range, sweep_of};
pub use journey::{Journey, Values, Ways};
pub use profile::{
    EdgeModel, Found, ProfileModel, ProfilePoint, SectionModel, ball_radius_mm, extent, inliers, profile_model,
    residual_extent, scan_model,
};
pub use stations::station_bars;
