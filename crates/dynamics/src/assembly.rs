//! From particles to their mixed NCPs, `W` side by side: [`Assembly`].

use stickslip_lanes::{Lanes, Mask};

use crate::friction::Friction;
use crate::geometry::contact::Contact;
use crate::geometry::narrow_phase::NarrowPhase;
use crate::geometry::placed::{Placed, may_touch};
use crate::geometry::shape::Shape;
use crate::geometry::transform::Transform;
use crate::geometry::vec2::Vec2;
use crate::input::{Body, FingerMotion, MOST_FINGERS};
use crate::ncp::rows::{ContactRow, FootRow, Ncp};
use crate::ncp::unknowns::Unknowns;
use crate::particles::{ContactImpulse, Particles, REMEMBERED};
use crate::prepared_scene::{PreparedScene, StepBodies, StepContext};
use crate::scene::{Fixel, Scene};
use crate::se2::{Twist, Wrench};

/// Gaps and overlaps up to this are closed (m): an object at rest is not to creep after the
/// rounding of its contacts.
const CLOSED: f64 = 1e-8;

/// Gaps and overlaps up to this at the end of a step are zero for an object that stood, where the
/// pusher is rigid (m). The tail of a smoothed track creeps on for seconds, and asks a wedged
/// object to move by less than a nanometre a step. The creep adds up to an overlap that exceeds
/// `CLOSED` and then moves the object.
const STILL: f64 = 1e-9;

/// Cosine of the angle between the pusher's motion and a contact normal below which it is not the
/// motion that presses.
const PRESSING: f64 = 0.5;

/// Contact that each row of a chunk's problems stands for.
#[derive(Clone, Debug, Default)]
pub struct Assembly<const W: usize> {
    pub(crate) rows: Vec<Row<W>>,
    /// Gap below which contacts take part (m).
    search_distance: Lanes<W>,
    /// Direction in which each finger yields, lane by lane; zero while it is off the plane.
    pub(crate) directions: [[Lanes<W>; 2]; MOST_FINGERS],
    pub(crate) scaling: Scaling<W>,
}

/// Contact that a row stands for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<const W: usize> {
    pub(crate) body: Body,
    /// Names the contact from one step to the next.
    key: f64,
    /// The lanes that have the contact.
    pub(crate) present: Mask<W>,
    /// Its gap (m).
    pub(crate) gap: Lanes<W>,
}

/// Factors that turn SI units into those of rows, and back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Scaling<const W: usize> {
    pub(crate) mass: f64,
    pub(crate) inertia: f64,
    pub(crate) h: f64,
    /// 1/ρ.
    inv_rho: f64,
    /// 1/h.
    rate: f64,
    /// Gap velocities up to this are zero for an object that stands (m/s); 0 where the pusher
    /// yields.
    still: f64,
    /// F_stall h (N s); `None` where the pusher is rigid, or off the plane in every lane.
    pub(crate) stall: Option<f64>,
}

/// The other body of a pair during one step.
struct Other<'a, const W: usize> {
    body: Body,
    shape: &'a Shape,
    transform: Transform<Lanes<W>>,
    mu: Lanes<W>,
    motion: Option<FingerMotion<Lanes<W>>>,
    /// The lanes in which it may touch the object.
    active: Mask<W>,
}

impl<const W: usize> Assembly<W> {
    /// Contacts with gaps below `search_distance` (m) take part from now on.
    #[inline(always)]
    pub fn set_search_distance(&mut self, search_distance: Lanes<W>) {
        self.search_distance = search_distance;
    }

    /// Gap below which contacts are sought (m).
    #[inline(always)]
    pub fn search_distance(&self) -> Lanes<W> {
        self.search_distance
    }

