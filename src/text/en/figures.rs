//! The figures of a report: their captions, and what stands in them where the window says nothing of the kind.

/// What stands before a station's name at the head of a small plot.
#[must_use]
pub fn station(label: &str) -> String {
    format!("Station {label}")
}

/// The same with the number of the capture, where there are several.
#[must_use]
pub fn station_step(label: &str, step: usize) -> String {
    format!("Station {label}, step {step}")
}

/// Caption of a station's profile with its arc.
#[must_use]
pub fn arc_title(label: &str, step: usize) -> String {
    format!("Profile of station {label}, step {step}, with the arc found in it and its residuals")
}

/// The same for a plate or a tip.
#[must_use]
pub fn edge_title(label: &str, feature: &str) -> String {
    format!("Profile of station {label} with the {feature} found in it and the residuals of its flanks")
}

/// Caption of the profiles of all stations.
#[must_use]
pub fn profiles_title(page: usize, num_pages: usize) -> String {
    format!("First usable profile of each station with its residuals{}", page_of(page, num_pages))
}

/// Caption of a station's curve.
#[must_use]
pub fn curve_title(label: &str) -> String {
    format!(
        "Section radius against the travel at station {label}: the whole curve, its peak ± σ, and the published stop"
    )
}

/// Caption of the curves of all stations.
#[must_use]
pub fn curves_title(page: usize, num_pages: usize) -> String {
    format!("Section radius against the travel at each station{}", page_of(page, num_pages))
}

fn page_of(page: usize, num_pages: usize) -> String {
    if num_pages > 1 { format!(" ({page} of {num_pages})") } else { String::new() }
}

/// The centre of a section beside its cross, or the point of an edge.
#[must_use]
pub fn centre(x_mm: &str, z_mm: &str) -> String {
    format!("x {x_mm}, z {z_mm}")
}

/// What a plot of an arc tells a reader who does not see it.
#[must_use]
pub fn arc_alt(title: &str, num_inliers: usize, num_outliers: usize, num_unused: usize, rms_um: &str) -> String {
    format!(
        "{title}: {num_inliers} inliers, {num_outliers} outliers, {num_unused} unused points, RMS residual {rms_um} µm."
    )
}

/// Legend of the points on what was found, without their number.
pub const INLIERS: &str = "inlier";
/// Legend of the points off it.
pub const OUTLIERS: &str = "outlier";
/// Legend of the points elsewhere.
pub const UNUSED: &str = "unused";
/// Legend of the fitted circle.
pub const SECTION: &str = "section";
/// Legend of the ball's outline.
pub const BALL: &str = "ball";
/// Legend of fitted lines.
pub const FLANKS: &str = "flanks";
/// Legend of the peak of a curve.
pub const PEAK: &str = "peak ± σ";
/// Legend of the published stop.
pub const PUBLISHED_STOP: &str = "published stop";
