//! Descent of the present particles from those of earlier steps: [`Lineage`].

/// Counts ancestors: of the latest step, and of a generation further back.
///
/// Few of either say that the particles, however many and however equal their weights, are copies
/// of a few (Doucet & Johansen 2009, section 4.3, on path degeneracy).
#[derive(Clone, Debug)]
pub struct Lineage {
    /// For each particle the one of the generation that it descends from.
    roots: Vec<u32>,
    /// And the one before the latest step.
    parents: Vec<u32>,
    spare: Vec<u32>,
    /// Particles of that generation, and before that step.
    generation: usize,
    before_step: usize,
    /// True if the latest step is over: further ancestors belong to the next one.
    over: bool,
    counted: Vec<bool>,
}

impl Lineage {
    /// `particles` that descend from themselves.
    pub(crate) fn new(particles: usize) -> Self {
        let mut lineage = Self {
            roots: vec![0; particles],
            parents: Vec::with_capacity(particles),
            spare: vec![0; particles],
            generation: 0,
            before_step: 0,
            over: true,
            counted: Vec::with_capacity(particles),
        };
        lineage.begin_step();
        lineage.begin_generation();
        lineage
    }

    /// Number of particles before the latest step that those of now descend from.
    #[must_use]
    pub fn parents(&mut self) -> usize {
        count_distinct(&self.parents, self.before_step, &mut self.counted)
    }

    /// Number of particles of the generation that those of now descend from.
    #[must_use]
    pub fn ancestors(&mut self) -> usize {
        count_distinct(&self.roots, self.generation, &mut self.counted)
    }

    /// The particles as they are now become the generation that is counted.
    pub(crate) fn begin_generation(&mut self) {
        self.generation = self.roots.len();
        number(&mut self.roots);
    }

    /// The particles as they are now become parents, unless they follow from those already.
    pub(crate) fn begin_step(&mut self) {
        if std::mem::replace(&mut self.over, false) {
            self.before_step = self.roots.len();
            self.parents.resize(self.before_step, 0);
            number(&mut self.parents);
        }
    }

    /// The next step begins with other parents.
    pub(crate) fn end_step(&mut self) {
        self.over = true;
    }

    /// Particle i becomes a copy of particle `ancestors[i]`.
    pub(crate) fn follow(&mut self, ancestors: &[u32]) {
        for ancestry in [&mut self.roots, &mut self.parents] {
            self.spare.clear();
            self.spare
                .extend(ancestors.iter().map(|i| ancestry[*i as usize]));
            std::mem::swap(ancestry, &mut self.spare);
        }
    }
}

/// Numbers the particles.
fn number(ancestry: &mut [u32]) {
    ancestry
        .iter_mut()
        .zip(0..)
        .for_each(|(number, i)| *number = i);
}

/// Number of different numbers below `below` among `of`.
fn count_distinct(of: &[u32], below: usize, counted: &mut Vec<bool>) -> usize {
    counted.clear();
    counted.resize(below, false);
    let mut count = 0;
    for i in of {
        count += usize::from(!std::mem::replace(&mut counted[*i as usize], true));
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ancestors_are_those_of_the_generation_and_parents_those_of_the_step() {
        let mut lineage = Lineage::new(4);
        assert_eq!((lineage.parents(), lineage.ancestors()), (4, 4));
        lineage.follow(&[0, 0, 2, 3]);
        assert_eq!((lineage.parents(), lineage.ancestors()), (3, 3));

        // copies of one particle are parents of their own, and of one ancestor
        lineage.end_step();
        lineage.begin_step();
        lineage.follow(&[0, 1, 1, 2]);
        assert_eq!((lineage.parents(), lineage.ancestors()), (3, 2));
        lineage.end_step();
        lineage.begin_step();
        assert_eq!((lineage.parents(), lineage.ancestors()), (4, 2));

        // another number of particles, and in the same step copies of copies; then a new generation
        lineage.follow(&[3, 3, 0, 0, 1]);
        lineage.begin_step();
        assert_eq!((lineage.parents(), lineage.ancestors()), (3, 2));
        lineage.follow(&[0, 1, 1, 0, 2]);
        assert_eq!((lineage.parents(), lineage.ancestors()), (2, 2));
        lineage.begin_generation();
        assert_eq!(lineage.ancestors(), 5);
    }
}
