//! Γ' for a block of particles (docs/method.md (19) to (22); paper eq. 6): noise, the step, and Φ,
//! which keeps only the parameters that took part.

use stickslip_dynamics::{
    Body, Dynamics, Friction, Lanes, Level, Mask, Outcome, Particles, StepWork, Support, Twist,
    on_widest,
};
use stickslip_filter::{BLOCK, BlockMut, Draw};

use crate::filter_model::FilterModel;
use crate::particle::set::chunk::{Column, FlagsMut, LANES, load_chunk, store_chunk};
use crate::particle::set::columns::Columns;
use crate::particle::set::observer::{Observer, SolvedStep};
use crate::particle::transition::closure::Cones;
use crate::particle::transition::involved::Involved;
use crate::particle::transition::noise_clock::{NOISE_STEP, sharing};
use crate::particle::transition::step_plan::{ParameterNoise, StepPlan};
use crate::particle::unknown::friction::note_identified;
use crate::setup::{Limits, Setup};

/// Chunks of particles in a block.
pub(crate) const CHUNKS: usize = BLOCK / LANES;

/// Speed above which an object counts as moving, mass-normalised (m/s) (Φ, docs/method.md (21);
/// paper Table I).
pub(crate) const MOVING: f64 = 1e-9;

/// Pairs of normal numbers: two for the parameters, then two for each force, which uses three of
/// the numbers.
const FORCE_PAIR: u32 = 2;

/// Γ' of one setup: what moves the particles.
#[derive(Clone, Debug)]
pub(crate) struct Transition<'o> {
    /// Γ of the scene.
    pub dynamics: Dynamics,
    /// Noise, limits and sensors.
    pub setup: Setup,
    /// Layout of the columns.
    pub columns: Columns,
    /// Observer of every step solved.
    pub observer: Option<&'o dyn Observer>,
}

/// Working memory for the particles of one block.
#[derive(Clone, Debug)]
pub struct Propagation {
    pub(crate) work: StepWork<LANES>,
    pub(crate) particles: [Particles<LANES>; CHUNKS],
    /// Friction drawn for the step.
    pub(crate) proposed: [Friction<Column>; CHUNKS],
    /// Offsets of each particle's fingers and fixels from their poses (robust model).
    pub(crate) pusher_offsets: Vec<[Column; 2]>,
    /// Turn of the pusher; empty if it is known (robust model).
    pub(crate) pusher_turn: Vec<Column>,
    pub(crate) fixel_offsets: Vec<[Column; 2]>,
    /// Ways by which the fingers yielded since the beginning of a plan; empty without one.
    pub(crate) yielded: Vec<[Column; 2]>,
    /// Image of the scene's feet of each particle; empty if they are known (robust model).
    pub(crate) supports: Vec<Support<Column>>,
    /// Square of the pusher's lag before the step (m²) (robust model).
    pub(crate) lag_before: [Column; CHUNKS],
    /// Impulse of the table's friction over the step (N s), with a force sensor (robust model).
    pub(crate) support: [[Column; 2]; CHUNKS],
    /// Velocities at which an unseen pusher carries objects along (robust model).
    pub(crate) carried: [Twist<Column>; CHUNKS],
    /// Particles that nothing has come near yet: no force disturbs them (robust model).
    pub(crate) untouched: [Mask<LANES>; CHUNKS],
    pub(crate) involved: [Involved; CHUNKS],
    /// Friction cones of one particle's contacts.
    pub(crate) cones: Cones,
    pub(crate) normals: [[f64; BLOCK]; 4],
    pub(crate) level: Level,
}

impl Default for Propagation {
    fn default() -> Self {
        Self {
            work: StepWork::default(),
            particles: [Particles::default(); CHUNKS],
            proposed: [Friction::default(); CHUNKS],
            pusher_offsets: Vec::new(),
            pusher_turn: Vec::new(),
            fixel_offsets: Vec::new(),
            yielded: Vec::new(),
            supports: Vec::new(),
            lag_before: [Column::ZERO; CHUNKS],
            support: [[Column::ZERO; 2]; CHUNKS],
            carried: [Twist::default(); CHUNKS],
            untouched: [Mask::splat(false); CHUNKS],
            involved: [Involved::NOTHING; CHUNKS],
            cones: Cones::default(),
            normals: [[0.0; BLOCK]; 4],
            level: Level::new(),
        }
    }
}

