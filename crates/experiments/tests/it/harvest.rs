//! Every time step of every recorded experiment, as the particle filter meets it, and a sample of
//! them as hard problems.

use std::path::Path;

use rayon::prelude::*;
use stickslip_experiments::{Harvest, HarvestOptions, harvest, recorded_cases, survey_steps};
use stickslip_testkit::data_root;

const OPTIONS: HarvestOptions = HarvestOptions {
    particles: 8,
    keep_one_in: 200,
};

fn harvest_below(root: &Path, options: &HarvestOptions) -> Vec<Harvest> {
    let cases = recorded_cases(root).expect("recorded experiments");
    cases
        .par_iter()
        .map(|case| harvest(case, options).expect("a run"))
        .collect()
}

#[test]
#[ignore = "needs recorded experiments"]
fn every_step_of_every_recorded_log_is_solved_to_a_nanometre_per_second() {
    let root = data_root().expect("recorded data");
    let harvests = harvest_below(&root, &OPTIONS);
    let mut all = Harvest::default();
    for harvest in harvests {
        all.tally.add(harvest.tally);
        all.kept.extend(harvest.kept);
        all.refuted.extend(harvest.refuted);
    }
    assert_eq!(
        all.refuted,
        [],
        "neither solved to 1e-9 m/s nor proven infeasible"
    );
    // 49,908 rows, most of them seen and hidden
    assert!(all.tally.problems > 700_000, "{}", all.tally.problems);
    assert!(
        all.tally.infeasible * 100_000 <= all.tally.problems,
        "{} infeasible",
        all.tally.infeasible
    );
    assert!(all.kept.len() > 1000, "{}", all.kept.len());
    for (name, tally) in survey_steps(&all.kept, 1) {
        assert_eq!(
            tally.failed, [0; 0],
            "{name}: neither solved nor proven infeasible"
        );
        assert_eq!(
            tally.contradicted, [0; 0],
            "{name}: said to be infeasible although a solution is known"
        );
        assert!(
            tally.worst_residual <= 1e-9,
            "{name}: residual {:e}",
            tally.worst_residual
        );
    }
}

/// The sample is a pure function of the experiment: its failures can be found again.
#[test]
#[ignore = "needs recorded experiments"]
fn harvest_of_a_recorded_log_keeps_the_same_steps_every_time() {
    let root = data_root()
        .expect("recorded data")
        .join("mujoco/stop-square50-bar-000");
    let kept = || {
        harvest_below(
            &root,
            &HarvestOptions {
                particles: 16,
                keep_one_in: 50,
            },
        )
        .into_iter()
        .map(|h| h.kept)
        .collect::<Vec<_>>()
    };
    let first = kept();
    assert_eq!(first.len(), 2, "seen and hidden");
    assert!(first.iter().all(|steps| steps.len() > 20) && first[0] != first[1]);
    assert_eq!(first, kept());
}
