//! A particle filter with Gaussian noise on the particles' poses after the contact step, which the
//! paper argues against (§III-B): [`PoseNoise`].
//!
//! Camera and touch weigh the particles as in the paper's model (docs/method.md (23), (24)), and a
//! collapse is the same (27). There is no random force, and friction is nominal. The contact flags
//! (22) are those of the poses after the noise.

use stickslip::dynamics::{
    Dynamics, Outcome, Particle, Particles, Placed, Pose, StepInput, StepWork, narrow_phase,
};
use stickslip::{Estimate, EstimateRow, NominalPredictor, Occlusion, RunError, Setup, wrapped};
use stickslip_dynamics::WarmStart;
use stickslip_evaluation::{Reference, Scores, score};
use stickslip_filter::{BLOCK, Block, BlockMut, Draw, Model, ParticleFilter, Settings};
use stickslip_formats::Experiment;

use super::overlap_count::OVERLAPPING;

/// Particles side by side.
const LANES: usize = 8;

/// Length of a row that the noise refers to (s).
const NOISE_STEP: f64 = 1.0 / 30.0;

/// Gap up to which bodies touch (m), docs/method.md (22).
const TOUCHING: f64 = 1e-4;

/// Best log-likelihood below which no particle explains a row, docs/method.md (27).
const COLLAPSED: f64 = -6.0;

/// Columns: pose, twist, lag of the pusher and warm start, then flags, the last ones of fixels.
const FAILED: usize = 8 + WarmStart::<f64>::LEN;
const OVERLAPS: usize = FAILED + 1;
const TOUCHES: usize = OVERLAPS + 1;

/// The filter's options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseNoise {
    /// Standard deviation of the noise on each position per row of 1/30 s (m); of the angle, this
    /// over the object's radius of gyration.
    pub position_std: f64,
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// A run of the filter, scored.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseNoiseRun {
    /// Its scores.
    pub scores: Scores,
    /// Rows at which no particle explained the camera.
    pub collapses: u32,
    /// Share of the particles, over all rows, that overlap a fixel by more than 0.1 mm.
    pub overlapping: f64,
}

impl PoseNoise {
    /// Runs the filter over an experiment with these rows hidden.
    ///
    /// # Errors
    /// The log has no pose to start from, or the scene no camera.
    pub fn run(&self, on: &Experiment, occlusion: Occlusion) -> Result<PoseNoiseRun, RunError> {
        let Experiment { setup, log, .. } = on;
        let predictor = NominalPredictor::new(setup, log)?;
        let hidden = occlusion.hidden(log);
        let model = PoseNoiseModel::new(setup, self.position_std, predictor.start)?;
        let settings = Settings {
            particles: self.particles,
            seed: self.seed,
            resample_below: setup.filter.resample_below,
            ..Settings::default()
        };
        let mut filter = ParticleFilter::new(model, settings)?;
        let mut estimate = Estimate {
            time: log.time.clone(),
            rows: vec![EstimateRow::default(); log.len()],
            ..Estimate::default()
        };
        estimate.rows[predictor.first].pose = Some(mean(&filter));

        // the step that leads to each row, then its measurements
        let (mut collapses, mut overlapping, mut touching) = (0, 0.0, TOUCHING);
        for row in predictor.first + 1..log.len() {
            let step = RowStep::new(&predictor, row, touching);
            touching = step.touching;
            let seen = RowSeen {
                pose: log.object[row].filter(|_| !hidden[row]),
                tactile: log.tactile.iter().map(|sensor| sensor[row]).collect(),
            };
            collapses += u32::from(filter.step(&step, Some(&seen)).collapsed());
            estimate.rows[row].pose = Some(mean(&filter));
            overlapping += filter.particles().column(OVERLAPS).sum::<f64>();
        }
        let steps = (log.len() - 1 - predictor.first) * self.particles;
        let scores = score(
            &estimate,
            &Reference::of(on),
            &hidden,
            setup.virtual_radius(),
        );
        Ok(PoseNoiseRun {
            scores,
            collapses,
            overlapping: overlapping / steps as f64,
        })
    }
}

