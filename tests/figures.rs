//! The figures of a report.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use handeye::report::evidence::Evidence;
use handeye::report::figure::{Figure, figures_of};
use handeye::session::samples::ALL;
use handeye::session::{self, Session};
use handeye::watch::Unwatched;

fn figures(session: &Session) -> Vec<Figure> {
    figures_of(&Evidence::gather(session, &[], &mut Unwatched).expect("not cancelled"))
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
