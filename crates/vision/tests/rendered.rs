//! Calibration and tracking on rendered frames, against the truth they were rendered from.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::sync::LazyLock;

use common::{BOARD_THICKNESS, Errors, OBJECT_TAG, PUSHER_TAG, Rig, found, true_camera};
use image::GrayImage;
use stickslip_dynamics::Pose;
use stickslip_rendering::{
    BodyPoses, CaptureSettings, Exposure, FrameGrabber, Optics, RecordedMotion, Video,
};
use stickslip_vision::{
    Board, BoardOnTable, BoardRecording, BodyTag, Calibration, CalibrationError, CalibrationFrame,
    Detector, Lens, Sighting, Tags, Track, TrackError, calibrate, search_board,
};

static RIG: LazyLock<Rig> = LazyLock::new(|| Rig::new(Optics::default(), 1));
static BOARD: LazyLock<(BoardRecording, BoardOnTable)> = LazyLock::new(|| {
    let (frames, board) = RIG.board_frames(12);
    (found(&frames), board)
});
static CALIBRATION: LazyLock<Calibration> =
    LazyLock::new(|| calibrate(&BOARD.0, &BOARD.1, 0).unwrap());

fn track(frames: &[GrayImage]) -> Result<Track, TrackError> {
    RIG.track(frames, &CALIBRATION.camera)
}

