//! Lenses and images from elsewhere: ROS, OpenCV, bags.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::rendered::{RENDERED, assert_refused, calibrate, track};
use crate::common::{Experiment, SLIDE, empty_folder, json, stickslip, succeeds};
use stickslip_formats::Topics;

/// The lens of a calibration as ROS and OpenCV write one.
fn lens_files(folder: &Path) -> [PathBuf; 2] {
    let text = fs::read_to_string(RENDERED.join("calibration.toml")).unwrap();
    let numbers = |key: &str| -> Vec<f64> {
        let line = text.lines().find(|line| line.starts_with(key)).unwrap();
        let list = line.split(['[', ']']).nth(1).unwrap();
        list.split(',')
            .map(|number| number.trim().parse().unwrap())
            .collect()
    };
    let ([fx, fy], [cx, cy], [k1, k2], [p1, p2]) = (
        numbers("focal")[..2].try_into().unwrap(),
        numbers("centre")[..2].try_into().unwrap(),
        numbers("radial")[..2].try_into().unwrap(),
        numbers("tangential")[..2].try_into().unwrap(),
    );
    let (k, d): ([f64; 9], [f64; 5]) = (
        [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        [k1, k2, p1, p2, 0.0],
    );
    let ros = format!(
        "image_width: 640\nimage_height: 480\ncamera_name: overhead\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: {k:?}\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: {d:?}\n"
    );
    let opencv = format!(
        "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: {k:?}\ndistortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: {d:?}\n"
    );
    [("camera_info.yaml", ros), ("opencv.yml", opencv)].map(|(name, text)| {
        fs::write(folder.join(name), text).unwrap();
        folder.join(name)
    })
}

#[test]
fn calibrate_finds_the_table_alone_through_a_lens_from_elsewhere() {
    let folder = empty_folder("camera/lens");
    let [ros, opencv] = lens_files(&folder);
    let table = |lens: &Path| {
        let mut command = stickslip();
        command
            .arg("calibrate")
            .arg(RENDERED.join("board"))
            .arg("--lens")
            .arg(lens);
        command.arg("--board").arg(RENDERED.join("board.toml"));
        let printed = json(
            command
                .arg("--json")
                .arg("--out")
                .arg(folder.join("table.toml")),
        );
        (
            printed,
            fs::read_to_string(folder.join("table.toml")).unwrap(),
        )
    };
    let (printed, own) = table(&RENDERED.join("calibration.toml"));
    assert_eq!(table(&ros), (printed.clone(), own.clone()));
    assert_eq!(table(&opencv), (printed.clone(), own));
    let (misfit, height) = (&printed["misfit_px"], &printed["camera_height_m"]);
    assert!(misfit.as_f64().unwrap() < 0.05, "{printed}");
    // as high as the calibration of lens and table together has it
    let text = fs::read_to_string(RENDERED.join("calibration.toml")).unwrap();
    let place = text
        .lines()
        .find(|line| line.starts_with("translation"))
        .unwrap();
    let z: f64 = place
        .rsplit(',')
        .next()
        .unwrap()
        .trim_end_matches(']')
        .trim()
        .parse()
        .unwrap();
    assert!(
        (height.as_f64().unwrap() / z - 1.0).abs() < 0.05,
        "{printed} {place}"
    );

    // frames are tracked with it as with the calibration itself
    let out = folder.join("tracked");
    let mut command = stickslip();
    command
        .arg("track")
        .arg(RENDERED.join("frames"))
        .arg("--calibration")
        .arg(folder.join("table.toml"));
    succeeds(
        command
            .arg("--tags")
            .arg(RENDERED.join("tags.toml"))
            .arg("--out")
            .arg(&out),
    );
    assert!(out.join("log.csv").is_file());
}

#[test]
fn calibrate_refuses_a_lens_that_was_never_calibrated() {
    let folder = empty_folder("camera/no_lens");
    let [ros, _] = lens_files(&folder);
    let uncalibrated = fs::read_to_string(&ros).unwrap();
    let start = uncalibrated.find("data: [").unwrap() + 7;
    let end = start + uncalibrated[start..].find(']').unwrap();
    let zeros = format!(
        "{}0,0,0,0,0,0,0,0,0{}",
        &uncalibrated[..start],
        &uncalibrated[end..]
    );
    fs::write(folder.join("zero.yaml"), zeros).unwrap();
    fs::copy(RENDERED.join("board.toml"), folder.join("board.toml")).unwrap();
    let mut command = calibrate(&RENDERED.join("board"), &folder);
    assert_refused(
        command.arg("--lens").arg(folder.join("zero.yaml")),
        &["the camera was not calibrated: its focal length is 0"],
    );
}

#[test]
fn bags_without_images_and_other_folders_are_refused() {
    let folder = empty_folder("camera/no_bag");
    let topic = ["--topic", "image=/image"];
    let case = Experiment::copy(SLIDE, "camera/no_images");
    let log = stickslip_formats::read_log(fs::File::open(case.log()).unwrap(), "log.csv")
        .unwrap()
        .0;
    let bag = folder.join("log.mcap");
    stickslip_formats::write_log_mcap(fs::File::create(&bag).unwrap(), &log, &Topics::default())
        .unwrap();
    let out = folder.join("out");
    let tags = RENDERED.join("tags.toml");
    assert_refused(
        &mut track(&bag, &tags, &out, &topic),
        &[
            "the topic `/image` (image) is not there",
            "the recording has none of its type",
        ],
    );
    assert_refused(
        &mut track(&bag, &tags, &out, &[]),
        &[
            "no topic of images is named",
            "help: see its topics with `stickslip info",
        ],
    );
    assert_refused(
        &mut track(&bag, &tags, &out, &["--topic", "image=/object/pose"]),
        &["sensor_msgs/msg/Image or sensor_msgs/msg/CompressedImage is needed"],
    );
    assert_refused(
        &mut track(
            &bag,
            &tags,
            &out,
            &["--topic", "image=/image", "--rate", "30"],
        ),
        &["the bag's images have times", "leave --rate out"],
    );
    let text = case.log();
    assert_refused(
        &mut track(Path::new(&text), &tags, &out, &topic),
        &["this is no bag"],
    );
}
