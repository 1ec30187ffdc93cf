//! Sums over weighted particles, block by block: [`Sums`].

use stickslip_dynamics::{Friction, Lanes, Pose, Twist, sin_cos};
use stickslip_filter::{Block, WeightedSums};

use crate::angle::nearest_zero;
use crate::contact_slip::ContactSlip;
use crate::estimate::EstimateRow;
use crate::particle::set::chunk::{Column, LANES, flag, load_chunk, total};
use crate::particle::set::columns::{Columns, Flag, SlipFlags};

/// Column of θ.
pub(crate) const ANGLE: usize = Columns::POSE + 2;

/// Quantities that are averaged on the line, not on the circle: one `T` for each of these columns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Linear<T> {
    /// x and y of the object.
    pub position: [T; 2],
    /// The friction parameters.
    pub friction: Friction<T>,
}

impl<T> Linear<T> {
    /// Returns them in the order of [`Linear::COLUMNS`].
    #[inline(always)]
    fn fields(&self) -> [&T; 6] {
        let ([x, y], [mu_s, mu_p, mu_f, d_tri]) = (&self.position, self.friction.fields());
        [x, y, mu_s, mu_p, mu_f, d_tri]
    }

    #[inline(always)]
    fn fields_mut(&mut self) -> [&mut T; 6] {
        let ([x, y], [mu_s, mu_p, mu_f, d_tri]) = (&mut self.position, self.friction.fields_mut());
        [x, y, mu_s, mu_p, mu_f, d_tri]
    }

    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Linear<U> {
        Linear {
            position: self.position.map(&mut f),
            friction: self.friction.map(f),
        }
    }
}

impl Linear<f64> {
    /// Columns that hold them.
    const COLUMNS: [usize; 6] = {
        let friction = Columns::FRICTION;
        let (x, y) = (Columns::POSE, Columns::POSE + 1);
        [x, y, friction, friction + 1, friction + 2, friction + 3]
    };

    /// Combines two, number by number.
    pub fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut zipped = self;
        for (to, other) in zipped.fields_mut().into_iter().zip(other.fields()) {
            *to = f(*to, *other);
        }
        zipped
    }
}

/// Reference values near the mean; sums of deviations from them avoid cancellation.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// Position and friction.
    pub linear: Linear<f64>,
    /// θ.
    pub angle: f64,
}

impl Reference {
    /// The means of a row.
    pub fn of(row: &EstimateRow) -> Option<Self> {
        row.pose
            .zip(row.friction)
            .map(|(pose, friction)| Self::new(pose, friction))
    }

    /// A pose and friction values.
    pub fn new(pose: Pose, friction: Friction) -> Self {
        let position = [pose.x, pose.y];
        Self {
            linear: Linear { position, friction },
            angle: pose.theta,
        }
    }
}

/// Sums over angles of particles; d is the deviation from the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AngleSums<T> {
    /// Σ w sin d.
    pub sin: T,
    /// Σ w cos d.
    pub cos: T,
    /// Σ w d.
    pub first: T,
    /// Σ w d².
    pub second: T,
}

impl<T> AngleSums<T> {
    #[inline(always)]
    fn fields(&self) -> [&T; 4] {
        [&self.sin, &self.cos, &self.first, &self.second]
    }

    #[inline(always)]
    fn fields_mut(&mut self) -> [&mut T; 4] {
        let Self {
            sin,
            cos,
            first,
            second,
        } = self;
        [sin, cos, first, second]
    }
}

impl AngleSums<f64> {
    /// Standard deviation of the angles about their mean direction, `turn` from the reference, if
    /// none is on the other side of the circle.
    pub fn std_about(&self, turn: f64) -> f64 {
        (self.second - 2.0 * turn * self.first + turn * turn)
            .max(0.0)
            .sqrt()
    }
}

/// Weighted sums over some particles; d is the deviation from the reference.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    /// Σ w d.
    pub first: Linear<f64>,
    /// Σ w d².
    pub second: Linear<f64>,
    /// Σ w v.
    pub twist: Twist,
    /// Sums over θ.
    pub angle: AngleSums<f64>,
    /// Σ w d d of x and y, of x and θ, of y and θ.
    pub cross: [f64; 3],
    /// Largest |d| of the angles (rad).
    pub widest: f64,
    /// Number of particles whose last step was not solved.
    pub unsolved: f64,
    /// Number of these whose solver gave up.
    pub failed: f64,
    /// Σ w c_p.
    pub contact_pusher: f64,
    /// Σ w c_j of every fixel, then of every other finger.
    pub contact_others: Vec<f64>,
    /// Σ w of the particles whose object is held.
    pub held: f64,
    /// Slip of the object, Σ w of the particles that do so: on the pusher, then on every fixel
    /// and other finger.
    pub slips: Vec<ContactSlip>,
}

