//! Experiment to simulate, [`Trial`], and the reasons why it cannot be simulated: [`TrialError`].

use stickslip_dynamics::{Body, Gap, Placed, Scene, Start, narrow_phase};

/// Overlap at the start that counts as rounding of the poses (m).
const ROUNDING: f64 = 2e-5;

/// One experiment to be simulated.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'a> {
    /// Bodies, and friction as far as the physics' own settings leave it open.
    pub scene: &'a Scene,
    /// Poses at the start, and the pusher's commanded motion.
    pub start: &'a Start,
    /// Camera frames per second (Hz).
    pub rate: f64,
    /// Seed of everything that is random.
    pub seed: u64,
}

/// Reason why an experiment cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrialError {
    /// The rate is no rate.
    #[error(
        "the camera rate is {rate} Hz; it must be from 1 to 1000 Hz. Give frames per second, 30 as a rule"
    )]
    Rate {
        /// The rate found (Hz).
        rate: f64,
    },
    /// A finger has no place at the start, or there is one too many.
    #[error(
        "the scene has {fingers} fingers and the start has {found}; give each [[finger]] its start = [x, y, theta]"
    )]
    Hand {
        /// Fingers of the scene, the pusher among them.
        fingers: usize,
        /// Fingers of the start.
        found: usize,
    },
    /// A friction coefficient is none.
    #[error(
        "the true {name} is {value}; it must be a finite number from 0 up. Give a coefficient of friction"
    )]
    Friction {
        /// Name of the number.
        name: &'static str,
        /// The value found.
        value: f64,
    },
    /// Bodies overlap at the start.
    #[error(
        "at the start the object overlaps {} by {:.3} mm; bodies must be apart. Move the object or the pusher in [start], the finger, or the fixel",
        body_name(*body), 1e3 * depth
    )]
    Overlap {
        /// The other body.
        body: Body,
        /// Depth of the overlap (m).
        depth: f64,
    },
    /// The steps are too many.
    #[error(
        "the experiment takes {steps:.1e} time steps of {length:.1e} s; at most {most:.0e} are made. \
         A small mass or inertia of the object makes steps short: give them in kg and kg m^2. Or give a shorter duration"
    )]
    Steps {
        /// Number of time steps.
        steps: f64,
        /// Their length (s).
        length: f64,
        /// Largest number.
        most: f64,
    },
    /// The centre of mass is not over the face.
    #[error(
        "the centre of mass (the origin of the object frame) is not over the object's face, so the object would tip. \
         Give its shape relative to the centre of mass"
    )]
    Tips,
}

impl Trial<'_> {
    /// Number of frames, from time 0 to the duration.
    pub fn frames(&self) -> usize {
        (self.start.duration * self.rate + 1e-6).floor() as usize + 1
    }

    /// Time of a frame (s).
    pub fn time(&self, frame: usize) -> f64 {
        frame as f64 / self.rate
    }

    /// Refuses trials that no physics can simulate.
    pub(crate) fn check(&self, friction: [(&'static str, f64); 3]) -> Result<(), TrialError> {
        if !(1.0..=1000.0).contains(&self.rate) {
            return Err(TrialError::Rate { rate: self.rate });
        }
        let fingers = self.scene.pusher.fingers.len();
        let found = self.start.directions().count();
        if found != fingers {
            return Err(TrialError::Hand { fingers, found });
        }
        if let Some((name, value)) = friction
            .into_iter()
            .find(|(_, value)| !value.is_finite() || *value < 0.0)
        {
            return Err(TrialError::Friction { name, value });
        }
        let shapes = self.scene.pusher.fingers.iter().enumerate();
        let fingers = shapes.zip(self.start.fingers_at(0.0));
        let fingers = fingers.map(|((k, shape), pose)| (Body::Finger(k), shape, pose));
        let fixels = self
            .scene
            .fixels
            .iter()
            .enumerate()
            .map(|(j, fixel)| (Body::Fixel(j), &fixel.shape, fixel.pose));
        let object = Placed::new(&self.scene.object.shape, self.start.object);
        let mut gaps: Vec<Gap> = Vec::new();
        for (body, shape, pose) in fingers.chain(fixels) {
            gaps.clear();
            narrow_phase(&object, &Placed::new(shape, pose), -ROUNDING, &mut gaps);
            if let Some(depth) = gaps.iter().map(|gap| -gap.gap).reduce(f64::max) {
                return Err(TrialError::Overlap { body, depth });
            }
        }
        Ok(())
    }
}

fn body_name(body: Body) -> String {
    match body {
        Body::Finger(0) => "the pusher".to_owned(),
        other => other.to_string(),
    }
}
