//! Friction between object and table: [`SupportFriction`], bristles under every point of the face.
//!
//! Each point drags a bristle along the table. Per unit of load it pulls with κ z + γ s, where z is
//! its stretch and s the point's slip velocity, and with at most μ(x, y) φ(|s|). A bristle whose κ
//! z reaches that limit slips: z stops growing and aligns with s.

use stickslip_dynamics::{Pose, Scene, Twist, Wrench};

use super::pressure::SupportPoint;
use super::table_friction::FrictionField;

/// Travel of the object after which the table's friction is looked up again (m).
const REFRESH: f64 = 3e-4;

/// Points side by side.
const LANES: usize = 8;

type Lanes = [f64; LANES];

/// Stiffness and damping of the bristles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bristles {
    /// Stretch at which they slip (m).
    pub give: f64,
    /// Damping ratio of the object on its bristles.
    pub damping_ratio: f64,
}

impl Default for Bristles {
    fn default() -> Self {
        Self {
            give: 5e-6,
            damping_ratio: 0.5,
        }
    }
}

/// Bristles under the object.
#[derive(Clone, Debug)]
pub(super) struct SupportFriction {
    table: FrictionField,
    blocks: Vec<Block>,
    law: Law,
    weight: f64,
    /// Pose at which friction was looked up.
    looked_up: Option<Pose>,
    /// Largest distance of a point from the centre of mass (m).
    radius: f64,
}

/// [`LANES`] points of the face; points without load fill the last block.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    /// Position in the object frame (m).
    x: Lanes,
    y: Lanes,
    /// Load (N).
    load: Lanes,
    /// Friction coefficient at the reference speed.
    mu: Lanes,
    /// Pull of the stretched bristle per unit of load, κ z, world frame.
    pull_x: Lanes,
    pull_y: Lanes,
}

/// κ and γ of the bristles.
#[derive(Clone, Copy, Debug)]
struct Law {
    /// κ (1/m).
    stiffness: f64,
    /// γ (s/m).
    damping: f64,
}

/// Motion of the object, with its angle's sine and cosine.
#[derive(Clone, Copy, Debug)]
struct Motion {
    sin: f64,
    cos: f64,
    twist: Twist,
}

impl SupportFriction {
    /// Relaxed bristles at these points of the scene's object.
    pub(super) fn new(
        points: &[SupportPoint],
        table: FrictionField,
        bristles: Bristles,
        scene: &Scene,
    ) -> Self {
        let weight = scene.object.mass * scene.gravity;
        // without friction bristles hold nothing, whatever their stiffness
        let stiffness = (table.mean() / bristles.give).max(1.0);
        let law = Law {
            stiffness,
            damping: 2.0 * bristles.damping_ratio * (stiffness / scene.gravity).sqrt(),
        };
        let block = |points: &[SupportPoint]| {
            let mut block = Block::default();
            for (k, point) in points.iter().enumerate() {
                [block.x[k], block.y[k]] = point.position;
                block.load[k] = point.load * weight;
            }
            block
        };
        let radius = points
            .iter()
            .map(|p| length(p.position))
            .fold(0.0, f64::max);
        Self {
            table,
            blocks: points.chunks(LANES).map(block).collect(),
            law,
            weight,
            looked_up: None,
            radius,
        }
    }

    /// Radius of the tripod with the same torque in pure spin (m): the mean distance of the load
    /// from the centre of mass.
    pub(super) fn tripod_radius(&self) -> f64 {
        self.mean(|point, _| length(point))
    }

    /// Mean friction coefficient under the load at a pose and twist.
    pub(super) fn mean_friction(&self, pose: Pose, twist: &Twist) -> f64 {
        self.mean(|point, table| {
            let [sx, sy] = twist.at(pose.rotate(point));
            table.at(pose.transform(point)) * table.speed_factor(sx * sx + sy * sy)
        })
    }

    /// The mean, by load, over the points in the object frame.
    fn mean(&self, value: impl Fn([f64; 2], &FrictionField) -> f64) -> f64 {
        let points = self
            .blocks
            .iter()
            .flat_map(|block| (0..LANES).map(move |k| ([block.x[k], block.y[k]], block.load[k])));
        points
            .filter(|(_, load)| *load > 0.0)
            .map(|(point, load)| load * value(point, &self.table))
            .fold(0.0, |sum, x| sum + x)
            / self.weight
    }

