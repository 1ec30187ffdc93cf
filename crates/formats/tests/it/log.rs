//! `log.csv`: columns by name, missing measurements, every kind of bad input at its place, and the
//! way there and back.

use stickslip::Log;
use stickslip_dynamics::Pose;
use stickslip_formats::{
    BodiesError, LogWarning, NamedColumns, check_bodies, log_of_columns, read_log, read_scene,
    write_log,
};

const HEADER: &str = "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta";
const SCENE: &str = "gravity = 9.81
object = { mass = 1, inertia = 1e-3, shape = [ { disc = { radius = 0.03 } } ] }
support = { friction = 0.3, tripod_radius = 0.02 }
pusher = { shape = [ { disc = { radius = 0.005 } } ], friction = 0.3 }
fixels = { friction = 0.25 }
fixel = [ { position = [1, 0], shape = [ { disc = { radius = 0.005 } } ] }, { position = [1, 1], shape = [ { disc = { radius = 0.005 } } ] } ]
";

#[track_caller]
fn read(text: &str) -> (Log, Vec<LogWarning>) {
    read_log(text.as_bytes(), "log.csv").unwrap_or_else(|error| panic!("{error}"))
}

/// The text must be refused at `place` with all of `words`.
#[track_caller]
fn refused(text: &str, place: &str, words: &[&str]) {
    let message = read_log(text.as_bytes(), "log.csv")
        .expect_err("must be refused")
        .to_string();
    assert!(
        message.starts_with(&format!("log.csv:{place}: ")),
        "expected place {place}: {message}"
    );
    for word in words {
        assert!(message.contains(word), "expected `{word}`: {message}");
    }
}

#[test]
fn log_with_a_cut_last_row_is_read_up_to_there_with_a_warning() {
    let header = format!("{HEADER},tactile_1,pusher_force_x,pusher_force_y");
    let whole = "0,1,2,3,4,5,6,1,7,8\n0.03,1,2,3,,,,0,,\n";
    let row = "0.07,1,2,3,4,5,6,1,7,-8e-3";
    let (expected, _) = read(&format!("{header}\n{whole}"));
    for length in 1..row.len() {
        let cut = &row[..length];
        let (log, warnings) = read(&format!("{header}\n{whole}{cut}"));
        if cut.ends_with("-8") {
            // it may be whole
            assert_eq!((log.len(), warnings), (3, vec![]));
            continue;
        }
        assert_eq!(log, expected, "{cut}");
        let [LogWarning::CutOff { at, size, why, .. }] = &warnings[..] else {
            panic!("{cut}: {warnings:?}");
        };
        let before = (header.len() + 1 + whole.len()) as u64;
        assert_eq!((*at, *size), (before, before + length as u64));
        assert!(warnings[0].is_loss() && why.contains("line 4"), "{why}");
    }
    // a row with an end is judged as it is, and a log of a cut row alone is none
    refused(&format!("{header}\n{whole}0.07,1\n"), "4", &["2 cells"]);
    refused(&format!("{header}\n0.07,1"), "2", &["2 cells"]);
}

#[test]
fn full_log_arrives() {
    let text = format!(
        "{HEADER},tactile_1,tactile_2,pusher_force_x,pusher_force_y\n0,1,2,3,4,5,6,0,1,7,8\n0.03,,,,,,,,,,\n0.07,1e-3,-2.5,+3,.5,5.,6,1,0,-7,0\n"
    );
    let (log, warnings) = read(&text);
    assert_eq!(warnings, []);
    assert_eq!(log.time, [0.0, 0.03, 0.07]);
    assert_eq!(
        log.object,
        [
            Some(Pose::new(1.0, 2.0, 3.0)),
            None,
            Some(Pose::new(0.001, -2.5, 3.0))
        ]
    );
    assert_eq!(
        log.pusher,
        [
            Some(Pose::new(4.0, 5.0, 6.0)),
            None,
            Some(Pose::new(0.5, 5.0, 6.0))
        ]
    );
    assert_eq!(
        log.tactile,
        [
            [Some(false), None, Some(true)],
            [Some(true), None, Some(false)]
        ]
    );
    assert_eq!(log.force, [Some([7.0, 8.0]), None, Some([-7.0, 0.0])]);
}

