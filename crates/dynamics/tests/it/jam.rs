//! A pusher that cannot go on: a drive with a force limit yields, a rigid one is reported as
//! infeasible and bounded.

use crate::common::{FRICTION, at, disc, fixel, pushing, square_scene, step};
use stickslip_dynamics::{
    ContactPoint, Dynamics, Foot, Friction, Outcome, Particle, Pose, Report, Scene, StepProblem,
    StepSolution, StepWork, TOLERANCE, Twist, solve, solve_from,
};
use stickslip_testkit::{
    enumerate_modes, gap_margin, is_sought, may_jam, residual_si, speed_limit,
};

const H: f64 = 0.01;
const SPEED: f64 = 0.02;

/// Compliance of the gap rows where there is no rigid solution (docs/method.md (14)).
const COMPLIANCE: f64 = 1e-6;

/// The square with two fixels that touch its face, symmetrically; a disc pushes it against them
/// along x.
fn dead_end(stall_force: Option<f64>, friction: f64) -> Scene {
    let mut scene = square_scene(vec![
        fixel(disc(0.005), 0.030, 0.015),
        fixel(disc(0.005), 0.030, -0.015),
    ]);
    scene.pusher.stall_force = stall_force;
    scene.nominal = Friction {
        mu_p: friction,
        mu_f: friction,
        ..FRICTION
    };
    scene
}

/// A disc between two fixels that let only a smaller one through.
fn bottleneck(stall_force: Option<f64>) -> Scene {
    let mut scene = square_scene(vec![
        fixel(disc(0.005), 0.02, 0.026),
        fixel(disc(0.005), 0.02, -0.026),
    ]);
    scene.object.shape = disc(0.025);
    scene.pusher.stall_force = stall_force;
    scene
}

/// The impulse with which the object resists the pusher along +x [N s].
fn resistance(work: &StepWork<1>, solution: &StepSolution) -> f64 {
    let impulses = solution.normal.iter().zip(&solution.tangential);
    let contacts = work.problem(0).contacts;
    let contacts = contacts.iter().zip(impulses);
    let on_pusher = contacts.filter(|(c, _)| c.yields.is_some());
    on_pusher
        .map(|(c, (p_n, p_t))| p_n * c.normal[0] - p_t * c.normal[1])
        .sum()
}

/// Pushes for `steps`, the pusher moving by what it does not yield; returns the yields.
fn push_with_stall(scene: Scene, x: f64, y: f64, steps: u32) -> (Vec<f64>, Particle) {
    let limit = scene.pusher.stall_force.expect("a stall force") * H;
    let (dynamics, mut particle, mut work) = (
        Dynamics::new(scene),
        Particle::default(),
        StepWork::default(),
    );
    let (mut x, mut yields) = (x, vec![]);
    for k in 0..steps {
        let report = step(
            &dynamics,
            &pushing(H, x, y, SPEED),
            &mut particle,
            &mut work,
        );
        assert_eq!(report.outcome, Outcome::Solved, "step {k}");
        let solution = work.solution(0);
        let residual = residual_si(&work.problem(0), &solution);
        assert!(
            residual <= TOLERANCE * 1.001,
            "step {k}: residual {residual:e}"
        );
        let (force, slip) = (resistance(&work, &solution), solution.pusher_yield);
        assert!(
            force <= limit * (1.0 + 1e-9),
            "step {k}: {force} N s, at most {limit}"
        );
        assert!(
            slip <= TOLERANCE || (force / limit - 1.0).abs() < 1e-6,
            "step {k}: it yields {slip} m/s at {force} N s"
        );
        x += H * (SPEED - slip);
        yields.push(slip);
    }
    (yields, particle)
}

