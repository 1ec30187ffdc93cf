//! The particles that say where the object is, and beside them, in contact mode, those that learn
//! its friction: [`LearningFilter`], docs/method.md (52).

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

/// Share of a camera pose that moves particles that learn, at least (52).
const LEAST_MOVED: f64 = 0.97;

/// Seeds of the particles that learn lie apart from those of the others.
const LEARNING_SEEDS: u64 = 1 << 48;

/// The filter that says where the object is, with the friction that another one learns.
///
/// What serves the pose is not what serves the friction. Pushes that are smoother than the model's
/// teach a wrong friction, unless particles know that pushes may be smooth and contacts may creep;
/// where the object goes is then told too surely. So there are two sets of particles, each with its
/// own model.
pub(crate) struct LearningFilter<'o> {
    poses: ContactFilter<'o>,
    learning: Learning<'o>,
    /// What was known of friction when the particles that learn it last looked.
    known: Option<KnownFriction>,
    /// The latest camera pose.
    shown: Pose,
    /// Time of the latest row (s).
    time: f64,
}

/// The particles that learn friction.
enum Learning<'o> {
    /// There are none, or no more: friction is told, or the camera will show no more.
    None,
    /// There is nothing to learn before a particle has touched anything.
    AtContact(Box<LearnerOptions<'o>>),
    /// They learn.
    Underway(Box<ContactFilter<'o>>),
}

/// Means and standard deviations.
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

    /// One row: the step that leads to it, then what was measured there.
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
            // particles that have felt nothing have the prior
            Learning::AtContact(_) if self.poses.latest().visual => {
                self.known = KnownFriction::of(self.poses.latest());
            }
            Learning::AtContact(_) | Learning::None => {}
        }
        self.tell_friction();
        self.latest()
    }

    /// A row that comes so soon after the latest step that none leads to it: its pose is weighed as
    /// one of the past.
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

    /// Weighs the particles by a pose that arrives late; those that learn, where the object has not
    /// come to rest since.
    pub fn weigh_late(&mut self, late: PoseAt) -> &EstimateRow {
        self.weigh(late);
        self.latest()
    }

    /// The same; whether the pose is a new one, and counted.
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

    /// Whether a camera pose is a new measurement: in contact mode, one that equals the one before
    /// is that frame again.
    fn is_new(&mut self, pose: Pose) -> bool {
        let before = std::mem::replace(&mut self.shown, pose);
        pose != before || self.poses.model() == FilterModel::Paper
    }

    /// The camera will show no more: what is known of friction stays as it is.
    pub fn learn_no_more(&mut self) {
        self.learning = Learning::None;
    }

    /// Writes what is known of friction into the latest row.
    fn tell_friction(&mut self) {
        if let Some(KnownFriction { mean, std }) = self.known {
            self.poses.tell_friction(mean, std);
        }
    }

    /// Goes on with another number of particles; where it is the same, nothing changes.
    pub fn resize(&mut self, particles: NonZero<u32>) {
        self.poses.resize(particles);
        if let Learning::Underway(learner) = &mut self.learning {
            learner.resize(particles);
        }
    }

    /// The number of particles that say where the object is; as many learn.
    pub fn count(&self) -> NonZero<u32> {
        self.poses.count()
    }

    /// The estimate at the latest row.
    pub fn latest(&self) -> &EstimateRow {
        self.poses.latest()
    }

    /// The particles that say where the object is, after the latest row.
    pub fn particles(&self) -> ParticleView<'_> {
        self.poses.particles()
    }

    /// Those that have its friction, where the latest row taught any: the ones that learn it, and
    /// before contact the same.
    pub fn friction_particles(&self) -> Option<ParticleView<'_>> {
        let taught = match &self.learning {
            Learning::Underway(learner) => &**learner,
            Learning::AtContact(_) => &self.poses,
            Learning::None => return None,
        };
        taught.latest().visual.then(|| taught.particles())
    }

    /// Rows at which no particle explained the camera and all were drawn anew around its pose.
    pub fn collapses(&self) -> u32 {
        self.poses.collapses()
    }

    /// How often the steps since a blackout were made again.
    pub fn second_tries(&self) -> u32 {
        self.poses.second_tries()
    }

    /// ln of the evidence of the rows so far.
    pub fn log_evidence(&self) -> f64 {
        self.poses.log_evidence()
    }
}

/// What the particles that learn friction are made with: a setup that leaves more open, and seeds
/// of their own.
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
                // nothing is learned in the dark
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

    /// The particles, of an object that has waited so far.
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