impl Propagation {
    /// Moves the particles of `block` over one step.
    pub fn propagate(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        draw: Draw,
        block: &mut BlockMut<'_>,
    ) {
        let (level, chunks) = (self.level, block.len().div_ceil(LANES));
        on_widest(
            level,
            #[inline(always)]
            || self.load(transition, plan, draw, block),
        );
        let model = transition.columns.model();
        if model == FilterModel::Robust {
            self.draw_unknowns(transition, plan, draw, block);
        }
        if plan.intended {
            self.stand_back(transition, chunks);
        }
        self.support.fill([Column::ZERO; 2]);
        let of_force = draw.before(plan.noise_age);
        for (part, input) in (0..).zip(&plan.substeps) {
            let pair = FORCE_PAIR + 2 * (part / sharing(input.h));
            on_widest(
                level,
                #[inline(always)]
                || self.apply_force(transition, plan, input.h, (of_force, pair), block),
            );
            if let Some(observer) = transition.observer {
                observer.before_step(input, &self.particles[..chunks]);
            }
            match model {
                FilterModel::Paper if !plan.intended => transition.dynamics.step_block(
                    input,
                    &mut self.particles[..chunks],
                    &mut self.work,
                ),
                _ => self.step_with_offsets(transition, input, chunks),
            }
            on_widest(
                level,
                #[inline(always)]
                || {
                    self.note_contacts(transition, chunks);
                    self.add_support(plan, chunks);
                },
            );
            if let Some(observer) = transition.observer.filter(|o| o.wants_steps()) {
                self.show(observer, block.len());
            }
        }
        if plan.intended {
            self.note_yields(transition, chunks);
        }
        on_widest(
            level,
            #[inline(always)]
            || {
                self.store(transition, plan, block);
                self.store_held(transition, plan, block);
            },
        );
        if model == FilterModel::Robust {
            self.weigh_step(transition, plan, block);
        }
    }

    /// Draws β̂ = β + w_β τ(β) within the physical limits; β̂ = β if the parameters are frozen
    /// (docs/method.md (20)).
    #[inline(always)]
    fn load(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        draw: Draw,
        block: &BlockMut<'_>,
    ) {
        let paper = transition.columns.model() == FilterModel::Paper;
        let drawn = paper && plan.parameter_noise == ParameterNoise::Drawn;
        if drawn {
            self.draw_normals(draw, 0, block);
        }
        let h = plan.duration();
        let most_lag = transition.setup.most_pusher_lag();
        let settings = &transition.setup.filter;
        let std = settings.parameter_std * (h / NOISE_STEP).sqrt();
        let limits = settings.limits.fields();
        for chunk in 0..block.len().div_ceil(LANES) {
            self.load_lags(&transition.columns, block, chunk);
            let particles = &mut self.particles[chunk];
            load_columns(block, Columns::POSE, chunk, particles.pose.fields_mut());
            load_columns(block, Columns::TWIST, chunk, particles.twist.fields_mut());
            load_columns(
                block,
                Columns::FRICTION,
                chunk,
                particles.friction.fields_mut(),
            );
            // a standing pusher goes on through no jam: what it yielded may be the bodies' compliance
            if !plan.intended && (paper || !plan.rests_unseen()) {
                particles.limit_pusher_lag(most_lag);
            }
            load_columns(
                block,
                Columns::WARM_START,
                chunk,
                particles.warm.fields_mut(),
            );
            self.involved[chunk] = Involved::NOTHING;
            if drawn {
                for (k, value) in self.particles[chunk]
                    .friction
                    .fields_mut()
                    .into_iter()
                    .enumerate()
                {
                    *value = disturbed(
                        *value,
                        load_chunk(&self.normals[k], chunk, 0.0) * std,
                        limits[k],
                    );
                }
            }
            self.proposed[chunk] = self.particles[chunk].friction;
        }
    }