    /// Writes the step's problems.
    #[inline(always)]
    pub fn collect(
        &mut self,
        prepared: &PreparedScene,
        bodies: StepBodies<'_, W>,
        particles: &Particles<W>,
        narrow: &mut NarrowPhase<W>,
        ncp: &mut Ncp<W>,
    ) {
        self.rows.clear();
        ncp.clear();
        let object = Transform::from(particles.pose);
        self.set_body(prepared, &bodies, (particles, &object), ncp);
        let scene = &prepared.scene;

        let fingers = scene.pusher.fingers.iter().enumerate().filter_map(
            #[inline(always)]
            |(i, shape)| {
                let finger = bodies.pushers.finger(bodies.chunk, i)?;
                Some(Other {
                    body: Body::Finger(i),
                    shape,
                    transform: finger.transform,
                    mu: particles.friction.mu_p,
                    motion: Some(finger.motion),
                    active: finger.present,
                })
            },
        );
        let fixels = scene.fixels.iter().zip(&prepared.fixels).enumerate().map(
            #[inline(always)]
            |(j, (Fixel { shape, .. }, transform))| {
                let mut transform: Transform<Lanes<W>> = transform.splat();
                if let Some([x, y]) = bodies.fixel_offsets.get(j) {
                    transform.origin[0] += *x;
                    transform.origin[1] += *y;
                }
                Other {
                    body: Body::Fixel(j),
                    shape,
                    transform,
                    mu: particles.friction.mu_f,
                    motion: None,
                    active: Mask::splat(true),
                }
            },
        );
        // one call for all bodies: what is inlined there is much code
        for mut other in fingers.chain(fixels) {
            if let (Body::Finger(i), Some(motion)) = (other.body, &other.motion) {
                self.directions[i] = motion.direction;
            }
            let near = self.may_touch(scene, &object, other.shape, other.transform.origin);
            other.active = other.active & near;
            if !other.active.any() {
                continue;
            }
            let first = self.rows.len();
            self.collide(scene, &object, &other, narrow, ncp);
            if let Body::Finger(i) = other.body {
                // which may stall
                self.let_finger_yield(i, first, particles, ncp);
            }
        }
    }

    /// Writes the direction in which a finger yields (docs/method.md (12)) into its contacts, which
    /// begin with row `first`. That is the direction of its motion where the motion presses on the
    /// object, else the normal of its nearest contact.
    #[inline(always)]
    fn let_finger_yield(
        &mut self,
        finger: usize,
        first: usize,
        particles: &Particles<W>,
        ncp: &mut Ncp<W>,
    ) {
        if self.scaling.stall.is_none() {
            return;
        }
        let rate = self.scaling.rate;
        let direction = &mut self.directions[finger];
        let contacts = &mut ncp.contacts[first..];
        // the normal of the nearest contact
        let mut nearest = Lanes::splat(f64::INFINITY);
        let mut normal = *direction;
        for (row, contact) in self.rows[first..].iter().zip(contacts.iter()) {
            let nearer = row.present & row.gap.lt(nearest);
            nearest = nearer.select(row.gap, nearest);
            for k in 0..2 {
                normal[k] = nearer.select(contact.n[k], normal[k]);
            }
        }
        let along = normal[0] * direction[0] + normal[1] * direction[1];
        let presses = along.gt(Lanes::splat(PRESSING));
        for k in 0..2 {
            direction[k] = presses.select(direction[k], normal[k]);
        }
        // the way from where it stands to its pose lies in the gap already
        let [x, y] = particles.pusher_lag[finger];
        let catch_up = [x * rate, y * rate];
        for contact in contacts {
            contact.let_yield(*direction, catch_up);
        }
    }

    /// Lanes in which the object may come nearer to a body than contacts are sought. A far body
    /// costs no more than this test.
    #[inline(always)]
    fn may_touch(
        &self,
        scene: &Scene,
        object: &Transform<Lanes<W>>,
        other: &Shape,
        origin: Vec2<Lanes<W>>,
    ) -> Mask<W> {
        may_touch(
            [&scene.object.shape, other],
            [object.origin, origin],
            self.search_distance,
        )
    }

