//! The object on its feet alone: [`SupportFriction`].

use crate::solver::elimination::solve_dense;
use crate::solver::exhaustive::limit_surface::{LimitSurface, Pivot, SlipFriction};
use crate::solver::exhaustive::scalar_ncp::ScalarFoot;
use crate::solver::vector::{Vector, add_scaled, dot, norm};

/// Most Newton steps: from the last slip, and from a start that leads to the solution.
const STEPS_FROM_LAST: u32 = 12;
const STEPS: u32 = 60;

/// Most halvings of a step.
const HALVINGS: u32 = 40;

/// Imbalance of a solution (m/s, relative where above 1).
const BALANCED: f64 = 1e-14;

/// Relative rounding of costs, below which only the imbalance shows progress.
const ROUNDING: f64 = 1e-14;

/// Keeps matrices regular where a single foot is loaded, relative to their largest entry.
const REGULAR: f64 = 1e-13;

/// The map from a load to the velocity it causes where only the feet resist: a search over curves
/// evaluates it many times.
///
/// A load within the friction body of the feet moves nothing; one outside moves the object by its
/// difference from the nearest point of the body, load = F(e) + ε e. Newton's method in the
/// direction e of slip and the speed ε serves objects that creep as well as those that slide, since
/// F does not depend on the speed. The problem is convex, and smooth but for rest and the pivots
/// about a foot: those are tried first, and descent from the best of them meets none of them again.
pub struct SupportFriction {
    surface: LimitSurface,
    pivots: [Pivot; 6],
    /// The last slip.
    last: Option<Slip>,
    /// Outward normal where the last load at rest meets the limit surface.
    ahead: Option<Vector<3>>,
}

/// A slip: unit direction and speed.
#[derive(Clone, Copy, Debug)]
struct Slip {
    e: Vector<3>,
    speed: f64,
}

/// A slip, and how far it is from balancing a load.
struct Trial {
    slip: Slip,
    cost: f64,
    moved: Moved,
}

/// Knowledge of the motion before the object slides.
enum Motion {
    /// It rests.
    Rests(SlipFriction),
    /// It turns about a foot, with this velocity.
    Pivots(Vector<3>, SlipFriction),
    /// It slides, and from here descent leads to how.
    Slips(Slip),
}

/// Motion of the object on its feet.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    /// Its velocity.
    pub v: Vector<3>,
    /// Impulse of each foot.
    pub feet: [[f64; 2]; 3],
    /// Remaining imbalance, at least the error of v (m/s).
    pub residual: f64,
    /// Linear systems solved.
    pub systems: u32,
}

impl SupportFriction {
    /// Of these feet.
    pub fn new(feet: &[ScalarFoot; 3]) -> Self {
        let surface = LimitSurface::new(feet);
        Self {
            pivots: surface.pivots(),
            surface,
            last: None,
            ahead: None,
        }
    }

    /// Velocity v = T⁻¹(load) and foot impulses, where `load` is the velocity without friction.
    ///
    /// v is the unique minimiser of ½|v − load|² + Σ bound_k |J_k v|, and 1-Lipschitz in the load.
    pub fn solve(&mut self, load: &Vector<3>) -> Moved {
        let mut systems = 0;
        if let Some(last) = self.last {
            let moved = self.slide(load, last, STEPS_FROM_LAST, &mut systems);
            if moved.is_balanced(load) {
                return moved;
            }
        }
        // the fastest pivot
        systems += 1;
        let speed = |pivot: &Pivot| dot(&pivot.e, load) - pivot.others.loss;
        let fastest = self
            .pivots
            .into_iter()
            .max_by(|a, b| speed(a).total_cmp(&speed(b)))
            .expect("six pivots");
        self.last = None;
        let motion = if speed(&fastest) > 0.0 {
            self.pivot(load, &fastest, speed(&fastest))
        } else {
            self.rest(load, &mut systems)
        };
        match motion {
            Motion::Pivots(v, friction) => Moved::new(load, v, &friction, systems),
            Motion::Rests(friction) => Moved::new(load, [0.0; 3], &friction, systems),
            Motion::Slips(start) => self.slide(load, start, STEPS, &mut systems),
        }
    }