/// The step to a row.
struct RowStep {
    substeps: Vec<StepInput>,
    /// Length (s).
    h: f64,
    /// Gap up to which a particle touches (m).
    touching: f64,
}

impl RowStep {
    /// The step to `row`; a standing pusher leaves the gap as it was.
    fn new(predictor: &NominalPredictor, row: usize, touching: f64) -> Self {
        let substeps = predictor.schedule().step(row - 1).to_vec();
        let h = substeps.iter().map(|step| step.h).sum();
        let pusher = substeps.last().and_then(|step| step.pusher);
        let pusher = pusher.filter(|_| predictor.schedule().driven(row - 1));
        let way = pusher.map(|pusher| h * libm::hypot(pusher[0].twist.vx, pusher[0].twist.vy));
        Self {
            substeps,
            h,
            touching: way.map_or(touching, |way| way.max(TOUCHING)),
        }
    }
}

/// Measurements of a row.
struct RowSeen {
    pose: Option<Pose>,
    tactile: Vec<Option<bool>>,
}

/// The model of [`PoseNoise`].
struct PoseNoiseModel {
    dynamics: Dynamics,
    setup: Setup,
    start: Pose,
    /// Standard deviations of a camera pose.
    camera_std: Pose,
    /// Standard deviations of the noise of a row of [`NOISE_STEP`].
    step_std: Pose,
}

impl PoseNoiseModel {
    fn new(setup: &Setup, position_std: f64, start: Pose) -> Result<Self, RunError> {
        let camera = setup.camera.ok_or(RunError::NoCamera)?;
        let turn_std = position_std / setup.virtual_radius();
        let std = camera.position_std;
        Ok(Self {
            dynamics: Dynamics::new(setup.scene.clone()),
            setup: setup.clone(),
            start,
            camera_std: Pose::new(std, std, camera.orientation_std),
            step_std: Pose::new(position_std, position_std, turn_std),
        })
    }

    /// Sets the flags of the fixels that particle `i` touches and overlaps.
    fn store_contacts(&self, pose: Pose, touching: f64, block: &mut BlockMut<'_>, i: usize) {
        let scene = self.dynamics.scene();
        let object = Placed::new(&scene.object.shape, pose);
        let flag = |yes: bool| f64::from(u8::from(yes));
        let (mut gaps, mut overlaps) = (Vec::new(), false);
        for (j, fixel) in scene.fixels.iter().enumerate() {
            gaps.clear();
            let fixel = Placed::new(&fixel.shape, fixel.pose);
            narrow_phase(&object, &fixel, touching, &mut gaps);
            block.column_mut(TOUCHES + j)[i] = flag(!gaps.is_empty());
            overlaps |= gaps.iter().any(|gap| gap.gap < -OVERLAPPING);
        }
        block.column_mut(OVERLAPS)[i] = flag(overlaps);
    }

    /// ln of the probability of the tactile readings given particle `i`, docs/method.md (24).
    fn of_touch(&self, seen: &RowSeen, block: &Block<'_>, i: usize) -> f64 {
        let tactile = &self.setup.tactile;
        let readings = seen.tactile.iter().enumerate();
        let ln = readings.filter_map(|(j, reading)| {
            let one = match block.column(TOUCHES + j)[i] > 0.0 {
                true => 1.0 - tactile.false_negative,
                false => tactile.false_positive,
            };
            Some(libm::log(if (*reading)? { one } else { 1.0 - one }))
        });
        ln.sum()
    }
}

impl Model for PoseNoiseModel {
    type Input = RowStep;
    type Observation = RowSeen;
    type Scratch = (StepWork<LANES>, Vec<Particles<LANES>>);
    type Sums = ();

    fn columns(&self) -> usize {
        TOUCHES + self.setup.scene.fixels.len()
    }

    fn scratch(&self) -> Self::Scratch {
        let chunks = vec![Particles::default(); BLOCK / LANES];
        (StepWork::default(), chunks)
    }

    fn initialise(&self, draw: Draw, block: &mut BlockMut<'_>) {
        for (i, particle) in block.particles() {
            let pose = disturbed(self.start, self.camera_std, draw.normals(particle, 0));
            store_pose(pose, block, i);
        }
    }

