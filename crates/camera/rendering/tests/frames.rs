//! Rendered frames against rays cast one by one, and properties of a video.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use image::GrayImage;
use stickslip_dynamics::{Part, Pose, Scene, Shape};
use stickslip_rendering::{
    Appearance, Board, BoardPose, BodyPoses, Camera, CaptureSettings, Exposure, FrameGrabber, Lens,
    Lighting, Optics, RecordedMotion, RenderScene, Renderer, Sensor, Video, calibration_poses,
    encode_png,
};
use stickslip_testkit::{disc, fixels, pushed_scene, square};

const CELLS: [[bool; 8]; 8] = [[false; 8]; 8];

fn scene(object: Shape) -> Scene {
    let fixel = fixels(&disc(0.005), &[[0.1, 0.03]]);
    pushed_scene(object, disc(0.006), fixel)
}

fn square_scene() -> Scene {
    scene(square(0.05))
}

fn camera() -> Camera {
    Camera::look_at(Lens::industrial(), [0.02, -0.09, 0.6], [0.02, 0.0]).unwrap()
}

/// A frame's bytes are the light returned, in 255 steps.
fn plain_optics() -> Optics {
    let lighting = Lighting {
        level: 255.0,
        gradient: [0.0; 2],
        vignetting: 0.0,
    };
    Optics {
        blur: 0.0,
        lighting,
        sensor: Sensor {
            read_noise: 0.0,
            shot_noise: 0.0,
        },
    }
}

fn still(object: Pose) -> Exposure {
    Exposure::at_rest(BodyPoses {
        object: Some(object),
        ..BodyPoses::default()
    })
}

fn ellipse() -> Part {
    Part::ellipse([0.03, 0.02], [0.004, 0.0], 0.3)
}

/// Surface that a line of sight can meet.
enum Surface {
    Top,
    Side,
    Plate,
}

/// Follows the line of sight of a pixel down from the height `top` of [`ellipse`] at `pose`, in
/// steps of 0.2 mm.
fn first_on_line_of_sight(camera: &Camera, pixel: [f64; 2], pose: Pose, top: f64) -> Surface {
    let inside = |[x, y]: [f64; 2]| {
        let (a, b) = libm::sincos(pose.theta);
        let [x, y] = [
            b * (x - pose.x) + a * (y - pose.y) - 0.004,
            b * (y - pose.y) - a * (x - pose.x),
        ];
        let (a, b) = libm::sincos(0.3);
        ((b * x + a * y) / 0.03).powi(2) + ((b * y - a * x) / 0.02).powi(2) <= 1.0
    };
    let [above, table] = [top, 0.0].map(|z| camera.point_at(pixel, z).unwrap());
    let at = |share: f64| [0, 1].map(|k| above[k] + share * (table[k] - above[k]));
    if inside(above) {
        Surface::Top
    } else if (1..=100).any(|step| inside(at(f64::from(step) / 100.0))) {
        Surface::Side
    } else {
        Surface::Plate
    }
}

