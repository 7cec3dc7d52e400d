//! A picture of one step, drawn without a display.

use std::path::{Path, PathBuf};
use std::sync::mpsc::sync_channel;

use egui::{Context, Pos2, RawInput, Rect, vec2};
use image::RgbaImage;
use thiserror::Error;

use crate::app::workbench::comparing::{Side, Sides};
use crate::app::{Command, NoticeKind};

use super::persisted::{Persisted, ThemeChoice};
use super::rail::Step;
use super::shell::Shell;
use super::software_renderer::SoftwareRenderer;
use super::verify::Section;

/// Frames drawn before the picture is taken: tables and plots settle their sizes over the first few.
const NUM_SETTLING_FRAMES: usize = 6;

/// Why there is no picture.
#[derive(Debug, Error)]
pub enum ScreenshotError {
    /// The session could not be opened.
    #[error("{0}")]
    Session(String),
    /// The picture could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// Where to.
        path: PathBuf,
        /// What went wrong.
        source: image::ImageError,
    },
}

/// What a picture shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scene {
    /// The session, or none.
    pub session: Option<PathBuf>,
    /// The step of the rail.
    pub step: Step,
    /// The section of Verify; none for that which comes up by itself.
    pub section: Option<Section>,
    /// What the section is about: two files to be compared, of which the second may be missing for the session itself, or a
    /// folder of results.
    pub of: Vec<PathBuf>,
    /// Files or a folder in the import's preview.
    pub import: Vec<PathBuf>,
}

/// Draws a scene at `size` pixels, and writes it to `out` as PNG.
///
/// # Errors
/// [`ScreenshotError`] if a file cannot be read or the picture not be written.
pub fn screenshot(scene: &Scene, theme: ThemeChoice, size: [u32; 2], out: &Path) -> Result<(), ScreenshotError> {
    let image = render_scene(scene, theme, size)?;
    image
        .save_with_format(out, image::ImageFormat::Png)
        .map_err(|source| ScreenshotError::Write { path: out.to_owned(), source })
}

/// The picture of a step with a session, or of the start page without one, not written.
///
/// # Errors
/// [`ScreenshotError::Session`] if the session cannot be read.
pub fn render(
    session: Option<&Path>,
    step: Step,
    theme: ThemeChoice,
    size: [u32; 2],
) -> Result<RgbaImage, ScreenshotError> {
    render_scene(&Scene { session: session.map(Path::to_owned), step, ..Scene::default() }, theme, size)
}

fn render_scene(scene: &Scene, theme: ThemeChoice, size: [u32; 2]) -> Result<RgbaImage, ScreenshotError> {
    let ctx = Context::default();
    let (sender, woken) = sync_channel(1);
    let mut shell = Shell::new(&ctx, Persisted { theme, ..Persisted::default() });
    ctx.set_request_repaint_callback(move |_| {
        // A full channel already holds the news that there is news.
        sender.try_send(()).ok();
    });
    if let Some(path) = &scene.session {
        shell.request(Command::Open(path.clone()));
    }
    let mut renderer = SoftwareRenderer::default();
    let mut frames = Frames { ctx, size, renderer: &mut renderer };
    // Also without news it looks again after a while: a wake-up may have come before the callback was set.
    let wait = |frames: &mut Frames<'_>, shell: &mut Shell| {
        while shell.is_busy() {
            frames.draw(shell);
            woken.recv_timeout(std::time::Duration::from_millis(20)).ok();
        }
    };
    wait(&mut frames, &mut shell);
    scene.begin(&mut shell);
    wait(&mut frames, &mut shell);
    let failed = shell.workbench().notices().iter().find(|notice| notice.kind == NoticeKind::Error);
    if let Some(notice) = failed {
        return Err(ScreenshotError::Session(notice.message.clone()));
    }
    shell.go_to(scene.step);
    // A step may begin work of its own when it is first seen.
    frames.draw(&mut shell);
    wait(&mut frames, &mut shell);
    for _ in 1..NUM_SETTLING_FRAMES {
        frames.draw(&mut shell);
    }
    Ok(frames.picture(&mut shell))
}

impl Scene {
    /// Asks for what it shows beside the session.
    fn begin(&self, shell: &mut Shell) {
        if let Some(section) = self.section {
            shell.verify_mut().go_to(section);
        }
        for (side, path) in self.of.iter().enumerate() {
            match self.section {
                Some(Section::CompareResults) => shell.verify_mut().take_compared(side, path),
                Some(Section::ResultHistory) => {
                    shell.verify_mut().take_result_folder(path);
                    shell.request(Command::ReadResultHistory(path.clone()));
                }
                _ => {}
            }
        }
        if self.section == Some(Section::CompareResults)
            && let Some(from) = self.of.first()
        {
            let to = self.of.get(1).map_or(Side::OpenSession, |path| Side::File(path.clone()));
            let sides = Sides { from: Side::File(from.clone()), to, points_in_sensor_mm: Vec::new() };
            shell.request(Command::CompareCalibrations(Box::new(sides)));
        }
        if !self.import.is_empty() {
            shell.request(Command::Import(self.import.clone()));
        }
    }
}

struct Frames<'a> {
    ctx: Context,
    size: [u32; 2],
    renderer: &'a mut SoftwareRenderer,
}

impl Frames<'_> {
    fn draw(&mut self, shell: &mut Shell) -> egui::FullOutput {
        shell.logic(&self.ctx);
        let [width, height] = self.size.map(to_points);
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(width, height))),
            focused: true,
            ..RawInput::default()
        };
        let ctx = self.ctx.clone();
        let mut output = ctx.run_ui(input, |ui| shell.ui(ui));
        self.renderer.update_textures(&mut output.textures_delta);
        output
    }

    fn picture(&mut self, shell: &mut Shell) -> RgbaImage {
        let output = self.draw(shell);
        let primitives = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        self.renderer.paint(&primitives, output.pixels_per_point, self.size)
    }
}

#[expect(clippy::cast_precision_loss, reason = "sides of pictures are far below 2^24")]
const fn to_points(pixels: u32) -> f32 {
    pixels as f32
}
