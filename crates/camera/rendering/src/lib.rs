//! An overhead camera: frames of a scene as a real camera would deliver them.
//!
//! A [`Renderer`] sees a [`RenderScene`] (plate, fixels, object, pusher, their tags, a hand)
//! through a [`Camera`] (perspective, [`Lens`] distortion), and renders 8-bit grey frames. Every
//! quarter of a pixel is the mean over rays spread over its area and over the exposure. Defocus,
//! uneven light, shot and read noise follow ([`Optics`]). A [`Video`] shows a recorded motion frame
//! by frame; its [`FrameGrabber`] now and then delivers a frame twice. A [`Board`] of tags, held in
//! many poses, serves calibration.
//!
//! Lengths in m, world frame: x and y on the table, z up from it. Pixels: x right, y down, the
//! centre of the first pixel at (0, 0). Greys of surfaces are the shares of light that they return,
//! in [0, 1].
//!
//! Invariants:
//! - a frame is a pure function of renderer, poses, seed and index, the same bits on any machine
//!   and number of threads;
//! - shares no code with `stickslip-vision`, whose results are judged by these frames.

mod appearance;
mod board;
mod camera;
mod draws;
mod exposure;
mod footprint;
mod frame_grabber;
mod lens;
mod optics;
mod png;
mod prism;
mod ray;
mod recorded_motion;
mod render_scene;
mod renderer;
mod sampler;
mod tag;
mod vector;
mod video;

pub use appearance::{Appearance, Hand, TagMount};
pub use board::{Board, BoardPose, calibration_poses};
pub use camera::{Camera, CameraError};
pub use exposure::{BodyPoses, Exposure};
pub use frame_grabber::FrameGrabber;
pub use lens::Lens;
pub use optics::{Lighting, Optics, Sensor};
pub use png::encode_png;
pub use recorded_motion::RecordedMotion;
pub use render_scene::RenderScene;
pub use renderer::Renderer;
pub use tag::{Tag, TagCells};
pub use video::{CaptureSettings, Video};
