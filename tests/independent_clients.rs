//! The simulated cell against clients that others wrote, by `tests/clients/run.py`. They come from Python's package index, so
//! they run only where they are asked for: `HANDEYE_CLIENTS=1 cargo test --test independent_clients`.
#![expect(clippy::expect_used, reason = "a test that cannot set itself up must fail")]

use std::io::{self, Write as _};
use std::path::Path;
use std::process::Command;

/// What is skipped is said even where the output of tests that pass is not shown.
fn say(text: &str) {
    writeln!(io::stderr(), "{text}").expect("written");
}

#[test]
fn clients_of_others_are_satisfied() {
    if std::env::var_os("HANDEYE_CLIENTS").is_none_or(|value| value.is_empty() || value == "0") {
        say("skipped: set HANDEYE_CLIENTS=1 to run the independent clients; they need Python 3 and its package index");
        return;
    }
    let python = if cfg!(windows) { "python" } else { "python3" };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/clients/run.py");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("clients");
    let output = match Command::new(python).arg(script).arg(env!("CARGO_BIN_EXE_handeye")).arg(folder).output() {
        Ok(output) => output,
        Err(error) => {
            say(&format!("skipped: {python} cannot be run ({error})"));
            return;
        }
    };
    say(&(String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr)));
    // Who asks for the clients and gets none of them must not take that for a success.
    assert!(output.status.success(), "a client found something, or could not be run; see above");
}
