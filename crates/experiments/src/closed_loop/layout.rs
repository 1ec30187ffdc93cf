//! Layout of the bodies of a random scene: [`Layout`].

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use stickslip_dynamics::{Fixel, Part, Pose, Shape};

use super::placement::{Side, Standing};
use super::scene_kind::SceneKind;
use super::shapes::{self, ObjectShape};
use stickslip_testkit::SplitMix64;

/// Most fixels of a scene.
const MOST_FIXELS: usize = 6;

/// Bodies in the frame in which the push goes along +x and the object's origin starts at 0.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub object: ObjectShape,
    /// Orientation of the object (rad).
    pub theta: f64,
    pub pusher: Shape,
    pub pusher_start: Pose,
    pub fixels: Vec<Fixel>,
    /// Way of the pusher until all that is near the object touches, if it goes straight (m).
    pub way: f64,
}

/// A layout in the making.
struct Arranger<'r> {
    rng: &'r mut SplitMix64,
    object: ObjectShape,
    theta: f64,
    /// Way of the object until it meets the fixels (m).
    way: f64,
    fixels: Vec<Fixel>,
}

impl Layout {
    /// A layout of this kind, for fixels of friction `mu_f`.
    pub fn draw(rng: &mut SplitMix64, kind: SceneKind, mu_f: f64) -> Self {
        let object = match kind {
            SceneKind::FaceToFace | SceneKind::Corner => shapes::polygonal_object(rng),
            _ => shapes::object(rng),
        };
        let theta = orientation(rng, kind, &object.shape);
        let way = if rng.one_in(4) {
            0.0
        } else {
            rng.log_within(1e-4, 20e-3)
        };
        let (pusher, pusher_start, clearance) = place_pusher(rng, kind, &object.shape, theta);
        let mut arranger = Arranger {
            rng,
            object,
            theta,
            way,
            fixels: Vec::new(),
        };
        arranger.arrange(kind, mu_f);
        arranger.add_bystanders();
        arranger.drop_overlapping();
        let Arranger {
            object,
            fixels,
            way,
            ..
        } = arranger;
        Self {
            object,
            theta,
            pusher,
            pusher_start,
            fixels,
            way: way + clearance,
        }
    }
}

/// The object's orientation (rad): a face to the pusher, a corner ahead, or any.
fn orientation(rng: &mut SplitMix64, kind: SceneKind, shape: &Shape) -> f64 {
    match (kind, &shape.parts()[0]) {
        (SceneKind::FaceToFace, Part::Polygon { vertices }) => {
            let k = rng.below(vertices.len());
            let (a, b) = (vertices[k], vertices[(k + 1) % vertices.len()]);
            // the outward normal is the edge turned by -90 degrees
            PI - libm::atan2(a[0] - b[0], b[1] - a[1])
        }
        (SceneKind::Corner, Part::Polygon { vertices }) => {
            let [x, y] = vertices[rng.below(vertices.len())];
            -libm::atan2(y, x)
        }
        _ => match rng.below(3) {
            0 => FRAC_PI_2 * rng.below(4) as f64,
            _ => rng.within(-PI, PI),
        },
    }
}

/// The pusher behind the object, and its distance from it (m).
fn place_pusher(
    rng: &mut SplitMix64,
    kind: SceneKind,
    object: &Shape,
    theta: f64,
) -> (Shape, Pose, f64) {
    let pose = Pose::new(0.0, 0.0, theta);
    let standing = Standing {
        shape: object,
        pose,
    };
    let half_width = standing.reach([0.0, 1.0]).min(standing.reach([0.0, -1.0]));
    let share = match kind {
        SceneKind::FaceToFace => rng.within(-0.3, 0.3),
        SceneKind::Corner => rng.sign() * rng.log_within(1e-4, 0.3),
        SceneKind::Pivot => 0.7,
        _ => rng.within(-0.8, 0.8),
    };
    let (shape, tilt) = match kind {
        SceneKind::FaceToFace => (shapes::bar(rng), 0.0),
        SceneKind::Corner if rng.one_in(2) => (shapes::wedge(rng), 0.0),
        _ => (shapes::pusher(rng), rng.within(-0.3, 0.3)),
    };
    let tilt = if rng.one_in(3) { 0.0 } else { tilt };
    let clearance = if rng.one_in(3) {
        0.0
    } else {
        rng.log_within(1e-5, 3e-3)
    };
    // the direction to the pusher is -x: a lateral shift to the left of it is one to -y
    let side = Side::at(PI, -share * half_width, clearance);
    let start = standing.beside(&shape, tilt, &side);
    (shape, start, clearance)
}

