//! Newton's method with contact modes held fixed: [`FixedModeNewton`].
//!
//! A smoothed solution shows the mode of every contact and foot plainly: an impulse well inside its
//! bound sticks, one at the bound slides. It does so even at speeds so small that the natural map,
//! which weighs impulses against speeds, cannot tell.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::natural_map::ContactVelocity;
use crate::ncp::rows::{Ncp, ROOM, Triple};
use crate::ncp::unknowns::Unknowns;
use crate::solver::contact_mode::{ContactMode, Penalty};
use crate::solver::linearised::{ContactStep, FootStep, Linearised, StallStep};
use crate::solver::stick_predictor::{SLIP_WEIGHT_NEAR, StickPredictor};

/// Penalty stiffness of active rows, in units of the object's mass per step: softer than
/// [`Newton`](crate::solver::newton::Newton)'s, since guessed modes may contradict each other, and
/// the impulses grow with it.
const STIFFNESS: f64 = 1.0e6;

/// Relative change of the velocity at which the iteration ends.
const CONVERGED: f64 = 1e-14;

/// Newton's method in fixed modes, with its working memory.
#[derive(Clone, Debug)]
pub struct FixedModeNewton<const W: usize> {
    linearised: Linearised<W>,
    contacts: Vec<ContactMode<W>>,
}

impl<const W: usize> Default for FixedModeNewton<W> {
    fn default() -> Self {
        Self {
            linearised: Linearised::default(),
            contacts: Vec::with_capacity(ROOM),
        }
    }
}

impl<const W: usize> FixedModeNewton<W> {
    /// At most `limit` Newton steps from `z`, in the modes that `z` itself shows, in the lanes of
    /// `running`; returns how many it took.
    ///
    /// An impulse above the share `sliding` of its bound counts as sliding.
    #[inline(always)]
    pub fn solve(
        &mut self,
        ncp: &Ncp<W>,
        z: &mut Unknowns<W>,
        mut running: Mask<W>,
        sliding: f64,
        limit: u32,
    ) -> u32 {
        // read the modes
        self.contacts.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(z.contacts()) {
            let gap = row.gap_velocity(&z.v, z.pusher_yield) + ncp.compliance * *p_n;
            let mode = ContactMode::by_impulses(row, [*p_n, *p_t], gap, sliding);
            self.contacts.push(mode);
        }
        let mut slides = [running; 3];
        for k in 0..3 {
            slides[k] = length(&z.feet[k]).gt(ncp.feet[k].bound * sliding);
        }
        let yields = ncp.stall.lt(Lanes::splat(f64::INFINITY))
            & z.pusher_yield.gt(ncp.stall - ncp.resistance(z));
        // iterate
        for step in 0..limit {
            let before = (z.v, z.pusher_yield);
            self.linearise(ncp, z, &slides, yields);
            self.linearised.step(ncp, z, running);
            running = running & moved(z, &before);
            if !running.any() {
                return step + 1;
            }
        }
        limit
    }

    #[inline(always)]
    fn linearise(&mut self, ncp: &Ncp<W>, z: &Unknowns<W>, slides: &[Mask<W>; 3], yields: Mask<W>) {
        let stiffness = Lanes::splat(STIFFNESS);
        self.linearised.imbalance = ncp.imbalance(z);
        self.linearised.contacts.clear();
        let penalty = Penalty::new(stiffness, ncp.compliance);
        let points = self.contacts.iter().zip(z.contacts());
        for (i, (row, (mode, (p_n, p_t)))) in ncp.contacts.iter().zip(points).enumerate() {
            let velocity = ContactVelocity {
                gap: row.gap_velocity(&z.v, z.pusher_yield) + ncp.compliance * *p_n,
                slip: row.slip_velocity(&z.v, z.pusher_yield),
            };
            let step = ContactStep::in_mode([*p_n, *p_t], &velocity, *mode, &penalty);
            self.linearised.contacts.push((i, step));
        }
        for k in 0..3 {
            let (bound, p, slip) = (ncp.feet[k].bound, &z.feet[k], ncp.feet[k].slip(&z.v));
            let predictor = StickPredictor::new(p, &slip, SLIP_WEIGHT_NEAR);
            self.linearised.feet[k] =
                FootStep::in_mode(bound, p, &slip, &predictor, slides[k], stiffness);
        }
        self.linearised.stall =
            StallStep::in_mode(yields, ncp.stall - ncp.resistance(z), z.pusher_yield);
    }
}

/// Lanes in which the last step changed the velocity by more than rounding.
#[inline(always)]
fn moved<const W: usize>(z: &Unknowns<W>, before: &(Triple<W>, Lanes<W>)) -> Mask<W> {
    let mut change = (z.pusher_yield - before.1).abs();
    let mut speed = z.pusher_yield.abs();
    for (now, was) in z.v.iter().zip(&before.0) {
        change = change.max((*now - *was).abs());
        speed = speed.max(now.abs());
    }
    change.gt(speed * CONVERGED)
}

#[inline(always)]
fn length<const W: usize>(p: &[Lanes<W>; 2]) -> Lanes<W> {
    (p[0] * p[0] + p[1] * p[1]).sqrt()
}
