//! Number of particles that can be computed in time: [`ParticleBudget`].

use std::collections::VecDeque;
use std::num::NonZero;

use crate::quantile::quantile;
use crate::tracker::StepSize;

/// Rows whose costs are remembered.
const REMEMBERED: usize = 50;

/// Share of the remembered rows that cost no more than the planned cost.
const RECKONED: f64 = 0.9;

/// Share of the time left that a row should take.
const AIM: f64 = 0.6;

/// Share of the time left from which on there are too many particles.
const TOO_MUCH: f64 = 0.8;

/// Least time that is planned with, as a share of the deadline. If less is left, the row before was
/// held up, which fewer particles do not undo.
const FLOOR: f64 = 0.25;

/// Share of the particles that stays if the deadline has passed before the row begins.
const LATE: f64 = 0.9;

/// Growth of the number of particles, and the number of rows after which it happens.
const GROWTH: f64 = 1.25;
const GROWS_AFTER: u32 = 25;

/// Least number of particles, unless fewer were asked for.
const LEAST: u32 = 64;

/// Number of particles for each row, so that its answer is there in time.
///
/// It reads no clock: the caller reports how long rows took. The cost of a row is proportional to
/// particles times substeps, at the rate that 90 % of the last 50 rows kept.
///
/// The number falls at once to what fits into 60 % of the time left. For rows behind one that was
/// held up, it falls by a tenth each. It rises again by a quarter every 25 rows if that fits. It
/// stays between 64 and the number asked for, so that a machine which is too slow still misses
/// deadlines.
///
/// ```
/// use std::num::NonZero;
/// use stickslip::{ParticleBudget, StepSize};
///
/// let most = NonZero::new(500).expect("not 0");
/// let mut budget = ParticleBudget::new(most, 0.010);
/// let step = StepSize { substeps: 1, particles: most };
/// budget.took(step, 0.020); // twice as long as it may
/// assert_eq!(budget.particles(step, 0.010).get(), 150); // 60 % of 10 ms
/// ```
#[derive(Clone, Debug)]
pub struct ParticleBudget {
    most: u32,
    least: u32,
    /// Time from a row's arrival until its answer is due (s).
    deadline: f64,
    /// Costs of the last rows per particle and substep (s).
    costs: VecDeque<f64>,
    since_change: u32,
}

impl ParticleBudget {
    /// Plans at most `most` particles, for answers that are due `deadline` (s) after their row.
    #[must_use]
    pub fn new(most: NonZero<u32>, deadline: f64) -> Self {
        Self {
            most: most.get(),
            least: LEAST.min(most.get()),
            deadline,
            costs: VecDeque::with_capacity(REMEMBERED + 1),
            since_change: 0,
        }
    }

    /// Returns the number of particles for a step whose answer is due in `left` (s). `left` is
    /// negative if the answer is late already.
    pub fn particles(&mut self, step: StepSize, left: f64) -> NonZero<u32> {
        self.since_change = self.since_change.saturating_add(1);
        let before = step.particles.get();
        let wanted = self.wanted(step, left);
        let wanted = wanted.clamp(self.least, self.most);
        if wanted != before {
            self.since_change = 0;
        }
        NonZero::new(wanted).unwrap_or(step.particles)
    }

    fn wanted(&self, step: StepSize, left: f64) -> u32 {
        let before = step.particles.get();
        let held_up = (LATE * f64::from(before)) as u32;
        let costs: Vec<f64> = self.costs.iter().copied().collect();
        let Some(cost) = quantile(&costs, RECKONED) else {
            return before;
        };
        let each = cost * f64::from(step.substeps.max(1));
        let fits = |share: f64, left: f64| share * left / each;
        if left <= 0.0 {
            return held_up.min(fits(AIM, self.deadline) as u32);
        }
        let left = left.max(FLOOR * self.deadline);
        if f64::from(before) > fits(TOO_MUCH, left) {
            return fits(AIM, left) as u32;
        }
        let grown = (GROWTH * f64::from(before)).ceil();
        if self.since_change >= GROWS_AFTER && grown <= fits(AIM, left) {
            return grown as u32;
        }
        before
    }

