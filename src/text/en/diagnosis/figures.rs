//! Plots of the evidence, and lines of figures.

use crate::calibrate::validation::{Bootstrap, Influence, Normality, SplitHalf};
use crate::calibrate::{Edge, EstimatedRadius, Mount, NoiseModel, Solution, Uncertainty};
use crate::diagnose::{CurveAxis, Plot};
use crate::session::{Robot, Target};
use crate::text::digits::{decimals_for, fixed};
use crate::text::edges::edge_name;

use super::words::{along, chance, size, target_word, with_std};

/// Heading of a plot of the evidence.
#[must_use]
pub fn plot_title(plot: &Plot, target: &Target) -> String {
    let fixed_words = match plot {
        Plot::Stations(_) if *target == Target::RightAnglePlate => {
            "How far each station's point is off its edge as the others have it"
        }
        Plot::Stations(_) => {
            return format!("How far each station's {} is from where the others have it", target_word(target));
        }
        Plot::Readings(_) => "Residual of each way to read the poses",
        Plot::Curve { axis: CurveAxis::RadiusMm, .. } => "Residual over the ball's radius",
        Plot::Curve { axis: CurveAxis::ProfileScale, .. } => "Residual over the scale of the profiles",
        Plot::Trend { .. } => return format!("Shift of the {} in the order of recording", target_word(target)),
        Plot::Direction { .. } => "Rotation about the three axes of the flange",
        Plot::Steps(_) => "Travel by the poses over commanded travel",
    };
    fixed_words.to_owned()
}

/// Titles of a plot's axes: across, upwards.
#[must_use]
pub const fn plot_axes(plot: &Plot) -> [&'static str; 2] {
    match plot {
        Plot::Stations(_) => ["station", "error / mm"],
        Plot::Readings(_) => ["residual / mm", ""],
        Plot::Curve { axis: CurveAxis::RadiusMm, .. } => ["radius / mm", "residual / mm"],
        Plot::Curve { axis: CurveAxis::ProfileScale, .. } => ["factor", "residual / mm"],
        Plot::Trend { .. } => ["station", "shift / mm"],
        Plot::Direction { .. } => ["axis", "rotation / °"],
        Plot::Steps(_) => ["commanded / mm", "by the poses / mm"],
    }
}

/// Calibrations from two halves of the stations.
#[must_use]
pub fn split_half_line(halves: &SplitHalf) -> String {
    format!(
        "two halves of the stations: {} mm apart (median), at most {} mm; {} mm is to be expected",
        size(halves.median_mm),
        size(halves.max_mm),
        size(halves.expected_mm)
    )
}

/// Whether the residuals look like noise.
#[must_use]
pub fn normality_line(normality: &Normality) -> String {
    if normality.p_value < 0.01 {
        return format!("residuals: not normally distributed; by chance this happens {}", chance(normality.p_value));
    }
    if normality.p_value < 0.05 {
        return format!("residuals: hardly normally distributed (p = {:.2})", normality.p_value);
    }
    format!("residuals: normally distributed (p = {:.2})", normality.p_value)
}

/// The station that the result depends on most.
#[must_use]
pub fn influence_line(influence: &Influence) -> String {
    format!(
        "most influential: station {}; leaving it out moves the workspace point by {} mm (studentised residual {:.1})",
        influence.label,
        size(influence.moves_workspace_point_mm),
        influence.studentised_residual
    )
}

/// The spread over stations drawn with replacement.
#[must_use]
pub fn bootstrap_line(bootstrap: &Bootstrap) -> String {
    let num_solved = bootstrap.distances_mm.len();
    let failed = match bootstrap.num_failed {
        0 => String::new(),
        num_failed => format!("; {num_failed} gave no result"),
    };
    if num_solved == 0 {
        return format!("bootstrap: too few of {} draws gave a result", bootstrap.num_failed);
    }
    format!(
        "bootstrap, {} draws: ± {} mm at the workspace point, 95 % within {} mm{failed}",
        num_solved + bootstrap.num_failed,
        size(bootstrap.std_mm),
        size(bootstrap.within_95_mm)
    )
}

