//! Offsets, latency and the centre of friction are found again.

use crate::common;
use crate::common::{pushes_in, setup};
use stickslip::Setup;
use stickslip_dynamics::{Feet, Part, Shape};
use stickslip_evaluation::Physics;
use stickslip_fit::{Fit, FitOptions, Parameter, Push, fit};

/// Learns `names` from pushes in `truth`, given the scene of the tests.
fn learnt(truth: &Setup, names: &[&str], change: impl Fn(&mut Push)) -> (Vec<Push>, Fit) {
    let mut pushes = pushes_in(truth, Physics::Model, 3, 5);
    for push in &mut pushes {
        push.setup = setup();
        change(push);
    }
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let options = FitOptions {
        parameters: Parameter::parse_list(&names).unwrap(),
        seed: 1,
    };
    let fit = fit(&pushes, &options, &|_, _| ()).unwrap();
    (pushes, fit)
}

#[track_caller]
fn assert_found(fit: &Fit, truths: &[f64]) {
    for (fitted, truth) in fit.parameters.iter().zip(truths) {
        println!(
            "{} {} +- {}, truly {truth}",
            fitted.name(),
            fitted.value,
            fitted.std
        );
        let off = (fitted.value - truth).abs() / fitted.std;
        assert!(fitted.determined && off < 3.5, "{fitted:?}, truly {truth}");
    }
}

/// Feet of equal friction, a third of the weight each, about another point than the origin.
#[test]
fn centre_of_friction_is_found_and_written() {
    let mut truth = setup();
    let [x, y] = [0.004, -0.003];
    let half = 0.025 * 3.0_f64.sqrt() / 2.0;
    truth.scene.feet = Feet::Known {
        positions: [
            [x, y + 0.025],
            [x - half, y - 0.0125],
            [x + half, y - 0.0125],
        ],
        loads: [1.0 / 3.0; 3],
    };
    let (_, fit) = learnt(&truth, &["centre_of_friction"], |_| ());
    assert_found(&fit, &[x, y]);

    // the scene that is written has these feet
    let text = fit.scene_text(common::SCENE, "scene.toml", None).unwrap();
    let written = stickslip_formats::read_scene(&text, "scene.toml").unwrap();
    let (
        Feet::Known { positions, .. },
        Feet::Known {
            positions: truly, ..
        },
    ) = (written.scene.feet, truth.scene.feet)
    else {
        panic!("known feet in {text}");
    };
    for (foot, truly) in positions.as_flattened().iter().zip(truly.as_flattened()) {
        assert!((foot - truly).abs() < 1e-3, "{positions:?}");
    }

    // as uncertain as the fit found it, at an angle that is no better known than before
    let std = written.uncertainty.centre_of_friction * written.scene.object.gyration_radius();
    let [least, most] =
        [f64::min, f64::max].map(|of| of(fit.parameters[0].std, fit.parameters[1].std));
    assert!((0.999 * least..1.001 * most).contains(&std), "{std}");
    let before = truth.uncertainty.tripod_angle;
    assert!((written.uncertainty.tripod_angle / before - 1.0).abs() < 1e-5);
}

/// Feet at the corners of a flat triangle, that the scene takes for a circle's: the image that the
/// fit writes has their centre and second moments.
#[test]
fn any_triangle_of_feet_is_found() {
    let mut truth = setup();
    let positions = [[0.030, 0.012], [-0.036, 0.006], [0.004, -0.014]];
    truth.scene.feet = Feet::Known {
        positions,
        loads: [1.0 / 3.0; 3],
    };
    let (pushes, fit) = learnt(&truth, &["mu_p", "support"], |_| ());
    let text = fit.scene_text(common::SCENE, "scene.toml", None).unwrap();
    let written = stickslip_formats::read_scene(&text, "scene.toml").unwrap();
    let Feet::Known {
        positions: found, ..
    } = written.scene.feet
    else {
        panic!("known feet in {text}");
    };
    let corners = [0.0, 1.0, -1.0].map(|k: f64| {
        let (sin, cos) = libm::sincos(1.571 + 2.0944 * k);
        let d_tri = pushes[0].setup.scene.nominal.d_tri;
        [d_tri * cos, d_tri * sin]
    });
    let off = |feet: [[f64; 2]; 3]| {
        let [found, truly] = [feet, positions].map(moments);
        let squares = found.iter().zip(truly).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    };
    assert!(off(found) < 0.4 * off(corners), "{found:?}");
    assert!(fit.sampling.settled, "{:?}", fit.sampling);

    // feet that are written as known are as uncertain as the fit left them
    let unsure = written.uncertainty;
    let spreads = [
        unsure.friction.d_tri,
        unsure.centre_of_friction,
        unsure.foot_stretch,
    ];
    assert!(
        spreads.iter().all(|std| (0.005..0.3).contains(std)),
        "{unsure:?}"
    );
}

