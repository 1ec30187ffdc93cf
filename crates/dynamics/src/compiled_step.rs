//! Compilation of the step, once per number of lanes: [`CompiledStep`].

use stickslip_lanes::{on_fused, on_vectors};

use crate::particles::Particles;
use crate::prepared_scene::Pushers;
use crate::step::Dynamics;
use crate::step_work::StepWork;

/// Numbers of particles side by side for which the step is compiled: 1, 2 and 8.
///
/// It is compiled in this crate and only here, so that no crate that calls it compiles it again.
pub trait CompiledStep<const W: usize> {
    /// Advances chunks of particles by `h` seconds.
    #[doc(hidden)]
    fn step(
        &mut self,
        dynamics: &Dynamics,
        h: f64,
        pushers: &Pushers<'_, W>,
        particles: &mut [Particles<W>],
    );
}

/// One particle, the scalar reference.
impl CompiledStep<1> for StepWork<1> {
    fn step(
        &mut self,
        dynamics: &Dynamics,
        h: f64,
        pushers: &Pushers<'_, 1>,
        particles: &mut [Particles<1>],
    ) {
        on_fused(
            dynamics.level,
            #[inline(always)]
            || dynamics.step_lanes(h, pushers, particles, self),
        );
    }
}

/// Two, to show that lanes do not mix; compiled where it is used.
impl CompiledStep<2> for StepWork<2> {
    #[inline]
    fn step(
        &mut self,
        dynamics: &Dynamics,
        h: f64,
        pushers: &Pushers<'_, 2>,
        particles: &mut [Particles<2>],
    ) {
        dynamics.step_lanes(h, pushers, particles, self);
    }
}

/// Eight, on the widest vector instructions; one after the other where none are wide enough.
impl CompiledStep<8> for StepWork<8> {
    fn step(
        &mut self,
        dynamics: &Dynamics,
        h: f64,
        pushers: &Pushers<'_, 8>,
        particles: &mut [Particles<8>],
    ) {
        let stepped = on_vectors(
            dynamics.level,
            #[inline(always)]
            || dynamics.step_lanes(h, pushers, particles, self),
        );
        if stepped.is_none() {
            self.step_by_lane(dynamics, h, pushers, particles);
        }
    }
}