#[test]
fn pusher_with_a_stall_force_yields_all_its_speed_in_a_dead_end() {
    for friction in [0.0, 0.3] {
        let (yields, particle) = push_with_stall(dead_end(Some(5.0), friction), -0.0304, 0.003, 60);
        assert!(
            yields[0] <= TOLERANCE,
            "it has not touched yet, but yields {}",
            yields[0]
        );
        assert!(
            (yields[59] - SPEED).abs() < 1e-8,
            "it should stand, but yields {} m/s",
            yields[59]
        );
        let q = particle.pose;
        assert!(
            q.x.abs() < 1e-9 && q.y.abs() < 1e-9 && q.theta.abs() < 1e-8,
            "the object should stay: {q:?}"
        );
    }
}

#[test]
fn pusher_with_a_stall_force_yields_once_a_disc_is_caught_in_a_bottleneck() {
    let (yields, particle) = push_with_stall(bottleneck(Some(5.0)), -0.0304, 0.0, 150);
    assert!(
        yields.iter().take(10).all(|y| *y <= TOLERANCE),
        "the way is free at first"
    );
    assert!(
        (yields[149] - SPEED).abs() < 1e-8,
        "it should stand, but yields {} m/s",
        yields[149]
    );
    // The discs' centres are 30 mm apart where they touch, of which 26 mm are across.
    let caught = 0.02 - libm::sqrt(0.030 * 0.030 - 0.026 * 0.026);
    assert!(
        (particle.pose.x - caught).abs() < 1e-6,
        "caught at {}, expected {caught}",
        particle.pose.x
    );
}

#[test]
fn pusher_that_stalls_below_the_support_friction_does_not_move_the_object() {
    let scene = Scene {
        fixels: vec![],
        ..dead_end(Some(0.9 * 0.3 * 0.5 * 9.81), 0.3)
    };
    let (yields, particle) = push_with_stall(scene, -0.030, 0.0, 60);
    assert!(
        yields.iter().all(|y| (y - SPEED).abs() < 1e-8),
        "it should stand"
    );
    assert_eq!(particle.pose, Pose::default());
}

/// One step of a rigid pusher; checks the properties of every infeasible step.
fn infeasible_step(
    dynamics: &Dynamics,
    x: f64,
    y: f64,
    particle: &mut Particle,
    work: &mut StepWork<1>,
) -> Report {
    let report = step(dynamics, &pushing(H, x, y, SPEED), particle, work);
    assert_eq!(report.outcome, Outcome::Infeasible);
    let (problem, solution) = (&work.problem(0), work.solution(0));
    assert!(
        may_jam(problem) || gap_margin(problem, 1.0) < 0.0,
        "it has a solution"
    );
    let residual = residual_si(problem, &solution);
    assert!(
        (report.residual / residual - 1.0).abs() < 1e-9,
        "{} reported, {residual} of the rigid rows",
        report.residual
    );
    assert!(
        report.residual > TOLERANCE
            && particle.pose.is_finite()
            && particle.warm.fields().into_iter().all(|x| x.is_finite())
    );
    report
}

#[test]
fn rigid_pusher_into_a_dead_end_is_infeasible_and_the_compliance_shares_the_squeeze() {
    for friction in [0.0, 0.3] {
        let dynamics = Dynamics::new(dead_end(None, friction));
        let (mut particle, mut work) = (Particle::default(), StepWork::default());
        let report = infeasible_step(&dynamics, -0.030, 0.0, &mut particle, &mut work);
        assert!(
            enumerate_modes(&work.problem(0)).is_empty(),
            "every contact mode is excluded"
        );
        // κ p/m = u − v at the pusher, κ p/(2 m) = v at each of two fixels, so v = u/3; the support
        // carries a share of about κ.
        let v = particle.twist;
        assert!(
            (v.vx - SPEED / 3.0).abs() < 2.0 * COMPLIANCE
                && v.vy.abs() < 1e-8
                && v.omega.abs() < 1e-6,
            "{v:?}"
        );
        assert!(
            (report.residual - 2.0 / 3.0 * SPEED).abs() < 2.0 * COMPLIANCE,
            "{}",
            report.residual
        );
    }
}