impl Arranger<'_> {
    fn arrange(&mut self, kind: SceneKind, mu_f: f64) {
        match kind {
            SceneKind::Graze => self.graze(),
            SceneKind::Stop => self.stop(),
            SceneKind::Pivot => self.pivot(),
            SceneKind::Wedge => self.wedge(mu_f),
            SceneKind::Corridor => self.corridor(),
            SceneKind::Slot => self.slot(),
            SceneKind::FormClosure => self.form_closure(),
            SceneKind::FaceToFace => self.face_to_face(),
            SceneKind::Corner => self.corner(),
            SceneKind::Clutter => self.clutter(),
        }
    }

    /// The object where it will have gone.
    fn ahead(&self) -> Standing<'_> {
        Standing {
            shape: &self.object.shape,
            pose: Pose::new(self.way, 0.0, self.theta),
        }
    }

    fn radius(&self) -> f64 {
        self.object.shape.bounding_radius()
    }

    fn add(&mut self, shape: Shape, theta: f64, side: &Side) {
        let pose = self.ahead().beside(&shape, theta, side);
        self.fixels.push(Fixel { pose, shape });
    }

    /// A fixel of any shape and orientation in direction `angle` (rad).
    fn add_any(&mut self, angle: f64, lateral: f64, clearance: f64) {
        let shape = shapes::fixel(self.rng);
        let theta = if self.rng.one_in(3) {
            0.0
        } else {
            self.rng.within(-PI, PI)
        };
        self.add(shape, theta, &Side::at(angle, lateral, clearance));
    }

    /// Mostly a touch, else up to `most` metres.
    fn small_clearance(&mut self, most: f64) -> f64 {
        if self.rng.one_in(3) {
            0.0
        } else {
            self.rng.log_within(1e-6, most)
        }
    }

    fn graze(&mut self) {
        let angle = self.rng.sign() * self.rng.within(0.9, 1.7);
        let clearance = self.small_clearance(1e-3);
        self.add_any(angle, 0.0, clearance);
    }

    fn stop(&mut self) {
        let half = 0.6 * self.radius();
        for _ in 0..=self.rng.below(2) {
            let (angle, lateral) = (self.rng.within(-0.4, 0.4), self.rng.within(-half, half));
            self.add_any(angle, lateral, 0.0);
        }
    }

    /// The pusher is on the side of +y.
    fn pivot(&mut self) {
        let half_width = self.ahead().reach([0.0, -1.0]);
        let lateral = -self.rng.within(0.5, 0.95) * half_width;
        self.add_any(0.0, lateral, 0.0);
        if self.rng.one_in(2) {
            let clearance = self.small_clearance(2e-3);
            let angle = self.rng.within(0.5, 2.0);
            self.add_any(angle, 0.0, clearance);
        }
    }

    /// Normals at the angle of friction to the way across, or at 0.4 to 1.6 times that.
    fn wedge(&mut self, mu_f: f64) {
        let share = if self.rng.one_in(4) {
            1.0
        } else {
            self.rng.within(0.4, 1.6)
        };
        let slope = (libm::atan(mu_f) * share).clamp(0.02, 1.3);
        let walls = self.rng.one_in(2);
        for sign in [1.0, -1.0] {
            let side = Side::at(sign * (FRAC_PI_2 - slope), 0.0, 0.0);
            if walls {
                let wall = self.wall();
                self.add(wall, -sign * slope, &side);
            } else {
                let radius = self.rng.log_within(2e-3, 15e-3);
                self.add(shapes::round(radius), 0.0, &side);
            }
        }
        if self.rng.one_in(3) {
            let clearance = self.small_clearance(2e-3);
            self.add_any(0.0, 0.0, clearance);
        }
    }

    /// A wall along x that is longer than the object.
    fn wall(&mut self) -> Shape {
        let length = self.radius() * self.rng.within(2.5, 5.0);
        shapes::rectangle(length, self.rng.within(5e-3, 15e-3))
    }

    fn corridor(&mut self) {
        for sign in [1.0, -1.0] {
            let clearance = self.small_clearance(2e-3);
            let wall = self.wall();
            self.add(wall, 0.0, &Side::at(sign * FRAC_PI_2, 0.0, clearance));
        }
        if self.rng.one_in(2) {
            let lateral = self.radius() * self.rng.within(-0.5, 0.5);
            self.add_any(0.0, lateral, 0.0);
        }
    }

    /// The mouth is as far ahead as the object will go, and narrower than the object.
    fn slot(&mut self) {
        let tight = 0.5 * self.rng.log_within(1e-5, 2e-3);
        let front = self.way + self.ahead().reach([1.0, 0.0]);
        let round_mouth = self.rng.one_in(2);
        for sign in [1.0, -1.0] {
            let inner = self.ahead().reach([0.0, sign]) - tight;
            let (shape, x, y) = if round_mouth {
                let radius = self.rng.log_within(2e-3, 15e-3);
                (shapes::round(radius), radius, radius)
            } else {
                let (length, width) = (2.0 * self.radius(), self.rng.within(5e-3, 15e-3));
                (shapes::rectangle(length, width), length / 2.0, width / 2.0)
            };
            let pose = Pose::new(front + x, sign * (inner + y), 0.0);
            self.fixels.push(Fixel { pose, shape });
        }
    }

    /// Around the object where it starts, so that it is held from the first frame on.
    fn form_closure(&mut self) {
        self.way = 0.0;
        let count = 3 + self.rng.below(MOST_FIXELS - 2);
        let first = self.rng.within(-PI, PI);
        for k in 0..count {
            let angle = first + (k as f64 + self.rng.within(-0.3, 0.3)) * TAU / count as f64;
            let clearance = self.small_clearance(5e-4);
            self.add_any(angle, 0.0, clearance);
        }
    }

    fn face_to_face(&mut self) {
        let width = self.radius() * self.rng.within(0.5, 3.0);
        let wall = shapes::rectangle(10e-3, width);
        if self.rng.one_in(2) {
            self.add(wall, 0.0, &Side::at(0.0, 0.0, 0.0));
            return;
        }
        // two walls in one line
        for sign in [1.0, -1.0] {
            let lateral = sign * 0.55 * width;
            self.add(wall.clone(), 0.0, &Side::at(0.0, lateral, 0.0));
        }
    }

    fn corner(&mut self) {
        let lateral = self.rng.sign() * self.rng.log_within(1e-7, 2e-3);
        let shape = shapes::small_polygon(self.rng);
        self.add(shape, PI, &Side::at(0.0, lateral, 0.0));
        if self.rng.one_in(2) {
            let angle = self.rng.sign() * self.rng.within(0.5, 1.5);
            self.add_any(angle, 0.0, 0.0);
        }
    }

    fn clutter(&mut self) {
        let half = self.radius();
        for _ in 0..=self.rng.below(MOST_FIXELS) {
            let (angle, lateral) = (self.rng.within(-2.2, 2.2), self.rng.within(-half, half));
            let clearance = self.small_clearance(10e-3);
            self.add_any(angle, lateral, clearance);
        }
    }

    /// Fixels farther away, so that most scenes have some that come into play late or never.
    fn add_bystanders(&mut self) {
        let room = MOST_FIXELS.saturating_sub(self.fixels.len());
        if room == 0 || !self.rng.one_in(3) {
            return;
        }
        for _ in 0..=self.rng.below(room) {
            let angle = self.rng.within(-PI, PI);
            let clearance = self.rng.log_within(3e-3, 50e-3);
            self.add_any(angle, 0.0, clearance);
        }
    }
    /// Fixels that the object would overlap where it starts.
    fn drop_overlapping(&mut self) {
        let start = Standing {
            shape: &self.object.shape,
            pose: Pose::new(0.0, 0.0, self.theta),
        };
        self.fixels
            .retain(|fixel| !start.overlaps(&fixel.shape, fixel.pose));
    }
}
