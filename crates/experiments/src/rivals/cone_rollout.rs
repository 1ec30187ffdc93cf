//! The nominal simulation with either support friction: [`ConeRollout`].

use std::time::Instant;

use stickslip::dynamics::{Dynamics, Outcome, Particle, Pose, StepInput, StepWork, Twist};
use stickslip::{NominalPredictor, Setup, wrapped};

use super::lemke::LemkeEnd;
use super::polygon_cone::PolygonCone;

/// A blind simulation of one log from its first object pose, with its steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConeRollout {
    /// Pose at the end.
    pub end: Pose,
    /// Unknowns of each step's problem.
    pub unknowns: Vec<f64>,
    /// Time of each step in which the object moves (s): with the quadratic cone the whole step of
    /// `Dynamics` for one particle, with polygons to state and solve the problem.
    pub seconds: Vec<f64>,
    /// Steps.
    pub steps: usize,
    /// Steps whose rigid problem has no solution: proven for the quadratic cone, a ray of Lemke's
    /// method for polygons.
    pub infeasible: usize,
    /// Steps whose rigid problem was given up.
    pub failed: usize,
    /// Steps with polygons in which the object rests, since no compliant problem was solved.
    pub rests: usize,
}

impl ConeRollout {
    /// Simulates a log with polygons, or with the quadratic cone of `Dynamics`.
    #[must_use]
    pub fn new(setup: &Setup, predictor: &NominalPredictor, cone: Option<PolygonCone>) -> Self {
        let mut stepper = Stepper::new(Dynamics::new(setup.scene.clone()), cone);
        let mut particle = Particle {
            pose: predictor.start,
            ..Particle::default()
        };
        for row in predictor.first..predictor.rows() - 1 {
            particle.limit_pusher_lag(setup.most_pusher_lag());
            for input in predictor.schedule().step(row) {
                particle = stepper.step(input, particle);
            }
        }
        stepper.rollout.end = particle.pose;
        stepper.rollout
    }

    /// Distance of the two ends (m): √(Δx² + Δy² + r² Δθ²) with a radius r (m).
    #[must_use]
    pub fn distance(&self, other: &Self, radius: f64) -> f64 {
        let (a, b) = (self.end, other.end);
        let turn = radius * wrapped(a.theta - b.theta);
        libm::hypot(libm::hypot(a.x - b.x, a.y - b.y), turn)
    }
}

/// One simulation so far.
struct Stepper {
    dynamics: Dynamics,
    work: StepWork<1>,
    cone: Option<PolygonCone>,
    rollout: ConeRollout,
}

impl Stepper {
    fn new(dynamics: Dynamics, cone: Option<PolygonCone>) -> Self {
        Self {
            dynamics,
            work: StepWork::default(),
            cone,
            rollout: ConeRollout::default(),
        }
    }

