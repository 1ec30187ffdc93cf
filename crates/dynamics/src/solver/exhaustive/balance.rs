//! Balance of a load by impulses within their bounds: [`balance`].
//!
//! The load that the contacts have to balance is a convex set, a [`Load`]. Contacts balance Σ α_i
//! g_i, α ≥ 0, a cone. Either set and cone meet, or a direction separates them. A direction that is
//! chosen beforehand, as those of the dual basis are, need not separate them.

use crate::solver::exhaustive::load::Load;
use crate::solver::vector::{Vector, add_scaled, dot, norm};

/// Most columns that enter.
const STEPS: u32 = 40;

/// Most columns that are independent.
const MOST: usize = 5;

/// Distance between set and cone that rounding leaves, relative to the set's size, and part of a
/// unit vector across another one that it leaves.
const ROUNDING: f64 = 1e-13;

/// Progress below which the search ends.
const PROGRESS: f64 = 1e-15;

/// Relation of set and cone.
#[derive(Clone, Debug)]
pub enum Balance {
    /// They meet: impulses α of the generators, and the feet's u.
    Met {
        /// One per generator.
        alpha: Vec<f64>,
        /// Zero for feet that slip.
        directions: [[f64; 2]; 3],
    },
    /// w·T > 0 in all of the set and w·g ≤ 0 for every generator, to rounding; |w| = 1.
    Separated(Vector<4>),
    /// Neither was found.
    Unknown,
}

/// Looks for impulses of `generators` that balance `load`, but for a distance of `tolerance` (m/s)
/// or what rounding leaves. Also returns the number of linear systems that it took.
///
/// Finds the point of set less cone that is nearest to the origin, as least squares with weights
/// that are not negative. The weights of the set's points sum to one as well as they can (Haskell
/// and Hanson 1981). Columns are found as they are needed, and enter and leave as in Lawson and
/// Hanson (1974).
pub fn balance(generators: &[Vector<4>], load: &Load<'_>, tolerance: f64) -> (Balance, u32) {
    let size = load.size();
    if size == 0.0 {
        let alpha = vec![0.0; generators.len()];
        let directions = [[0.0; 2]; 3];
        return (Balance::Met { alpha, directions }, 0);
    }
    let met = f64::max(tolerance / size, ROUNDING);
    let rays: Vec<_> = generators.iter().map(|g| g.map(|x| -x / norm(g))).collect();
    let mut active = ActiveSet::default();
    for step in 0..STEPS {
        let rest = active.rest();
        let w = [rest[0], rest[1], rest[2], rest[3]];
        if active.has_point() && norm(&w) <= met {
            return (active.impulses(generators, size), step);
        }
        // the column that the rest leans on most
        let (point, directions) = load.farthest(&w);
        let point = point.map(|x| x / size);
        let (ray, along_ray) = (0..rays.len())
            .map(|i| (i, dot(&w, &rays[i])))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, f64::NEG_INFINITY));
        let along_point = dot(&w, &point);
        if along_ray <= ROUNDING * norm(&w) && along_point < -met * norm(&w) {
            return (Balance::Separated(w.map(|x| -x / norm(&w))), step);
        }
        let entered = if along_ray > along_point + rest[4] {
            along_ray > PROGRESS && active.enter(Column::ray(ray, &rays[ray]))
        } else {
            along_point + rest[4] > PROGRESS && active.enter(Column::point(&point, directions))
        };
        if !entered {
            return (Balance::Unknown, step);
        }
    }
    (Balance::Unknown, STEPS)
}

/// A generator's direction, or a point of the set.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// The fifth entry is one for a point.
    entries: Vector<5>,
    weight: f64,
    /// `None` for a point.
    ray: Option<usize>,
    directions: [[f64; 2]; 3],
}

impl Column {
    fn ray(i: usize, ray: &Vector<4>) -> Self {
        let [a, b, c, d] = *ray;
        Self {
            entries: [a, b, c, d, 0.0],
            weight: 0.0,
            ray: Some(i),
            directions: [[0.0; 2]; 3],
        }
    }

