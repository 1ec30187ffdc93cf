//! Bounds on the velocity between two points of a curve: [`Enclosure`].

use crate::solver::exhaustive::scalar_ncp::ScalarFoot;
use crate::solver::vector::{Vector, add_scaled, dot, norm};

/// Slip below which a foot is not taken to slip (m/s, relative to v where above 1).
const STANDS: f64 = 1e-12;

/// Slip at which a foot is not taken to resist (m/s): within the certificate's tolerance, a foot
/// that slips as slowly may exert its impulse in another direction.
const ANY_WAY: f64 = 1e-8;

/// Of a sum of products of a matrix and two vectors.
const ROUNDING: f64 = 1e-14;

/// Ratio of bound to slip above which a foot resists a turn of its slip.
const CREEPS: f64 = 10.0;

/// The object on its feet alone under one load: its velocity, and the impulses of the feet.
#[derive(Clone, Copy, Debug)]
pub struct Slide<'a> {
    /// Velocity.
    pub v: Vector<3>,
    /// Impulse of each foot.
    pub feet: &'a [[f64; 2]; 3],
}

/// All velocities T⁻¹(load) for loads between those of two slides.
#[derive(Clone, Copy, Debug)]
pub struct Between<'a> {
    /// The feet.
    pub feet: &'a [ScalarFoot; 3],
    /// Both ends.
    pub ends: [Slide<'a>; 2],
    /// Δload·Δv of both, at least.
    pub power: f64,
    /// Error of both (m/s).
    pub rounding: f64,
}

/// An ellipsoid about a centre c: |Lᵀ(v − c)| ≤ radius.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure {
    /// Its centre.
    pub centre: Vector<3>,
    /// Lower triangle of L.
    factor: [Vector<3>; 3],
    radius: f64,
    rounding: f64,
}

impl Between<'_> {
    /// A ball about the middle of both ends, of radius zero where the object rests at both.
    ///
    /// T⁻¹ is firmly nonexpansive, |Δv|² ≤ Δload·Δv. Added for both ends, that leaves to every v
    /// between them |v − v_a|² + |v − v_b|² ≤ power.
    pub fn ball(&self) -> Enclosure {
        self.enclosure(&[identity(); 2])
    }

    /// An ellipsoid, from the highest slip speeds of the feet in another enclosure: the direction
    /// of a slow slip hardly turns. `None` where no foot slips slowly.
    ///
    /// With f = −p, Δload·Δv is |Δv|² + Σ Δf_k·Δs_k, and no term of the sum is negative. Where the
    /// foot slips at a, a term is b (|s| + |s_a|)(1 − cos). That is at least b (|s| + |s_a|)/(2
    /// |s|²) times the square of the part of s across s_a. Where the foot stands at a, a term is at
    /// least (b − |p_a|)|s|. The enclosure bounds |s|.
    pub fn narrower(&self, than: &Enclosure) -> Option<Enclosure> {
        let fastest = self.feet.each_ref().map(|foot| than.fastest(foot));
        let creeps = self
            .feet
            .iter()
            .zip(fastest)
            .any(|(foot, fastest)| foot.bound > CREEPS * fastest);
        creeps.then(|| self.enclosure(&self.ends.map(|end| end.stiffness(self.feet, &fastest))))
    }

    /// The v with (u + half)·A (u + half) + (u − half)·B (u − half) ≤ power, u = v − middle.
    fn enclosure(&self, [at_a, at_b]: &[[Vector<3>; 3]; 2]) -> Enclosure {
        let [a, b] = &self.ends;
        let half = add_scaled(&b.v, -1.0, &a.v).map(|x| 0.5 * x);
        let sum = [0, 1, 2].map(|i| add_scaled(&at_a[i], 1.0, &at_b[i]));
        let difference = [0, 1, 2].map(|i| add_scaled(&at_b[i], -1.0, &at_a[i]));
        let factor = cholesky(&sum);
        // the centre is off the middle by M⁻¹ (B − A) half
        let along = forward(&factor, &difference.map(|row| dot(&row, &half)));
        let middle = add_scaled(&a.v, 1.0, &half);
        let ends = dot(&sum.map(|row| dot(&row, &half)), &half);
        // both ends are exact for loads that differ by their errors
        let farthest = self.power.sqrt() + norm(&half);
        let stiffest = sum[0][0] + sum[1][1] + sum[2][2];
        let power =
            self.power + 4.0 * self.rounding * farthest + ROUNDING * stiffest * dot(&half, &half);
        Enclosure {
            centre: add_scaled(&middle, 1.0, &backward(&factor, &along)),
            factor,
            radius: (power - ends + dot(&along, &along)).max(0.0).sqrt(),
            rounding: self.rounding,
        }
    }
}

impl Enclosure {
    /// Largest difference of row·v from its value at the centre.
    pub fn reach(&self, row: &Vector<3>) -> f64 {
        self.radius * norm(&forward(&self.factor, row)) + self.rounding * norm(row)
    }

    /// A foot slips no faster.
    fn fastest(&self, foot: &ScalarFoot) -> f64 {
        let [x, y] = foot.slip(&self.centre);
        let [dx, dy] = [[1.0, 0.0, foot.jx], [0.0, 1.0, foot.jy]].map(|row| self.reach(&row));
        norm(&[x.abs() + dx, y.abs() + dy])
    }
}

