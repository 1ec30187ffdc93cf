//! The particles that estimate the pose and, in the robust model, those that learn friction:
//! [`LearningFilter`], docs/method.md (52).

use std::num::NonZero;

use stickslip_dynamics::{Friction, Pose};

use crate::error::RunError;
use crate::estimate::EstimateRow;
use crate::filter_model::FilterModel;
use crate::moves::Moves;
use crate::particle::contact_filter::{ContactFilter, Drive, Measured, Waiting};
use crate::particle::filter_options::FilterOptions;
use crate::particle::observation::PoseAt;
use crate::particle::view::ParticleView;
use crate::setup::{Camera, Setup};

/// Least share of a camera pose that moves particles that learn (52).
const LEAST_MOVED: f64 = 0.97;

/// Distance of the seeds of the particles that learn from those of the others.
const LEARNING_SEEDS: u64 = 1 << 48;

/// The filter of the pose, with the friction that another filter learns.
///
/// A model that serves the pose does not serve the friction. Particles learn a wrong friction from
/// pushes that are smoother than their model's, unless they allow for smooth pushes and creeping
/// contacts. But with this allowance they are overconfident about where the object goes. So there
/// are two sets of particles, each with its own model.
pub(crate) struct LearningFilter<'o> {
    poses: ContactFilter<'o>,
    learning: Learning<'o>,
    /// Friction when the particles that learn it last saw the object.
    known: Option<KnownFriction>,
    /// The latest camera pose.
    shown: Pose,
    /// Time of the latest row (s).
    time: f64,
}

