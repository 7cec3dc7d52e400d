//! What the window does by itself when a document, results or a notice have come.

use std::time::Duration;

use egui::{Context, ViewportCommand};

use crate::app::{Command, NoticeKind};
use crate::calibrate::Method;
use crate::session::Target;
use crate::text::document::READ_ONLY;
use crate::text::shell as words;
use crate::ui::Selection;
use crate::ui::arcs::ArcsState;
use crate::ui::compare::CompareState;
use crate::ui::diagnosis::DiagnosisState;
use crate::ui::poses::panel::PosesState;
use crate::ui::report::ReportState;

use super::Shell;

/// Seconds after which a notice of something done goes away by itself.
const DONE_NOTICE_SECONDS: f64 = 6.0;

impl Shell {
    pub(super) fn notice_new_document(&mut self, ctx: &Context) {
        let Some(document) = self.workbench.document() else {
            self.seen_document = 0;
            self.set_title(ctx, words::PROGRAM.to_owned());
            return;
        };
        if document.id() != self.seen_document {
            self.seen_document = document.id();
            let method = method_for(&document.session.target, self.selection.method);
            self.selection = Selection { method, ..Selection::default() };
            self.poses = PosesState::default();
            self.arcs = ArcsState::default();
            self.compare = CompareState::default();
            self.diagnosis = DiagnosisState::default();
            self.report = ReportState::default();
            self.start.forget_typing();
            self.seen_results = 0;
        }
        if let Some(path) = &document.path
            && self.persisted.recent_files.first() != Some(path)
        {
            self.persisted.note_recent(path);
        }
        let dot = if document.is_unsaved() { " ●" } else { "" };
        let mut name = document.title();
        if document.is_read_only {
            name = words::title_with(&name, READ_ONLY);
        }
        let title = format!("{name}{dot} – {}", words::PROGRAM);
        self.set_title(ctx, title);
    }

    pub(super) fn set_title(&mut self, ctx: &Context, title: String) {
        if self.window_title != title {
            self.window_title.clone_from(&title);
            ctx.send_viewport_cmd(ViewportCommand::Title(title));
        }
    }

    /// With a document's first results, shows the method to be trusted most among those that found something.
    pub(super) fn notice_new_results(&mut self) {
        let Some(results) = self.workbench.results() else { return };
        if self.seen_results == results.revision {
            return;
        }
        let is_first = self.seen_results == 0;
        self.seen_results = results.revision;
        let has_solution = |method: &Method| results.method(*method).is_some_and(|result| result.outcome.is_ok());
        if is_first || !has_solution(&self.selection.method) {
            let trusted = Method::BEST_FIRST.into_iter().find(has_solution);
            let of_target = || {
                let document = self.workbench.document()?;
                Some(method_for(&document.session.target, self.selection.method))
            };
            if let Some(method) = trusted.or_else(of_target) {
                self.selection.method = method;
            }
        }
    }

    pub(super) fn dismiss_done_notice(&mut self, ctx: &Context) {
        let now = ctx.input(|input| input.time);
        let newest = self.workbench.notices().iter().find(|notice| notice.kind == NoticeKind::Done);
        let Some(id) = newest.map(|notice| notice.id) else {
            self.done_notice = None;
            return;
        };
        let (known_id, since) = *self.done_notice.get_or_insert((id, now));
        if known_id != id {
            self.done_notice = Some((id, now));
        } else if now - since > DONE_NOTICE_SECONDS {
            self.workbench.apply(Command::DismissNotice(id));
            self.done_notice = None;
        }
        ctx.request_repaint_after(Duration::from_secs_f64(DONE_NOTICE_SECONDS));
    }
}

/// The method selected so far if it is one of the target's, else the target's that is to be trusted most.
fn method_for(target: &Target, selected: Method) -> Method {
    let of_target: &[Method] = match target {
        Target::Ball { .. } => &Method::BALL,
        Target::RightAnglePlate => &Method::PLATE,
        Target::Point => &Method::POINT,
        Target::Pose { .. } => &Method::MOTION,
        Target::Workpiece | Target::Rgbd { .. } => &[],
    };
    if of_target.contains(&selected) {
        return selected;
    }
    Method::BEST_FIRST.into_iter().find(|method| of_target.contains(method)).unwrap_or(selected)
}
