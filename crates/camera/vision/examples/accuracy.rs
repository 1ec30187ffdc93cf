//! Accuracy of tracking on rendered frames with known truth:
//! `cargo run --release -p stickslip-vision --example accuracy`.

#[path = "../tests/it/common/mod.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod common;

use common::{Errors, Rig, found, true_camera};
use stickslip_dynamics::Pose;
use stickslip_rendering::Optics;
use stickslip_vision::calibrate;

/// Random poses a row of the table.
const FRAMES: u64 = 300;

fn main() {
    let rig = Rig::new(Optics::default(), 1);
    let (frames, board) = rig.board_frames(20);
    let calibration = calibrate(&found(&frames), &board, 0).expect("a board in every frame");
    println!(
        "calibration: {} frames, {} tags, {} left out, misfit {:.3} px",
        calibration.frames, calibration.tags, calibration.left_out, calibration.rms
    );
    let (lens, truth) = (calibration.camera.lens(), true_camera());
    let numbers = lens.calibrated();
    let true_lens = truth.lens();
    let expected = [
        true_lens.focal,
        true_lens.centre,
        true_lens.radial,
        true_lens.tangential,
    ];
    for (k, name) in ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"]
        .iter()
        .enumerate()
    {
        let (number, expected, std) = (numbers[k], expected[k / 2][k % 2], calibration.lens_std[k]);
        println!(
            "  {name} {number:10.4}, true {expected:10.4}, error {:6.2} standard deviations",
            (number - expected) / std
        );
    }
    println!(
        "\n{:<34} {:>6}  {:>22}  {:>22}  {:>22}",
        "", "found", "bias (um, um, mdeg)", "spread", "spread / predicted"
    );
    let still = Pose::default();
    for blur in [0.4, 0.6, 1.0, 1.5, 2.0, 2.5, 3.0] {
        row(
            &format!("blur {blur} px"),
            &Rig::new(
                Optics {
                    blur,
                    ..Optics::default()
                },
                2,
            ),
            still,
            &calibration.camera,
        );
    }
    for pixels in [1.0, 2.0, 4.0, 6.0, 8.0, 12.0] {
        // at the object's height a pixel is about half a millimetre
        let travel = Pose::new(pixels * 0.6 / 1205.0, 0.0, 0.0);
        row(
            &format!("moved by {pixels} px"),
            &Rig::new(Optics::default(), 3),
            travel,
            &calibration.camera,
        );
    }
}

fn row(name: &str, rig: &Rig, travel: Pose, camera: &stickslip_vision::Camera) {
    let (frames, truth) = rig.random_frames(FRAMES, travel, 5);
    let Ok(track) = rig.track(&frames, camera) else {
        println!("{name:<26} nothing found");
        return;
    };
    let (mut object, mut pusher) = (Errors::default(), Errors::default());
    for (frame, [true_object, true_pusher]) in track.frames.iter().zip(&truth) {
        object.add(&frame.object, *true_object);
        pusher.add(&frame.pusher, *true_pusher);
    }
    for (body, errors) in [("object", object), ("pusher", pusher)] {
        let units = [1e6, 1e6, 1e3_f64.to_degrees()];
        let show = |numbers: [f64; 3]| {
            [0, 1, 2]
                .map(|k| format!("{:6.1}", numbers[k] * units[k]))
                .join("  ")
        };
        let ratio = errors
            .ratio()
            .map(|ratio| format!("{ratio:6.2}"))
            .join("  ");
        let found = 100.0 * (1.0 - errors.missed as f64 / FRAMES as f64);
        println!(
            "{:<34} {found:>4.0} %  {}  {}  {ratio}",
            format!("{name}, {body}"),
            show(errors.bias()),
            show(errors.spread())
        );
    }
}
