//! Known friction is found again, from simulated pushes.

use std::sync::OnceLock;

use crate::common;
use crate::common::{pushes, rig_tripod_radius};
use stickslip_dynamics::Friction;
use stickslip_evaluation::Physics;
use stickslip_fit::{
    CrossValidation, Fit, FitOptions, FittedParameter, HeldOut, Parameter, Push, cross_validate,
    fit, predict,
};

const TRUTH: Friction = Friction {
    mu_s: 0.3,
    mu_p: 0.45,
    mu_f: 0.25,
    d_tri: 0.033,
};

fn options(names: &[&str]) -> FitOptions {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    FitOptions {
        parameters: Parameter::parse_list(&names).unwrap(),
        seed: 0,
    }
}

/// Distance of a fitted value from the truth, in its standard deviations.
fn deviation(fit: &Fit, name: &str, truth: f64) -> f64 {
    let fitted = fit.parameters.iter().find(|p| p.name() == name).unwrap();
    (fitted.value - truth) / fitted.std
}

#[test]
fn friction_of_the_model_is_found_within_its_spread() {
    let pushes = pushes(TRUTH, Physics::Model, 4, 1);
    let fit = fit(&pushes, &options(&["mu_p", "tripod_radius"]), &|_, _| ()).unwrap();
    for (name, truth) in [("mu_p", TRUTH.mu_p), ("tripod_radius", TRUTH.d_tri)] {
        assert!(deviation(&fit, name, truth).abs() < 3.0, "{name} {fit:?}");
    }
    let close = |p: &FittedParameter| p.determined && p.std < 0.05 * p.value;
    assert!(fit.parameters.iter().all(close), "{fit:?}");
    assert!(
        fit.sampling.settled && fit.sampling.unsolved == 0,
        "{:?}",
        fit.sampling
    );
}

/// The rig rests on many points and has uneven friction: no tripod is all of it.
#[test]
fn friction_of_another_physics_is_found_nearly() {
    let pushes = pushes(TRUTH, Physics::Testbed, 4, 3);
    let fit = fit(&pushes, &options(&["mu_p", "support"]), &|_, _| ()).unwrap();
    for (name, truth) in [
        ("mu_p", TRUTH.mu_p),
        ("tripod_radius", rig_tripod_radius(TRUTH, 3)),
    ] {
        let fitted = fit.parameters.iter().find(|p| p.name() == name).unwrap();
        println!("{name} {} +- {}, truly {truth}", fitted.value, fitted.std);
        assert!(
            (fitted.value / truth - 1.0).abs() < 0.15,
            "{name} {truth} {fit:?}"
        );
        // one rig in ten is outside, and one in two hundred beyond twice the half-width
        let half_width = libm::log(fitted.interval_90[1] / fitted.value);
        assert!(
            libm::log(truth / fitted.value).abs() < 2.0 * half_width,
            "{name} {truth} {fitted:?}"
        );
    }
}

/// A stiff pusher moves the object at its own speed whatever the table's friction, and no push
/// comes near a fixel.
#[test]
fn what_pushes_do_not_show_keeps_its_prior() {
    let pushes = pushes(TRUTH, Physics::Model, 2, 20);
    let fit = fit(&pushes, &options(&["mu_f", "mu_p", "mu_s"]), &|_, _| ()).unwrap();
    let [mu_s, mu_p, mu_f] = &fit.parameters[..] else {
        panic!("three parameters");
    };
    assert!(
        mu_p.determined && !mu_s.determined && !mu_f.determined,
        "{fit:?}"
    );
    for (fitted, nominal) in [(mu_s, 0.3), (mu_f, 0.25)] {
        let off = libm::log(fitted.value / nominal).abs();
        assert!(off < 0.2 && fitted.std_ratio > 0.8, "{fitted:?}");
    }
}