/// Centre (m), and roots of the second moments about it (m), of equal feet.
fn moments(feet: [[f64; 2]; 3]) -> [f64; 5] {
    let mean = |of: &dyn Fn([f64; 2]) -> f64| feet.into_iter().map(of).sum::<f64>() / 3.0;
    let [x, y] = [0, 1].map(|k| mean(&|foot| foot[k]));
    let second = |a: usize, b: usize| {
        let moment = mean(&|foot| (foot[a] - [x, y][a]) * (foot[b] - [x, y][b]));
        moment.abs().sqrt().copysign(moment)
    };
    [x, y, second(0, 0), second(0, 1), second(1, 1)]
}

/// As far as its noisy track allows, see below.
#[test]
fn offset_of_the_pusher_is_found() {
    let mut truth = setup();
    let centre = [0.001, -0.0006];
    truth.scene.pusher.fingers[0] = Shape::new(vec![Part::Disc {
        radius: 0.005,
        centre,
    }])
    .unwrap();
    let (_, fit) = learnt(&truth, &["pusher_offset"], |_| ());
    for (fitted, truth) in fit.parameters.iter().zip(centre) {
        let off = (fitted.value - truth).abs();
        assert!(fitted.determined && off < 4e-4, "{fitted:?}, truly {truth}");
    }
}

/// The log's object poses come 0.08 s late, and the scene does not say so. A noisy pusher track
/// carries the object ahead by up to 0.3 mm, since contact only pushes: at 15 mm/s that appears as
/// 0.02 s.
#[test]
fn latency_is_found_as_far_as_the_pusher_is_known() {
    let mut truth = setup();
    if let Some(camera) = &mut truth.camera {
        camera.latency = 0.08;
    }
    let (_, fit) = learnt(&truth, &["latency"], |_| ());
    let latency = &fit.parameters[0];
    assert!(
        latency.determined && (latency.value - 0.08).abs() < 0.03,
        "{latency:?}"
    );
}

#[test]
fn what_a_scene_lacks_is_refused() {
    let pushes = pushes_in(&setup(), Physics::Model, 2, 5);
    let refused = |names: &[&str], change: fn(&mut Setup)| {
        let mut pushes = pushes.clone();
        pushes.iter_mut().for_each(|push| change(&mut push.setup));
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let parameters = Parameter::parse_list(&names).unwrap();
        let options = FitOptions {
            parameters,
            seed: 0,
        };
        fit(&pushes, &options, &|_, _| ()).unwrap_err().to_string()
    };
    let feet = |setup: &mut Setup| {
        setup.scene.feet = Feet::Known {
            positions: [[0.02, 0.0], [-0.01, 0.02], [-0.01, -0.02]],
            loads: [1.0 / 3.0; 3],
        };
    };
    assert!(refused(&["centre_of_friction"], feet).contains("gives the feet"));
    assert!(refused(&["latency"], |setup| setup.camera = None).contains("no [camera]"));
    let sure = |setup: &mut Setup| setup.uncertainty.friction.mu_p = 0.0;
    assert!(refused(&["mu_p"], sure).contains("leaves nothing to be learnt"));
}
