//! The unknowns of the mixed NCP, `W` particles side by side: [`Unknowns`].

use std::iter::Zip;
use std::slice;

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::problem::{StepProblem, StepSolution};
use crate::ncp::rows::{Ncp, ROOM, Triple};
use crate::se2::Twist;

/// Largest normal impulse of a start, and of a solution that is left as it is (m/s). Bodies that
/// squeeze an object press on it with impulses that cancel each other and that nothing determines:
/// carried from step to step, they would grow until their rounding exceeds the certificate's
/// tolerance.
const LARGEST: f64 = 1e4;

/// Unknowns z = (v⁺, p_n, p_t, p_k, y) of an [`Ncp`], all in m/s.
#[derive(Clone, Debug)]
pub struct Unknowns<const W: usize> {
    /// Velocity v⁺.
    pub v: Triple<W>,
    /// p_n / m per contact.
    pub normal: Vec<Lanes<W>>,
    /// p_t / m per contact.
    pub tangential: Vec<Lanes<W>>,
    /// p_k / m per foot.
    pub feet: [[Lanes<W>; 2]; 3],
    /// Speed y by which the pusher yields.
    pub pusher_yield: Lanes<W>,
}

impl<const W: usize> Default for Unknowns<W> {
    fn default() -> Self {
        Self::zero(0)
    }
}

impl<const W: usize> Unknowns<W> {
    /// No impulse at all on `contacts` contacts, at rest.
    pub fn zero(contacts: usize) -> Self {
        let zeros = || {
            let mut zeros = Vec::with_capacity(contacts.max(ROOM));
            zeros.resize(contacts, Lanes::ZERO);
            zeros
        };
        Self {
            v: [Lanes::ZERO; 3],
            normal: zeros(),
            tangential: zeros(),
            feet: [[Lanes::ZERO; 2]; 3],
            pusher_yield: Lanes::ZERO,
        }
    }

    /// Makes all numbers zero, on `contacts` contacts; memory is reused.
    pub fn clear(&mut self, contacts: usize) {
        self.normal.clear();
        self.tangential.clear();
        self.resize(contacts);
        (self.v, self.feet, self.pusher_yield) =
            ([Lanes::ZERO; 3], [[Lanes::ZERO; 2]; 3], Lanes::ZERO);
    }

    /// Makes room for `contacts` contacts; new entries are zero.
    pub fn resize(&mut self, contacts: usize) {
        self.normal.resize(contacts, Lanes::ZERO);
        self.tangential.resize(contacts, Lanes::ZERO);
    }

    /// The start without any impulse: the free motion.
    pub fn cold_start(&mut self, ncp: &Ncp<W>) {
        self.clear(ncp.contacts.len());
        self.v = ncp.free;
    }

    /// (p_n, p_t) of every contact.
    #[inline(always)]
    pub fn contacts(&self) -> Zip<slice::Iter<'_, Lanes<W>>, slice::Iter<'_, Lanes<W>>> {
        self.normal.iter().zip(&self.tangential)
    }

    /// Lanes in which no normal impulse exceeds `LARGEST`.
    #[inline(always)]
    pub fn is_bounded(&self) -> Mask<W> {
        !self.largest_normal().gt(Lanes::splat(LARGEST))
    }

    /// The largest normal impulse (m/s).
    #[inline(always)]
    pub fn largest_normal(&self) -> Lanes<W> {
        let mut largest = Lanes::ZERO;
        for p_n in &self.normal {
            largest = largest.max(*p_n);
        }
        largest
    }

    /// The largest speed: of v⁺ and of the pusher's yield (m/s).
    #[inline(always)]
    pub fn fastest(&self) -> Lanes<W> {
        let mut fastest = self.pusher_yield.abs();
        for v in &self.v {
            fastest = fastest.max(v.abs());
        }
        fastest
    }

    /// Copies all lanes; memory is reused.
    pub fn copy_from(&mut self, from: &Self) {
        self.v = from.v;
        self.normal.clone_from(&from.normal);
        self.tangential.clone_from(&from.tangential);
        self.feet = from.feet;
        self.pusher_yield = from.pusher_yield;
    }

    /// from + share (to − from).
    #[inline(always)]
    pub fn blend(&mut self, from: &Self, to: &Self, share: Lanes<W>) {
        self.copy_from(to);
        for (to, from) in [
            (&mut self.v[..], &from.v[..]),
            (self.feet.as_flattened_mut(), from.feet.as_flattened()),
            (&mut self.normal, &from.normal),
            (&mut self.tangential, &from.tangential),
            (
                slice::from_mut(&mut self.pusher_yield),
                slice::from_ref(&from.pusher_yield),
            ),
        ] {
            for (to, from) in to.iter_mut().zip(from) {
                *to = *from + share * (*to - *from);
            }
        }
    }

