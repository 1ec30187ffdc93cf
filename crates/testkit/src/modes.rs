//! All solutions of a small step by trying every contact mode: [`enumerate_modes`].
//!
//! A mode says of each contact whether it separates, sticks or slips to the left or right, of the
//! feet whether all slide, one sticks or all do, and of the drive whether it follows its command.
//! Within a mode the conditions are smooth equations; a damped Newton iteration solves them from
//! several starts, first with the corner of |s_k| rounded off, and solutions that pass the residual
//! are kept. Where a mode leaves impulses undetermined, those of least norm that respect the cones
//! are sought at its twist.

use stickslip_dynamics::{StepProblem, StepSolution};

use crate::impulses::impulses_for_twist;
use crate::mode_equations::{ContactMode, DriveMode, FeetMode, Mode, ModeEquations};
use crate::residual::residual_si;
use crate::rng::SplitMix64;
use crate::scaled_problem::{Column, ScaledProblem};

/// Solutions must meet this residual (m/s).
const TOLERANCE: f64 = 1e-10;
/// Twists closer than this, relative to the problem's fastest speed, are one solution.
const DISTINCT: f64 = 1e-6;
/// Four modes per contact: two contacts are quick, three bearable.
const MOST_CONTACTS: usize = 3;
const RANDOM_STARTS: usize = 3;

/// Every solution of distinct twist or yield that the enumeration finds; slow (milliseconds), for
/// up to three contacts.
///
/// Complete up to the Newton iteration's luck in each mode and up to continua of twists, of which
/// it reports a few members. Each returned solution has `residual_si` ≤ 1e-10 m/s.
///
/// # Panics
/// With more than three contacts.
#[must_use]
pub fn enumerate_modes(problem: &StepProblem) -> Vec<StepSolution> {
    assert!(
        problem.contacts.len() <= MOST_CONTACTS,
        "{} contacts have too many modes to enumerate",
        problem.contacts.len()
    );
    let scaled = ScaledProblem::new(problem);
    let starts = starts(&scaled);
    let mut search = Search {
        scaled: &scaled,
        tried: vec![],
        found: vec![],
    };
    for mode in modes(problem) {
        let equations = ModeEquations::new(&scaled, &mode);
        for start in &starts {
            search.consider(&equations, start);
        }
    }
    search.found
}

struct Search<'a> {
    scaled: &'a ScaledProblem<'a>,
    /// z and y of everything that met the equations of some mode.
    tried: Vec<[f64; 4]>,
    found: Vec<StepSolution>,
}

impl Search<'_> {
    /// Keeps the mode's solution reached from `start` where it is new and certified, if need be
    /// with other impulses at the same twist.
    fn consider(&mut self, equations: &ModeEquations, start: &Column) {
        let Some(candidate) = equations.solve(start) else {
            return;
        };
        let key = self.key(&candidate);
        if self.found.iter().any(|known| near(&self.key(known), &key)) {
            return;
        }
        let problem = self.scaled.problem;
        if residual_si(problem, &candidate) <= TOLERANCE {
            self.found.push(candidate);
        } else if !self.tried.iter().any(|known| near(known, &key)) {
            self.tried.push(key);
            let with_impulses =
                impulses_for_twist(problem, candidate.twist, candidate.pusher_yield);
            self.found.extend(
                with_impulses.filter(|solution| residual_si(problem, solution) <= TOLERANCE),
            );
        }
    }

    /// z and y of a solution.
    fn key(&self, solution: &StepSolution) -> [f64; 4] {
        let [x, y, turn] = self.scaled.scale_twist(solution.twist);
        [x, y, turn, solution.pusher_yield / self.scaled.speed()]
    }
}

fn near(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < DISTINCT)
}

fn starts(scaled: &ScaledProblem) -> Vec<Column> {
    let mut rng = SplitMix64::new(1);
    let mut all = vec![
        scaled.free(),
        scaled.scale_twist(scaled.problem.twist),
        [0.0; 3],
    ];
    all.extend((0..RANDOM_STARTS).map(|_| {
        [
            rng.within(-1.0, 1.0),
            rng.within(-1.0, 1.0),
            rng.within(-1.0, 1.0),
        ]
    }));
    all
}

fn modes(problem: &StepProblem) -> Vec<Mode> {
    let feet = if problem.feet.iter().all(|foot| foot.bound == 0.0) {
        vec![FeetMode::Slide]
    } else {
        vec![
            FeetMode::Slide,
            FeetMode::Pivot(0),
            FeetMode::Pivot(1),
            FeetMode::Pivot(2),
            FeetMode::Stuck,
        ]
    };
    let may_stall = problem.stall.is_some() && problem.contacts.iter().any(|c| c.yields.is_some());
    let drives = if may_stall {
        vec![DriveMode::Commanded, DriveMode::Stalled]
    } else {
        vec![DriveMode::Commanded]
    };
    let mut all = vec![];
    for contacts in contact_modes(problem) {
        for &feet in &feet {
            all.extend(drives.iter().map(|&drive| Mode {
                contacts: contacts.clone(),
                feet,
                drive,
            }));
        }
    }
    all
}

/// The product of the contacts' modes; without friction, slip to either side is the same.
fn contact_modes(problem: &StepProblem) -> Vec<Vec<ContactMode>> {
    let mut all = vec![vec![]];
    for contact in &problem.contacts {
        let options = match contact.mu {
            0.0 => vec![ContactMode::Separate, ContactMode::Slip(1.0)],
            _ => vec![
                ContactMode::Separate,
                ContactMode::Stick,
                ContactMode::Slip(1.0),
                ContactMode::Slip(-1.0),
            ],
        };
        all = all
            .iter()
            .flat_map(|head| {
                options
                    .iter()
                    .map(move |&last| [head.as_slice(), &[last]].concat())
            })
            .collect();
    }
    all
}
