//! Test whether the poses of an object at rest lie to one side of its estimated place: [`Aside`]
//! (docs/method.md (54)).

/// Number of the latest poses that are judged.
const LATEST: f64 = 30.0;

/// Threshold of the sum of the squared means over their variances. Chance exceeds it in 0.02 % of
/// poses (χ² of three degrees of freedom).
const NO_CHANCE: f64 = 20.0;

/// Mean displacement of the latest poses, axis by axis, in standard deviations expected of each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aside([f64; 3]);

impl Aside {
    /// Takes the displacement of one more pose.
    pub fn take(&mut self, off: [f64; 3]) {
        for (mean, off) in self.0.iter_mut().zip(off) {
            *mean += (off - *mean) / LATEST;
        }
    }

    /// The squares of the means.
    pub fn squares(&self) -> [f64; 3] {
        self.0.map(|mean| mean * mean)
    }

    /// Returns true if chance hardly ever displaces poses so far to one side.
    pub fn is_no_chance(&self) -> bool {
        // a mean that forgets like this has 1/(2 n - 1) of the variance of one pose
        self.squares().iter().sum::<f64>() * (2.0 * LATEST - 1.0) > NO_CHANCE
    }
}

#[cfg(test)]
mod tests {
    use stickslip_filter::Streams;

    use super::*;

    #[test]
    fn chance_hardly_ever_lies_aside_and_a_shift_mostly_does() {
        let share = |off: f64| {
            let mut aside = Aside::default();
            let beyond = (0..100_000).filter(|k| {
                let drawn = Streams::new(2).normals::<3>(*k, 0, 0);
                aside.take([drawn[0] + off, drawn[1], drawn[2]]);
                aside.is_no_chance()
            });
            beyond.count() as f64 / 1e5
        };
        // χ² of three degrees of freedom is above 20 in 1.7 of 10,000; some tens of neighbours
        // exceed it together
        assert!(share(0.0) < 1e-3, "{}", share(0.0));
        assert!(share(0.7) > 0.8, "{}", share(0.7));
    }
}
