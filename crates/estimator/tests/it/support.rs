//! Feet of each particle in the robust model (docs/model.md (35)): resampled from the prior while
//! the object rests, kept once it moves.

use std::sync::Mutex;

use crate::common::{PARTICLES, run_into_the_dark, setup};
use stickslip::{Observer, SolvedStep};

/// Steps in which nothing touches the object yet, and steps in which it moves in all particles.
const AT_REST: std::ops::Range<usize> = 0..18;
const MOVING: std::ops::Range<usize> = 45..55;

/// Seeds of runs.
const SEEDS: u64 = 20;

/// Arms of the feet (m), step after step, particle after particle.
#[derive(Debug, Default)]
struct Arms(Mutex<Vec<[[f64; 2]; 3]>>);

impl Observer for Arms {
    fn on_step(&self, step: &SolvedStep<'_>) {
        let mut arms = self.0.lock().expect("no test panicked here");
        arms.push(step.problem.feet.map(|foot| foot.arm));
    }
}

/// The centre of a particle's feet, in standard deviations, and the cosine of the first foot's
/// direction from there.
type Stand = ([f64; 2], f64);

/// Stands of the particles in each step of a run.
type Steps = Vec<Vec<Stand>>;

/// Stands of the particles in all runs.
fn feet() -> Vec<Steps> {
    let mut setup = setup(&[]);
    // so that an angle is that of the turn alone
    setup.uncertainty.foot_stretch = 0.0;
    let told = setup.uncertainty.centre_of_friction * setup.scene.object.gyration_radius();
    let stand = |arms: &[[f64; 2]; 3]| -> Stand {
        let centre = [0, 1].map(|axis| arms.iter().map(|arm| arm[axis]).sum::<f64>() / 3.0);
        let [x, y] = [0, 1].map(|axis| arms[0][axis] - centre[axis]);
        (centre.map(|x| x / told), x / x.hypot(y))
    };
    let run = |seed| {
        let arms = Arms::default();
        run_into_the_dark(&setup, seed, &arms);
        let arms = arms.0.into_inner().expect("no test panicked here");
        let steps = arms.chunks(PARTICLES);
        steps.map(|step| step.iter().map(stand).collect()).collect()
    };
    (0..SEEDS).map(run).collect()
}

fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let numbers: Vec<f64> = numbers.collect();
    numbers.iter().sum::<f64>() / numbers.len() as f64
}

/// Mean square of the centre on an axis, and mean product with that of the step before; 1 is the
/// prior's variance.
fn square_and_product(runs: &[Steps], steps: std::ops::Range<usize>) -> [f64; 2] {
    let pairs: Vec<[[f64; 2]; 2]> = runs
        .iter()
        .flat_map(|run| run[steps.clone()].windows(2))
        .flat_map(|two| two[0].iter().zip(&two[1]))
        .map(|(before, now)| [before.0, now.0])
        .collect();
    let dot = |a: [f64; 2], b: [f64; 2]| 0.5 * (a[0] * b[0] + a[1] * b[1]);
    let square = mean(pairs.iter().map(|[_, now]| dot(*now, *now)));
    [
        square,
        mean(pairs.iter().map(|[before, now]| dot(*before, *now))),
    ]
}

#[test]
fn feet_are_drawn_anew_until_the_object_moves_and_kept_after_that() {
    let runs = feet();

    // 20,000 independent draws on two axes: standard errors 0.007 and 0.005
    let [square, product] = square_and_product(&runs, AT_REST);
    assert!((square - 1.0).abs() < 0.03, "variance {square}");
    assert!(product.abs() < 0.02, "{product}");
    // a normal angle of deviation π/3 has the mean cosine exp(−(π/3)²/2)
    let told = libm::exp(-0.5 * (std::f64::consts::PI / 3.0).powi(2));
    let cosine = mean(
        runs.iter()
            .flat_map(|run| &run[AT_REST])
            .flatten()
            .map(|(_, cos)| *cos),
    );
    assert!((cosine - told).abs() < 0.02, "{cosine}, {told}");

    // 1280 particles, some of which were copied, that wander by a tenth: correlated by √0.99 from
    // step to step, as the object turns a little
    let [square, product] = square_and_product(&runs, MOVING);
    assert!((square - 1.0).abs() < 0.1, "variance {square}");
    let kept = product / square;
    assert!((0.97..0.999).contains(&kept), "{kept}");
}