    fn propagate(
        &self,
        step: &RowStep,
        draw: Draw,
        block: &mut BlockMut<'_>,
        (work, chunks): &mut Self::Scratch,
    ) {
        // the contact step; lanes past the last particle repeat it
        let friction = self.dynamics.scene().nominal;
        let chunks = &mut chunks[..block.len().div_ceil(LANES)];
        for i in 0..chunks.len() * LANES {
            let mut particle = Particle::default();
            let lane = i.min(block.len() - 1);
            for (column, number) in numbers(&mut particle).enumerate() {
                *number = block.column(column)[lane];
            }
            particle.limit_pusher_lag(self.setup.most_pusher_lag());
            chunks[i / LANES].set(i % LANES, &particle, &friction);
        }
        block.column_mut(FAILED).fill(0.0);
        for input in &step.substeps {
            self.dynamics.step_block(input, chunks, work);
            let reports = work.reports().as_flattened();
            for (failed, report) in block.column_mut(FAILED).iter_mut().zip(reports) {
                if report.outcome == Outcome::Failed {
                    *failed = 1.0;
                }
            }
        }

        // the noise after it
        let scale = (step.h / NOISE_STEP).sqrt();
        for (i, index) in block.particles() {
            let mut particle = chunks[i / LANES].get(i % LANES);
            let std = self.step_std.map(|std| std * scale);
            particle.pose = disturbed(particle.pose, std, draw.normals(index, 0));
            for (column, number) in numbers(&mut particle).enumerate() {
                block.column_mut(column)[i] = *number;
            }
            self.store_contacts(particle.pose, step.touching, block, i);
        }
    }

    fn log_likelihood(&self, seen: &RowSeen, block: &Block<'_>, out: &mut [f64]) {
        self.resetting_log_likelihood(seen, block, out);
        for (i, out) in out.iter_mut().enumerate() {
            *out += self.of_touch(seen, block, i);
        }
    }

    /// That of the camera alone, docs/method.md (23).
    fn resetting_log_likelihood(&self, seen: &RowSeen, block: &Block<'_>, out: &mut [f64]) {
        let scale = self.setup.filter.likelihood_scale;
        let std = self.camera_std.map(|std| std * scale);
        for (i, out) in out.iter_mut().enumerate() {
            *out = seen.pose.map_or(0.0, |seen| {
                let [x, y, theta] = [0, 1, 2].map(|axis| block.column(axis)[i]);
                let (dx, dy) = ((x - seen.x) / std.x, (y - seen.y) / std.y);
                let turn = wrapped(theta - seen.theta) / std.theta;
                -0.5 * (dx * dx + dy * dy + turn * turn)
            });
        }
    }

    fn sum(&self, _: &RowStep, _: &Block<'_>, _: &[f64], (): &mut ()) {}

    fn may_be_copied(&self, block: &Block<'_>, i: usize) -> bool {
        block.column(FAILED)[i] == 0.0
    }

    fn collapsed(&self, best_log_likelihood: f64) -> bool {
        best_log_likelihood < COLLAPSED
    }

    fn reinitialise(&self, seen: &RowSeen, draw: Draw, block: &mut BlockMut<'_>) {
        for (i, particle) in block.particles() {
            if let Some(seen) = seen.pose {
                let pose = disturbed(seen, self.camera_std, draw.normals(particle, 0));
                store_pose(pose, block, i);
            }
        }
    }
}

/// Weighted mean of the particles, its angle on the circle, docs/method.md (28).
fn mean(filter: &ParticleFilter<PoseNoiseModel>) -> Pose {
    let mean = |column: usize, f: fn(f64) -> f64| filter.expectation(column, f);
    let turn = libm::atan2(mean(2, libm::sin), mean(2, libm::cos));
    Pose::new(mean(0, |x| x), mean(1, |y| y), turn)
}

/// A pose with noise of these standard deviations.
fn disturbed(pose: Pose, std: Pose, [x, y, theta]: [f64; 3]) -> Pose {
    Pose {
        x: pose.x + std.x * x,
        y: pose.y + std.y * y,
        theta: pose.theta + std.theta * theta,
    }
}

/// The numbers of a particle that columns keep, in their order.
fn numbers(particle: &mut Particle) -> impl Iterator<Item = &mut f64> {
    let body = particle.pose.fields_mut().into_iter();
    let body = body.chain(particle.twist.fields_mut());
    let body = body.chain(particle.pusher_lag[0].each_mut());
    body.chain(particle.warm.fields_mut())
}

fn store_pose(pose: Pose, block: &mut BlockMut<'_>, i: usize) {
    for (column, number) in pose.fields().into_iter().enumerate() {
        block.column_mut(column)[i] = *number;
    }
}

#[cfg(test)]
mod tests {
    use stickslip_evaluation::paper::PinnedScene;

