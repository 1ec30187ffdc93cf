//! Newton's method with the modes of a guess held fixed: [`polish`].
//!
//! A smoothed solution shows every contact's and foot's mode plainly (an impulse well inside its
//! bound sticks, one on it slides), also at speeds so small that the natural map of the fast
//! solver, which weighs impulses against speeds, cannot tell.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::rows::{ContactRow, Ncp, ROOM, Triple};
use crate::ncp::unknowns::Impulses;
use crate::solver::linearised::{ContactStep, FootStep, Linearised, StallStep};
use crate::solver::newton::{self, Hold, Holding, Mode};

/// Stiffness of held rows, in units of the object's mass per step: softer than the fast solver's,
/// since a guess may hold rows that contradict each other, and the impulses grow with it.
const STIFFNESS: f64 = 1.0e6;

/// Relative change of the velocity at which the iteration ends.
const CONVERGED: f64 = 1e-14;

/// Newton's method in fixed modes, with its working memory.
#[derive(Clone, Debug)]
pub struct Polish<const W: usize> {
    linearised: Linearised<W>,
    modes: Vec<Mode<W>>,
}

impl<const W: usize> Default for Polish<W> {
    fn default() -> Self {
        Self {
            linearised: Linearised::default(),
            modes: Vec::with_capacity(ROOM),
        }
    }
}

impl<const W: usize> Polish<W> {
    /// At most `limit` Newton steps from `p`, in its own modes, in the lanes of `open`.
    ///
    /// An impulse above the share `sliding` of its bound counts as sliding.
    #[inline(always)]
    pub fn polish(
        &mut self,
        ncp: &Ncp<W>,
        p: &mut Impulses<W>,
        mut open: Mask<W>,
        sliding: f64,
        limit: u32,
    ) {
        self.modes.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            let gamma = row.gap_velocity(&p.v, p.pusher_yield) + ncp.compliance * *p_n;
            self.modes
                .push(contact_mode(row, [*p_n, *p_t], gamma, sliding));
        }
        let mut slides = [open; 3];
        for k in 0..3 {
            slides[k] = length(&p.feet[k]).gt(ncp.feet[k].bound * sliding);
        }
        let yields = ncp.stall.lt(Lanes::splat(f64::INFINITY))
            & p.pusher_yield.gt(ncp.stall - ncp.resistance(p));
        for _ in 0..limit {
            let before = (p.v, p.pusher_yield);
            self.linearise(ncp, p, &slides, yields);
            self.linearised.step(ncp, p, open);
            open = open & moved(p, &before);
            if !open.any() {
                break;
            }
        }
    }

    #[inline(always)]
    fn linearise(&mut self, ncp: &Ncp<W>, p: &Impulses<W>, slides: &[Mask<W>; 3], yields: Mask<W>) {
        self.linearised.imbalance = ncp.imbalance(p);
        let contacts = &mut self.linearised.contacts;
        contacts.clear();
        let hold = Hold::new(Lanes::splat(STIFFNESS), ncp.compliance);
        let points = p.normal.iter().zip(&p.tangential);
        for (i, ((row, mode), (p_n, p_t))) in
            ncp.contacts.iter().zip(&self.modes).zip(points).enumerate()
        {
            let gamma = row.gap_velocity(&p.v, p.pusher_yield) + ncp.compliance * *p_n;
            let slip = row.slip_velocity(&p.v, p.pusher_yield);
            contacts.push((
                i,
                ContactStep::in_mode([*p_n, *p_t], [gamma, slip], *mode, &hold),
            ));
        }
        for k in 0..3 {
            let slip = ncp.feet[k].slip(&p.v);
            let holding = Holding::new(&p.feet[k], &slip, newton::NEAR);
            self.linearised.feet[k] = FootStep::in_mode(
                ncp.feet[k].bound,
                &p.feet[k],
                &slip,
                &holding,
                slides[k],
                Lanes::splat(STIFFNESS),
            );
        }
        self.linearised.stall =
            StallStep::decided(yields, ncp.stall - ncp.resistance(p), p.pusher_yield);
    }
}

/// Where the last step changed the velocity by more than rounding.
#[inline(always)]
fn moved<const W: usize>(p: &Impulses<W>, before: &(Triple<W>, Lanes<W>)) -> Mask<W> {
    let mut change = (p.pusher_yield - before.1).abs();
    let mut speed = p.pusher_yield.abs();
    for (now, was) in p.v.iter().zip(&before.0) {
        change = change.max((*now - *was).abs());
        speed = speed.max(now.abs());
    }
    change.gt(speed * CONVERGED)
}

#[inline(always)]
fn length<const W: usize>(p: &[Lanes<W>; 2]) -> Lanes<W> {
    (p[0] * p[0] + p[1] * p[1]).sqrt()
}

#[inline(always)]
fn contact_mode<const W: usize>(
    row: &ContactRow<W>,
    p: [Lanes<W>; 2],
    gamma: Lanes<W>,
    sliding: f64,
) -> Mode<W> {
    Mode {
        closed: p[0].gt(gamma),
        sliding: p[1].abs().gt(row.mu * p[0] * sliding),
        ratio: p[1].sign() * row.mu,
    }
}
