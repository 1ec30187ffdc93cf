//! The step lane by lane, where no vector instructions are wide enough: [`StepWork::step_by_lane`].

use stickslip_lanes::Lanes;

use crate::compiled_step::CompiledStep;
use crate::input::Offsets;
use crate::ncp::report::Report;
use crate::particles::Particles;
use crate::prepared_scene::Pushers;
use crate::step::Dynamics;
use crate::step_work::StepWork;

impl<const W: usize> StepWork<W> {
    /// Advances chunks of particles by `h` seconds, one particle after the other, each as the step
    /// of one would; results of the step come from `by_lane`.
    pub(crate) fn step_by_lane(
        &mut self,
        dynamics: &Dynamics,
        h: f64,
        pushers: &Pushers<'_, W>,
        particles: &mut [Particles<W>],
    ) {
        let count = particles.len() * W;
        self.by_lane.resize_with(count, StepWork::default);
        self.reports.resize(particles.len(), [Report::UNSOLVED; W]);
        for (i, work) in self.by_lane.iter_mut().enumerate() {
            let (chunk, lane) = (i / W, i % W);
            let mut alone = [particles[chunk].lane(lane)];
            pushers.with_lane(chunk, lane, |pushers| {
                work.step(dynamics, h, pushers, &mut alone);
            });
            let [alone] = &alone;
            particles[chunk].set(lane, &alone.get(0), &alone.friction.map(|x| x.0[0]));
            self.reports[chunk][lane] = work.reports[0][0];
        }
    }

    /// Answers of the steps of one chunk's lanes, side by side.
    pub(crate) fn asked_by_lane(
        &self,
        chunk: usize,
        ask: impl Fn(&StepWork<1>) -> Lanes<1>,
    ) -> Lanes<W> {
        let works = &self.by_lane[chunk * W..][..W];
        let mut all = Lanes::ZERO;
        for (to, work) in all.0.iter_mut().zip(works) {
            *to = ask(work).0[0];
        }
        all
    }
}

impl<const W: usize> Particles<W> {
    /// One of them, alone.
    fn lane(&self, lane: usize) -> Particles<1> {
        let mut alone = Particles::default();
        alone.set(0, &self.get(lane), &self.friction.map(|x| x.0[lane]));
        alone
    }
}

impl<const W: usize> Pushers<'_, W> {
    /// Hands over the bodies that one lane of one chunk meets.
    fn with_lane(&self, chunk: usize, lane: usize, then: impl FnOnce(&Pushers<'_, 1>)) {
        let alone = |[x, y]: &[Lanes<W>; 2]| [Lanes([x.0[lane]]), Lanes([y.0[lane]])];
        match self {
            Self::Shared(pusher) => then(&Pushers::Shared(*pusher)),
            Self::Each { contexts, fingers } => {
                let alone = contexts[chunk * fingers..][..*fingers].iter();
                let alone: Vec<_> = alone
                    .map(|finger| finger.as_ref().map(|finger| finger.lane(lane)))
                    .collect();
                then(&Pushers::Each {
                    contexts: &alone,
                    fingers: *fingers,
                });
            }
            Self::Offset {
                pusher,
                offsets,
                fingers,
                fixels,
            } => {
                let driven = offsets.pusher[chunk * fingers..][..*fingers].iter();
                let driven: Vec<_> = driven.map(alone).collect();
                let beside: Vec<_> = self.fixel_offsets(chunk).iter().map(alone).collect();
                let feet = self.support(chunk).into_iter();
                let feet: Vec<_> = feet
                    .map(|support| support.map(|x| Lanes([x.0[lane]])))
                    .collect();
                let turn = offsets.pusher_turn.get(chunk);
                let turn: Vec<_> = turn.map(|turn| Lanes([turn.0[lane]])).into_iter().collect();
                let offsets = Offsets {
                    pusher: &driven,
                    pusher_turn: &turn,
                    fixels: &beside,
                    supports: &feet,
                };
                then(&Pushers::Offset {
                    pusher: *pusher,
                    offsets,
                    fingers: *fingers,
                    fixels: *fixels,
                });
            }
        }
    }
}
