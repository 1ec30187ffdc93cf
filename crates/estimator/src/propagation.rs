//! Γ' for a block of particles (eq. 6): noise, the step, and Φ, which keeps of the parameters what
//! took part.

use stickslip_dynamics::{Body, Lanes, Level, Mask, Outcome, Particles, StepWork, on_widest};
use stickslip_filter::{BLOCK, BlockMut, Draw};

use crate::Limits;
use crate::chunk::{Column, FlagsMut, LANES, part, store_part};
use crate::columns::Columns;
use crate::contact_model::{ContactModel, ParameterNoise, StepPlan};
use crate::watch::{SolvedStep, StepWatch};

/// Chunks of particles in a block.
const CHUNKS: usize = BLOCK / LANES;

/// Time step to which the noise settings refer (s).
const NOISE_STEP: f64 = 1.0 / 30.0;

/// Speed above which an object counts as moving, mass-normalised (m/s) (Φ, Table I).
const MOVING: f64 = 1e-9;

/// Pairs of normal numbers: two for the parameters, then two for the force in each substep, of
/// which three numbers are used.
const FORCE_PAIR: u32 = 2;

/// Working memory for the particles of one block.
#[derive(Debug)]
pub struct Propagation {
    work: StepWork<LANES>,
    particles: [Particles<LANES>; CHUNKS],
    touched: [Touched; CHUNKS],
    normals: [[f64; BLOCK]; 4],
    level: Level,
}

/// What took part in a step (Φ) and how it ended, by lane of a chunk.
#[derive(Clone, Copy, Debug)]
struct Touched {
    pusher: Mask<LANES>,
    fixel: Mask<LANES>,
    moved: Mask<LANES>,
    unsolved: Mask<LANES>,
}

impl Touched {
    const NOTHING: Self = {
        let no = Mask::splat(false);
        Self {
            pusher: no,
            fixel: no,
            moved: no,
            unsolved: no,
        }
    };
}

impl Default for Propagation {
    fn default() -> Self {
        Self {
            work: StepWork::default(),
            particles: [Particles::default(); CHUNKS],
            touched: [Touched::NOTHING; CHUNKS],
            normals: [[0.0; BLOCK]; 4],
            level: Level::new(),
        }
    }
}

impl Propagation {
    /// Moves the particles of `block` over one step.
    pub fn propagate(
        &mut self,
        model: &ContactModel<'_>,
        plan: &StepPlan,
        draw: Draw,
        block: &mut BlockMut<'_>,
    ) {
        let (level, chunks) = (self.level, block.len().div_ceil(LANES));
        on_widest(
            level,
            #[inline(always)]
            || self.load(model, plan, draw, block),
        );
        for (part, input) in plan.substeps.iter().enumerate() {
            let pair = FORCE_PAIR + 2 * part as u32;
            on_widest(
                level,
                #[inline(always)]
                || self.apply_force(model, input.h, draw, pair, block),
            );
            if let Some(watch) = model.watch {
                watch.before(input, &self.particles[..chunks]);
            }
            model
                .dynamics
                .step_block(input, &mut self.particles[..chunks], &mut self.work);
            on_widest(
                level,
                #[inline(always)]
                || self.note_contacts(model, chunks),
            );
            if let Some(watch) = model.watch {
                self.show(watch, block.len());
            }
        }
        on_widest(
            level,
            #[inline(always)]
            || self.store(model, plan, block),
        );
    }

