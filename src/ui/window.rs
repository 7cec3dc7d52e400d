//! The operating system's window around the [`Shell`], and what is said where there can be none.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::path::PathBuf;

use eframe::NativeOptions;
use egui::{Context, Ui, ViewportBuilder};

use crate::app::{Command, RecoverySettings};
use crate::text::shell as words;

use super::persisted::Persisted;
use super::shell::Shell;

/// By this name the system knows the program; what it remembers is in a folder of that name.
const APP_ID: &str = "handeye";

/// How the window starts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Start {
    /// A session file to open.
    pub file: Option<PathBuf>,
    /// Where copies of unsaved work are kept for a run that ends badly; none are kept without.
    pub recovery_folder: Option<PathBuf>,
}

/// Why there is no window; its `Display` is one line that says what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WindowError {
    /// No display to open it on.
    NoDisplay,
    /// A display is named, but it does not answer.
    DeadDisplay,
    /// Libraries of the window system are missing.
    MissingLibraries,
    /// No OpenGL.
    NoOpenGl,
}

impl fmt::Display for WindowError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reason = match self {
            Self::NoDisplay => words::NO_DISPLAY,
            Self::DeadDisplay => words::DEAD_DISPLAY,
            Self::MissingLibraries => words::MISSING_LIBRARIES,
            Self::NoOpenGl => words::NO_OPENGL,
        };
        write!(formatter, "{reason}; {}", words::WITHOUT_WINDOW)
    }
}

impl std::error::Error for WindowError {}

/// The [`Shell`] as eframe drives it.
pub struct Window {
    shell: Shell,
}

impl Window {
    /// Takes up what was remembered and opens the file asked for.
    #[must_use]
    pub fn new(creation: &eframe::CreationContext<'_>, start: Start) -> Self {
        let persisted: Option<Persisted> =
            creation.storage.and_then(|storage| eframe::get_value(storage, Persisted::KEY));
        let mut shell = Shell::new(&creation.egui_ctx, persisted.unwrap_or_default());
        if let Some(folder) = start.recovery_folder {
            shell.workbench_mut().keep_copies(RecoverySettings::new(folder));
        }
        if let Some(file) = start.file {
            shell.request(Command::Open(file));
        }
        Self { shell }
    }

    /// What is inside.
    #[must_use]
    pub const fn shell(&self) -> &Shell {
        &self.shell
    }

    /// The same, to be driven by a test.
    pub const fn shell_mut(&mut self) -> &mut Shell {
        &mut self.shell
    }
}

impl eframe::App for Window {
    fn logic(&mut self, ctx: &Context, _frame: &mut eframe::Frame) {
        self.shell.logic(ctx);
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.shell.ui(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, Persisted::KEY, self.shell.persisted());
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        self.shell.end();
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// [`WindowError`] if there can be no window here.
pub fn run(mut start: Start) -> Result<(), WindowError> {
    if !has_display() {
        return Err(WindowError::NoDisplay);
    }
    let options = NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title(words::PROGRAM)
            .with_app_id(APP_ID)
            .with_inner_size([1440.0, 900.0])
            .with_min_inner_size([960.0, 640.0])
            .with_drag_and_drop(true),
        // The same letters on every machine.
        system_font_fallback: false,
        ..NativeOptions::default()
    };
    start.recovery_folder =
        start.recovery_folder.or_else(|| eframe::storage_dir(APP_ID).map(|folder| folder.join("recovery")));
    // A missing libxkbcommon-x11 makes the window system panic instead of failing: that panic is answered with
    // words, so its own message is kept from the terminal. Once the window stands, panics speak again.
    let hook = std::sync::Arc::new(std::sync::Mutex::new(Some(take_hook())));
    set_hook(Box::new(|_| {}));
    let restore_hook = {
        let hook = std::sync::Arc::clone(&hook);
        move || {
            if let Some(hook) = hook.lock().ok().and_then(|mut hook| hook.take()) {
                set_hook(hook);
            }
        }
    };
    let restore_once_open = restore_hook.clone();
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native(
            APP_ID,
            options,
            Box::new(move |creation| {
                restore_once_open();
                Ok(Box::new(Window::new(creation, start)))
            }),
        )
    }));
    let has_opened = hook.lock().is_ok_and(|hook| hook.is_none());
    restore_hook();
    match outcome {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => {
            log::debug!("{error}");
            Err(explain(&error))
        }
        // A fault of the program itself, long after the window opened, is not the window system's.
        Err(panic) if has_opened => std::panic::resume_unwind(panic),
        Err(_) => Err(WindowError::MissingLibraries),
    }
}

fn explain(error: &eframe::Error) -> WindowError {
    let text = format!("{error:?}");
    if text.contains("LibraryOpenError") || text.contains("cannot open shared object") {
        WindowError::MissingLibraries
    } else if matches!(error, eframe::Error::NoGlutinConfigs(..) | eframe::Error::Glutin(_)) {
        WindowError::NoOpenGl
    } else {
        WindowError::DeadDisplay
    }
}

/// Whether the environment names a display; an empty variable counts as none.
fn has_display() -> bool {
    !cfg!(target_os = "linux")
        || ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"]
            .into_iter()
            .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_is_one_line_that_says_what_works_instead() {
        for error in
            [WindowError::NoDisplay, WindowError::DeadDisplay, WindowError::MissingLibraries, WindowError::NoOpenGl]
        {
            let line = error.to_string();
            assert!(!line.contains('\n'), "{line}");
            assert!(line.contains("handeye solve FILE"), "{line}");
            assert!(!line.contains("winit"), "{line}");
        }
    }
}
