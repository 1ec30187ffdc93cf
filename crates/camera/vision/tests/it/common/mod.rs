//! A rendered rig with known truth: a square object, a round pusher, a tag board, an overhead
//! camera.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::sync::LazyLock;

use image::GrayImage;
use stickslip_dynamics::{Pose, Scene};
use stickslip_filter::Streams;
use stickslip_rendering::{
    self as rendered, Appearance, BodyPoses, Exposure, Optics, RenderScene, Renderer, TagMount,
};
use stickslip_testkit::{disc, fixels, pushed_scene, square};
use stickslip_vision::{
    Board, BoardOnTable, BoardRecording, BodyTag, Calibration, CalibrationError, Camera,
    Measurement, Sighting, TagPlace, Tags, Track, TrackError, calibrate, search_board, tag_cells,
    track,
};

pub const OBJECT_TAG: u16 = 3;
pub const PUSHER_TAG: u16 = 7;
/// Height of the board's print above the table (m).
pub const BOARD_THICKNESS: f64 = 0.003;

/// The rig that tests share.
pub static RIG: LazyLock<Rig> = LazyLock::new(|| Rig::new(Optics::default(), 1));
/// Twelve frames of its board.
pub static BOARD: LazyLock<(BoardRecording, BoardOnTable)> = LazyLock::new(|| {
    let (frames, board) = RIG.board_frames(12);
    (found(&frames), board)
});
/// Its calibration from them.
pub static CALIBRATION: LazyLock<Calibration> =
    LazyLock::new(|| calibrate(&BOARD.0, &BOARD.1, 0).unwrap());

/// A rendered rig.
pub struct Rig {
    pub renderer: Renderer,
    pub tags: Tags,
}

/// A square of 50 mm, a pusher with a radius of 6 mm, three fixels.
pub fn scene() -> Scene {
    let positions = [[0.13, 0.018], [0.13, -0.02], [0.12, 0.06]];
    pushed_scene(square(0.05), disc(0.006), fixels(&disc(0.005), &positions))
}

/// The true camera: 0.62 m above the table, tilted by 5.5 degrees.
pub fn true_camera() -> rendered::Camera {
    rendered::Camera::look_at(
        rendered::Lens::industrial(),
        [0.02, -0.06, 0.62],
        [0.02, 0.0],
    )
    .unwrap()
}

impl Rig {
    /// The rig through some optics; the object's tag is off its middle and turned.
    pub fn new(optics: Optics, seed: u64) -> Self {
        let cells = |id| tag_cells(id).unwrap();
        let mut appearance = Appearance::of(&scene(), cells(OBJECT_TAG), cells(PUSHER_TAG), 0.0);
        let mount = appearance.object_tag.as_mut().unwrap();
        mount.pose = Pose::new(0.003, -0.002, 0.2);
        let of = |id, mount: &Option<TagMount>| {
            let TagMount { tag, pose, height } = mount.unwrap();
            BodyTag {
                id,
                place: TagPlace {
                    size: tag.size,
                    height,
                    pose,
                },
            }
        };
        let tags = Tags {
            object: of(OBJECT_TAG, &appearance.object_tag),
            pusher: of(PUSHER_TAG, &appearance.pusher_tag),
        };
        Self {
            renderer: Renderer::new(
                true_camera(),
                RenderScene::new(&scene(), &appearance),
                optics,
                seed,
            ),
            tags,
        }
    }

    /// Frames of a board of 7 x 5 tags, and where it lies in the first one.
    pub fn board_frames(&self, count: usize) -> (Vec<GrayImage>, BoardOnTable) {
        let board = Board {
            rows: 5,
            columns: 7,
            tag_size: 0.026,
            gap: 0.008,
            first_tag: 100,
        };
        let tags = board.tags().map(|id| tag_cells(id).unwrap()).collect();
        let print = rendered::Board {
            columns: 7,
            tag_size: board.tag_size,
            gap: board.gap,
            tags,
        };
        let poses =
            rendered::calibration_poses(self.renderer.camera(), &print, BOARD_THICKNESS, count)
                .unwrap();
        let frames = poses
            .iter()
            .zip(0..)
            .map(|(pose, index)| self.renderer.board_frame(1_000_000 + index, &print, pose))
            .collect();
        let [x, y, _] = poses[0].origin;
        (
            frames,
            BoardOnTable {
                board,
                thickness: BOARD_THICKNESS,
                pose: Pose::new(x, y, 0.0),
            },
        )
    }