/// Two implementations of the same lens.
#[test]
fn lens_is_that_of_the_renderer() {
    let truth = true_camera();
    let lens = truth.lens();
    let same = Lens {
        size: lens.size,
        focal: lens.focal,
        centre: lens.centre,
        radial: lens.radial,
        tangential: lens.tangential,
    };
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

/// Bias at most 0.05 mm and 0.05 degrees, all tags found, errors as large as predicted.
#[test]
fn track_measures_poses_with_the_noise_it_predicts() {
    for (travel, seed) in [(Pose::default(), 5), (Pose::new(1e-3, 5e-4, 0.01), 6)] {
        let (frames, truth) = RIG.random_frames(40, travel, seed);
        let track = track(&frames).unwrap();
        let (mut object, mut pusher) = (Errors::default(), Errors::default());
        for (frame, [true_object, true_pusher]) in track.frames.iter().zip(&truth) {
            object.add(&frame.object, *true_object);
            pusher.add(&frame.pusher, *true_pusher);
        }
        for errors in [object, pusher] {
            let ([x, y, theta], spread, ratio) = (errors.bias(), errors.spread(), errors.ratio());
            assert_eq!(errors.missed, 0);
            assert!(
                x.abs() < 0.05e-3 && y.abs() < 0.05e-3 && theta.abs() < 0.05_f64.to_radians(),
                "{errors:?}"
            );
            assert!(
                spread[0] < 0.02e-3 && spread[1] < 0.02e-3 && spread[2] < 0.05_f64.to_radians(),
                "{spread:?}"
            );
            assert!(
                ratio.iter().all(|ratio| (0.5..1.6).contains(ratio)),
                "{ratio:?}"
            );
        }
    }
}

#[test]
fn track_knows_repeated_frames() {
    let motion = motion(20);
    let video = video(&motion, 0.3, 0..0);
    let frames: Vec<GrayImage> = (0..20).map(|index| video.frame(index)).collect();
    let track = track(&frames).unwrap();
    let repeated: Vec<bool> = (0..20)
        .map(|index| video.settings.grabber.delivered(index) != index)
        .collect();
    assert!(repeated.iter().any(|repeated| *repeated));
    assert_eq!(
        track
            .frames
            .iter()
            .map(|frame| frame.repeated)
            .collect::<Vec<_>>(),
        repeated
    );
    // their poses are old, and not given
    assert_eq!(
        track
            .object()
            .iter()
            .map(Option::is_none)
            .collect::<Vec<_>>(),
        repeated
    );
    assert_eq!(
        track
            .pusher()
            .iter()
            .map(Option::is_none)
            .collect::<Vec<_>>(),
        repeated
    );
}

/// While the hand comes and goes the tag is partly covered: a pose is right or is not given.
#[test]
fn track_gives_no_wrong_pose_while_the_hand_covers_the_tag() {
    let motion = motion(36);
    let video = video(&motion, 0.0, 15..20);
    let frames: Vec<GrayImage> = (0..36).map(|index| video.frame(index)).collect();
    let track = track(&frames).unwrap();
    let objects = track.object();
    assert!(objects[15..20].iter().all(Option::is_none));
    assert!(
        objects[..4]
            .iter()
            .chain(&objects[32..])
            .all(Option::is_some)
    );
    assert!(track.pusher().iter().all(Option::is_some));
    for (found, truth) in objects.iter().zip(&motion.object) {
        let Some(found) = found else { continue };
        let off = (found.x - truth.x).hypot(found.y - truth.y);
        assert!(
            off < 0.2e-3 && (found.theta - truth.theta).abs() < 0.01,
            "{found:?} {truth:?}"
        );
    }
}

/// Angles go on past half a turn.
#[test]
fn track_continues_angles() {
    let turning = |index: u32| Pose::new(0.02, 0.0, 2.9 + 0.1 * f64::from(index));
    let frame = |index: u32| {
        let poses = BodyPoses {
            object: Some(turning(index)),
            pusher: Some(Pose::new(-0.05, 0.0, 0.0)),
            hand: None,
        };
        RIG.renderer.frame(index.into(), &Exposure::at_rest(poses))
    };
    let found = track(&(0..6).map(frame).collect::<Vec<_>>())
        .unwrap()
        .object();
    for (found, index) in found.iter().zip(0..) {
        assert!(
            (found.unwrap().theta - turning(index).theta).abs() < 1e-3,
            "{found:?}"
        );
    }
}

/// The reference implementation in C finds the same tags, in the same place, the same way up.
#[test]
fn find_agrees_with_the_reference_detector() {
    let (frames, _) = RIG.random_frames(10, Pose::default(), 9);
    let (board, _) = RIG.board_frames(3);
    let mut reference = apriltag::DetectorBuilder::new()
        .add_family_bits(apriltag::Family::tag_36h11(), 1)
        .build()
        .unwrap();
    let detector = Detector::new([640, 480]);
    let mut compared = 0;
    for frame in frames.iter().chain(&board) {
        let mut copy = apriltag::Image::zeros_with_alignment(640, 480, 1).unwrap();
        let stride = copy.stride();
        for (row, pixels) in frame.as_raw().chunks(640).enumerate() {
            copy.as_slice_mut()[row * stride..row * stride + 640].copy_from_slice(pixels);
        }
        let found = detector.find(frame);
        for expected in reference.detect(&copy) {
            let tag = found
                .iter()
                .find(|tag| usize::from(tag.id) == expected.id())
                .unwrap();
            // its pixels begin at their corner; its corners go round from the lower left too
            for (corner, [x, y]) in tag.corners().iter().zip(expected.corners()) {
                let off = (corner[0] - x + 0.5).hypot(corner[1] - y + 0.5);
                assert!(
                    off < 0.6,
                    "tag {}: {:?} {:?}",
                    tag.id,
                    tag.corners(),
                    expected.corners()
                );
            }
            compared += 1;
        }
    }
    assert!(compared > 20 + 60, "{compared}");
}

#[test]
fn find_takes_any_image() {
    for size in [[1, 1], [31, 200], [32, 32], [33, 47], [200, 150]] {
        let detector = Detector::new(size);
        let streams = stickslip_filter::Streams::new(u64::from(size[0]));
        for index in 0..20 {
            let noise = GrayImage::from_fn(size[0], size[1], |x, y| {
                image::Luma([(256.0 * streams.uniform(index, x, y)) as u8])
            });
            assert!(detector.find(&noise).is_empty());
        }
        assert!(detector.find(&GrayImage::new(size[0], size[1])).is_empty());
    }
}

#[test]
fn track_is_the_same_on_any_number_of_threads() {
    let (frames, _) = RIG.random_frames(40, Pose::default(), 8);
    let on = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| track(&frames))
            .unwrap()
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(3));
}

