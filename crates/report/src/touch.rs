//! Contact of the object with other bodies: [`TouchRule`], by gap or by force, so that it applies
//! at rest too.
//!
//! The force that a filter or a simulation has for a contact at rest may be zero, and says nothing
//! then: friction keeps the object in place whether the pusher presses on it or only stands there.

use stickslip::dynamics::{Body, Placed, Pose, Scene, Shape, narrow_phase};
use stickslip::{EstimateRow, Setup};
use stickslip_evaluation::Reference;
use stickslip_formats::Experiment;

use crate::drawing::px;

/// Gap up to which two bodies touch (m).
const GAP: f64 = 2e-4;

/// Largest offset of a row of the truth from a row of the log at the same time (s).
const SAME_TIME: f64 = 5e-4;

/// Rule for contact in a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TouchRule<'a> {
    scene: &'a Scene,
    /// Gap up to which the pusher touches (m): its measured pose is noisy.
    pusher_gap: f64,
}

impl<'a> TouchRule<'a> {
    /// Of poses that are known exactly.
    pub fn exact(setup: &'a Setup) -> Self {
        Self {
            scene: &setup.scene,
            pusher_gap: GAP,
        }
    }

    /// Of poses about a measured pusher.
    pub fn measured(setup: &'a Setup) -> Self {
        let noise = setup
            .camera
            .map_or(0.0, |camera| camera.pusher_position_std);
        Self {
            pusher_gap: GAP + 2.0 * noise,
            ..Self::exact(setup)
        }
    }

    /// The rule in words.
    pub fn words(&self) -> String {
        let [gap, pusher_gap] = [GAP, self.pusher_gap].map(|gap| px(1e3 * gap));
        let rule = format!(
            "two bodies touch where they press on each other or their gap is at most {gap} mm"
        );
        match pusher_gap == gap {
            true => rule,
            false => format!("{rule}; for an estimate, {pusher_gap} mm to the pusher as measured"),
        }
    }

    /// Number of bodies: the pusher, the fixels, and a hand's other fingers.
    pub fn bodies(&self) -> usize {
        1 + self.scene.others()
    }

    /// Returns true if the object at a pose touches a body. The pusher is body 0. Fixels
    /// follow, then other fingers. `fingers` has the poses of the pusher and of the other fingers,
    /// where they are on the table.
    pub fn touches(&self, object: Pose, fingers: &[Option<Pose>], body: usize) -> bool {
        let Scene { fixels, pusher, .. } = self.scene;
        match self.scene.contact(body) {
            Body::Fixel(j) => self.within(object, &fixels[j].shape, fixels[j].pose, GAP),
            Body::Finger(i) => {
                fingers.get(i).copied().flatten().is_some_and(|pose| {
                    self.within(object, &pusher.fingers[i], pose, self.pusher_gap)
                })
            }
        }
    }

    fn within(&self, object: Pose, other: &Shape, at: Pose, gap: f64) -> bool {
        let mut gaps = Vec::new();
        let object = Placed::new(&self.scene.object.shape, object);
        narrow_phase(&object, &Placed::new(other, at), gap, &mut gaps);
        gaps.iter().any(|found| found.gap <= gap)
    }

    /// Probability of contact by particles of the same weight and by the row's own numbers, body by
    /// body; `None` where the row has none.
    pub fn probabilities(
        &self,
        row: &EstimateRow,
        particles: &[Pose],
        fingers: &[Option<Pose>],
    ) -> Option<Vec<f64>> {
        let pressed: Vec<f64> = std::iter::once(row.contact_pusher?)
            .chain(row.contact_others.iter().flatten().copied())
            .collect();
        let share = |body: usize| {
            let near = particles
                .iter()
                .filter(|pose| self.touches(**pose, fingers, body));
            near.count() as f64 / particles.len().max(1) as f64
        };
        let bodies = pressed.iter().enumerate();
        Some(bodies.map(|(body, p)| p.max(share(body))).collect())
    }
}

/// True contacts of the object with the pusher, each fixel and each other finger, row by row: it is
/// pressed, or the gap is closed. `None` where there is no truth.
pub(crate) fn true_touches(
    experiment: &Experiment,
    reference: &Reference,
) -> Vec<Option<Vec<bool>>> {
    let Experiment {
        setup, log, truth, ..
    } = experiment;
    let rule = TouchRule::exact(setup);
    let Some(truth) = truth else {
        return vec![None; rule.bodies()];
    };
    let row_at = |time: &f64| {
        let row = truth.time.partition_point(|t| *t < time - SAME_TIME);
        (*truth.time.get(row)? < time + SAME_TIME).then_some(row)
    };
    let rows: Vec<Option<usize>> = log.time.iter().map(row_at).collect();
    let touches = |body: usize| -> Vec<bool> {
        let force = match body.checked_sub(1) {
            None => Some(&truth.pusher_force),
            Some(fixel) => truth.fixel_forces.get(fixel),
        };
        let touch = |(row, at): (usize, &Option<usize>)| {
            let pressed = at.and_then(|k| force?.get(k).copied());
            let mut fingers = log.fingers_at(row);
            if let Some(pusher) = at.and_then(|k| truth.pusher.get(k)) {
                fingers[0] = Some(*pusher);
            }
            pressed.is_some_and(|force| force > setup.tactile.touch_force)
                || reference.pose[row].is_some_and(|pose| rule.touches(pose, &fingers, body))
        };
        rows.iter().enumerate().map(touch).collect()
    };
    (0..rule.bodies()).map(|body| Some(touches(body))).collect()
}

