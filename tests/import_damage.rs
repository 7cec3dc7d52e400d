//! Imports under damage: 10,000 mutated files of every format; no panic, no hang, no memory beyond a multiple of the file.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use handeye::geometry::PoseNotation;
use handeye::session::import::{ImportOptions, Source, read};
use handeye::watch::Unwatched;
use peak_alloc::PeakAlloc;
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

const NUM_FILES: usize = 10_000;
/// Memory that an import may take for a byte of its file, ...
const BYTES_PER_BYTE: usize = 10;
/// ... and whatever the file: the preview, what recognition looks at, sentences, and the YAML reader's own.
const BYTES_AT_ANY_RATE: usize = 128 << 10;
/// A file of kilobytes takes milliseconds; on a machine that does ten other things more.
const LONGEST: Duration = Duration::from_secs(2);

/// The examples of the documentation and the files kept for tests.
fn seeds() -> Vec<(String, Vec<u8>)> {
    let mut seeds: Vec<(String, Vec<u8>)> = include_str!("../docs/import.md")
        .split("<!-- example: ")
        .skip(1)
        .map(|part| {
            let (head, rest) = part.split_once(" -->\n```\n").expect("a fence behind its comment");
            let name = head.split(' ').next().expect("a name");
            (name.to_owned(), rest.split("```\n").next().expect("an end").as_bytes().to_vec())
        })
        .collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/import");
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    for path in paths {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        seeds.push((name, std::fs::read(path).expect("readable")));
    }
    // A file of some size, so that memory in proportion to it shows.
    let rows = (0..400).map(|idx| format!("{idx},{}.{idx},-110.245,-139.394,-178.2,0.5,90.25\n", 500 + idx % 50));
    seeds.push(("many.csv".to_owned(), rows.collect::<String>().into_bytes()));
    let points = (0..800).map(|idx| format!("{:.3},{:.4}\n", f64::from(idx) * 0.02 - 8.0, 58.0 + f64::from(idx % 7)));
    seeds.push(("profile.csv".to_owned(), points.collect::<String>().into_bytes()));
    seeds
}

fn below(random: &mut Pcg64Mcg, bound: usize) -> usize {
    usize::try_from(random.next_u64() % bound.max(1) as u64).expect("below a usize")
}

/// Damages a file in one of the ways in which files get damaged.
fn damage(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    const BITS: [&[u8]; 16] = [
        b"1e999",
        b"-",
        b"nan",
        b",",
        b";",
        b"\t",
        b"\n",
        b"\r",
        b"\"",
        b"[[[[[[[[[[",
        b"{",
        b"}",
        b"p[",
        b"q0=1 ",
        b"999999999999999999999999",
        b"\xff\xfe",
    ];
    let at = below(random, bytes.len());
    let end = (at + 1 + below(random, 40)).min(bytes.len());
    match below(random, 8) {
        0 if !bytes.is_empty() => bytes[at] = random.next_u64().to_le_bytes()[0],
        1 => drop(bytes.drain(at..end)),
        2 => {
            let copy = bytes[at..end].to_vec();
            bytes.splice(at..at, copy);
        }
        3 => bytes.truncate(at),
        4 => drop(bytes.splice(at..at, BITS[below(random, BITS.len())].iter().copied())),
        5 => {
            let (from, to) = ([b',', b';', b'\t', b' '][below(random, 4)], [b';', b'\t', b' ', b','][below(random, 4)]);
            bytes.iter_mut().filter(|byte| **byte == from).for_each(|byte| *byte = to);
        }
        6 => {
            // The same piece many times: repeated names, brackets and lines.
            let copy = bytes[at..end].repeat(20);
            bytes.splice(at..at, copy);
        }
        _ if !bytes.is_empty() => bytes[at] ^= 1 << below(random, 8),
        _ => {}
    }
}

