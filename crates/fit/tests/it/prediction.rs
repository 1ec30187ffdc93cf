//! Side by side, predictions are the nominal simulation.

use crate::common::pushes;
use stickslip::dynamics::{Friction, Pose};
use stickslip::{Method, NominalPredictor, RunOptions, Surface, run};
use stickslip_evaluation::Physics;

/// The nominal simulation of a run is another loop over the same step.
#[test]
fn predictions_are_nominal_simulations_bit_for_bit() {
    let friction = Friction {
        mu_s: 0.3,
        mu_p: 0.4,
        mu_f: 0.3,
        d_tri: 0.02,
    };
    let push = pushes(friction, Physics::Model, 1, 7).remove(0);
    let predictor = NominalPredictor::new(&push.setup, &push.log).unwrap();
    let simulated = |friction: Friction| -> Vec<Pose> {
        let mut setup = push.setup.clone();
        setup.scene.nominal = friction;
        let options = RunOptions {
            method: Method::Nominal,
            ..RunOptions::default()
        };
        let run = run(&setup, &push.log, &options, &mut |_| ()).unwrap();
        let poses = run.estimate.rows.iter().filter_map(|row| row.pose);
        poses.collect()
    };
    let frictions: Vec<Friction> = (0..11)
        .map(|k| Friction {
            mu_p: 0.1 * f64::from(k),
            d_tri: 0.01 + 0.002 * f64::from(k),
            ..friction
        })
        .collect();
    let surfaces: Vec<Surface> = frictions.iter().map(|one| (*one).into()).collect();
    let together = predictor.predict(&surfaces);
    assert_eq!(together.len(), 11);
    for (friction, prediction) in frictions.iter().zip(&together) {
        assert_eq!(prediction.poses, simulated(*friction));
        assert_eq!(predictor.predict(&[(*friction).into()])[0], *prediction);
    }
    assert_ne!(together[0].poses, together[1].poses);
}
