//! `truth.csv` and `truth.json`.

use proptest::prelude::*;
use stickslip_dynamics::{Pose, Twist};
use stickslip_formats::{
    Truth, TruthFacts, read_truth_csv, read_truth_json, write_truth_csv, write_truth_json,
};

#[track_caller]
fn refused_csv(text: &str, place: &str, words: &[&str]) {
    let message = read_truth_csv(text.as_bytes(), "truth.csv")
        .expect_err("must be refused")
        .to_string();
    assert!(
        message.starts_with(&format!("truth.csv:{place}: ")),
        "expected place {place}: {message}"
    );
    for word in words {
        assert!(message.contains(word), "expected `{word}`: {message}");
    }
}

#[track_caller]
fn refused_json(text: &str, place: &str, words: &[&str]) {
    let message = read_truth_json(text, "truth.json")
        .expect_err("must be refused")
        .to_string();
    assert!(
        message.starts_with(&format!("truth.json:{place}: ")),
        "expected place {place}: {message}"
    );
    for word in words {
        assert!(message.contains(word), "expected `{word}`: {message}");
    }
}

#[test]
fn truth_csv_takes_time_and_pose_by_name() {
    let truth = read_truth_csv(
        &b"force,theta,time,y,x\n,3,0,2,1\nabc,6,0.5,5,4\n"[..],
        "truth.csv",
    )
    .unwrap();
    assert_eq!(truth.time, [0.0, 0.5]);
    assert_eq!(
        truth.pose,
        [Pose::new(1.0, 2.0, 3.0), Pose::new(4.0, 5.0, 6.0)]
    );
}

#[test]
fn truth_csv_with_holes_or_bad_cells_is_refused() {
    refused_csv("time,x,y\n0,1,2\n", "1", &["`theta`", "missing"]);
    refused_csv("time,x,y,theta\n0,1,,3\n", "2: column 3 (y)", &["empty"]);
    refused_csv(
        "time,x,y,theta\n0,1,b,3\n",
        "2: column 3 (y)",
        &["`b`", "not a number"],
    );
    refused_csv(
        "time,x,y,theta\n0,1,2,inf\n",
        "2: column 4 (theta)",
        &["`inf`", "not finite"],
    );
    refused_csv(
        "time,x,y,theta\n0,1,2,3\n0,1,2,3\n",
        "3: column 1 (time)",
        &["rise"],
    );
    refused_csv("time,x,y,theta\n0,1,2\n", "2", &["3 cells", "4"]);
    refused_csv("time,x,y,theta\n", "1", &["no rows"]);
}

#[test]
fn truth_csv_takes_twist_pusher_and_forces_where_they_are_complete() {
    let text = "time,x,y,theta,vx,vy,omega,pusher_x,pusher_y,pusher_theta,force_pusher,force_1,force_2,force_4\n0,1,2,3,4,5,6,7,8,9,10,11,12,14\n";
    let truth = read_truth_csv(text.as_bytes(), "truth.csv").unwrap();
    assert_eq!(
        truth.twist,
        [Twist {
            vx: 4.0,
            vy: 5.0,
            omega: 6.0
        }]
    );
    assert_eq!(truth.pusher, [Pose::new(7.0, 8.0, 9.0)]);
    assert_eq!(
        (truth.pusher_force, truth.fixel_forces),
        (vec![10.0], vec![vec![11.0], vec![12.0]])
    );

    let text = "time,x,y,theta,vx,vy,pusher_x,pusher_y\n0,1,2,3,4,5,6,7\n";
    let truth = read_truth_csv(text.as_bytes(), "truth.csv").unwrap();
    assert!(truth.twist.is_empty() && truth.pusher.is_empty());
    refused_csv(
        "time,x,y,theta,force_pusher\n0,1,2,3,\n",
        "2: column 5 (force_pusher)",
        &["empty"],
    );
    refused_csv(
        "time,x,y,theta,vx,vy,omega\n0,1,2,3,4,a,6\n",
        "2: column 6 (vy)",
        &["`a`", "not a number"],
    );
}

