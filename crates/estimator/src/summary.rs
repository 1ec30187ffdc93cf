//! What a particle set amounts to: weighted means and standard deviations of its columns:
//! [`summary`].

use std::f64::consts::FRAC_PI_2;

use stickslip_dynamics::{Friction, Pose, Twist};
use stickslip_filter::ParticleFilter;

use crate::contact_model::ContactModel;
use crate::sums::{ANGLE, Reference};
use crate::{EstimateRow, Spread};

/// The row of weighted means and standard deviations from sums about `reference`; θ is the nearest
/// to that of the reference.
pub(crate) fn summary(
    filter: &ParticleFilter<ContactModel<'_>>,
    reference: &Reference,
) -> EstimateRow {
    let sums = filter.sums();
    let [x, y, mu_s, mu_p, mu_f, d_tri] =
        std::array::from_fn(|k| reference.spread[k] + sums.first[k]);
    let stds: [f64; 6] = std::array::from_fn(|k| {
        (sums.second[k] - sums.first[k] * sums.first[k])
            .max(0.0)
            .sqrt()
    });
    let [vx, vy, omega] = sums.twist;
    let turn = libm::atan2(sums.angle[0], sums.angle[1]);
    let theta_std = if sums.widest <= FRAC_PI_2 {
        sums.angle_std_about(turn)
    } else {
        filter.weighted_circular_std_about(reference.angle + turn, ANGLE)
    };
    EstimateRow {
        pose: Some(Pose::new(x, y, reference.angle + turn)),
        twist: Some(Twist { vx, vy, omega }),
        friction: Some(Friction {
            mu_s,
            mu_p,
            mu_f,
            d_tri,
        }),
        contact_pusher: Some(sums.contact_pusher),
        contact_fixels: Some(sums.contact_fixels.clone()),
        spread: Some(Spread {
            pose: Pose::new(stds[0], stds[1], theta_std),
            friction: Some(Friction {
                mu_s: stds[2],
                mu_p: stds[3],
                mu_f: stds[4],
                d_tri: stds[5],
            }),
        }),
        unsolved: Some(sums.unsolved as u32),
        ess: Some(filter.weights().effective_sample_size()),
        ..EstimateRow::default()
    }
}
