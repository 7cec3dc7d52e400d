//! Wording of reports.

/// Section.
pub const VERDICT: &str = "Verdict";
/// Section.
pub const CALIBRATION: &str = "Calibration";
/// Section.
pub const SETUP: &str = "Set-up";
/// Section.
pub const METHODS: &str = "Methods side by side";
/// Section.
pub const FIGURES: &str = "Figures";
/// Section.
pub const DIAGNOSIS: &str = "Diagnosis";
/// Section.
pub const VALIDATION: &str = "Validation";
/// Section.
pub const VERIFICATION: &str = "Verification on other data";
/// Section.
pub const STATIONS: &str = "Stations";
/// Section.
pub const TOOL_FRAMES: &str = "For the controller";
/// Section.
pub const INPUTS: &str = "Inputs and program";
/// Section.
pub const REFERENCES: &str = "References";
/// Section.
pub const SIGNATURE: &str = "Signature";