    use super::*;

    /// A filter on a scene whose particles all start at one pose.
    fn filter(
        setup: &Setup,
        (start, position_std): (Pose, f64),
        particles: usize,
    ) -> ParticleFilter<PoseNoiseModel> {
        let mut model = PoseNoiseModel::new(setup, position_std, start).unwrap();
        model.camera_std = Pose::default();
        let settings = Settings {
            particles,
            ..Settings::default()
        };
        ParticleFilter::new(model, settings).unwrap()
    }

    /// Without noise and with one start, all particles are the nominal simulation, bit for bit.
    #[test]
    fn without_noise_it_is_the_nominal_simulation() {
        let scenes = PinnedScene::all();
        for scene in [&scenes[0], &scenes[20], &scenes[80]] {
            let Experiment { setup, log, .. } = scene.simulate().unwrap().experiment;
            let predictor = NominalPredictor::new(&setup, &log).unwrap();
            let nominal = predictor.predict(&[setup.scene.nominal.into()]).remove(0);
            assert!(nominal.poses.len() > 100);
            let mut filter = filter(&setup, (predictor.start, 0.0), 11);
            for (row, expected) in (predictor.first + 1..).zip(&nominal.poses[1..]) {
                let _ = filter.step(&RowStep::new(&predictor, row, TOUCHING), None);
                for i in 0..11 {
                    let [x, y, theta] = [0, 1, 2].map(|axis| filter.particles().value(i, axis));
                    let pose = Pose { x, y, theta };
                    assert_eq!(pose, *expected, "{}, row {row}", scene.name);
                }
            }
        }
    }

    /// The noise is as large as configured, and touch weighs particles by Bayes' rule.
    #[test]
    fn noise_spreads_the_particles_and_touch_weighs_them() {
        let setup = PinnedScene::all()[0].simulate().unwrap().experiment.setup;
        // an object whose lower face touches a fixel, which half of the particles then overlap
        let fixel = &setup.scene.fixels[0];
        let up = fixel.shape.bounding_radius() + 0.022_045;
        let start = Pose::new(fixel.pose.x, fixel.pose.y + up, 0.0);
        let mut filter = filter(&setup, (start, 1e-3), 2000);
        let step = |h: f64| RowStep {
            substeps: vec![StepInput { h, pusher: None }],
            h,
            touching: TOUCHING,
        };
        let _ = filter.step(&step(NOISE_STEP), None);
        let square = filter.expectation(0, |x| (x - start.x) * (x - start.x));
        assert!((square.sqrt() / 1e-3 - 1.0).abs() < 0.06, "{square}");
        let touching = filter.expectation(TOUCHES, |flag| flag);
        assert!((0.3..0.8).contains(&touching), "{touching}");

        let seen = RowSeen {
            pose: None,
            tactile: vec![Some(true), None, None],
        };
        let still = RowStep {
            substeps: Vec::new(),
            ..step(0.0)
        };
        let _ = filter.step(&still, Some(&seen));
        let tactile = &setup.tactile;
        let (hit, false_alarm) = (1.0 - tactile.false_negative, tactile.false_positive);
        let expected = hit * touching / (hit * touching + false_alarm * (1.0 - touching));
        let after = filter.expectation(TOUCHES, |flag| flag);
        assert!((after - expected).abs() < 1e-12, "{after}, {expected}");
    }
}
