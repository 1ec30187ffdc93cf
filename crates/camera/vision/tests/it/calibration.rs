//! Calibration from rendered frames, against the truth they were rendered from.

use crate::common::{BOARD, BOARD_THICKNESS, CALIBRATION, true_camera};
use image::GrayImage;
use stickslip_vision::{
    Board, BoardOnTable, BoardRecording, Calibration, CalibrationError, CalibrationFrame, Lens,
    calibrate, find_table, search_board,
};

/// Two implementations of the same lens.
#[test]
fn lens_is_that_of_the_renderer() {
    let truth = true_camera();
    let (lens, same) = (truth.lens(), true_lens());
    for pixel in [[0.0, 0.0], [639.0, 479.0], [200.0, 400.0], [320.0, 240.0]] {
        let direction = lens.direction(pixel).unwrap();
        let ideal = same.undistort(pixel).unwrap();
        let expected = [0, 1].map(|k| lens.focal[k] * direction[k] + lens.centre[k]);
        assert!(
            (ideal[0] - expected[0]).abs() < 1e-9 && (ideal[1] - expected[1]).abs() < 1e-9,
            "{ideal:?} {expected:?}"
        );
        let [u, v] = same.distort(expected);
        assert!((u - pixel[0]).abs() < 1e-9 && (v - pixel[1]).abs() < 1e-9);
    }
}

/// Every point over the plate, to 40 mm above it, is projected to where it is seen.
#[test]
fn calibrate_finds_the_camera() {
    let Calibration {
        camera,
        rms,
        frames,
        tags,
        left_out,
        ..
    } = &*CALIBRATION;
    assert!(
        *rms < 0.03 && *frames == 12 && *tags > 300 && *left_out < 10,
        "{rms} {frames} {tags} {left_out}"
    );
    for x in [-0.10, 0.02, 0.14] {
        for y in [-0.09, 0.0, 0.09] {
            for z in [0.0, BOARD_THICKNESS, 0.02, 0.04] {
                let (found, truth) = (
                    camera.project([x, y, z]).unwrap(),
                    true_camera().project([x, y, z]),
                );
                let off = (found[0] - truth[0]).hypot(found[1] - truth[1]);
                // a pixel is half a millimetre
                assert!(off < 0.03, "({x}, {y}, {z}): {off} px");
            }
        }
    }
    let off = [0, 1, 2].map(|k| (camera.centre()[k] - true_camera().centre()[k]).abs());
    assert!(off.iter().all(|off| *off < 1e-3), "{off:?}");
}

/// The lens of the renderer, as this crate has it.
fn true_lens() -> Lens {
    let camera = true_camera();
    let lens = camera.lens();
    Lens {
        size: lens.size,
        focal: lens.focal,
        centre: lens.centre,
        radial: [lens.radial[0], lens.radial[1], 0.0],
        tangential: lens.tangential,
    }
}

/// With the true lens, one frame of the flat board puts every point over the plate where it is
/// seen.
#[test]
fn find_table_finds_the_table_of_a_known_lens() {
    let (recording, board) = &*BOARD;
    let fit = find_table(recording, board, &true_lens()).unwrap();
    assert!(
        fit.rms < 0.03 && fit.tags >= 30,
        "{} px, {} tags",
        fit.rms,
        fit.tags
    );
    for x in [-0.10, 0.02, 0.14] {
        for y in [-0.09, 0.0, 0.09] {
            for z in [0.0, BOARD_THICKNESS, 0.04] {
                let (found, truth) = (
                    fit.camera.project([x, y, z]).unwrap(),
                    true_camera().project([x, y, z]),
                );
                let off = (found[0] - truth[0]).hypot(found[1] - truth[1]);
                assert!(off < 0.03, "({x}, {y}, {z}): {off} px");
            }
        }
    }
    // the height is off by what the place along the axis is said to be off by, within four of it
    let off = (fit.camera.centre()[2] - true_camera().centre()[2]).abs();
    assert!(
        off < 4.0 * fit.translation_std[2],
        "{off} {:?}",
        fit.translation_std
    );
    assert!(fit.translation_std[2] < 1e-3, "{:?}", fit.translation_std);
}