    /// The motion about a foot, or a slip off it that costs less.
    fn pivot(&self, load: &Vector<3>, pivot: &Pivot, speed: f64) -> Motion {
        let v = pivot.e.map(|x| speed * x);
        let rest = add_scaled(&add_scaled(load, -1.0, &v), -1.0, &pivot.others.total);
        let impulse = [rest[0], rest[1]];
        if let Some(friction) = self.surface.on_facet(pivot, impulse) {
            return Motion::Pivots(v, friction);
        }
        // the foot yields along the impulse
        let off = [impulse[0], impulse[1], 0.0];
        let cost = |v: &Vector<3>| cost(load, v, &self.surface.friction(v));
        Motion::Slips(Slip::of(&leave(cost, &v, &off)))
    }

    /// Rest where friction balances the load, or a slip that costs less: the friction in the
    /// direction of the load is F(e) = h load, with e the minimum of the convex h(e) = F(e)·e,
    /// e·load = 1.
    fn rest(&mut self, load: &Vector<3>, systems: &mut u32) -> Motion {
        let size = norm(load);
        if size == 0.0 {
            return Motion::Rests(SlipFriction::default());
        }
        let loss = |e: &Vector<3>| self.surface.friction(e).loss;
        let onto_plane = |e: &Vector<3>| e.map(|x| x / dot(e, load));
        // the best pivot, straight ahead, or as for the last load at rest
        let mut e = load.map(|x| x / (size * size));
        let mut best = loss(&e);
        if let Some(last) = self.ahead.filter(|last| dot(last, load) > 0.0) {
            let again = onto_plane(&last);
            if loss(&again) < best {
                (e, best) = (again, loss(&again));
            }
        }
        for pivot in &self.pivots {
            let along = dot(&pivot.e, load);
            let h = pivot.others.loss / along;
            if along < 1e-9 * size || h > best {
                continue;
            }
            let rest = add_scaled(&load.map(|x| h * x), -1.0, &pivot.others.total);
            let impulse = [rest[0], rest[1]];
            // no pivot moves, so that h is at least 1
            if let Some(friction) = self.surface.on_facet(pivot, impulse) {
                return Motion::Rests(friction.scaled(1.0 / h));
            }
            // off it, in the plane
            let across = -(impulse[0] * load[0] + impulse[1] * load[1]) / along;
            let off = add_scaled(&[impulse[0], impulse[1], 0.0], across, &pivot.e);
            e = leave(loss, &onto_plane(&pivot.e), &off);
            best = loss(&e);
        }
        // Newton's method in the plane
        for _ in 0..STEPS {
            let friction = self.surface.friction(&e);
            let missed = |f: &SlipFriction| norm(&add_scaled(&f.total, -f.loss, load));
            let now = missed(&friction);
            if now <= BALANCED * friction.loss * size {
                break;
            }
            *systems += 1;
            let Some(step) = self.step_in_plane(load, &e, &friction) else {
                break;
            };
            let next = first_share(
                |share| onto_plane(&add_scaled(&e, share, &step)),
                |next| {
                    let then = self.surface.friction(next);
                    then.loss < friction.loss
                        || then.loss <= friction.loss * (1.0 + ROUNDING)
                            && missed(&then) < 0.9 * now
                },
            );
            let Some(next) = next else {
                break;
            };
            e = next;
        }
        self.ahead = Some(e);
        let friction = self.surface.friction(&e);
        Motion::at(friction.loss, &e, friction)
    }

    /// A Newton step to the least loss among the e with e·load = 1.
    fn step_in_plane(
        &self,
        load: &Vector<3>,
        e: &Vector<3>,
        friction: &SlipFriction,
    ) -> Option<Vector<3>> {
        let change = regular(self.surface.change(e));
        let mut matrix = [[0.0; 4]; 4];
        let size = norm(load);
        for i in 0..3 {
            matrix[i][..3].copy_from_slice(&change[i]);
            matrix[i][3] = load[i] / size;
            matrix[3][i] = load[i] / size;
        }
        let [x, y, z] = friction.total.map(|x| -x);
        let [x, y, z, _] = solve_dense(matrix, [x, y, z, 0.0], 0.0)?;
        Some([x, y, z])
    }