    fn point(point: &Vector<4>, directions: [[f64; 2]; 3]) -> Self {
        let [a, b, c, d] = *point;
        Self {
            entries: [a, b, c, d, 1.0],
            weight: 0.0,
            ray: None,
            directions,
        }
    }
}

/// The columns whose weights are positive.
#[derive(Clone, Debug, Default)]
struct ActiveSet {
    columns: Vec<Column>,
}

impl ActiveSet {
    /// (0, 0, 0, 0, 1) less the weighted columns.
    fn rest(&self) -> Vector<5> {
        let all = [0.0, 0.0, 0.0, 0.0, 1.0];
        self.columns.iter().fold(all, |rest, column| {
            add_scaled(&rest, -column.weight, &column.entries)
        })
    }

    fn has_point(&self) -> bool {
        self.columns.iter().any(|column| column.ray.is_none())
    }

    /// Takes a column in, and drops those whose weights become negative; whether it stayed.
    fn enter(&mut self, column: Column) -> bool {
        self.columns.push(column);
        while let Some(wanted) = least_squares(&self.columns) {
            let share = self
                .columns
                .iter()
                .zip(&wanted)
                .filter(|(_, wanted)| **wanted <= 0.0)
                .map(|(column, wanted)| {
                    column.weight / (column.weight - wanted).max(f64::MIN_POSITIVE)
                })
                .reduce(f64::min);
            for (column, wanted) in self.columns.iter_mut().zip(&wanted) {
                column.weight += share.unwrap_or(1.0) * (wanted - column.weight);
            }
            if share.is_none() {
                return true;
            }
            // the new one alone has no weight where nothing could be gained
            if self.columns.last().is_some_and(|new| new.weight <= 0.0) {
                return false;
            }
            self.columns
                .retain(|column| column.weight > f64::MIN_POSITIVE);
        }
        false
    }

    /// The impulses that the weights say.
    fn impulses(&self, generators: &[Vector<4>], size: f64) -> Balance {
        let points = self.columns.iter().filter(|column| column.ray.is_none());
        let sum: f64 = points.map(|column| column.weight).sum();
        let mut alpha = vec![0.0; generators.len()];
        let mut directions = [[0.0; 2]; 3];
        for column in &self.columns {
            let weight = column.weight / sum;
            match column.ray {
                Some(i) => alpha[i] += weight * size / norm(&generators[i]),
                None => {
                    for (to, from) in directions.iter_mut().zip(&column.directions) {
                        *to = add_scaled(to, weight, from);
                    }
                }
            }
        }
        Balance::Met { alpha, directions }
    }
}

