//! What each fault is diagnosed as, over many simulated sessions, and how long that takes: `cargo bench --bench diagnosis`.
//!
//! Prints the tables of `docs/diagnosis.md`. Seeds are fixed, so anyone gets the same findings.
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use handeye::calibrate::{Method, Mount, solve_all};
use handeye::diagnose::{Case, Diagnosis, diagnose};
use handeye::session::{Session, ball_problem, measure};
use handeye::simulate::{Dirt, Fault, SimulationOptions, simulate};
use handeye::watch::Unwatched;

/// A named kind of session.
struct Scene {
    name: &'static str,
    options: SimulationOptions,
}

fn main() {
    // `cargo test --benches` and `cargo bench` pass flags of their harness; only the latter asks for the tables.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return;
    }
    // A number asks for fewer seeds, a name for the faults that contain it.
    let num_seeds = arguments.iter().find_map(|argument| argument.parse().ok()).unwrap_or(20);
    let wanted = arguments.iter().find(|argument| !argument.starts_with('-') && argument.parse::<u64>().is_err());
    for scene in scenes() {
        println!("\n### {} ({num_seeds} seeds)\n", scene.name);
        println!("| fault | first finding | others |\n| --- | --- | --- |");
        for fault in std::iter::once(None).chain(Fault::ALL.into_iter().map(Some)) {
            let name = fault.map_or("none", Fault::id);
            if wanted.is_none_or(|wanted| name.contains(wanted.as_str())) {
                print_row(name, &SimulationOptions { fault, ..scene.options.clone() }, num_seeds);
            }
        }
    }
    print_timing();
}

fn scenes() -> Vec<Scene> {
    let sweeps = SimulationOptions::default();
    let sections = SimulationOptions { num_stations: 20, num_steps: 1, ..sweeps.clone() };
    let fixed = |options: &SimulationOptions| SimulationOptions { mount: Mount::Fixed, ..options.clone() };
    let scene = |name, options| Scene { name, options };
    vec![
        scene("10 sweeps, sensor on the flange", sweeps.clone()),
        scene("10 sweeps, fixed sensor", fixed(&sweeps)),
        scene("20 single sections, sensor on the flange", sections.clone()),
        scene("20 single sections, fixed sensor", fixed(&sections)),
        scene("10 sweeps with table, spikes, holes and flank bias", SimulationOptions { dirt: Dirt::all(), ..sweeps }),
    ]
}

fn diagnosed(session: &Session) -> (Diagnosis, Duration) {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    let problem = ball_problem(session, &measured).expect("a ball");
    let results = solve_all(&problem, &Method::BALL, &mut Unwatched).expect("not cancelled");
    let start = Instant::now();
    let diagnosis =
        diagnose(Case { session, problem: &problem, results: &results }, &mut Unwatched).expect("not cancelled");
    (diagnosis, start.elapsed())
}

fn print_row(name: &str, options: &SimulationOptions, num_seeds: u64) {
    let (mut first, mut others) = (BTreeMap::new(), BTreeMap::new());
    for seed in 1..=num_seeds {
        let (diagnosis, _) = diagnosed(&simulate(&SimulationOptions { seed, ..options.clone() }));
        let mut codes = diagnosis.findings.iter().map(|finding| finding.fault.code());
        *first.entry(codes.next().unwrap_or("none")).or_insert(0) += 1;
        for code in codes {
            *others.entry(code).or_insert(0) += 1;
        }
    }
    println!("| {name} | {} | {} |", counted(&first, num_seeds), counted(&others, num_seeds));
}

/// `code`, with how often where it is not always.
fn counted(counts: &BTreeMap<&str, u64>, num_seeds: u64) -> String {
    let mut counts: Vec<_> = counts.iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    let words: Vec<String> = counts
        .into_iter()
        .map(|(code, count)| if *count == num_seeds { (*code).to_owned() } else { format!("{code} ({count})") })
        .collect();
    words.join(", ")
}

fn print_timing() {
    println!("\n### Time of the diagnosis, 20 stations x 21 x 800\n");
    println!("| session | ms |\n| --- | --- |");
    for fault in [None, Some(Fault::WrongPose), Some(Fault::MixedOrder), Some(Fault::PoseConvention)] {
        let options = SimulationOptions { num_stations: 20, fault, ..SimulationOptions::default() };
        let (_, elapsed) = diagnosed(&simulate(&options));
        println!("| {} | {} |", fault.map_or("none", Fault::id), elapsed.as_millis());
    }
}
