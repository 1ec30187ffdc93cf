//! From poses to frames: [`Renderer`].

use image::GrayImage;
use stickslip_filter::{Draw, Purpose, Streams};

use crate::board::{Board, BoardPose, BoardView};
use crate::camera::Camera;
use crate::exposure::{BodyPoses, Exposure};
use crate::optics::Optics;
use crate::prism::Parent;
use crate::render_scene::{PlacedPrism, RenderScene, VisiblePart};
use crate::sampler::{SUBPIXELS, Sampler};

/// A camera before a scene.
#[derive(Clone, Debug)]
pub struct Renderer {
    camera: Camera,
    scene: RenderScene,
    optics: Optics,
    streams: Streams,
    sampler: Sampler,
    /// Light of the scene with nothing that moves, subpixel by subpixel.
    background: Vec<f32>,
}

impl Renderer {
    /// A camera before a scene; `seed` is that of all noise.
    pub fn new(camera: Camera, scene: RenderScene, optics: Optics, seed: u64) -> Self {
        let streams = Streams::new(seed).of(Purpose::Measure);
        let [columns, rows] = camera.lens().size.map(|n| n as usize * SUBPIXELS);
        let mut renderer = Self {
            sampler: Sampler::new(&camera),
            camera,
            scene,
            optics,
            streams,
            background: vec![0.0; columns * rows],
        };
        let nothing = Exposure::at_rest(BodyPoses::default());
        renderer.background = renderer.light(&nothing, streams.at(0), |_| true);
        renderer
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Frame number `index`.
    pub fn frame(&self, index: u64, exposure: &Exposure) -> GrayImage {
        let draw = self.streams.at(index);
        let light = self.light(exposure, draw, |visible| {
            visible
                .iter()
                .any(|placed| placed.prism.parent != Parent::Table)
        });
        self.optics.capture(&light, self.camera.lens().size, draw)
    }

    /// Frame number `index` of a tag board over the bare plate.
    pub fn board_frame(&self, index: u64, board: &Board, pose: &BoardPose) -> GrayImage {
        let draw = self.streams.at(index);
        let view = BoardView {
            board,
            pose,
            around: self.scene.bare(),
        };
        let mut light = self.background.clone();
        self.sampler
            .tiles()
            .for_each(|tile| self.sampler.render(&view, &tile, draw, &mut light));
        self.optics.capture(&light, self.camera.lens().size, draw)
    }

    /// The light that reaches the sensor, subpixel by subpixel. It is that of the background,
    /// except in tiles where `differs` is true of the prisms that may be seen there: these are
    /// rendered again.
    fn light(
        &self,
        exposure: &Exposure,
        draw: Draw,
        differs: impl Fn(&[&PlacedPrism<'_>]) -> bool,
    ) -> Vec<f32> {
        let placed = self.scene.during(exposure);
        let mut light = self.background.clone();
        for tile in self.sampler.tiles() {
            let is_visible = |placed: &&PlacedPrism<'_>| {
                let heights = [placed.prism.bottom, placed.prism.top];
                let [[left, below], [right, above]] = self.sampler.seen_box(&tile, heights);
                let [from, to] = placed.bounds();
                from[0] <= right && from[1] <= above && left <= to[0] && below <= to[1]
            };
            let prisms: Vec<&PlacedPrism<'_>> = placed.iter().filter(is_visible).collect();
            if differs(&prisms) {
                let view = VisiblePart {
                    prisms,
                    ..self.scene.bare()
                };
                self.sampler.render(&view, &tile, draw, &mut light);
            }
        }
        light
    }
}
