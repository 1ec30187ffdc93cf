//! One time step Γ, and Γ' with noise (docs/method.md (11); paper eq. 3 and 6), for a block of
//! particles side by side: [`Dynamics::step_block`].
//!
//! Gaps are taken at the poses at the start of the step; the mixed NCP gives the twist at its end;
//! q⁺ = q + h v⁺.

use std::ops::Range;

use stickslip_lanes::{Lanes, Level, Mask};

use crate::assembly::Assembly;
use crate::block_problems::BlockProblems;
use crate::compiled_step::CompiledStep;
use crate::friction::Friction;
use crate::geometry::narrow_phase::NarrowPhase;
use crate::input::{Body, Offsets, PusherMotion, StepInput};
use crate::kept_lanes::KeptLanes;
use crate::ncp::problem::{StepProblem, StepSolution};
use crate::ncp::report::{Outcome, Report};
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::particles::{Particle, Particles};
use crate::prepared_scene::{PreparedScene, PusherContext, Pushers, SharedPusher, StepContext};
use crate::scene::Scene;
use crate::se2::{Twist, Wrench};
use crate::solver::chain::Solver;

/// Added to the distance that bodies can close within one step when contacts are sought (m).
const MARGIN: f64 = 5e-4;

/// Search distance at which widening ends (m): nothing real moves so far in one step.
const WIDEST: f64 = 1e3;

/// Γ for one scene.
#[derive(Clone, Debug)]
pub struct Dynamics {
    scene: PreparedScene,
    /// Radius of the object's bounding circle about its centre of mass (m).
    object_radius: f64,
    pub(crate) level: Level,
}

/// Working memory of [`Dynamics::step_block`], `W` particles to a chunk; nothing is allocated once
/// it has grown.
#[derive(Clone, Debug, Default)]
pub struct StepWork<const W: usize> {
    narrow: NarrowPhase<W>,
    chunks: Vec<Assembly<W>>,
    ncps: Vec<Ncp<W>>,
    unknowns: Vec<Unknowns<W>>,
    pub(crate) reports: Vec<[Report; W]>,
    solver: Solver<W>,
    kept: KeptLanes<W>,
    /// Of steps in which every particle has its own.
    pushers: Vec<Option<PusherContext<W>>>,
    /// Of the particles one by one, where they are stepped so; else empty.
    pub(crate) by_lane: Vec<StepWork<1>>,
}

impl<const W: usize> StepWork<W> {
    /// How the last step of each particle ended, chunk by chunk.
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

    /// Smallest gap (m) between the object and a body at the end of the last step, as its contacts
    /// tell it, by lane of a chunk; infinite where none was near.
    #[inline(always)]
    pub fn gaps(&self, chunk: usize, body: Body) -> Lanes<W> {
        if self.by_lane.is_empty() {
            self.chunks[chunk].gaps(&self.ncps[chunk], &self.unknowns[chunk], body)
        } else {
            self.asked_by_lane(chunk, |work| work.gaps(0, body))
        }
    }

    /// Slip velocity (m/s) of the object on a body in the last step, by lane of a chunk, positive where
    /// the object's surface moves to the left of the contact normal, which points into the object: the
    /// mean of its contacts, each by what it presses; where none presses, that of the nearest one, and 0
    /// where there is none.
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
        match self.by_lane.get(particle) {
            Some(work) => work.bodies(0),
            None => self.chunks[particle / W].bodies(particle % W),
        }
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

    fn resize(&mut self, chunks: usize) {
        self.chunks
            .resize_with(chunks.max(self.chunks.len()), Assembly::default);
        self.ncps
            .resize_with(chunks.max(self.ncps.len()), Ncp::default);
        self.unknowns
            .resize_with(chunks.max(self.unknowns.len()), Unknowns::default);
        self.reports.resize(chunks, [Report::UNSOLVED; W]);
    }
}

impl Dynamics {
    /// The dynamics of one scene, on the widest vector instructions that the machine has.
    pub fn new(scene: Scene) -> Self {
        Self {
            object_radius: scene.object.shape.bounding_radius(),
            scene: PreparedScene::new(scene),
            level: Level::new(),
        }
    }

    /// The same on other vector instructions; no result depends on them.
    pub fn with_level(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene.scene
    }

    /// Advances `W` particles by one step; `friction` holds each one's parameters.
    pub fn step<const W: usize>(
        &self,
        input: &StepInput,
        friction: &[Friction; W],
        particles: &mut [Particle; W],
        work: &mut StepWork<W>,
    ) -> [Report; W]
    where
        StepWork<W>: CompiledStep<W>,
    {
        let mut chunk = Particles::default();
        for (lane, (particle, friction)) in particles.iter().zip(friction).enumerate() {
            chunk.set(lane, particle, friction);
        }
        self.step_block(input, std::slice::from_mut(&mut chunk), work);
        for (lane, particle) in particles.iter_mut().enumerate() {
            *particle = chunk.get(lane);
        }
        work.reports[0]
    }

