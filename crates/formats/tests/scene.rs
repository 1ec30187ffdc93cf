//! `scene.toml`: every key arrives where it belongs, every kind of bad input is refused at its
//! place in its words.

use std::f64::consts::FRAC_PI_2;

use stickslip::{Camera, FilterSettings, Limits, Setup, Tactile};
use stickslip_dynamics::{Feet, Friction, Part, Pose, Shape, SpeedProfile, Start};
use stickslip_formats::{SceneProblem, read_scene};

/// Every key of the format, none with its default.
const FULL: &str = include_str!("full_scene.toml");

/// Only the keys that have no default.
const LEAST: &str = "gravity = 9.81
[object]
mass = 1
inertia = 1e-3
shape = [ { disc = { radius = 0.03 } } ]
[support]
friction = 0.3
tripod_radius = 0.02
[pusher]
shape = [ { disc = { radius = 0.005 } } ]
friction = 0.3
[fixels]
friction = 0.25
";

fn read(text: &str) -> Setup {
    read_scene(text, "scene.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Reads the full scene with `from` replaced by `to`; it must be refused at `place` with all of
/// `words`.
#[track_caller]
fn refused(from: &str, to: &str, place: &str, words: &[&str]) {
    refused_text(&replaced(FULL, from, to), place, words);
}

#[track_caller]
fn refused_text(text: &str, place: &str, words: &[&str]) {
    let message = read_scene(text, "scene.toml")
        .expect_err("must be refused")
        .to_string();
    assert!(
        message.starts_with(&format!("scene.toml:{place}: ")),
        "expected place {place}: {message}"
    );
    for word in words {
        assert!(message.contains(word), "expected `{word}`: {message}");
    }
}

#[track_caller]
fn replaced(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "`{from}` once");
    text.replace(from, to)
}

fn same_shape(shape: &Shape, parts: Vec<Part>) {
    assert_eq!(
        format!("{shape:?}"),
        format!("{:?}", Shape::new(parts).expect("a shape"))
    );
}

#[test]
fn full_scene_bodies_arrive() {
    let scene = read(FULL).scene;
    assert_eq!(scene.gravity, 9.81);
    assert_eq!((scene.object.mass, scene.object.inertia), (0.5, 2.1e-4));
    assert_eq!(scene.feet, Feet::Tripod { angle: 0.5 });
    assert_eq!(scene.pusher.stall_force, Some(20.0));
    assert_eq!(
        scene.nominal,
        Friction {
            mu_s: 0.28,
            mu_p: 0.30,
            mu_f: 0.25,
            d_tri: 0.02
        }
    );
    assert_eq!(
        scene
            .fixels
            .iter()
            .map(|fixel| fixel.pose)
            .collect::<Vec<_>>(),
        [Pose::new(0.1, 0.018, 0.25), Pose::new(0.2, -0.018, 0.0)]
    );
}

#[test]
fn full_scene_shapes_arrive() {
    let scene = read(FULL).scene;
    let corners = vec![
        [-0.025, -0.025],
        [0.025, -0.025],
        [0.025, 0.025],
        [-0.025, 0.025],
    ];
    same_shape(
        &scene.object.shape,
        vec![Part::Polygon { vertices: corners }],
    );
    let discs = vec![
        Part::Disc {
            radius: 0.005,
            centre: [0.0, 0.0],
        },
        Part::Disc {
            radius: 0.004,
            centre: [0.01, 0.0],
        },
    ];
    same_shape(&scene.pusher.shape, discs);
    same_shape(
        &scene.fixels[0].shape,
        vec![Part::Ellipse {
            semi_axes: [0.03, 0.02],
            centre: [0.0, 0.01],
            angle: 0.125,
        }],
    );
    same_shape(
        &scene.fixels[1].shape,
        vec![Part::Ellipse {
            semi_axes: [0.03, 0.02],
            centre: [0.0, 0.0],
            angle: 0.0,
        }],
    );
}

#[test]
fn full_scene_sensing_arrives() {
    let setup = read(FULL);
    let camera = Camera {
        position_std: 3.0e-4,
        orientation_std: 5.2e-3,
        latency: 0.125,
        pusher_position_std: 0.0,
        pusher_orientation_std: 1.0e-3,
    };
    assert_eq!(setup.camera, Some(camera));
    assert_eq!(
        setup.tactile,
        Tactile {
            false_positive: 0.02,
            false_negative: 0.06,
            touch_force: 0.07
        }
    );
    let filter = FilterSettings {
        force_std: 0.16,
        parameter_std: 0.04,
        resample_below: 0.6,
        likelihood_scale: 1.25,
        limits: Friction {
            mu_s: Limits {
                min: 0.06,
                max: 0.9,
            },
            mu_p: Limits {
                min: 0.03,
                max: 0.8,
            },
            mu_f: Limits {
                min: 0.04,
                max: 0.7,
            },
            d_tri: Limits {
                min: 0.004,
                max: 0.03,
            },
        },
    };
    assert_eq!(setup.filter, filter);
}

#[test]
fn full_scene_start_arrives() {
    let start = Start {
        object: Pose::new(0.01, -0.02, 0.5),
        pusher: Pose::new(-0.08, 0.001, 0.0),
        direction: 0.125,
        speed: SpeedProfile::new(vec![[0.0, 0.0], [0.5, 0.02], [8.0, 0.02], [8.0, 0.0]])
            .expect("a profile"),
        duration: 12.5,
    };
    assert_eq!(read(FULL).start, Some(start));
    assert_eq!(read(LEAST).start, None);
}

#[test]
fn start_has_a_direction_by_default_and_may_have_one_speed() {
    let start = "[start]\nobject = [0, 0, 0]\npusher = [-1, 0, 0]\nspeed = 0.02\nduration = 3\n";
    let start = read(&format!("{LEAST}{start}")).start.expect("a start");
    assert_eq!(
        (start.direction, start.speed),
        (0.0, SpeedProfile::constant(0.02))
    );
}

#[test]
fn start_that_cannot_be_is_refused() {
    refused(
        "duration = 12.5 ",
        "duration = 0 ",
        "60:12",
        &["start.duration is 0 s", "positive"],
    );
    refused(
        "duration = 12.5 ",
        "# ",
        "55:1",
        &["`start.duration`", "missing", "how long"],
    );
    refused(
        "object = [0.01, -0.02, 0.5]",
        "",
        "55:1",
        &["`start.object`", "missing", "[x, y, theta]"],
    );
    refused(
        "object = [0.01, -0.02, 0.5]",
        "object = [0.01, -0.02]",
        "56:10",
        &["start.object", "a list of 2", "a list of 3"],
    );
    refused(
        "[-0.08, 0.001, 0]",
        "[-0.08, inf, 0]",
        "57:18",
        &["start.pusher[2]", "inf", "finite"],
    );
    refused(
        "direction = 0.125",
        "direction = \"east\"",
        "58:13",
        &["start.direction", "\"east\"", "a number", "rad"],
    );
    refused(
        "direction = 0.125",
        "heading = 0.125",
        "58:1",
        &["`start.heading`", "not a known key"],
    );
}

#[test]
fn start_with_a_speed_that_is_none_is_refused() {
    const GOOD: &str = "speed = [[0, 0], [0.5, 0.02], [8, 0.02], [8, 0]]";
    refused(
        GOOD,
        "speed = \"slow\"",
        "59:9",
        &["start.speed", "\"slow\"", "a number", "m/s"],
    );
    refused(
        GOOD,
        "speed = []",
        "59:9",
        &["start.speed", "an empty list", "[[time, speed], ...]"],
    );
    refused(
        GOOD,
        "speed = [0.02]",
        "59:10",
        &["start.speed[1]", "a list"],
    );
    refused(
        GOOD,
        "speed = [[0, 0, 1]]",
        "59:10",
        &["start.speed[1]", "a list of 3", "a list of 2"],
    );
    refused(
        GOOD,
        "speed = [[-1, 0]]",
        "59:11",
        &["start.speed[1][1]", "-1 s", "zero or positive"],
    );
    refused(
        GOOD,
        "speed = [[1, 0], [0.5, 0.02]]",
        "59:19",
        &["start.speed[2][1] is 0.5 s", "at or after"],
    );
    refused(
        GOOD,
        "speed = [[1, nan]]",
        "59:14",
        &["start.speed[1][2]", "nan", "finite"],
    );
}

#[test]
fn scene_of_the_guide_is_one() {
    let guide = include_str!("../../../docs/guide/formats.md");
    let scene = guide
        .split("```toml\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .expect("a scene in the guide");
    let setup = read(scene);
    assert_eq!(
        (setup.filter, setup.tactile),
        (FilterSettings::default(), Tactile::default())
    );
    assert!(setup.start.is_some() && setup.camera.is_some());
}

#[test]
fn least_scene_takes_the_defaults_of_the_contract() {
    let setup = read(LEAST);
    assert_eq!(setup.scene.feet, Feet::Tripod { angle: FRAC_PI_2 });
    assert!(
        setup.scene.fixels.is_empty()
            && setup.scene.pusher.stall_force.is_none()
            && setup.camera.is_none()
    );
    assert_eq!(
        setup.tactile,
        Tactile {
            false_positive: 0.01,
            false_negative: 0.05,
            touch_force: 0.05
        }
    );
    let filter = FilterSettings {
        force_std: 0.15,
        parameter_std: 0.05,
        resample_below: 0.5,
        likelihood_scale: 1.5,
        limits: Friction {
            mu_s: Limits {
                min: 0.05,
                max: 1.0,
            },
            mu_p: Limits {
                min: 0.02,
                max: 1.0,
            },
            mu_f: Limits {
                min: 0.02,
                max: 1.0,
            },
            d_tri: Limits {
                min: 0.003,
                max: 0.04,
            },
        },
    };
    assert_eq!(setup.filter, filter);
}

#[test]
fn camera_defaults_are_those_of_the_contract() {
    let setup = read(&format!(
        "{LEAST}[camera]\nposition_std = 1e-3\norientation_std = 0.01\n[tactile]\n[filter]\n"
    ));
    let camera = Camera {
        position_std: 1e-3,
        orientation_std: 0.01,
        latency: 0.0,
        pusher_position_std: 1e-4,
        pusher_orientation_std: 2e-3,
    };
    assert_eq!(
        (setup.camera, setup.tactile, setup.filter),
        (Some(camera), Tactile::default(), FilterSettings::default())
    );
}

#[test]
fn known_feet_carry_what_statics_says() {
    // balance by hand: (0, 2d) carries half, the two at y = -2d a quarter each, so that sum N y = 0
    // and sum N x = 0
    let feet = "feet = [[-0.03, -0.02], [0.03, -0.02], [0.0, 0.02]]";
    let Feet::Known { positions, loads } = read(&replaced(LEAST, "tripod_radius = 0.02", feet))
        .scene
        .feet
    else {
        panic!("known feet")
    };
    assert_eq!(positions, [[-0.03, -0.02], [0.03, -0.02], [0.0, 0.02]]);
    for (load, expected) in loads.iter().zip([0.25, 0.25, 0.5]) {
        assert!((load - expected).abs() < 1e-15, "{loads:?}");
    }
}

#[test]
fn known_feet_have_their_mean_radius_as_nominal() {
    let feet = "feet = [[-0.03, -0.04], [0.03, -0.04], [0.0, 0.02]]";
    let d_tri = read(&replaced(LEAST, "tripod_radius = 0.02", feet))
        .scene
        .nominal
        .d_tri;
    assert!((d_tri - 0.04).abs() < 1e-15, "{d_tri}");
}

#[test]
fn windows_line_endings_and_byte_order_mark_are_read() {
    read(&FULL.replace('\n', "\r\n"));
    read(&format!("\u{feff}{FULL}"));
    refused_text("\u{feff}gravity = 0", "1:11", &["positive"]);
}

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
    refused(
        "gravity = 9.81 ",
        "#",
        "1:1",
        &["`gravity`", "missing", "m/s^2"],
    );
    refused(
        "mass = 0.50\n",
        "",
        "3:1",
        &["`object.mass`", "missing", "kg"],
    );
    refused(
        "inertia = 2.1e-4\n",
        "",
        "3:1",
        &["`object.inertia`", "missing", "kg m^2"],
    );
    refused(
        "friction = 0.28\n",
        "",
        "8:1",
        &["`support.friction`", "missing"],
    );
    refused(
        "tripod_radius = 0.02 ",
        "#",
        "8:1",
        &["`support.tripod_radius`", "missing", " m"],
    );
    refused(
        "friction = 0.30\n",
        "",
        "13:1",
        &["`pusher.friction`", "missing"],
    );
    refused(
        "friction = 0.25\n",
        "",
        "21:1",
        &["`fixels.friction`", "missing"],
    );
    refused(
        "position = [0.2, -0.018] ",
        "#",
        "29:1",
        &["`fixel[2].position`", "missing"],
    );
    refused(
        "position_std = 3.0e-4\n",
        "",
        "33:1",
        &["`camera.position_std`", "missing"],
    );
    refused(
        "orientation_std = 5.2e-3\n",
        "",
        "33:1",
        &["`camera.orientation_std`", "missing"],
    );
    refused(
        "{ radius = 0.005 }",
        "{}",
        "15:12",
        &["`pusher.shape[1].disc.radius`", "missing"],
    );
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

#[test]
fn numbers_that_are_not_finite_are_refused() {
    for value in ["nan", "inf", "-inf", "1e999"] {
        refused(
            "mass = 0.50",
            &format!("mass = {value}"),
            "4:8",
            &["object.mass", value, "finite", "kg"],
        );
    }
    refused(
        "[0.025, 0.025]",
        "[0.025, nan]",
        "6:67",
        &["object.shape[1].polygon[3][2]", "nan", "finite"],
    );
    refused(
        "mass = 0.50",
        "mass = 99999999999999999999",
        "4:8",
        &["object.mass", "99999999999999999999", "too large"],
    );
}

#[test]
fn numbers_against_their_rule_are_refused() {
    refused(
        "gravity = 9.81",
        "gravity = 0",
        "1:11",
        &["gravity is 0 m/s^2", "positive"],
    );
    refused(
        "inertia = 2.1e-4",
        "inertia = -1",
        "5:11",
        &["object.inertia is -1 kg m^2", "positive"],
    );
    refused(
        "mass = 0.50",
        "mass = 0",
        "4:8",
        &["object.mass is 0 kg", "positive"],
    );
    refused(
        "friction = 0.28",
        "friction = -0.28",
        "9:12",
        &["support.friction is -0.28", "zero or positive"],
    );
    refused(
        "friction = 0.30",
        "friction = -1",
        "18:12",
        &["pusher.friction is -1", "zero or positive"],
    );
    refused(
        "friction = 0.25",
        "friction = -1",
        "22:12",
        &["fixels.friction is -1", "zero or positive"],
    );
    refused(
        "tripod_radius = 0.02",
        "tripod_radius = 0",
        "10:17",
        &["support.tripod_radius is 0 m", "positive"],
    );
    refused(
        "stall_force = 20",
        "stall_force = 0",
        "19:15",
        &["pusher.stall_force is 0 N", "positive"],
    );
}

#[test]
fn sensing_numbers_against_their_rule_are_refused() {
    refused(
        "\nposition_std = 3.0e-4",
        "\nposition_std = 0",
        "34:16",
        &["camera.position_std is 0 m", "positive"],
    );
    refused(
        "\norientation_std = 5.2e-3",
        "\norientation_std = -1",
        "35:19",
        &["camera.orientation_std is -1 rad", "positive"],
    );
    refused(
        "latency = 0.125",
        "latency = -0.1",
        "36:11",
        &["camera.latency is -0.1 s", "zero or positive"],
    );
    refused(
        "pusher_position_std = 0",
        "pusher_position_std = -1e-4",
        "37:23",
        &["camera.pusher_position_std is -1e-4 m", "zero or positive"],
    );
    refused(
        "1.0e-3",
        "-1.0e-3",
        "38:26",
        &[
            "camera.pusher_orientation_std is -1.0e-3 rad",
            "zero or positive",
        ],
    );
    for value in ["0", "1", "1.5", "-0.1"] {
        refused(
            "false_positive = 0.02",
            &format!("false_positive = {value}"),
            "41:18",
            &["tactile.false_positive", value, "between 0 and 1"],
        );
        refused(
            "false_negative = 0.06",
            &format!("false_negative = {value}"),
            "42:18",
            &["tactile.false_negative", value, "between 0 and 1"],
        );
    }
    refused(
        "touch_force = 0.07",
        "touch_force = -0.07",
        "43:15",
        &["tactile.touch_force is -0.07 N", "zero or positive"],
    );
}

#[test]
fn filter_numbers_against_their_rule_are_refused() {
    refused(
        "force_std = 0.16",
        "force_std = -1",
        "46:13",
        &["filter.force_std is -1", "zero or positive"],
    );
    refused(
        "parameter_std = 0.04",
        "parameter_std = -1",
        "47:17",
        &["filter.parameter_std is -1", "zero or positive"],
    );
    refused(
        "resample_below = 0.6",
        "resample_below = 50",
        "48:18",
        &["filter.resample_below is 50", "from 0 to 1"],
    );
    refused(
        "likelihood_scale = 1.25",
        "likelihood_scale = 0",
        "49:20",
        &["filter.likelihood_scale is 0", "positive"],
    );
    refused(
        "mu_s = [0.06, 0.9]",
        "mu_s = [0.9, 0.06]",
        "50:8",
        &["filter.mu_s is [0.9, 0.06]", "smaller limit first"],
    );
    refused(
        "mu_p = [0.03, 0.8]",
        "mu_p = [-0.1, 0.8]",
        "51:9",
        &["filter.mu_p[1] is -0.1", "zero or positive"],
    );
    refused(
        "d_tri = [0.004, 0.03]",
        "d_tri = [0, 0.03]",
        "53:10",
        &["filter.d_tri[1] is 0 m", "positive"],
    );
}

#[test]
fn nominal_friction_outside_its_limits_is_allowed() {
    assert_eq!(
        read(&replaced(FULL, "friction = 0.28", "friction = 2"))
            .scene
            .nominal
            .mu_s,
        2.0
    );
}

#[test]
fn feet_that_cannot_be_are_refused() {
    let with = |feet: &str| replaced(LEAST, "tripod_radius = 0.02", &format!("feet = {feet}"));
    refused_text(
        &with("[[0.01, 0], [0.03, 0], [0.01, 0.02]]"),
        "8:8",
        &["centre of mass", "outside", "foot 2", "-0.5"],
    );
    refused_text(
        &with("[[-1, -1], [0, 0], [1, 1]]"),
        "8:8",
        &["support.feet", "one line", "triangle"],
    );
    refused_text(
        &with("[[-1, -1], [0, 1]]"),
        "8:8",
        &["support.feet", "a list of 2", "a list of 3"],
    );
    refused_text(
        &with("[[-1, -1], [0, 1], [1]]"),
        "8:27",
        &["support.feet[3]", "a list of 1", "a list of 2"],
    );
    refused_text(
        &with("[[-1, -1], [0, 1], [1, inf]]"),
        "8:31",
        &["support.feet[3][2]", "inf", "finite"],
    );
}

#[test]
fn feet_together_with_a_tripod_are_refused() {
    let feet = "feet = [[-1, -1], [1, -1], [0, 1]]\n";
    refused(
        "tripod_radius = 0.02 ",
        &format!("{feet}tripod_radius = 0.02 "),
        "11:17",
        &["support.feet", "support.tripod_radius", "Remove one"],
    );
    let text = replaced(
        LEAST,
        "tripod_radius = 0.02\n",
        &format!("{feet}tripod_angle = 1\n"),
    );
    refused_text(
        &text,
        "9:16",
        &["support.feet", "support.tripod_angle", "Remove one"],
    );
}

#[test]
fn part_of_no_kind_or_of_two_is_refused() {
    refused(
        "{ disc = { radius = 0.005 } }",
        "{}",
        "15:3",
        &["pusher.shape[1]", "0 of", "polygon", "disc", "ellipse"],
    );
    refused(
        "{ radius = 0.005 } }",
        "{ radius = 0.005 }, polygon = [] }",
        "15:3",
        &["pusher.shape[1]", "2 of", "exactly one"],
    );
}

#[test]
fn shape_that_is_none_is_refused_at_its_part() {
    refused(
        "radius = 0.004",
        "radius = 0",
        "16:23",
        &["pusher.shape[2].disc.radius is 0 m", "positive"],
    );
    refused(
        "[0.03, 0.02], c",
        "[0.03, 0], c",
        "27:44",
        &["fixel[1].shape[1].ellipse.semi_axes[2] is 0 m", "positive"],
    );
    let clockwise = "{ polygon = [[0, 0], [0, 1], [1, 0]] }";
    refused(
        "{ disc = { radius = 0.004, centre = [0.01, 0] } }",
        clockwise,
        "16:3",
        &["pusher.shape[2]", "clockwise"],
    );
    refused_text(
        &replaced(LEAST, "[ { disc = { radius = 0.03 } } ]", "[]"),
        "5:9",
        &["object.shape"],
    );
    refused_text(
        &replaced(
            LEAST,
            "{ disc = { radius = 0.03 } }",
            "{ polygon = [[0, 0], [1, 0]] }",
        ),
        "5:11",
        &["object.shape[1]"],
    );
}
