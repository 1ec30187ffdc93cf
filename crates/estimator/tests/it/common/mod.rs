//! Scenes of discs that the tests of this crate share.
use stickslip::dynamics::{Feet, Fixel, Friction, Object, Part, Pose, Pusher, Scene, Shape};
use stickslip::{
    Camera, FilterSettings, Log, Method, Observer, RunOptions, Setup, Tactile, Uncertainty, run,
    run_observed,
};

/// Frames per second (Hz).
pub const RATE: f64 = 30.0;

/// A disc about the origin; `radius` in m.
pub fn disc(radius: f64) -> Shape {
    Shape::new(vec![Part::Disc {
        radius,
        centre: [0.0, 0.0],
    }])
    .expect("a disc")
}

/// A disc of 30 mm at the origin, a pusher of 5 mm, and fixels of 5 mm at these places (m).
pub fn setup(fixels: &[[f64; 2]]) -> Setup {
    let fixel = |[x, y]: &[f64; 2]| Fixel {
        pose: Pose::new(*x, *y, 0.0),
        shape: disc(0.005),
    };
    Setup {
        scene: Scene {
            gravity: 9.81,
            object: Object {
                mass: 0.5,
                inertia: 2e-4,
                shape: disc(0.03),
            },
            feet: Feet::Tripod { angle: 0.0 },
            pusher: Pusher {
                fingers: vec![disc(0.005)],
                stall_force: Some(20.0),
            },
            fixels: fixels.iter().map(fixel).collect(),
            nominal: Friction {
                mu_s: 0.31,
                mu_p: 0.32,
                mu_f: 0.33,
                d_tri: 0.02,
            },
        },
        stall_force_assumed: false,
        camera: Some(Camera {
            position_std: 3e-4,
            orientation_std: 5e-3,
            latency: 0.0,
            pusher_position_std: 1e-4,
            pusher_orientation_std: 2e-3,
        }),
        tactile: Tactile::default(),
        filter: FilterSettings::default(),
        wrench: None,
        uncertainty: Uncertainty::default(),
        start: None,
    }
}

/// Makes the feet stand as in the scene: no particle has its own.
pub fn know_feet(setup: &mut Setup) {
    setup.uncertainty = setup.uncertainty.with_known_feet();
}

/// A log whose camera sees the object at `object(time)`, and the pusher at `pusher(time)`.
pub fn log(
    rows: usize,
    object: impl Fn(f64) -> Option<Pose>,
    pusher: impl Fn(f64) -> Option<Pose>,
) -> Log {
    let time: Vec<f64> = (0..rows).map(|row| row as f64 / RATE).collect();
    Log {
        object: time.iter().map(|t| object(*t)).collect(),
        pusher: time.iter().map(|t| pusher(*t)).collect(),
        time,
        ..Log::default()
    }
}

/// Particles of [`run_into_the_dark`]: not more than a block, so that they are shown in one piece.
pub const PARTICLES: usize = 64;

/// Runs some particles whose object at the origin a pusher moves after the camera turned off.
/// Camera poses would reveal what they do not know.
pub fn run_into_the_dark(setup: &Setup, seed: u64, observer: &impl Observer) {
    run_from_rest(setup, seed, false, observer);
}

/// Runs these particles with the camera `seeing` the object to the end, at rest, or not.
pub fn run_from_rest(setup: &Setup, seed: u64, seeing: bool, observer: &impl Observer) {
    // no frame equals the one before
    let object = |time| Pose::new(1e-9 * time, 0.0, 0.0);
    let pusher = |time: f64| Some(Pose::new(-0.05 + 0.02 * time, 0.0, 0.0));
    let log = log(
        60,
        |time| (seeing || time < 0.5).then(|| object(time)),
        pusher,
    );
    assert_eq!(log.time[1], 1.0 / RATE, "one draw of the force a row");
    let options = RunOptions {
        particles: PARTICLES,
        seed,
        ..RunOptions::default()
    };
    run_observed(setup, &log, &options, observer, &mut |_| ()).expect("a run");
}

/// A disc that is pushed off its middle against a fixel jams if both frictions are above 0.29.
/// Otherwise it slides round the fixel, if its feet stand about its middle. Here it slides.
pub fn slippery() -> (Setup, Log) {
    let mut slippery = setup(&[[0.032, -0.022]]);
    know_feet(&mut slippery);
    let nominal = &mut slippery.scene.nominal;
    (nominal.mu_p, nominal.mu_f) = (0.15, 0.15);
    let beside = |time: f64| Some(Pose::new(-0.0348 + 0.02 * time, 0.004, 0.0));
    let mut log = log(110, |_| Some(Pose::default()), beside);
    let options = RunOptions {
        method: Method::Nominal,
        ..RunOptions::default()
    };
    let truth = run(&slippery, &log, &options, &mut |_| ()).expect("a simulation");
    log.object = truth.estimate.rows.iter().map(|row| row.pose).collect();
    assert!(log.object[109].expect("a pose").y > 0.01);
    (slippery, log)
}

/// The slippery experiment with another nominal friction of pusher and fixel: most particles expect
/// that it jams.
pub fn sticky(slippery: &Setup, friction: f64) -> Setup {
    let mut sticky = slippery.clone();
    let nominal = &mut sticky.scene.nominal;
    (nominal.mu_p, nominal.mu_f) = (friction, friction);
    sticky
}
