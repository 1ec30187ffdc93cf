//! One time step Γ, and Γ' with noise (docs/method.md (11); paper eq. 3 and 6), for a block of
//! particles side by side: [`Dynamics::step_block`].
//!
//! Gaps are taken at the poses at the start of the step; the mixed NCP gives the twist at its end;
//! q⁺ = q + h v⁺.

use std::ops::Range;

use stickslip_lanes::{Lanes, Level, Mask};

use crate::block_problems::BlockProblems;
use crate::compiled_step::CompiledStep;
use crate::friction::Friction;
use crate::input::{Offsets, PusherMotion, StepInput};
use crate::ncp::report::{Outcome, Report};
use crate::particles::{Particle, Particles};
use crate::prepared_scene::{PreparedScene, Pushers, SharedPusher, StepContext};
use crate::scene::Scene;
use crate::se2::{Twist, Wrench};
use crate::step_work::StepWork;

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

impl Dynamics {
    /// The dynamics of one scene, on the widest vector instructions that the machine has.
    pub fn new(scene: Scene) -> Self {
        Self {
            object_radius: scene.object.shape.bounding_radius(),
            scene: PreparedScene::new(scene),
            level: Level::new(),
        }
    }

    /// Uses other vector instructions; no result depends on them.
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

    /// Advances a block of particles by one step; the outcome of each is in `work`.
    ///
    /// Every contact that could act takes part. Where the solved twist could have closed a larger
    /// gap than was looked for, the step is solved again with a wider search. A particle's result
    /// depends on nothing but the particle and the input.
    ///
    /// # Panics
    /// If the input's pusher has not as many fingers as the scene's.
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

    /// Advances a block of particles of which each has a pusher of its own. `pushers` holds those
    /// of a chunk side by side, `None` off the plane; `h` is the step (s).
    ///
    /// A particle's result is that of [`step_block`](Self::step_block) with its pusher, bit for
    /// bit.
    ///
    /// # Panics
    /// If there are not as many chunks of pushers as of particles, or a pusher has not as many
    /// fingers as the scene's.
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
        let fingers = self.scene.scene.pusher.fingers.len();
        for pushers in pushers {
            contexts.extend((0..fingers).map(|i| self.scene.finger(pushers, i)));
        }
        let each = Pushers::Each {
            contexts: &contexts,
            fingers,
        };
        work.step(self, h, &each, particles);
        work.pushers = contexts;
    }

    /// Advances a block of particles, each with its own `offsets`. They shift pusher, fixels and
    /// feet from the given poses.
    ///
    /// # Panics
    /// If an offset of a finger or of a fixel is missing for a chunk of particles. Also if the
    /// turns of the pusher or the supports are neither none at all nor one for each
    /// chunk.
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
        let fingers = self.scene.scene.pusher.fingers.len();
        assert_eq!(
            offsets.pusher.len(),
            chunks * fingers,
            "an offset for each finger"
        );
        assert_eq!(offsets.fixels.len(), chunks * fixels, "and for each fixel");
        let turn = offsets.pusher_turn.len();
        assert!(turn == chunks || turn == 0, "a turn for each chunk");
        let feet = offsets.supports.len();
        assert!(feet == chunks || feet == 0, "feet for each chunk");
        let pushers = Pushers::Offset {
            pusher: SharedPusher::new(&self.scene, input.pusher.as_ref()),
            offsets,
            fingers,
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
        work.by_lane.clear();
        work.resize(particles.len());

        // how far apart contacts are looked for
        for (chunk, particles) in particles.iter().enumerate() {
            let pusher = self.pusher_speed(pushers, chunk);
            let distance = self.search_distance(h, pusher, particles);
            work.chunks[chunk].set_search_distance(distance);
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

    /// Solves the problems of some chunks, in lanes that are asked for; the others keep their
    /// answers.
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
            self.level,
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

    /// The first chunk from `first` on in which some lanes' solutions move farther than their
    /// search covered, and these lanes, to be solved again with a wider one.
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
            let needed = (object + self.pusher_speed(pushers, chunk)) * h;
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

    /// Speed of the fastest point of each pusher of a chunk (m/s); 0 off the plane.
    #[inline(always)]
    fn pusher_speed<const W: usize>(&self, pushers: &Pushers<'_, W>, chunk: usize) -> Lanes<W> {
        pushers.speed(chunk, self.scene.scene.pusher.fingers.len())
    }

    /// Gap below which contacts of a chunk are sought (m): the distance that object and pusher, of
    /// this speed (m/s), can close within the step, with room for the velocity that the contacts
    /// add.
    #[inline(always)]
    fn search_distance<const W: usize>(
        &self,
        h: f64,
        pusher: Lanes<W>,
        particles: &Particles<W>,
    ) -> Lanes<W> {
        let Wrench { fx, fy, torque } = &particles.applied;
        let kick = length_at_most(fx, fy) * self.scene.inv_mass
            + torque.abs() * (self.scene.inv_inertia * self.object_radius);
        let object = (self.point_speed(&particles.twist) + kick).max(pusher);
        (object * 1.5 + pusher) * h + MARGIN
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
