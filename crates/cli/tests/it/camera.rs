//! From an experiment to frames and back: `render`, `calibrate`, `track`, and their messages about
//! bad input.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::rendered::{RENDERED, ROWS, assert_refused, calibrate, track};
use crate::common::{Experiment, SLIDE, empty_folder, json, stickslip, succeeds};
use stickslip_formats::{Topics, read_log_mcap};

/// A copy of two frames.
fn two_frames(test: &str) -> PathBuf {
    let folder = empty_folder(test);
    for name in ["000000.png", "000001.png"] {
        fs::copy(RENDERED.join("frames").join(name), folder.join(name)).unwrap();
    }
    folder
}

fn cells(file: &Path) -> Vec<Vec<String>> {
    fs::read_to_string(file)
        .unwrap()
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

#[test]
fn track_finds_what_was_rendered() {
    let out = RENDERED.join("tracked");
    let sensors = RENDERED.join("../log.csv").display().to_string();
    let tags = RENDERED.join("tags.toml");
    succeeds(&mut track(
        &RENDERED.join("frames"),
        &tags,
        &out,
        &["--sensors", &sensors],
    ));
    let (log, poses, truth) = (
        cells(&out.join("log.csv")),
        cells(&out.join("poses.csv")),
        cells(&RENDERED.join("truth.csv")),
    );
    assert_eq!(log[0].last().unwrap(), "tactile_3");
    assert_eq!([log.len(), poses.len()], [1 + ROWS.len(); 2]);
    let (recording, warnings) = read_log_mcap(
        &fs::read(out.join("log.mcap")).unwrap()[..],
        "log.mcap",
        &Topics::default(),
    )
    .unwrap();
    // a row without any pose is no message
    assert!(
        warnings.is_empty()
            && recording.tactile.len() == 3
            && (20..=ROWS.len()).contains(&recording.len()),
        "{recording:?}"
    );
    let (mut measured, mut repeated) = (0, 0);
    for ((log, poses), truth) in log.iter().zip(&poses).zip(&truth).skip(1) {
        repeated += usize::from(poses[1] == "1");
        assert!(
            poses[1] == "0" || log[1].is_empty() && log[4].is_empty(),
            "{log:?}"
        );
        if log[1].is_empty() {
            continue;
        }
        measured += 1;
        let off =
            [1, 2, 3].map(|k| log[k].parse::<f64>().unwrap() - truth[k].parse::<f64>().unwrap());
        assert!(
            off[0].hypot(off[1]) < 0.1e-3 && off[2].abs() < 2e-3,
            "{off:?}"
        );
    }
    assert!(
        repeated > 0 && (15..=24).contains(&measured),
        "{repeated} {measured}"
    );

    let report = json(
        stickslip()
            .arg("track")
            .arg(RENDERED.join("frames"))
            .arg("--json")
            .arg("--calibration")
            .arg(RENDERED.join("calibration.toml"))
            .arg("--tags")
            .arg(&tags)
            .arg("--out")
            .arg(RENDERED.join("json")),
    );
    assert_eq!(report["object"]["measured"].as_u64(), Some(measured));
    assert_eq!(report["repeated"].as_u64(), Some(repeated as u64));
}

/// A jaw about a disc: its second finger is in the picture and has no tag.
const JAW: &str = "
gravity = 9.81
object  = { mass = 0.5, inertia = 2.25e-4, shape = [{ disc = { radius = 0.03 } }] }
support = { friction = 0.3, tripod_radius = 0.02 }
pusher  = { friction = 0.3, stall_force = 10.0, shape = [{ disc = { radius = 0.005 } }] }
finger  = [{ start = [0.05, 0.0, 0.0], direction = 3.14159, shape = [{ disc = { radius = 0.005 } }] }]
fixels  = { friction = 0.3 }
camera  = { position_std = 3.0e-4, orientation_std = 5.0e-3 }
start   = { object = [0.0, 0.0, 0.3], pusher = [-0.045, 0.0, 0.0], speed = 0.03, duration = 0.5 }
";

#[test]
fn a_hand_is_filmed_and_its_other_fingers_come_from_the_log() {
    let folder = empty_folder("camera/jaw");
    fs::write(folder.join("given.toml"), JAW).unwrap();
    let (case, out) = (folder.join("case"), folder.join("out"));
    let scene = folder.join("given.toml");
    let mut simulate = stickslip();
    succeeds(simulate.arg("simulate").arg(scene).arg("--out").arg(&case));
    let mut render = stickslip();
    render
        .arg("render")
        .arg(&case)
        .args(["--board-frames", "8"]);
    succeeds(render.arg("--out").arg(&out));
    succeeds(&mut calibrate(&out.join("board"), &out));

    let sensors = case.join("log.csv");
    let mut track = stickslip();
    track.arg("track").arg(out.join("frames"));
    track.arg("--calibration").arg(out.join("calibration.toml"));
    track.arg("--tags").arg(out.join("tags.toml"));
    track.arg("--sensors").arg(&sensors);
    succeeds(track.arg("--out").arg(out.join("tracked")));
    let (log, given, truth) = (
        cells(&out.join("tracked/log.csv")),
        cells(&sensors),
        cells(&case.join("truth.csv")),
    );
    let column = |rows: &[Vec<String>], name: &str| {
        let index = rows[0].iter().position(|cell| cell == name).expect(name);
        let numbers = rows[1..].iter().map(|row| row[index].parse().ok());
        numbers.collect::<Vec<Option<f64>>>()
    };
    assert_eq!(column(&log, "finger_1_x"), column(&given, "finger_1_x"));
    // the film shows the object as it was, and the fingers as they were logged
    let shown = [
        ("object_x", column(&truth, "x")),
        ("pusher_x", column(&given, "pusher_x")),
    ];
    for (name, shown) in shown {
        let pairs = column(&log, name).into_iter().zip(shown);
        let off = pairs.filter_map(|(found, is)| Some((found? - is?).abs()));
        let off: Vec<f64> = off.collect();
        assert!(
            off.len() > 3 && off.iter().all(|off| *off < 0.2e-3),
            "{name} {off:?}"
        );
    }
}

#[test]
fn track_takes_any_folder_of_images_at_a_rate() {
    let (frames, out) = (two_frames("camera/rate"), RENDERED.join("rate"));
    let tags = RENDERED.join("tags.toml");
    assert_refused(
        &mut track(&frames, &tags, &out, &[]),
        &[
            "no frames.csv",
            "help: write frames.csv (time,file), or give the frames per second",
        ],
    );
    succeeds(&mut track(&frames, &tags, &out, &["--rate", "50"]));
    let log = cells(&out.join("log.csv"));
    assert_eq!(
        log.iter()
            .skip(1)
            .map(|row| row[0].as_str())
            .collect::<Vec<_>>(),
        ["0", "0.02"]
    );
    let both = ["--rate", "30"];
    assert_refused(
        &mut track(&RENDERED.join("frames"), &tags, &out, &both),
        &[
            "frames.csv gives times, and --rate 30 others",
            "leave --rate out",
        ],
    );
}

#[test]
fn track_asks_about_names_whose_order_is_not_sure() {
    let (frames, out) = (two_frames("camera/names"), RENDERED.join("names"));
    let tags = RENDERED.join("tags.toml");
    let mut names: Vec<PathBuf> = fs::read_dir(&frames)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    names.sort();
    for (path, name) in names.iter().zip(["12.25.png", "12.5.png"]) {
        fs::rename(path, frames.join(name)).unwrap();
    }
    assert_refused(
        &mut track(&frames, &tags, &out, &["--rate", "30"]),
        &[
            "`12.25.png` comes before `12.5.png` if these are decimal numbers",
            "write frames.csv",
        ],
    );
    fs::rename(frames.join("12.25.png"), frames.join("12.05.png")).unwrap();
    succeeds(&mut track(&frames, &tags, &out, &["--rate", "30"]));
}

#[test]
fn track_names_an_image_that_cannot_be_read() {
    let (frames, out) = (two_frames("camera/broken"), RENDERED.join("broken"));
    let tags = RENDERED.join("tags.toml");
    let good = fs::read(frames.join("000001.png")).unwrap();
    fs::write(frames.join("000001.png"), &good[..good.len() / 2]).unwrap();
    assert_refused(
        &mut track(&frames, &tags, &out, &["--rate", "30"]),
        &[
            "000001.png: the PNG image cannot be decoded",
            "Record or copy it again",
        ],
    );
    fs::write(frames.join("000001.png"), "not an image").unwrap();
    assert_refused(
        &mut track(&frames, &tags, &out, &["--rate", "30"]),
        &[
            "000001.png: its first bytes are those of no image",
            "Convert it to PNG",
        ],
    );
    fs::write(
        frames.join("frames.csv"),
        "time,file\n0,000000.png\n1,gone.png\n",
    )
    .unwrap();
    assert_refused(
        &mut track(&frames, &tags, &out, &[]),
        &["gone.png: cannot be read"],
    );
    assert!(!out.exists());
}

#[test]
fn track_names_a_wrong_tag_a_wrong_size_and_no_tag() {
    let (frames, out) = (two_frames("camera/tags"), RENDERED.join("wrong"));
    let text = fs::read_to_string(RENDERED.join("tags.toml")).unwrap();
    let tags = frames.join("tags.toml");
    fs::write(&tags, text.replace("tag = 1\n", "tag = 9\n")).unwrap();
    let mut run = track(&frames, &tags, &out, &["--rate", "30"]);
    assert_refused(
        &mut run,
        &[
            "the pusher's tag, number 9, is in none of the 2 frames; found are: 0 (2 times), 1 (2 times)",
            "Correct pusher.tag",
        ],
    );

    let mut run = track(
        &RENDERED.join("board"),
        &RENDERED.join("tags.toml"),
        &out,
        &["--rate", "30"],
    );
    assert_refused(
        &mut run,
        &["the object's tag, number 0, is in none of the 8 frames; found are: 100"],
    );

    // a tag said to be a tenth larger than it is
    fs::write(&tags, text.replace("size = 0.024", "size = 0.0264")).unwrap();
    let run = succeeds(&mut track(&frames, &tags, &out, &["--rate", "30"]));
    let told = String::from_utf8_lossy(&run.stderr);
    assert!(
        told.contains("warning: pusher tag 24.0 mm wide") && told.contains("pusher.size 26.4 mm"),
        "{told}"
    );

    let empty = empty_folder("camera/empty");
    fs::write(
        empty.join("a.pgm"),
        [b"P5 640 480 255\n".as_slice(), &vec![90; 640 * 480]].concat(),
    )
    .unwrap();
    assert_refused(
        &mut track(&empty, &tags, &out, &["--rate", "30"]),
        &["no tag of the family 36h11 is in any of the 1 frames"],
    );
    fs::write(
        empty.join("a.pgm"),
        [b"P5 64 48 255\n".as_slice(), &vec![90; 64 * 48]].concat(),
    )
    .unwrap();
    assert_refused(
        &mut track(&empty, &tags, &out, &["--rate", "30"]),
        &["a.pgm: the image has 64 x 48 pixels, the camera was calibrated at 640 x 480"],
    );
}

#[test]
fn track_refuses_sensors_of_other_times() {
    let tags = RENDERED.join("tags.toml");
    let sensors = Experiment::copy(SLIDE, "camera/sensors").log();
    let mut run = track(
        &RENDERED.join("frames"),
        &tags,
        &RENDERED.join("sensors"),
        &["--sensors", &sensors],
    );
    assert_refused(
        &mut run,
        &[
            "log.csv: row 0 is at 0 s, frame 0 at 3.33333",
            "one row for each frame",
        ],
    );
}

#[test]
fn calibrate_says_what_is_wrong_with_board_and_frames() {
    let out = empty_folder("camera/calibrate");
    let text = fs::read_to_string(RENDERED.join("board.toml")).unwrap();
    let with = |from: &str, to: &str, frames: &Path| {
        fs::write(out.join("board.toml"), text.replace(from, to)).unwrap();
        calibrate(frames, &out)
    };
    let board = RENDERED.join("board");
    assert_refused(
        &mut with("gap = 0.008", "gap = 0.001", &board),
        &["board.toml:", "`gap` is 0.001 m", "eighth of tag_size"],
    );
    assert_refused(
        &mut with("first_tag = 100", "first_tag = 200", &board),
        &[
            "the board, which has 200 to 234; found: 100, ",
            "Correct first_tag",
        ],
    );
    assert_refused(
        &mut with("", "", &two_frames("camera/few")),
        &["none of the tags found is on the board", "found: 0, 1"],
    );
    assert_refused(
        &mut with("", "", &empty_folder("camera/none")),
        &["there is no image in it", "help: give a folder with png"],
    );
    assert_refused(
        stickslip()
            .arg("calibrate")
            .arg(&board)
            .arg("--board")
            .arg(RENDERED.join("board.toml"))
            .args(["--flat", "x.png"]),
        &["--flat x.png: there is no such image; the first is 000.png, the last 007.png"],
    );
    assert!(!out.join("calibration.toml").exists());
}

#[test]
fn prints_of_board_and_tags_are_ready_to_use() {
    let folder = empty_folder("camera/prints");
    let at = |name: &str| folder.join(name).display().to_string();
    fs::write(
        at("board.toml"),
        "rows = 2\ncolumns = 3\ntag_size = 0.03\ngap = 0.01\n",
    )
    .unwrap();
    succeeds(stickslip().args(["print", &at("board.svg"), "--board", &at("board.toml")]));
    succeeds(stickslip().args(["print", &at("tags.svg"), "--tags", "0,1", "--size", "0.03"]));
    succeeds(stickslip().args(["print", &at("tags.pdf"), "--tags", "0,1", "--size", "0.03"]));
    assert!(fs::read(at("tags.pdf")).unwrap().starts_with(b"%PDF-1.4"));
    for (file, tags) in [("board.svg", 6), ("tags.svg", 2)] {
        let svg = fs::read_to_string(at(file)).unwrap();
        assert_eq!(svg.matches("id=\"tag").count(), tags, "{file}");
    }
    let large = stickslip()
        .args(["print", &at("x.svg"), "--tags", "0", "--size", "1"])
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&large.stderr).into_owned();
    assert!(
        large.status.code() == Some(1) && told.contains("the paper has"),
        "{told}"
    );
}