    /// Draws β̂ = β + w_β τ(β) within the physical limits, β where the parameters are frozen.
    #[inline(always)]
    fn load(
        &mut self,
        model: &ContactModel<'_>,
        plan: &StepPlan,
        draw: Draw,
        block: &BlockMut<'_>,
    ) {
        let drawn = plan.parameter_noise == ParameterNoise::Drawn;
        if drawn {
            self.draw_normals(draw, 0, block);
        }
        let h: f64 = plan.substeps.iter().map(|step| step.h).sum();
        let most_lag = Lanes::splat(model.setup.most_pusher_lag());
        let settings = &model.setup.filter;
        let std = settings.parameter_std * (h / NOISE_STEP).sqrt();
        let limits = [
            &settings.mu_s,
            &settings.mu_p,
            &settings.mu_f,
            &settings.d_tri,
        ];
        for chunk in 0..block.len().div_ceil(LANES) {
            let particles = &mut self.particles[chunk];
            load_columns(block, Columns::POSE, chunk, &mut particles.pose);
            load_columns(block, Columns::TWIST, chunk, &mut particles.twist);
            load_columns(block, Columns::FRICTION, chunk, &mut particles.friction);
            load_columns(
                block,
                Columns::PUSHER_LAG,
                chunk,
                std::array::from_mut(&mut particles.pusher_lag),
            );
            particles.pusher_lag = particles.pusher_lag.min(most_lag);
            load_columns(block, Columns::WARM_START, chunk, &mut particles.warm);
            self.touched[chunk] = Touched::NOTHING;
            if drawn {
                for (k, value) in self.particles[chunk].friction.iter_mut().enumerate() {
                    *value = disturbed(*value, part(&self.normals[k], chunk, 0.0) * std, limits[k]);
                }
            }
        }
    }

    /// Fills the columns of normals with the pairs `pair` and `pair + 1`.
    #[inline(always)]
    fn draw_normals(&mut self, draw: Draw, pair: u32, block: &BlockMut<'_>) {
        let (len, first) = (block.len(), block.first_particle());
        let [a, b, c, d] = &mut self.normals;
        draw.normal_columns(first, pair, &mut a[..len], &mut b[..len]);
        draw.normal_columns(first, pair + 1, &mut c[..len], &mut d[..len]);
    }

    /// Draws w_app for one substep: a share of μ_s m g per [`NOISE_STEP`] on each axis, its
    /// variance proportional to h.
    #[inline(always)]
    fn apply_force(
        &mut self,
        model: &ContactModel<'_>,
        h: f64,
        draw: Draw,
        pair: u32,
        block: &BlockMut<'_>,
    ) {
        self.draw_normals(draw, pair, block);
        let scene = &model.setup.scene;
        let share = model.setup.filter.force_std
            * scene.object.mass
            * scene.gravity
            * NOISE_STEP
            * (h / NOISE_STEP).sqrt();
        let rho = scene.object.gyration_radius();
        for (chunk, particles) in self
            .particles
            .iter_mut()
            .enumerate()
            .take(block.len().div_ceil(LANES))
        {
            let std = particles.friction[0] * share;
            for (k, arm) in [1.0, 1.0, rho].into_iter().enumerate() {
                particles.applied[k] = std * arm * part(&self.normals[k], chunk, 0.0);
            }
            self.touched[chunk].moved = self.touched[chunk].moved | moving(&particles.twist, rho);
        }
    }

    /// Shows a watch the block's last step.
    fn show(&self, watch: &dyn StepWatch, particles: usize) {
        let reports = self.work.reports().as_flattened();
        for (i, report) in reports.iter().enumerate().take(particles) {
            watch.see(&SolvedStep {
                problem: &self.work.problem(i),
                solution: &self.work.solution(i),
                report: *report,
            });
        }
    }

    /// Adds what took part in the last substep.
    #[inline(always)]
    fn note_contacts(&mut self, model: &ContactModel<'_>, chunks: usize) {
        let scene = &model.setup.scene;
        let rho = scene.object.gyration_radius();
        let pressed =
            |work: &StepWork<LANES>, chunk, body| work.normal_impulses(chunk, body).gt(Lanes::ZERO);
        for chunk in 0..chunks {
            let touched = &mut self.touched[chunk];
            touched.moved = touched.moved | moving(&self.particles[chunk].twist, rho);
            touched.pusher = touched.pusher | pressed(&self.work, chunk, Body::Pusher);
            for j in 0..scene.fixels.len() {
                touched.fixel = touched.fixel | pressed(&self.work, chunk, Body::Fixel(j));
            }
            for (lane, report) in self.work.reports()[chunk].iter().enumerate() {
                if report.outcome != Outcome::Solved {
                    touched.unsolved.set(lane, true);
                }
            }
        }
    }

