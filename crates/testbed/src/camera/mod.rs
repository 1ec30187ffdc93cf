//! The overhead camera: frames of a scene as a real camera would deliver them.
//!
//! A [`Studio`] looks through a [`Camera`] (perspective, [`Lens`] distortion) at a [`Stage`]
//! (plate, fixels, object, pusher, their tags, a hand) and renders 8-bit grey frames: every quarter
//! of a pixel is the mean over rays spread over its area and over the exposure, then defocus,
//! uneven light, shot and read noise ([`Optics`]). A [`Grabber`] now and then delivers a frame
//! twice. A [`Board`] of tags, held in many poses, serves calibration.
//!
//! Lengths in m, world frame: x and y on the table, z up from it. Pixels: x right, y down, the
//! centre of the first pixel at (0, 0). Greys of surfaces are shares of the light they return, in
//! [0, 1].
//!
//! Invariants:
//! - a frame is a pure function of studio, poses, seed and index, the same bits on any machine and
//!   number of threads;
//! - shares no code with `stickslip-vision`, whose results are judged by these frames.

mod board;
mod body;
mod film;
mod footprint;
mod grabber;
mod lens;
mod optics;
mod ray;
mod sampler;
mod stage;
mod studio;
mod tag;
mod viewpoint;

pub use board::{Board, BoardPose, calibration_poses};
pub use film::{Film, Recorded, Take};
pub use grabber::Grabber;
pub use lens::Lens;
pub use optics::{Lighting, Optics, Sensor};
pub use stage::{Hand, Props, Stage, TagMount};
pub use studio::{Actors, Shutter, Studio, encode_png};
pub use tag::{Tag, TagCells};
pub use viewpoint::{Camera, CameraError};
