//! Replicates from camera frames, all in memory: a camera over the testbed is calibrated from a
//! board, films, and its frames are tracked ([`filmed`]).

use anyhow::{Context, Result};
use image::GrayImage;
use indicatif::ProgressBar;
use rayon::prelude::*;
use stickslip::Log;
use stickslip::dynamics::Pose;
use stickslip_evaluation::REPEATS;
use stickslip_evaluation::paper::{Noise, NoiseLevel, PaperExperiment, Replicate};
use stickslip_formats::{Experiment, Truth};
use stickslip_rendering::{CaptureSettings, FrameGrabber, Optics, RecordedMotion, Video};
use stickslip_vision::{BoardRecording, Camera, calibrate, search_board, track};

use super::setup::CameraSetup;
use crate::progress::{Work, bar};

/// Time that the shutter is open (s).
const EXPOSURE: f64 = 0.008;
/// Frames of the calibration board.
const BOARD_FRAMES: usize = 20;

/// A camera over one experiment, calibrated once for all seeds.
#[derive(Clone, Debug)]
struct CalibratedCamera {
    setup: CameraSetup,
    camera: Camera,
}

/// A replicate whose poses come from frames.
#[derive(Clone, Debug)]
struct Tracked {
    /// The replicate.
    replicate: Replicate,
    /// Tracked poses less true ones.
    noise: Noise,
}

/// The replicates from frames, the same from simulated poses of equal noise, and that noise by
/// experiment.
pub fn filmed(
    replicates: &[Replicate],
) -> Result<(Vec<Replicate>, Vec<Replicate>, Vec<NoiseLevel>)> {
    let frames = replicates.iter().map(|own| own.experiment.log.len()).sum();
    let progress = bar(frames, "frames", Work::Long);
    let (mut tracked, mut simulated, mut levels) = (Vec::new(), Vec::new(), Vec::new());
    for paper in PaperExperiment::ALL {
        // film and track all seeds before one calibrated camera
        let own = replicates.iter().filter(|own| own.paper == paper);
        let own: Vec<&Replicate> = own.collect();
        let camera = CalibratedCamera::new(&own, Optics::default())?;
        let seen: Vec<Tracked> = own
            .par_iter()
            .map(|replicate| camera.track(replicate, &progress))
            .collect::<Result<_>>()?;

        // simulate poses with the noise of all of them
        let noise = seen
            .iter()
            .fold(Noise::default(), |sum, tracked| sum.with(tracked.noise));
        levels.push(noise.level());
        simulated.extend(
            seen.par_iter()
                .map(|tracked| tracked.replicate.with_noise(&noise))
                .collect::<Result<Vec<_>, _>>()?,
        );
        let given = noise.given_camera();
        tracked.extend(seen.into_iter().map(|seen| seen.replicate.given(given)));
    }
    progress.finish_and_clear();
    Ok((tracked, simulated, levels))
}

impl CalibratedCamera {
    /// Puts a camera over an experiment with several replicates, and calibrates it.
    fn new(replicates: &[&Replicate], optics: Optics) -> Result<Self> {
        let scene = &replicates[0].experiment.setup.scene;
        let motions: Vec<RecordedMotion> = replicates
            .iter()
            .map(|replicate| motion(replicate))
            .collect();
        let setup = CameraSetup::new(scene, &motions, optics, 0)?;
        let board = setup.board(BOARD_FRAMES)?;
        let frames: Vec<GrayImage> = board.frames(&setup, |_, frame| Ok(frame))?;
        let load = |index: usize| {
            Ok::<_, anyhow::Error>((format!("board frame {index}"), frames[index].clone()))
        };
        let recording: BoardRecording = search_board(frames.len(), load)?;
        let camera = calibrate(&recording, &board.on_table, 0)
            .context("calibration of the rendered camera")?
            .camera;
        Ok(Self { setup, camera })
    }