    /// Sets all that does not depend on contacts: free velocity, feet, stall force.
    #[inline(always)]
    fn set_body(
        &mut self,
        &PreparedScene {
            ref scene,
            rho,
            inv_rho,
            inv_mass,
            inv_inertia,
            ref stance,
            ..
        }: &PreparedScene,
        &StepBodies {
            context: &StepContext { h, rate, .. },
            pushers,
            chunk,
            support,
            ..
        }: &StepBodies<'_, W>,
        (particles, object): (&Particles<W>, &Transform<Lanes<W>>),
        ncp: &mut Ncp<W>,
    ) {
        let (mass, inertia) = (scene.object.mass, scene.object.inertia);
        let stall = scene.pusher.stall_force.map(|force| force * h);
        let stall = stall.filter(|_| pushers.is_present(chunk));
        self.directions = [[Lanes::ZERO; 2]; MOST_FINGERS];
        self.scaling = Scaling {
            mass,
            inertia,
            h,
            inv_rho,
            rate,
            still: if stall.is_some() { 0.0 } else { STILL * rate },
            stall,
        };
        ncp.stall = Lanes::splat(stall.map_or(f64::INFINITY, |impulse| impulse / mass));
        let Twist { vx, vy, omega } = particles.twist;
        let Wrench { fx, fy, torque } = particles.applied;
        ncp.free = [
            vx + fx * inv_mass,
            vy + fy * inv_mass,
            (omega + torque * inv_inertia) * rho,
        ];
        let Friction { mu_s, d_tri, .. } = particles.friction;
        let arms = scene.foot_arms(stance, object, (d_tri, support));
        let loads = scene.foot_loads();
        for ((row, [x, y]), load) in ncp.feet.iter_mut().zip(arms).zip(loads) {
            *row = FootRow {
                jx: -y * inv_rho,
                jy: x * inv_rho,
                bound: mu_s * (scene.gravity * h * load),
            };
        }
    }

    /// Adds the contacts of the object with one body.
    #[inline(always)]
    fn collide(
        &mut self,
        scene: &Scene,
        object: &Transform<Lanes<W>>,
        other: &Other<'_, W>,
        narrow: &mut NarrowPhase<W>,
        ncp: &mut Ncp<W>,
    ) {
        let placed = Placed {
            shape: &scene.object.shape,
            transform: *object,
        };
        let other_placed = Placed {
            shape: other.shape,
            transform: other.transform,
        };
        narrow.collide(placed, other_placed, self.search_distance, other.active);
        for contact in narrow.contacts().filter(|contact| contact.present.any()) {
            let gap = contact.gap;
            let gap = gap.abs().gt(Lanes::splat(CLOSED)).zero_unless(gap);
            let key = (other.body.number() * Contact::<W>::ID_COUNT as usize + contact.id as usize)
                as f64;
            self.rows.push(Row {
                body: other.body,
                key,
                present: contact.present,
                gap,
            });
            ncp.contacts
                .push(row(&self.scaling, object, other, contact, gap));
        }
    }

    /// The impulses and twists that the particles remember, as a start.
    #[inline(always)]
    pub fn load_warm_start(&self, rho: f64, particles: &Particles<W>, p: &mut Unknowns<W>) {
        let Twist { vx, vy, omega } = particles.twist;
        p.v = [vx, vy, omega * rho];
        let warm = &particles.warm;
        p.feet = warm.feet;
        p.pusher_yield = warm.pusher_yield;
        p.normal.clear();
        p.tangential.clear();
        for row in &self.rows {
            let [p_n, p_t] = remembered(particles, row.key);
            p.normal.push(row.present.zero_unless(p_n));
            p.tangential.push(row.present.zero_unless(p_t));
        }
    }

