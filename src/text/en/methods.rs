//! Names of the methods and verdicts.

use crate::calibrate::{ClosedForm, Method, PoseFault, Verdict};

/// The method's name in a table head.
#[must_use]
pub const fn method_name(method: Method) -> &'static str {
    match method {
        Method::BallFixedPoint => "Fixed point",
        Method::BallMaxArcStep => "Largest arc, published stop",
        Method::BallMaxArc => "Largest arc, whole curve",
        Method::BallBundle => "Bundle of all points",
        Method::PlateOrthogonal => "Orthogonal edges, published",
        Method::PlateBundle => "Bundle of both edges",
        Method::FixedPoint => "Fixed point of a tip",
        Method::Motion => "Motions, A X = X B",
    }
}

/// A few words where space is short.
#[must_use]
pub const fn method_short_name(method: Method) -> &'static str {
    match method {
        Method::BallFixedPoint => "fixed point",
        Method::BallMaxArcStep => "published stop",
        Method::BallMaxArc => "whole curve",
        Method::BallBundle => "bundle",
        Method::PlateOrthogonal => "orthogonal",
        Method::PlateBundle => "plate bundle",
        Method::FixedPoint => "tip",
        Method::Motion => "motion",
    }
}

/// What the method does, in one sentence.
#[must_use]
pub const fn method_description(method: Method) -> &'static str {
    match method {
        Method::BallFixedPoint => {
            "One section a station; the ball's centre is ±√(R² − l²) beside the laser plane (Lin & Mu 2019, eq. 1–2)"
        }
        Method::BallMaxArcStep => "Steps along Y and stops at the first section with l ≥ R (Lin & Mu 2019, eq. 3)",
        Method::BallMaxArc => "Fits the whole radius-vs-step curve with the real pose of every step",
        Method::BallBundle => "All points of all profiles at once: the answer to use",
        Method::PlateOrthogonal => {
            "Vectors between points of one edge, perpendicular to those of the other (Chen et al. 2023, eq. 7, squared)"
        }
        Method::PlateBundle => "All edge points on two lines that meet at a right angle: the answer to use",
        Method::FixedPoint => "A tip touched by the laser line from several poses stays where it is",
        Method::Motion => {
            "The flange's motions against those that the sensor sees (A X = X B), weighed by the noise of both: the answer to use"
        }
    }
}

/// The verdict in words.
#[must_use]
pub const fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Good => "Good",
        Verdict::Usable => "Usable",
        Verdict::NotUsable => "Not usable",
    }
}

/// The verdict in result files.
#[must_use]
pub const fn verdict_id(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Good => "good",
        Verdict::Usable => "usable",
        Verdict::NotUsable => "not-usable",
    }
}

/// What would explain a pose that was left out, in result files.
#[must_use]
pub const fn pose_fault_id(fault: PoseFault) -> &'static str {
    match fault {
        PoseFault::Inverted => "inverted",
        PoseFault::Flipped => "flipped",
        PoseFault::Orientation => "orientation",
        PoseFault::Place => "place",
        PoseFault::Both => "both",
    }
}

/// A published closed form, with its paper.
#[must_use]
pub const fn closed_form_name(form: ClosedForm) -> &'static str {
    match form {
        ClosedForm::Tsai => "Tsai & Lenz 1989",
        ClosedForm::Park => "Park & Martin 1994",
        ClosedForm::Horaud => "Horaud & Dornaika 1995",
        ClosedForm::Andreff => "Andreff et al. 2001",
        ClosedForm::Daniilidis => "Daniilidis 1999",
        ClosedForm::Shah => "Shah 2013 (A X = Z B)",
        ClosedForm::Li => "Li et al. 2010 (A X = Z B)",
    }
}

/// The verdict's shape, so that colour is never alone.
#[must_use]
pub const fn verdict_mark(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Good => "✔",
        Verdict::Usable => "!",
        Verdict::NotUsable => "✖",
    }
}
