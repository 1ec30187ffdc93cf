//! Tracking on rendered frames, against the truth they were rendered from.

use crate::common::{CALIBRATION, Errors, OBJECT_TAG, PUSHER_TAG, RIG};
use image::GrayImage;
use stickslip_dynamics::Pose;
use stickslip_rendering::{
    BodyPoses, CaptureSettings, Exposure, FrameGrabber, RecordedMotion, Video,
};
use stickslip_vision::{BodyTag, Detector, Sighting, Tags, Track, TrackError};

fn track(frames: &[GrayImage]) -> Result<Track, TrackError> {
    RIG.track(frames, &CALIBRATION.camera)
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
            ..BodyPoses::default()
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

/// Frames must not be processed one inside the other: thousands of them take the stack of a few.
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
        ..RecordedMotion::default()
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
