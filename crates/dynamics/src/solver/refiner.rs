//! From a point near a solution to a certified one, one particle at a time: [`Refiner`].

use stickslip_lanes::{Lanes, Level, Mask, on_fused};

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::report::TOLERANCE;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::exhaustive::certifier::Judged;
use crate::solver::fixed_mode_newton::FixedModeNewton;
use crate::solver::newton::{Newton, NewtonSettings};

/// Newton steps in fixed modes, and iterations of [`Newton`] after them.
const ITERATIONS: u32 = 12;

/// Of the Newton iteration, which may still be far from a solution.
const SETTINGS: NewtonSettings = NewtonSettings {
    tolerance: TOLERANCE,
    iterations: ITERATIONS,
    slip_weight: 1.0,
};

/// Shares of its bound above which an impulse is taken to slide, tried in turn.
const SLIDING: [f64; 2] = [0.9999, 0.98];

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
    /// the guess as it is.
    pub fn refine(&mut self, ncp: &Ncp<1>, guess: &Unknowns<1>) -> Judged {
        let mut systems = 0;
        for sliding in SLIDING {
            self.z.copy_from(guess);
            let (residual, steps) = self.fixed_modes(ncp, sliding);
            systems += steps;
            if ncp.certifies(&self.z, Lanes([residual])).all() {
                return Judged {
                    certified: true,
                    systems,
                };
            }
        }
        let end = self.iterate(ncp, guess, SETTINGS);
        Judged {
            systems: systems + end.systems,
            ..end
        }
    }

    /// Copies `guess` into `self.z`, and judges it as it is.
    pub fn accept(&mut self, ncp: &Ncp<1>, guess: &Unknowns<1>) -> Judged {
        self.z.copy_from(guess);
        let residual = ncp.residual(&self.z);
        Judged {
            certified: ncp.certifies(&self.z, residual).all(),
            systems: 1,
        }
    }

    /// [`Newton`] from `start` into `self.z`.
    pub fn iterate(
        &mut self,
        ncp: &Ncp<1>,
        start: &Unknowns<1>,
        settings: NewtonSettings,
    ) -> Judged {
        self.z.copy_from(start);
        let end = on_fused(
            self.level,
            #[inline(always)]
            || self.newton.solve(ncp, &mut self.z, settings),
        );
        Judged {
            certified: ncp.certifies(&self.z, end.residual).all(),
            systems: end.iterations.0[0] as u32,
        }
    }

    /// Newton steps in the modes that `self.z` shows: its residual then, and how many.
    fn fixed_modes(&mut self, ncp: &Ncp<1>, sliding: f64) -> (f64, u32) {
        on_fused(
            self.level,
            #[inline(always)]
            || {
                let all = Mask::splat(true);
                let steps = self
                    .fixed_modes
                    .solve(ncp, &mut self.z, all, sliding, ITERATIONS);
                (self.map.evaluate(ncp, &self.z).0[0], steps)
            },
        )
    }
}
