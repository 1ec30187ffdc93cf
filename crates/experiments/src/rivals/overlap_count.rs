//! Particles that overlap a fixel: [`OverlapCount`].

use std::sync::atomic::{AtomicU64, Ordering};

use stickslip::dynamics::{Placed, Scene, narrow_phase};
use stickslip::{Observer, ParticleView, SolvedStep};

/// Overlap from which on it counts (m).
pub(super) const OVERLAPPING: f64 = 1e-4;

/// An observer that counts the particles which overlap a fixel by more than 0.1 mm, over all rows.
#[derive(Debug)]
pub struct OverlapCount<'a> {
    scene: &'a Scene,
    overlapping: AtomicU64,
    all: AtomicU64,
}

impl<'a> OverlapCount<'a> {
    /// A count of no particles yet.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            overlapping: AtomicU64::new(0),
            all: AtomicU64::new(0),
        }
    }

    /// Share of the particles that overlap a fixel.
    #[must_use]
    pub fn share(&self) -> f64 {
        let count = |of: &AtomicU64| of.load(Ordering::Relaxed) as f64;
        count(&self.overlapping) / count(&self.all)
    }
}

impl Observer for OverlapCount<'_> {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn wants_steps(&self) -> bool {
        false
    }

    fn on_row(&self, _: usize, particles: &ParticleView<'_>) {
        let mut gaps = Vec::new();
        for i in 0..particles.len() {
            let object = Placed::new(&self.scene.object.shape, particles.pose(i));
            gaps.clear();
            for fixel in &self.scene.fixels {
                let fixel = Placed::new(&fixel.shape, fixel.pose);
                narrow_phase(&object, &fixel, OVERLAPPING, &mut gaps);
            }
            let overlaps = u64::from(gaps.iter().any(|gap| gap.gap < -OVERLAPPING));
            self.overlapping.fetch_add(overlaps, Ordering::Relaxed);
        }
        let count = particles.len() as u64;
        self.all.fetch_add(count, Ordering::Relaxed);
    }
}
