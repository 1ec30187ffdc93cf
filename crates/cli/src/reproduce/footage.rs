//! An experiment from camera frames: [`Footage`] films the testbed, calibrates the camera from a
//! board and tracks the tags, all in memory.

use anyhow::{Context, Result};
use image::GrayImage;
use indicatif::ProgressBar;
use stickslip::Log;
use stickslip::dynamics::Pose;
use stickslip_rendering::{CaptureSettings, FrameGrabber, Optics, RecordedMotion, Video};
use stickslip_vision::{BoardRecording, Camera, calibrate, search_board, track};

use super::noise::Noise;
use super::recording::Recording;
use crate::film_set::FilmSet;
use crate::simulation::REPEATS;

/// Time that the shutter is open (s).
const EXPOSURE: f64 = 0.008;
/// Frames of the calibration board.
const BOARD_FRAMES: usize = 20;

/// One experiment before a camera, calibrated once for all seeds.
#[derive(Clone, Debug)]
pub struct Footage {
    set: FilmSet,
    camera: Camera,
}

/// A recording whose poses come from frames.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// The recording.
    pub recording: Recording,
    /// Tracked poses less true ones.
    pub noise: Noise,
}

impl Footage {
    /// Puts a camera before an experiment that is recorded several times, and calibrates it.
    pub fn new(recordings: &[&Recording], optics: Optics) -> Result<Self> {
        let scene = &recordings[0].experiment.setup.scene;
        let motions: Vec<RecordedMotion> = recordings
            .iter()
            .map(|recording| motion(recording))
            .collect();
        let set = FilmSet::new(scene, &motions, optics, 0)?;
        let board = set.board(BOARD_FRAMES)?;
        let frames: Vec<GrayImage> = board.frames(&set, |_, frame| Ok(frame))?;
        let load = |index: usize| {
            Ok::<_, anyhow::Error>((format!("board frame {index}"), frames[index].clone()))
        };
        let recording: BoardRecording = search_board(frames.len(), load)?;
        let camera = calibrate(&recording, &board.on_table, 0)
            .context("calibration of the rendered camera")?
            .camera;
        Ok(Self { set, camera })
    }

    /// Films a recording and tracks it.
    pub fn track(&self, recording: &Recording, progress: &ProgressBar) -> Result<Tracked> {
        let experiment = &recording.experiment;
        let motion = motion(recording);
        let grabber = FrameGrabber {
            repeat: REPEATS,
            seed: recording.seed,
        };
        let settings = CaptureSettings {
            exposure: EXPOSURE,
            grabber,
            covered: 0..0,
            hand_height: self.set.hand_height,
        };
        let film = Video {
            renderer: &self.set.renderer,
            motion: &motion,
            settings,
        };
        let load = |index: usize| {
            progress.inc(1);
            Ok::<_, anyhow::Error>((format!("frame {index}"), film.frame(index)))
        };
        let tracked = track(motion.time.len(), load, &self.camera, &self.set.tags)?;
        let log = Log {
            object: tracked.object(),
            pusher: tracked.pusher(),
            ..experiment.log.clone()
        };
        let noise = Noise::of(&log, &motion);
        let recording = Recording {
            experiment: stickslip_formats::Experiment {
                log,
                ..experiment.clone()
            },
            ..recording.clone()
        };
        Ok(Tracked { recording, noise })
    }
}

/// The true motion of object and pusher.
pub fn motion(recording: &Recording) -> RecordedMotion {
    let truth = recording
        .experiment
        .truth
        .as_ref()
        .expect("a simulated experiment has a truth");
    let pusher = truth.pusher.iter().map(|pose: &Pose| Some(*pose)).collect();
    RecordedMotion {
        time: truth.time.clone(),
        object: truth.pose.clone(),
        pusher,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::PaperExperiment;

    /// The first rows of a recording.
    fn beginning(recording: &Recording, rows: usize) -> Recording {
        let mut short = recording.clone();
        let (log, truth) = (
            &mut short.experiment.log,
            short.experiment.truth.as_mut().unwrap(),
        );
        log.time.truncate(rows);
        log.object.truncate(rows);
        log.pusher.truncate(rows);
        log.tactile
            .iter_mut()
            .for_each(|sensor| sensor.truncate(rows));
        truth.time.truncate(rows);
        truth.pose.truncate(rows);
        truth.pusher.truncate(rows);
        short
    }

    #[test]
    fn tracked_frames_and_simulated_poses_have_equal_noise() {
        let recording = Recording::simulate(PaperExperiment::A, 1).unwrap();
        let short = beginning(&recording, 60);
        let footage = Footage::new(&[&short], Optics::default()).unwrap();
        let Tracked {
            recording: tracked,
            noise,
        } = footage.track(&short, &ProgressBar::hidden()).unwrap();
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
        let tracked = tracked.told(noise.told());
        let seen = |recording: &Recording| {
            recording
                .experiment
                .log
                .object
                .iter()
                .take(60)
                .map(Option::is_some)
                .collect::<Vec<_>>()
        };
        assert_eq!(seen(&simulated), seen(&tracked));
        let other = Noise::of(&beginning(&simulated, 60).experiment.log, &motion(&short)).level();
        let ratio = other.object_mm / level.object_mm;
        assert!(
            (ratio - 1.0).abs() < 3.0 / (4.0_f64 * 59.0).sqrt(),
            "{ratio}"
        );
        assert_eq!(
            simulated.experiment.setup.camera,
            tracked.experiment.setup.camera
        );
        assert_eq!(simulated.experiment.truth, recording.experiment.truth);
    }
}