    /// Follows a slip to where it balances the load, by damped Newton steps.
    fn slide(&mut self, load: &Vector<3>, start: Slip, steps: u32, systems: &mut u32) -> Moved {
        let mut now = self.trial(load, start);
        for _ in 0..steps {
            if now.moved.is_balanced(load) {
                break;
            }
            *systems += 1;
            let Some(step) = self.newton_step(load, &now.slip) else {
                break;
            };
            // from the last slip, the object may as well come to rest
            let stops = now.slip.speed + dot(&step, &now.slip.e) <= 0.0;
            if stops && steps == STEPS_FROM_LAST {
                break;
            }
            let rounding = ROUNDING * now.slip.speed * norm(load);
            let next = first_share(
                |share| self.trial(load, now.slip.after(&step, share)),
                |next| {
                    let nearer = next.moved.residual < 0.9 * now.moved.residual;
                    let falls = nearer && next.cost <= now.cost + rounding;
                    next.slip.speed > 0.0 && (next.cost < now.cost || falls)
                },
            );
            let Some(next) = next else { break };
            now = next;
        }
        self.last = Some(now.slip);
        now.moved.systems = *systems;
        now.moved
    }

    /// The object slips like this, no loaded foot standing.
    fn trial(&self, load: &Vector<3>, slip: Slip) -> Trial {
        let v = slip.velocity();
        let friction = self.surface.friction(&v);
        Trial {
            slip,
            cost: cost(load, &v, &friction),
            moved: Moved::new(load, v, &friction, 0),
        }
    }

    /// Changes of direction and speed, as e' + speed' e, to where the linearised friction balances
    /// the load.
    fn newton_step(&self, load: &Vector<3>, slip: &Slip) -> Option<Vector<3>> {
        let Slip { e, speed } = slip;
        let left = add_scaled(
            &add_scaled(load, -*speed, e),
            -1.0,
            &self.surface.friction(e).total,
        );
        let mut matrix = self.surface.change(e);
        for i in 0..3 {
            for j in 0..3 {
                matrix[i][j] += (1.0 - speed) * e[i] * e[j];
            }
            matrix[i][i] += speed;
        }
        solve_dense(regular(matrix), left, 0.0)
    }
}

/// ½|v − load|² + Σ bound |J v|, less its value at rest.
fn cost(load: &Vector<3>, v: &Vector<3>, friction: &SlipFriction) -> f64 {
    dot(v, v) * 0.5 - dot(v, load) + friction.loss
}

impl Moved {
    /// With a velocity and the friction against it.
    fn new(load: &Vector<3>, v: Vector<3>, friction: &SlipFriction, systems: u32) -> Self {
        let left = add_scaled(&add_scaled(load, -1.0, &v), -1.0, &friction.total);
        Self {
            v,
            feet: friction.feet.map(|f| f.map(|x| -x)),
            residual: norm(&left),
            systems,
        }
    }

    fn is_balanced(&self, load: &Vector<3>) -> bool {
        self.residual <= BALANCED * (1.0 + norm(load))
    }
}

impl Slip {
    /// Of a velocity other than zero.
    fn of(v: &Vector<3>) -> Self {
        let speed = norm(v);
        Self {
            e: v.map(|x| x / speed),
            speed,
        }
    }

    fn velocity(&self) -> Vector<3> {
        self.e.map(|x| self.speed * x)
    }

    /// After a share of a step: its part along e changes the speed, the rest the direction.
    fn after(&self, step: &Vector<3>, share: f64) -> Self {
        let faster = dot(step, &self.e);
        let turn = add_scaled(step, -faster, &self.e);
        Self {
            speed: self.speed + share * faster,
            ..Self::of(&add_scaled(&self.e, share, &turn))
        }
    }
}

impl Motion {
    /// Motion where the friction in the direction of the load is `h` times the load: rest above 1.
    fn at(h: f64, e: &Vector<3>, friction: SlipFriction) -> Self {
        if h >= 1.0 {
            Self::Rests(friction.scaled(1.0 / h))
        } else {
            let Slip { e, speed } = Slip::of(e);
            // e·load is 1 for the unscaled e
            Self::Slips(Slip {
                e,
                speed: (1.0 - h) * speed.recip(),
            })
        }
    }
}

