//! End of a particle's last step: [`end`].

use stickslip_dynamics::{Body, Outcome};

use crate::estimate::moves;
use crate::outcomes::End;
use crate::particle::estimate::closure::closes;
use crate::particle::set::chunk::LANES;
use crate::particle::transition::propagation::Propagation;

/// Returns how the last step of particle `i` of a block ended. Bodies up to a gap of `touching` (m)
/// touch.
pub(crate) fn end(block: &Propagation, i: usize, touching: f64) -> End {
    let (problem, solution) = (block.work.problem(i), block.work.solution(i));
    let particle = block.particles[i / LANES].get(i % LANES);
    let rows = problem.contacts.iter().zip(&solution.normal);
    let touches = rows.map(|(contact, impulse)| *impulse > 0.0 || contact.gap <= touching);
    let bodies = block.work.bodies(i).into_iter().zip(touches);
    let mut bodies: Vec<Body> = bodies
        .filter_map(|(body, touches)| touches.then_some(body))
        .collect();
    bodies.sort_unstable();
    bodies.dedup();
    let report = block.work.reports()[i / LANES][i % LANES];
    End {
        pose: particle.pose,
        bodies,
        moves: moves(&particle.twist),
        yields: solution.pusher_yield > 0.0,
        closes: closes(&problem, &solution),
        solved: report.outcome == Outcome::Solved,
    }
}
