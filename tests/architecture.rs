//! The arrows between the floors, read from the sources.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::fs;
use std::path::{Path, PathBuf};

/// A module may name only floors below its own.
const FLOORS: [(&str, u8); 20] = [
    ("geometry", 0),
    ("watch", 0),
    ("whole_file", 0),
    ("fit", 1),
    ("scene", 1),
    ("sheet", 1),
    ("calibrate", 2),
    ("odometry", 2),
    ("scan", 2),
    ("plan", 3),
    ("verify", 3),
    ("session", 3),
    ("device", 4),
    ("diagnose", 4),
    ("simulate", 4),
    ("text", 5),
    ("report", 6),
    ("app", 7),
    ("ui", 8),
    ("cli", 9),
];

/// Floors without I/O, threads, clock, log or serde: same input, same bits.
const PURE: [&str; 7] = ["geometry", "fit", "calibrate", "odometry", "plan", "verify", "diagnose"];
const IMPURE_NAMES: [&str; 7] = ["std::fs", "std::thread", "std::time", "std::io", "serde", "log::", "rand_core"];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the crate") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

fn module_of(path: &Path, src: &Path) -> Option<&'static str> {
    let first = path.strip_prefix(src).ok()?.components().next()?.as_os_str().to_str()?;
    let first = first.trim_end_matches(".rs");
    FLOORS.iter().map(|(name, _)| *name).find(|name| *name == first)
}

fn floor_of(module: &str) -> u8 {
    FLOORS.iter().find(|(name, _)| *name == module).map(|(_, floor)| *floor).expect("a listed module")
}

/// The code before the unit tests, without comments: tests may look upwards.
fn code_lines(text: &str) -> impl Iterator<Item = &str> {
    let tests_at = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
    text[..tests_at].lines().map(|line| line.split("//").next().unwrap_or(""))
}

#[test]
fn modules_name_only_floors_below_their_own() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    assert!(files.len() > 50, "the sources were found");
    let mut breaches = Vec::new();
    for path in &files {
        let Some(module) = module_of(path, &src) else { continue };
        // A file of tests beside its module may look upwards too.
        if path.file_name().is_some_and(|name| name == "tests.rs") {
            continue;
        }
        let text = fs::read_to_string(path).expect("readable");
        for line in code_lines(&text) {
            for (other, floor) in FLOORS {
                let named = line.contains(&format!("crate::{other}::")) || line.contains(&format!("crate::{other};"));
                if named && other != module && floor >= floor_of(module) {
                    breaches.push(format!("{}: {}", path.display(), line.trim()));
                }
            }
            if module != "ui" && (line.contains("egui") || line.contains("eframe")) {
                breaches.push(format!("{} names egui: {}", path.display(), line.trim()));
            }
            if PURE.contains(&module)
                && let Some(impure) = IMPURE_NAMES.iter().find(|name| line.contains(**name))
            {
                breaches.push(format!("{} is not pure, it names {impure}: {}", path.display(), line.trim()));
            }
        }
    }
    assert!(breaches.is_empty(), "{}", breaches.join("\n"));
}

#[test]
fn every_file_says_what_lives_in_it() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    for path in files {
        let text = fs::read_to_string(&path).expect("readable");
        assert!(text.starts_with("//! "), "{} does not begin with what lives here", path.display());
    }
}
