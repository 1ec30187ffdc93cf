//! From poses to frames: [`Studio`].

use image::{ExtendedColorType, GrayImage, ImageEncoder, codecs::png};
use stickslip_dynamics::Pose;
use stickslip_filter::{Draw, Purpose, Streams};

use super::board::{Board, BoardPose, BoardView};
use super::body::{Body, Carrier};
use super::optics::Optics;
use super::sampler::{INSTANTS, SUBPIXELS, Sampler};
use super::stage::{Placed, Scenery, Stage};
use super::viewpoint::Camera;

/// Random numbers of a frame begin at this particle, so that they never coincide with those of
/// other sensors of the same seed.
pub(crate) const FIRST_DRAW: u32 = 1 << 30;

/// Poses of everything that moves, in the world frame; `None` is not in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Actors {
    /// The object.
    pub object: Option<Pose>,
    /// The pusher.
    pub pusher: Option<Pose>,
    /// The hand.
    pub hand: Option<Pose>,
}

/// Where everything is while the shutter is open: it moves evenly from one to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shutter {
    /// As it opens.
    pub open: Actors,
    /// As it closes.
    pub close: Actors,
}

/// A camera before a stage.
#[derive(Clone, Debug)]
pub struct Studio {
    camera: Camera,
    stage: Stage,
    optics: Optics,
    streams: Streams,
    sampler: Sampler,
    /// Light of the stage with nothing that moves, subpixel by subpixel.
    background: Vec<f32>,
}

impl Shutter {
    /// Nothing moves.
    pub fn still(actors: Actors) -> Self {
        Self {
            open: actors,
            close: actors,
        }
    }

    /// Poses of a carrier as the shutter opens and closes; `None` unless it is there for both.
    fn way(&self, carrier: Carrier) -> Option<[Pose; 2]> {
        let both = |of: fn(&Actors) -> Option<Pose>| Some([of(&self.open)?, of(&self.close)?]);
        match carrier {
            Carrier::Table => Some([Pose::default(); 2]),
            Carrier::Object => both(|actors| actors.object),
            Carrier::Pusher => both(|actors| actors.pusher),
            Carrier::Hand => both(|actors| actors.hand),
        }
    }
}

impl Studio {
    /// A camera before a stage; `seed` is that of all noise.
    pub fn new(camera: Camera, stage: Stage, optics: Optics, seed: u64) -> Self {
        let sampler = Sampler::new(&camera);
        let streams = Streams::new(seed).of(Purpose::Measure);
        let background = vec![
            0.0;
            camera
                .lens()
                .size
                .iter()
                .map(|n| *n as usize * SUBPIXELS)
                .product()
        ];
        let mut studio = Self {
            camera,
            stage,
            optics,
            streams,
            sampler,
            background,
        };
        studio.background =
            studio.light(&Shutter::still(Actors::default()), streams.at(0), |_| true);
        studio
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Frame number `index`.
    pub fn frame(&self, index: u64, shutter: &Shutter) -> GrayImage {
        let draw = self.streams.at(index);
        let light = self.light(shutter, draw, |bodies| {
            bodies
                .iter()
                .any(|placed| placed.body.carrier != Carrier::Table)
        });
        self.optics.develop(&light, self.camera.lens().size, draw)
    }

    /// Frame number `index` of a tag board over the bare plate.
    pub fn board_frame(&self, index: u64, board: &Board, pose: &BoardPose) -> GrayImage {
        let draw = self.streams.at(index);
        let view = BoardView {
            board,
            pose,
            around: self.stage.bare(),
        };
        let mut light = self.background.clone();
        self.sampler
            .tiles()
            .for_each(|tile| self.sampler.paint(&view, &tile, draw, &mut light));
        self.optics.develop(&light, self.camera.lens().size, draw)
    }

    /// The light that reaches the sensor: the background's, but for tiles whose bodies say that
    /// they are `worth` painting.
    fn light(
        &self,
        shutter: &Shutter,
        draw: Draw,
        worth: impl Fn(&[&Placed<'_>]) -> bool,
    ) -> Vec<f32> {
        let placed: Vec<Placed<'_>> = self
            .stage
            .bodies()
            .iter()
            .filter_map(|body| placed(body, shutter))
            .collect();
        let mut light = self.background.clone();
        for tile in self.sampler.tiles() {
            let seen = |placed: &&Placed<'_>| {
                let [[left, below], [right, above]] = self
                    .sampler
                    .ground(&tile, [placed.body.bottom, placed.body.top]);
                let [from, to] = placed.bounds();
                from[0] <= right && from[1] <= above && left <= to[0] && below <= to[1]
            };
            let bodies: Vec<&Placed<'_>> = placed.iter().filter(seen).collect();
            if worth(&bodies) {
                self.sampler.paint(
                    &Scenery {
                        bodies,
                        ..self.stage.bare()
                    },
                    &tile,
                    draw,
                    &mut light,
                );
            }
        }
        light
    }
}

/// A body that is there, at its places during an exposure.
fn placed<'a>(body: &'a Body, shutter: &Shutter) -> Option<Placed<'a>> {
    let [open, close] = shutter.way(body.carrier)?;
    let at = |instant: usize| {
        body.place(open.interpolate(close, (instant as f64 + 0.5) / INSTANTS as f64))
    };
    let places = if open == close {
        vec![body.place(open)]
    } else {
        (0..INSTANTS).map(at).collect()
    };
    Some(Placed { body, places })
}

/// A frame as PNG.
///
/// # Panics
/// If memory runs out.
pub fn encode_png(frame: &GrayImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    png::PngEncoder::new_with_quality(&mut bytes, png::CompressionType::Fast, png::FilterType::Sub)
        .write_image(
            frame.as_raw(),
            frame.width(),
            frame.height(),
            ExtendedColorType::L8,
        )
        .expect("a grey image of its own size can be written to memory");
    bytes
}
