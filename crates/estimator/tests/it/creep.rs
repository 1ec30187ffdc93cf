//! Contacts that creep in the robust model, as particles meet them before anything is learned of
//! the creep.

use std::sync::Mutex;

use crate::common::{PARTICLES, run_into_the_dark, setup};
use stickslip::dynamics::{StepProblem, StepSolution, Twist};
use stickslip::{Observer, SolvedStep};

/// Median of κ, and the spread of its logarithm.
const TOLD: f64 = 0.2;
const SPREAD: f64 = 1.2;

/// Every step, particle after particle.
#[derive(Debug, Default)]
struct Steps(Mutex<Vec<(StepProblem, StepSolution)>>);

impl Observer for Steps {
    fn on_step(&self, step: &SolvedStep<'_>) {
        let mut steps = self.0.lock().expect("no test panicked here");
        steps.push((step.problem.clone(), step.solution.clone()));
    }
}

/// Returns κ of (50), from what a particle's step states and how its step before ended. `None` if
/// it did not press with one contact in both, or was slower than 1 mm/s.
fn share(
    rho: f64,
    (_, before): &(StepProblem, StepSolution),
    (now, _): &(StepProblem, StepSolution),
) -> Option<f64> {
    let ([contact], [pressed]) = (&now.contacts[..], &before.normal[..]) else {
        return None;
    };
    let Twist { vx, vy, omega } = before.twist;
    let speed = (vx * vx + vy * vy + rho * rho * omega * omega).sqrt();
    let feet: f64 = now.feet.iter().map(|foot| foot.bound).sum();
    let slip = contact.creep * contact.mu * pressed;
    (*pressed > 0.1 * feet && speed > 1e-3).then(|| slip / speed * (pressed / feet).max(1.0))
}

/// ln κ of particles that a pusher moves while the camera is off, over many seeds.
fn logarithms(creep: f64) -> Vec<f64> {
    let mut setup = setup(&[]);
    setup.uncertainty.creep = creep;
    let rho = setup.scene.object.gyration_radius();
    let mut all = Vec::new();
    for seed in 0..20 {
        let steps = Steps::default();
        run_into_the_dark(&setup, seed, &steps);
        let steps = steps.0.into_inner().expect("no test panicked here");
        // one step of each particle: the first that reveals κ
        let rows: Vec<_> = steps.chunks(PARTICLES).collect();
        let told = |i: usize| {
            rows.windows(2)
                .find_map(|rows| share(rho, &rows[0][i], &rows[1][i]))
        };
        all.extend((0..PARTICLES).filter_map(told));
    }
    all.into_iter().map(libm::log).collect()
}

#[test]
fn share_at_which_contacts_creep_is_log_normal() {
    let mut found = logarithms(TOLD);
    let n = found.len();
    assert!(n > 600, "{n} particles");
    found.sort_by(f64::total_cmp);
    let [low, median, high] = [0.1587, 0.5, 0.8413].map(|q| found[(q * n as f64) as usize]);
    // standard errors: 1.25 and 1.1 times the spread over √n
    assert!((median - libm::log(TOLD)).abs() < 0.2, "{median}");
    assert!((0.5 * (high - low) - SPREAD).abs() < 0.17, "{low} {high}");
}

#[test]
fn no_contact_creeps_where_none_is_told_to() {
    assert!(logarithms(0.0).iter().all(|x| *x == f64::NEG_INFINITY));
}