/// Four pushes, the fit to them, and how two halves of them predict each other.
fn halves() -> (Vec<Push>, FitOptions, CrossValidation) {
    static VALIDATION: OnceLock<CrossValidation> = OnceLock::new();
    let pushes = pushes(TRUTH, Physics::Model, 4, 40);
    let options = options(&["mu_p", "tripod_radius"]);
    let validation =
        VALIDATION.get_or_init(|| cross_validate(&pushes, 2, &options, &|_, _| ()).unwrap());
    let validation = validation.clone();
    (pushes, options, validation)
}

#[test]
fn held_out_pushes_are_predicted_better() {
    let (_, _, validation) = halves();
    for [unfitted, fitted] in [validation.median_final_mm, validation.median_wmse_mm] {
        assert!(fitted < 0.6 * unfitted, "{validation:?}");
    }
    assert_eq!(validation.pushes.len(), 4);

    // the gain is the mean of the pushes' own, and it pays
    let sum = |of: fn(&HeldOut) -> [f64; 2]| -> f64 {
        let each = validation.pushes.iter().map(of);
        each.map(|[unfitted, fitted]| unfitted - fitted).sum()
    };
    let gain = (sum(|push| push.final_mm) + sum(|push| push.wmse_mm)) / 4.0;
    assert!((validation.gain_mm[0] - gain).abs() < 1e-12 && validation.pays);
}

/// The fit of two pushes as one fold, and as a fit that predicts the other two.
#[test]
fn other_pushes_are_predicted_as_a_fold_is() {
    let (pushes, options, folds) = halves();
    let (train, test): (Vec<_>, Vec<_>) = pushes
        .iter()
        .cloned()
        .enumerate()
        .partition(|(k, _)| k % 2 == 1);
    let of = |part: Vec<(usize, _)>| part.into_iter().map(|(_, push)| push).collect::<Vec<_>>();
    let (train, test) = (of(train), of(test));
    let taught = fit(&train, &options, &|_, _| ()).unwrap();
    let predicted = predict(&test, &taught, None, &options).unwrap();
    let first_fold = folds.pushes.iter().filter(|push| push.fold == 0);
    for (push, of_fold) in predicted.pushes.iter().zip(first_fold) {
        assert_eq!(push.push, of_fold.push);
        assert_eq!(push.final_mm, of_fold.final_mm);
        assert_eq!(push.wmse_mm, of_fold.wmse_mm);
    }

    // a log whose first rows have no object pose is predicted from the first one that has
    let mut late = test[0].clone();
    late.log.object[..2].fill(None);
    let late = predict(&[late], &taught, None, &options).unwrap();
    let ([nominal, fitted], [_, of_late]) = (predicted.pushes[0].final_mm, late.pushes[0].final_mm);
    assert!(
        (of_late - fitted).abs() < 0.3 * (nominal - fitted),
        "{of_late} {fitted} {nominal}"
    );

    // where fitting does not pay, all stays as it was
    let refused = CrossValidation {
        pays: false,
        ..folds
    };
    let kept = predict(&test, &taught, Some(&refused), &options).unwrap();
    assert_eq!(kept.median_final_mm[0], kept.median_final_mm[1]);
    assert_eq!(kept.median_final_mm[0], predicted.median_final_mm[0]);
    let text = taught
        .scene_text(common::SCENE, "scene.toml", Some(&refused))
        .unwrap();
    let (said, scene): (Vec<&str>, Vec<&str>) =
        text.lines().partition(|line| line.starts_with('#'));
    assert_eq!(scene.join("\n").trim(), common::SCENE.trim());
    assert!(said.concat().contains("nominal values"), "{text}");
}

#[test]
fn same_seed_same_bits_on_any_number_of_threads() {
    let pushes = pushes(TRUTH, Physics::Model, 2, 60);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let fit = pool
            .build()
            .unwrap()
            .install(|| fit(&pushes, &options(&["mu_p"]), &|_, _| ()));
        format!("{:?}", fit.unwrap())
    };
    assert_eq!(on(1), on(3));
}