    /// Writes the block back; Φ keeps only the parameters that took part (Table I).
    #[inline(always)]
    fn store(&mut self, model: &ContactModel<'_>, plan: &StepPlan, block: &mut BlockMut<'_>) {
        let last_h = plan.substeps.last().map_or(0.0, |step| step.h);
        let touch_impulse = Lanes::splat(model.setup.tactile.touch_force * last_h);
        let rho = model.setup.scene.object.gyration_radius();
        let driven = Mask::splat(plan.driven);
        for chunk in 0..block.len().div_ceil(LANES) {
            let (particles, touched) = (&self.particles[chunk], &self.touched[chunk]);
            store_columns(block, Columns::POSE, chunk, &particles.pose);
            store_columns(block, Columns::TWIST, chunk, &particles.twist);
            store_columns(block, Columns::PUSHER_LAG, chunk, &[particles.pusher_lag]);
            store_columns(block, Columns::WARM_START, chunk, &particles.warm);
            let took_part = [touched.moved, touched.pusher, touched.fixel, touched.moved];
            for (k, took_part) in took_part.into_iter().enumerate() {
                let mut kept = [Lanes::ZERO];
                load_columns(block, Columns::FRICTION + k, chunk, &mut kept);
                store_columns(
                    block,
                    Columns::FRICTION + k,
                    chunk,
                    &[took_part.select(particles.friction[k], kept[0])],
                );
            }
            let mut flags = FlagsMut::new(block, chunk);
            flags.set(Columns::UNSOLVED, touched.unsolved);
            let pusher = self
                .work
                .normal_impulses(chunk, Body::Pusher)
                .gt(Lanes::ZERO);
            flags.set(Columns::CONTACT_PUSHER, pusher);
            let pressed = moving(&particles.twist, rho) | pusher;
            flags.set(Columns::IDLE, !(pressed & driven));
            for j in 0..model.setup.scene.fixels.len() {
                let touches = self
                    .work
                    .normal_impulses(chunk, Body::Fixel(j))
                    .gt(touch_impulse);
                flags.set(model.columns.contact_fixel(j), touches);
                let against = model.columns.against_fixel(j);
                let before = flags.get(against);
                flags.set(against, pressed & touches | !pressed & before);
            }
            flags.write();
            if model.columns.history() > 0 {
                store_columns(
                    block,
                    model.columns.past_pose(plan.slot),
                    chunk,
                    &particles.pose,
                );
            }
        }
    }
}

/// Where ‖v‖, mass-normalised, is above [`MOVING`].
#[inline(always)]
fn moving([vx, vy, omega]: &[Column; 3], rho: f64) -> Mask<LANES> {
    let turn = *omega * rho;
    (*vx * *vx + *vy * *vy + turn * turn).gt(Lanes::splat(MOVING * MOVING))
}

/// β + β w within the limits.
#[inline(always)]
fn disturbed(value: Column, w: Column, limits: &Limits) -> Column {
    (value + value * w)
        .max(Lanes::splat(limits.min))
        .min(Lanes::splat(limits.max))
}

/// Reads one chunk of neighbouring columns; lanes past the last particle repeat it.
#[inline(always)]
fn load_columns<const N: usize>(
    block: &BlockMut<'_>,
    first_column: usize,
    chunk: usize,
    to: &mut [Column; N],
) {
    for (k, to) in to.iter_mut().enumerate() {
        let column = block.column(first_column + k);
        *to = part(column, chunk, column[column.len() - 1]);
    }
}

/// Writes one chunk of neighbouring columns.
#[inline(always)]
fn store_columns<const N: usize>(
    block: &mut BlockMut<'_>,
    first_column: usize,
    chunk: usize,
    from: &[Column; N],
) {
    for (k, from) in from.iter().enumerate() {
        store_part(block.column_mut(first_column + k), chunk, from);
    }
}
