//! The extended Kalman filter baseline: a normal distribution of pose, twist and friction that goes
//! through Γ, as the particles do (docs/method.md (46) to (48)).
//!
//! It takes friction and the disturbing force as unknown, like the robust model, and moves by the
//! same pusher track. Its belief is normal, and its transition is linear, by differences.
//!
//! Tactile readings are not used. A reading is 0 or 1, and this filter could use only its
//! derivative by the state, which is 0 nearly everywhere. Offsets, outline, feet and the unknown
//! part of the latency are left out, too.

use crate::baseline::belief::Belief;
use crate::baseline::linearised_step::LinearisedStep;
use crate::baseline::nominal::touch;
use crate::baseline::pose_update::PoseUpdate;
use crate::estimate::{Estimate, EstimateRow};
use crate::particle::transition::noise_clock::NOISE_STEP;
use crate::prepared_log::PreparedLog;
use crate::setup::{Camera, Setup};

/// Filters the visible object poses of `prepared`. Also returns how often the belief restarted
/// because several poses in a row were unexpected.
pub(crate) fn track(
    setup: &Setup,
    camera: Camera,
    prepared: &PreparedLog<'_>,
    progress: &mut dyn FnMut(usize),
) -> (Estimate, u32) {
    let first = prepared.first;
    let mut camera = PoseUpdate::new(camera, prepared.start);
    let noise = camera.noise(prepared.covariance(first));
    let mut belief = Belief::at_rest(setup, prepared.start, &noise);
    let mut step = LinearisedStep::new(setup, prepared.observer);
    let mut estimate = prepared.empty_estimate(setup);
    estimate.rows[first] = EstimateRow {
        visual: true,
        ..belief.row()
    };
    for row in first + 1..prepared.log.len() {
        predict(&mut step, &mut belief, (prepared, row));
        let noise = camera.noise(prepared.covariance(row));
        let pose = prepared.visible(row);
        let visual = pose.is_some_and(|pose| camera.see(&mut belief, pose, &noise));
        let last = prepared.schedule.step(row - 1).last();
        let touch = touch(setup, step.work(), last, &estimate.rows[row - 1]);
        let (contact_pusher, contact_others) = touch.unzip();
        let [unsolved, failed] = step.since.counts();
        estimate.rows[row] = EstimateRow {
            contact_pusher,
            contact_others,
            visual,
            unsolved: Some(unsolved),
            failed: Some(failed),
            ..belief.row()
        };
        progress(row);
    }
    (estimate, camera.restarts)
}

