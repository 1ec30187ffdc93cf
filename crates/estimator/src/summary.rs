//! What a particle set amounts to: weighted means and standard deviations of its columns: [`summary`].

use std::f64::consts::FRAC_PI_2;

use stickslip_dynamics::{Friction, Pose, Twist};
use stickslip_filter::ParticleFilter;

use crate::angle::unwrapped;
use crate::contact_model::ContactModel;
use crate::sums::{ANGLE, Reference, Sums};
use crate::{EstimateRow, Spread};

/// The row of weighted means and standard deviations from sums about `reference`; θ is unwrapped from there.
pub(crate) fn summary(filter: &ParticleFilter<ContactModel<'_>>, reference: &Reference) -> EstimateRow {
    let sums = filter.sums();
    let [x, y, mu_s, mu_p, mu_f, d_tri] = std::array::from_fn(|k| reference.spread[k] + sums.first[k]);
    let stds: [f64; 6] = std::array::from_fn(|k| (sums.second[k] - sums.first[k] * sums.first[k]).max(0.0).sqrt());
    let [vx, vy, omega] = sums.twist;
    let turn = libm::atan2(sums.angle[0], sums.angle[1]);
    let theta_std = if sums.widest <= FRAC_PI_2 {
        sums.angle_std_about(turn)
    } else {
        filter.weighted_circular_std_about(reference.angle + turn, ANGLE)
    };
    EstimateRow {
        pose: Some(Pose::new(x, y, unwrapped(reference.angle + turn, reference.angle))),
        twist: Some(Twist { vx, vy, omega }),
        friction: Some(Friction { mu_s, mu_p, mu_f, d_tri }),
        contact_pusher: Some(sums.contact_pusher),
        contact_fixels: Some(sums.contact_fixels.clone()),
        spread: Some(Spread {
            pose: Pose::new(stds[0], stds[1], theta_std),
            friction: Some(Friction { mu_s: stds[2], mu_p: stds[3], mu_f: stds[4], d_tri: stds[5] }),
        }),
        unsolved: Some(sums.unsolved as u32),
        ess: Some(filter.weights().effective_sample_size()),
        ..EstimateRow::default()
    }
}

impl Reference {
    /// The means of a row.
    pub fn of(row: &EstimateRow) -> Option<Self> {
        row.pose.zip(row.friction).map(|(pose, friction)| Self::new(pose, friction))
    }

    pub fn new(Pose { x, y, theta }: Pose, Friction { mu_s, mu_p, mu_f, d_tri }: Friction) -> Self {
        Self { spread: [x, y, mu_s, mu_p, mu_f, d_tri], angle: theta }
    }
}

impl Sums {
    /// Standard deviation of the angles about their mean direction, `turn` from the reference, if none is on the other side of the
    /// circle.
    fn angle_std_about(&self, turn: f64) -> f64 {
        let [_, _, d, square] = self.angle;
        (square - 2.0 * turn * d + turn * turn).max(0.0).sqrt()
    }
}
