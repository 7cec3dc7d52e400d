//! The state machine against a ball of pure geometry.

use std::collections::HashSet;

use super::*;
use crate::scene::Random;

const RADIUS_MM: f64 = 15.0;
/// The stated σ of a section's radius, mm.
const STD_MM: f64 = 0.002;

/// What a ball shows whose peak is so far along the travel.
fn ball(peak_mm: f64) -> impl Fn(f64) -> Option<f64> {
    move |travelled_mm: f64| {
        let squared = RADIUS_MM.powi(2) - (travelled_mm - peak_mm).powi(2);
        // Smaller sections make no arc.
        (squared > 4.0).then(|| squared.sqrt())
    }
}

fn seen(travelled_mm: f64, radius_mm: Option<f64>) -> StepSeen {
    StepSeen {
        travelled_mm,
        radius_and_std_mm: radius_mm.map(|radius_mm| [radius_mm, STD_MM]).ok_or_else(|| "nothing there".to_owned()),
    }
}

/// A search that is over, and the phases that it went through.
struct Run {
    report: SearchReport,
    phases: Vec<SearchPhase>,
}

impl Run {
    fn end(&self) -> &SearchEnd {
        self.report.end.as_ref().expect("over")
    }

    #[track_caller]
    fn peak_mm(&self) -> f64 {
        let SearchEnd::Found { peak_mm, .. } = self.end() else { panic!("{}", self.end()) };
        *peak_mm
    }

    fn commanded_mm(&self) -> Vec<f64> {
        self.report.points.iter().map(|point| point.commanded_mm).collect()
    }
}

/// Runs a search; `see` is told the number of the capture and the commanded distance.
fn run(settings: &SearchSettings, mut see: impl FnMut(usize, f64) -> StepSeen) -> Run {
    let mut search = Search::new(settings, RADIUS_MM);
    let mut phases = Vec::new();
    while let SearchNext::CaptureAt { commanded_mm } = search.next() {
        let idx = search.report().points.len();
        assert!(idx < usize::from(settings.max_captures), "too many captures");
        assert!(commanded_mm.abs() <= settings.max_travel_mm, "{commanded_mm} mm is beyond the limit");
        if phases.last() != Some(&search.report().phase) {
            phases.push(search.report().phase);
        }
        search.take(see(idx, commanded_mm));
    }
    assert_eq!(search.report().phase, SearchPhase::Ended);
    Run { report: search.report().clone(), phases }
}

fn usual() -> SearchSettings {
    SearchSettings::default()
}

#[test]
fn wherever_it_starts_on_the_ball_it_finds_the_peak() {
    for tenths in -140..=140 {
        let start_mm = f64::from(tenths) * 0.1;
        let found = run(&usual(), |_, at_mm| seen(at_mm, ball(start_mm)(at_mm)));
        assert!((found.peak_mm() - start_mm).abs() < 0.01, "{start_mm}: {}", found.end());
        let num_captures = found.report.points.len();
        assert!(num_captures <= 20, "{start_mm}: {num_captures} captures");
    }
}

#[test]
fn the_phases_are_those_of_the_paper() {
    use SearchPhase::{Climb, First, Pass, Probe, Reverse};
    #[track_caller]
    fn check(peak_mm: f64, phases: &[SearchPhase]) {
        let found = run(&usual(), |_, at_mm| seen(at_mm, ball(peak_mm)(at_mm)));
        assert_eq!(found.phases, phases, "peak at {peak_mm}: {:?}", found.commanded_mm());
    }
    check(8.0, &[First, Probe, Climb, Pass]);
    check(-8.0, &[First, Probe, Reverse, Climb, Pass]);
    // At the peak: this side, that side, and this side again until both are covered.
    check(0.0, &[First, Probe, Reverse, Pass, Reverse, Pass]);
}

#[test]
fn what_was_captured_before_it_turned_stays_in_the_curve() {
    let found = run(&usual(), |_, at_mm| seen(at_mm, ball(-6.0)(at_mm)));
    assert_eq!(
        found.commanded_mm()[..3],
        [0.0, 0.75, -1.5],
        "a probe, then past the start: {:?}",
        found.commanded_mm()
    );
    assert!((found.report.sign + 1.0).abs() < f64::EPSILON);
}

