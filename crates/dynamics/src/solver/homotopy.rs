//! The path of smoothed solutions, followed with care, one particle at a time: [`Homotopy`].
//!
//! ε is driven to zero. Every reduction begins with a step along the path's tangent, and every
//! Newton step is halved until the smoothed residual falls.

use stickslip_lanes::{Lanes, Level, Mask, on_widest};

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::linearised::Linearised;
use crate::solver::smoothed_map::SmoothedMap;

/// Smallest ε, as a share of the speed scale.
const SMALLEST: f64 = 1e-11;

/// Reductions of ε, failed ones included.
const REDUCTIONS: u32 = 40;

/// Newton steps at one ε.
const STEPS: u32 = 10;

/// Most halvings of a Newton step.
const HALVINGS: u32 = 6;

/// Full steps without decrease that are allowed at one ε: near a kink the residual must rise before
/// it can fall.
const UPHILL_STEPS: u32 = 3;

/// Smoothed residual in units of ε at which a point counts as on the path.
const ON_PATH: f64 = 0.1;

/// The smoothing homotopy with its working memory.
#[derive(Clone, Debug)]
pub struct Homotopy {
    map: SmoothedMap<1>,
    linearised: Linearised<1>,
    /// The last point on the path.
    settled: Unknowns<1>,
    /// The iterate on the way to the next.
    iterate: Unknowns<1>,
    /// The iterate after a full Newton step.
    full: Unknowns<1>,
    /// The iterate after a part of that step.
    trial: Unknowns<1>,
    level: Level,
}

impl Default for Homotopy {
    fn default() -> Self {
        Self {
            map: SmoothedMap::default(),
            linearised: Linearised::default(),
            settled: Unknowns::default(),
            iterate: Unknowns::default(),
            full: Unknowns::default(),
            trial: Unknowns::default(),
            level: Level::new(),
        }
    }
}

impl Homotopy {
    /// Follows ε from `smoothing` times the problem's speed scale down to [`SMALLEST`] of it.
    ///
    /// `start` seeds the path; returns its end, or the last point reached, which is to be refined.
    /// Where a reduction was too large to recover from, a smaller one is tried from the last point
    /// on the path.
    pub fn follow(&mut self, ncp: &Ncp<1>, start: &Unknowns<1>, smoothing: f64) -> &Unknowns<1> {
        let scale = ncp.speed_scale().0[0];
        let (mut settled_at, mut epsilon) = (smoothing * scale, smoothing * scale);
        let mut reduction = 0.1;
        self.settled.copy_from(start);
        for _ in 0..REDUCTIONS {
            self.iterate.copy_from(&self.settled);
            if self.settle(ncp, settled_at, epsilon) {
                std::mem::swap(&mut self.settled, &mut self.iterate);
                if epsilon < SMALLEST * scale {
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
    pub fn end(&self) -> &Unknowns<1> {
        &self.settled
    }

    /// Moves the iterate, a point of the path at ε = `from`, to the path at `epsilon`; false where
    /// that fails.
    fn settle(&mut self, ncp: &Ncp<1>, from: f64, epsilon: f64) -> bool {
        // a step along the tangent
        if from > epsilon && self.newton_step(ncp, from, epsilon) {
            std::mem::swap(&mut self.iterate, &mut self.full);
        }
        // Newton steps at the new ε
        let mut merit = violation(self.level, &mut self.map, ncp, &self.iterate, epsilon);
        let mut uphill = UPHILL_STEPS;
        for _ in 0..STEPS {
            if merit < ON_PATH * epsilon {
                return true;
            }
            merit = match self.damped_step(ncp, epsilon, merit) {
                Some(next) => next,
                None if uphill > 0 => {
                    uphill -= 1;
                    std::mem::swap(&mut self.iterate, &mut self.full);
                    violation(self.level, &mut self.map, ncp, &self.iterate, epsilon)
                }
                None => return false,
            };
        }
        merit < ON_PATH * epsilon
    }

    /// A Newton step, halved until the smoothed residual falls, which is returned; `None` where
    /// halving does not help.
    fn damped_step(&mut self, ncp: &Ncp<1>, epsilon: f64, merit: f64) -> Option<f64> {
        if !self.newton_step(ncp, epsilon, epsilon) {
            return None;
        }
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            self.trial.blend(&self.iterate, &self.full, Lanes([share]));
            let next = violation(self.level, &mut self.map, ncp, &self.trial, epsilon);
            if next < merit * (1.0 - 0.1 * share) {
                std::mem::swap(&mut self.iterate, &mut self.trial);
                return Some(next);
            }
            share *= 0.5;
        }
        None
    }

    /// Leaves the iterate after a full Newton step in `full`; false where that is not finite.
    fn newton_step(&mut self, ncp: &Ncp<1>, from: f64, target: f64) -> bool {
        self.full.copy_from(&self.iterate);
        on_widest(
            self.level,
            #[inline(always)]
            || {
                self.map.evaluate(ncp, &self.iterate, Lanes([from]));
                self.linearised.linearise_smoothed_map(
                    ncp,
                    &self.iterate,
                    &self.map,
                    Lanes([target]),
                );
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
    z: &Unknowns<1>,
    epsilon: f64,
) -> f64 {
    on_widest(
        level,
        #[inline(always)]
        || map.evaluate(ncp, z, Lanes([epsilon])).0[0],
    )
}
