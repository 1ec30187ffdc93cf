//! Semismooth Newton iteration on the natural map of the mixed NCP, `W` particles side by side:
//! [`Newton`].
//!
//! As in Alart & Curnier (1991), the natural map of the iterate chooses every row's mode. Either
//! the row is *active*, and its velocity is driven to zero: the gap of a closed contact, the slip
//! of a sticking one or of a sticking foot. Or its impulse follows from the other rows. Slips have
//! weights of their own in that choice. An active row has a finite penalty stiffness k and keeps
//! its impulse from one iteration to the next (a method of multipliers), so redundant contacts do
//! no harm. Once the modes are right, the error shrinks by K/(K + k) an iteration, where K is the
//! stiffness of all other resistance. The start is the particle's last step. A stiff penalty
//! converges sooner, a soft one copes better with modes that contradict each other: the iterations
//! alternate.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::contact_mode::{ContactMode, Penalty};
use crate::solver::linearised::{ContactStep, FootStep, Linearised, StallStep};
use crate::solver::stick_predictor::StickPredictor;

/// Stiff penalty, in units of the object's mass per step: well above the stiffness of sliding feet,
/// bound / slip speed, which resist the creep of a jammed object at 1e-8 m/s.
const STIFF: f64 = 5.0e8;

/// Soft penalty, for where stiff iterations do not converge: active rows that contradict each other
/// drive their impulses up in proportion to it.
const SOFT: f64 = 3.0e6;

/// So many iterations are stiff, as many soft, and so on.
const ALTERNATION: f64 = 8.0;

/// Limits of the iteration, and rule by which it chooses the modes of feet.
#[derive(Clone, Copy, Debug)]
pub struct NewtonSettings {
    /// Residual at which a lane has converged (m/s).
    pub tolerance: f64,
    /// Most iterations.
    pub iterations: u32,
    /// Weight k of a foot's slip against its impulse, see [`StickPredictor`]:
    /// [`SLIP_WEIGHT_NEAR`](crate::solver::stick_predictor::SLIP_WEIGHT_NEAR) a solution, 1 far
    /// from one.
    pub slip_weight: f64,
}

/// Limits up to which all lanes of a chunk iterate, running or not.
#[derive(Clone, Copy, Debug)]
pub struct BatchLimits {
    /// Most iterations.
    pub iterations: u32,
    /// Fewest running lanes, at least 1, for which another iteration is worth it.
    pub lanes: u32,
}

impl BatchLimits {
    /// Until no lane runs.
    #[inline(always)]
    pub fn until_finished(settings: &NewtonSettings) -> Self {
        Self {
            iterations: settings.iterations,
            lanes: 1,
        }
    }
}

/// Progress of each lane.
#[derive(Clone, Copy, Debug)]
pub struct Progress<const W: usize> {
    /// Residual at the present point (m/s).
    pub residual: Lanes<W>,
    /// Iterations taken.
    pub iterations: Lanes<W>,
    /// Lanes that have neither converged nor taken all iterations, nor been given up.
    pub running: Mask<W>,
}

impl<const W: usize> Default for Progress<W> {
    /// Nothing runs.
    fn default() -> Self {
        Self {
            residual: Lanes::ZERO,
            iterations: Lanes::ZERO,
            running: Mask::splat(false),
        }
    }
}

impl<const W: usize> Progress<W> {
    /// Copies one lane into lane `slot` of `to`.
    #[inline(always)]
    pub fn pack_lane<const V: usize>(&self, lane: usize, to: &mut Progress<V>, slot: usize) {
        to.residual.0[slot] = self.residual.0[lane];
        to.iterations.0[slot] = self.iterations.0[lane];
        to.running.set(slot, self.running.lane(lane));
    }
}

/// The Newton iteration with its working memory.
#[derive(Clone, Debug, Default)]
pub struct Newton<const W: usize> {
    map: NaturalMap<W>,
    linearised: Linearised<W>,
}

impl<const W: usize> Newton<W> {
    /// Iterates from `z` until every lane has converged or taken all iterations.
    #[inline(always)]
    pub fn solve(
        &mut self,
        ncp: &Ncp<W>,
        z: &mut Unknowns<W>,
        settings: NewtonSettings,
    ) -> Progress<W> {
        let limits = BatchLimits::until_finished(&settings);
        self.begin(ncp, z, settings, limits)
    }

