//! An experiment made of formulas: a disc moves a square along x until it stands still, with the
//! camera off from row 60 % on.
use stickslip::dynamics::{Feet, Fixel, Friction, Object, Part, Pose, Pusher, Scene, Shape};
use stickslip::{Estimate, EstimateRow, FilterSettings, Log, Setup, Spread, Tactile, Uncertainty};
use stickslip_evaluation::{Reference, ScoredRun, Scores, Variant};
use stickslip_report::{Mark, ReportedExperiment, ReportedRun};

/// Half the side of the object (m).
pub const HALF: f64 = 0.025;

pub fn square(half: f64) -> Shape {
    Shape::new(vec![Part::Polygon {
        vertices: vec![[-half, -half], [half, -half], [half, half], [-half, half]],
    }])
    .unwrap()
}

pub fn disc(radius: f64) -> Shape {
    Shape::new(vec![Part::Disc {
        radius,
        centre: [0.0, 0.0],
    }])
    .unwrap()
}

pub fn setup() -> Setup {
    let nominal = Friction {
        mu_s: 0.3,
        mu_p: 0.25,
        mu_f: 0.2,
        d_tri: 0.02,
    };
    let fixel = |x: f64, y: f64| Fixel {
        pose: Pose::new(x, y, 0.0),
        shape: disc(0.005),
    };
    let scene = Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2e-4,
            shape: square(HALF),
        },
        feet: Feet::Tripod { angle: 0.0 },
        pusher: Pusher {
            fingers: vec![disc(0.005)],
            stall_force: None,
        },
        fixels: vec![fixel(0.09, 0.01), fixel(0.09, -0.02)],
        nominal,
    };
    Setup {
        scene,
        stall_force_assumed: false,
        camera: None,
        tactile: Tactile::default(),
        filter: FilterSettings::default(),
        wrench: None,
        uncertainty: Uncertainty::default(),
        start: None,
    }
}

/// Pose of the object at a row, of so many.
pub fn truth(row: usize, rows: usize) -> Pose {
    let way = (row as f64 / (0.7 * rows as f64)).min(1.0);
    Pose::new(0.06 * way, 0.002 * way, 0.3 * way)
}

pub fn log(rows: usize) -> Log {
    let pusher = |row: usize| {
        (row % 17 != 3).then(|| Pose::new(truth(row, rows).x - HALF - 0.005, 0.0, 0.0))
    };
    Log {
        time: (0..rows).map(|row| row as f64 / 30.0).collect(),
        object: (0..rows).map(|row| Some(truth(row, rows))).collect(),
        object_covariance: Vec::new(),
        pusher: (0..rows).map(pusher).collect(),
        other_fingers: Vec::new(),
        tactile: vec![(0..rows).map(|row| Some(row * 10 >= 7 * rows)).collect()],
        force: Vec::new(),
    }
}

fn estimate(rows: usize, off: f64, learns: bool) -> Estimate {
    let row = |row: usize| {
        let pose = truth(row, rows);
        let pose = Pose::new(
            pose.x + off * libm::sin(row as f64),
            pose.y + off,
            pose.theta - 10.0 * off,
        );
        let friction = Friction {
            mu_s: 0.3 + off,
            mu_p: 0.25,
            mu_f: 0.2,
            d_tri: 0.02,
        };
        let spread = Spread {
            pose: Pose::new(off, off, off),
            cross: None,
            friction: Some(Friction {
                mu_s: 0.01,
                mu_p: 0.02,
                mu_f: 0.0,
                d_tri: 0.001,
            }),
        };
        EstimateRow {
            pose: Some(pose),
            friction: learns.then_some(friction),
            spread: learns.then_some(spread),
            contact_pusher: learns.then_some(0.5),
            contact_others: learns.then(|| vec![0.25, 1.0]),
            ..EstimateRow::default()
        }
    };
    Estimate {
        time: log(rows).time,
        rows: (0..rows).map(row).collect(),
        others: 2,
        has_tripod: true,
    }
}

/// A run whose error is `off` metres, twice that while the camera is off.
fn scored(variant: Variant, estimate: Estimate, off: f64) -> ScoredRun {
    ScoredRun {
        variant,
        estimate,
        scores: Scores {
            wmse_mm: Some(1e3 * off),
            wmse_occluded_mm: Some(2e3 * off),
            ..Scores::default()
        },
        camera_wmse_mm: None,
        unsolved: 0,
        failed: 0,
        collapses: 0,
        log_evidence: None,
    }
}

/// Five variants on `rows` rows, two with `particles` particles each.
pub fn experiment<'a>(
    name: &str,
    setup: &'a Setup,
    log: &'a Log,
    particles: usize,
) -> ReportedExperiment<'a> {
    let rows = log.len();
    let dark = rows * 6 / 10;
    let run = |variant: Variant, off: f64, particles: usize| {
        let cloud = |row: usize| -> Vec<Pose> {
            let pose = truth(row, rows);
            (0..particles)
                .map(|k| {
                    Pose::new(
                        pose.x + 1e-3 * libm::sin(k as f64),
                        pose.y + 1e-3 * libm::cos((k + row) as f64),
                        pose.theta,
                    )
                })
                .collect()
        };
        ReportedRun {
            scored: scored(variant, estimate(rows, off, particles > 0), off),
            cloud: if particles > 0 {
                (0..rows).map(cloud).collect()
            } else {
                Vec::new()
            },
        }
    };
    ReportedExperiment {
        name: name.to_owned(),
        what: format!("a disc pushes a square ({name})"),
        setup,
        log,
        reference: Reference {
            time: log.time.clone(),
            pose: log.object.clone(),
            ..Reference::default()
        },
        reference_name: "truth".to_owned(),
        hidden: (0..rows).map(|row| row >= dark).collect(),
        touches: vec![
            Some(vec![true; rows]),
            None,
            Some((0..rows).map(|row| row >= dark).collect()),
        ],
        contacts: [(0, format!("pusher {name}")), (dark, "fixel 2".to_owned())]
            .into_iter()
            .filter_map(|(row, name)| {
                Some(Mark {
                    time: *log.time.get(row)?,
                    name,
                })
            })
            .collect(),
        first_fixel: log.time.get(dark).copied(),
        friction: [Some(0.35), Some(0.2), None, Some(0.021)],
        runs: vec![
            run(Variant::Nominal, 4e-3, 0),
            run(Variant::Kalman, 4e-2, 0),
            run(Variant::ParticleNoTouch, 1e-3, particles),
            run(Variant::Particle, 2e-4, particles),
            run(Variant::ParticleCameraOn, 5e-5, 0),
        ],
    }
}