/// An elliptic object without a tag against 16 x 16 lines of sight a pixel.
#[test]
fn frame_is_what_lines_of_sight_meet() {
    const SIDE: u32 = 16;
    let appearance = Appearance {
        object_tag: None,
        ..Appearance::of(&square_scene(), CELLS, CELLS, 0.0)
    };
    let (top, pose, camera) = (
        appearance.object_height,
        Pose::new(0.01, 0.02, 0.7),
        camera(),
    );
    let renderer = Renderer::new(
        camera,
        RenderScene::new(&scene(Shape::new(vec![ellipse()]).unwrap()), &appearance),
        plain_optics(),
        1,
    );
    let frame = renderer.frame(0, &still(pose));
    let grey_of = |bytes: &GrayImage, x: u32, y: u32| f64::from(bytes.get_pixel(x, y).0[0]);
    // greys of top, plate and sides, from pixels that see nothing else: the near side is 20 mm
    // high, a few pixels
    let [u, v] = camera.project([0.014, 0.02, top]).map(|x| x.round() as u32);
    let (face, plate) = (grey_of(&frame, u, v), grey_of(&frame, u, v + 150));
    let column: Vec<f64> = (v..v + 100).map(|y| grey_of(&frame, u, y)).collect();
    let side = column.iter().copied().fold(f64::MAX, f64::min);
    assert!(face < plate && side < face, "{face} {plate} {side}");

    let seen = |pixel: [f64; 2]| match first_on_line_of_sight(&camera, pixel, pose, top) {
        Surface::Top => face,
        Surface::Side => side,
        Surface::Plate => plate,
    };
    let (mut edges, mut squares) = (0, 0.0);
    for y in (v - 60..v + 60).step_by(5) {
        for x in (u - 80..u + 80).step_by(4) {
            let offset = |k: u32| (f64::from(k) + 0.5) / f64::from(SIDE) - 0.5;
            let sum = (0..SIDE * SIDE).fold(0.0, |sum, k| {
                let (dx, dy) = (offset(k % SIDE), offset(k / SIDE));
                sum + seen([f64::from(x) + dx, f64::from(y) + dy])
            });
            let expected = sum / f64::from(SIDE * SIDE);
            let error = grey_of(&frame, x, y) - expected;
            // 64 rays in a pixel with an edge err by some hundredths of the contrast, 80 levels
            assert!(error.abs() < 5.0, "({x}, {y}): {error}");
            if [face, side, plate]
                .iter()
                .all(|grey| (grey - expected).abs() > 2.0)
            {
                (edges, squares) = (edges + 1, squares + error * error);
            } else {
                assert!(error.abs() < 2.5, "({x}, {y}): {error}");
            }
        }
    }
    let rms = (squares / f64::from(edges)).sqrt();
    assert!(
        edges >= 10 && rms < 2.0,
        "{edges} pixels with an edge, off by {rms}"
    );
}

/// Over the exposure a moving object is seen in the middle of its path.
#[test]
fn frame_of_a_moving_object_is_in_the_middle_of_its_path() {
    let appearance = Appearance {
        object_tag: None,
        ..Appearance::of(&square_scene(), CELLS, CELLS, 0.0)
    };
    let renderer = Renderer::new(
        camera(),
        RenderScene::new(&square_scene(), &appearance),
        plain_optics(),
        1,
    );
    let empty = renderer.frame(0, &Exposure::at_rest(BodyPoses::default()));
    let middle = |exposure: &Exposure| {
        let weights = renderer
            .frame(0, exposure)
            .into_raw()
            .into_iter()
            .zip(empty.as_raw())
            .map(|(a, b)| f64::from(a) - f64::from(*b));
        let (sum, x) = weights.zip(0..).fold((0.0, 0.0), |(sum, x), (w, index)| {
            (sum + w, x + w * f64::from(index % 640))
        });
        x / sum
    };
    let at = |x: f64| BodyPoses {
        object: Some(Pose::new(x, 0.0, 0.2)),
        ..BodyPoses::default()
    };
    let moving = middle(&Exposure {
        start: at(0.018),
        end: at(0.022),
    });
    assert!((moving - middle(&Exposure::at_rest(at(0.02)))).abs() < 0.02);
    assert!((moving - middle(&Exposure::at_rest(at(0.021)))).abs() > 1.5);
}

