//! What the commands print.

use crate::calibrate::{Edge, Method, Mount, Verdict, VerdictReason, Warning};
use crate::diagnose::Reason;
use crate::session::{Session, Target};

use crate::text::digits;

use super::diagnosis::{fault_message, target_word};
use super::edges::edge_name;
use super::{method_name, method_short_name, plural, verdict_name, warning_message};

/// The verdict with its reason, in one line.
#[must_use]
pub fn verdict_line(verdict: Verdict, reason: Reason<'_>, warnings: &[Warning], session: &Session) -> String {
    let name = verdict_name(verdict);
    let reason = match reason {
        Reason::Solution(reason) => reason,
        Reason::Finding(finding) => return format!("{name}: {}", fault_message(&finding.fault, session)),
    };
    match reason {
        VerdictReason::WorkspacePoint(std_mm) => {
            format!(
                "{name}: a point in the workspace is known to ± {} mm (1 σ, 3D)",
                digits::value(std_mm, Some(std_mm))
            )
        }
        VerdictReason::LeaveOneOut { left_out_mm, std_mm } => format!(
            "{name}: a point in the workspace is known to ± {} mm (1 σ, 3D); a station predicted by the others is missed by {} mm (RMS)",
            digits::value(std_mm, Some(std_mm)),
            digits::value(left_out_mm, Some(left_out_mm))
        ),
        VerdictReason::Warning(idx) => {
            let message = warnings.get(idx).map_or_else(String::new, warning_message);
            format!("{name}: {message}")
        }
        VerdictReason::NoRedundancy => format!("{name}: nothing is left over to judge by; add stations"),
    }
}

/// A label that no station has.
#[must_use]
pub fn no_such_station(label: &str, session: &Session) -> String {
    let labels: Vec<&str> = session.stations.iter().map(|station| station.label.as_str()).collect();
    format!("--without: found {label}, expected the label of a station: {}", labels.join(", "))
}

/// Heads the result to use.
#[must_use]
pub fn answer_head(method: Method) -> String {
    format!("Answer: {} ({})", method_name(method), method.id())
}

/// The session has more targets than the one that is solved here.
#[must_use]
pub fn further_line(session: &Session) -> String {
    /// More are counted.
    const MAX_NAMES: usize = 5;
    let further = &session.further;
    let mut names: Vec<String> = further.iter().take(MAX_NAMES).map(|further| further.name.clone()).collect();
    names.extend((further.len() > MAX_NAMES).then(|| format!("{} more", further.len() - MAX_NAMES)));
    format!(
        "not used here: the further target{} {}; `handeye verify` judges this result on {}, and solves all together",
        plural(further.len()),
        names.join(", "),
        if further.len() == 1 { "it" } else { "them" }
    )
}

/// Nothing is wrong with a result that is not good all the same.
#[must_use]
pub const fn nothing_wrong_but_poorly_known(target: &Target, has_next_pose: bool) -> &'static str {
    if matches!(target, Target::Rgbd { .. }) {
        "Nothing is wrong with the session, but the result is not well known. Record a longer way, with larger turns about all axes."
    } else if has_next_pose {
        "Nothing is wrong with the session, but the result is not well known. Add stations; the next pose helps most."
    } else {
        "Nothing is wrong with the session, but the result is not well known. Add stations with other orientations."
    }
}

/// Why no poses are planned from a result.
#[must_use]
pub fn mend_before_planning(code: &str, message: &str) -> String {
    format!("no stations are planned from a wrong result: [{code}] {message} Mend that first; `handeye solve` says how")
}

/// There are neither stations nor a rough cell.
#[must_use]
pub fn nothing_to_plan_from(reason: &str, target: &Target) -> String {
    let way_out = match target {
        Target::Ball { .. } => {
            "For a plan before anything is measured say roughly where things are: --sensor-at X Y Z A B C --ball-at X Y Z"
        }
        Target::Point => {
            "For a plan before anything is measured say roughly where things are: --sensor-at X Y Z A B C --tip-at X Y Z"
        }
        _ => "Measure three stations at each edge first, tilted and turned as far as the line allows",
    };
    format!("{}. {way_out}", reason.trim_end_matches('.'))
}

/// What a plan is for, and what is known before it.
#[must_use]
pub fn plan_head(session: &Session, num_stations: usize, method: Option<Method>, std_mm: Option<f64>) -> String {
    let captures = match session.target {
        Target::Ball { .. } => "sweeps of 21 captures, a profiler of 0.01 mm",
        _ => "single captures, a profiler that finds its target to 0.03 mm",
    };
    let rests_on = method.map_or_else(
        || {
            format!(
                "before anything is measured, for {captures} and the robot's stated noise (0.02 mm, 0.005° where none is)"
            )
        },
        |method| {
            let std = std_mm.map_or_else(|| "not known yet".to_owned(), |std_mm| format!("± {std_mm:.3} mm"));
            format!("a point in the workspace now: {std} (1 σ, 3D; {})", method_short_name(method))
        },
    );
    format!("{} · {num_stations} station{} to measure next\n{rests_on}\n\n", session.name, plural(num_stations))
}

/// Heads of a plan's columns.
#[must_use]
pub fn plan_columns(angle_names: [&str; 3], has_edges: bool) -> String {
    let edge = if has_edges { "edge " } else { "" };
    let [a, b, c] = angle_names.map(|name| format!("{name}/°"));
    format!(
        "no. {edge}{:>10} {:>10} {:>10}  {a:>9} {b:>9} {c:>9}  {:>6} {:>8} {:>6}  {:>9}\n",
        "x/mm", "y/mm", "z/mm", "tilt/°", "towards°", "turn/°", "σ then/mm"
    )
}

/// One station of a plan.
#[must_use]
pub fn plan_row(
    number: usize,
    edge: Option<Edge>,
    pose_mm: &[String; 3],
    angles_deg: &[String; 3],
    turned_deg: &[String; 3],
    std_mm: &str,
) -> String {
    let ([x, y, z], [a, b, c], [tilt, azimuth, spin]) = (pose_mm, angles_deg, turned_deg);
    let edge = edge.map_or_else(String::new, |edge| format!("{:<5}", edge_name(edge)));
    format!(
        "{number:<3} {edge}{x:>10} {y:>10} {z:>10}  {a:>9} {b:>9} {c:>9}  {tilt:>6} {azimuth:>8} {spin:>6}  {std_mm:>9}\n"
    )
}

/// What a plan's columns mean.
#[must_use]
pub fn plan_foot(session: &Session) -> String {
    let Session { target, mount, robot, .. } = session;
    let what = target_word(target);
    let carrier = match mount {
        Mount::OnFlange => "flange in the base".to_owned(),
        Mount::Fixed => format!("flange (with the {what}) in the base"),
    };
    let (at, to_do, of) = match target {
        Target::Ball { .. } => (" at the first capture", "then sweep across the ball as at the other stations", ""),
        Target::RightAnglePlate => ("", "the line crosses the edge that is named", " at that edge"),
        _ => ("", "there bring the line onto the tip", ""),
    };
    format!(
        "\nposes: {carrier}{at}, {}; {to_do}\n\
         tilt, towards, turn: of the range axis from the middle of the stations{of} · σ then: with this station and those above\n",
        robot.notation.convention.label
    )
}