/// The first of the shares 1, 1/2, 1/4, … whose trial is accepted.
fn first_share<T>(trial: impl Fn(f64) -> T, accepts: impl Fn(&T) -> bool) -> Option<T> {
    let mut share = 2.0;
    (0..HALVINGS)
        .map(|_| {
            share *= 0.5;
            trial(share)
        })
        .find(accepts)
}

/// From a kink of a convex function, a point in a direction in which it falls.
fn leave(cost: impl Fn(&Vector<3>) -> f64, from: &Vector<3>, direction: &Vector<3>) -> Vector<3> {
    let reach = norm(from) / norm(direction);
    let at = |share: f64| add_scaled(from, share * reach, direction);
    first_share(at, |to| cost(to) < cost(from)).unwrap_or(at(libm::exp2(-f64::from(HALVINGS))))
}

/// A symmetric matrix with a small part of its size added to its diagonal.
fn regular(mut matrix: [Vector<3>; 3]) -> [Vector<3>; 3] {
    let trace: f64 = (0..3).map(|i| matrix[i][i].abs()).sum();
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] += REGULAR * trace + f64::MIN_POSITIVE;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::exhaustive::numbers::Numbers;

    /// Some of them bear nothing.
    fn random_feet(numbers: &mut Numbers) -> [ScalarFoot; 3] {
        std::array::from_fn(|_| ScalarFoot {
            jx: 2.0 * numbers.next(),
            jy: 2.0 * numbers.next(),
            bound: match numbers.next() {
                ..-0.9 => 0.0,
                x => x.abs(),
            },
        })
    }

    /// Variational inequality of the minimum: load − v is in the friction's subdifferential at v.
    #[track_caller]
    fn is_solution(feet: &[ScalarFoot; 3], load: &Vector<3>, moved: &Moved) {
        let mut left = add_scaled(load, -1.0, &moved.v);
        for (foot, p) in feet.iter().zip(&moved.feet) {
            let slip = foot.slip(&moved.v);
            assert!(p[0].hypot(p[1]) <= foot.bound * (1.0 + 1e-12), "{moved:?}");
            let power = p[0] * slip[0] + p[1] * slip[1];
            let most = foot.bound * slip[0].hypot(slip[1]);
            assert!(power + most <= 1e-12 * (1.0 + norm(load)), "{moved:?}");
            left = add_scaled(&left, 1.0, &[p[0], p[1], foot.jx * p[0] + foot.jy * p[1]]);
        }
        assert!(
            norm(&left) <= 1e-12 * (1.0 + norm(load)),
            "{left:?} {moved:?}"
        );
    }

    #[test]
    fn feet_oppose_and_balance_random_loads_from_rest_to_slides() {
        let mut numbers = Numbers(1);
        let mut rests = 0;
        for case in 0..20_000 {
            let feet = random_feet(&mut numbers);
            let mut support = SupportFriction::new(&feet);
            let size = [0.3, 1.0, 3.0][case % 3];
            let load: Vector<3> = std::array::from_fn(|_| size * numbers.next());
            let moved = support.solve(&load);
            is_solution(&feet, &load, &moved);
            rests += usize::from(moved.v == [0.0; 3]);
        }
        assert!((2_000..18_000).contains(&rests), "{rests}");
    }

    #[test]
    fn loads_along_a_line_through_rest_pivots_and_creep_are_balanced() {
        let mut numbers = Numbers(2);
        for _ in 0..500 {
            let feet = random_feet(&mut numbers);
            let mut support = SupportFriction::new(&feet);
            let [from, along]: [Vector<3>; 2] =
                std::array::from_fn(|_| std::array::from_fn(|_| numbers.next()));
            // halve towards where rest ends
            let (mut a, mut b) = (-4.0, 4.0);
            for _ in 0..50 {
                let x = 0.5 * (a + b);
                let load = add_scaled(&from, x, &along);
                let moved = support.solve(&load);
                is_solution(&feet, &load, &moved);
                if moved.v == [0.0; 3] { a = x } else { b = x }
            }
        }
    }
}
