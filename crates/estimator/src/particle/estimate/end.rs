//! End of a particle's last step: [`end`].

use stickslip_dynamics::{Body, Outcome};

use crate::estimate::moves;
use crate::outcomes::End;
use crate::particle::set::chunk::LANES;
use crate::particle::transition::closure::Cones;
use crate::particle::transition::propagation::Propagation;

/// Returns how the last step of particle `i` of a block ended. Bodies up to a gap of `touching` (m)
/// touch.
pub(crate) fn end(block: &Propagation, i: usize, rho: f64, touching: f64) -> End {
    let mut bodies: Vec<Body> = Vec::new();
    let mut cones = Cones::default();
    block.work.each_contact(i, &mut |contact| {
        let presses = contact.impulse > 0.0;
        if presses {
            cones.add(&contact.point, rho);
        }
        if presses || contact.gap <= touching {
            bodies.push(contact.body);
        }
    });
    bodies.sort_unstable();
    bodies.dedup();
    let particle = block.particles[i / LANES].get(i % LANES);
    let report = block.work.reports()[i / LANES][i % LANES];
    End {
        pose: particle.pose,
        bodies,
        moves: moves(&particle.twist),
        yields: block.work.solution(i).pusher_yield > 0.0,
        closes: cones.close(),
        solved: report.outcome == Outcome::Solved,
    }
}