/// The weights whose columns sum to (0, 0, 0, 0, 1) best; `None` where the columns depend on each
/// other.
fn least_squares(columns: &[Column]) -> Option<[f64; MOST]> {
    // columns are nearly parallel where a face rests on another one: orthogonal directions keep twice
    // the digits that the normal equations would, each taken out twice against rounding
    let n = columns.len();
    if n > MOST {
        return None;
    }
    let (mut basis, mut upper) = ([[0.0; 5]; MOST], [[0.0; MOST]; MOST]);
    for (j, column) in columns.iter().enumerate() {
        let mut across = column.entries;
        for _ in 0..2 {
            for (i, unit) in basis[..j].iter().enumerate() {
                let along = dot(unit, &across);
                upper[i][j] += along;
                across = add_scaled(&across, -along, unit);
            }
        }
        upper[j][j] = norm(&across);
        if upper[j][j] <= 1e-12 * norm(&column.entries) {
            return None;
        }
        basis[j] = across.map(|x| x / upper[j][j]);
    }
    let mut weights = [0.0; MOST];
    for j in (0..n).rev() {
        weights[j] = basis[j][4];
        for k in j + 1..n {
            weights[j] -= upper[j][k] * weights[k];
        }
        weights[j] /= upper[j][j];
    }
    Some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::exhaustive::load::Slips;
    use crate::solver::exhaustive::numbers::Numbers;
    use crate::solver::exhaustive::scalar_ncp::ScalarFoot;
    use crate::solver::exhaustive::support_friction::SupportFriction;

    fn random_feet(numbers: &mut Numbers) -> [ScalarFoot; 3] {
        [0; 3].map(|_| ScalarFoot {
            jx: numbers.next(),
            jy: numbers.next(),
            bound: numbers.next().abs(),
        })
    }

    fn wrench(foot: &ScalarFoot, u: &[f64; 2]) -> Vector<4> {
        let [x, y] = u.map(|x| foot.bound * x);
        [x, y, foot.jx * x + foot.jy * y, 0.0]
    }

    /// Impulses add up, and no corner of the set lies on the wrong side of the direction that
    /// separates.
    #[track_caller]
    fn is_sound(found: &Balance, generators: &[Vector<4>], load: &Load<'_>) {
        match found {
            Balance::Met { alpha, directions } => {
                let mut sum = load.corners[0];
                for (foot, u) in load.feet.iter().zip(directions) {
                    assert!(norm(u) <= 1.0 + 1e-12, "{u:?}");
                    sum = add_scaled(&sum, 1.0, &wrench(foot, u));
                }
                for (g, alpha) in generators.iter().zip(alpha) {
                    assert!(*alpha >= 0.0, "{alpha}");
                    sum = add_scaled(&sum, -alpha, g);
                }
                assert!(norm(&sum) < 1e-11, "{sum:?}");
            }
            Balance::Separated(w) => {
                assert!(generators.iter().all(|g| dot(w, g) < 1e-13), "{w:?}");
                for turn in 0..8_u32.pow(3) {
                    let mut point = load.corners[0];
                    for (k, foot) in load.feet.iter().enumerate() {
                        let angle = f64::from(turn / 8_u32.pow(k as u32) % 8) * 0.785;
                        let (sin, cos) = libm::sincos(angle);
                        point = add_scaled(&point, 1.0, &wrench(foot, &[cos, sin]));
                    }
                    assert!(dot(w, &point) > 0.0, "{w:?}");
                }
            }
            Balance::Unknown => panic!("neither"),
        }
    }

    #[test]
    fn load_is_met_by_feet_alone_where_the_object_rests() {
        let (mut numbers, mut counts) = (Numbers(1), [0; 2]);
        for _ in 0..1000 {
            let (feet, free) = (random_feet(&mut numbers), numbers.vector::<3>());
            let rests = SupportFriction::new(&feet).solve(&free).v == [0.0; 3];
            let [x, y, turn] = free.map(|x| -x);
            let load = Load {
                corners: vec![[x, y, turn, 0.0]],
                feet: &feet,
                slips: [Slips::Any; 3],
            };
            let (found, _) = balance(&[], &load, 0.0);
            is_sound(&found, &[], &load);
            assert_eq!(matches!(found, Balance::Met { .. }), rests, "{found:?}");
            counts[usize::from(rests)] += 1;
        }
        assert!(counts[0] > 100 && counts[1] > 100, "{counts:?}");
    }

    #[test]
    fn generators_that_met_a_load_meet_it_again_and_separations_hold() {
        let (mut numbers, mut separated) = (Numbers(2), 0);
        for round in 0..1000 {
            let feet = random_feet(&mut numbers);
            let generators = [0; 3].map(|_| numbers.vector::<4>());
            // every other load is a point of the cone, less what feet within their bounds exert
            let fixed = if round % 2 == 0 {
                let cone = generators
                    .iter()
                    .fold([0.0; 4], |sum, g| add_scaled(&sum, numbers.next().abs(), g));
                feet.iter().fold(cone, |sum, foot| {
                    let u = [0; 2].map(|_| 0.7 * numbers.next());
                    add_scaled(&sum, 1.0, &wrench(foot, &u))
                })
            } else {
                numbers.vector()
            };
            let load = Load {
                corners: vec![fixed],
                feet: &feet,
                slips: [Slips::Any; 3],
            };
            let (found, _) = balance(&generators, &load, 0.0);
            is_sound(&found, &generators, &load);
            separated += usize::from(matches!(found, Balance::Separated(_)));
            assert!(
                round % 2 == 1 || matches!(found, Balance::Met { .. }),
                "{found:?}"
            );
        }
        assert!(separated > 100, "{separated}");
    }
}
