//! `scene.toml`: numbers and shapes that cannot be are refused at their place in their words.

use stickslip_formats::read_scene;

use crate::scene_text::{FULL, LEAST, read, refused, refused_text, replaced};

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
}

#[test]
fn stall_forces_that_are_none_are_refused() {
    for value in ["0", "-5", "-inf", "nan"] {
        refused(
            "stall_force = 20",
            &format!("stall_force = {value}"),
            "19:15",
            &[
                &format!("pusher.stall_force is {value} N"),
                "positive, or inf",
                "at which the drive yields in N",
            ],
        );
    }
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

#[test]
fn numbers_that_cannot_be_on_a_table_top_are_refused() {
    for (from, to, words) in [
        ("mass = 0.50", "mass = 1e30", "at most 1e6 kg"),
        ("mass = 0.50", "mass = 5e-324", "at least 1e-6 kg"),
        ("inertia = 2.1e-4", "inertia = 1e308", "at most 1e9 kg m^2"),
        (
            "inertia = 2.1e-4",
            "inertia = 1e-30",
            "at least 1e-12 kg m^2",
        ),
        ("gravity = 9.81", "gravity = 1e300", "at most 1e5 m/s^2"),
        (
            "\nposition_std = 3.0e-4",
            "\nposition_std = 1.7e308",
            "at most 1e6 m",
        ),
        ("latency = 0.125", "latency = 1e300", "at most 1e4 s"),
        ("stall_force = 20", "stall_force = 1e300", "at most 1e9 N"),
    ] {
        let message = read_scene(&replaced(FULL, from, to), "scene.toml")
            .expect_err("must be refused")
            .to_string();
        assert!(
            message.contains(words) && message.contains("as on any table top"),
            "{message}"
        );
    }
    let ellipse = LEAST.replace(
        "disc = { radius = 0.03 }",
        "ellipse = { semi_axes = [1e-300, 0.03] }",
    );
    refused_text(
        &ellipse,
        "5:38",
        &["semi_axes[1] is 1e-300 m", "at least 1e-9 m"],
    );
}

#[test]
fn outlines_that_are_too_fine_are_refused() {
    let vertex = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / 3001.0;
        format!(
            "[{:.9}, {:.9}]",
            0.03 * libm::cos(angle),
            0.03 * libm::sin(angle)
        )
    };
    let vertices: Vec<String> = (0..3001).map(vertex).collect();
    let polygon = format!("polygon = [{}]", vertices.join(", "));
    let text = replaced(LEAST, "disc = { radius = 0.03 }", &polygon);
    refused_text(
        &text,
        "5:23",
        &["has 3001 vertices; at most 3000 are read. Simplify the outline"],
    );
    let discs = vec!["{ disc = { radius = 0.03 } }"; 201].join(", ");
    let text = replaced(LEAST, "{ disc = { radius = 0.03 } }", &discs);
    refused_text(&text, "5:9", &["object.shape has 201 parts; at most 200"]);
}
