//! Particles side by side must not influence each other: any number of lanes, on any vector
//! instructions, gives the same bits.

use crate::common::{FRICTION, Rng, bench_input, bench_scene, disc, fixel, pushing, square_scene};
use stickslip_dynamics::{
    CompiledStep, Dynamics, Friction, Level, Outcome, Particle, Particles, Pose, Report, Route,
    StepInput, StepWork, Twist, Wrench,
};

const PARTICLES: usize = 16;

/// Everything that a step returns of a particle, as bits.
#[derive(Debug, PartialEq)]
struct StepResult {
    numbers: Vec<u64>,
    outcome: Outcome,
    route: Route,
    iterations: u32,
}

fn step_result(particle: &Particle, report: &Report) -> StepResult {
    let (q, v) = (particle.pose, particle.twist);
    let numbers = [q.x, q.y, q.theta, v.vx, v.vy, v.omega, report.residual];
    let bits = numbers
        .iter()
        .chain(particle.warm.fields())
        .map(|x| x.to_bits())
        .collect();
    StepResult {
        numbers: bits,
        outcome: report.outcome,
        route: report.route,
        iterations: report.systems,
    }
}

/// Steps blocks of `W` of the particles through all inputs.
fn run<const W: usize>(
    dynamics: &Dynamics,
    inputs: &[StepInput],
    friction: &[Friction; PARTICLES],
    start: &[Particle; PARTICLES],
) -> Vec<Vec<StepResult>>
where
    StepWork<W>: CompiledStep<W>,
{
    let mut particles = *start;
    let mut works: Vec<StepWork<W>> = (0..PARTICLES / W).map(|_| StepWork::default()).collect();
    let mut all = vec![];
    for input in inputs {
        let (blocks, _) = particles.as_chunks_mut::<W>();
        let (frictions, _) = friction.as_chunks::<W>();
        let mut row = vec![];
        for ((block, friction), work) in blocks.iter_mut().zip(frictions).zip(&mut works) {
            let reports = dynamics.step(input, friction, block, work);
            row.extend(
                block
                    .iter()
                    .zip(&reports)
                    .map(|(particle, report)| step_result(particle, report)),
            );
        }
        all.push(row);
    }
    all
}

/// Steps all particles as one block, whose lanes the solver may pack again.
fn run_as_block<const W: usize>(
    dynamics: &Dynamics,
    inputs: &[StepInput],
    friction: &[Friction; PARTICLES],
    start: &[Particle; PARTICLES],
) -> Vec<Vec<StepResult>>
where
    StepWork<W>: CompiledStep<W>,
{
    let mut chunks = vec![Particles::<W>::default(); PARTICLES / W];
    for (i, (particle, friction)) in start.iter().zip(friction).enumerate() {
        chunks[i / W].set(i % W, particle, friction);
    }
    let mut work = StepWork::default();
    let mut step = |input| {
        dynamics.step_block(input, &mut chunks, &mut work);
        (0..PARTICLES)
            .map(|i| step_result(&chunks[i / W].get(i % W), &work.reports()[i / W][i % W]))
            .collect()
    };
    inputs.iter().map(&mut step).collect()
}

#[track_caller]
fn assert_same(one: &[Vec<StepResult>], many: &[Vec<StepResult>], lanes: usize) {
    for (frame, (one, many)) in one.iter().zip(many).enumerate() {
        for (i, (one, many)) in one.iter().zip(many).enumerate() {
            assert_eq!(one, many, "{lanes} lanes, frame {frame}, particle {i}");
        }
    }
}

