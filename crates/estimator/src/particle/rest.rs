//! Objects that rest: the place of one that nothing has come near (docs/method.md (44)), and small
//! displacements of one that the camera sees rest, (36).

use stickslip_filter::BlockMut;

use crate::particle::chunk::{LANES, load_chunk};
use crate::particle::model::write;
use crate::particle::noise_clock::NOISE_STEP;
use crate::particle::propagation::{Propagation, Transition};
use crate::particle::resting_pose::RestingPose;
use crate::particle::step_plan::StepPlan;

/// Standard deviation (m) per axis by which an object that the camera sees rest is displaced within
/// [`NOISE_STEP`].
const SHAKE: f64 = 3e-6;

impl Propagation {
    /// Redraws the pose of objects that nothing has come near: where they rest, or where they are
    /// after `h` (s) if they move all the same.
    pub(super) fn draw_resting_pose(
        &mut self,
        Transition { columns, .. }: &Transition<'_>,
        (resting, h): (&RestingPose, f64),
        block: &mut BlockMut<'_>,
    ) {
        let belief = resting.belief(h);
        for (i, _) in block.particles() {
            let (chunk, lane) = (i / LANES, i % LANES);
            if !self.untouched[chunk].lane(lane) {
                continue;
            }
            let [x, y, theta, _] = self.normals.each_ref().map(|column| column[i]);
            let pose = belief.at([x, y, theta]);
            let now = self.particles[chunk].pose.fields_mut();
            for (now, drawn) in now.into_iter().zip(pose.fields()) {
                now.0[lane] = *drawn;
            }
            for slot in 0..columns.history() {
                write(block, columns.past_pose(slot), i, pose.fields());
            }
            let noise = resting.noise_seen_at(&pose);
            write(block, columns.camera_noise(), i, noise.each_ref());
        }
    }

    /// Displaces objects that the camera sees rest. The ensemble update is one-sided at a contact:
    /// the next step undoes shifts into a touching body, and keeps shifts away from it. Also, no
    /// rig is still to the last micrometre.
    pub(super) fn shake(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        block: &BlockMut<'_>,
    ) {
        let rho = transition.setup.scene.object.gyration_radius();
        // rows that come faster share one draw of the noise
        let size = SHAKE * (plan.duration().max(NOISE_STEP) / NOISE_STEP).sqrt();
        for chunk in 0..block.len().div_ceil(LANES) {
            let touched = !self.untouched[chunk];
            let pose = self.particles[chunk].pose.fields_mut();
            let sizes = [size, size, size / rho];
            for (k, (value, size)) in pose.into_iter().zip(sizes).enumerate() {
                let way = load_chunk(&self.normals[k], chunk, 0.0) * size;
                *value += touched.zero_unless(way);
            }
        }
    }
}