    /// Fills the columns of normals with the pairs `pair` and `pair + 1`.
    #[inline(always)]
    pub(crate) fn draw_normals(&mut self, draw: Draw, pair: u32, block: &BlockMut<'_>) {
        let (len, first) = (block.len(), block.first_particle());
        self.draw_first_normals(draw, pair, block);
        let [_, _, c, d] = &mut self.normals;
        draw.normal_columns(first, pair + 1, &mut c[..len], &mut d[..len]);
    }

    /// Fills the first two columns of normals with the pair `pair`.
    #[inline(always)]
    pub(crate) fn draw_first_normals(&mut self, draw: Draw, pair: u32, block: &BlockMut<'_>) {
        let (len, first) = (block.len(), block.first_particle());
        let [a, b, ..] = &mut self.normals;
        draw.normal_columns(first, pair, &mut a[..len], &mut b[..len]);
    }

    /// Draws w_app for one substep: a share of μ_s m g per [`NOISE_STEP`] on each axis. The
    /// variance of its sum is proportional to the time that it lasts (docs/method.md (19)).
    #[inline(always)]
    fn apply_force(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        h: f64,
        (draw, pair): (Draw, u32),
        block: &BlockMut<'_>,
    ) {
        self.draw_normals(draw, pair, block);
        let Transition { setup, columns, .. } = transition;
        let scene = &setup.scene;
        let per_step = match columns.model() {
            FilterModel::Robust => setup.uncertainty.force_std,
            FilterModel::Paper => setup.filter.force_std,
        };
        let sharing = f64::from(sharing(h));
        let lasts = h * sharing;
        let share =
            per_step * scene.object.mass * scene.gravity * NOISE_STEP * (lasts / NOISE_STEP).sqrt()
                / sharing;
        let rho = scene.object.gyration_radius();
        for (chunk, particles) in self
            .particles
            .iter_mut()
            .enumerate()
            .take(block.len().div_ceil(LANES))
        {
            let disturbed = !(self.untouched[chunk] | Mask::splat(plan.undisturbed));
            let factor = match columns.model() {
                FilterModel::Robust => Self::force_factor(transition, plan, block, chunk),
                FilterModel::Paper => Lanes::splat(1.0),
            };
            let std = disturbed.zero_unless(particles.friction.mu_s * share * factor);
            for (k, (impulse, arm)) in particles
                .applied
                .fields_mut()
                .into_iter()
                .zip([1.0, 1.0, rho])
                .enumerate()
            {
                *impulse = std * arm * load_chunk(&self.normals[k], chunk, 0.0);
            }
            self.involved[chunk].moved = self.involved[chunk].moved | moving(&particles.twist, rho);
        }
    }

    /// Shows an observer the block's last step.
    fn show(&self, observer: &dyn Observer, particles: usize) {
        let reports = self.work.reports().as_flattened();
        for (i, report) in reports.iter().enumerate().take(particles) {
            observer.on_step(&SolvedStep {
                problem: &self.work.problem(i),
                bodies: &self.work.bodies(i),
                solution: &self.work.solution(i),
                report: *report,
            });
        }
    }

    /// Adds what took part in the last substep.
    #[inline(always)]
    fn note_contacts(&mut self, transition: &Transition<'_>, chunks: usize) {
        let scene = &transition.setup.scene;
        let rho = scene.object.gyration_radius();
        let pressed =
            |work: &StepWork<LANES>, chunk, body| work.normal_impulses(chunk, body).gt(Lanes::ZERO);
        for chunk in 0..chunks {
            let involved = &mut self.involved[chunk];
            involved.moved = involved.moved | moving(&self.particles[chunk].twist, rho);
            for i in 0..scene.pusher.fingers.len() {
                involved.pusher = involved.pusher | pressed(&self.work, chunk, Body::Finger(i));
            }
            for j in 0..scene.fixels.len() {
                involved.fixel = involved.fixel | pressed(&self.work, chunk, Body::Fixel(j));
            }
            for (lane, report) in self.work.reports()[chunk].iter().enumerate() {
                if report.outcome != Outcome::Solved {
                    involved.unsolved.set(lane, true);
                }
                if report.outcome == Outcome::Failed {
                    involved.failed.set(lane, true);
                }
            }
        }
    }

