//! Sums over weighted particles, block by block: [`Sums`].

use stickslip_dynamics::{Friction, Lanes, Pose, sin_cos};
use stickslip_filter::{Block, WeightedSums};

use crate::EstimateRow;
use crate::angle::nearest_zero;
use crate::chunk::{Column, LANES, flag, part};
use crate::columns::{Columns, Flag};

/// Columns whose spread is told: x, y, μ_s, μ_p, μ_f, d_tri.
const SPREAD: [usize; 6] = [
    Columns::POSE,
    Columns::POSE + 1,
    Columns::FRICTION,
    Columns::FRICTION + 1,
    Columns::FRICTION + 2,
    Columns::FRICTION + 3,
];

/// θ.
pub(crate) const ANGLE: usize = Columns::POSE + 2;

/// What the particles are near: sums of deviations from it lose few digits.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// x, y, μ_s, μ_p, μ_f, d_tri.
    pub spread: [f64; 6],
    /// θ.
    pub angle: f64,
}

impl Reference {
    /// The means of a row.
    pub fn of(row: &EstimateRow) -> Option<Self> {
        row.pose
            .zip(row.friction)
            .map(|(pose, friction)| Self::new(pose, friction))
    }

    /// A pose and friction values.
    pub fn new(
        Pose { x, y, theta }: Pose,
        Friction {
            mu_s,
            mu_p,
            mu_f,
            d_tri,
        }: Friction,
    ) -> Self {
        Self {
            spread: [x, y, mu_s, mu_p, mu_f, d_tri],
            angle: theta,
        }
    }
}

/// Weighted sums over some particles; d is the deviation from the reference.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    /// Σ w d.
    pub first: [f64; 6],
    /// Σ w d².
    pub second: [f64; 6],
    /// Σ w v.
    pub twist: [f64; 3],
    /// Σ w sin d, Σ w cos d, Σ w d, Σ w d² of the angles.
    pub angle: [f64; 4],
    /// Largest |d| of the angles (rad).
    pub widest: f64,
    /// Number of particles whose last step was not solved.
    pub unsolved: f64,
    /// Σ w c_p.
    pub contact_pusher: f64,
    /// Σ w c_j of every fixel.
    pub contact_fixels: Vec<f64>,
}

impl Sums {
    /// Those over one block.
    #[inline(always)]
    pub fn take(
        &mut self,
        block: &Block<'_>,
        weights: &[f64],
        reference: &Reference,
        columns: Columns,
    ) {
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
            widest = widest.max(w.gt(o).zero_unless(d.abs()));
            unsolved += flag(block, Columns::UNSOLVED, chunk).zero_unless(Lanes::splat(1.0));
        }
        self.first = first.map(total);
        self.second = second.map(total);
        self.twist = twist.map(total);
        self.angle = angle.map(total);
        self.widest = widest.0.into_iter().fold(0.0, f64::max);
        self.unsolved = total(unsolved);
        self.contact_pusher = share(block, weights, Columns::CONTACT_PUSHER);
        self.contact_fixels.clear();
        for j in 0..columns.fixels() {
            self.contact_fixels
                .push(share(block, weights, columns.contact_fixel(j)));
        }
    }

    /// Standard deviation of the angles about their mean direction, `turn` from the reference, if
    /// none is on the other side of the circle.
    pub fn angle_std_about(&self, turn: f64) -> f64 {
        let [_, _, d, square] = self.angle;
        (square - 2.0 * turn * d + turn * turn).max(0.0).sqrt()
    }
}

/// Weight of the particles whose flag is set.
#[inline(always)]
fn share(block: &Block<'_>, weights: &[f64], which: Flag) -> f64 {
    let mut sum = Column::ZERO;
    for chunk in 0..block.len().div_ceil(LANES) {
        sum += flag(block, which, chunk).zero_unless(part(weights, chunk, 0.0));
    }
    total(sum)
}

#[inline(always)]
fn total(lanes: Column) -> f64 {
    lanes.0.iter().sum()
}

impl WeightedSums for Sums {
    fn clear(&mut self) {
        let mut contact_fixels = std::mem::take(&mut self.contact_fixels);
        contact_fixels.clear();
        *self = Self {
            contact_fixels,
            ..Self::default()
        };
    }

    fn add(&mut self, other: &Self, share: f64) {
        self.contact_fixels.resize(other.contact_fixels.len(), 0.0);
        for (to, from) in [
            (&mut self.first[..], &other.first[..]),
            (&mut self.second, &other.second),
            (&mut self.twist, &other.twist),
            (&mut self.angle, &other.angle),
            (
                std::slice::from_mut(&mut self.contact_pusher),
                std::slice::from_ref(&other.contact_pusher),
            ),
            (&mut self.contact_fixels, &other.contact_fixels),
        ] {
            to.iter_mut()
                .zip(from)
                .for_each(|(to, from)| *to += share * from);
        }
        self.widest = self.widest.max(other.widest);
        self.unsolved += other.unsolved;
    }
}