#[test]
fn columns_are_found_by_name_in_any_order() {
    let text = "tactile_2,pusher_theta,object_y,time,tactile_1,object_theta,pusher_x,object_x,pusher_y\n1,6,2,0,0,3,4,1,5\n";
    let (log, _) = read(text);
    assert_eq!(
        (log.object[0], log.pusher[0]),
        (
            Some(Pose::new(1.0, 2.0, 3.0)),
            Some(Pose::new(4.0, 5.0, 6.0))
        )
    );
    assert_eq!(log.tactile, [[Some(false)], [Some(true)]]);
    assert!(log.force.is_empty());
}

#[test]
fn columns_with_an_infinite_pose_are_refused() {
    let names = HEADER.split(',').map(str::to_owned);
    let mut columns = [[0.0, 1.0]; 7];
    columns[2][1] = f64::NEG_INFINITY;
    let named = names
        .zip(columns.iter().map(|column| &column[..]))
        .collect();
    let error = log_of_columns(&NamedColumns::new(named).unwrap(), "log").unwrap_err();
    assert_eq!(
        error.to_string(),
        "row 1: `object_y` is -inf; it must be finite"
    );
}

#[test]
fn extra_columns_are_ignored_with_a_warning_that_names_them() {
    let (log, warnings) = read(&format!(
        "frame,{HEADER},tactile_left\n17,0,1,2,3,4,5,6,\"a, b\"\n"
    ));
    assert_eq!((log.len(), log.tactile.len()), (1, 0));
    assert_eq!(warnings.len(), 1);
    assert_eq!(
        warnings[0].to_string(),
        "log.csv:1: extra columns are ignored: frame, tactile_left"
    );
    let (_, warnings) = read(&format!(",{HEADER}\n17,0,1,2,3,4,5,6\n"));
    assert_eq!(
        warnings[0].to_string(),
        "log.csv:1: extra columns are ignored: (number 1, without a name)"
    );
}

#[test]
fn line_endings_byte_order_mark_blanks_and_quotes_are_read() {
    let plain = format!("{HEADER}\n0,1,2,3,4,5,6\n0.1,,,,4,5,6\n");
    let (expected, _) = read(&plain);
    assert_eq!(read(&plain.replace('\n', "\r\n")).0, expected);
    assert_eq!(read(&format!("\u{feff}{plain}")).0, expected);
    assert_eq!(read(&format!("{plain}\n  \r\n\n")).0, expected);
    assert_eq!(read(plain.trim_end()).0, expected);
    assert_eq!(read(&plain.replace(',', " , ")).0, expected);
    assert_eq!(
        read(
            &plain
                .replace("object_x", "\"object_x\"")
                .replace("0.1", "\"0.1\"")
        )
        .0,
        expected
    );
}

#[test]
fn last_cell_of_the_file_may_be_empty() {
    let (log, _) = read(&format!("{HEADER},tactile_1\n0,1,2,3,4,5,6,\n"));
    assert_eq!(log.tactile, [[None]]);
}

#[test]
fn empty_file_and_header_alone_are_refused() {
    refused("", "1", &["empty", "columns"]);
    refused("\u{feff}\r\n\n", "1", &["empty"]);
    refused(HEADER, "1", &["no rows"]);
    refused(&format!("{HEADER}\r\n\r\n"), "1", &["no rows"]);
}

