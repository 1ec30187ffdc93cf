//! A scene before a camera, with tags and calibration board: [`CameraSetup`].

use anyhow::Result;
use image::GrayImage;
use rayon::prelude::*;
use stickslip::dynamics::{Pose, Scene};
use stickslip_rendering::{
    self as rendering, Appearance, BoardPose, Camera, Lens, Optics, RecordedMotion, RenderScene,
    Renderer, TagMount, calibration_poses,
};
use stickslip_vision::{Board, BoardOnTable, BodyTag, TagPlace, Tags, tag_cells};

const OBJECT_TAG: u16 = 0;
const PUSHER_TAG: u16 = 1;
/// Room of the plate about the motion (m).
const PLATE_ROOM: f64 = 0.06;
/// Frames of the board are numbered from here, away from those of the experiment.
const BOARD_FRAMES: u64 = 1 << 40;
/// A board of 7 x 5 tags.
const BOARD: Board = Board {
    rows: 5,
    columns: 7,
    tag_size: 0.026,
    gap: 0.008,
    first_tag: 100,
};
/// Its thickness (m).
const THICKNESS: f64 = 0.003;

/// A scene before a camera.
#[derive(Clone, Debug)]
pub struct CameraSetup {
    /// The camera before the stage.
    pub renderer: Renderer,
    /// Tags of each body, and their places.
    pub tags: Tags,
    /// Height of the hand (m).
    pub hand_height: f64,
}

/// A recording of the calibration board.
#[derive(Clone, Debug)]
pub struct BoardFrames {
    print: rendering::Board,
    poses: Vec<BoardPose>,
    /// Place of the board in the first frame.
    pub on_table: BoardOnTable,
}

impl CameraSetup {
    /// A camera that sees all that happens in `recordings`; `seed` is that of all noise.
    pub fn new(
        scene: &Scene,
        recordings: &[RecordedMotion],
        optics: Optics,
        seed: u64,
    ) -> Result<Self> {
        let push = recordings
            .first()
            .map_or(0.0, RecordedMotion::push_direction);
        let mut appearance = Appearance::of(scene, cells(OBJECT_TAG), cells(PUSHER_TAG), push);
        let seen = recordings
            .iter()
            .map(|recorded| recorded.bounds(scene, &appearance));
        let [low, high] = seen.fold(
            [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]],
            |[low, high], [l, h]| {
                [
                    std::array::from_fn(|k| low[k].min(l[k])),
                    std::array::from_fn(|k| high[k].max(h[k])),
                ]
            },
        );
        appearance.plate = [low.map(|x| x - PLATE_ROOM), high.map(|x| x + PLATE_ROOM)];
        let camera = Camera::over(Lens::industrial(), [low, high])?;
        Ok(Self {
            renderer: Renderer::new(camera, RenderScene::new(scene, &appearance), optics, seed),
            tags: tags(&appearance),
            hand_height: (appearance.hand.heights[0] + appearance.hand.heights[1]) / 2.0,
        })
    }

    /// The calibration board in `count` poses.
    pub fn board(&self, count: usize) -> Result<BoardFrames> {
        let tags = BOARD.tags().map(cells).collect();
        let print = rendering::Board {
            columns: usize::from(BOARD.columns),
            tag_size: BOARD.tag_size,
            gap: BOARD.gap,
            tags,
        };
        let poses = calibration_poses(self.renderer.camera(), &print, THICKNESS, count)?;
        let [x, y, _] = poses[0].origin;
        Ok(BoardFrames {
            print,
            poses,
            on_table: BoardOnTable {
                board: BOARD,
                thickness: THICKNESS,
                pose: Pose::new(x, y, 0.0),
            },
        })
    }
}

impl BoardFrames {
    /// Every frame, made into something on any thread.
    pub fn frames<T: Send>(
        &self,
        setup: &CameraSetup,
        make: impl Fn(usize, GrayImage) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let frame = |(index, pose): (usize, &BoardPose)| {
            make(
                index,
                setup
                    .renderer
                    .board_frame(BOARD_FRAMES + index as u64, &self.print, pose),
            )
        };
        self.poses.par_iter().enumerate().map(frame).collect()
    }
}

fn cells(id: u16) -> rendering::TagCells {
    tag_cells(id).expect("the family has this tag")
}

fn tags(appearance: &Appearance) -> Tags {
    let of = |id: u16, mount: &Option<TagMount>| {
        let TagMount { tag, pose, height } = mount.expect("the standard appearance have both tags");
        BodyTag {
            id,
            place: TagPlace {
                size: tag.size,
                height,
                pose,
            },
        }
    };
    Tags {
        object: of(OBJECT_TAG, &appearance.object_tag),
        pusher: of(PUSHER_TAG, &appearance.pusher_tag),
    }
}
