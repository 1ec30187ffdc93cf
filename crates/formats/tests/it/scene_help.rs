//! Help for writing `scene.toml`: the schema, the scene to begin with, values that may be left out.

use crate::scene_schema::{mismatch, schema};
use crate::scene_text::lines::{FEET, TRIPOD, all_keys};
use crate::scene_text::{FULL, replaced};
use stickslip_dynamics::{Dynamics, Pose, RolloutStart, Twist};
use stickslip_formats::{NEW_SCENE, SceneProblem, read_scene, scene_assumptions};

fn by_schema(text: &str) -> Option<String> {
    let document: toml::Table = toml::from_str(text).unwrap();
    let document = serde_json::to_value(document).unwrap();
    mismatch(&schema(), &document, "scene")
}

#[test]
fn schema_takes_what_the_reader_takes() {
    let rigid = replaced(FULL, "stall_force = 20", "stall_force = inf");
    let with_tripod = all_keys(NEW_SCENE, FEET);
    let with_feet = all_keys(NEW_SCENE, TRIPOD);
    for text in [FULL, &rigid, NEW_SCENE, &with_tripod, &with_feet] {
        read_scene(text, "scene.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(by_schema(text), None);
    }
    assert!(with_tripod.contains("\ninertia") && with_tripod.contains("\n[[fixel]]"));
}

#[test]
fn schema_and_reader_refuse_the_same() {
    let broken = [
        ("mass = 0.50", "mass = \"0.5 kg\""),
        ("mass = 0.50", "mass = -0.5"),
        ("mass = 0.50", "mas = 0.50"),
        ("mass = 0.50", ""),
        ("friction = 0.25", ""),
        ("false_negative = 0.06", "false_negative = 1"),
        ("position = [0.10, 0.018]", "position = [0.10, 0.018, 0.0]"),
        (
            "{ disc = { radius = 0.005 } }",
            "{ disc = { radios = 0.005 } }",
        ),
        ("mu_s = [0.06, 0.9]", "mu_s = 0.9"),
        ("object = [0.01, -0.02, 0.5]", "object = [0.01, -0.02]"),
        (
            "speed = [[0, 0], [0.5, 0.02], [8, 0.02], [8, 0]]",
            "speed = [[0, 0, 0]]",
        ),
    ];
    for (from, to) in broken {
        let text = replaced(FULL, from, to);
        assert!(
            read_scene(&text, "scene.toml").is_err() && by_schema(&text).is_some(),
            "{to}"
        );
    }
}

/// Every value of the full scene and of the new one, replaced by one of a wrong kind: a key of the
/// schema whose kind is not the reader's would show.
#[test]
fn kinds_of_the_schema_are_the_readers() {
    let mut tried = 0;
    for text in [
        FULL.to_owned(),
        all_keys(NEW_SCENE, FEET),
        all_keys(NEW_SCENE, TRIPOD),
    ] {
        for (number, line) in text.lines().enumerate() {
            let Some((key, value)) = line
                .split_once(" = ")
                .filter(|_| !line.starts_with(['#', ' ', '[']))
            else {
                continue;
            };
            if value.trim_end().ends_with('[') {
                continue;
            }
            for wrong in ["true", "{ x = 1 }", "[[[1]]]"] {
                let line = format!("{key} = {wrong}");
                let lines = text
                    .lines()
                    .enumerate()
                    .map(|(index, old)| if index == number { &line } else { old });
                let broken = lines.collect::<Vec<_>>().join("\n");
                assert!(read_scene(&broken, "scene.toml").is_err(), "{line}");
                assert!(by_schema(&broken).is_some(), "{line}");
                tried += 1;
            }
        }
    }
    assert!(tried > 350, "{tried}");
}

#[test]
fn inertia_and_tripod_follow_from_the_outline_and_it_is_said() {
    let scene = read_scene(NEW_SCENE, "scene.toml").unwrap().scene;
    // a square of edge a: a² / 6, and a (sqrt 2 + asinh 1) / 6
    assert!((scene.object.inertia - 0.5 * 0.05 * 0.05 / 6.0).abs() < 1e-9);
    assert!((scene.nominal.d_tri - 0.05 * 0.382_597_86).abs() < 1e-7);
    let told = scene_assumptions(NEW_SCENE, "scene.toml").unwrap();
    assert_eq!(told.len(), 2);
    assert!(
        told[0].contains("2.083e-4 kg m^2") && told[1].contains("0.0191 m"),
        "{told:?}"
    );
    assert!(scene_assumptions(FULL, "scene.toml").unwrap().is_empty());
}

#[test]
fn ellipse_has_its_inertia_and_is_pushed() {
    let text = NEW_SCENE.replace(
        "polygon = [[-0.025, -0.025], [0.025, -0.025], [0.025, 0.025], [-0.025, 0.025]]",
        "ellipse = { semi_axes = [0.03, 0.02], angle = 0.5 }",
    );
    let scene = read_scene(&text, "scene.toml").unwrap().scene;
    let exact = 0.5 * (0.03 * 0.03 + 0.02 * 0.02) / 4.0;
    assert!((scene.object.inertia / exact - 1.0).abs() < 1e-5);

    let start = RolloutStart {
        pose: Pose::default(),
        twist: Twist::default(),
        friction: scene.nominal,
    };
    let pushers: Vec<Pose> = (0..=30)
        .map(|k| Pose::new(-0.04 + 1e-3 * f64::from(k), 0.0, 0.0))
        .collect();
    let rollout = Dynamics::new(scene)
        .rollout(1.0 / 30.0, &[start], &pushers)
        .unwrap();
    assert!(rollout.poses.last().unwrap().x > 0.01, "{rollout:?}");
}

#[test]
fn outline_off_the_centre_of_mass_needs_its_inertia() {
    let text = NEW_SCENE.replace(
        "[[-0.025, -0.025], [0.025, -0.025], [0.025, 0.025], [-0.025, 0.025]]",
        "[[0, 0], [0.05, 0], [0.05, 0.05], [0, 0.05]]",
    );
    let error = read_scene(&text, "scene.toml").unwrap_err();
    assert!(matches!(*error.problem, SceneProblem::OffCentre { .. }));
    let told = error.to_string();
    assert!(
        told.contains("`object.inertia` is missing") && told.contains("(0.0250, 0.0250) m"),
        "{told}"
    );
}