/// Frames must not be looked at one inside the other: thousands of them with the stack of a few.
#[test]
fn track_takes_no_more_stack_for_more_frames() {
    let load =
        |index: usize| Ok::<_, TrackError>((format!("{index}.png"), GrayImage::new(640, 480)));
    let track = || stickslip_vision::track(100 * 32, load, &CALIBRATION.camera, &RIG.tags);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .stack_size(1 << 17)
        .build()
        .unwrap();
    let text = pool.install(track).unwrap_err().to_string();
    assert!(
        text.contains("no tag of the family 36h11 is in any of the 3200 frames"),
        "{text}"
    );
}

#[test]
fn track_says_which_tag_is_missing() {
    let (frames, _) = RIG.random_frames(2, Pose::default(), 8);
    let with = |tags: Tags| {
        let load =
            |index: usize| Ok::<_, TrackError>((format!("{index}.png"), frames[index].clone()));
        stickslip_vision::track(2, load, &CALIBRATION.camera, &tags)
            .unwrap_err()
            .to_string()
    };
    let text = with(Tags {
        pusher: BodyTag {
            id: 40,
            ..RIG.tags.pusher
        },
        ..RIG.tags
    });
    assert!(
        text.contains("the pusher's tag, number 40, is in none of the 2 frames"),
        "{text}"
    );
    assert!(
        text.contains(&format!(
            "found are: {OBJECT_TAG} (2 times), {PUSHER_TAG} (2 times)"
        )) && text.contains("Correct pusher.tag"),
        "{text}"
    );
    let text = track(&[GrayImage::new(640, 480)]).unwrap_err().to_string();
    assert!(
        text.contains("no tag of the family 36h11 is in any of the 1 frames"),
        "{text}"
    );
    let text = track(&[GrayImage::new(64, 48)]).unwrap_err().to_string();
    assert!(
        text.contains(
            "0.png: the image has 64 x 48 pixels, the camera was calibrated at 640 x 480"
        ),
        "{text}"
    );
}

#[test]
fn track_doubts_a_tag_that_is_there_twice() {
    let (frames, _) = RIG.random_frames(1, Pose::default(), 8);
    let both = Tags {
        object: RIG.tags.object,
        pusher: BodyTag {
            id: OBJECT_TAG,
            ..RIG.tags.pusher
        },
    };
    let twice = GrayImage::from_fn(640, 480, |x, y| *frames[0].get_pixel(x % 320 + 160, y));
    let load = |_| Ok::<_, TrackError>((String::new(), twice.clone()));
    // the image's middle, side by side with itself
    let seen = stickslip_vision::track(1, load, &CALIBRATION.camera, &both);
    if let Ok(track) = seen {
        let count = track.frames[0]
            .tags
            .iter()
            .filter(|id| **id == OBJECT_TAG)
            .count();
        assert_eq!(
            track.frames[0].object == Sighting::Twice,
            count == 2,
            "{:?}",
            track.frames[0]
        );
    }
}

/// Why a calibration from some frames of the recording is refused.
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

fn motion(frames: u32) -> RecordedMotion {
    let time: Vec<f64> = (0..frames).map(|k| f64::from(k) / 30.0).collect();
    let object = time
        .iter()
        .map(|t| Pose::new(0.03 * t, 0.01, 0.2 * t))
        .collect();
    RecordedMotion {
        object,
        pusher: time
            .iter()
            .map(|t| Some(Pose::new(0.03 * t - 0.035, 0.01, 0.0)))
            .collect(),
        time,
    }
}

fn video(motion: &RecordedMotion, repeat: f64, covered: std::ops::Range<usize>) -> Video<'_> {
    let settings = CaptureSettings {
        exposure: 0.008,
        grabber: FrameGrabber { repeat, seed: 2 },
        covered,
        hand_height: 0.085,
    };
    Video {
        renderer: &RIG.renderer,
        motion,
        settings,
    }
}
