//! Start of an experiment, and the motion that the pusher is commanded: [`Start`].

use crate::se2::Pose;

/// Start of an experiment, and the motion that the pusher is commanded: `[start]` of a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Pose of the object, at rest.
    pub object: Pose,
    /// Pose of the pusher; it keeps its angle.
    pub pusher: Pose,
    /// Direction of the pusher's motion, world frame (rad).
    pub direction: f64,
    /// A hand's other fingers: the pose, where each keeps its angle, and its direction (rad).
    pub other_fingers: Vec<(Pose, f64)>,
    /// Commanded speed of the drive, with which every finger moves along its direction.
    pub speed: SpeedProfile,
    /// Duration of the experiment (s).
    pub duration: f64,
}

/// A commanded speed over time: linear between knots, constant before the first and after the last
/// one.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedProfile {
    knots: Vec<[f64; 2]>,
}

impl Start {
    /// Unit vector of the motion of each finger, world frame, the pusher's first.
    pub fn directions(&self) -> impl Iterator<Item = [f64; 2]> {
        self.fingers().map(|(_, direction)| {
            let (sin, cos) = libm::sincos(direction);
            [cos, sin]
        })
    }

    /// Poses of all fingers, the pusher's first, when the drive has travelled `way` (m).
    pub fn fingers_at(&self, way: f64) -> impl Iterator<Item = Pose> {
        let places = self.fingers().zip(self.directions());
        places.map(move |((Pose { x, y, theta }, _), [along_x, along_y])| {
            Pose::new(x + way * along_x, y + way * along_y, theta)
        })
    }

    /// Pose and direction of each finger, the pusher's first.
    fn fingers(&self) -> impl Iterator<Item = (Pose, f64)> {
        let pusher = (self.pusher, self.direction);
        std::iter::once(pusher).chain(self.other_fingers.iter().copied())
    }
}

impl SpeedProfile {
    /// One speed at all times (m/s).
    pub fn constant(speed: f64) -> Self {
        Self {
            knots: vec![[0.0, speed]],
        }
    }

    /// A speed through knots of time (s) and speed (m/s); two knots of one time are a jump.
    ///
    /// `None` without knots, with a number that is not finite, or with a time before the last
    /// one's.
    ///
    /// ```
    /// # use stickslip_dynamics::SpeedProfile;
    /// let ramp = SpeedProfile::new(vec![[1.0, 0.0], [2.0, 0.02]]).unwrap();
    /// assert_eq!([0.0, 1.5, 9.0].map(|time| ramp.at(time)), [0.0, 0.01, 0.02]);
    /// ```
    pub fn new(knots: Vec<[f64; 2]>) -> Option<Self> {
        let finite = knots.as_flattened().iter().all(|x| x.is_finite());
        let sorted = knots.windows(2).all(|pair| pair[0][0] <= pair[1][0]);
        (finite && sorted && !knots.is_empty()).then_some(Self { knots })
    }

    /// Knots of time (s) and speed (m/s).
    pub fn knots(&self) -> &[[f64; 2]] {
        &self.knots
    }

    /// Speed at `time` (m/s); at a jump the later one.
    pub fn at(&self, time: f64) -> f64 {
        let after = self.knots.partition_point(|knot| knot[0] <= time);
        match (after.checked_sub(1), self.knots.get(after)) {
            (Some(before), Some(next)) => between(self.knots[before], *next, time),
            (Some(last), None) => self.knots[last][1],
            (None, _) => self.knots[0][1],
        }
    }

    /// Way travelled from time 0 to `time` ≥ 0 (m).
    pub fn travel(&self, time: f64) -> f64 {
        let inner = self
            .knots
            .iter()
            .map(|knot| knot[0])
            .filter(|t| 0.0 < *t && *t < time);
        let ends: Vec<f64> = [0.0].into_iter().chain(inner).chain([time]).collect();
        let middle = |pair: &[f64]| self.at(0.5 * (pair[0] + pair[1])) * (pair[1] - pair[0]);
        ends.windows(2).map(middle).fold(0.0, |sum, way| sum + way)
    }
}

/// Linear between two knots of different times.
fn between(from: [f64; 2], to: [f64; 2], time: f64) -> f64 {
    from[1] + (to[1] - from[1]) * (time - from[0]) / (to[0] - from[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At rest, a jump to 30 mm/s at 1 s, a ramp down to 10 mm/s at 3 s.
    fn profile() -> SpeedProfile {
        SpeedProfile::new(vec![[1.0, 0.0], [1.0, 0.03], [3.0, 0.01]]).expect("a profile")
    }

    #[test]
    fn at_jumps_and_holds() {
        let speeds = [0.0, 0.999, 1.0, 2.0, 3.0, 99.0].map(|time| profile().at(time));
        assert_eq!(speeds, [0.0, 0.0, 0.03, 0.02, 0.01, 0.01]);
    }

    #[test]
    fn travel_is_the_area_under_the_speed() {
        for (time, way) in [
            (0.0, 0.0),
            (1.0, 0.0),
            (2.0, 0.025),
            (3.0, 0.04),
            (5.0, 0.06),
        ] {
            assert!((profile().travel(time) - way).abs() < 1e-15, "{time}");
        }
        assert_eq!(SpeedProfile::constant(0.02).travel(3.0), 0.06);
    }

    #[test]
    fn new_refuses_what_is_no_profile() {
        for knots in [vec![], vec![[0.0, f64::NAN]], vec![[1.0, 0.0], [0.5, 0.0]]] {
            assert_eq!(SpeedProfile::new(knots), None);
        }
    }

    #[test]
    fn fingers_move_along_their_directions() {
        let start = Start {
            object: Pose::default(),
            pusher: Pose::new(1.0, 2.0, 0.5),
            direction: std::f64::consts::FRAC_PI_2,
            other_fingers: vec![(Pose::new(1.0, 9.0, 0.25), -std::f64::consts::FRAC_PI_2)],
            speed: SpeedProfile::constant(0.5),
            duration: 4.0,
        };
        let poses: Vec<Pose> = start.fingers_at(start.speed.travel(2.0)).collect();
        let expected = [Pose::new(1.0, 3.0, 0.5), Pose::new(1.0, 8.0, 0.25)];
        for (pose, expected) in poses.iter().zip(expected) {
            assert!((pose.x - expected.x).abs() < 1e-15, "{poses:?}");
            assert_eq!((pose.y, pose.theta), (expected.y, expected.theta));
        }
        assert_eq!(poses.len(), 2);
    }
}