impl Slide<'_> {
    /// Resistance to a change of v from here, where feet slip no faster than `fastest`.
    fn stiffness(&self, feet: &[ScalarFoot; 3], fastest: &[f64; 3]) -> [Vector<3>; 3] {
        let mut matrix = identity();
        let stands = STANDS * (1.0 + norm(&self.v));
        for ((foot, impulse), &fastest) in feet.iter().zip(self.feet).zip(fastest) {
            let slip = foot.slip(&self.v);
            let speed = norm(&slip);
            if fastest < ANY_WAY {
                continue;
            }
            if speed > stands {
                let size = foot.bound * (fastest + speed) / (2.0 * fastest * fastest);
                add_along(&mut matrix, foot, [-slip[1] / speed, slip[0] / speed], size);
            } else {
                let spare = (foot.bound - norm(impulse)).max(0.0) / fastest;
                add_along(&mut matrix, foot, [1.0, 0.0], spare);
                add_along(&mut matrix, foot, [0.0, 1.0], spare);
            }
        }
        matrix
    }
}

/// Adds a resistance of `size` against slip of a foot along a direction to a matrix.
fn add_along(matrix: &mut [Vector<3>; 3], foot: &ScalarFoot, [x, y]: [f64; 2], size: f64) {
    let row = [x, y, foot.jx * x + foot.jy * y];
    for i in 0..3 {
        matrix[i] = add_scaled(&matrix[i], size * row[i], &row);
    }
}

fn identity() -> [Vector<3>; 3] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
}

/// L of a symmetric matrix L Lᵀ that is larger than the identity.
fn cholesky(matrix: &[Vector<3>; 3]) -> [Vector<3>; 3] {
    let mut factor = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let rest = matrix[i][j] - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            factor[i][j] = if i == j {
                rest.max(1.0).sqrt()
            } else {
                rest / factor[j][j]
            };
        }
    }
    factor
}

/// L⁻¹ b.
fn forward(factor: &[Vector<3>; 3], b: &Vector<3>) -> Vector<3> {
    let mut x = *b;
    for i in 0..3 {
        for j in 0..i {
            x[i] -= factor[i][j] * x[j];
        }
        x[i] /= factor[i][i];
    }
    x
}

/// L⁻ᵀ b.
fn backward(factor: &[Vector<3>; 3], b: &Vector<3>) -> Vector<3> {
    let mut x = *b;
    for i in (0..3).rev() {
        for j in i + 1..3 {
            x[i] -= factor[j][i] * x[j];
        }
        x[i] /= factor[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::exhaustive::numbers::Numbers;
    use crate::solver::exhaustive::support_friction::SupportFriction;

    /// Velocities at loads between two, by the solver of the feet: all within every enclosure, and
    /// where the object creeps ellipsoids are far thinner than balls.
    #[test]
    fn velocities_between_two_loads_are_within_balls_and_ellipsoids() {
        let (mut numbers, mut thinner, mut narrowed) = (Numbers(5), 0, 0);
        for round in 0..3000 {
            let feet = [0; 3].map(|_| ScalarFoot {
                jx: numbers.next(),
                jy: numbers.next(),
                bound: numbers.next().abs(),
            });
            let mut support = SupportFriction::new(&feet);
            let from: Vector<3> = numbers.vector::<3>().map(|x| 1.5 * x);
            let reach = [1.0, 1e-2, 1e-4][round % 3];
            let change: Vector<3> = numbers.vector::<3>().map(|x| reach * x);
            let at = |support: &mut SupportFriction, share: f64| {
                support.solve(&add_scaled(&from, share, &change))
            };
            let [a, b] = [0.0, 1.0].map(|share| at(&mut support, share));
            let ends = [&a, &b].map(|end| Slide {
                v: end.v,
                feet: &end.feet,
            });
            let between = Between {
                feet: &feet,
                ends,
                power: dot(&change, &add_scaled(&b.v, -1.0, &a.v)).max(0.0),
                rounding: 1e-13,
            };
            let mut enclosures = vec![between.ball()];
            while let Some(next) = between.narrower(&enclosures[enclosures.len() - 1])
                && enclosures.len() < 4
            {
                enclosures.push(next);
            }
            for share in [0.0, 0.1, 0.4, 0.5, 0.8, 1.0] {
                let v = at(&mut support, share).v;
                for (k, enclosure) in enclosures.iter().enumerate() {
                    let row = numbers.vector();
                    let off = dot(&row, &add_scaled(&v, -1.0, &enclosure.centre)).abs();
                    assert!(off <= enclosure.reach(&row), "{round} {share} {k}: {off:e}");
                }
            }
            let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let volume = |e: &Enclosure| axes.iter().map(|axis| e.reach(axis)).product::<f64>();
            narrowed += usize::from(enclosures.len() > 1);
            let last = &enclosures[enclosures.len() - 1];
            thinner += usize::from(volume(last) < 0.1 * volume(&enclosures[0]));
        }
        assert!(narrowed > 300 && thinner > 100, "{narrowed}, {thinner}");
    }
}
