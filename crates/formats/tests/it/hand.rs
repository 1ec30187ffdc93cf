//! The fingers of a hand in scenes, logs and rows.

use stickslip::Log;
use stickslip_dynamics::Pose;
use stickslip_formats::{
    BodiesError, NamedColumns, check_bodies, log_columns, log_of_columns, read_log, read_row_json,
    read_scene, write_log,
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
    assert!(message.starts_with(&format!("log.csv:{place}")), "{message}");
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
    assert_eq!(log_of_columns(&named, "log"), Ok((log, vec![])));

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
