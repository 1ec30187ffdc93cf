//! An experiment from camera frames: [`Footage`] films the testbed, calibrates the camera from a board and tracks the tags, all in memory.

use anyhow::{Context, Result};
use image::GrayImage;
use indicatif::ProgressBar;
use stickslip::Log;
use stickslip::dynamics::Pose;
use stickslip_testbed::camera::{Film, Grabber, Optics, Recorded, Take};
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
        let motions: Vec<Recorded> = recordings.iter().map(|recording| motion(recording)).collect();
        let set = FilmSet::new(scene, &motions, optics, 0)?;
        let board = set.board(BOARD_FRAMES)?;
        let frames: Vec<GrayImage> = board.frames(&set, |_, frame| Ok(frame))?;
        let load = |index: usize| Ok::<_, anyhow::Error>((format!("board frame {index}"), frames[index].clone()));
        let recording: BoardRecording = search_board(frames.len(), load)?;
        let camera = calibrate(&recording, &board.on_table, 0).context("calibration of the rendered camera")?.camera;
        Ok(Self { set, camera })
    }

    /// Films a recording and tracks it.
    pub fn track(&self, recording: &Recording, progress: &ProgressBar) -> Result<Tracked> {
        let experiment = &recording.experiment;
        let motion = motion(recording);
        let grabber = Grabber { repeat: REPEATS, seed: recording.seed };
        let take = Take { exposure: EXPOSURE, grabber, covered: 0..0, hand_height: self.set.hand_height };
        let film = Film { studio: &self.set.studio, recorded: &motion, take };
        let load = |index: usize| {
            progress.inc(1);
            Ok::<_, anyhow::Error>((format!("frame {index}"), film.frame(index)))
        };
        let tracked = track(motion.time.len(), load, &self.camera, &self.set.tags)?;
        let log = Log { object: tracked.object(), pusher: tracked.pusher(), ..experiment.log.clone() };
        let noise = Noise::of(&log, &motion);
        let recording = Recording { experiment: stickslip_formats::Experiment { log, ..experiment.clone() }, ..recording.clone() };
        Ok(Tracked { recording, noise })
    }
}

/// The true motion of object and pusher.
pub fn motion(recording: &Recording) -> Recorded {
    let truth = recording.experiment.truth.as_ref().expect("a simulated experiment has a truth");
    let pusher = truth.pusher.iter().map(|pose: &Pose| Some(*pose)).collect();
    Recorded { time: truth.time.clone(), object: truth.pose.clone(), pusher }
}
