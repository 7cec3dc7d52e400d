//! The figures of a report.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use handeye::report::figure::{Evidence, Figure, figures_of};
use handeye::session::samples::ALL;
use handeye::session::{self, Session, measure};
use handeye::watch::Unwatched;

fn figures(session: &Session) -> Vec<Figure> {
    let measured = measure(session, None, &mut Unwatched).expect("measured");
    let problem = session::problem(session, &measured).ok();
    let results = problem
        .as_ref()
        .map_or_else(Vec::new, |problem| problem.solve_all(problem.methods(), &mut Unwatched).expect("not cancelled"));
    let diagnosis = problem.as_ref().map(|problem| {
        handeye::diagnose::diagnose_any(session, problem, &results, &mut Unwatched).expect("not cancelled")
    });
    let own = problem.as_ref().map(|problem| (problem, results.as_slice()));
    let verification = handeye::app::verification::verification(session, &measured, own, &[], &[], &mut Unwatched)
        .expect("not cancelled");
    figures_of(&Evidence {
        session,
        measured: &measured,
        results: &results,
        diagnosis: diagnosis.as_ref(),
        verification: Some(&verification),
    })
}

#[test]
fn every_sample_has_its_figures() {
    for sample in ALL {
        let session = session::parse(sample.json.as_bytes(), sample.file_name).expect("a sample");
        let figures = figures(&session);
        if let Ok(folder) = std::env::var("HANDEYE_FIGURES") {
            for figure in &figures {
                let name = format!("{folder}/{}-{}", sample.file_name.trim_end_matches(".json"), figure.id);
                std::fs::write(format!("{name}.svg"), figure.svg().expect("drawn")).expect("written");
                figure.png(2.0).expect("drawn").save(format!("{name}.png")).expect("written");
            }
        }
    }
}