    /// Copies one lane into lane `slot` of `to`, on the contacts that the lane has in `ncp`;
    /// contacts that `to` has beyond these get no impulse.
    #[inline(always)]
    pub fn pack_lane<const V: usize>(
        &self,
        ncp: &Ncp<W>,
        lane: usize,
        to: &mut Unknowns<V>,
        slot: usize,
    ) {
        self.copy_body_lane(lane, to, slot);
        let mut packed = 0;
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(self.contacts()) {
            if row.is_present(lane) {
                to.normal[packed].0[slot] = p_n.0[lane];
                to.tangential[packed].0[slot] = p_t.0[lane];
                packed += 1;
            }
        }
        let beyond = to.normal[packed..]
            .iter_mut()
            .zip(&mut to.tangential[packed..]);
        for (p_n, p_t) in beyond {
            (p_n.0[slot], p_t.0[slot]) = (0.0, 0.0);
        }
    }

    /// The inverse of [`Unknowns::pack_lane`]; contacts that the lane does not have get no impulse.
    #[inline(always)]
    pub fn unpack_lane<const V: usize>(
        &mut self,
        ncp: &Ncp<W>,
        lane: usize,
        from: &Unknowns<V>,
        slot: usize,
    ) {
        from.copy_body_lane(slot, self, lane);
        let mut packed = 0;
        let contacts = self.normal.iter_mut().zip(&mut self.tangential);
        for (row, (to_n, to_t)) in ncp.contacts.iter().zip(contacts) {
            let (mut p_n, mut p_t) = (0.0, 0.0);
            if row.is_present(lane) {
                (p_n, p_t) = (from.normal[packed].0[slot], from.tangential[packed].0[slot]);
                packed += 1;
            }
            (to_n.0[lane], to_t.0[lane]) = (p_n, p_t);
        }
    }

    /// Copies the numbers that do not belong to a contact from one lane into lane `slot` of `to`.
    #[inline(always)]
    fn copy_body_lane<const V: usize>(&self, lane: usize, to: &mut Unknowns<V>, slot: usize) {
        for k in 0..3 {
            to.v[k].0[slot] = self.v[k].0[lane];
            to.feet[k][0].0[slot] = self.feet[k][0].0[lane];
            to.feet[k][1].0[slot] = self.feet[k][1].0[lane];
        }
        to.pusher_yield.0[slot] = self.pusher_yield.0[lane];
    }

    /// Makes every lane a solution in SI units of `problem`.
    pub fn assign(&mut self, solution: &StepSolution, problem: &StepProblem) {
        let (m, contacts) = (problem.mass, problem.contacts.len());
        assert!(
            solution.normal.len() == contacts && solution.tangential.len() == contacts,
            "one impulse per contact"
        );
        let rho = (problem.inertia / m).sqrt();
        let Twist { vx, vy, omega } = solution.twist;
        self.v = [vx, vy, omega * rho].map(Lanes::splat);
        self.feet = solution.feet.map(|p| p.map(|x| Lanes::splat(x / m)));
        self.pusher_yield = Lanes::splat(solution.pusher_yield);
        self.resize(contacts);
        for (to, from) in [
            (&mut self.normal, &solution.normal),
            (&mut self.tangential, &solution.tangential),
        ] {
            for (to, from) in to.iter_mut().zip(from) {
                *to = Lanes::splat(from / m);
            }
        }
    }

    /// One lane in SI units, for the problem it solves.
    pub fn to_solution(&self, lane: usize, problem: &StepProblem) -> StepSolution {
        let m = problem.mass;
        let rho = (problem.inertia / m).sqrt();
        let contacts = problem.contacts.len();
        let newton_seconds =
            |column: &[Lanes<W>]| column[..contacts].iter().map(|p| p.0[lane] * m).collect();
        StepSolution {
            twist: Twist {
                vx: self.v[0].0[lane],
                vy: self.v[1].0[lane],
                omega: self.v[2].0[lane] / rho,
            },
            normal: newton_seconds(&self.normal),
            tangential: newton_seconds(&self.tangential),
            feet: self.feet.map(|p| p.map(|x| x.0[lane] * m)),
            pusher_yield: self.pusher_yield.0[lane],
        }
    }
}
