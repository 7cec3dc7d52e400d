//! Wording of what happens to the document: history, recovery copies, files that others change.

use std::time::Duration;

use super::shell::count;

/// In place of a name that is not given.
pub const UNTITLED: &str = "untitled session";
/// Menu entry that shows the history.
pub const HISTORY_ENTRY: &str = "History…";
/// Title of the history window.
pub const HISTORY: &str = "History";
/// What a click on a step does.
pub const HISTORY_HINT: &str = "Click a step to go there. Nothing is lost until you change something.";
/// The state before all steps.
pub const AS_OPENED: &str = "as opened";
/// The state before the oldest step that is kept.
pub const OLDER_FORGOTTEN: &str = "older steps are forgotten";
/// An empty history.
pub const NO_HISTORY: &str = "Nothing has been changed since the session was opened.";

/// Name of a step's row.
#[must_use]
pub fn history_step(label: &str, is_present: bool) -> String {
    if is_present { format!("{label} (the present state)") } else { format!("Go to: {label}") }
}

/// Heading of what other runs have left behind.
pub const RECOVERY: &str = "Unsaved work was found";
/// Button.
pub const RECOVER: &str = "Recover";
/// Button.
pub const DISCARD: &str = "Discard";
/// Button that means it.
pub const DISCARD_FOR_GOOD: &str = "Discard for good";
/// Button.
pub const KEEP: &str = "Keep";
/// What recovering does.
pub const RECOVER_HINT: &str = "Opens the session as it was. Its file is changed only when you save";

/// Name of a button that recovers a session.
#[must_use]
pub fn recover(title: &str) -> String {
    format!("{RECOVER} {title}")
}

/// Name of a button that throws a session away.
#[must_use]
pub fn discard(title: &str) -> String {
    format!("{DISCARD} {title}")
}

/// What a copy is of.
#[must_use]
pub fn left_behind(age: Duration, num_edits: usize, last_edit: Option<&str>) -> String {
    let edits = match (num_edits, last_edit) {
        (0, _) => "never saved".to_owned(),
        (number, None) => format!("{} not saved", count(number, "edit")),
        (number, Some(last)) => format!("{} not saved, the last one: {last}", count(number, "edit")),
    };
    format!("Handeye ended without saving it {}; {edits}", ago(age))
}

/// A length of time before now.
#[must_use]
pub fn ago(age: Duration) -> String {
    let minutes = age.as_secs() / 60;
    match (minutes, minutes / 60, minutes / (24 * 60)) {
        (0, ..) => "less than a minute ago".to_owned(),
        (minutes, 0, _) => format!("{} ago", count(to_count(minutes), "minute")),
        (_, hours, 0) => format!("{} ago", count(to_count(hours), "hour")),
        (_, _, days) => format!("{} ago", count(to_count(days), "day")),
    }
}

fn to_count(number: u64) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}

/// Heading of the question before another program's changes are replaced.
#[must_use]
pub fn changed_title(title: &str) -> String {
    format!("{title} was changed by another program")
}
/// The question's explanation.
pub const CHANGED_HINT: &str = "It is not as it was when you opened or saved it last, so nothing was written. Save over it, and the other program's changes are lost. Reload it, and yours leave the window; undo brings them back.";
/// Button.
pub const SAVE_OVER: &str = "Save over it";
/// Button.
pub const RELOAD: &str = "Reload";

/// The strip while a file is another than on the bench.
#[must_use]
pub fn changed_strip(title: &str) -> String {
    format!("{title} was changed by another program. Reloading is one step of undo")
}

/// The strip while a file is not there any more.
#[must_use]
pub fn gone_strip(title: &str) -> String {
    format!("{title} was deleted or moved. Saving writes it again")
}

/// Beside the title of a file that is not to be changed.
pub const READ_ONLY: &str = "read-only";
/// What it means.
pub const READ_ONLY_HINT: &str = "The file is marked as read-only: save as another file";

/// Before a recent file that is not there.
pub const MISSING: &str = "not found";

/// Name of a button beside a recent file.
#[must_use]
pub fn remove_recent(path: &str) -> String {
    format!("Remove {path} from the list")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_told_in_the_unit_that_fits() {
        for (seconds, expected) in [
            (0, "less than a minute ago"),
            (60, "1 minute ago"),
            (59 * 60, "59 minutes ago"),
            (3600, "1 hour ago"),
            (48 * 3600, "2 days ago"),
        ] {
            assert_eq!(ago(Duration::from_secs(seconds)), expected);
        }
    }
}