/// How well the workspace point is known, and where worst.
#[must_use]
pub fn accuracy_line(uncertainty: &Uncertainty, mount: Mount) -> String {
    let (weakest, std_mm) = uncertainty.weakest_direction();
    format!(
        "workspace point: 95 % within {} mm; weakest {}, ± {} mm",
        size(uncertainty.workspace_point_95_mm),
        along(weakest, mount),
        size(std_mm)
    )
}

/// The noise of the robot: what the session states, and what the weights stand for where the data refute that.
#[must_use]
pub fn noise_line(noise: &NoiseModel, robot: &Robot) -> String {
    let angle = |std_rad: f64| size(std_rad.to_degrees());
    let stated = robot.position_std_mm.zip(robot.orientation_std_deg).filter(|_| noise.is_stated);
    let (position_std_mm, orientation_std_deg) =
        stated.unwrap_or((noise.position_std_mm, noise.orientation_std_rad.to_degrees()));
    let source = if stated.is_some() { "stated" } else { "estimated" };
    let is_refuted = stated.is_some() && noise.above_stated.is_some_and(|above| above.is_contradicted());
    let shown = if is_refuted {
        format!("; the data show {} mm, {}°", size(noise.position_std_mm), angle(noise.orientation_std_rad))
    } else {
        String::new()
    };
    let common = if noise.station_position_std_mm > 0.0 || noise.station_orientation_std_rad > 0.0 {
        format!(
            "; common to the captures of a station {} mm, {}°",
            size(noise.station_position_std_mm),
            angle(noise.station_orientation_std_rad)
        )
    } else {
        String::new()
    };
    format!(
        "noise of the robot, {source}: {} mm, {}° a pose{shown}{common}",
        size(position_std_mm),
        size(orientation_std_deg)
    )
}

/// The radius that was estimated along with the calibration.
#[must_use]
pub fn estimated_radius_line(radius: &EstimatedRadius) -> String {
    format!("radius of the ball, estimated: {} mm", with_std(radius.radius_mm, radius.std_mm))
}

/// How the result follows the ball's radius.
#[must_use]
pub fn radius_line(solution: &Solution) -> String {
    /// A step that a calliper shows, mm.
    const STEP_MM: f64 = 0.01;
    let change = solution.change_by_radius * STEP_MM;
    format!(
        "per {STEP_MM} mm of radius the workspace point moves by {} mm, the translation by {} mm, the rotation by {}°",
        size(solution.workspace_point_by_radius.norm() * STEP_MM),
        size(change.fixed_rows::<3>(3).norm()),
        size(change.fixed_rows::<3>(0).norm().to_degrees())
    )
}

/// The station that would help most; position (mm) and angles (degrees) as the robot names them.
#[must_use]
pub fn next_pose_line(
    edge: Option<Edge>,
    position: &str,
    angles: &str,
    before_mm: Option<f64>,
    after_mm: Option<f64>,
) -> String {
    let at = edge.map_or_else(String::new, |edge| format!("edge {} at ", edge_name(edge)));
    let brings = before_mm.zip(after_mm).map_or_else(String::new, |(before_mm, after_mm)| {
        let decimals = decimals_for(Some(after_mm)).min(4);
        format!(": ± {} → {} mm at the workspace point", fixed(before_mm, decimals), fixed(after_mm, decimals))
    });
    format!("next pose: {at}{position}, {angles}{brings}")
}

/// Heading of what to do first.
#[must_use]
pub fn next_step_line(remedy: &str) -> String {
    format!("next step: {remedy}")
}

/// The figure of a finding.
#[must_use]
pub fn residual_falls([as_given_mm, mended_mm]: [f64; 2]) -> String {
    format!("(residual {} → {} mm)", size(as_given_mm), size(mended_mm))
}