    /// Remembers the impulses of lanes that are solved, of the contacts the first [`REMEMBERED`]
    /// that press, and where the fingers stand. Impulses of unsolved lanes would be a bad start:
    /// compliant impulses are a million times too large. So would be impulses that grow from step
    /// to step.
    #[inline(always)]
    pub fn store_warm_start(&self, p: &Unknowns<W>, solved: Mask<W>, particles: &mut Particles<W>) {
        let warm = &mut particles.warm;
        for (to, from) in warm
            .feet
            .as_flattened_mut()
            .iter_mut()
            .zip(p.feet.as_flattened())
        {
            *to = solved.zero_unless(*from);
        }
        warm.pusher_yield = solved.zero_unless(p.pusher_yield);
        let way = p.pusher_yield * self.scaling.h;
        for (lag, [x, y]) in particles.pusher_lag.iter_mut().zip(&self.directions) {
            *lag = match self.scaling.stall {
                Some(_) => [*x * way, *y * way],
                None => [Lanes::ZERO; 2],
            };
        }
        let kept = solved & p.is_bounded();
        warm.contacts = [ContactImpulse::default(); REMEMBERED];
        let mut filled = Lanes::ZERO;
        for ((row, p_n), p_t) in self.rows.iter().zip(&p.normal).zip(&p.tangential) {
            let pressed = kept & p_n.gt(Lanes::ZERO);
            if !pressed.any() {
                continue;
            }
            for (k, slot) in warm.contacts.iter_mut().enumerate() {
                let here: Mask<W> = pressed & !(filled - k as f64).abs().gt(Lanes::ZERO);
                slot.key = here.select(Lanes::splat(row.key), slot.key);
                slot.normal = here.select(*p_n, slot.normal);
                slot.tangential = here.select(*p_t, slot.tangential);
            }
            filled += pressed.zero_unless(Lanes::splat(1.0));
        }
    }
}

/// The row of one contact.
#[inline(always)]
fn row<const W: usize>(
    scaling: &Scaling<W>,
    object: &Transform<Lanes<W>>,
    other: &Other<'_, W>,
    contact: &Contact<W>,
    gap: Lanes<W>,
) -> ContactRow<W> {
    let Scaling {
        inv_rho,
        rate,
        still,
        ..
    } = *scaling;
    let Contact {
        present,
        normal: [nx, ny],
        arm: [x, y],
        ..
    } = *contact;
    let u = other.motion.as_ref().map_or([Lanes::ZERO; 2], |motion| {
        let arm = [
            object.origin[0] + x - motion.pose.x,
            object.origin[1] + y - motion.pose.y,
        ];
        let Twist { vx, vy, omega } = motion.twist;
        [arm[1] * -omega + vx, arm[0] * omega + vy]
    });
    let keep = |value: Lanes<W>| present.zero_unless(value);
    let closing = gap * rate - (nx * u[0] + ny * u[1]);
    ContactRow {
        n: [keep(nx), keep(ny), keep((x * ny - y * nx) * inv_rho)],
        t: [keep(-ny), keep(nx), keep((x * nx + y * ny) * inv_rho)],
        gap_offset: present.select(
            closing.abs().gt(Lanes::splat(still)).zero_unless(closing),
            ContactRow::<W>::OPEN.gap_offset,
        ),
        slip_offset: keep(ny * u[0] - nx * u[1]),
        nd: Lanes::ZERO,
        td: Lanes::ZERO,
        mu: keep(other.mu),
    }
}

/// Normal and tangential impulse over m of the contact `key` in the step before; 0 where it did not
/// press.
#[inline(always)]
fn remembered<const W: usize>(particles: &Particles<W>, key: f64) -> [Lanes<W>; 2] {
    let (mut p_n, mut p_t) = (Lanes::ZERO, Lanes::ZERO);
    for slot in &particles.warm.contacts {
        let same = !(slot.key - key).abs().gt(Lanes::ZERO);
        p_n = same.select(slot.normal, p_n);
        p_t = same.select(slot.tangential, p_t);
    }
    [p_n, p_t]
}
