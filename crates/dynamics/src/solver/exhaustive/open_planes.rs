//! The planes that two generators leave, before their own slips are asked for: [`OpenPlanes`].

use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::mode_conditions::ModeConditions;
use crate::solver::exhaustive::plane_region::PlaneRegion;

/// The open plane of each two contacts, or of a contact and the stall pair. Both edges of a contact
/// ask for the same closed gap: their planes are the same.
#[derive(Debug)]
pub struct OpenPlanes {
    /// At [`index`].
    planes: Vec<Option<PlaneRegion>>,
    contacts: usize,
}

impl OpenPlanes {
    /// Those of `generators`, of which the first one is one of `firsts` contacts, from the first
    /// one on.
    pub fn new(conditions: &ModeConditions, generators: &[Generator], firsts: usize) -> Self {
        let contacts = conditions.problem.contacts.len();
        let mut planes = vec![None; (1 + contacts) * (1 + contacts)];
        let mut one_each = generators.to_vec();
        one_each.dedup_by_key(|generator| generator.contact);
        for (k, a) in one_each.iter().enumerate().take(firsts) {
            for b in &one_each[k + 1..] {
                planes[index(contacts, a, b)] = conditions.open_plane(&[*a, *b]);
            }
        }
        Self { planes, contacts }
    }

    /// Part of the plane of two generators that a mode's inequalities leave; `None` where their
    /// equations leave none.
    pub fn of(&self, conditions: &ModeConditions, chosen: &[Generator; 2]) -> Option<PlaneRegion> {
        let [a, b] = chosen;
        let mut region = if a.contact == b.contact {
            conditions.open_plane(chosen)?
        } else {
            self.planes[index(self.contacts, a, b)].clone()?
        };
        for inequality in conditions.slips(chosen) {
            region.clip(&inequality, conditions.slack);
        }
        Some(region)
    }
}

/// Place of two generators among the planes of so many contacts; the stall pair comes first.
fn index(contacts: usize, a: &Generator, b: &Generator) -> usize {
    let row = |generator: &Generator| generator.contact.map_or(0, |i| i + 1);
    row(a) * (1 + contacts) + row(b)
}
