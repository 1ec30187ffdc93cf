//! The fingers of a hand in scenes, logs and rows.

use std::io::Cursor;

use stickslip::Log;
use stickslip_dynamics::Pose;
use stickslip_formats::{
    BodiesError, McapError, NamedColumns, Topics, check_bodies, log_columns, log_of_columns,
    read_log, read_log_mcap, read_row_json, read_scene, write_log, write_log_mcap,
};

const HEADER: &str = "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta";
const SCENE: &str = "gravity = 9.81
object = { mass = 1, inertia = 1e-3, shape = [ { disc = { radius = 0.03 } } ] }
support = { friction = 0.3, tripod_radius = 0.02 }
pusher = { shape = [ { disc = { radius = 0.005 } } ], friction = 0.3 }
fixels = { friction = 0.25 }
fixel = [ { position = [1, 0], shape = [ { disc = { radius = 0.005 } } ] }, { position = [1, 1], shape = [ { disc = { radius = 0.005 } } ] } ]
";

/// The text must be refused at `place` with all of `words`.
fn refused(text: &str, place: &str, words: &[&str]) {
    let message = read_log(text.as_bytes(), "log.csv")
        .expect_err("must be refused")
        .to_string();
    assert!(
        message.starts_with(&format!("log.csv:{place}")),
        "{message}"
    );
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

#[test]
fn fingers_of_a_hand_have_columns_of_their_own() {
    let header = format!(
        "{HEADER},finger_1_x,finger_1_y,finger_1_theta,finger_2_x,finger_2_y,finger_2_theta,tactile_1"
    );
    let text = format!("{header}\n0,1,2,3,4,5,6,7,8,9,,,,1\n0.5,,,,4,5,6,,,,-1,0,0.25,0\n");
    let (log, warnings) = read_log(text.as_bytes(), "log.csv").expect("a log");
    assert!(warnings.is_empty(), "{warnings:?}");
    let [first, second] = &log.other_fingers[..] else {
        panic!("{log:?}");
    };
    assert_eq!(first, &[Some(Pose::new(7.0, 8.0, 9.0)), None]);
    assert_eq!(second, &[None, Some(Pose::new(-1.0, 0.0, 0.25))]);
    let mut written = Vec::new();
    write_log(&mut written, &log).expect("memory takes everything");
    assert_eq!(String::from_utf8(written).expect("text"), text);
    let columns = log_columns(&log);
    let named = columns
        .iter()
        .map(|(name, column)| (name.clone(), &column[..]));
    let named = NamedColumns::new(named.collect()).expect("columns");
    assert_eq!(log_of_columns(&named, "log"), Ok((log.clone(), vec![])));

    let line = r#"{"time": 0.5, "finger_2_x": -1, "finger_2_y": 0, "finger_2_theta": 0.25}"#;
    let row = read_row_json(line).expect("a row");
    assert_eq!(row.other_fingers, [None, second[1]]);

    refused(
        &format!("{HEADER},finger_1_x,finger_1_theta\n"),
        "1",
        &["`finger_1_y` is missing"],
    );
    refused(
        &format!("{HEADER},finger_2_x,finger_2_y,finger_2_theta\n"),
        "1",
        &["`finger_1_x` is missing"],
    );
    let one = format!("{HEADER},finger_1_x,finger_1_y,finger_1_theta\n0,1,2,3,4,5,6,7,,9\n");
    refused(&one, "2: column 9 (finger_1_y)", &["empty"]);
}

#[test]
fn a_log_has_the_fingers_of_its_scene() {
    let finger = "finger = [ { shape = [ { disc = { radius = 0.005 } } ] } ]\n";
    let jaw = read_scene(&format!("{SCENE}{finger}"), "scene.toml").expect("a hand");
    let log = |fingers: usize, sensors: usize| Log {
        other_fingers: vec![Vec::new(); fingers],
        tactile: vec![Vec::new(); sensors],
        ..Log::default()
    };
    // two fixels and two fingers
    assert_eq!(check_bodies(&log(1, 4), &jaw), Ok(()));
    let words = |error: BodiesError, words: [&str; 2]| {
        let message = error.to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    words(
        check_bodies(&log(1, 5), &jaw).expect_err("a sensor too many"),
        [
            "5 tactile sensors and the scene 2 fixels and 2 fingers",
            "tactile_5",
        ],
    );
    words(
        check_bodies(&log(0, 0), &jaw).expect_err("no finger"),
        [
            "0 fingers besides the pusher and the scene 1 [[finger]] table",
            "finger_k_x",
        ],
    );
    let many = format!("{SCENE}finger = [{}]\n", "{ shape = [] }, ".repeat(4));
    let error = read_scene(
        &many.replace("[]", "[ { disc = { radius = 0.005 } } ]"),
        "scene.toml",
    );
    let message = error.expect_err("too many fingers").to_string();
    assert!(message.contains("at most 3 other fingers"), "{message}");
}

#[test]
fn a_bag_has_a_topic_for_each_finger() {
    let at = |x: f64| Some(Pose::new(x, 0.25, 0.5));
    let log = Log {
        time: vec![0.0, 0.5, 1.0],
        object: vec![at(0.0), None, at(1.0)],
        pusher: vec![at(2.0), at(3.0), at(4.0)],
        other_fingers: vec![vec![at(5.0), at(6.0), None], vec![None, at(7.0), at(8.0)]],
        tactile: vec![vec![Some(true), Some(false), Some(true)]],
        ..Log::default()
    };
    let write = |topics: &Topics| {
        let mut bag = Cursor::new(Vec::new());
        write_log_mcap(&mut bag, &log, topics).expect("memory takes everything");
        bag.into_inner()
    };
    let read = |bag: Vec<u8>, topics: &Topics| read_log_mcap(&bag[..], "hand.mcap", topics);
    let plain = Topics::default();
    let mapped = ["finger_2=/right/pose".parse().expect("a mapping")];
    let mapped = Topics::new(mapped).expect("topics");
    for topics in [&plain, &mapped] {
        let (back, warnings) = read(write(topics), topics).expect("a bag");
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(back, log);
    }
    let message = |error: Result<_, McapError>| error.expect_err("refused").to_string();
    let missing = message(read(write(&plain), &mapped));
    assert!(
        missing.contains("the topic `/right/pose` (finger_2) is not there"),
        "{missing}"
    );
    let later = Topics::new(["finger_4=/pusher/pose2".parse().expect("a mapping")]);
    let gap = message(read(write(&plain), &later.expect("topics")));
    assert!(
        gap.contains("`/pusher/pose2` (finger_4) is not there"),
        "{gap}"
    );
}
