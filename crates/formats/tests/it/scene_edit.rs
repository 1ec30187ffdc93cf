//! Numbers of scene files replaced.

use stickslip_dynamics::{Feet, Part, Shape};
use stickslip_formats::{SceneEdit, read_scene};

const SCENE: &str = "# ours
gravity = 9.81 # Berlin
[object]
mass = 0.5
inertia = 2.1e-4
shape = [ { disc = { radius = 0.03 } } ]
[support]
friction = 0.28   # a guess
tripod_radius = 0.02
[pusher]
shape = [ { disc = { radius = 0.005 } } ]
friction = 0.3
[fixels]
friction = 0.25
";

#[test]
fn set_changes_a_number_and_nothing_else() {
    let mut edit = SceneEdit::new(SCENE, "scene.toml").unwrap();
    assert_eq!(edit.text(), SCENE);
    edit.set(&["support", "friction"], 0.123_456_789);
    let expected = SCENE.replace("0.28   # a guess", "0.123457   # a guess");
    assert_eq!(edit.text(), expected);
}

#[test]
fn new_refuses_what_is_no_scene() {
    let error = SceneEdit::new("gravity = 0\n", "scene.toml").unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("scene.toml:1:11: gravity is 0"),
        "{error}"
    );
}

#[test]
fn set_shape_and_feet_are_read_back() {
    let parts = vec![
        Part::Polygon {
            vertices: vec![[-0.01, -0.01], [0.01, -0.01], [0.01, 0.01], [-0.01, 0.01]],
        },
        Part::Disc {
            radius: 0.012,
            centre: [0.001, 0.002],
        },
    ];
    let mut edit = SceneEdit::new(SCENE, "scene.toml").unwrap();
    edit.set_shape("object", &Shape::new(parts.clone()).unwrap());
    let (positions, loads) = (
        [[0.02, 0.001], [-0.01, 0.02], [-0.01, -0.02]],
        [0.25, 0.5, 0.25],
    );
    edit.set_feet(positions, loads);
    let text = edit.text();
    let scene = read_scene(&text, "scene.toml").unwrap().scene;
    assert_eq!(scene.object.shape.parts(), parts);
    assert_eq!(scene.feet, Feet::Known { positions, loads });
    for kept in ["# ours", "# Berlin", "# a guess"] {
        assert!(text.contains(kept), "{text}");
    }
}

#[test]
fn foot_loads_that_are_no_shares_are_refused() {
    let feet = "feet = [[0.02, 0], [-0.01, 0.02], [-0.01, -0.02]]\n";
    let with = |loads: &str| {
        let text = SCENE.replace(
            "tripod_radius = 0.02\n",
            &format!("{feet}foot_loads = {loads}\n"),
        );
        read_scene(&text, "scene.toml").map(|setup| setup.scene.feet)
    };
    assert!(with("[0.5, 0.25, 0.25]").is_ok());
    for bad in ["[0.5, 0.5, 0.25]", "[1.5, -0.25, -0.25]", "[0.5, 0.5]"] {
        let error = with(bad).unwrap_err().to_string();
        assert!(error.contains("foot_loads"), "{error}");
    }
}

#[test]
fn put_makes_tables_replaces_values_and_removes_them() {
    let mut edit = SceneEdit::new(SCENE, "scene.toml").unwrap();
    edit.put("support.friction", Some(0.123_456_789.into()))
        .unwrap();
    edit.put("camera.latency", Some(0.02.into())).unwrap();
    edit.put("support.tripod_radius", None).unwrap();
    edit.put("start.speed", None).unwrap();
    let expected = SCENE
        .replace("0.28   # a guess", "0.123456789   # a guess")
        .replace("tripod_radius = 0.02\n", "");
    assert_eq!(edit.text(), expected + "\n[camera]\nlatency = 0.02\n");

    let mut edit = SceneEdit::new(SCENE, "scene.toml").unwrap();
    let fixel = "{ position = [0.1, 0.0], shape = [ { disc = { radius = 0.01 } } ] }";
    let fixels = format!("[{fixel}, {fixel}]").parse().unwrap();
    edit.put("fixel", Some(fixels)).unwrap();
    assert_eq!(edit.text().matches("[[fixel]]").count(), 2);
    let setup = read_scene(&edit.text(), "scene.toml").unwrap();
    assert_eq!(setup.scene.fixels.len(), 2);
}

#[test]
fn put_refuses_ways_to_no_value() {
    let mut edit = SceneEdit::new(SCENE, "scene.toml").unwrap();
    for way in ["", "pusher.", ".friction", "gravity.x", "object.tags.tag_7"] {
        let error = edit.put(way, Some(1.0.into())).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("`{way}` names no value")),
            "{error}"
        );
    }
    assert_eq!(edit.text(), SCENE);
}