#[test]
fn damaged_files_are_refused_or_read_in_little_time_and_memory() {
    let seeds = seeds();
    let mut random = Pcg64Mcg::seed_from_u64(20_250_301);
    let (mut num_read, mut longest, mut worst) = (0, Duration::ZERO, 0.0_f64);
    for idx in 0..NUM_FILES {
        let (name, intact) = &seeds[idx % seeds.len()];
        let mut bytes = intact.clone();
        for _ in 0..=below(&mut random, 4) {
            damage(&mut bytes, &mut random);
        }
        let copy = bytes.clone();
        let text = || String::from_utf8_lossy(&copy).into_owned();
        // The bytes of the file, which are the import's now, count as well.
        let before = PEAK.current_usage() - bytes.len();
        PEAK.reset_peak_usage();
        let started = Instant::now();
        let num_bytes = bytes.len();
        let sources = [Source::from_bytes(name.clone(), bytes)];
        let outcome = read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched);
        let elapsed = started.elapsed();
        let taken = PEAK.peak_usage().saturating_sub(before);
        let limit = BYTES_PER_BYTE * num_bytes + BYTES_AT_ANY_RATE;
        assert!(taken <= limit, "file {idx} of {num_bytes} bytes took {taken} bytes:\n{name}\n{}", text());
        assert!(elapsed < LONGEST, "file {idx} took {elapsed:?}:\n{name}\n{}", text());
        #[expect(clippy::cast_precision_loss, reason = "for show")]
        let ratio = taken.saturating_sub(BYTES_AT_ANY_RATE) as f64 / num_bytes.max(1) as f64;
        (longest, worst) = (longest.max(elapsed), worst.max(ratio));
        match outcome {
            Ok(imported) => num_read += usize::from(!imported.stations.is_empty()),
            Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
        }
    }
    println!("{num_read} of {NUM_FILES} gave stations, at most {longest:?} and {worst:.1} bytes a byte");
    check_large_files();
    assert!(num_read > NUM_FILES / 10, "the damage is not so thorough that nothing is left to read");
}

/// Files of a size at which what does not grow with them does not count, by the factor alone.
fn check_large_files() {
    let poses =
        |idx: i32| format!("{idx},{}.{:03},-110.245,-139.394,-178.2045,0.5124,90.2546\n", 500 + idx % 50, idx % 1000);
    let points = |idx: i32| format!("{:.3},{:.4}\n", f64::from(idx) * 0.02 - 8.0, 58.0 + f64::from(idx % 7));
    let programs = |idx: i32| {
        format!(
            "P[{idx}]{{\n GP1:\n UF : 0, UT : 0, CONFIG : 'N U T, 0, 0, 0',\n X = {idx}.5 mm, Y = -110.245 mm, Z = -139.394 mm,\n W = -178.2 deg, P = 0.5 deg, R = 90.25 deg\n}};\n"
        )
    };
    // Rows that end early under a head of many columns are no profiles.
    let head = ",a".repeat(63);
    let row = ",58.125".repeat(63);
    let full = format!("7.5{row}\n").repeat(20);
    check_large_file("early.csv", format!("x_mm{head}\n{full}{}", "1\n".repeat(100_000)), 100_000);
    let files: [(&str, String); 3] = [
        ("poses.csv", (0..19_000).map(poses).collect()),
        ("profile.csv", (0..50_000).map(points).collect()),
        ("program.ls", (0..10_000).map(programs).collect()),
    ];
    for (name, text) in files {
        check_large_file(name, text, 0);
    }
}

fn check_large_file(name: &str, text: String, num_problems: usize) {
    let num_bytes = text.len();
    let before = PEAK.current_usage() - num_bytes;
    PEAK.reset_peak_usage();
    let sources = [Source::from_text(name, text)];
    let started = Instant::now();
    let imported = read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched);
    let (elapsed, taken) = (started.elapsed(), PEAK.peak_usage() - before);
    assert_eq!(imported.expect(name).num_problems, num_problems, "{name}");
    println!("{name}: {num_bytes} bytes took {taken} bytes and {elapsed:?}");
    assert!(taken <= BYTES_PER_BYTE * num_bytes, "{name} of {num_bytes} bytes took {taken} bytes");
}
