//! `scene.toml`: every key arrives where it belongs.

use std::f64::consts::FRAC_PI_2;

use crate::scene_text::{FULL, LEAST, read, refused, refused_text, replaced};
use stickslip::{Camera, FilterSettings, Limits, Tactile};
use stickslip_dynamics::{Feet, Friction, Part, Pose, Shape, SpeedProfile, Start};

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
fn scene_above_1_mb_is_refused_and_at_1_mb_read() {
    let text = |bytes: usize| format!("{LEAST}#{}", "x".repeat(bytes - LEAST.len() - 1));
    assert_eq!(read(&text(1_000_000)).scene.gravity, 9.81);
    let words = ["the file has 1000001 bytes", "at most 1 MB"];
    refused_text(&text(1_000_001), "1:1", &words);
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
    same_shape(&scene.pusher.fingers[0], discs);
    same_shape(
        &scene.fixels[0].shape,
        vec![Part::ellipse([0.03, 0.02], [0.0, 0.01], 0.125)],
    );
    same_shape(
        &scene.fixels[1].shape,
        vec![Part::ellipse([0.03, 0.02], [0.0, 0.0], 0.0)],
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
        other_fingers: Vec::new(),
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
        &["`start.duration`", "missing", "the duration"],
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
    let guide = include_str!("../../../../docs/guide/formats.md");
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
fn limits_that_are_not_told_leave_room_about_the_nominal_values() {
    // a plate of 300 mm: its feet stand far beyond the 40 mm of small objects
    let wide = replaced(LEAST, "tripod_radius = 0.02", "tripod_radius = 0.1");
    let limits = read(&wide).filter.limits;
    let default = FilterSettings::default().limits;
    assert!((limits.d_tri.max - 0.16).abs() < 1e-12 && limits.d_tri.min == default.d_tri.min);
    assert_eq!(
        (limits.mu_s, limits.mu_p, limits.mu_f),
        (default.mu_s, default.mu_p, default.mu_f)
    );
    // configured limits are kept
    let told = read(&format!("{wide}\n[filter]\nd_tri = [0.05, 0.12]\n"));
    assert_eq!(
        told.filter.limits.d_tri,
        Limits {
            min: 0.05,
            max: 0.12
        }
    );
}

#[test]
fn least_scene_takes_the_defaults_of_the_contract() {
    let setup = read(LEAST);
    assert_eq!(setup.scene.feet, Feet::Tripod { angle: FRAC_PI_2 });
    assert!(setup.scene.fixels.is_empty() && setup.camera.is_none());
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
fn stall_force_is_the_file_s_or_twenty_times_what_slides_the_object() {
    let read = |line: &str| {
        let setup = read(&replaced(LEAST, "[fixels]\n", &format!("{line}[fixels]\n")));
        (setup.scene.pusher.stall_force, setup.stall_force_assumed)
    };
    assert_eq!(read("stall_force = 36\n"), (Some(36.0), false));
    assert_eq!(read("stall_force = inf\n"), (None, false));
    let (force, assumed) = read("");
    let weight = 1.0 * 9.81;
    assert!(assumed && force.is_some_and(|force| (force - 20.0 * 0.3 * weight).abs() < 1e-12));
}

#[test]
fn stall_force_must_be_given_where_nothing_resists() {
    let smooth = LEAST.replacen("friction = 0.3", "friction = 0", 1);
    let missing = ["`pusher.stall_force` is missing", "yields in N"];
    refused_text(&smooth, "9:1", &missing);
    let given = replaced(&smooth, "[fixels]\n", "stall_force = 2\n[fixels]\n");
    assert_eq!(read(&given).scene.pusher.stall_force, Some(2.0));
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
fn who_tells_a_rig_worse_than_most_means_it_on_all_rigs() {
    let well_measured = |lines: &str| {
        let text = format!("{LEAST}\n[uncertainty]\n{lines}\n");
        read(&text).uncertainty.well_measured
    };
    assert_eq!(well_measured("fixel_position = 1e-3"), 1.0);
    for as_most in ["", "fixel_position = 1e-4", "pusher_offset = 1e-3"] {
        assert_eq!(well_measured(as_most), 0.1, "{as_most}");
    }
    assert_eq!(
        well_measured("fixel_position = 1e-3\nwell_measured = 0.5"),
        0.5
    );
}

#[test]
fn key_of_an_earlier_version_is_refused_with_its_replacement() {
    let text = format!("{LEAST}\n[uncertainty]\ncreep = 0.1\n");
    let place = format!("{}:1", text.lines().count());
    let words = "`uncertainty.creep` is no longer a key: contacts follow Coulomb's law";
    refused_text(&text, &place, &[words]);
}

#[test]
fn feet_are_unknown_as_far_as_no_scene_tells_them() {
    let feet = "feet = [[-0.03, -0.04], [0.03, -0.04], [0.0, 0.02]]";
    let turned = "tripod_radius = 0.02\ntripod_angle = 0.5";
    let unknown = |support: &str, lines: &str| {
        let text = replaced(LEAST, "tripod_radius = 0.02", support);
        let found = read(&format!("{text}\n[uncertainty]\n{lines}\n")).uncertainty;
        [found.centre_of_friction, found.tripod_angle]
    };
    let any_angle = std::f64::consts::FRAC_PI_3;
    let told = "centre_of_friction = 0.1\ntripod_angle = 0.2";
    assert_eq!(unknown("tripod_radius = 0.02", ""), [0.15, any_angle]);
    assert_eq!(unknown(turned, ""), [0.15, 0.0]);
    assert_eq!(unknown(feet, ""), [0.0, 0.0]);
    for support in ["tripod_radius = 0.02", turned, feet] {
        assert_eq!(unknown(support, told), [0.1, 0.2], "{support}");
    }
}