#[cfg(test)]
mod tests {
    use stickslip::dynamics::{Feet, Fixel, Friction, Object, Part, Pusher};
    use stickslip::{Camera, FilterSettings, Log, Tactile, Uncertainty};
    use stickslip_formats::{Truth, TruthFacts};

    use super::*;

    fn disc(radius: f64) -> Shape {
        let centre = [0.0, 0.0];
        Shape::new(vec![Part::Disc { radius, centre }]).expect("a disc")
    }

    /// Discs of 10 mm: the object, a pusher left of it, a fixel at 40 mm.
    fn setup() -> Setup {
        Setup {
            scene: Scene {
                gravity: 9.81,
                object: Object {
                    mass: 0.5,
                    inertia: 2e-4,
                    shape: disc(0.01),
                },
                feet: Feet::Tripod { angle: 0.0 },
                pusher: Pusher {
                    fingers: vec![disc(0.01)],
                    stall_force: None,
                },
                fixels: vec![Fixel {
                    pose: Pose::new(0.04, 0.0, 0.0),
                    shape: disc(0.01),
                }],
                nominal: Friction {
                    mu_s: 0.3,
                    mu_p: 0.3,
                    mu_f: 0.3,
                    d_tri: 0.01,
                },
            },
            stall_force_assumed: false,
            camera: None,
            tactile: Tactile::default(),
            filter: FilterSettings::default(),
            wrench: None,
            uncertainty: Uncertainty::default(),
            start: None,
        }
    }

    /// The object rests at the fixel from row 1 on; the pusher leaves it at row 2.
    fn experiment(forces: bool) -> Experiment {
        let time = vec![0.0, 0.1, 0.2];
        let object = [0.01, 0.019_9, 0.019_9].map(|x| Pose::new(x, 0.0, 0.0));
        let pusher = [-0.011, -1e-4, -0.01].map(|x| Pose::new(x, 0.0, 0.0));
        let log = Log {
            time: time.clone(),
            object: object.map(Some).to_vec(),
            pusher: pusher.map(Some).to_vec(),
            ..Log::default()
        };
        let truth = Truth {
            time,
            pose: object.to_vec(),
            pusher: pusher.to_vec(),
            pusher_force: if forces { vec![2.0, 0.0, 0.0] } else { vec![] },
            ..Truth::default()
        };
        Experiment::new(setup(), log, Some(truth), TruthFacts::default()).expect("an experiment")
    }

    #[test]
    fn contact_at_rest_holds_without_a_force_and_ends_with_a_gap() {
        for (forces, first) in [(true, true), (false, false)] {
            let experiment = experiment(forces);
            let touches = true_touches(&experiment, &Reference::of(&experiment));
            let expected = [vec![first, true, false], vec![false, true, true]];
            assert_eq!(touches, expected.map(Some));
        }
    }

    #[test]
    fn the_rule_tells_the_gap_to_a_pusher_whose_pose_is_noisy() {
        let exact = setup();
        let noisy = Setup {
            camera: Some(Camera {
                position_std: 3e-4,
                orientation_std: 5e-3,
                latency: 0.0,
                pusher_position_std: 4e-5,
                pusher_orientation_std: 0.0,
            }),
            ..setup()
        };
        let told = |setup: &Setup| TouchRule::measured(setup).words();
        assert!(told(&exact).ends_with("gap is at most 0.2 mm"));
        assert!(told(&noisy).ends_with("for an estimate, 0.28 mm to the pusher as measured"));
    }

    #[test]
    fn particles_at_a_body_touch_it_though_nothing_presses() {
        let setup = setup();
        let row = EstimateRow {
            contact_pusher: Some(0.25),
            contact_others: Some(vec![0.0]),
            ..EstimateRow::default()
        };
        let particles = [0.019_85, 0.02, 0.018, 0.0199].map(|x| Pose::new(x, 0.0, 0.0));
        let rule = TouchRule::measured(&setup);
        let found = rule.probabilities(&row, &particles, &[]);
        assert_eq!(found, Some(vec![0.25, 0.75]));
        let none = rule.probabilities(&EstimateRow::default(), &particles, &[]);
        assert_eq!(none, None);
    }
}