/// Makes the steps that lead to a row, and the drift of friction on the way.
fn predict(
    step: &mut LinearisedStep<'_>,
    belief: &mut Belief,
    (prepared, row): (&PreparedLog<'_>, usize),
) {
    step.begin_row();
    for input in prepared.schedule.step(row - 1) {
        step.advance(belief, input);
    }
    if prepared.schedule.driven(row - 1) || prepared.visible(row).is_some() {
        let h = prepared.log.time[row] - prepared.log.time[row - 1];
        belief.drift(&step.since.took_part, h / NOISE_STEP);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baseline::belief::TWIST;
    use crate::baseline::pose_update::PoseNoise;
    use crate::setup::{FilterSettings, Tactile};
    use crate::uncertainty::Uncertainty;
    use stickslip_dynamics::{Feet, Friction, Object, Part, Pose, Pusher, Scene, Shape, StepInput};

    const LATENCY: f64 = 0.02;

    /// A disc of known friction on its tripod, without fixels.
    fn alone() -> Setup {
        let disc = |radius| {
            let centre = [0.0, 0.0];
            Shape::new(vec![Part::Disc { radius, centre }]).expect("a disc")
        };
        Setup {
            scene: Scene {
                gravity: 9.81,
                object: Object {
                    mass: 0.5,
                    inertia: 2e-4,
                    shape: disc(0.03),
                },
                feet: Feet::Tripod { angle: 0.0 },
                pusher: Pusher {
                    fingers: vec![disc(0.005)],
                    stall_force: Some(20.0),
                },
                fixels: Vec::new(),
                nominal: Friction {
                    mu_s: 0.3,
                    mu_p: 0.3,
                    mu_f: 0.3,
                    d_tri: 0.02,
                },
            },
            stall_force_assumed: false,
            camera: None,
            tactile: Tactile::default(),
            wrench: None,
            filter: FilterSettings::default(),
            uncertainty: Uncertainty {
                friction: Friction::default(),
                force_std: 0.1,
                ..Uncertainty::default()
            },
            start: None,
        }
    }

    /// A disc that slides without turning is braked by the same force at any speed along its way.
    /// So x and v_x are a linear system, and this is its Kalman filter, written out.
    #[test]
    fn a_disc_that_slides_freely_has_the_exact_answer_along_its_way() {
        let (setup, h) = (alone(), 1.0 / 30.0);
        let (sigma, turn) = (3e-4, 5e-3);
        let camera = Camera {
            position_std: sigma,
            orientation_std: turn,
            latency: LATENCY,
            pusher_position_std: 0.0,
            pusher_orientation_std: 0.0,
        };
        let mut camera = PoseUpdate::new(camera, Pose::default());
        let noise = camera.noise(None);
        let mut belief = Belief::at_rest(&setup, Pose::default(), &noise);
        let mut step = LinearisedStep::new(&setup, None);
        belief.normal.mean[TWIST] = 2.0;
        belief.normal.covariance[(TWIST, TWIST)] = 1e-4;

        let brake: f64 = 0.3 * 9.81 * h;
        let force = (0.1 * brake).powi(2);
        let (mut x, mut v) = (0.0, 2.0);
        let (mut xx, mut xv, mut vv) = (sigma * sigma, 0.0, 1e-4);
        for row in 1..15 {
            let input = StepInput { h, pusher: None };
            step.begin_row();
            step.advance(&mut belief, &input);
            // v' = v - brake + w, x' = x + h v'
            v -= brake;
            x += h * v;
            vv += force;
            (xx, xv) = (xx + 2.0 * h * xv + h * h * vv, xv + h * vv);
            if row % 3 == 0 {
                // off by a part of the noise, other at every row
                let z = x - LATENCY * v + sigma * (f64::from(row) / 6.0 - 1.0);
                assert!(camera.see(&mut belief, Pose::new(z, 0.0, 0.0), &noise));
                // of x - L v
                let (to_x, to_v) = (xx - LATENCY * xv, xv - LATENCY * vv);
                let s = to_x - LATENCY * to_v + sigma * sigma;
                let innovation = z - x + LATENCY * v;
                (x, v) = (x + to_x / s * innovation, v + to_v / s * innovation);
                xx -= to_x * to_x / s;
                xv -= to_x * to_v / s;
                vv -= to_v * to_v / s;
            }
            let (mean, covariance) = (&belief.normal.mean, &belief.normal.covariance);
            for (found, expected, scale) in [
                (mean[0], x, xx.sqrt()),
                (mean[TWIST], v, vv.sqrt()),
                (covariance[(0, 0)], xx, xx),
                (covariance[(0, TWIST)], xv, (xx * vv).sqrt()),
                (covariance[(TWIST, TWIST)], vv, vv),
            ] {
                assert!(
                    (found - expected).abs() < 1e-6 * scale,
                    "row {row}: {found} {expected}"
                );
            }
        }
        assert_eq!(step.since.counts(), [0, 0]);
    }

    #[test]
    fn forces_last_for_a_thirtieth_of_a_second() {
        // thirty steps of a millisecond add up to one of their length, of the same force
        let setup = alone();
        let after = |h: f64, steps: u32| {
            let mut belief = Belief::at_rest(&setup, Pose::default(), &PoseNoise::zeros());
            let mut step = LinearisedStep::new(&setup, None);
            belief.normal.mean[TWIST] = 2.0;
            step.begin_row();
            for _ in 0..steps {
                step.advance(&mut belief, &StepInput { h, pusher: None });
            }
            belief.normal.covariance[(TWIST, TWIST)].sqrt()
        };
        // 33 steps of 1 ms make 33 ms of the 33.3 that a force lasts: √(33 · 0.03)
        let (slow, fast) = (after(1.0 / 30.0, 1), after(1e-3, 33));
        let expected = slow * (33.0_f64 * 0.03).sqrt();
        assert!((fast / expected - 1.0).abs() < 1e-6, "{fast} {expected}");
    }
}
