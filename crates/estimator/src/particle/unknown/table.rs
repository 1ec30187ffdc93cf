//! Unknowns of the robust model besides friction: [`UNKNOWNS`], their one table (docs/model.md,
//! "Unknowns"). Three loops go over it: the first draw, the step of each row, and the ensemble
//! update, in [`moved`](super::moved). The units of their numbers are in [`units`](super::units).

use stickslip_dynamics::{Twist, on_widest};
use stickslip_filter::{BlockMut, Draw};

use crate::particle::set::chunk::{LANES, flag, load_chunk, squared, store_chunk};
use crate::particle::set::columns::{Columns, Flag};
use crate::particle::transition::propagation::{Propagation, Transition};
use crate::particle::transition::step_plan::{StepPlan, UNSEEN_PAIR};
use crate::setup::Setup;
use crate::tuning::JITTER;

/// An unknown of every particle: neighbouring columns, whose numbers have the standard normal
/// distribution as prior.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unknown {
    /// Its name.
    pub name: Name,
    /// Number of its columns, or of those of each fixel.
    pub numbers: usize,
    /// Event from which on measurements depend on it. Before, it is resampled from its prior.
    pub identified_by: Event,
    /// True if camera poses move it, (45).
    pub moved: bool,
}

/// Name of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Name {
    /// Offset of the pusher, or of a hand's first finger, from its logged poses: x, y
    /// (`pusher_offset`).
    PusherOffset,
    /// Turn of the pusher's fingers from their logged angles (`camera.pusher_orientation_std`).
    PusherTurn,
    /// ln of the scale of the rig (`roughness`).
    Roughness,
    /// ln of the camera's latency (`latency`).
    Latency,
    /// ln of the factor between the measured force and the table's friction (`wrench.scale_std`).
    ForceScale,
    /// Image of the feet: displacement x, y (`centre_of_friction`), turn (`tripod_angle`), and two
    /// numbers of ln of a stretch (`foot_stretch`).
    Feet,
    /// Offset of a fixel from its position, or of another finger from its logged poses: x, y
    /// (`fixel_position`, `pusher_offset`).
    OtherOffset,
}

/// Event that makes measurements depend on an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// The pusher comes near the object.
    PusherNear,
    /// The fixel, or the other finger, that the unknown belongs to comes near.
    OtherNear,
    /// The object moves.
    Motion,
}

/// The unknowns, in the order of their columns. Those of fixels and other fingers come last,
/// body by body.
pub(crate) const UNKNOWNS: [Unknown; 7] = [
    unknown(Name::PusherOffset, 2, Event::PusherNear, true),
    unknown(Name::PusherTurn, 1, Event::PusherNear, true),
    unknown(Name::Roughness, 1, Event::PusherNear, false),
    unknown(Name::Latency, 1, Event::PusherNear, true),
    unknown(Name::ForceScale, 1, Event::Motion, false),
    unknown(Name::Feet, 5, Event::Motion, true),
    unknown(Name::OtherOffset, 2, Event::OtherNear, true),
];

const fn unknown(name: Name, numbers: usize, identified_by: Event, moved: bool) -> Unknown {
    Unknown {
        name,
        numbers,
        identified_by,
        moved,
    }
}

/// One number of an unknown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Number {
    /// Its column.
    pub column: usize,
    /// Flag of the event that identifies it.
    pub identified: Flag,
    /// The unknown.
    pub of: Unknown,
}

/// Numbers of all unknowns.
pub(crate) fn numbers(columns: Columns) -> impl Iterator<Item = Number> {
    let kept = UNKNOWNS.into_iter().filter(move |of| columns.has(of.name));
    kept.flat_map(move |of| {
        let copies = match of.identified_by {
            Event::OtherNear => columns.others(),
            Event::PusherNear | Event::Motion => 1,
        };
        (0..copies).flat_map(move |other| {
            let identified = match of.identified_by {
                Event::PusherNear => Columns::PUSHER_WAS_NEAR,
                Event::OtherNear => columns.other_was_near(other),
                Event::Motion => Columns::identified(MU_S),
            };
            let first = columns.unknown(of.name, other);
            (first..first + of.numbers).map(move |column| Number {
                column,
                identified,
                of,
            })
        })
    })
}

/// Index of μ_s, the friction that takes part where the object moves.
const MU_S: usize = 0;

