//! What a particle set amounts to: weighted means and standard deviations of its columns, in one pass over the particles: [`summary`].

use std::f64::consts::FRAC_PI_2;

use stickslip_dynamics::{Friction, Lanes, Level, Pose, Twist, on_widest, sin_cos};
use stickslip_filter::{Block, ParticleFilter};

use crate::angle::{nearest_zero, unwrapped};
use crate::chunk::{Column, LANES, flag, part};
use crate::columns::{Columns, Flag};
use crate::contact_model::ContactModel;
use crate::{EstimateRow, Spread};

/// Columns whose spread is told: x, y, μ_s, μ_p, μ_f, d_tri.
const SPREAD: [usize; 6] =
    [Columns::POSE, Columns::POSE + 1, Columns::FRICTION, Columns::FRICTION + 1, Columns::FRICTION + 2, Columns::FRICTION + 3];

/// θ.
const ANGLE: usize = Columns::POSE + 2;

/// One particle of the set: sums of deviations from it, which is near the others, lose no digits.
#[derive(Clone, Copy, Debug)]
struct Reference {
    spread: [f64; 6],
    angle: f64,
}

/// Weighted sums over some particles; d is the deviation from the reference.
#[derive(Clone, Debug)]
struct Sums {
    /// Σ w d.
    first: [f64; 6],
    /// Σ w d².
    second: [f64; 6],
    /// Σ w v.
    twist: [f64; 3],
    /// Σ w c_p.
    contact_pusher: f64,
    /// Σ w sin d, Σ w cos d, Σ w d, Σ w d² of the angles.
    angle: [f64; 4],
    /// Largest |d| of the angles (rad).
    widest: f64,
    /// Number of particles whose last step was not solved.
    unsolved: f64,
    /// Σ w c_j of every fixel.
    contact_fixels: Vec<f64>,
}

/// The row of weighted means and standard deviations; θ is unwrapped from `near`.
pub(crate) fn summary(filter: &ParticleFilter<ContactModel<'_>>, near: f64) -> EstimateRow {
    let level = Level::new();
    let value = |column: usize| filter.particles().value(0, column);
    let reference = Reference { spread: SPREAD.map(value), angle: value(ANGLE) };
    let columns = filter.model().layout();
    let of_block = |block: &Block<'_>, weights: &[f64]| {
        on_widest(
            level,
            #[inline(always)]
            || Sums::of_block(block, weights, &reference, columns),
        )
    };
    let sums = filter.reduce(of_block, Sums::plus);

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
        pose: Some(Pose::new(x, y, unwrapped(reference.angle + turn, near))),
        twist: Some(Twist { vx, vy, omega }),
        friction: Some(Friction { mu_s, mu_p, mu_f, d_tri }),
        contact_pusher: Some(sums.contact_pusher),
        contact_fixels: Some(sums.contact_fixels),
        spread: Some(Spread {
            pose: Pose::new(stds[0], stds[1], theta_std),
            friction: Some(Friction { mu_s: stds[2], mu_p: stds[3], mu_f: stds[4], d_tri: stds[5] }),
        }),
        unsolved: Some(sums.unsolved as u32),
        ess: Some(filter.weights().effective_sample_size()),
        ..EstimateRow::default()
    }
}

impl Sums {
    #[inline(always)]
    fn of_block(block: &Block<'_>, weights: &[f64], reference: &Reference, columns: Columns) -> Self {
        let o = Column::ZERO;
        let (mut first, mut second, mut twist, mut angle) = ([o; 6], [o; 6], [o; 3], [o; 4]);
        let (mut widest, mut unsolved) = (o, o);
        for chunk in 0..block.len().div_ceil(LANES) {
            let of_column = |column: usize| part(block.column(column), chunk, 0.0);
            let w = part(weights, chunk, 0.0);
            for k in 0..6 {
                let d = of_column(SPREAD[k]) - reference.spread[k];
                first[k] += w * d;
                second[k] += w * d * d;
            }
            for k in 0..3 {
                twist[k] += w * of_column(Columns::TWIST + k);
            }
            let d = nearest_zero(of_column(ANGLE) - reference.angle);
            let (sin, cos) = sin_cos(d);
            for (sum, value) in angle.iter_mut().zip([sin, cos, d, d * d]) {
                *sum += w * value;
            }
            widest = widest.max(w.gt(o).keep(d.abs()));
            unsolved += flag(block, Columns::UNSOLVED, chunk).keep(Lanes::splat(1.0));
        }
        let total = |lanes: Column| lanes.0.iter().sum::<f64>();
        let share = |which: Flag| {
            let mut sum = o;
            for chunk in 0..block.len().div_ceil(LANES) {
                sum += flag(block, which, chunk).keep(part(weights, chunk, 0.0));
            }
            total(sum)
        };
        Self {
            first: first.map(total),
            second: second.map(total),
            twist: twist.map(total),
            contact_pusher: share(Columns::CONTACT_PUSHER),
            angle: angle.map(total),
            widest: widest.0.into_iter().fold(0.0, f64::max),
            unsolved: total(unsolved),
            contact_fixels: (0..columns.fixels()).map(|j| share(columns.contact_fixel(j))).collect(),
        }
    }

    fn plus(self, other: Self) -> Self {
        let mut contact_fixels = self.contact_fixels;
        contact_fixels.iter_mut().zip(other.contact_fixels).for_each(|(sum, more)| *sum += more);
        Self {
            contact_fixels,
            first: added(self.first, other.first),
            second: added(self.second, other.second),
            twist: added(self.twist, other.twist),
            contact_pusher: self.contact_pusher + other.contact_pusher,
            angle: added(self.angle, other.angle),
            widest: self.widest.max(other.widest),
            unsolved: self.unsolved + other.unsolved,
        }
    }

    /// Standard deviation of the angles about their mean direction, `turn` from the reference, if none is on the other side of the
    /// circle.
    fn angle_std_about(&self, turn: f64) -> f64 {
        let [_, _, d, square] = self.angle;
        (square - 2.0 * turn * d + turn * turn).max(0.0).sqrt()
    }
}

fn added<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] + b[k])
}