    /// Advances a block of particles by one step; how each ended is in `work`.
    ///
    /// Every contact that could act takes part: where the solved twist could have closed a larger
    /// gap than was looked for, the step is solved again with a wider search. A particle's result
    /// depends on nothing but the particle and the input.
    pub fn step_block<const W: usize>(
        &self,
        input: &StepInput,
        particles: &mut [Particles<W>],
        work: &mut StepWork<W>,
    ) where
        StepWork<W>: CompiledStep<W>,
    {
        let pusher = SharedPusher::new(&self.scene, input.pusher.as_ref());
        work.step(self, input.h, &Pushers::Shared(pusher), particles);
    }

    /// The same for particles of which each has a pusher of its own: `pushers` holds those of a
    /// chunk side by side, `None` off the plane; `h` is the step (s).
    ///
    /// A particle's result is that of [`step_block`](Self::step_block) with its pusher, bit for bit.
    ///
    /// # Panics
    /// If there are not as many chunks of pushers as of particles.
    pub fn step_block_each<const W: usize>(
        &self,
        h: f64,
        pushers: &[[Option<PusherMotion>; W]],
        particles: &mut [Particles<W>],
        work: &mut StepWork<W>,
    ) where
        StepWork<W>: CompiledStep<W>,
    {
        assert_eq!(
            pushers.len(),
            particles.len(),
            "as many chunks of pushers as of particles"
        );
        let mut contexts = std::mem::take(&mut work.pushers);
        contexts.clear();
        contexts.extend(pushers.iter().map(|pushers| self.scene.pushers(pushers)));
        work.step(self, h, &Pushers::Each(&contexts), particles);
        work.pushers = contexts;
    }

    /// The same for particles whose pusher and fixels stand beside the given poses, and whose object
    /// is larger than its shape, each by its own `offsets`.
    ///
    /// # Panics
    /// If there is not one offset of the pusher and one growth for each chunk of particles, and one
    /// offset of each fixel.
    pub fn step_block_offset<const W: usize>(
        &self,
        input: &StepInput,
        offsets: Offsets<'_, W>,
        particles: &mut [Particles<W>],
        work: &mut StepWork<W>,
    ) where
        StepWork<W>: CompiledStep<W>,
    {
        let (chunks, fixels) = (particles.len(), self.scene.fixels.len());
        assert_eq!(offsets.pusher.len(), chunks, "an offset for each chunk");
        assert_eq!(offsets.fixels.len(), chunks * fixels, "and for each fixel");
        assert_eq!(offsets.growth.len(), chunks, "a growth for each chunk");
        let pushers = Pushers::Offset {
            pusher: SharedPusher::new(&self.scene, input.pusher.as_ref()),
            offsets,
            fixels,
        };
        work.step(self, input.h, &pushers, particles);
    }

    #[inline(always)]
    pub(crate) fn step_lanes<const W: usize>(
        &self,
        h: f64,
        pushers: &Pushers<'_, W>,
        particles: &mut [Particles<W>],
        work: &mut StepWork<W>,
    ) {
        // how far apart contacts are looked for
        work.by_lane.clear();
        work.resize(particles.len());
        for (chunk, particles) in particles.iter().enumerate() {
            work.chunks[chunk].set_search_distance(self.search_distance(
                h,
                pushers.of(chunk).as_ref(),
                particles,
            ));
        }

        // solve all chunks, then again the lanes that moved farther than was looked for
        let mut asked = (0..particles.len(), Mask::splat(true));
        while !asked.0.is_empty() {
            self.solve(h, pushers, particles, &asked, work);
            asked = self.too_narrow(h, pushers, asked.0.start, work);
            let chunk = asked.0.start;
            if chunk < particles.len() {
                work.kept.keep(
                    &work.ncps[chunk],
                    &work.unknowns[chunk],
                    &work.reports[chunk],
                );
            }
        }

        // q⁺ = q + h v⁺, and what the particles remember
        for (chunk, particles) in particles.iter_mut().enumerate() {
            self.integrate(h, particles, chunk, work);
        }
    }

    /// Solves the problems of some chunks, in lanes that are asked for; the others keep their answers.
    #[inline(always)]
    fn solve<const W: usize>(
        &self,
        h: f64,
        pushers: &Pushers<'_, W>,
        particles: &[Particles<W>],
        (asked, lanes): &(Range<usize>, Mask<W>),
        work: &mut StepWork<W>,
    ) {
        let StepWork {
            narrow,
            chunks,
            ncps,
            unknowns,
            reports,
            solver,
            kept,
            ..
        } = work;
        let mut problems = BlockProblems {
            scene: &self.scene,
            context: StepContext::new(h),
            pushers,
            first: asked.start,
            asked: *lanes,
            particles: &particles[asked.clone()],
            chunks: &mut chunks[asked.clone()],
            narrow,
        };
        solver.solve(
            &mut problems,
            &mut ncps[asked.clone()],
            &mut unknowns[asked.clone()],
            &mut reports[asked.clone()],
        );
        if !lanes.all() {
            let chunk = asked.start;
            kept.restore(
                !*lanes,
                &ncps[chunk],
                &mut unknowns[chunk],
                &mut reports[chunk],
            );
        }
    }

