//! Random scenes in closed loop: a part of those that the program `closed_loop` runs.

use std::sync::OnceLock;

use stickslip_experiments::{ClosedLoop, LoopTally, SceneKind, SceneRun};

const LOOP: ClosedLoop = ClosedLoop {
    seed: 1,
    frames: 60,
    particles: 64,
};

const SCENES: u64 = 40;

fn runs() -> &'static [SceneRun] {
    static RUNS: OnceLock<Vec<SceneRun>> = OnceLock::new();
    RUNS.get_or_init(|| {
        LOOP.run_all(0..SCENES, &|_| ())
            .expect("scenes that can be run")
    })
}

/// The scene's counts without its times.
fn counts(run: SceneRun) -> LoopTally {
    LoopTally {
        slowest_step: Default::default(),
        slowest_frame: Default::default(),
        ..run.tally
    }
}

/// Steps of which at most one may fail: creeping pushers in form closures cost the search over
/// modes more than a step's limit on work.
const ONE_MAY_FAIL_OF: u64 = 10_000;

#[test]
fn steps_are_solved_or_truly_have_no_solution() {
    let (mut steps, mut failed) = (0, 0);
    for run in runs() {
        let LoopTally {
            contradicted_at,
            refuted_at,
            ..
        } = &run.tally;
        assert_eq!(contradicted_at, &[], "{:?}: a wrong proof", run.kind);
        assert_eq!(refuted_at, &[], "{:?}: no solution", run.kind);
        steps += run.tally.steps.problems;
        failed += run.tally.steps.failed.len() as u64;
    }
    assert!(
        failed * ONE_MAY_FAIL_OF <= steps,
        "{failed} of {steps} steps failed"
    );
}

#[test]
fn every_kind_of_scene_is_pushed_and_held() {
    for kind in SceneKind::ALL {
        let mut all = LoopTally::default();
        for run in runs().iter().filter(|run| run.kind == kind) {
            all.add(&run.tally);
        }
        assert_eq!(all.scenes, SCENES / SceneKind::ALL.len() as u64, "{kind:?}");
        assert!(all.frames > 100, "{kind:?}: {} frames", all.frames);
        assert!(all.checked > 100, "{kind:?}: {} checked", all.checked);
        let share = |count: u64| count as f64 / all.steps.problems as f64;
        assert!(share(all.pushed) > 0.05, "{kind:?}: {} pushed", all.pushed);
        assert!(share(all.held) > 0.02, "{kind:?}: {} held", all.held);
    }
}

/// Runs are reproducible from seed and index.
#[test]
fn run_is_a_function_of_seed_and_index() {
    let again = |index| counts(LOOP.run(index, 0).expect("a scene"));
    for index in [0, 5] {
        assert_eq!(counts(runs()[index as usize].clone()), again(index));
        assert_ne!(again(index), again(index + SCENES));
    }
}
