//! From a point near a solution to a certified one, one particle at a time: [`Refiner`].

use stickslip_lanes::{Level, Mask, on_widest};

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::report::TOLERANCE;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::fixed_mode_newton::FixedModeNewton;
use crate::solver::newton::{Newton, NewtonSettings};

/// Newton steps in fixed modes, and iterations of [`Newton`] after them.
const ITERATIONS: u32 = 30;

/// Of the Newton iteration, which may still be far from a solution.
const SETTINGS: NewtonSettings = NewtonSettings {
    tolerance: TOLERANCE,
    iterations: ITERATIONS,
    slip_weight: 1.0,
};

/// Shares of its bound above which an impulse is taken to slide, tried in turn.
const SLIDING: [f64; 3] = [0.9999, 0.98, 0.8];

/// The refinement with its working memory.
#[derive(Clone, Debug)]
pub struct Refiner {
    /// The refined point.
    pub z: Unknowns<1>,
    fixed_modes: FixedModeNewton<1>,
    newton: Newton<1>,
    map: NaturalMap<1>,
    level: Level,
}

impl Default for Refiner {
    fn default() -> Self {
        Self {
            z: Unknowns::default(),
            fixed_modes: FixedModeNewton::default(),
            newton: Newton::default(),
            map: NaturalMap::default(),
            level: Level::new(),
        }
    }
}

impl Refiner {
    /// Refines `guess` into `self.z`, in the modes that the guess shows, else by [`Newton`] from
    /// the guess as it is; returns the residual.
    pub fn refine(&mut self, ncp: &Ncp<1>, guess: &Unknowns<1>) -> f64 {
        let residual = self.try_modes(ncp, guess, &SLIDING, ITERATIONS);
        if residual <= TOLERANCE {
            return residual;
        }
        self.z.copy_from(guess);
        on_widest(
            self.level,
            #[inline(always)]
            || self.newton.solve(ncp, &mut self.z, SETTINGS).0[0],
        )
    }

    /// At most `limit` Newton steps from `guess` in the modes that it shows, for each share of
    /// `sliding` until one is certified; leaves the last result in `self.z` and returns its
    /// residual.
    pub fn try_modes(
        &mut self,
        ncp: &Ncp<1>,
        guess: &Unknowns<1>,
        sliding: &[f64],
        limit: u32,
    ) -> f64 {
        let mut residual = f64::INFINITY;
        for &share in sliding {
            self.z.copy_from(guess);
            residual = on_widest(
                self.level,
                #[inline(always)]
                || {
                    self.fixed_modes
                        .solve(ncp, &mut self.z, Mask::splat(true), share, limit);
                    self.map.evaluate(ncp, &self.z).0[0]
                },
            );
            if residual <= TOLERANCE {
                break;
            }
        }
        residual
    }
}