    /// Tracks rendered frames.
    pub fn track(&self, frames: &[GrayImage], camera: &Camera) -> Result<Track, TrackError> {
        track(
            frames.len(),
            |index| Ok((format!("{index}.png"), frames[index].clone())),
            camera,
            &self.tags,
        )
    }

    /// Frames with object and pusher at `count` random places, moving by `travel` (m, rad) while
    /// the shutter is open.
    pub fn random_frames(
        &self,
        count: u64,
        travel: Pose,
        seed: u64,
    ) -> (Vec<GrayImage>, Vec<[Pose; 2]>) {
        let truth: Vec<[Pose; 2]> = (0..count).map(|index| random_poses(index, seed)).collect();
        let at = |[object, pusher]: [Pose; 2], share: f64| {
            let moved = |pose: Pose| {
                Pose::new(
                    pose.x + share * travel.x,
                    pose.y + share * travel.y,
                    pose.theta + share * travel.theta,
                )
            };
            BodyPoses {
                object: Some(moved(object)),
                pusher: Some(moved(pusher)),
                ..BodyPoses::default()
            }
        };
        let frame = |(poses, index): (&[Pose; 2], u64)| {
            self.renderer.frame(
                seed * 10_000 + index,
                &Exposure {
                    start: at(*poses, -0.5),
                    end: at(*poses, 0.5),
                },
            )
        };
        (truth.iter().zip(0..).map(frame).collect(), truth)
    }
}

/// Object and pusher somewhere on the plate, apart from each other.
fn random_poses(index: u64, seed: u64) -> [Pose; 2] {
    let draw = Streams::new(seed).at(index);
    let between = |k: u32, low: f64, high: f64| low + (high - low) * draw.uniform(0, k);
    let object = Pose::new(
        between(0, -0.01, 0.13),
        between(1, -0.07, 0.07),
        between(2, -3.1, 3.1),
    );
    [
        object,
        Pose::new(
            object.x - 0.050,
            object.y + between(3, -0.015, 0.015),
            between(4, -0.3, 0.3),
        ),
    ]
}

/// The tags of frames, named by their numbers.
pub fn found(frames: &[GrayImage]) -> BoardRecording {
    let load =
        |index: usize| Ok::<_, CalibrationError>((format!("{index}.png"), frames[index].clone()));
    search_board(frames.len(), load).unwrap()
}

/// Errors of poses against their truth.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    /// x, y (m), theta (rad), in the body's frame.
    pub errors: Vec<[f64; 3]>,
    /// Predicted standard deviations.
    pub stds: Vec<[f64; 3]>,
    /// Frames without a pose.
    pub missed: usize,
}

impl Errors {
    pub fn add(&mut self, sighting: &Sighting, truth: Pose) {
        let Sighting::Measured(measurement) = sighting else {
            self.missed += 1;
            return;
        };
        let error = error(measurement, truth);
        self.errors.push(error);
        self.stds.push(measurement.std());
    }

    pub fn bias(&self) -> [f64; 3] {
        self.mean(|error, _| error)
    }

    /// Standard deviations about the bias.
    pub fn spread(&self) -> [f64; 3] {
        let (squares, bias) = (self.mean(|error, _| error * error), self.bias());
        [0, 1, 2].map(|k| (squares[k] - bias[k] * bias[k]).sqrt())
    }

    /// Spread over root mean square prediction.
    pub fn ratio(&self) -> [f64; 3] {
        let predicted = self.mean(|_, std| std * std);
        [0, 1, 2].map(|k| self.spread()[k] / predicted[k].sqrt())
    }

    fn mean(&self, of: impl Fn(f64, f64) -> f64) -> [f64; 3] {
        let count = self.errors.len() as f64;
        [0, 1, 2].map(|k| {
            self.errors
                .iter()
                .zip(&self.stds)
                .fold(0.0, |sum, (error, std)| sum + of(error[k], std[k]) / count)
        })
    }
}

/// x, y, theta of a measurement less the truth, in the world.
fn error(measurement: &Measurement, truth: Pose) -> [f64; 3] {
    let turn = measurement.pose.theta - truth.theta;
    let turns = (turn / std::f64::consts::TAU).round();
    [
        measurement.pose.x - truth.x,
        measurement.pose.y - truth.y,
        turn - std::f64::consts::TAU * turns,
    ]
}