#[test]
fn missing_column_is_refused_with_the_nearest() {
    for name in HEADER.split(',') {
        let header = HEADER
            .split(',')
            .map(|other| if other == name { "elsewhere_0" } else { other })
            .collect::<Vec<_>>()
            .join(",");
        refused(
            &format!("{header}\n0,1,2,3,4,5,6\n"),
            "1",
            &[&format!("`{name}`"), "missing"],
        );
    }
    refused(
        &format!(
            "{}\n0,1,2,3,4,5,6\n",
            HEADER.replace("object_theta", "object_tetha")
        ),
        "1",
        &["`object_theta`", "`object_tetha`"],
    );
    refused("0,1,2,3,4,5,6\n", "1", &["`time`", "missing", "first line"]);
    refused(
        "0.5,1,2,,4,0,0\n",
        "1",
        &["`time`", "missing", "numbers", "`0.5`"],
    );
    refused(
        &format!("# of Monday\n{HEADER}\n0,1,2,3,4,5,6\n"),
        "1",
        &["`time`", "missing", "comment"],
    );
    refused(
        &format!("{}\n0;1;2;3;4;5;6\n", HEADER.replace(',', ";")),
        "1",
        &["`time`", "';'", "commas"],
    );
}

#[test]
fn column_named_twice_is_refused() {
    refused(
        &format!("{HEADER},object_y\n0,1,2,3,4,5,6,7\n"),
        "1: column 8 (object_y)",
        &["column 3"],
    );
}

#[test]
fn wrong_column_count_is_refused() {
    refused(
        &format!("{HEADER}\n0,1,2,3,4,5,6\n0.1,1,2,3,4,5\n"),
        "3",
        &["6 cells", "7"],
    );
    refused(
        &format!("{HEADER}\n0,1,2,3,4,5,6,7\n"),
        "2",
        &["8 cells", "7"],
    );
    refused(
        &format!("{HEADER}\n0,1,2,3,4,5,6\n\n0.1,1,2,3,4,5,6\n"),
        "3",
        &["0 cells", "7"],
    );
    refused(
        &format!("{HEADER}\n# a comment\n0.1,1,2,3,4,5,6\n"),
        "2",
        &["1 cells", "7"],
    );
}

#[test]
fn bad_number_is_refused() {
    refused(
        &format!("{HEADER}\n0,1,2,3,4,5,6\n0.1,1,abc,3,4,5,6\n"),
        "3: column 3 (object_y)",
        &["`abc`", "not a number"],
    );
    refused(
        &format!("{HEADER}\n0 s,1,2,3,4,5,6\n"),
        "2: column 1 (time)",
        &["`0 s`", "not a number"],
    );
    refused(
        &format!("{HEADER}\n0,1,2,3,4,5,\"6,5\"\n"),
        "2: column 7 (pusher_theta)",
        &["`6,5`", "not a number"],
    );
    refused(
        &format!("{HEADER},pusher_force_x,pusher_force_y\n0,1,2,3,4,5,6,-,-\n"),
        "2: column 8 (pusher_force_x)",
        &["`-`"],
    );
}

#[test]
fn number_that_is_not_finite_is_refused() {
    for value in ["NaN", "nan", "inf", "-inf", "infinity", "1e999"] {
        let text = format!("{HEADER}\n0,1,2,3,{value},5,6\n");
        refused(
            &text,
            "2: column 5 (pusher_x)",
            &[&format!("`{value}`"), "not finite", "empty"],
        );
    }
}

#[test]
fn time_must_be_there_and_rise() {
    refused(
        &format!("{HEADER}\n0,1,2,3,4,5,6\n,1,2,3,4,5,6\n"),
        "3: column 1 (time)",
        &["empty"],
    );
    refused(
        &format!("{HEADER}\n0.5,1,2,3,4,5,6\n0.5,1,2,3,4,5,6\n"),
        "3: column 1 (time)",
        &["0.5 s comes after 0.5 s", "rise"],
    );
    refused(
        &format!("{HEADER}\n0.5,1,2,3,4,5,6\n0.25,1,2,3,4,5,6\n"),
        "3: column 1 (time)",
        &["0.25 s comes after 0.5 s"],
    );
}

#[test]
fn measurement_in_part_is_refused() {
    refused(
        &format!("{HEADER}\n0,1,,3,4,5,6\n"),
        "2: column 3 (object_y)",
        &["empty", "`object_x`", "object_x, object_y, object_theta"],
    );
    refused(
        &format!("{HEADER}\n0,1,2,3,,5,6\n"),
        "2: column 5 (pusher_x)",
        &["empty", "`pusher_y`"],
    );
    let text = format!("{HEADER},pusher_force_x,pusher_force_y\n0,1,2,3,4,5,6,1,\n");
    refused(
        &text,
        "2: column 9 (pusher_force_y)",
        &["empty", "`pusher_force_x`"],
    );
}

