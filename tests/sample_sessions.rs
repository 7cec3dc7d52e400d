//! The sample sessions: all open, all can be saved, and the simulated ones are what their documented commands give.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use handeye::cli::simulate::{SimulateArgs, TargetArg, run, simulated_session};
use handeye::session::{Reading, check, format, parse, samples, to_json};

#[derive(Parser)]
struct SimulateLine {
    #[command(flatten)]
    args: SimulateArgs,
}

/// The `handeye simulate` commands in the documentation that make samples.
fn documented_commands() -> Vec<SimulateArgs> {
    include_str!("../docs/samples.md")
        .lines()
        .filter(|line| line.contains("--out sample_sessions/"))
        .filter_map(|line| line.strip_prefix("handeye "))
        .map(|line| SimulateLine::try_parse_from(shell_words(line)).expect("a documented command parses").args)
        .collect()
}

/// Splits at spaces outside of double quotes: all that the documented commands need of a shell.
fn shell_words(line: &str) -> Vec<String> {
    line.split('"')
        .enumerate()
        .flat_map(|(idx, part)| {
            if idx % 2 == 1 { vec![part.to_owned()] } else { part.split_whitespace().map(str::to_owned).collect() }
        })
        .collect()
}

#[test]
fn simulated_samples_are_what_their_documented_commands_give() {
    let commands = documented_commands();
    assert_eq!(commands.len(), 11);
    for args in commands {
        let written = to_json(&simulated_session(&args).expect("a documented command is valid"));
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(&args.out);
        // To write them anew after a change of the simulation or of a command.
        if std::env::var_os("HANDEYE_WRITE_SAMPLES").is_some() {
            std::fs::write(&path, &written).expect("the sample can be written");
        }
        let on_disk = std::fs::read_to_string(&path).expect("the sample is there");
        assert!(written == on_disk, "{} differs from what its command gives", args.out.display());
    }
}

#[test]
fn the_sample_sequence_is_what_its_documented_command_gives() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut commands = documented_commands();
    let args = commands.iter_mut().find(|args| args.target == TargetArg::Room).expect("it is documented");
    let committed = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(&args.out);
    args.out = folder.path().join(committed.file_name().expect("it has a name"));
    assert_eq!(run(args), ExitCode::SUCCESS);
    let sequence = format!("{}-sequence", args.out.file_stem().expect("it has a name").to_string_lossy());
    let (written, committed) = (folder.path().join(&sequence), committed.with_file_name(&sequence));
    if std::env::var_os("HANDEYE_WRITE_SAMPLES").is_some() {
        // There is none the first time.
        let _ = std::fs::remove_dir_all(&committed);
        for name in files_in(&written) {
            let path = committed.join(&name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("the sample can be written");
            std::fs::copy(written.join(&name), path).expect("the sample can be written");
        }
    }
    let names = files_in(&written);
    assert_eq!(names, files_in(&committed));
    let mut total = 0;
    for name in names {
        let [new, old] = [&written, &committed].map(|folder| std::fs::read(folder.join(&name)).expect("it is there"));
        assert!(new == old, "{} differs from what its command gives", name.display());
        total += old.len();
    }
    assert!(total < 6_000_000, "{total} bytes");
}

/// The files of a sequence, in order.
fn files_in(sequence: &Path) -> BTreeSet<PathBuf> {
    let entries = |folder: &str| std::fs::read_dir(sequence.join(folder)).into_iter().flatten().flatten();
    let files = ["", "rgb", "depth"].into_iter().flat_map(|folder| {
        entries(folder)
            .filter(|entry| entry.path().is_file())
            .map(move |entry| Path::new(folder).join(entry.file_name()))
    });
    files.collect()
}

#[test]
fn every_sample_opens_and_survives_saving() {
    for sample in samples::ALL {
        let session = parse(sample.json.as_bytes(), sample.file_name).expect(sample.file_name);
        assert!(!session.name.is_empty() && !session.notes.is_empty(), "{} has a lesson", sample.file_name);
        let again = parse(to_json(&session).as_bytes(), sample.file_name).expect(sample.file_name);
        assert_eq!(session, again, "{}", sample.file_name);
    }
}

#[test]
fn the_samples_are_small_enough_to_carry() {
    let total: usize = samples::ALL.iter().map(|sample| sample.json.len()).sum();
    assert!(total <= 3_000_000, "{total} bytes");
}

#[test]
fn printed_errors_follow_from_printed_centres_but_for_the_known_misprints() {
    // Half a unit of the last printed digit, in each of two numbers.
    const ROUNDING_MM: [f64; 2] = [1.01e-3, 1.01e-4];
    let mut misprints = Vec::new();
    for (sample, rounding_mm) in samples::ALL[..2].iter().zip(ROUNDING_MM) {
        let session = parse(sample.json.as_bytes(), sample.file_name).expect(sample.file_name);
        let published = session.published.expect("it is from a paper");
        assert_eq!(published.target_in_base_mm.len(), 5);
        assert_eq!(published.error_from_first_mm.len(), 5);
        for (row, (ball, printed)) in published.target_in_base_mm.iter().zip(&published.error_from_first_mm).enumerate()
        {
            let error = ball - published.target_in_base_mm[0];
            for axis in 0..3 {
                if (error[axis] - printed[axis]).abs() > rounding_mm {
                    misprints.push((sample.file_name, row, axis));
                }
            }
        }
    }
    let table_1 = "lin-mu-2019-table-1.json";
    assert_eq!(misprints, [(table_1, 1, 1), (table_1, 1, 2)]);
}

#[test]
fn the_papers_quaternions_are_normalised_with_a_note() {
    for (sample, num_poses) in samples::ALL[..2].iter().zip([5, 4]) {
        let loaded = format::parse_with_notes(sample.json.as_bytes(), sample.file_name).expect(sample.file_name);
        let [check::Finding::QuaternionsNormalised { num_poses: found, .. }] = loaded.notes.as_slice() else {
            panic!("{:?}", loaded.notes);
        };
        // Of Table 2's quaternions one happens to have unit norm within the note's threshold.
        assert_eq!(*found, num_poses, "{}", sample.file_name);
        let is_point = |capture: &handeye::session::Capture| matches!(capture.reading, Reading::Point(_));
        assert!(loaded.session.stations.iter().all(|station| station.captures.iter().all(is_point)));
    }
}