#[test]
fn steps_are_coarse_far_from_the_peak_and_fine_near_it() {
    let found = run(&usual(), |_, at_mm| seen(at_mm, ball(12.0)(at_mm)));
    for pair in found.commanded_mm()[1..].windows(2) {
        let (step_mm, beside_mm) = (pair[1] - pair[0], (12.0 - pair[0]).abs());
        if beside_mm < 0.25 * RADIUS_MM - 0.01 {
            assert!((step_mm - 0.75).abs() < 1e-9, "{step_mm} at {beside_mm}");
        } else if beside_mm > 0.25 * RADIUS_MM + 1.5 {
            assert!((step_mm - 1.5).abs() < 1e-9, "{step_mm} at {beside_mm}");
        }
    }
}

#[test]
fn noise_near_the_peak_does_not_turn_it_astray() {
    // A radius changes by 0.02 mm over the first step from the peak; its noise is as large.
    const NOISE_MM: f64 = 0.02;
    for seed in 0..300 {
        let mut random = Random::new(seed, 1);
        let start_mm = random.signed_unit();
        let settings = SearchSettings { stop: StopRule::PeakKnown { peak_std_mm: 0.05 }, ..usual() };
        let found = run(&settings, |_, at_mm| StepSeen {
            travelled_mm: at_mm,
            radius_and_std_mm: Ok([ball(start_mm)(at_mm).expect("on the ball") + NOISE_MM * random.normal(), NOISE_MM]),
        });
        let SearchEnd::Found { peak_mm, peak_std_mm } = found.end() else { panic!("{seed}: {}", found.end()) };
        assert!((peak_mm - start_mm).abs() < 4.0 * peak_std_mm, "{seed}: {peak_mm} ± {peak_std_mm}, not {start_mm}");
        assert!(found.report.points.len() <= 30, "{seed}: {}", found.report.points.len());
    }
}

#[test]
fn a_profile_without_an_arc_is_noted_and_passed_over() {
    for missing_idx in 0..10 {
        let found = run(&usual(), |idx, at_mm| seen(at_mm, ball(-5.0)(at_mm).filter(|_| idx != missing_idx)));
        assert!((found.peak_mm() + 5.0).abs() < 0.01, "{missing_idx}: {}", found.end());
        assert_eq!(found.report.points[missing_idx].radius_and_std_mm, None);
    }
}

#[test]
fn no_arc_at_the_start_ends_it_at_the_second_look() {
    let none = run(&usual(), |_, at_mm| seen(at_mm, None));
    assert_eq!(none.end(), &SearchEnd::NoArcAtStart { reason: "nothing there".to_owned() });
    assert_eq!(none.commanded_mm(), [0.0, 0.0]);
}

#[test]
fn an_arc_that_vanishes_at_the_probe_turns_it_round() {
    // At the ball's rim: one step on there is nothing.
    let found = run(&usual(), |_, at_mm| seen(at_mm, ball(-14.5)(at_mm)));
    assert!((found.peak_mm() + 14.5).abs() < 0.01);
}

#[test]
fn travel_along_the_laser_line_ends_it() {
    let mut random = Random::new(1, 1);
    let flat = run(&usual(), |_, at_mm| seen(at_mm, Some(12.0 + STD_MM * random.normal())));
    let SearchEnd::RadiusUnchanged { travelled_mm } = flat.end() else { panic!("{}", flat.end()) };
    assert!(*travelled_mm < 0.4 * RADIUS_MM, "{travelled_mm}");
}

#[test]
fn travel_far_off_the_normal_finds_the_peak_late() {
    // 60° off: the ball passes half as fast.
    let settings = SearchSettings { max_travel_mm: 40.0, ..usual() };
    let found = run(&settings, |_, at_mm| seen(at_mm, ball(5.0)(0.5 * at_mm)));
    assert!((found.peak_mm() - 10.0).abs() < 0.05, "{}", found.end());
    assert!((found.report.curve.expect("fitted").curvature - 0.25).abs() < 0.02);
}

#[test]
fn an_arc_that_vanishes_while_it_climbs_is_lost() {
    let lost = run(&usual(), |_, at_mm| seen(at_mm, ball(9.0)(at_mm).filter(|_| at_mm < 3.0)));
    let SearchEnd::ArcLost { travelled_mm, .. } = lost.end() else { panic!("{}", lost.end()) };
    assert!(*travelled_mm > 3.0);
    assert!(lost.commanded_mm().iter().all(|at_mm| *at_mm < 7.0), "not far into nothing: {:?}", lost.commanded_mm());
}