/// Pair of normal numbers of the objects that nothing has come near yet.
const UNTOUCHED_PAIR: u32 = UNSEEN_PAIR + 2;

/// Number of the first pair of normal numbers of a step: behind those of all substeps.
const FIRST_PAIR: u32 = 1 << 21;

/// Number of a particle's first normal number of the first draw.
const FIRST_NUMBER: u32 = 1 << 21;

/// Draws the unknowns of one particle from their priors.
pub(crate) fn draw(
    columns: Columns,
    (draw, particle): (Draw, u32),
    block: &mut BlockMut<'_>,
    i: usize,
) {
    for (k, number) in (FIRST_NUMBER..).zip(numbers(columns)) {
        block.column_mut(number.column)[i] = draw.normal(particle, k);
    }
}

impl Unknown {
    /// Returns false if a setup says that its value is exact.
    fn is_open(&self, setup: &Setup) -> bool {
        match self.name {
            Name::PusherTurn => setup.pusher_turn() > 0.0,
            Name::Feet => setup.support_is_uncertain(),
            Name::PusherOffset
            | Name::Roughness
            | Name::Latency
            | Name::ForceScale
            | Name::OtherOffset => true,
        }
    }
}

impl Propagation {
    /// Draws the unknowns for one step.
    pub(crate) fn draw_unknowns(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        draw: Draw,
        block: &mut BlockMut<'_>,
    ) {
        on_widest(
            self.level,
            #[inline(always)]
            || self.note_untouched(transition, block),
        );
        self.carried.fill(Twist::default());
        if let Some(pusher) = plan.unseen_pusher {
            self.normals_of(draw, UNSEEN_PAIR, block);
            self.carry(transition, plan, (pusher, draw), block);
        }
        if !plan.is_dark() && self.untouched.iter().any(|lanes| lanes.any()) {
            self.normals_of(draw, UNTOUCHED_PAIR, block);
            on_widest(
                self.level,
                #[inline(always)]
                || self.nudge(transition, plan, block),
            );
        }
        self.normals_of(draw, 0, block);
        on_widest(
            self.level,
            #[inline(always)]
            || self.draw_friction(transition, plan, block),
        );
        // drawn in every row of a fast pusher, its offset would be the largest of many when it
        // comes near
        if plan.noise_age == 0 && !plan.undisturbed {
            self.step_unknowns(transition, plan, draw, block);
        }
        on_widest(
            self.level,
            #[inline(always)]
            || {
                self.load_offsets(transition, block);
                self.load_support(transition, block);
            },
        );
        for (before, particles) in self.lag_before.iter_mut().zip(&self.particles) {
            *before = squared(particles.pusher_lag[0]);
        }
    }

    /// Fills the columns of normals, on the widest instructions.
    fn normals_of(&mut self, draw: Draw, pair: u32, block: &BlockMut<'_>) {
        on_widest(
            self.level,
            #[inline(always)]
            || self.draw_normals(draw, pair, block),
        );
    }

    /// Takes the step (34) of every unknown. Until something has identified it, it is resampled
    /// from its prior. Afterwards it takes a random step that keeps the prior, while the pusher
    /// moves.
    fn step_unknowns(
        &mut self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        draw: Draw,
        block: &mut BlockMut<'_>,
    ) {
        let open = numbers(*columns).filter(|number| number.of.is_open(setup));
        for (k, number) in (0..).zip(open) {
            let fourth = k % 4;
            on_widest(
                self.level,
                #[inline(always)]
                || {
                    if fourth == 0 {
                        self.draw_normals(draw, FIRST_PAIR + k / 2, block);
                    }
                    self.step_number(plan, &number, fourth as usize, block);
                },
            );
        }
    }

    /// Takes the step of one number, by the column `normals` of normal numbers.
    #[inline(always)]
    fn step_number(
        &self,
        plan: &StepPlan,
        number: &Number,
        normals: usize,
        block: &mut BlockMut<'_>,
    ) {
        for chunk in 0..block.len().div_ceil(LANES) {
            let identified = flag(&block.as_block(), number.identified, chunk);
            let column = block.column_mut(number.column);
            let before = load_chunk(column, chunk, 0.0);
            let fresh = load_chunk(&self.normals[normals], chunk, 0.0);
            let known = match plan.driven {
                true => before * (1.0 - JITTER * JITTER).sqrt() + fresh * JITTER,
                false => before,
            };
            store_chunk(column, chunk, &identified.select(known, fresh));
        }
    }
}
