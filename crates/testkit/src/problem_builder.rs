//! Random step problems, put together part by part: [`ProblemBuilder`] adds contacts and loads to a
//! body on its feet with a pusher.
//!
//! Everything keeps to the scale of a table-top experiment. Masses are 0.02–5 kg, radii of gyration
//! ρ 3–60 mm, steps 0.1–33 ms, speeds up to 0.3 m/s. Contacts lie within 2.1 ρ of the centre of
//! mass (faces 3.2 ρ), gaps within ±2 mm.

use stickslip_dynamics::{ContactPoint, Foot, StepProblem, Twist, Wrench};

use crate::rng::SplitMix64;
use crate::vector::left;

const GRAVITY: f64 = 9.81;
pub(crate) const FASTEST: f64 = 0.3;
const WIDEST_GAP: f64 = 2e-3;

/// The other body of a contact.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Other {
    Pusher,
    Fixel,
}

/// A step problem in the making, with the random numbers that it is made from.
pub(crate) struct ProblemBuilder {
    pub rng: SplitMix64,
    pub problem: StepProblem,
    /// Radius of gyration ρ (m).
    pub gyration: f64,
    /// Largest friction impulse of all feet together (N s).
    pub bound: f64,
    /// The pusher's commanded motion, as the twist of the point at the object's centre of mass.
    pub pusher: Twist,
}

impl ProblemBuilder {
    /// A body in motion or at rest, on a tripod or uneven feet, without contacts or load.
    pub fn new(mut rng: SplitMix64) -> Self {
        let (mass, gyration) = (rng.log_within(0.02, 5.0), rng.log_within(3e-3, 60e-3));
        let h = rng.log_within(1e-4, 1.0 / 30.0);
        let mu_s = if rng.one_in(10) {
            0.0
        } else {
            rng.within(0.02, 1.0)
        };
        let problem = StepProblem {
            mass,
            inertia: mass * gyration * gyration,
            h,
            twist: Twist::default(),
            applied: Wrench::default(),
            contacts: vec![],
            feet: [Foot::default(); 3],
            stall: None,
        };
        let mut builder = Self {
            rng,
            problem,
            gyration,
            bound: mu_s * mass * GRAVITY * h,
            pusher: Twist::default(),
        };
        if builder.rng.one_in(4) {
            builder.stand_unevenly(1e-3)
        } else {
            builder.stand_on_tripod(1e-4, 50e-3)
        }
        builder.problem.twist = builder.slow_twist();
        let (speed, direction) = (
            builder.rng.log_within(1e-3, FASTEST),
            builder.rng.direction(),
        );
        builder.pusher = Twist {
            vx: speed * direction[0],
            vy: speed * direction[1],
            omega: 0.0,
        };
        builder
    }

    pub fn stand_on_tripod(&mut self, smallest: f64, largest: f64) {
        let (d_tri, e) = (self.rng.log_within(smallest, largest), self.rng.direction());
        let (cos, sin) = (-0.5, 0.75_f64.sqrt());
        let directions = [
            e,
            [cos * e[0] - sin * e[1], sin * e[0] + cos * e[1]],
            [cos * e[0] + sin * e[1], cos * e[1] - sin * e[0]],
        ];
        self.problem.feet = directions.map(|e| Foot {
            arm: [d_tri * e[0], d_tri * e[1]],
            bound: self.bound / 3.0,
        });
    }

    /// Feet anywhere about the centre of mass; loads from statics: the centre of mass is their
    /// load-weighted mean.
    pub fn stand_unevenly(&mut self, least_share: f64) {
        let light = self.rng.log_within(least_share, 0.3);
        let split = self.rng.within(0.1, 0.9) * (1.0 - light);
        let loads = [light, split, 1.0 - light - split];
        let extent = 1.5 * self.gyration;
        let points = [(); 3].map(|()| {
            [
                self.rng.within(-extent, extent),
                self.rng.within(-extent, extent),
            ]
        });
        let mean = [0, 1].map(|axis| (0..3).map(|k| loads[k] * points[k][axis]).sum::<f64>());
        self.problem.feet = [0, 1, 2].map(|k| Foot {
            arm: [points[k][0] - mean[0], points[k][1] - mean[1]],
            bound: loads[k] * self.bound,
        });
    }

    pub fn scale_support(&mut self, factor: f64) {
        self.bound *= factor;
        self.problem
            .feet
            .iter_mut()
            .for_each(|foot| foot.bound *= factor);
    }

    /// At rest once in four times; otherwise translation and rotation (at ρ) each from 0.1 mm/s to
    /// 0.3 m/s.
    pub fn slow_twist(&mut self) -> Twist {
        if self.rng.one_in(4) {
            Twist::default()
        } else {
            self.twist_between(1e-4, FASTEST)
        }
    }