    /// Records how long (s) the latest step took. Times that are not positive numbers are left out.
    pub fn took(&mut self, step: StepSize, seconds: f64) {
        let work = f64::from(step.particles.get()) * f64::from(step.substeps.max(1));
        if seconds.is_finite() && seconds > 0.0 {
            self.costs.push_back(seconds / work);
        }
        if self.costs.len() > REMEMBERED {
            self.costs.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEADLINE: f64 = 0.010;

    fn count(particles: u32) -> NonZero<u32> {
        NonZero::new(particles).expect("not 0")
    }

    /// A machine of one thread that answers rows in order.
    struct Machine {
        budget: ParticleBudget,
        particles: NonZero<u32>,
        /// Time at which it is free (s).
        free: f64,
        missed: usize,
    }

    impl Machine {
        fn new() -> Self {
            Self {
                budget: ParticleBudget::new(count(500), DEADLINE),
                particles: count(500),
                free: 0.0,
                missed: 0,
            }
        }

        /// Answers a row that arrives at time `arrives` (s) and costs `cost` (s) per particle and
        /// substep.
        fn answer(&mut self, arrives: f64, substeps: u32, cost: f64) {
            let begins = self.free.max(arrives);
            let mut step = StepSize {
                substeps,
                particles: self.particles,
            };
            step.particles = self.budget.particles(step, arrives + DEADLINE - begins);
            let seconds = cost * f64::from(step.particles.get() * substeps);
            self.budget.took(step, seconds);
            self.particles = step.particles;
            self.free = begins + seconds;
            self.missed += usize::from(self.free > arrives + DEADLINE);
        }

        /// Answers rows that come regularly; returns how many missed their deadline.
        fn run(&mut self, rows: usize, period: f64, cost: f64) -> usize {
            let (before, from) = (self.missed, self.free);
            for row in 0..rows {
                self.answer(from + period * row as f64, 1, cost);
            }
            self.missed - before
        }
    }

    #[test]
    fn all_particles_stay_where_there_is_time() {
        let mut machine = Machine::new();
        assert_eq!(machine.run(1000, 0.01, 10e-6), 0);
        assert_eq!(machine.particles, count(500));
    }

    #[test]
    fn slow_machine_gets_what_fits_and_gets_all_back_when_it_is_fast_again() {
        let mut machine = Machine::new();
        // 500 particles would take 25 ms: 120 fit into 6 ms
        assert!(machine.run(1000, 0.01, 50e-6) < 10);
        assert!((100..=160).contains(&machine.particles.get()));
        assert_eq!(machine.run(1000, 0.01, 50e-6), 0);
        assert_eq!(machine.run(1000, 0.01, 5e-6), 0);
        assert_eq!(machine.particles, count(500));
    }

    #[test]
    fn one_row_held_up_costs_few_particles() {
        let mut machine = Machine::new();
        machine.run(100, 0.01, 5e-6);
        machine.free += 0.030;
        let from = machine.free - 0.030;
        for row in 0..6 {
            machine.answer(from + 0.01 * f64::from(row), 1, 5e-6);
        }
        assert!((1..=4).contains(&machine.missed));
        assert!(machine.particles.get() > 300, "{}", machine.particles);
    }

    #[test]
    fn rows_that_come_too_fast_are_caught_up_with() {
        let mut machine = Machine::new();
        // 500 particles fit into the deadline but not between two rows
        machine.run(500, 0.002, 10e-6);
        assert_eq!(machine.run(500, 0.002, 10e-6), 0);
        assert!((64..200).contains(&machine.particles.get()));
    }

    #[test]
    fn long_step_gets_fewer_particles() {
        let mut machine = Machine::new();
        machine.run(100, 0.01, 10e-6);
        machine.answer(machine.free + 1.0, 10, 10e-6);
        assert_eq!((machine.particles, machine.missed), (count(64), 0));
    }

    #[test]
    fn too_slow_a_machine_keeps_the_least() {
        let mut machine = Machine::new();
        assert!(machine.run(100, 0.01, 1e-3) > 90);
        assert_eq!(machine.particles, count(64));
        let mut few = ParticleBudget::new(count(10), DEADLINE);
        let step = StepSize {
            substeps: 1,
            particles: count(10),
        };
        few.took(step, f64::NAN);
        few.took(step, 1.0);
        assert_eq!(few.particles(step, DEADLINE), count(10));
    }
}
