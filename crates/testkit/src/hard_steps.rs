//! Steps that a solver once failed on, or took long for: [`hard_steps`].

use stickslip_dynamics::{ContactPoint, Foot, StepProblem, StepSolution, Twist, Wrench};

/// One step a line; its comments explain the numbers.
const TEXT: &str = include_str!("../data/hard_steps.txt");

/// A step of a particle filter over a recorded experiment, scaled to mass 1, radius of gyration 1
/// and step length 1.
#[derive(Clone, Debug, PartialEq)]
pub struct HardStep {
    /// Class of its difficulty.
    pub class: String,
    /// The problem.
    pub problem: StepProblem,
    /// The step before, from which its solver started.
    pub start: StepSolution,
}

/// All of them, in the order of the file.
///
/// # Panics
/// If the file, which is part of the program, is damaged.
#[must_use]
pub fn hard_steps() -> Vec<HardStep> {
    let lines = TEXT.lines().filter(|line| !line.starts_with('#'));
    lines.map(read).collect()
}

fn read(line: &str) -> HardStep {
    let (class, numbers) = line.split_once(' ').expect("a class, then numbers");
    let mut numbers = numbers
        .split(' ')
        .map(|number| number.parse::<f64>().expect("a number"));
    let mut next = || numbers.next().expect("as many numbers as the header says");
    let twist = Twist {
        vx: next(),
        vy: next(),
        omega: next(),
    };
    let feet = std::array::from_fn(|_| Foot {
        arm: [next(), next()],
        bound: next(),
    });
    let impulse = next();
    let direction = [next(), next()];
    let count = next() as usize;
    let contacts: Vec<_> = (0..count).map(|_| contact(direction, &mut next)).collect();
    let start = start(count, &mut next);
    HardStep {
        class: class.to_owned(),
        problem: StepProblem {
            mass: 1.0,
            inertia: 1.0,
            h: 1.0,
            twist,
            applied: Wrench::default(),
            contacts,
            feet,
            stall: impulse.is_finite().then_some(impulse),
        },
        start,
    }
}

/// A contact; one on the pusher yields along `direction`.
fn contact(direction: [f64; 2], next: &mut impl FnMut() -> f64) -> ContactPoint {
    let normal = [next(), next()];
    let arm = [next(), next()];
    let gap = next();
    // along t, the normal turned by +90 degrees
    let slip = next();
    ContactPoint {
        normal,
        arm,
        gap,
        surface_velocity: [-normal[1] * slip, normal[0] * slip],
        mu: next(),
        yields: (next() > 0.0).then_some(direction),
    }
}

fn start(contacts: usize, next: &mut impl FnMut() -> f64) -> StepSolution {
    let twist = Twist {
        vx: next(),
        vy: next(),
        omega: next(),
    };
    let feet = std::array::from_fn(|_| [next(), next()]);
    let pusher_yield = next();
    let (normal, tangential) = (0..contacts).map(|_| (next(), next())).unzip();
    StepSolution {
        twist,
        normal,
        tangential,
        feet,
        pusher_yield,
    }
}