fn motion() -> RecordedMotion {
    let time: Vec<f64> = (0..60).map(|k| f64::from(k) / 30.0).collect();
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

fn video<'a>(renderer: &'a Renderer, motion: &'a RecordedMotion, repeat: f64) -> Video<'a> {
    let settings = CaptureSettings {
        exposure: 0.008,
        grabber: FrameGrabber { repeat, seed: 2 },
        covered: 20..40,
        hand_height: 0.085,
    };
    Video {
        renderer,
        motion,
        settings,
    }
}

#[test]
fn video_covers_the_objects_tag_and_not_the_pushers() {
    let (scene, motion) = (square_scene(), motion());
    let appearance = Appearance::of(&scene, CELLS, CELLS, 0.0);
    let renderer = Renderer::new(
        Camera::over(Lens::industrial(), motion.bounds(&scene, &appearance)).unwrap(),
        RenderScene::new(&scene, &appearance),
        plain_optics(),
        1,
    );
    let video = video(&renderer, &motion, 0.0);
    // tags of black cells: dark where they are seen
    let dark = |index: usize, at: [f64; 2], z: f64| {
        let [u, v] = renderer
            .camera()
            .project([at[0], at[1], z])
            .map(|x| x.round() as u32);
        video.frame(index).get_pixel(u, v).0[0] < 30
    };
    let size = appearance.object_tag.unwrap().tag.size / 2.0 - 1e-3;
    for index in [0, 5, 20, 30, 39, 55] {
        let corners = [
            [-size, -size],
            [size, -size],
            [size, size],
            [-size, size],
            [0.0, 0.0],
        ];
        let object =
            corners.map(|corner| dark(index, motion.object[index].transform(corner), 0.0205));
        assert_eq!(object, [!(20..40).contains(&index); 5], "frame {index}");
        let half = 0.011;
        let pusher = [[-half, -half], [half, -half], [half, half], [-half, half]];
        let at = motion.pusher[index].unwrap();
        assert!(
            pusher
                .iter()
                .all(|[x, y]| dark(index, at.transform([x - 0.04, *y]), 0.0305)),
            "frame {index}"
        );
    }
}

#[test]
fn video_repeats_frames_to_the_byte_and_never_otherwise() {
    let (scene, motion) = (square_scene(), motion());
    let stage = RenderScene::new(&scene, &Appearance::of(&scene, CELLS, CELLS, 0.0));
    let renderer = Renderer::new(camera(), stage, Optics::default(), 1);
    let video = video(&renderer, &motion, 0.3);
    let frames: Vec<GrayImage> = (0..20).map(|index| video.frame(index)).collect();
    for (pair, index) in frames.windows(2).zip(1..) {
        assert_eq!(
            pair[0] == pair[1],
            video.settings.grabber.delivered(index) < index,
            "frame {index}"
        );
    }
    assert!(frames.windows(2).any(|pair| pair[0] == pair[1]));
}

#[test]
fn frame_is_a_function_of_its_seed_and_number() {
    let renderer = |seed| {
        Renderer::new(
            camera(),
            RenderScene::new(
                &square_scene(),
                &Appearance::of(&square_scene(), CELLS, CELLS, 0.0),
            ),
            Optics::default(),
            seed,
        )
    };
    let (exposure, one) = (still(Pose::new(0.0, 0.0, 0.3)), renderer(1));
    let frame = one.frame(3, &exposure);
    one.frame(7, &exposure);
    assert_eq!(frame, one.frame(3, &exposure));
    assert_eq!(frame, renderer(1).frame(3, &exposure));
    assert_ne!(frame, one.frame(4, &exposure));
    assert_ne!(frame, renderer(2).frame(3, &exposure));
    assert_eq!(
        image::load_from_memory(&encode_png(&frame))
            .unwrap()
            .into_luma8(),
        frame
    );
}

/// The first pose is flat; in every other one the board is tilted by 20 to 40 degrees and its
/// middle is in the image.
#[test]
fn calibration_poses_tilt_the_board_in_the_image() {
    let board = Board {
        columns: 6,
        tag_size: 0.026,
        gap: 0.008,
        tags: vec![CELLS; 24],
    };
    let poses = calibration_poses(&camera(), &board, 0.003, 20).unwrap();
    assert_eq!(poses.len(), 20);
    assert_eq!(
        poses[0],
        BoardPose::flat([poses[0].origin[0], poses[0].origin[1]], 0.003)
    );
    let half = board.extent().map(|side| side / 2.0);
    for pose in &poses {
        let [u, v] = camera().project(pose.point(half));
        assert!(
            (100.0..540.0).contains(&u) && (100.0..380.0).contains(&v),
            "{u} {v}"
        );
    }
    for BoardPose { axes: [x, y], .. } in &poses[1..] {
        let upwards = x[0] * y[1] - x[1] * y[0];
        assert!((0.75..0.95).contains(&upwards), "{upwards}");
    }
}
