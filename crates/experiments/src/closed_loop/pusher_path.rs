//! Commanded motions of a pusher: [`PusherPath`].

use std::f64::consts::TAU;

use stickslip_dynamics::Pose;

use stickslip_testkit::SplitMix64;

/// Commanded motion of a pusher.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// Straight on, at one speed.
    Straight,
    /// Its heading turns as it moves.
    Curved,
    /// It turns in place as it moves, or stands while it turns.
    Turning,
    /// It stops for a while, several times.
    StopAndGo,
    /// It goes back and forth.
    Reversing,
    /// It creeps, micrometres a frame.
    Creeping,
}

/// A commanded motion, in the frame in which the push goes along +x.
#[derive(Clone, Copy, Debug)]
pub(super) struct PusherPath {
    motion: Motion,
    /// Way from the first frame to the last, were it straight (m).
    travel: f64,
    /// Change of heading over the whole way (rad).
    bend: f64,
    /// Change of orientation over the whole way (rad).
    turn: f64,
    /// Stops, or turns back.
    cycles: f64,
}

impl PusherPath {
    /// Any motion; a straight one comes `travel` m far.
    pub fn draw(rng: &mut SplitMix64, travel: f64) -> Self {
        let motion = match rng.below(10) {
            0..=3 => Motion::Straight,
            4 | 5 => Motion::Curved,
            6 => Motion::Turning,
            7 => Motion::StopAndGo,
            8 => Motion::Reversing,
            _ => Motion::Creeping,
        };
        Self {
            motion,
            travel: match motion {
                Motion::Creeping => travel * rng.log_within(1e-2, 0.3),
                Motion::Turning => travel * rng.within(0.0, 1.0),
                _ => travel,
            },
            bend: match motion {
                Motion::Curved => rng.sign() * rng.within(0.2, 1.5),
                _ => 0.0,
            },
            turn: match motion {
                Motion::Turning => rng.sign() * rng.within(0.2, 3.0),
                Motion::Curved => rng.within(-1.0, 1.0),
                _ => 0.0,
            },
            cycles: 1.0 + rng.below(5) as f64,
        }
    }

    /// Speed at `share` of the time, as a multiple of travel over duration.
    fn pace(&self, share: f64) -> f64 {
        let phase = (share * self.cycles).fract();
        match self.motion {
            Motion::StopAndGo if phase > 0.6 => 0.0,
            Motion::StopAndGo => 1.0 / 0.6,
            Motion::Reversing => 1.0 + self.cycles * libm::cos(TAU * share * self.cycles),
            _ => 1.0,
        }
    }

    /// The commanded twist times the duration at `share` in [0, 1] of the time: metres and radians
    /// over the whole way.
    fn rate(&self, share: f64) -> [f64; 3] {
        let (sin, cos) = libm::sincos(self.bend * share);
        let way = self.travel * self.pace(share);
        [way * cos, way * sin, self.turn]
    }

    /// Commanded poses from `start`, one per frame.
    pub fn poses(&self, start: Pose, frames: usize) -> Vec<Pose> {
        let steps = (frames - 1).max(1) as f64;
        let mut pose = start;
        let mut poses = vec![start];
        for k in 1..frames {
            let [x, y, turn] = self.rate((k as f64 - 0.5) / steps);
            pose = Pose::new(
                pose.x + x / steps,
                pose.y + y / steps,
                pose.theta + turn / steps,
            );
            poses.push(pose);
        }
        poses
    }
}