/// The baseline's vector instructions and all wider ones that this machine has.
fn levels() -> Vec<Level> {
    let mut levels = vec![Level::new(), Level::baseline()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    levels
}

/// Compares all widths and instruction sets; returns the results of one lane at a time.
fn assert_independent(
    dynamics: &Dynamics,
    inputs: &[StepInput],
    friction: &[Friction; PARTICLES],
    start: &[Particle; PARTICLES],
) -> Vec<StepResult> {
    let one = run::<1>(dynamics, inputs, friction, start);
    assert_same(&one, &run::<2>(dynamics, inputs, friction, start), 2);
    assert_same(
        &one,
        &run_as_block::<1>(dynamics, inputs, friction, start),
        1,
    );
    for level in levels() {
        let dynamics = dynamics.clone().with_level(level);
        assert_same(&one, &run::<8>(&dynamics, inputs, friction, start), 8);
        assert_same(
            &one,
            &run_as_block::<8>(&dynamics, inputs, friction, start),
            8,
        );
    }
    one.into_iter().flatten().collect()
}

/// Particles in mixed order: as the scene has it, off by a little, far away, fast, spinning,
/// loaded.
fn mixed_particles(rng: &mut Rng) -> ([Particle; PARTICLES], [Friction; PARTICLES]) {
    let mut start = [Particle::default(); PARTICLES];
    for (i, particle) in start.iter_mut().enumerate() {
        particle.pose = Pose::new(
            rng.within(-3e-4, 3e-4),
            rng.within(-3e-4, 3e-4),
            rng.within(-9e-3, 9e-3),
        );
        match i % 8 {
            1 => particle.pose.x += 3.0,
            3 => {
                particle.twist = Twist {
                    vx: 2.5,
                    vy: -0.3,
                    omega: 4.0,
                }
            }
            4 => particle.twist.omega = 25.0,
            5 => {
                particle.applied = Wrench {
                    fx: 0.02,
                    fy: -0.01,
                    torque: 3e-4,
                }
            }
            6 => particle.pose.theta += 0.6,
            _ => {}
        }
    }
    let mut any = |low, high| rng.within(low, high);
    let friction = std::array::from_fn(|i| Friction {
        mu_s: any(0.05, 0.6),
        mu_p: if i == 9 { 0.0 } else { any(0.0, 1.0) },
        mu_f: any(0.0, 1.0),
        d_tri: any(0.005, 0.03),
    });
    (start, friction)
}

#[test]
fn step_of_mixed_particles_past_fixels_gives_the_same_bits_for_every_number_of_lanes() {
    let (start, friction) = mixed_particles(&mut Rng(3));
    let inputs: Vec<_> = (0..260).map(bench_input).collect();
    let results = assert_independent(&Dynamics::new(bench_scene()), &inputs, &friction, &start);
    assert!(
        results
            .iter()
            .filter(|result| result.iterations > 1)
            .count()
            > 1000,
        "most particles were pushed"
    );
    assert!(
        results
            .iter()
            .filter(|result| result.iterations > 4)
            .count()
            > 50,
        "some lanes go on when the others of their chunk are done"
    );
}

#[test]
fn step_with_some_particles_jammed_gives_the_same_bits_for_every_number_of_lanes() {
    let (mut start, mut friction) = mixed_particles(&mut Rng(4));
    // Two that are sure to be jammed amid others that are not.
    (start[2], friction[2]) = (Particle::default(), FRICTION);
    (start[11], friction[11]) = (Particle::default(), FRICTION);
    let inputs: Vec<_> = (0..30)
        .map(|k| pushing(0.01, -0.0301 + 2e-4 * f64::from(k), 0.0, 0.02))
        .collect();
    for stall_force in [None, Some(3.0)] {
        let mut scene = square_scene(vec![
            fixel(disc(0.005), 0.0305, 0.015),
            fixel(disc(0.005), 0.0305, -0.015),
        ]);
        scene.pusher.stall_force = stall_force;
        let results = assert_independent(&Dynamics::new(scene), &inputs, &friction, &start);
        let unsolved = results
            .iter()
            .filter(|result| result.outcome == Outcome::Infeasible)
            .count();
        assert_eq!(
            unsolved > 20,
            stall_force.is_none(),
            "{unsolved} of {} are infeasible",
            results.len()
        );
        assert!(
            results.iter().any(|result| result.route != Route::Newton),
            "the later solvers took part"
        );
    }
}