    /// Iterates all lanes from `z` within `limits`; [`Newton::iterate`] continues.
    #[inline(always)]
    pub fn begin(
        &mut self,
        ncp: &Ncp<W>,
        z: &mut Unknowns<W>,
        settings: NewtonSettings,
        limits: BatchLimits,
    ) -> Progress<W> {
        let residual = self.map.evaluate(ncp, z);
        let mut progress = Progress {
            residual,
            iterations: Lanes::ZERO,
            running: residual.gt(Lanes::splat(settings.tolerance)),
        };
        for _ in 0..limits.iterations {
            if progress.running.count() < limits.lanes {
                break;
            }
            self.iterate(ncp, z, settings, &mut progress);
        }
        progress
    }

    /// One iteration of the running lanes; `z` is the point at which the map was last evaluated.
    ///
    /// Finished lanes keep their result while others go on, so a lane's bits do not depend on its
    /// neighbours.
    #[inline(always)]
    pub fn iterate(
        &mut self,
        ncp: &Ncp<W>,
        z: &mut Unknowns<W>,
        settings: NewtonSettings,
        progress: &mut Progress<W>,
    ) {
        let Progress {
            residual,
            iterations,
            running,
        } = progress;
        let stiffness = stiffness(*iterations);
        self.linearised
            .linearise_natural_map(ncp, z, &self.map, settings.slip_weight, stiffness);
        self.linearised.step(ncp, z, *running);
        *residual = running.select(self.map.evaluate(ncp, z), *residual);
        *iterations += running.zero_unless(Lanes::splat(1.0));
        *running = *running
            & residual.gt(Lanes::splat(settings.tolerance))
            & iterations.lt(Lanes::splat(f64::from(settings.iterations)));
    }

    /// Copies the map of one lane of `ncp` into lane `slot` of `to`, whose problems have `contacts`
    /// contacts.
    #[inline(always)]
    pub fn pack_lane<const V: usize>(
        &self,
        ncp: &Ncp<W>,
        lane: usize,
        to: &mut Newton<V>,
        contacts: usize,
        slot: usize,
    ) {
        self.map.pack_lane(ncp, lane, &mut to.map, contacts, slot);
    }
}

/// Penalty stiffness of the next iteration of lanes that have taken `iterations`.
#[inline(always)]
fn stiffness<const W: usize>(iterations: Lanes<W>) -> Lanes<W> {
    let period = (iterations + 0.5) * (0.5 / ALTERNATION);
    let soft = (period - (period - 0.5).round()).gt(Lanes::splat(0.5));
    soft.select(Lanes::splat(SOFT), Lanes::splat(STIFF))
}

impl<const W: usize> Linearised<W> {
    /// Linearises at `z`, where the natural map is `map`, in the modes that the map chooses.
    #[inline(always)]
    fn linearise_natural_map(
        &mut self,
        ncp: &Ncp<W>,
        z: &Unknowns<W>,
        map: &NaturalMap<W>,
        slip_weight: f64,
        stiffness: Lanes<W>,
    ) {
        self.imbalance = map.imbalance;
        for k in 0..3 {
            let (bound, p, slip) = (ncp.feet[k].bound, &z.feet[k], &map.slips[k]);
            let predictor = StickPredictor::new(p, slip, slip_weight);
            let slides = predictor.exceeds(bound);
            self.feet[k] = FootStep::in_mode(bound, p, slip, &predictor, slides, stiffness);
        }
        self.contacts.clear();
        let penalty = Penalty::new(stiffness, ncp.compliance);
        let points = map.contacts.iter().zip(z.contacts());
        for (i, (row, (velocity, (p_n, p_t)))) in ncp.contacts.iter().zip(points).enumerate() {
            let p = [*p_n, *p_t];
            if let Some(mode) = ContactMode::by_natural_map(row, p, velocity) {
                let step = ContactStep::in_mode(p, velocity, mode, &penalty);
                self.contacts.push((i, step));
            }
        }
        self.stall = StallStep::in_mode(z.pusher_yield.gt(map.slack), map.slack, z.pusher_yield);
    }
}