    /// One step. The gaps, normals and stall direction are those of `Dynamics` in either case.
    fn step(&mut self, input: &StepInput, particle: Particle) -> Particle {
        let mut next = [particle];
        let friction = [self.dynamics.scene().nominal];
        let (work, rollout) = (&mut self.work, &mut self.rollout);
        let began = Instant::now();
        let [report] = self.dynamics.step(input, &friction, &mut next, work);
        let mut seconds = began.elapsed().as_secs_f64();
        let problem = work.problem(0);
        // twist, two impulses a contact, two a foot, y
        let stall = usize::from(problem.stall.is_some());
        let mut unknowns = 3 + 2 * problem.contacts.len() + 2 * problem.feet.len() + stall;
        let mut ended =
            [Outcome::Infeasible, Outcome::Failed].map(|outcome| report.outcome == outcome);

        if let Some(cone) = self.cone {
            let began = Instant::now();
            let step = cone.step(&problem);
            seconds = began.elapsed().as_secs_f64();
            unknowns = step.unknowns;
            ended = [LemkeEnd::Ray, LemkeEnd::Inexact].map(|end| step.rigid == end);
            rollout.rests += usize::from(step.rests);
            let mut yields = problem.contacts.iter().filter_map(|contact| contact.yields);
            let direction = yields.next().filter(|_| problem.stall.is_some());
            let direction = direction.unwrap_or_default();
            next[0].pose = particle.pose.advance(step.twist, input.h);
            next[0].twist = step.twist;
            next[0].pusher_lag[0] = direction.map(|d| d * step.pusher_yield * input.h);
        }
        rollout.steps += 1;
        rollout.infeasible += usize::from(ended[0]);
        rollout.failed += usize::from(ended[1]);
        rollout.unknowns.push(unknowns as f64);
        if next[0].twist != Twist::default() {
            rollout.seconds.push(seconds);
        }
        next[0]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use stickslip::dynamics::Wrench;
    use stickslip_testkit::{Block, disc, pushed_scene, square};

    use super::*;

    /// A block that slides without contacts loses at most μ g h a step, with a corner ahead, and at
    /// least cos(π/n) of it, with the middle of a side ahead.
    #[test]
    fn polygons_brake_a_sliding_block_between_their_two_radii() {
        let block = Block {
            mass: 0.7,
            inertia: 4e-4,
            h: 0.01,
            mu_s: 0.4,
            gravity: 9.81,
            d_tri: 0.02,
        };
        for sides in [4, 6, 8, 16] {
            let cone = PolygonCone { sides, turn: 0.0 };
            let lost = |angle: f64| {
                let (sin, cos) = libm::sincos(angle);
                let twist = Twist {
                    vx: 0.3 * cos,
                    vy: 0.3 * sin,
                    omega: 0.0,
                };
                let step = cone.step(&block.problem(twist, Wrench::default()));
                assert!(step.rigid.solution().is_some());
                (0.3 - (step.twist.vx * cos + step.twist.vy * sin)) / block.slide_loss()
            };
            let (half_side, least) = (PI / sides as f64, libm::cos(PI / sides as f64));
            for k in 0..50 {
                let share = lost(TAU * f64::from(k) / 50.0);
                assert!(
                    share > least - 1e-9 && share < 1.0 + 1e-9,
                    "{sides}, {k}: {share}"
                );
            }
            assert!(
                (lost(2.0 * half_side) - 1.0).abs() < 1e-9,
                "a corner, {sides}"
            );
            assert!((lost(half_side) - least).abs() < 1e-9, "a side, {sides}");
        }
    }

    /// End of a square that slides and spins to rest without contacts.
    fn slid(cone: Option<PolygonCone>) -> Pose {
        let scene = pushed_scene(square(0.05), disc(0.005), vec![]);
        let mut stepper = Stepper::new(Dynamics::new(scene), cone);
        let twist = Twist {
            vx: 0.4,
            vy: 0.13,
            omega: 3.0,
        };
        let mut particle = Particle {
            twist,
            ..Particle::default()
        };
        let input = StepInput {
            h: 0.01,
            pusher: None,
        };
        for _ in 0..60 {
            particle = stepper.step(&input, particle);
        }
        let rollout = stepper.rollout;
        assert_eq!(rollout.infeasible + rollout.failed, 0);
        assert_eq!(particle.twist, Twist::default(), "it has come to rest");
        particle.pose
    }

    /// The way differs from that of `Dynamics` by less than 5 % for 16 sides, and by less than a
    /// quarter of that for 64.
    #[test]
    fn many_sides_slide_as_the_disc() {
        let disc = slid(None);
        let way = libm::hypot(disc.x, disc.y);
        assert!(way > 0.02);
        let share_off = |sides| {
            let pose = slid(Some(PolygonCone { sides, turn: 0.0 }));
            libm::hypot(pose.x - disc.x, pose.y - disc.y) / way
        };
        let [few, many] = [16, 64].map(share_off);
        assert!(few < 0.05 && few > 1e-4, "{few}");
        assert!(many < few / 4.0, "{many} of {few}");
    }
}
