//! Working memory of a step, and results of the last one: [`StepWork`].

use stickslip_lanes::Lanes;

use crate::assembly::Assembly;
use crate::geometry::narrow_phase::NarrowPhase;
use crate::input::Body;
use crate::kept_lanes::KeptLanes;
use crate::ncp::problem::{StepProblem, StepSolution};
use crate::ncp::report::Report;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::prepared_scene::FingerContext;
use crate::se2::Twist;
use crate::solved_contact::SolvedContact;
use crate::solver::chain::Solver;

/// Working memory of [`Dynamics::step_block`](crate::Dynamics::step_block), `W` particles to a
/// chunk; nothing is allocated once it has grown, except where particles are stepped one by one.
#[derive(Clone, Debug, Default)]
pub struct StepWork<const W: usize> {
    pub(crate) narrow: NarrowPhase<W>,
    pub(crate) chunks: Vec<Assembly<W>>,
    pub(crate) ncps: Vec<Ncp<W>>,
    pub(crate) unknowns: Vec<Unknowns<W>>,
    pub(crate) reports: Vec<[Report; W]>,
    pub(crate) solver: Solver<W>,
    pub(crate) kept: KeptLanes<W>,
    /// Fingers, of steps in which every particle has its own pusher.
    pub(crate) pushers: Vec<Option<FingerContext<W>>>,
    /// Of the particles one by one, where they are stepped so; else empty.
    pub(crate) by_lane: Vec<StepWork<1>>,
}

impl<const W: usize> StepWork<W> {
    /// Outcomes of the last step, chunk by chunk.
    pub fn reports(&self) -> &[[Report; W]] {
        &self.reports
    }

    /// Normal impulses (N s) between the object and a body in the last step, summed over their
    /// contacts, by lane of a chunk.
    #[inline(always)]
    pub fn normal_impulses(&self, chunk: usize, body: Body) -> Lanes<W> {
        if self.by_lane.is_empty() {
            self.chunks[chunk].normal_impulses(&self.unknowns[chunk], body)
        } else {
            self.asked_by_lane(chunk, |work| work.normal_impulses(0, body))
        }
    }

    /// Impulse (N s) of the table's friction on the object in the last step, by lane of a chunk: x
    /// and y in the world.
    #[inline(always)]
    pub fn support_impulses(&self, chunk: usize) -> [Lanes<W>; 2] {
        if self.by_lane.is_empty() {
            return self.chunks[chunk].support_impulses(&self.unknowns[chunk]);
        }
        [0, 1].map(|axis| self.asked_by_lane(chunk, |work| work.support_impulses(0)[axis]))
    }

    /// Smallest gap (m) between the object and a body at the end of the last step, by its contacts,
    /// by lane of a chunk; infinite where none was near.
    #[inline(always)]
    pub fn gaps(&self, chunk: usize, body: Body) -> Lanes<W> {
        if self.by_lane.is_empty() {
            self.chunks[chunk].gaps(&self.ncps[chunk], &self.unknowns[chunk], body)
        } else {
            self.asked_by_lane(chunk, |work| work.gaps(0, body))
        }
    }

    /// Slip velocity (m/s) of the object on a body in the last step, by lane of a chunk. Positive
    /// where the object's surface moves to the left of the contact normal, which points into the
    /// object.
    ///
    /// It is the mean over its contacts, each weighted by its normal impulse. Where none presses,
    /// it is that of the nearest contact, and 0 where there is no contact.
    #[inline(always)]
    pub fn slips(&self, chunk: usize, body: Body) -> Lanes<W> {
        if self.by_lane.is_empty() {
            self.chunks[chunk].slips(&self.ncps[chunk], &self.unknowns[chunk], body)
        } else {
            self.asked_by_lane(chunk, |work| work.slips(0, body))
        }
    }

    /// The body of each contact in the last step's problem of one particle.
    pub fn bodies(&self, particle: usize) -> Vec<Body> {
        let mut bodies = Vec::new();
        self.each_contact(particle, &mut |contact| bodies.push(contact.body));
        bodies
    }

    /// Visits the contacts of one particle after the last step, in the order of its problem.
    pub fn each_contact(&self, particle: usize, visit: &mut dyn FnMut(&SolvedContact)) {
        if let Some(work) = self.by_lane.get(particle) {
            return work.each_contact(0, visit);
        }
        let (chunk, lane) = (particle / W, particle % W);
        let (ncp, unknowns) = (&self.ncps[chunk], &self.unknowns[chunk]);
        self.chunks[chunk].each_contact(ncp, unknowns, lane, visit);
    }

    /// Normal impulse (N s) of one particle, counted over all chunks.
    pub fn normal_impulse(&self, particle: usize, body: Body) -> f64 {
        self.normal_impulses(particle / W, body).0[particle % W]
    }

    /// The last step's problem of one particle, in SI units; the applied impulse is part of its
    /// twist.
    pub fn problem(&self, particle: usize) -> StepProblem {
        if let Some(work) = self.by_lane.get(particle) {
            return work.problem(0);
        }
        let (chunk, lane) = (particle / W, particle % W);
        self.chunks[chunk].problem(&self.ncps[chunk], lane)
    }

    /// The last step's solution of one particle.
    pub fn solution(&self, particle: usize) -> StepSolution {
        if let Some(work) = self.by_lane.get(particle) {
            return work.solution(0);
        }
        let (chunk, lane) = (particle / W, particle % W);
        let problem = self.problem(particle);
        let mut alone = Unknowns::<1>::zero(problem.contacts.len());
        self.unknowns[chunk].pack_lane(&self.ncps[chunk], lane, &mut alone, 0);
        alone.to_solution(0, &problem)
    }

    pub(crate) fn resize(&mut self, chunks: usize) {
        self.chunks
            .resize_with(chunks.max(self.chunks.len()), Assembly::default);
        self.ncps
            .resize_with(chunks.max(self.ncps.len()), Ncp::default);
        self.unknowns
            .resize_with(chunks.max(self.unknowns.len()), Unknowns::default);
        self.reports.resize(chunks, [Report::UNSOLVED; W]);
    }

    /// Solved twists of one chunk.
    #[inline(always)]
    pub(crate) fn twist(&self, chunk: usize, inv_rho: f64) -> Twist<Lanes<W>> {
        let [vx, vy, scaled] = self.unknowns[chunk].v;
        Twist {
            vx,
            vy,
            omega: scaled * inv_rho,
        }
    }
}
