//! The unknowns of the mixed NCP, `W` particles side by side: [`Impulses`].

use stickslip_lanes::{Lanes, copy_lane};

use crate::ncp::problem::{StepProblem, StepSolution};
use crate::ncp::rows::{Ncp, ROOM, Triple};
use crate::se2::Twist;

/// Unknowns of an [`Ncp`], all in m/s.
#[derive(Clone, Debug)]
pub struct Impulses<const W: usize> {
    /// Velocity v⁺.
    pub v: Triple<W>,
    /// p_n / m per contact.
    pub normal: Vec<Lanes<W>>,
    /// p_t / m per contact.
    pub tangential: Vec<Lanes<W>>,
    /// p_k / m per foot.
    pub feet: [[Lanes<W>; 2]; 3],
    /// Speed y by which the pusher gives way.
    pub pusher_yield: Lanes<W>,
}

impl<const W: usize> Impulses<W> {
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

    /// Makes room for `contacts` contacts; new entries are zero.
    pub fn resize(&mut self, contacts: usize) {
        self.normal.resize(contacts, Lanes::ZERO);
        self.tangential.resize(contacts, Lanes::ZERO);
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
        self.zip(from, |to, from| from + share * (to - from));
    }

    /// Replaces every number by a function of it and of its like in `other`.
    #[inline(always)]
    fn zip(&mut self, other: &Self, f: impl Fn(Lanes<W>, Lanes<W>) -> Lanes<W>) {
        let pairs = self.v.iter_mut().zip(&other.v);
        let feet = self
            .feet
            .as_flattened_mut()
            .iter_mut()
            .zip(other.feet.as_flattened());
        let normal = self.normal.iter_mut().zip(&other.normal);
        let tangential = self.tangential.iter_mut().zip(&other.tangential);
        for (to, from) in pairs.chain(feet).chain(normal).chain(tangential) {
            *to = f(*to, *from);
        }
        self.pusher_yield = f(self.pusher_yield, other.pusher_yield);
    }

    /// Makes all numbers zero, on `contacts` contacts; memory is reused.
    pub fn clear(&mut self, contacts: usize) {
        self.normal.clear();
        self.tangential.clear();
        self.resize(contacts);
        (self.v, self.feet, self.pusher_yield) =
            ([Lanes::ZERO; 3], [[Lanes::ZERO; 2]; 3], Lanes::ZERO);
    }

    /// The start without any impulse: the free motion.
    pub fn cold_start(&mut self, ncp: &Ncp<W>) {
        self.clear(ncp.contacts.len());
        self.v = ncp.free;
    }

    /// Copies one lane's numbers into lane `slot` of `to`, on the contacts that the lane has in
    /// `ncp`; what contacts `to` has beyond these carry nothing.
    #[inline(always)]
    pub fn pack_lane<const V: usize>(
        &self,
        ncp: &Ncp<W>,
        lane: usize,
        to: &mut Impulses<V>,
        slot: usize,
    ) {
        copy_lane(to.singles_mut(), slot, self.singles(), lane);
        let mut k = 0;
        for (row, (p_n, p_t)) in ncp
            .contacts
            .iter()
            .zip(self.normal.iter().zip(&self.tangential))
        {
            if row.is_present(lane) {
                to.normal[k].0[slot] = p_n.0[lane];
                to.tangential[k].0[slot] = p_t.0[lane];
                k += 1;
            }
        }
        for (p_n, p_t) in to.normal[k..].iter_mut().zip(&mut to.tangential[k..]) {
            (p_n.0[slot], p_t.0[slot]) = (0.0, 0.0);
        }
    }

    /// The inverse of [`Impulses::pack_lane`]; contacts that the lane does not have carry nothing.
    #[inline(always)]
    pub fn unpack_lane<const V: usize>(
        &mut self,
        ncp: &Ncp<W>,
        lane: usize,
        from: &Impulses<V>,
        slot: usize,
    ) {
        copy_lane(self.singles_mut(), lane, from.singles(), slot);
        let mut k = 0;
        for (row, (to_n, to_t)) in ncp
            .contacts
            .iter()
            .zip(self.normal.iter_mut().zip(&mut self.tangential))
        {
            let (mut p_n, mut p_t) = (0.0, 0.0);
            if row.is_present(lane) {
                (p_n, p_t) = (from.normal[k].0[slot], from.tangential[k].0[slot]);
                k += 1;
            }
            (to_n.0[lane], to_t.0[lane]) = (p_n, p_t);
        }
    }

    /// What does not belong to a contact.
    #[inline(always)]
    fn singles(&self) -> [&Lanes<W>; 10] {
        let ([x, y, turn], [[ax, ay], [bx, by], [cx, cy]]) = (&self.v, &self.feet);
        [x, y, turn, ax, ay, bx, by, cx, cy, &self.pusher_yield]
    }

    #[inline(always)]
    fn singles_mut(&mut self) -> [&mut Lanes<W>; 10] {
        let ([x, y, turn], [[ax, ay], [bx, by], [cx, cy]]) = (&mut self.v, &mut self.feet);
        [x, y, turn, ax, ay, bx, by, cx, cy, &mut self.pusher_yield]
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