    /// Advances the bristles by `h` seconds under the moving object; returns their wrench on it.
    pub(super) fn step(&mut self, pose: Pose, twist: &Twist, h: f64) -> Wrench {
        if self.has_moved(pose) {
            self.look_up(pose);
        }
        let (sin, cos) = libm::sincos(pose.theta);
        let motion = Motion {
            sin,
            cos,
            twist: *twist,
        };
        let mut sums = [[0.0; LANES]; 3];
        for block in &mut self.blocks {
            block.step(&motion, &self.law, &self.table, h, &mut sums);
        }
        let [fx, fy, torque] = sums.map(|lanes| -lanes.iter().fold(0.0, |sum, x| sum + x));
        Wrench { fx, fy, torque }
    }

    fn has_moved(&self, pose: Pose) -> bool {
        self.looked_up.is_none_or(|before| {
            let travel = length([pose.x - before.x, pose.y - before.y]);
            travel + self.radius * (pose.theta - before.theta).abs() > REFRESH
        })
    }

    fn look_up(&mut self, pose: Pose) {
        self.looked_up = Some(pose);
        for block in &mut self.blocks {
            block.mu =
                std::array::from_fn(|k| self.table.at(pose.transform([block.x[k], block.y[k]])));
        }
    }
}

impl Block {
    /// One step of the bristles; adds their pull and its moment to `sums`.
    ///
    /// Written line by line over the lanes, with selections for branches, so that it compiles to
    /// SIMD instructions.
    #[inline(always)]
    fn step(
        &mut self,
        motion: &Motion,
        law: &Law,
        table: &FrictionField,
        h: f64,
        sums: &mut [Lanes; 3],
    ) {
        let Motion {
            sin,
            cos,
            twist: Twist { vx, vy, omega },
        } = *motion;
        // arms, slip velocities and friction limits
        let rx = lanes(|k| cos * self.x[k] - sin * self.y[k]);
        let ry = lanes(|k| sin * self.x[k] + cos * self.y[k]);
        let sx = lanes(|k| vx - omega * ry[k]);
        let sy = lanes(|k| vy + omega * rx[k]);
        let limit = lanes(|k| self.mu[k] * table.speed_factor(sx[k] * sx[k] + sy[k] * sy[k]));

        // pull of the bristles: one at its limit slips, and only one that sticks is damped
        let px = lanes(|k| self.pull_x[k] + h * law.stiffness * sx[k]);
        let py = lanes(|k| self.pull_y[k] + h * law.stiffness * sy[k]);
        let excess = lanes(|k| px[k] * px[k] + py[k] * py[k] - limit[k] * limit[k]);
        let damping = lanes(|k| if excess[k] > 0.0 { 0.0 } else { law.damping });
        let tx = lanes(|k| px[k] + damping[k] * sx[k]);
        let ty = lanes(|k| py[k] + damping[k] * sy[k]);
        let size = lanes(|k| (tx[k] * tx[k] + ty[k] * ty[k]).sqrt());
        let scale = lanes(|k| {
            limit[k]
                / if size[k] > limit[k] {
                    size[k]
                } else {
                    limit[k] + f64::MIN_POSITIVE
                }
        });
        let fx = lanes(|k| scale[k] * tx[k]);
        let fy = lanes(|k| scale[k] * ty[k]);
        self.pull_x = lanes(|k| if excess[k] > 0.0 { fx[k] } else { px[k] });
        self.pull_y = lanes(|k| if excess[k] > 0.0 { fy[k] } else { py[k] });

        // sum up force and torque
        sums[0] = lanes(|k| sums[0][k] + self.load[k] * fx[k]);
        sums[1] = lanes(|k| sums[1][k] + self.load[k] * fy[k]);
        sums[2] = lanes(|k| sums[2][k] + self.load[k] * (rx[k] * fy[k] - ry[k] * fx[k]));
    }
}

#[inline(always)]
fn lanes(value: impl Fn(usize) -> f64) -> Lanes {
    std::array::from_fn(value)
}

#[inline(always)]
fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
