//! Friction that runs say they have observed, against truths that are drawn and known.

use stickslip::{FilterModel, Uncertainty};
use stickslip_evaluation::{Physics, Variant};
use stickslip_experiments::{CalibrationOptions, CalibrationRun, Placed, TruthSource};

/// μ_p and μ_f among the quantities of a run.
const CONTACTS: [usize; 2] = [4, 5];

#[test]
fn friction_of_smooth_pushes_is_observed_in_some_and_true_there() {
    // the testbed is another physics, and its pushes have none of the filter's random forces
    let options = CalibrationOptions {
        source: TruthSource::Simulated(Physics::Testbed),
        model: FilterModel::Robust,
        uncertainty: Uncertainty::default(),
        variant: Variant::ParticleCameraOn,
        particles: 500,
    };
    let runs = CalibrationRun::of_papers(96, &options);
    let observed = runs
        .iter()
        .flat_map(|run| CONTACTS.map(|which| run.placed[which]));
    let observed: Vec<Placed> = observed.flatten().collect();
    assert!(observed.len() >= 5, "{} were observed", observed.len());

    let held = observed.iter().filter(|placed| placed.is_held());
    let held = held.count() as f64 / observed.len() as f64;
    // 77 ± 4 % of 192 seeds: the intervals are too narrow (docs/limits.md)
    assert!(held >= 0.65, "{held} of 90 % intervals hold the truth");

    let sum = |distance: fn(&Placed) -> f64| observed.iter().map(distance).sum::<f64>();
    let nearer = sum(|placed| placed.error) / sum(|placed| placed.prior_error);
    assert!(nearer < 0.85, "{nearer} of the prior's error");
}
