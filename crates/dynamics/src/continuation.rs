//! The second solver: one Newton step on the smoothed rows per reduction of ε, `W` particles side by side.
//!
//! Where an object jams or rests among redundant contacts the natural map of the first solver jumps between modes; smoothed rows
//! do not. There is no line search: ε falls a hundredfold whenever the smoothed residual is below [`NEAR`]·ε, so that every
//! particle does the same arithmetic. Long before ε is small the modes show, and Newton's method with these modes held ends it.

use crate::condensed::Linearised;
use crate::impulses::Impulses;
use crate::lanes::{Lanes, Mask};
use crate::natural::NaturalMap;
use crate::ncp::Ncp;
use crate::polish::Polish;
use crate::smoothing::SmoothedMap;

/// Smoothed residual, in units of ε, below which ε may fall.
const NEAR: f64 = 1e3;

/// Factor by which ε falls, and between one look at the modes and the next.
const REDUCTION: f64 = 0.01;

/// Smallest ε, as a share of the speed scale.
const SMALLEST: f64 = 1e-11;

/// Newton steps on smoothed rows.
const STEPS: u32 = 30;

/// Share of its bound above which an impulse is taken to slide.
const SLIDING: f64 = 0.98;

/// Newton steps with modes held.
const POLISH_STEPS: u32 = 2;

/// The continuation with its working memory.
#[derive(Clone, Debug)]
pub struct Continuation<const W: usize> {
    map: SmoothedMap<W>,
    linearised: Linearised<W>,
    certificate: NaturalMap<W>,
    polish: Polish<W>,
    path: Impulses<W>,
    trial: Impulses<W>,
}

impl<const W: usize> Default for Continuation<W> {
    fn default() -> Self {
        let none = Impulses::zero(0);
        Self {
            map: SmoothedMap::default(),
            linearised: Linearised::default(),
            certificate: NaturalMap::default(),
            polish: Polish::default(),
            path: none.clone(),
            trial: none,
        }
    }
}

impl<const W: usize> Continuation<W> {
    /// Starts at `p` with ε = `start` times each problem's speed scale; where it reaches a residual of at most `tolerance`,
    /// `p` becomes the solution. Returns the residual of each lane and the Newton steps.
    #[inline(always)]
    pub fn solve(&mut self, ncp: &Ncp<W>, p: &mut Impulses<W>, start: f64, tolerance: f64) -> (Lanes<W>, Lanes<W>) {
        let scale = ncp.speed_scale();
        let smallest = scale * SMALLEST;
        let mut epsilon = scale * start;
        let mut next_look = epsilon;
        self.path.copy_from(p);
        let mut violation = self.map.take(ncp, &self.path, epsilon);
        let mut residual = Lanes::splat(f64::INFINITY);
        let mut steps = Lanes::ZERO;
        let mut open = Mask::splat(true);
        for _ in 0..STEPS {
            let near = violation.lt(epsilon * NEAR);
            let target = near.select(epsilon * REDUCTION, epsilon);
            self.linearised.smoothed(ncp, &self.path, &self.map, target);
            self.linearised.step(ncp, &mut self.path, open);
            steps += open.keep(Lanes::splat(1.0));
            epsilon = open.select(target, epsilon);
            violation = self.map.take(ncp, &self.path, epsilon);

            let look = open & violation.lt(epsilon * NEAR) & !epsilon.gt(next_look);
            if look.any() {
                next_look = look.select(next_look * REDUCTION, next_look);
                let polished = self.polish(ncp, look);
                residual = look.select(polished, residual);
                let done = look & !polished.gt(Lanes::splat(tolerance));
                p.copy_where(done, &self.trial);
                open = open & !done & epsilon.gt(smallest);
            }
            if !open.any() {
                break;
            }
        }
        (residual, steps)
    }

    /// Tries the modes that the path shows in the lanes of `look`; the residual of what that leads to.
    #[inline(always)]
    fn polish(&mut self, ncp: &Ncp<W>, look: Mask<W>) -> Lanes<W> {
        self.trial.copy_from(&self.path);
        self.polish.polish(ncp, &mut self.trial, look, SLIDING, POLISH_STEPS);
        self.certificate.take(ncp, &self.trial)
    }
}