    /// Films a replicate and tracks it.
    fn track(&self, replicate: &Replicate, progress: &ProgressBar) -> Result<Tracked> {
        let experiment = &replicate.experiment;
        let motion = motion(replicate);
        let grabber = FrameGrabber {
            repeat: REPEATS,
            seed: replicate.seed,
        };
        let settings = CaptureSettings {
            exposure: EXPOSURE,
            grabber,
            covered: 0..0,
            hand_height: self.setup.hand_height,
        };
        let film = Video {
            renderer: &self.setup.renderer,
            motion: &motion,
            settings,
        };
        let load = |index: usize| {
            progress.inc(1);
            Ok::<_, anyhow::Error>((format!("frame {index}"), film.frame(index)))
        };
        let tracked = track(motion.time.len(), load, &self.camera, &self.setup.tags)?;
        let log = Log {
            object: tracked.object(),
            pusher: tracked.pusher(),
            ..experiment.log.clone()
        };
        let noise = Noise::of(&log, truth(replicate));
        let replicate = Replicate {
            experiment: Experiment {
                log,
                ..experiment.clone()
            },
            ..replicate.clone()
        };
        Ok(Tracked { replicate, noise })
    }
}

/// The true motion of object and pusher.
fn motion(replicate: &Replicate) -> RecordedMotion {
    let truth = truth(replicate);
    let pusher = truth.pusher.iter().map(|pose: &Pose| Some(*pose)).collect();
    RecordedMotion {
        time: truth.time.clone(),
        object: truth.pose.clone(),
        pusher,
        other_fingers: Vec::new(),
    }
}

fn truth(replicate: &Replicate) -> &Truth {
    let truth = replicate.experiment.truth.as_ref();
    truth.expect("a simulated experiment has a truth")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first rows of a replicate.
    fn beginning(replicate: &Replicate, rows: usize) -> Replicate {
        let mut short = replicate.clone();
        let (log, truth) = (
            &mut short.experiment.log,
            short.experiment.truth.as_mut().unwrap(),
        );
        log.truncate(rows);
        truth.time.truncate(rows);
        truth.pose.truncate(rows);
        truth.pusher.truncate(rows);
        short
    }

    #[test]
    fn tracked_frames_and_simulated_poses_have_equal_noise() {
        let replicate = Replicate::simulate(PaperExperiment::A, 1).unwrap();
        let short = beginning(&replicate, 60);
        let camera = CalibratedCamera::new(&[&short], Optics::default()).unwrap();
        let Tracked {
            replicate: tracked,
            noise,
        } = camera.track(&short, &ProgressBar::hidden()).unwrap();
        let level = noise.level();
        // docs/guide/camera.md: micrometres and hundredths of a degree
        assert!(
            level.object_mm < 0.02
                && level.object_deg < 0.05
                && level.pusher_mm < 0.05
                && level.seen > 0.9,
            "{level:?}"
        );

        // the other arm misses the same frames, and its errors are as large: 2 n numbers tell a
        // deviation within 1 ± 3/√(4 n)
        let simulated = tracked.with_noise(&noise).unwrap();
        let tracked = tracked.given(noise.given_camera());
        let seen = |replicate: &Replicate| {
            replicate
                .experiment
                .log
                .object
                .iter()
                .take(60)
                .map(Option::is_some)
                .collect::<Vec<_>>()
        };
        assert_eq!(seen(&simulated), seen(&tracked));
        let other = Noise::of(&beginning(&simulated, 60).experiment.log, truth(&short)).level();
        let ratio = other.object_mm / level.object_mm;
        assert!(
            (ratio - 1.0).abs() < 3.0 / (4.0_f64 * 59.0).sqrt(),
            "{ratio}"
        );
        assert_eq!(
            simulated.experiment.setup.camera,
            tracked.experiment.setup.camera
        );
        assert_eq!(simulated.experiment.truth, replicate.experiment.truth);
    }
}
