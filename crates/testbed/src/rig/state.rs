//! The rig in motion: [`RigState`] and its time step.

use stickslip_dynamics::{Body, Gap, Placed, Pose, Twist, Wrench, narrow_phase};

use super::Rig;
use super::contact::{CompliantContact, RelativeMotion};
use super::drive::Drive;
use super::support_friction::SupportFriction;
use crate::trace::{Contact, Frame};
use crate::trial::{Trial, TrialError};

/// Largest step, relative to 1/ω of the stiffest spring.
const RESOLUTION: f64 = 0.2;

/// State of a rig.
#[derive(Clone, Debug)]
pub(super) struct RigState<'a> {
    rig: &'a Rig,
    trial: &'a Trial<'a>,
    /// Direction of each finger.
    directions: Vec<[f64; 2]>,
    fixels: Vec<Placed<'a>>,
    /// Pose of the object.
    pub object: Pose,
    /// Twist of the object.
    pub twist: Twist,
    support: SupportFriction,
    drive: Drive<'a>,
    /// With each finger, then with each fixel.
    compliant: Vec<CompliantContact>,
    gaps: Vec<Gap>,
    /// Contacts of the last step.
    pub contacts: Vec<Contact>,
    /// Impulses since the last frame (N s): of the pusher, of all fingers together, and normal ones
    /// of fingers and fixels.
    pusher_impulse: [f64; 2],
    hand_impulse: [f64; 2],
    finger_impulses: Vec<f64>,
    fixel_impulses: Vec<f64>,
    has_moved: bool,
}

impl<'a> RigState<'a> {
    /// The rig at rest at the start of a trial.
    pub(super) fn new(rig: &'a Rig, trial: &'a Trial<'a>) -> Result<Self, TrialError> {
        let (scene, start) = (trial.scene, trial.start);
        let points = rig.pressure.points(&scene.object.shape, trial.seed)?;
        let fixels: Vec<Placed<'a>> = scene
            .fixels
            .iter()
            .map(|fixel| Placed::new(&fixel.shape, fixel.pose))
            .collect();
        let directions: Vec<[f64; 2]> = start.directions().collect();
        let mu = directions.iter().map(|_| rig.mu_p);
        let mu = mu.chain(fixels.iter().map(|_| rig.mu_f));
        Ok(Self {
            rig,
            trial,
            object: start.object,
            twist: Twist::default(),
            support: SupportFriction::new(
                &points,
                rig.table.field(rig.mu_s, trial.seed),
                rig.bristles,
                scene,
            ),
            drive: Drive::new(rig.drive, &start.speed, trial.seed),
            compliant: mu.map(CompliantContact::new).collect(),
            gaps: Vec::new(),
            contacts: Vec::new(),
            pusher_impulse: [0.0; 2],
            hand_impulse: [0.0; 2],
            finger_impulses: vec![0.0; directions.len()],
            directions,
            fixel_impulses: vec![0.0; fixels.len()],
            fixels,
            has_moved: false,
        })
    }

    /// The longest step that resolves the contacts and the drive (s).
    pub(super) fn longest_step(&self) -> f64 {
        let object = &self.trial.scene.object;
        // the stiffest case: two contacts at the far ends of the object
        let lever = object.shape.bounding_radius();
        let contact =
            2.0 * self.rig.contact.stiffness * (1.0 / object.mass + lever * lever / object.inertia);
        let spindle = self
            .rig
            .drive
            .spindle
            .map_or(0.0, |spindle| spindle.stiffness / spindle.mass);
        (RESOLUTION / contact.max(spindle).sqrt()).min(self.rig.longest_step)
    }

    /// One step of `h` seconds from `time`.
    pub(super) fn step(&mut self, time: f64, h: f64) {
        self.contacts.clear();
        let mut wrench = self.contact_wrench(h);
        let on_drive = self.add_impulses(h);

        // before the first contact the object is at rest on relaxed bristles, which pull at nothing
        self.has_moved |= !self.contacts.is_empty() || self.twist != Twist::default();
        if self.has_moved {
            wrench = sum(wrench, self.support.step(self.object, &self.twist, h));
        }

        // semi-implicit Euler: velocities first
        let object = &self.trial.scene.object;
        self.twist.vx += h * wrench.fx / object.mass;
        self.twist.vy += h * wrench.fy / object.mass;
        self.twist.omega += h * wrench.torque / object.inertia;
        self.object = self.object.advance(self.twist, h);
        self.drive.advance(time, h, on_drive);
    }