#[test]
fn an_arc_that_leaves_beyond_the_peak_is_not_lost() {
    // It never gets as good as that.
    let settings = SearchSettings { stop: StopRule::PeakKnown { peak_std_mm: 1e-5 }, ..usual() };
    let found = run(&settings, |_, at_mm| seen(at_mm, ball(9.0)(at_mm).filter(|_| at_mm < 11.5)));
    let SearchEnd::Found { peak_mm, peak_std_mm } = found.end() else { panic!("{}", found.end()) };
    assert!((peak_mm - 9.0).abs() < 0.02 && *peak_std_mm > 1e-5 && *peak_std_mm < 0.1, "{}", found.end());
}

#[test]
fn a_robot_that_does_not_go_ends_it() {
    for from_idx in 1..8 {
        let mut stands_mm = 0.0;
        let stuck = run(&usual(), |idx, at_mm| {
            if idx < from_idx {
                stands_mm = at_mm;
            }
            seen(stands_mm, ball(9.0)(stands_mm))
        });
        assert!(matches!(stuck.end(), SearchEnd::Stuck { .. }), "{from_idx}: {}", stuck.end());
        assert_eq!(stuck.report.points.len(), from_idx + 2, "it was asked twice");
    }
}

#[test]
fn a_robot_that_was_late_once_goes_on() {
    let found = run(&usual(), |idx, at_mm| {
        let at_mm = if idx == 4 { at_mm - 1.0 } else { at_mm };
        seen(at_mm, ball(5.0)(at_mm))
    });
    assert!((found.peak_mm() - 5.0).abs() < 0.01);
}

#[test]
fn the_limits_of_travel_and_of_captures_hold() {
    let short = SearchSettings { max_travel_mm: 4.0, ..usual() };
    let exhausted = run(&short, |_, at_mm| seen(at_mm, ball(9.0)(at_mm)));
    assert_eq!(exhausted.end(), &SearchEnd::TravelExhausted { max_travel_mm: 4.0 });
    assert_eq!(exhausted.commanded_mm().last(), Some(&4.0), "it goes as far as it may");
    let few = SearchSettings { max_captures: 6, ..usual() };
    let exhausted = run(&few, |_, at_mm| seen(at_mm, ball(12.0)(at_mm)));
    assert_eq!(exhausted.end(), &SearchEnd::CapturesExhausted { max_captures: 6 });
    assert_eq!(exhausted.report.points.len(), 6);
}

#[test]
fn a_limit_just_beyond_the_peak_is_enough() {
    let settings = SearchSettings { max_travel_mm: 7.0, ..usual() };
    let found = run(&settings, |_, at_mm| seen(at_mm, ball(6.0)(at_mm)));
    assert!((found.peak_mm() - 6.0).abs() < 0.05, "{}", found.end());
}

#[test]
fn another_radius_than_stated_and_a_moved_ball_end_it() {
    let larger = run(&usual(), |_, at_mm| seen(at_mm, ball(6.0)(at_mm).map(|radius_mm| 1.04 * radius_mm)));
    assert!(matches!(larger.end(), SearchEnd::ResidualGrew { .. }), "{}", larger.end());
    let moved = run(&usual(), |idx, at_mm| seen(at_mm, ball(if idx < 5 { 10.0 } else { 7.0 })(at_mm)));
    assert!(matches!(moved.end(), SearchEnd::ResidualGrew { .. }), "{}", moved.end());
}

#[test]
fn a_section_above_the_radius_by_noise_is_no_reason_to_end() {
    // A ball larger by 0.03 mm than stated: many sections are above R.
    let found = run(&usual(), |_, at_mm| seen(at_mm, ball(6.0)(at_mm).map(|radius_mm| 1.002 * radius_mm)));
    assert!((found.peak_mm() - 6.0).abs() < 0.05, "{}", found.end());
    assert!(found.report.points.iter().any(|point| point.radius_and_std_mm.is_some_and(|[l, _]| l > RADIUS_MM)));
}

#[test]
fn the_published_rule_stops_at_the_first_section_as_large_as_the_ball_or_at_the_largest() {
    let settings = SearchSettings { stop: StopRule::Published, ..usual() };
    // A multiple of the steps: R is reached.
    let reached = run(&settings, |_, at_mm| seen(at_mm, ball(0.75)(at_mm)));
    assert_eq!(reached.report.published_stop_idx, Some(1));
    assert!((reached.peak_mm() - 0.75).abs() < 1e-12);
    // Between two steps: it never is, and the radius has to fall again.
    let fallen = run(&settings, |_, at_mm| seen(at_mm, ball(2.6)(at_mm)));
    assert!((fallen.peak_mm() - 2.6).abs() < 0.4, "{}", fallen.end());
    assert!(fallen.report.published_stop_idx.expect("stopped") < fallen.report.points.len() - 1);
}

