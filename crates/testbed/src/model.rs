//! The model in the rig's place: [`Model`] runs Γ itself, one step per frame.

use stickslip_dynamics::{
    Body, Dynamics, FingerMotion, Friction, Outcome, Particle, Pose, PusherMotion, StepInput,
    StepWork, Twist,
};

use crate::touch::TouchSensors;
use crate::trace::{Contact, Frame, Trace};
use crate::trial::{Trial, TrialError};

/// Γ with its true friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// True friction.
    pub friction: Friction,
    /// The touch sensors on the fixels.
    pub touch: TouchSensors,
}

impl Model {
    /// Runs an experiment; the pusher moves by h (u − y d), so a stalled one stays behind its
    /// command.
    ///
    /// # Errors
    /// [`TrialError`]: the camera's rate or a friction value is none, bodies overlap at the start.
    pub fn run(&self, trial: &Trial<'_>) -> Result<Trace, TrialError> {
        self.run_observed(trial, &mut |_| ())
    }

    /// Runs an experiment like [`run`](Self::run); `progress` gets the number of finished frames.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_observed(
        &self,
        trial: &Trial<'_>,
        progress: &mut dyn FnMut(usize),
    ) -> Result<Trace, TrialError> {
        let Friction {
            mu_s, mu_p, mu_f, ..
        } = self.friction;
        trial.check([("mu_s", mu_s), ("mu_p", mu_p), ("mu_f", mu_f)])?;
        let (dynamics, h) = (Dynamics::new(trial.scene.clone()), 1.0 / trial.rate);
        let directions: Vec<[f64; 2]> = trial.start.directions().collect();
        let commanded = |k: usize| {
            let way = trial.start.speed.travel(trial.time(k));
            trial.start.fingers_at(way).collect::<Vec<Pose>>()
        };
        let mut object = Particle {
            pose: trial.start.object,
            ..Particle::default()
        };
        let (mut fingers, mut work, mut unsolved) = (commanded(0), StepWork::<1>::default(), 0);
        let mut frames = vec![frame(trial, 0, &object, &fingers, Vec::new())];
        for k in 1..trial.frames() {
            progress(k);
            let ways = commanded(k - 1).into_iter().zip(commanded(k));
            let twists: Vec<Twist> = ways.map(|(from, to)| from.twist_to(to, h)).collect();
            let motions = fingers.iter().zip(&twists).zip(&directions);
            let motions = motions.map(|((pose, twist), direction)| {
                Some(FingerMotion {
                    pose: *pose,
                    twist: *twist,
                    direction: *direction,
                })
            });
            let input = StepInput {
                h,
                pusher: PusherMotion::new(motions),
            };
            let [report] = dynamics.step(
                &input,
                &[self.friction],
                std::array::from_mut(&mut object),
                &mut work,
            );
            unsolved += usize::from(report.outcome != Outcome::Solved);
            // the trace's fingers are exact: no lag is left to the particle
            let lags = std::mem::take(&mut object.pusher_lag);
            for ((finger, twist), [x, y]) in fingers.iter_mut().zip(&twists).zip(lags) {
                *finger = finger.advance(*twist, h);
                (finger.x, finger.y) = (finger.x - x, finger.y - y);
            }
            frames.push(frame(
                trial,
                k,
                &object,
                &fingers,
                contacts(&work, object.pose, h),
            ));
        }
        self.touch.write_readings(&mut frames, trial);
        Ok(Trace {
            friction: self.friction,
            frames,
            unsolved,
        })
    }
}

/// Contacts that pressed in the last step.
fn contacts(work: &StepWork<1>, object: Pose, h: f64) -> Vec<Contact> {
    let (problem, solution) = (work.problem(0), work.solution(0));
    let bodies = work.bodies(0);
    let impulses = solution.normal.iter().zip(&solution.tangential);
    let rows = problem
        .contacts
        .iter()
        .zip(&bodies)
        .zip(impulses)
        .filter(|(_, (normal, _))| **normal > 0.0);
    let contact = |((point, body), (p_n, p_t)): (
        (&stickslip_dynamics::ContactPoint, &Body),
        (&f64, &f64),
    )| {
        let ([nx, ny], [rx, ry]) = (point.normal, point.arm);
        let force = [(p_n * nx - p_t * ny) / h, (p_n * ny + p_t * nx) / h];
        Contact {
            body: *body,
            point: [object.x + rx, object.y + ry],
            normal: point.normal,
            force,
        }
    };
    rows.map(contact).collect()
}

fn frame(
    trial: &Trial<'_>,
    k: usize,
    object: &Particle,
    fingers: &[Pose],
    contacts: Vec<Contact>,
) -> Frame {
    let of = |body: Body| contacts.iter().filter(move |contact| contact.body == body);
    let vector = |body: Body| {
        let forces = of(body).map(|contact| contact.force);
        forces.fold([0.0; 2], |sum, f| [sum[0] + f[0], sum[1] + f[1]])
    };
    let normal = |c: &Contact| c.force[0] * c.normal[0] + c.force[1] * c.normal[1];
    let force = |body: Body| of(body).map(normal).fold(0.0, |sum, f| sum + f);
    let fixels = (0..trial.scene.fixels.len()).map(Body::Fixel);
    Frame {
        time: trial.time(k),
        object: object.pose,
        twist: object.twist,
        pusher: fingers[0],
        other_fingers: fingers[1..].to_vec(),
        pusher_force: vector(Body::Finger(0)),
        hand_force: (0..fingers.len())
            .map(|k| vector(Body::Finger(k)))
            .fold([0.0; 2], |sum, f| [sum[0] + f[0], sum[1] + f[1]]),
        fixel_forces: fixels.map(force).collect(),
        finger_forces: (0..fingers.len()).map(Body::Finger).map(force).collect(),
        contacts,
        tactile: Vec::new(),
    }
}
