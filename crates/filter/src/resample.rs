//! Resampling: N ancestors drawn so that particle i is the ancestor of N w_i particles on average.
//!
//! The schemes differ in their noise (Douc, Cappé & Moulines 2005): systematic gives every particle
//! either the integer below N w_i or the one above, from one random number.

use crate::streams::Draw;

/// A resampling scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Resampling {
    /// Points `(i + u) / N` with one u (Kitagawa 1996).
    #[default]
    Systematic,
    /// Points `(i + u_i) / N`, one u_i per stratum (Kitagawa 1996).
    Stratified,
    /// `floor(N w_i)` copies for certain, the rest multinomial (Liu & Chen 1998).
    Residual,
    /// Independent ancestors (Gordon, Salmond & Smith 1993).
    Multinomial,
}

impl Resampling {
    /// Writes the ancestors, indices into `weights` (which sum to 1); `draw` is used as particle 0.
    ///
    /// A particle of weight zero is never an ancestor. The number of ancestors need not be that of
    /// the weights.
    pub fn ancestors(self, weights: &[f64], draw: Draw, ancestors: &mut [u32]) {
        let n = ancestors.len() as f64;
        let weight = |i: usize| weights[i];
        match self {
            Resampling::Systematic => {
                let u = draw.uniform(0, 0);
                invert(weights.len(), weight, |i| (i as f64 + u) / n, ancestors);
            }
            Resampling::Stratified => {
                invert(
                    weights.len(),
                    weight,
                    |i| (i as f64 + draw.uniform(0, i as u32)) / n,
                    ancestors,
                );
            }
            Resampling::Residual => residual(weights, draw, ancestors),
            Resampling::Multinomial => multinomial(weights.len(), weight, draw, ancestors),
        }
    }
}

fn residual(weights: &[f64], draw: Draw, ancestors: &mut [u32]) {
    let n = ancestors.len() as f64;
    let mut filled = 0;
    for (i, w) in weights.iter().enumerate() {
        let copies = (n * w).floor() as usize;
        ancestors[filled..filled + copies].fill(i as u32);
        filled += copies;
    }
    let rest = &mut ancestors[filled..];
    let remainder = |i: usize| n * weights[i] - (n * weights[i]).floor();
    multinomial(weights.len(), remainder, draw, rest);
}

/// Sorted uniform points in one pass without a sort: the partial sums of K + 1 exponential spacings
/// over their total (Devroye 1986, V.3.1). The spacings are evaluated twice rather than stored.
fn multinomial(particles: usize, weight: impl Fn(usize) -> f64, draw: Draw, ancestors: &mut [u32]) {
    if ancestors.is_empty() {
        return;
    }
    let spacing = |i: usize| -libm::log(draw.uniform(0, i as u32));
    let total: f64 = (0..=ancestors.len()).map(spacing).sum();
    let mut reached = 0.0;
    let point = |i: usize| {
        reached += spacing(i);
        reached / total
    };
    invert(particles, weight, point, ancestors);
}

/// Ancestor i is where the cumulated weights pass `point(i)` of their total; the points rise within
/// (0, 1).
fn invert(
    particles: usize,
    weight: impl Fn(usize) -> f64,
    mut point: impl FnMut(usize) -> f64,
    ancestors: &mut [u32],
) {
    let total: f64 = (0..particles).map(&weight).sum();
    let last = (0..particles).rev().find(|&i| weight(i) > 0.0);
    let Some(last) = last.filter(|_| total.is_finite()) else {
        panic!("weights with the sum {total} have no ancestors");
    };
    let (mut particle, mut reached) = (0, weight(0));
    for (i, ancestor) in ancestors.iter_mut().enumerate() {
        let goal = point(i) * total;
        // rounding may leave the cumulated sum short of the total: stop at the last weight that
        // counts
        while reached <= goal && particle < last {
            particle += 1;
            reached += weight(particle);
        }
        *ancestor = particle as u32;
    }
}