#[test]
fn rigid_pusher_that_goes_on_into_a_dead_end_stays_infeasible_and_the_object_between() {
    let dynamics = Dynamics::new(dead_end(None, 0.3));
    let (mut particle, mut work) = (Particle::default(), StepWork::default());
    for k in 0..30 {
        let _ = infeasible_step(
            &dynamics,
            -0.030 + SPEED * H * f64::from(k),
            0.0,
            &mut particle,
            &mut work,
        );
        // Pushed in by a third of the overlap, again after each step.
        let q = particle.pose;
        assert!(
            (-1e-6..=SPEED * H * f64::from(k + 1)).contains(&q.x)
                && q.y.abs() < 1e-6
                && q.theta.abs() < 1e-4,
            "step {k}: {q:?}"
        );
    }
}

#[test]
fn rigid_pusher_and_a_disc_in_a_bottleneck_go_from_solved_to_infeasible() {
    let dynamics = Dynamics::new(bottleneck(None));
    let (mut particle, mut work) = (Particle::default(), StepWork::default());
    let mut outcomes = vec![];
    for k in 0..60 {
        let report = step(
            &dynamics,
            &pushing(H, -0.0304 + SPEED * H * f64::from(k), 0.0, SPEED),
            &mut particle,
            &mut work,
        );
        assert!(particle.pose.is_finite() && report.residual.is_finite());
        outcomes.push(report.outcome);
    }
    let free = outcomes
        .iter()
        .take_while(|o| **o == Outcome::Solved)
        .count();
    // It is caught after 5.03 mm of its way, of which the pusher needs 0.4 mm to reach it: 27 steps
    // of 0.2 mm.
    assert!((25..=28).contains(&free), "caught in step {free}");
    assert!(
        outcomes[free + 1..]
            .iter()
            .all(|o| *o == Outcome::Infeasible),
        "{outcomes:?}"
    );
}

/// The square between two fixels whose gaps to its faces are `left` and `right`.
fn between(left: f64, right: f64) -> Scene {
    square_scene(vec![
        fixel(disc(0.005), -0.030 - left, 0.0),
        fixel(disc(0.005), 0.030 + right, 0.0),
    ])
}

#[test]
fn fixels_that_overlap_the_object_from_two_sides_are_infeasible_and_share_the_overlap() {
    for (left, right) in [
        (-1e-4, -1e-4),
        (-3e-4, -1e-4),
        (-1e-5, -5e-4),
        (-2e-4, 1e-4),
    ] {
        let (dynamics, mut particle, mut work) = (
            Dynamics::new(between(left, right)),
            at(Pose::default()),
            StepWork::default(),
        );
        let report = step(
            &dynamics,
            &pushing(H, -1.0, 0.0, 0.0),
            &mut particle,
            &mut work,
        );
        assert_eq!(report.outcome, Outcome::Infeasible, "{left} {right}");
        let residual = residual_si(&work.problem(0), &work.solution(0));
        assert!(
            (report.residual / residual - 1.0).abs() < 1e-9,
            "{} reported, {residual} of the rigid rows",
            report.residual
        );
        // Equal forces: both gaps end up equal.
        let v = (right - left) / (2.0 * H);
        let Twist { vx, vy, omega } = particle.twist;
        assert!(
            (vx - v).abs() < 2.0 * COMPLIANCE && vy.abs() < 1e-8 && omega.abs() < 1e-6,
            "{left} {right}: {:?}",
            particle.twist
        );
    }
}

#[test]
fn fixel_that_overlaps_from_one_side_is_solved_and_pushes_the_object_out() {
    let (dynamics, mut particle, mut work) = (
        Dynamics::new(between(-1e-4, 2e-4)),
        at(Pose::default()),
        StepWork::default(),
    );
    let report = step(
        &dynamics,
        &pushing(H, -1.0, 0.0, 0.0),
        &mut particle,
        &mut work,
    );
    assert_eq!(report.outcome, Outcome::Solved);
    assert!(
        (particle.pose.x - 1e-4).abs() < 1e-11,
        "{:?}",
        particle.pose
    );
}