impl Sums {
    /// Sums over one block.
    #[inline(always)]
    pub fn evaluate(
        &mut self,
        block: &Block<'_>,
        weights: &[f64],
        reference: &Reference,
        columns: Columns,
    ) {
        let o = Column::ZERO;
        let mut first = Linear::<Column>::default();
        let mut second = Linear::<Column>::default();
        let mut twist = Twist::<Column>::default();
        let mut angle = AngleSums::<Column>::default();
        let mut cross = [o; 3];
        let (mut widest, mut unsolved, mut failed) = (o, o, o);
        for chunk in 0..block.len().div_ceil(LANES) {
            let of_column = |column: usize| load_chunk(block.column(column), chunk, 0.0);
            let w = load_chunk(weights, chunk, 0.0);

            // position and friction
            let (first, second) = (first.fields_mut(), second.fields_mut());
            let near = reference.linear.fields();
            let mut position = [o; 2];
            for (k, (first, second)) in first.into_iter().zip(second).enumerate() {
                let d = of_column(Linear::COLUMNS[k]) - *near[k];
                *first += w * d;
                *second += w * d * d;
                if k < 2 {
                    position[k] = d;
                }
            }

            // twist
            for (k, sum) in twist.fields_mut().into_iter().enumerate() {
                *sum += w * of_column(Columns::TWIST + k);
            }

            // angle, on the circle
            let d = nearest_zero(of_column(ANGLE) - reference.angle);
            let (sin, cos) = sin_cos(d);
            for (sum, value) in angle.fields_mut().into_iter().zip([sin, cos, d, d * d]) {
                *sum += w * value;
            }
            widest = widest.max(w.gt(o).zero_unless(d.abs()));
            let [x, y] = position;
            cross[0] += w * x * y;
            cross[1] += w * x * d;
            cross[2] += w * y * d;

            // how the steps ended
            unsolved += flag(block, Columns::UNSOLVED, chunk).zero_unless(Lanes::splat(1.0));
            failed += flag(block, Columns::FAILED, chunk).zero_unless(Lanes::splat(1.0));
        }
        self.first = first.map(total);
        self.second = second.map(total);
        self.twist = twist.map(total);
        let [sin, cos, d, square] = angle.fields().map(|sum| total(*sum));
        self.angle = AngleSums {
            sin,
            cos,
            first: d,
            second: square,
        };
        self.cross = cross.map(total);
        self.widest = widest.0.into_iter().fold(0.0, f64::max);
        self.unsolved = total(unsolved);
        self.failed = total(failed);
        self.contact_pusher = share(block, weights, Columns::CONTACT_PUSHER);
        self.held = share(block, weights, Columns::HELD);
        self.contact_others.clear();
        self.slips.clear();
        let how = (Columns::CONTACT_PUSHER, Columns::SLIP_PUSHER);
        self.slips
            .push(slips(block, weights, self.contact_pusher, how));
        for j in 0..columns.others() {
            let contact = columns.contact_other(j);
            let touch = share(block, weights, contact);
            self.contact_others.push(touch);
            let how = (contact, columns.slip_other(j));
            self.slips.push(slips(block, weights, touch, how));
        }
    }
}

/// Returns the weight of the particles whose flag is set.
#[inline(always)]
fn share(block: &Block<'_>, weights: &[f64], which: Flag) -> f64 {
    let mut sum = Column::ZERO;
    for chunk in 0..block.len().div_ceil(LANES) {
        sum += flag(block, which, chunk).zero_unless(load_chunk(weights, chunk, 0.0));
    }
    total(sum)
}

/// Returns the weight of the particles that stick and slide on a body, which particles of weight
/// `touch` touch: in most blocks none.
#[inline(always)]
fn slips(
    block: &Block<'_>,
    weights: &[f64],
    touch: f64,
    (contact, slip): (Flag, SlipFlags),
) -> ContactSlip {
    if touch <= 0.0 {
        return ContactSlip::default();
    }
    let mut sums = [Column::ZERO; 3];
    for chunk in 0..block.len().div_ceil(LANES) {
        let w = load_chunk(weights, chunk, 0.0);
        let touches = flag(block, contact, chunk);
        let stick = touches & flag(block, slip.stick, chunk);
        let left = touches & flag(block, slip.left, chunk);
        let right = touches & !stick & !left;
        for (sum, of) in sums.iter_mut().zip([stick, left, right]) {
            *sum += of.zero_unless(w);
        }
    }
    let [stick, left, right] = sums.map(total);
    ContactSlip { stick, left, right }
}

impl WeightedSums for Sums {
    fn clear(&mut self) {
        let mut contact_others = std::mem::take(&mut self.contact_others);
        let mut slips = std::mem::take(&mut self.slips);
        contact_others.clear();
        slips.clear();
        *self = Self {
            contact_others,
            slips,
            ..Self::default()
        };
    }

    fn add(&mut self, other: &Self, share: f64) {
        let add = |to: &mut f64, from: &f64| *to += share * from;
        let linear = [
            (&mut self.first, &other.first),
            (&mut self.second, &other.second),
        ];
        for (to, from) in linear {
            let pairs = to.fields_mut().into_iter().zip(from.fields());
            pairs.for_each(|(to, from)| add(to, from));
        }
        let twist = self.twist.fields_mut().into_iter();
        twist
            .zip(other.twist.fields())
            .for_each(|(to, from)| add(to, from));
        let angle = self.angle.fields_mut().into_iter();
        angle
            .zip(other.angle.fields())
            .for_each(|(to, from)| add(to, from));
        let cross = self.cross.iter_mut().zip(&other.cross);
        cross.for_each(|(to, from)| add(to, from));
        add(&mut self.contact_pusher, &other.contact_pusher);
        add(&mut self.held, &other.held);
        let others = other.contact_others.len();
        self.contact_others.resize(others, 0.0);
        let others = self.contact_others.iter_mut().zip(&other.contact_others);
        others.for_each(|(to, from)| add(to, from));
        self.slips.resize(other.slips.len(), ContactSlip::default());
        for (to, from) in self.slips.iter_mut().zip(&other.slips) {
            add(&mut to.stick, &from.stick);
            add(&mut to.left, &from.left);
            add(&mut to.right, &from.right);
        }
        self.widest = self.widest.max(other.widest);
        self.unsolved += other.unsolved;
        self.failed += other.failed;
    }
}