    /// Contacts of the object with all bodies, and their wrench on it.
    fn contact_wrench(&mut self, h: f64) -> Wrench {
        let scene = self.trial.scene;
        let object = Placed::new(&scene.object.shape, self.object);
        let mut wrench = Wrench::default();
        let poses = self.trial.start.fingers_at(self.drive.travel);
        for ((k, shape), pose) in scene.pusher.fingers.iter().enumerate().zip(poses) {
            let velocity = self.directions[k].map(|d| d * self.drive.speed);
            let finger = Placed::new(shape, pose);
            let own = self.contact(Body::Finger(k), (&object, &finger), velocity, h);
            wrench = sum(wrench, own);
        }
        for j in 0..self.fixels.len() {
            let fixel = self.fixels[j];
            wrench = sum(
                wrench,
                self.contact(Body::Fixel(j), (&object, &fixel), [0.0; 2], h),
            );
        }
        wrench
    }

    /// Contacts of the object with one body that moves with `velocity`, and their wrench on the
    /// object.
    fn contact(
        &mut self,
        body: Body,
        (object, other): (&Placed<'_>, &Placed<'_>),
        velocity: [f64; 2],
        h: f64,
    ) -> Wrench {
        self.gaps.clear();
        narrow_phase(object, other, 0.0, &mut self.gaps);
        let index = match body {
            Body::Finger(k) => k,
            Body::Fixel(j) => self.directions.len() + j,
        };
        let compliant = &mut self.compliant[index];
        let mut wrench = Wrench::default();
        for gap in &self.gaps {
            let ([nx, ny], [rx, ry]) = (gap.normal, gap.arm);
            let own = self.twist.at(gap.arm);
            let (vx, vy) = (own[0] - velocity[0], own[1] - velocity[1]);
            let relative = RelativeMotion {
                gap_rate: nx * vx + ny * vy,
                slip: nx * vy - ny * vx,
            };
            let mass = self.trial.scene.object.mass;
            let f = compliant.force(&self.rig.contact, gap, relative, [mass, h]);
            let force = [
                f.normal * nx - f.tangential * ny,
                f.normal * ny + f.tangential * nx,
            ];
            wrench.fx += force[0];
            wrench.fy += force[1];
            wrench.torque += rx * force[1] - ry * force[0];
            self.contacts.push(Contact {
                body,
                point: [self.object.x + rx, self.object.y + ry],
                normal: gap.normal,
                force,
            });
        }
        compliant.end_step();
        wrench
    }

    /// Adds up the contacts' impulses; returns the force of the object on the drive: on all
    /// fingers, each along its direction (N).
    fn add_impulses(&mut self, h: f64) -> f64 {
        let mut along = 0.0;
        for contact in &self.contacts {
            let [fx, fy] = contact.force;
            let normal = h * (fx * contact.normal[0] + fy * contact.normal[1]);
            match contact.body {
                Body::Finger(k) => {
                    let [along_x, along_y] = self.directions[k];
                    along -= fx * along_x + fy * along_y;
                    self.finger_impulses[k] += normal;
                    for (axis, force) in [fx, fy].into_iter().enumerate() {
                        self.hand_impulse[axis] += h * force;
                        if k == 0 {
                            self.pusher_impulse[axis] += h * force;
                        }
                    }
                }
                Body::Fixel(j) => self.fixel_impulses[j] += normal,
            }
        }
        along
    }

    /// The frame at `time`, with means over the `interval` that ends here (s); begins the next one.
    pub(super) fn frame(&mut self, time: f64, interval: f64) -> Frame {
        let mut fingers: Vec<Pose> = self.trial.start.fingers_at(self.drive.travel).collect();
        let mean = |impulses: &[f64]| impulses.iter().map(|p| p / interval).collect();
        let frame = Frame {
            time,
            object: self.object,
            twist: self.twist,
            other_fingers: fingers.split_off(1),
            pusher: fingers[0],
            contacts: self.contacts.clone(),
            pusher_force: self.pusher_impulse.map(|p| p / interval),
            hand_force: self.hand_impulse.map(|p| p / interval),
            fixel_forces: mean(&self.fixel_impulses),
            finger_forces: mean(&self.finger_impulses),
            tactile: Vec::new(),
        };
        self.pusher_impulse = [0.0; 2];
        self.hand_impulse = [0.0; 2];
        self.finger_impulses.fill(0.0);
        self.fixel_impulses.fill(0.0);
        frame
    }

    /// Mean friction coefficient under the object now.
    pub(super) fn mean_friction(&self) -> f64 {
        self.support.mean_friction(self.object, &self.twist)
    }

    /// Radius of the tripod with the support's torque in pure spin (m).
    pub(super) fn tripod_radius(&self) -> f64 {
        self.support.tripod_radius()
    }
}

fn sum(a: Wrench, b: Wrench) -> Wrench {
    Wrench {
        fx: a.fx + b.fx,
        fy: a.fy + b.fy,
        torque: a.torque + b.torque,
    }
}