    /// Writes the block back; Φ keeps only the parameters that took part (docs/method.md (21);
    /// paper Table I).
    #[inline(always)]
    fn store(&mut self, transition: &Transition<'_>, plan: &StepPlan, block: &mut BlockMut<'_>) {
        for chunk in 0..block.len().div_ceil(LANES) {
            self.store_lags(&transition.columns, block, chunk);
            let (particles, involved) = (&self.particles[chunk], &self.involved[chunk]);
            store_columns(block, Columns::POSE, chunk, particles.pose.fields());
            let mut twist = particles.twist;
            if plan.pusher_is_back {
                self.slow_down(transition, plan, &mut twist);
            }
            for (twist, carried) in twist
                .fields_mut()
                .into_iter()
                .zip(self.carried[chunk].fields())
            {
                *twist += *carried;
            }
            store_columns(block, Columns::TWIST, chunk, twist.fields());
            store_columns(block, Columns::WARM_START, chunk, particles.warm.fields());
            let mut friction = Friction::default();
            load_columns(block, Columns::FRICTION, chunk, friction.fields_mut());
            let proposed = self.proposed[chunk].fields().into_iter();
            let mut phi = involved.phi();
            if transition.columns.model() == FilterModel::Robust {
                note_identified(&mut phi, block, chunk);
            }
            for ((kept, proposed), took_part) in friction
                .fields_mut()
                .into_iter()
                .zip(proposed)
                .zip(phi.fields())
            {
                *kept = took_part.select(*proposed, *kept);
            }
            store_columns(block, Columns::FRICTION, chunk, friction.fields());
            let mut flags = FlagsMut::new(block, chunk);
            flags.set(Columns::UNSOLVED, involved.unsolved);
            flags.set(Columns::FAILED, involved.failed);
            self.store_contacts(transition, plan, chunk, &mut flags);
            flags.write();
            if transition.columns.history() > 0 {
                store_columns(
                    block,
                    transition.columns.past_pose(plan.slot),
                    chunk,
                    particles.pose.fields(),
                );
            }
        }
    }
}

/// Returns the lanes in which ‖v‖, mass-normalised, is above [`MOVING`].
#[inline(always)]
pub(crate) fn moving(Twist { vx, vy, omega }: &Twist<Column>, rho: f64) -> Mask<LANES> {
    let turn = *omega * rho;
    (*vx * *vx + *vy * *vy + turn * turn).gt(Lanes::splat(MOVING * MOVING))
}

/// Returns β + β w within the limits (docs/method.md (20)).
#[inline(always)]
fn disturbed(value: Column, w: Column, limits: &Limits) -> Column {
    (value + value * w)
        .max(Lanes::splat(limits.min))
        .min(Lanes::splat(limits.max))
}

/// Reads one chunk of neighbouring columns; lanes past the last particle repeat it.
#[inline(always)]
pub(crate) fn load_columns<const N: usize>(
    block: &BlockMut<'_>,
    first_column: usize,
    chunk: usize,
    to: [&mut Column; N],
) {
    for (k, to) in to.into_iter().enumerate() {
        let column = block.column(first_column + k);
        *to = load_chunk(column, chunk, column[column.len() - 1]);
    }
}

/// Writes one chunk of neighbouring columns.
#[inline(always)]
pub(crate) fn store_columns<const N: usize>(
    block: &mut BlockMut<'_>,
    first_column: usize,
    chunk: usize,
    from: [&Column; N],
) {
    for (k, from) in from.into_iter().enumerate() {
        store_chunk(block.column_mut(first_column + k), chunk, from);
    }
}