#[test]
fn written_truth_has_the_columns_that_are_known() {
    let truth = Truth {
        time: vec![0.0, 0.5],
        pose: vec![Pose::new(1.0, 2.0, 3.0); 2],
        ..Truth::default()
    };
    assert_eq!(csv_of(&truth), "time,x,y,theta\n0,1,2,3\n0.5,1,2,3\n");
    let truth = Truth {
        twist: vec![Twist::default(); 2],
        fixel_forces: vec![vec![0.25, 0.0]; 2],
        ..truth
    };
    assert!(
        csv_of(&truth)
            .starts_with("time,x,y,theta,vx,vy,omega,force_1,force_2\n0,1,2,3,0,0,0,0.25,0.25\n")
    );
}

fn csv_of(truth: &Truth) -> String {
    let mut bytes = Vec::new();
    write_truth_csv(&mut bytes, truth).expect("memory takes everything");
    String::from_utf8(bytes).expect("text")
}

fn json_of(facts: &TruthFacts) -> String {
    let mut bytes = Vec::new();
    write_truth_json(&mut bytes, facts).expect("memory takes everything");
    String::from_utf8(bytes).expect("text")
}

#[test]
fn written_facts_read_back_and_are_null_where_nothing_is_known() {
    let facts = TruthFacts {
        source: Some("a rig \"of steel\"".to_owned()),
        mu_s: Some(0.1 + 0.2),
        d_tri: Some(1e-300),
        first_fixel_contacts: vec![None, Some(7)],
        occlude_from: Some(5),
        final_pose: Some(Pose::new(0.1, -0.0, 1e-17)),
        ..TruthFacts::default()
    };
    assert_eq!(read_truth_json(&json_of(&facts), "truth.json"), Ok(facts));
    let nothing = json_of(&TruthFacts::default());
    for line in [
        "\"mu_p\": null,",
        "\"first_fixel_contacts\": [],",
        "\"final_pose\": null",
    ] {
        assert!(nothing.contains(line), "{nothing}");
    }
}

proptest! {
    #[test]
    fn written_truth_reads_back_to_the_same_bits(values in prop::collection::vec(any::<f64>(), 12), fixels in 0..3_usize) {
        prop_assume!(values.iter().all(|value| value.is_finite()));
        let pose = |k: usize| Pose::new(values[k], values[k + 1], values[k + 2]);
        let truth = Truth {
            time: vec![values[0]],
            pose: vec![pose(1)],
            twist: vec![Twist { vx: values[4], vy: values[5], omega: values[6] }],
            pusher: vec![pose(7)],
            pusher_force: vec![values[10]],
            fixel_forces: vec![vec![values[11]]; fixels],
        };
        let back = read_truth_csv(csv_of(&truth).as_bytes(), "truth.csv").unwrap();
        let signs = |truth: &Truth| truth.pose[0].x.is_sign_negative();
        prop_assert_eq!(signs(&back), signs(&truth));
        prop_assert_eq!(back, truth);
    }
}

#[test]
fn truth_json_takes_known_keys_and_ignores_others() {
    let text = r#"{
        "source": "by hand", "mu_s": 0.16, "mu_p": 1, "mu_f": null, "d_tri": 0.02,
        "first_pusher_contact": 184, "first_fixel_contacts": [310, null], "occlude_from": 305,
        "final_pose": [0.5, -0.25, 3], "feet": [[1, 2]]
    }"#;
    let expected = TruthFacts {
        source: Some("by hand".to_owned()),
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
    assert_eq!(
        read_truth_json("{}", "truth.json"),
        Ok(TruthFacts::default())
    );
}

#[test]
fn truth_json_of_wrong_types_is_refused_with_its_key() {
    refused_json("{\n  \"mu_s\": \"low\"\n}", "2:15", &["`mu_s`", "\"low\""]);
    refused_json(
        "{ \"occlude_from\": -3 }",
        "1:20",
        &["`occlude_from`", "-3"],
    );
    refused_json(
        "{ \"first_fixel_contacts\": [1, 2.5] }",
        "1:33",
        &["`first_fixel_contacts[1]`", "2.5"],
    );
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