#[test]
fn find_table_says_what_the_frame_lacks() {
    let (recording, board) = &*BOARD;
    let of = |frame: CalibrationFrame, lens: Lens| {
        let recording = BoardRecording {
            frames: vec![frame],
            size: recording.size,
        };
        find_table(&recording, board, &lens)
            .unwrap_err()
            .to_string()
    };
    let flat = &recording.frames[0];
    let small = Lens {
        size: [320, 240],
        ..true_lens()
    };
    let text = of(flat.clone(), small);
    assert!(
        text.contains(
            "0.png: the image has 640 x 480 pixels, the lens was calibrated at 320 x 240"
        ),
        "{text}"
    );
    let mut few = flat.clone();
    few.tags.truncate(3);
    let text = of(few, true_lens());
    assert!(text.contains("3 of the board's tags are usable"), "{text}");
    let bent = Lens {
        radial: [1.5, 0.0, 0.0],
        ..true_lens()
    };
    let text = of(flat.clone(), bent);
    assert!(text.contains("px is good. Measure tag_size"), "{text}");
}

/// Reason why a calibration from some frames of the recording is refused.
fn refusal(frames: &[CalibrationFrame], board: &BoardOnTable) -> CalibrationError {
    let recording = BoardRecording {
        frames: frames.to_vec(),
        size: BOARD.0.size,
    };
    calibrate(&recording, board, 0).unwrap_err()
}

fn without_tags(frame: &CalibrationFrame) -> CalibrationFrame {
    CalibrationFrame {
        tags: Vec::new(),
        ..frame.clone()
    }
}

#[test]
fn calibrate_says_what_the_frames_lack() {
    let (BoardRecording { frames, .. }, board) = &*BOARD;
    let none: Vec<CalibrationFrame> = frames.iter().map(without_tags).collect();
    let no_tag = CalibrationError::NoTag { frames: 12 };
    assert_eq!(refusal(&none, board), no_tag);

    let mut no_flat = frames.clone();
    no_flat[0] = without_tags(&frames[0]);
    let flat_frame = CalibrationError::FlatFrame {
        name: "0.png".to_owned(),
        found: 0,
    };
    assert_eq!(refusal(&no_flat, board), flat_frame);

    let too_few = CalibrationError::TooFewFrames {
        usable: 3,
        frames: 3,
    };
    assert_eq!(refusal(&frames[..3], board), too_few);

    let flat_only = refusal(&vec![frames[0].clone(); 6], board);
    let no_tilt = matches!(flat_only, CalibrationError::NoTilt { .. });
    assert!(no_tilt, "{flat_only}");

    // copies of tilted frames look like many measurements
    let few = [0, 5, 7].map(|k| vec![frames[k].clone(); 4]).concat();
    let same_views = CalibrationError::SameViews {
        distinct: 3,
        frames: 12,
    };
    assert_eq!(refusal(&few, board), same_views);
}

#[test]
fn calibrate_says_what_is_wrong_with_the_board() {
    let (BoardRecording { frames, .. }, on_table) = &*BOARD;
    let text = |board: Board| {
        let board = BoardOnTable { board, ..*on_table };
        refusal(frames, &board).to_string()
    };
    let other = text(Board {
        first_tag: 300,
        ..on_table.board
    });
    assert!(
        other.contains("on the board, which has 300 to 334; found: 100, 101,")
            && other.contains("Correct first_tag"),
        "{other}"
    );
    let stretched = text(Board {
        gap: 0.012,
        ..on_table.board
    });
    assert!(
        stretched.contains("px is good. Measure tag_size and gap"),
        "{stretched}"
    );
}

#[test]
fn search_board_refuses_frames_of_several_sizes() {
    let load = |index: usize| {
        Ok::<_, CalibrationError>((
            format!("{index}.png"),
            GrayImage::new(64, 48 + index as u32 / 2),
        ))
    };
    let text = search_board(3, load).unwrap_err().to_string();
    assert!(
        text.contains("2.png: the image has 64 x 49 pixels, 0.png has 64 x 48")
            && text.contains("Take the odd ones out"),
        "{text}"
    );
}
