//! Single camera images of a replicate, to draw poses on: [`CameraView`], [`Frame`].

use anyhow::Result;
use stickslip::dynamics::Pose;
use stickslip_evaluation::paper::Replicate;
use stickslip_rendering::{
    CaptureSettings, FrameGrabber, Optics, RecordedMotion, Video, encode_png,
};
use stickslip_report::{Body, CameraImage, Colour, Drawing, Overlay};

use super::filmed::motion;
use crate::camera_setup::CameraSetup;

/// Height of the object's upper face (m), where outlines are drawn.
const FACE: f64 = 0.020;
/// Width of a picture (px).
const WIDTH: f64 = 294.0;
/// Room about the bodies in a picture (px).
const ROOM: f64 = 28.0;

/// A replicate with a camera over it.
#[derive(Debug)]
pub struct CameraView<'a> {
    replicate: &'a Replicate,
    motion: RecordedMotion,
    setup: CameraSetup,
}

/// One of its images.
#[derive(Debug)]
pub struct Frame<'a> {
    camera: &'a CameraView<'a>,
    row: usize,
    png: Vec<u8>,
}

impl<'a> CameraView<'a> {
    /// Puts a camera over a replicate.
    pub fn new(replicate: &'a Replicate) -> Result<Self> {
        let motion = motion(replicate);
        let scene = &replicate.experiment.setup.scene;
        let setup = CameraSetup::new(
            scene,
            std::slice::from_ref(&motion),
            Optics::default(),
            replicate.seed,
        )?;
        Ok(Self {
            replicate,
            motion,
            setup,
        })
    }

    /// The image of a row of the log.
    pub fn frame(&'a self, row: usize) -> Frame<'a> {
        let settings = CaptureSettings {
            exposure: 0.0,
            grabber: FrameGrabber {
                repeat: 0.0,
                seed: 0,
            },
            covered: 0..0,
            hand_height: self.setup.hand_height,
        };
        let film = Video {
            renderer: &self.setup.renderer,
            motion: &self.motion,
            settings,
        };
        Frame {
            camera: self,
            row,
            png: encode_png(&film.frame(row)),
        }
    }

    /// Pixel at which a point of the object's upper face is seen, from the image's left and upper
    /// edge (px).
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        // pixels are numbered by their centres
        self.setup
            .renderer
            .camera()
            .project([x, y, FACE])
            .map(|pixel| pixel + 0.5)
    }

    /// The part of the image with object, pusher and fixels in it: two corners (px).
    fn view(&self, row: usize) -> [[f64; 2]; 2] {
        let scene = &self.replicate.experiment.setup.scene;
        let fixels = scene
            .fixels
            .iter()
            .map(|fixel| (fixel.pose, fixel.shape.bounding_radius()));
        let object = (
            self.motion.object[row],
            scene.object.shape.bounding_radius(),
        );
        let corners = fixels.chain([object]).flat_map(|(pose, r)| {
            [[-r, -r], [r, -r], [r, r], [-r, r]].map(|[x, y]| self.pixel([pose.x + x, pose.y + y]))
        });
        let empty = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let [low, high] = corners.fold(empty, |[low, high], pixel| {
            [
                std::array::from_fn(|k| low[k].min(pixel[k])),
                std::array::from_fn(|k| high[k].max(pixel[k])),
            ]
        });
        [low.map(|x| x - ROOM), high.map(|x| x + ROOM)]
    }
}

impl Frame<'_> {
    /// The image with the object's outline at a pose on it.
    pub fn with(&self, title: &str, pose: Option<Pose>, colour: Colour) -> Result<Drawing> {
        let shape = &self.camera.replicate.experiment.setup.scene.object.shape;
        let body = pose.map(|pose| Body::new("", shape, &pose, colour).filled(0.25));
        let overlay = Overlay {
            title: title.to_owned(),
            bodies: body.into_iter().collect(),
            view: Some(self.camera.view(self.row)),
            width: WIDTH,
        };
        Ok(overlay.drawing_on(&CameraImage {
            png: &self.png,
            pixel: &|point| Some(self.camera.pixel(point)),
        })?)
    }
}