/// The particles that learn friction.
enum Learning<'o> {
    /// There are none, or no more: friction is known, or no camera pose will follow.
    None,
    /// They begin at the first contact: before it there is nothing to learn.
    AtContact(Box<LearnerOptions<'o>>),
    /// They learn.
    Underway(Box<ContactFilter<'o>>),
}

/// Means and standard deviations of friction.
#[derive(Clone, Copy, Debug)]
struct KnownFriction {
    mean: Friction,
    std: Friction,
}

impl KnownFriction {
    fn of(row: &EstimateRow) -> Option<Self> {
        let mean = row.friction?;
        let std = row.spread?.friction?;
        Some(Self { mean, std })
    }
}

impl<'o> LearningFilter<'o> {
    /// Particles around `start`.
    ///
    /// # Errors
    /// Where the filter's settings are out of range.
    pub fn new(
        setup: &Setup,
        camera: Camera,
        start: PoseAt,
        options: &FilterOptions<'o>,
    ) -> Result<Self, RunError> {
        let learns = options.model == FilterModel::Robust
            && setup.uncertainty.friction != Friction::default();
        let poses = ContactFilter::new(setup, camera, start, options)?;
        Ok(Self {
            learning: match learns {
                true => Learning::AtContact(Box::new(LearnerOptions::new(setup, camera, options))),
                false => Learning::None,
            },
            known: KnownFriction::of(poses.latest()).filter(|_| learns),
            poses,
            shown: start.pose,
            time: start.time,
        })
    }

    /// Takes one row: the step that leads to it, then its measurements.
    pub fn step(&mut self, measured: Measured<'_>, drive: Drive<'_>) -> &EstimateRow {
        let measured = Measured {
            object: measured.object.filter(|pose| self.is_new(*pose)),
            ..measured
        };
        let waited = self.poses.waiting_at(self.time);
        self.time = measured.time;
        self.poses.step(measured, drive);
        if let Learning::AtContact(options) = &self.learning
            && self.poses.latest().any_contact()
        {
            let learner = options.start(waited, self.poses.count());
            self.learning = Learning::Underway(Box::new(learner));
        }
        match &mut self.learning {
            Learning::Underway(learner) => {
                let looks = self.poses.latest().moves() || learner.latest().moves();
                let object = measured.object.filter(|_| looks);
                let row = learner.step(Measured { object, ..measured }, drive);
                if row.visual {
                    self.known = KnownFriction::of(row);
                    self.poses.count_steps_of(row);
                }
            }
            // particles without contact have the prior
            Learning::AtContact(_) if self.poses.latest().visual => {
                self.known = KnownFriction::of(self.poses.latest());
            }
            Learning::AtContact(_) | Learning::None => {}
        }
        self.tell_friction();
        self.latest()
    }

    /// Takes a row that comes so soon after the latest step that no step leads to it. Its pose is
    /// weighed as one of the past.
    pub fn look(&mut self, measured: Measured<'_>) -> &EstimateRow {
        let seen = measured.object.is_some_and(|pose| {
            self.weigh(PoseAt {
                time: measured.time,
                pose,
                covariance: measured.covariance,
            })
        });
        self.poses.make_no_step(seen);
        self.latest()
    }

    /// Weighs the particles by a pose that arrives late. Those that learn are weighed only if the
    /// object has not come to rest since.
    pub fn weigh_late(&mut self, late: PoseAt) -> &EstimateRow {
        self.weigh(late);
        self.latest()
    }

    /// Weighs the particles by a pose; returns true if it is a new one.
    fn weigh(&mut self, late: PoseAt) -> bool {
        if !self.is_new(late.pose) {
            return false;
        }
        self.poses.weigh_late(late);
        if let Learning::Underway(learner) = &mut self.learning
            && (self.poses.latest().moves() || learner.latest().moves())
        {
            self.known = KnownFriction::of(learner.weigh_late(late));
        }
        self.tell_friction();
        true
    }

    /// Returns true if a camera pose is a new measurement. In the robust model, a pose that equals
    /// the one before is that frame again.
    fn is_new(&mut self, pose: Pose) -> bool {
        let before = std::mem::replace(&mut self.shown, pose);
        pose != before || self.poses.model() == FilterModel::Paper
    }

    /// Stops learning friction, because no camera pose will follow: it stays as it is known.
    pub fn learn_no_more(&mut self) {
        self.learning = Learning::None;
    }

    /// Writes the known friction into the latest row.
    fn tell_friction(&mut self) {
        if let Some(KnownFriction { mean, std }) = self.known {
            self.poses.tell_friction(mean, std);
        }
    }

    /// Goes on with another number of particles; nothing changes if it is the same.
    pub fn resize(&mut self, particles: NonZero<u32>) {
        self.poses.resize(particles);
        if let Learning::Underway(learner) = &mut self.learning {
            learner.resize(particles);
        }
    }

    /// Number of particles of the pose; as many learn friction.
    pub fn count(&self) -> NonZero<u32> {
        self.poses.count()
    }

    /// The estimate at the latest row.
    pub fn latest(&self) -> &EstimateRow {
        self.poses.latest()
    }

    /// The particles of the pose, after the latest row.
    pub fn particles(&self) -> ParticleView<'_> {
        self.poses.particles()
    }

    /// The particles with the friction of the estimate, if the latest row taught any: those that
    /// learn it, and before contact those of the pose.
    pub fn friction_particles(&self) -> Option<ParticleView<'_>> {
        let taught = match &self.learning {
            Learning::Underway(learner) => &**learner,
            Learning::AtContact(_) => &self.poses,
            Learning::None => return None,
        };
        taught.latest().visual.then(|| taught.particles())
    }

    /// Number of rows at which no particle explained the camera pose, so that all were
    /// reinitialised around it.
    pub fn collapses(&self) -> u32 {
        self.poses.collapses()
    }

    /// Number of re-simulations of the steps since an occlusion began.
    pub fn second_tries(&self) -> u32 {
        self.poses.second_tries()
    }

    /// ln of the evidence of the rows so far.
    pub fn log_evidence(&self) -> f64 {
        self.poses.log_evidence()
    }
}

/// Options of the particles that learn friction: a setup that leaves more open, and seeds of their
/// own.
struct LearnerOptions<'o> {
    setup: Setup,
    camera: Camera,
    options: FilterOptions<'o>,
}

impl<'o> LearnerOptions<'o> {
    fn new(setup: &Setup, camera: Camera, options: &FilterOptions<'o>) -> Self {
        Self {
            setup: Setup {
                uncertainty: setup.uncertainty.of_learners(),
                ..setup.clone()
            },
            camera,
            options: FilterOptions {
                seed: options.seed.wrapping_add(LEARNING_SEEDS),
                // nothing is learned while the camera is off
                moves: Moves {
                    second_tries: false,
                    ..options.moves
                },
                least_moved: LEAST_MOVED,
                observer: None,
                ..*options
            },
        }
    }

    /// Creates the particles, of an object that has waited so far.
    fn start(&self, waited: Waiting, particles: NonZero<u32>) -> ContactFilter<'o> {
        let options = FilterOptions {
            particles: particles.get() as usize,
            ..self.options
        };
        let learner = ContactFilter::new(&self.setup, self.camera, waited.at, &options);
        let mut learner = learner.expect("the settings are those of the other particles");
        learner.go_on_waiting(&waited);
        learner
    }
}
