//! `handeye screenshot`: a step of the window as a picture, drawn without a display. The pictures in the docs are made so.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use crate::ui::persisted::ThemeChoice;
use crate::ui::screenshot::Scene;
use crate::ui::verify::Section;
use crate::ui::{self, Step};

use super::{EXIT_WRONG_INPUT, fail};

/// Arguments of `handeye screenshot`.
#[derive(Debug, Args)]
pub struct ScreenshotArgs {
    /// Session file; without it the start page is drawn
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// PNG file to write
    #[arg(long)]
    pub out: PathBuf,
    /// Step of the rail
    #[arg(long, value_enum, default_value_t = StepName::Session)]
    pub step: StepName,
    /// Section of Verify
    #[arg(long, value_enum)]
    pub section: Option<SectionName>,
    /// What the section is about: two files to compare (or one, with the session), or a folder of results
    #[arg(long, value_name = "PATH", requires = "section")]
    pub of: Vec<PathBuf>,
    /// Show the import's preview of these files
    #[arg(long, value_name = "PATH")]
    pub import: Vec<PathBuf>,
    /// Width, pixels
    #[arg(long, default_value_t = 1440, value_parser = clap::value_parser!(u32).range(640..=4096))]
    pub width: u32,
    /// Colours
    #[arg(long, value_enum, default_value_t = ThemeName::Light)]
    pub theme: ThemeName,
    /// Height, pixels
    #[arg(long, default_value_t = 900, value_parser = clap::value_parser!(u32).range(480..=4096))]
    pub height: u32,
}

/// The steps by their names on the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum StepName {
    /// The start page, or the session's overview
    Session,
    /// The live cell
    Capture,
    /// Profiles and curves
    Arcs,
    /// The pose table
    Poses,
    /// Methods side by side
    Compare,
    /// Findings, validation and the next poses
    Diagnosis,
    /// What the calibration is worth on other data
    Verify,
    /// The report and the tool frame
    Report,
}

/// The sections of Verify by their names on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "the names say it")]
pub enum SectionName {
    Distances,
    Stability,
    OtherTargets,
    Workpiece,
    Compare,
    History,
}

impl From<SectionName> for Section {
    fn from(name: SectionName) -> Self {
        match name {
            SectionName::Distances => Self::Distances,
            SectionName::Stability => Self::Stability,
            SectionName::OtherTargets => Self::CrossTarget,
            SectionName::Workpiece => Self::Workpiece,
            SectionName::Compare => Self::CompareResults,
            SectionName::History => Self::ResultHistory,
        }
    }
}

/// The themes by their names on the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum ThemeName {
    /// Dark on light
    Light,
    /// Light on dark
    Dark,
}

impl From<ThemeName> for ThemeChoice {
    fn from(name: ThemeName) -> Self {
        match name {
            ThemeName::Light => Self::Light,
            ThemeName::Dark => Self::Dark,
        }
    }
}

impl From<StepName> for Step {
    fn from(name: StepName) -> Self {
        match name {
            StepName::Session => Self::Session,
            StepName::Capture => Self::Capture,
            StepName::Arcs => Self::Arcs,
            StepName::Poses => Self::Poses,
            StepName::Compare => Self::Compare,
            StepName::Diagnosis => Self::Diagnosis,
            StepName::Verify => Self::Verify,
            StepName::Report => Self::Report,
        }
    }
}

/// Runs the command.
#[must_use]
pub fn run(args: &ScreenshotArgs) -> ExitCode {
    let scene = Scene {
        session: args.file.clone(),
        // A section is one of Verify.
        step: if args.section.is_some() { Step::Verify } else { args.step.into() },
        section: args.section.map(Section::from),
        of: args.of.clone(),
        import: args.import.clone(),
    };
    match ui::screenshot(&scene, args.theme.into(), [args.width, args.height], &args.out) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => fail(EXIT_WRONG_INPUT, &error),
    }
}