    pub fn twist_between(&mut self, slowest: f64, fastest: f64) -> Twist {
        let (speed, direction) = (self.rng.log_within(slowest, fastest), self.rng.direction());
        let turn = self.rng.sign() * self.rng.log_within(slowest, fastest) / self.gyration;
        Twist {
            vx: speed * direction[0],
            vy: speed * direction[1],
            omega: turn,
        }
    }

    /// Unit vector of the commanded translation.
    pub fn drive(&self) -> [f64; 2] {
        let speed = libm::hypot(self.pusher.vx, self.pusher.vy);
        [self.pusher.vx / speed, self.pusher.vy / speed]
    }

    /// Lets the drive stall at between a twentieth and twenty times the force that pushing the
    /// object alone takes.
    pub fn limit_drive(&mut self) {
        let needed = self.bound + self.problem.mass * libm::hypot(self.pusher.vx, self.pusher.vy);
        self.problem.stall = Some(needed * self.rng.log_within(0.05, 20.0));
    }

    pub fn friction(&mut self) -> f64 {
        if self.rng.one_in(8) {
            0.0
        } else {
            self.rng.within(0.05, 1.5)
        }
    }

    /// Zero, or closing or opening within about a step, or anything up to 2 mm.
    pub fn gap(&mut self) -> f64 {
        let reachable = (FASTEST * self.problem.h).min(WIDEST_GAP);
        match self.rng.below(3) {
            0 => 0.0,
            1 => reachable * self.rng.within(-0.5, 1.0),
            _ => self.rng.log_within(1e-7, WIDEST_GAP),
        }
    }

    /// A negative gap down to −2 mm, often very small.
    pub fn overlap(&mut self) -> f64 {
        let depth = if self.rng.one_in(2) {
            self.rng.log_within(1e-7, WIDEST_GAP)
        } else {
            self.rng.within(1e-7, WIDEST_GAP)
        };
        -depth
    }

    /// `normal` turned by a random angle of at most `most` (rad).
    pub fn tilted(&mut self, normal: [f64; 2], most: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.rng.within(-most, most));
        [
            cos * normal[0] - sin * normal[1],
            sin * normal[0] + cos * normal[1],
        ]
    }

    /// A contact with `other` whose normal passes `lever` ρ to the left of the centre of mass, with
    /// random friction and gap.
    pub fn contact(&mut self, other: Other, normal: [f64; 2], lever: f64) -> ContactPoint {
        let depth = self.rng.within(0.5, 1.7) * self.gyration;
        let (t, side) = (left(normal), lever * self.gyration);
        let arm = [
            side * t[0] - depth * normal[0],
            side * t[1] - depth * normal[1],
        ];
        let surface_velocity = if other == Other::Pusher {
            self.pusher.at(arm)
        } else {
            [0.0; 2]
        };
        let (gap, mu) = (self.gap(), self.friction());
        ContactPoint {
            normal,
            arm,
            gap,
            mu,
            surface_velocity,
            yields: (other == Other::Pusher).then(|| self.drive()),
        }
    }

    /// A contact with `other` of the given normal, anywhere on that side of the object.
    pub fn contact_anywhere(&mut self, other: Other, normal: [f64; 2]) -> ContactPoint {
        let lever = self.rng.within(-1.2, 1.2);
        self.contact(other, normal, lever)
    }

    pub fn add(&mut self, contact: ContactPoint) {
        self.problem.contacts.push(contact);
    }

    /// A pusher contact that faces the drive to within `most` (rad).
    pub fn add_push(&mut self, most: f64) {
        let drive = self.drive();
        let normal = self.tilted(drive, most);
        let contact = self.contact_anywhere(Other::Pusher, normal);
        self.add(contact);
    }

    /// Two contacts of one face at the same depth, parallel or slightly tilted against each other.
    pub fn add_face(&mut self, other: Other, normal: [f64; 2]) {
        let first = self.contact_anywhere(other, normal);
        let tilt = if self.rng.one_in(2) {
            0.0
        } else {
            self.rng.log_within(1e-9, 1e-2)
        };
        let width = self.rng.within(-1.5, 1.5) * self.gyration;
        let t = left(normal);
        let arm = [first.arm[0] + width * t[0], first.arm[1] + width * t[1]];
        let surface_velocity = if other == Other::Pusher {
            self.pusher.at(arm)
        } else {
            [0.0; 2]
        };
        let gap = if self.rng.one_in(2) {
            first.gap
        } else {
            self.gap()
        };
        let second = ContactPoint {
            normal: self.tilted(normal, tilt),
            arm,
            gap,
            surface_velocity,
            ..first
        };
        self.add(first);
        self.add(second);
    }

    /// A random load: an impulse of `share` times the support's friction impulse, and a torque up
    /// to that times ρ.
    pub fn load(&mut self, share: f64) {
        let (size, e) = (share * self.bound, self.rng.direction());
        let torque = share * self.bound * self.gyration * self.rng.within(-1.0, 1.0);
        self.problem.applied = Wrench {
            fx: size * e[0],
            fy: size * e[1],
            torque,
        };
    }
}
