//! `scene.toml`: keys and values of the wrong kind are refused at their place in their words.

use crate::scene_text::{FULL, LEAST, refused, refused_text, replaced};
use stickslip_formats::{SceneProblem, read_scene};

#[test]
fn message_has_file_place_value_rule_and_action() {
    let error = read_scene(
        &replaced(FULL, "mass = 0.50", "mass = -0.5"),
        "runs/a/scene.toml",
    )
    .expect_err("must be refused");
    assert_eq!(
        error.to_string(),
        "runs/a/scene.toml:4:8: object.mass is -0.5 kg; it must be positive. Give the object's mass in kg"
    );
    assert_eq!((error.line, error.column), (4, 8));
    assert!(matches!(*error.problem, SceneProblem::OutOfRange { .. }));
}

#[test]
fn column_counts_characters_not_bytes() {
    refused_text("\"µµ\" = 1", "1:1", &["µµ"]);
    refused_text("gravity = 'µ' # é\n[object]\n", "1:11", &["'µ'", "number"]);
    refused_text(
        "object = { name = \"µµ\", mas = 1 }\ngravity = 1",
        "1:12",
        &["object.name"],
    );
    refused_text(
        "gravity = 1\nobject = { \"mass\" = 1, \"µ\" = 1 }",
        "2:24",
        &["object.µ"],
    );
}

#[test]
fn text_that_is_no_toml_is_refused() {
    refused(
        "mass = 0.50",
        "mass = 0.50 kg",
        "4:8",
        &["mass = 0.50 kg", "TOML", "without a unit"],
    );
    refused("[object]", "[object", "3:8", &["TOML", "]"]);
    refused(
        "mass = 0.50",
        "mass = 1\nmass = 2",
        "5:1",
        &["TOML", "duplicate"],
    );
    refused_text(
        &format!("gravity = {}", "[".repeat(100_000)),
        "1:91",
        &["TOML"],
    );
}

#[test]
fn unknown_key_is_refused_with_the_nearest() {
    refused(
        "mass = 0.50",
        "mas = 0.50",
        "4:1",
        &["`object.mas`", "not a known key", "`mass`"],
    );
    refused(
        "gravity = 9.81",
        "gravty = 9.81",
        "1:1",
        &["`gravty`", "`gravity`"],
    );
    refused("[camera]", "[kamera]", "33:2", &["`kamera`", "`camera`"]);
    refused(
        "angle = 0.25",
        "angel = 0.25",
        "26:1",
        &["`fixel[1].angel`", "`angle`"],
    );
    refused(
        "radius = 0.004",
        "raduis = 0.004",
        "16:14",
        &["`pusher.shape[2].disc.raduis`", "`radius`"],
    );
    refused(
        "polygon",
        "polygone",
        "6:13",
        &["`object.shape[1].polygone`", "`polygon`"],
    );
    refused(
        "touch_force",
        "touchforce",
        "43:1",
        &["`tactile.touchforce`", "`touch_force`"],
    );
    refused(
        "force_std",
        "force-std",
        "46:1",
        &["`filter.force-std`", "`force_std`"],
    );
    refused(
        "tripod_angle",
        "tripod_angel",
        "11:1",
        &["`support.tripod_angel`", "`tripod_angle`"],
    );
}

#[test]
fn known_key_in_a_wrong_table_is_refused_with_its_place() {
    refused("[object]\n", "", "3:1", &["`mass`", "`object.mass`"]);
    refused(
        "mass = 0.50",
        "gravity = 9.81\nmass = 0.50",
        "4:1",
        &["`object.gravity`", "`gravity above all tables`"],
    );
    refused(
        "false_positive = 0.02",
        "latency = 0.02",
        "41:1",
        &["`tactile.latency`", "`camera.latency`"],
    );
}

#[test]
fn missing_key_is_refused_at_its_table() {
    for (from, to, place, key, unit) in [
        ("gravity = 9.81 ", "#", "1:1", "`gravity`", "m/s^2"),
        ("mass = 0.50\n", "", "3:1", "`object.mass`", "kg"),
        ("friction = 0.28\n", "", "8:1", "`support.friction`", ""),
        ("friction = 0.30\n", "", "13:1", "`pusher.friction`", ""),
        ("friction = 0.25\n", "", "21:1", "`fixels.friction`", ""),
        (
            "position = [0.2, -0.018] ",
            "#",
            "29:1",
            "`fixel[2].position`",
            "",
        ),
        (
            "position_std = 3.0e-4\n",
            "",
            "33:1",
            "`camera.position_std`",
            "",
        ),
        (
            "orientation_std = 5.2e-3\n",
            "",
            "33:1",
            "`camera.orientation_std`",
            "",
        ),
        (
            "{ radius = 0.005 }",
            "{}",
            "15:12",
            "`pusher.shape[1].disc.radius`",
            "",
        ),
    ] {
        refused(from, to, place, &[key, "missing", unit]);
    }
    refused_text(
        "gravity = 9.81\n",
        "1:1",
        &["`object`", "missing", "[object]", "mass"],
    );
}

#[test]
fn missing_shape_is_refused_at_its_table() {
    refused_text(
        &replaced(LEAST, "shape = [ { disc = { radius = 0.03 } } ]\n", ""),
        "2:1",
        &["`object.shape`", "missing", "polygon"],
    );
}

#[test]
fn wrong_type_is_refused() {
    refused(
        "mass = 0.50",
        "mass = \"0.5\"",
        "4:8",
        &["object.mass", "\"0.5\"", "a number", "kg"],
    );
    refused(
        "mass = 0.50",
        "mass = true",
        "4:8",
        &["object.mass", "true", "a number"],
    );
    refused(
        "mass = 0.50",
        "mass = [0.5]",
        "4:8",
        &["object.mass", "a list", "a number"],
    );
    refused(
        "mass = 0.50",
        "mass = 2020-01-01",
        "4:8",
        &["object.mass", "2020-01-01", "a number"],
    );
    refused(
        "[0.025, 0.025]",
        "[0.025, \"a\"]",
        "6:67",
        &["object.shape[1].polygon[3][2]", "\"a\"", "a number"],
    );
    refused(
        "position = [0.10, 0.018]",
        "position = [0.10, 0.018, 0]",
        "25:12",
        &["fixel[1].position", "a list of 3", "a list of 2", "[x, y]"],
    );
    refused(
        "position = [0.10, 0.018]",
        "position = 0.10",
        "25:12",
        &["fixel[1].position", "0.10", "a list"],
    );
    refused(
        "mu_s = [0.06, 0.9]",
        "mu_s = 0.9",
        "50:8",
        &["filter.mu_s", "0.9", "a list"],
    );
    refused(
        "{ radius = 0.005 }",
        "0.005",
        "15:12",
        &["pusher.shape[1].disc", "0.005", "a table"],
    );
    refused_text(
        &replaced(LEAST, "[fixels]", "[fixel]\nangle = 0\n[fixels]"),
        "12:1",
        &["fixel", "a table", "a list", "[[fixel]]"],
    );
    refused_text(
        "gravity = 1\nobject = 3",
        "2:10",
        &["object is 3", "a table", "[object]"],
    );
}
