//! Numbers of several particles side by side ([`Lanes`], [`Mask`]), compiled for the widest vector
//! instructions of the machine ([`on_widest`]).
//!
//! Every operation acts on each lane alone and is correctly rounded, so a result depends neither on
//! the number of lanes nor on the instructions: `Lanes<1>` is the scalar reference of the same
//! code. The functions on plain f64 ([`exponentials`], [`box_muller`]) are written so that loops
//! over them vectorise.

mod box_muller;
mod dispatch;
mod exp;
mod lanes;
mod ln;
mod mask;
mod polynomial;
mod trig;

pub use box_muller::box_muller;
pub use dispatch::{on_fused, on_lanes, on_vectors, on_widest};
pub use exp::exponentials;
pub use fearless_simd::Level;
pub use lanes::Lanes;
pub use mask::Mask;
pub use trig::sin_cos;