#[test]
fn one_force_column_alone_is_refused() {
    refused(
        &format!("{HEADER},pusher_force_x\n0,1,2,3,4,5,6,7\n"),
        "1",
        &["`pusher_force_y`", "missing"],
    );
    refused(
        &format!("{HEADER},pusher_force_y\n0,1,2,3,4,5,6,7\n"),
        "1",
        &["`pusher_force_x`", "missing"],
    );
}

#[test]
fn tactile_cell_that_is_neither_0_nor_1_is_refused() {
    for value in ["2", "-1", "0.5", "true", "nan"] {
        let text = format!("{HEADER},tactile_1\n0,1,2,3,4,5,6,{value}\n");
        refused(
            &text,
            "2: column 8 (tactile_1)",
            &[&format!("`{value}`"), "neither 0 nor 1"],
        );
    }
    assert_eq!(
        read(&format!("{HEADER},tactile_1\n0,1,2,3,4,5,6,1.0\n"))
            .0
            .tactile,
        [[Some(true)]]
    );
}

#[test]
fn sensor_numbers_with_a_gap_are_refused() {
    refused(
        &format!("{HEADER},tactile_1,tactile_3\n0,1,2,3,4,5,6,0,0\n"),
        "1: column 9 (tactile_3)",
        &["`tactile_2`", "[[fixel]]"],
    );
    refused(
        &format!("{HEADER},tactile_0\n0,1,2,3,4,5,6,0\n"),
        "1: column 8 (tactile_0)",
        &["`tactile_1`"],
    );
    refused(
        &format!("{HEADER},tactile_01\n0,1,2,3,4,5,6,0\n"),
        "1: column 8 (tactile_01)",
        &["`tactile_1`"],
    );
    let huge = "tactile_99999999999999999999999999";
    refused(
        &format!("{HEADER},{huge}\n0,1,2,3,4,5,6,0\n"),
        &format!("1: column 8 ({huge})"),
        &["`tactile_1`"],
    );
}

#[test]
fn more_sensors_than_fixels_are_refused_and_fewer_are_not() {
    let setup = read_scene(SCENE, "scene.toml").expect("a scene with two fixels");
    let with_sensors = |sensors: usize| Log {
        tactile: vec![Vec::new(); sensors],
        ..Log::default()
    };
    for sensors in 0..=2 {
        assert_eq!(check_bodies(&with_sensors(sensors), &setup), Ok(()));
    }
    let error = check_bodies(&with_sensors(3), &setup).expect_err("one too many");
    assert_eq!(
        error,
        BodiesError::Sensors {
            sensors: 3,
            fixels: 2,
            fingers: 1,
            most: 2
        }
    );
    for word in ["3 tactile sensors", "2 fixels", "tactile_3", "[[fixel]]"] {
        assert!(error.to_string().contains(word), "{error}");
    }
}

#[test]
fn write_log_writes_the_contract() {
    let log = Log {
        time: vec![0.0, 0.04],
        object: vec![Some(Pose::new(0.5, -0.25, 1e-9)), None],
        object_covariance: Vec::new(),
        pusher: vec![None, Some(Pose::new(1.0, 2.0, -0.0))],
        other_fingers: Vec::new(),
        tactile: vec![vec![Some(true), None], vec![Some(false), Some(false)]],
        force: vec![None, Some([1.5, 0.0])],
    };
    let expected = format!(
        "{HEADER},tactile_1,tactile_2,pusher_force_x,pusher_force_y\n0,0.5,-0.25,1e-9,,,,1,0,,\n0.04,,,,1,2,-0,,0,1.5,0\n"
    );
    assert_eq!(String::from_utf8(written(&log)).expect("text"), expected);
}

fn written(log: &Log) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_log(&mut bytes, log).expect("memory takes everything");
    bytes
}