    /// The first chunk from `first` on in which some lanes' solutions move farther than their search
    /// covered, and these lanes, to be solved again with a wider one.
    #[inline(always)]
    fn too_narrow<const W: usize>(
        &self,
        h: f64,
        pushers: &Pushers<'_, W>,
        first: usize,
        work: &mut StepWork<W>,
    ) -> (Range<usize>, Mask<W>) {
        let count = work.reports.len();
        for chunk in first..count {
            let searched = work.chunks[chunk].search_distance();
            let object = self.point_speed(&work.twist(chunk, self.scene.inv_rho));
            let needed = (object + pusher_speed(pushers.of(chunk).as_ref())) * h;
            let wider = needed.gt(searched)
                & needed.lt(Lanes::splat(f64::INFINITY))
                & searched.lt(Lanes::splat(WIDEST));
            if wider.any() {
                work.chunks[chunk].set_search_distance(wider.select(needed * 2.0, searched));
                return (chunk..chunk + 1, wider);
            }
        }
        (count..count, Mask::splat(true))
    }

    #[inline(always)]
    fn integrate<const W: usize>(
        &self,
        h: f64,
        particles: &mut Particles<W>,
        chunk: usize,
        work: &StepWork<W>,
    ) {
        particles.twist = work.twist(chunk, self.scene.inv_rho);
        particles.pose = particles.pose.advance(particles.twist, h);
        let mut solved = Mask::splat(true);
        for (lane, report) in work.reports[chunk].iter().enumerate() {
            solved.set(lane, report.outcome == Outcome::Solved);
        }
        work.chunks[chunk].store_warm_start(&work.unknowns[chunk], solved, particles);
    }

    /// No point of the object is faster.
    #[inline(always)]
    fn point_speed<const W: usize>(&self, Twist { vx, vy, omega }: &Twist<Lanes<W>>) -> Lanes<W> {
        length_at_most(vx, vy) + omega.abs() * self.object_radius
    }

    /// Gap below which contacts of a chunk are looked for (m): what object and pusher can close
    /// within the step, with room for the velocity that the contacts add.
    #[inline(always)]
    fn search_distance<const W: usize>(
        &self,
        h: f64,
        pusher: Option<&PusherContext<W>>,
        particles: &Particles<W>,
    ) -> Lanes<W> {
        let Wrench { fx, fy, torque } = &particles.applied;
        let kick = length_at_most(fx, fy) * self.scene.inv_mass
            + torque.abs() * (self.scene.inv_inertia * self.object_radius);
        let pusher = pusher_speed(pusher);
        let object = (self.point_speed(&particles.twist) + kick).max(pusher);
        (object * 1.5 + pusher) * h + MARGIN
    }
}

/// Speed of the fastest point of each pusher of a chunk (m/s); 0 off the plane.
#[inline(always)]
fn pusher_speed<const W: usize>(pusher: Option<&PusherContext<W>>) -> Lanes<W> {
    match pusher {
        Some(pusher) => pusher.speed,
        None => Lanes::ZERO,
    }
}

/// No less than √(x² + y²), and no more than a twelfth above it; nothing waits for the divider.
#[inline(always)]
fn length_at_most<const W: usize>(x: &Lanes<W>, y: &Lanes<W>) -> Lanes<W> {
    // √2 − 1, rounded up: the bound is exact where one is zero and where both are equal
    const SHORTER: f64 = 0.414_213_562_373_096;
    let (x, y) = (x.abs(), y.abs());
    x.max(y) + x.min(y) * SHORTER
}

impl<const W: usize> StepWork<W> {
    /// Solved twists of one chunk.
    #[inline(always)]
    fn twist(&self, chunk: usize, inv_rho: f64) -> Twist<Lanes<W>> {
        let [vx, vy, scaled] = self.unknowns[chunk].v;
        Twist {
            vx,
            vy,
            omega: scaled * inv_rho,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_at_most_is_a_bound_and_a_close_one() {
        for i in 0..1000 {
            let (sin, cos) = libm::sincos(0.01 * f64::from(i));
            let length = 1e-3 * f64::from(i + 1);
            let bound = length_at_most(&Lanes([length * cos]), &Lanes([length * sin])).0[0];
            assert!(
                bound >= length * (1.0 - 1e-15) && bound <= length * 13.0 / 12.0,
                "{bound} of {length}, direction {i}"
            );
        }
    }
}
