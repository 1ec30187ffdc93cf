//! The third solver: the path of smoothed solutions, followed with care, one particle at a time.
//!
//! ε is driven to zero; every reduction begins with a step along the path's tangent, and every step
//! halves until the smoothed residual falls.

use stickslip_lanes::{Lanes, Level, Mask, on_widest};

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Impulses;
use crate::solver::linearised::Linearised;
use crate::solver::smoothed::SmoothedMap;

/// Full steps without decrease that are allowed at one ε.
const BOLD_STEPS: u32 = 3;

/// The smoothing homotopy with its working memory.
#[derive(Clone, Debug)]
pub struct Homotopy {
    map: SmoothedMap<1>,
    linearised: Linearised<1>,
    guess: Impulses<1>,
    full: Impulses<1>,
    trial: Impulses<1>,
    settled: Impulses<1>,
    level: Level,
}

impl Default for Homotopy {
    fn default() -> Self {
        let none = Impulses::zero(0);
        let (map, linearised) = (SmoothedMap::default(), Linearised::default());
        Self {
            map,
            linearised,
            guess: none.clone(),
            full: none.clone(),
            trial: none.clone(),
            settled: none,
            level: Level::new(),
        }
    }
}

impl Homotopy {
    /// Follows ε from `first` times the problem's speed scale down to 1e-11 of it; the end is meant
    /// to be polished.
    ///
    /// `start` seeds the path; returns its end, or the last point reached. Where a reduction was
    /// too bold to recover from, a milder one is tried from the last good point.
    pub fn follow(&mut self, ncp: &Ncp<1>, start: &Impulses<1>, first: f64) -> &Impulses<1> {
        let scale = ncp.speed_scale().0[0];
        let (mut settled_at, mut epsilon) = (first * scale, first * scale);
        let mut reduction = 0.1;
        self.settled.copy_from(start);
        for _ in 0..40 {
            self.guess.copy_from(&self.settled);
            if self.settle(ncp, settled_at, epsilon) {
                std::mem::swap(&mut self.settled, &mut self.guess);
                if epsilon < 1e-11 * scale {
                    break;
                }
                settled_at = epsilon;
                reduction = f64::max(reduction * reduction, 0.01);
            } else if reduction < 0.9 {
                reduction = reduction.sqrt();
            } else {
                break;
            }
            epsilon = settled_at * reduction;
        }
        &self.settled
    }

    /// Where the last path ended.
    pub fn end(&self) -> &Impulses<1> {
        &self.settled
    }

    /// From a point settled at `from`, Newton steps to `epsilon`; false where they do not get
    /// there.
    fn settle(&mut self, ncp: &Ncp<1>, from: f64, epsilon: f64) -> bool {
        if from > epsilon && self.newton_step(ncp, from, epsilon) {
            std::mem::swap(&mut self.guess, &mut self.full);
        }
        let mut merit = violation(self.level, &mut self.map, ncp, &self.guess, epsilon);
        let mut bold = BOLD_STEPS;
        for _ in 0..10 {
            if merit < 0.1 * epsilon {
                return true;
            }
            merit = match self.damped_step(ncp, epsilon, merit) {
                Some(next) => next,
                None if bold > 0 => {
                    // near a kink the residual must rise before it can fall
                    bold -= 1;
                    std::mem::swap(&mut self.guess, &mut self.full);
                    violation(self.level, &mut self.map, ncp, &self.guess, epsilon)
                }
                None => return false,
            };
        }
        merit < 0.1 * epsilon
    }

    /// A Newton step, halved until the smoothed residual falls to what is returned; `None` where
    /// halving does not help.
    fn damped_step(&mut self, ncp: &Ncp<1>, epsilon: f64, merit: f64) -> Option<f64> {
        if !self.newton_step(ncp, epsilon, epsilon) {
            return None;
        }
        let mut share = 1.0;
        for _ in 0..6 {
            self.trial.blend(&self.guess, &self.full, Lanes([share]));
            let next = violation(self.level, &mut self.map, ncp, &self.trial, epsilon);
            if next < merit * (1.0 - 0.1 * share) {
                std::mem::swap(&mut self.guess, &mut self.trial);
                return Some(next);
            }
            share *= 0.5;
        }
        None
    }

    /// Leaves the full step from the guess in `full`; false where it is not finite.
    fn newton_step(&mut self, ncp: &Ncp<1>, from: f64, target: f64) -> bool {
        self.full.copy_from(&self.guess);
        on_widest(
            self.level,
            #[inline(always)]
            || {
                self.map.take(ncp, &self.guess, Lanes([from]));
                self.linearised
                    .smoothed(ncp, &self.guess, &self.map, Lanes([target]));
                self.linearised.step(ncp, &mut self.full, Mask::splat(true));
            },
        );
        self.full.v.iter().all(|v| v.0[0].is_finite()) && self.full.pusher_yield.0[0].is_finite()
    }
}

/// The smoothed residual.
fn violation(
    level: Level,
    map: &mut SmoothedMap<1>,
    ncp: &Ncp<1>,
    p: &Impulses<1>,
    epsilon: f64,
) -> f64 {
    on_widest(
        level,
        #[inline(always)]
        || map.take(ncp, p, Lanes([epsilon])).0[0],
    )
}
