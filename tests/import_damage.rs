//! Imports under damage: 10,000 mutated files of every format; no panic, no hang, no memory beyond a multiple of the file.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use handeye::geometry::PoseNotation;
use handeye::session::import::{ImportOptions, Source, read, read_paths};
use handeye::watch::Unwatched;
use peak_alloc::PeakAlloc;
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

const NUM_FILES: usize = 10_000;
/// Memory that an import may take for a byte of its file, ...
const BYTES_PER_BYTE: usize = 10;
/// ... and whatever the file: previews, sentences, and small files whose poses are larger than their text.
const BYTES_AT_ANY_RATE: usize = 64 << 20;
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
    let folder = tempfile::tempdir().expect("a folder");
    let (mut num_read, mut longest, mut worst) = (0, Duration::ZERO, 0.0_f64);
    for idx in 0..NUM_FILES {
        let (name, intact) = &seeds[idx % seeds.len()];
        let mut bytes = intact.clone();
        for _ in 0..=below(&mut random, 4) {
            damage(&mut bytes, &mut random);
        }
        let path = folder.path().join(name);
        std::fs::write(&path, &bytes).expect("written");
        let limit = BYTES_PER_BYTE * bytes.len() + BYTES_AT_ANY_RATE;
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let paths = [path];
        let before = PEAK.current_usage();
        PEAK.reset_peak_usage();
        let started = Instant::now();
        let sources: Vec<Source> = read_paths(&paths).expect("readable");
        let outcome = read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched);
        let elapsed = started.elapsed();
        let taken = PEAK.peak_usage().saturating_sub(before);
        assert!(taken <= limit, "file {idx} of {} bytes took {taken} bytes:\n{name}\n{text}", bytes.len());
        assert!(elapsed < LONGEST, "file {idx} took {elapsed:?}:\n{name}\n{text}");
        #[expect(clippy::cast_precision_loss, reason = "for show")]
        let ratio = taken.saturating_sub(BYTES_AT_ANY_RATE) as f64 / bytes.len().max(1) as f64;
        if taken.saturating_sub(10 * bytes.len()) > 40000 {
            println!("XX {name} {} {taken}", bytes.len());
        }
        (longest, worst) = (longest.max(elapsed), worst.max(ratio));
        match outcome {
            Ok(imported) => num_read += usize::from(!imported.stations.is_empty()),
            Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
        }
    }
    println!("{num_read} of {NUM_FILES} gave stations, at most {longest:?} and {worst:.1} bytes a byte");
    assert!(num_read > NUM_FILES / 10, "the damage is not so thorough that nothing is left to read");
}