#[test]
fn ours_says_where_the_published_rule_would_have_stopped() {
    let see = |_, at_mm| seen(at_mm, ball(5.3)(at_mm));
    let ours = run(&usual(), see);
    let published = run(&SearchSettings { stop: StopRule::Published, ..usual() }, see);
    assert_eq!(ours.report.published_stop_idx, published.report.published_stop_idx);
    assert!(ours.report.published_stop_idx.is_some());
}

#[test]
fn settings_that_make_no_search_end_it_before_it_begins() {
    let settings = SearchSettings { step_mm: 0.0, ..usual() };
    let refused = run(&settings, |_, _| panic!("nothing may move"));
    assert!(matches!(refused.end(), SearchEnd::NotBegun(SettingsRefusal::NotPositive { .. })));
    for radius_mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut search = Search::new(&usual(), radius_mm);
        assert!(matches!(search.next(), SearchNext::Over(SearchEnd::NotBegun(_))));
        search.take(seen(0.0, Some(5.0)));
        assert!(search.report().points.is_empty(), "it stays over");
    }
}

#[test]
fn numbers_that_are_none_are_no_arcs_and_no_places() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -3.0, 0.0, 1e300] {
        let none = run(&usual(), |_, at_mm| seen(at_mm, Some(bad)));
        assert!(matches!(none.end(), SearchEnd::NoArcAtStart { .. }), "{bad}: {}", none.end());
        let lost = run(&usual(), |idx, at_mm| seen(if idx > 2 { bad * 1e3 } else { at_mm }, ball(9.0)(at_mm)));
        assert!(matches!(lost.end(), SearchEnd::Stuck { .. }), "{bad}: {}", lost.end());
    }
}

#[test]
fn small_balls_get_small_steps() {
    let settings = SearchSettings { step_mm: 5.0, coarse_step_mm: 20.0, ..usual() };
    let found = run(&settings, |_, at_mm| seen(at_mm, ball(9.0)(at_mm)));
    assert!((found.peak_mm() - 9.0).abs() < 0.05);
    let steps = found.commanded_mm();
    assert!(steps.windows(2).all(|pair| (pair[1] - pair[0]).abs() <= 0.25 * RADIUS_MM + 1e-9), "{steps:?}");
}

#[test]
fn a_replay_shows_what_the_search_showed() {
    let found = run(&usual(), |_, at_mm| seen(at_mm, ball(-6.2)(at_mm)));
    let recorded = found.report.points.iter().map(|point| StepSeen {
        travelled_mm: point.travelled_mm,
        radius_and_std_mm: point.radius_and_std_mm.ok_or_else(String::new),
    });
    let mut replay = Replay::new(&usual(), RADIUS_MM, recorded.collect());
    let reports: Vec<SearchReport> = replay.by_ref().collect();
    assert_eq!(reports.len(), found.report.points.len());
    assert_eq!(replay.stop_idx(), Some(reports.len() - 1));
    let last = reports.last().expect("some");
    assert_eq!((&last.curve, &last.end), (&found.report.curve, &found.report.end));
    assert_eq!(last.published_stop_idx, found.report.published_stop_idx);
    let phases: Vec<SearchPhase> = reports.iter().map(|report| report.phase).collect();
    let visited: HashSet<_> = phases.iter().map(|phase| format!("{phase:?}")).collect();
    for phase in ["Probe", "Reverse", "Climb", "Pass", "Ended"] {
        assert!(visited.contains(phase), "{phase} of {phases:?}");
    }
}

#[test]
fn a_replayed_sweep_goes_on_after_the_search_would_have_stopped() {
    let sweep = |range: std::ops::Range<i32>| -> Vec<StepSeen> {
        range.map(|step| f64::from(step) * 0.75).map(|at_mm| seen(at_mm, ball(6.0)(at_mm))).collect()
    };
    let mut replay = Replay::new(&usual(), RADIUS_MM, sweep(0..21));
    assert_eq!(replay.by_ref().count(), 21);
    let stop_idx = replay.stop_idx().expect("it would have stopped");
    assert!((9..15).contains(&stop_idx), "{stop_idx}");
    // One flank only, against the direction, and nothing at all.
    let mut flank = Replay::new(&usual(), RADIUS_MM, sweep(0..5).into_iter().rev().collect());
    let last = flank.by_ref().last().expect("five");
    assert_eq!(flank.stop_idx(), None);
    assert!(last.sign < 0.0 && matches!(last.end, Some(SearchEnd::TravelExhausted { .. })), "{last:?}");
    assert_eq!(Replay::new(&usual(), RADIUS_MM, Vec::new()).count(), 0);
}
