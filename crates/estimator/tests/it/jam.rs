//! A pusher that drives a disc head-on against a fixel, and goes on for 2 mm by its log.

use crate::common::log;
use stickslip::dynamics::Pose;
use stickslip::{FilterModel, Method, RunOptions, run};

const SCENE: &str = "gravity = 9.81
object = { mass = 0.5, inertia = 2e-4, shape = [{ disc = { radius = 0.03 } }] }
support = { friction = 0.28, tripod_radius = 0.02 }
fixels = { friction = 0.25 }
fixel = [{ position = [0.045, 0], shape = [{ disc = { radius = 0.005 } }] }]
camera = { position_std = 3e-4, orientation_std = 5e-3 }
";

/// Particle steps without a certified solution over 60 rows; the first 20 lead to the fixel. `keys`
/// are the rest of the pusher's.
fn unsolved(keys: &str, method: Method) -> u64 {
    let pusher =
        format!("pusher = {{ friction = 0.3, shape = [{{ disc = {{ radius = 0.005 }} }}]{keys} }}");
    let setup = stickslip_formats::read_scene(&format!("{SCENE}{pusher}\n"), "scene.toml")
        .expect("a scene");
    let object = |t: f64| Some(Pose::new((0.015 * t).min(0.01), 0.0, 0.0));
    let pusher = |t: f64| Some(Pose::new(-0.035 + 0.015 * t.min(0.8), 0.0, 0.0));
    let options = RunOptions {
        model: FilterModel::Paper,
        method,
        particles: 16,
        ..RunOptions::default()
    };
    run(&setup, &log(60, object, pusher), &options, &mut |_| ())
        .expect("a run")
        .unsolved
}

#[test]
fn jam_without_a_stall_force_is_solved() {
    for method in [Method::Nominal, Method::Particle] {
        assert_eq!(unsolved("", method), 0, "{method:?}");
    }
}

#[test]
fn jam_under_a_rigid_pusher_has_no_solution() {
    assert!(unsolved(", stall_force = inf", Method::Nominal) > 0);
}
