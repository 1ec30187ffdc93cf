//! `truth.csv` and `truth.json`.

use stickslip_dynamics::Pose;
use stickslip_formats::{TruthFacts, read_truth_csv, read_truth_json};

#[track_caller]
fn refused_csv(text: &str, place: &str, words: &[&str]) {
    let message = read_truth_csv(text.as_bytes(), "truth.csv").expect_err("must be refused").to_string();
    assert!(message.starts_with(&format!("truth.csv:{place}: ")), "expected place {place}: {message}");
    for word in words {
        assert!(message.contains(word), "expected `{word}`: {message}");
    }
}

#[track_caller]
fn refused_json(text: &str, place: &str, words: &[&str]) {
    let message = read_truth_json(text, "truth.json").expect_err("must be refused").to_string();
    assert!(message.starts_with(&format!("truth.json:{place}: ")), "expected place {place}: {message}");
    for word in words {
        assert!(message.contains(word), "expected `{word}`: {message}");
    }
}

#[test]
fn truth_csv_takes_time_and_pose_by_name() {
    let truth = read_truth_csv(&b"force,theta,time,y,x\n,3,0,2,1\nabc,6,0.5,5,4\n"[..], "truth.csv").unwrap();
    assert_eq!(truth.time, [0.0, 0.5]);
    assert_eq!(truth.pose, [Pose::new(1.0, 2.0, 3.0), Pose::new(4.0, 5.0, 6.0)]);
}

#[test]
fn truth_csv_with_holes_or_bad_cells_is_refused() {
    refused_csv("time,x,y\n0,1,2\n", "1", &["`theta`", "missing"]);
    refused_csv("time,x,y,theta\n0,1,,3\n", "2: column 3 (y)", &["empty"]);
    refused_csv("time,x,y,theta\n0,1,b,3\n", "2: column 3 (y)", &["`b`", "not a number"]);
    refused_csv("time,x,y,theta\n0,1,2,inf\n", "2: column 4 (theta)", &["`inf`", "not finite"]);
    refused_csv("time,x,y,theta\n0,1,2,3\n0,1,2,3\n", "3: column 1 (time)", &["rise"]);
    refused_csv("time,x,y,theta\n0,1,2\n", "2", &["3 cells", "4"]);
    refused_csv("time,x,y,theta\n", "1", &["no rows"]);
}

#[test]
fn truth_json_takes_known_keys_and_ignores_others() {
    let text = r#"{
        "source": "by hand", "mu_s": 0.16, "mu_p": 1, "mu_f": null, "d_tri": 0.02,
        "first_pusher_contact": 184, "first_fixel_contacts": [310, null], "occlude_from": 305,
        "final_pose": [0.5, -0.25, 3], "feet": [[1, 2]]
    }"#;
    let expected = TruthFacts {
        mu_s: Some(0.16),
        mu_p: Some(1.0),
        mu_f: None,
        d_tri: Some(0.02),
        first_pusher_contact: Some(184),
        first_fixel_contacts: vec![Some(310), None],
        occlude_from: Some(305),
        final_pose: Some(Pose::new(0.5, -0.25, 3.0)),
    };
    assert_eq!(read_truth_json(text, "truth.json"), Ok(expected));
    assert_eq!(read_truth_json("{}", "truth.json"), Ok(TruthFacts::default()));
}

#[test]
fn truth_json_of_wrong_types_is_refused_with_its_key() {
    refused_json("{\n  \"mu_s\": \"low\"\n}", "2:15", &["`mu_s`", "\"low\""]);
    refused_json("{ \"occlude_from\": -3 }", "1:20", &["`occlude_from`", "-3"]);
    refused_json("{ \"first_fixel_contacts\": [1, 2.5] }", "1:33", &["`first_fixel_contacts[1]`", "2.5"]);
    refused_json("{ \"final_pose\": [1, 2] }", "1:22", &["`final_pose`", "3"]);
}

#[test]
fn truth_json_that_is_no_object_is_refused() {
    refused_json("", "1:1", &["JSON"]);
    refused_json("\n [1, 2, 3, 4, 5, [], 7, null]", "2:2", &["object", "`[`"]);
    refused_json("3", "1:1", &["object", "`3`"]);
    refused_json("{ \"mu_s\": NaN }", "1:11", &["JSON"]);
    refused_json("{} x", "1:4", &["JSON"]);
}
