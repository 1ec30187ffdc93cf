//! Times of a log that a clock gave, counted from its start, as people read them: [`since_start`].

use stickslip_formats::Experiment;
use stickslip_report::ReportedRun;

/// Times that begin at this (s) or later are those of a clock.
const CLOCK: f64 = 1e6;

/// An experiment and its runs as pages show them, and the origin of all their times (s), in whole
/// seconds; `None` where that is 0.
pub fn since_start(
    experiment: &Experiment,
    mut runs: Vec<ReportedRun>,
) -> (Experiment, Vec<ReportedRun>, Option<f64>) {
    let mut experiment = experiment.clone();
    let first = experiment.log.time.first().copied();
    let start = first.filter(|first| *first >= CLOCK).map(f64::floor);
    if let Some(start) = start {
        let truth = experiment.truth.iter_mut().map(|truth| &mut truth.time);
        let estimates = runs.iter_mut().map(|run| &mut run.scored.estimate.time);
        let log = std::iter::once(&mut experiment.log.time);
        for time in log.chain(truth).chain(estimates).flatten() {
            *time -= start;
        }
    }
    (experiment, runs, start)
}

#[cfg(test)]
mod tests {
    use stickslip_formats::{TruthFacts, read_log, read_scene};

    use super::*;

    #[test]
    fn a_clocks_times_count_from_the_logs_start_and_others_stay() {
        let scene = include_str!("../../testkit/experiments/slide-ell-disc-110/scene.toml");
        let log = include_bytes!("../../testkit/experiments/slide-ell-disc-110/log.csv");
        let own = Experiment {
            setup: read_scene(scene, "scene.toml").unwrap(),
            log: read_log(&log[..], "log.csv").unwrap().0,
            truth: None,
            facts: TruthFacts::default(),
        };
        let (shown, _, start) = since_start(&own, Vec::new());
        assert_eq!((shown.log, start), (own.log.clone(), None));
        let mut of_clock = own.clone();
        for time in &mut of_clock.log.time {
            *time += 1_760_000_000.5;
        }
        let (shown, _, start) = since_start(&of_clock, Vec::new());
        assert_eq!(start, Some(1_760_000_000.0));
        for (shown, own) in shown.log.time.iter().zip(&own.log.time) {
            assert!((shown - own - 0.5).abs() < 1e-6, "{shown} {own}");
        }
    }
}