#[test]
fn rigid_pusher_that_creeps_on_by_less_than_a_nanometre_stands() {
    let dynamics = Dynamics::new(dead_end(None, 0.3));
    for (way, outcome) in [(0.9e-9, Outcome::Solved), (5e-9, Outcome::Infeasible)] {
        let (mut particle, mut work) = (Particle::default(), StepWork::default());
        let creeps = pushing(H, -0.030, 0.003, way / H);
        let report = step(&dynamics, &creeps, &mut particle, &mut work);
        assert_eq!(report.outcome, outcome, "{way} m");
        if outcome == Outcome::Solved {
            assert_eq!(particle.twist, Twist::default());
        }
    }
}

/// A body of 1 kg at 0.5 m/s between two walls, on feet that resist it with 0.3 N s.
fn between_walls(mu: f64) -> StepProblem {
    let wall = |sign: f64| ContactPoint {
        normal: [sign, 0.0],
        arm: [-sign, 0.0],
        gap: 0.0,
        surface_velocity: [0.0; 2],
        mu,
        yields: None,
    };
    let arms = [[0.0, 0.5], [0.4, -0.3], [-0.4, -0.3]];
    StepProblem {
        mass: 1.0,
        inertia: 1.0,
        h: 1.0,
        twist: Twist {
            vx: 0.5,
            ..Twist::default()
        },
        contacts: vec![wall(1.0), wall(-1.0)],
        feet: arms.map(|arm| Foot { arm, bound: 0.1 }),
        ..StepProblem::default()
    }
}

#[test]
fn impulses_that_cancel_each_other_are_not_kept() {
    for mu in [0.0, 0.7] {
        let problem = between_walls(mu);
        let start = StepSolution {
            normal: vec![1e7, 1e7],
            tangential: vec![0.0; 2],
            ..StepSolution::default()
        };
        let (solution, report) = solve_from(&problem, &start);
        assert_eq!(report.outcome, Outcome::Solved);
        assert!(residual_si(&problem, &solution) <= TOLERANCE);
        // nothing pushes but the body's momentum, and the feet
        assert!(
            solution.normal.iter().all(|p| *p <= 0.5 + 0.3),
            "{:?}",
            solution.normal
        );
    }
}

/// An object between a fixel's face and that of a pusher that closes at `u`, the two at an angle,
/// without friction: it leaves at u/tan(angle).
fn squeezed(u: f64, angle: f64) -> (StepProblem, f64) {
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let contact = |normal: [f64; 2], surface_velocity, yields| ContactPoint {
        normal,
        // through the centre of mass: no torque
        arm: normal.map(|n| -0.02 * n),
        gap: 0.0,
        mu: 0.0,
        surface_velocity,
        yields,
    };
    let problem = StepProblem {
        mass: 1.0,
        inertia: 1e-4,
        h: H,
        contacts: vec![
            contact([1.0, 0.0], [0.0; 2], None),
            contact([-cos, sin], [-u, 0.0], Some([-1.0, 0.0])),
        ],
        ..StepProblem::default()
    };
    (problem, u * cos / sin)
}

#[test]
fn object_is_squeezed_out_thirty_times_as_fast_as_the_faces_close_and_no_faster() {
    let u = 0.1;
    let (problem, speed) = squeezed(u, 2.2_f64.to_radians());
    let (solution, report) = solve(&problem);
    assert_eq!(report.outcome, Outcome::Solved);
    assert!(
        (solution.twist.vy / speed - 1.0).abs() < 1e-7,
        "{solution:?}"
    );
    assert!(is_sought(&problem, &solution));

    let (problem, speed) = squeezed(u, 1.6_f64.to_radians());
    assert!(speed > speed_limit(&problem));
    let (solution, report) = solve(&problem);
    assert_eq!(report.outcome, Outcome::Infeasible);
    assert!(is_sought(&problem, &solution), "{solution:?}");
}
