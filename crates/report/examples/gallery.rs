//! Writes one figure of every kind into a folder: `cargo run -p stickslip-report --features
//! png --example gallery -- FOLDER`.

use std::f64::consts::TAU;
use std::path::Path;

use stickslip_dynamics::{Feet, Fixel, Friction, Object, Part, Pose, Pusher, Scene, Shape};
use stickslip_report::{
    Body, Colour, Curve, Level, Line, Mark, Overlay, Panel, Scale, TimeFigure, png_of,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "gallery".to_owned());
    std::fs::create_dir_all(&folder)?;
    let figures = [
        ("errors", errors().drawing().to_svg()),
        ("parameters", parameters().drawing().to_svg()),
        ("poses", poses()?.drawing().to_svg()),
    ];
    for (name, svg) in figures {
        std::fs::write(
            Path::new(&folder).join(name).with_extension("png"),
            png_of(&svg)?,
        )?;
        std::fs::write(Path::new(&folder).join(name).with_extension("svg"), svg)?;
    }
    Ok(())
}

fn curve(name: &str, colour: Colour, of: impl Fn(f64) -> f64, spread: f64) -> Curve {
    let times: Vec<f64> = (0..=300).map(|k| f64::from(k) / 30.0).collect();
    let points: Vec<[f64; 2]> = times.iter().map(|t| [*t, of(*t)]).collect();
    let band = points
        .iter()
        .filter(|_| spread > 0.0)
        .map(|[t, v]| [*t, v / (1.0 + spread), v * (1.0 + spread)])
        .collect();
    Curve {
        name: name.to_owned(),
        colour,
        line: Line::Solid,
        points,
        band,
    }
}

fn marks() -> Vec<Mark> {
    [
        (4.3, "pusher"),
        (8.6, "fixel 1"),
        (9.0, "fixel 3"),
        (9.9, "fixel 2"),
    ]
    .map(|(time, name)| Mark {
        time,
        name: name.to_owned(),
    })
    .to_vec()
}

fn errors() -> TimeFigure {
    let panel = |label: &str, scale: f64| Panel {
        label: label.to_owned(),
        scale: Scale::Log { floor: 0.01 },
        curves: vec![
            curve("nominal", Colour::GREY, |t| scale * (0.5 + 0.4 * t), 0.0),
            curve(
                "kalman",
                Colour::ORANGE,
                |t| scale * (0.3 + libm::exp(t - 6.0)),
                0.0,
            ),
            curve(
                "particle, no tactile",
                Colour::SKY,
                |t| scale * (0.4 + 0.1 * t * libm::sin(TAU * t).abs()),
                0.6,
            ),
            curve(
                "particle",
                Colour::VERMILLION,
                |t| scale * (0.2 + 0.05 * libm::sin(3.0 * t)),
                0.4,
            ),
            curve(
                "particle, camera on",
                Colour::GREEN,
                |t| scale * (0.1 + 0.05 * libm::cos(5.0 * t)),
                0.0,
            ),
        ],
        ..Panel::default()
    };
    TimeFigure {
        title: "A pusher pushes a square until it jams".to_owned(),
        span: [3.0, 10.0],
        dark: vec![[8.0, 10.0]],
        marks: marks(),
        panels: vec![
            panel("position error (mm)", 1.0),
            panel("angle error (°)", 0.3),
        ],
        band_name: "10–90 % of 20 seeds".to_owned(),
        ..TimeFigure::default()
    }
}

fn parameters() -> TimeFigure {
    let panel = |label: &str, nominal: f64| Panel {
        label: label.to_owned(),
        curves: vec![curve(
            "particle filter",
            Colour::VERMILLION,
            |t| nominal * (1.0 + 0.2 * libm::tanh(t - 4.0)),
            0.1,
        )],
        levels: vec![
            Level {
                name: "truth".to_owned(),
                value: 1.3 * nominal,
                colour: Colour::INK,
                line: Line::Solid,
            },
            Level {
                name: "nominal".to_owned(),
                value: nominal,
                colour: Colour::INK,
                line: Line::Dashed,
            },
        ],
        ..Panel::default()
    };
    TimeFigure {
        title: "Estimated friction".to_owned(),
        span: [0.0, 10.0],
        dark: vec![[8.0, 10.0]],
        marks: marks(),
        columns: 2,
        panel_size: [430.0, 240.0],
        panels: vec![
            panel("μ_s", 0.3),
            panel("μ_p", 0.25),
            panel("μ_f", 0.2),
            panel("d_tri (mm)", 20.0),
        ],
        band_name: "± 2 standard deviations".to_owned(),
        ..TimeFigure::default()
    }
}

fn poses() -> Result<Overlay, Box<dyn std::error::Error>> {
    let scene = scene()?;
    let body = |name: &str, pose: Pose, colour| Body::new(name, &scene.object.shape, &pose, colour);
    let mut bodies = Body::surroundings(&scene, &[Some(Pose::new(-0.04, 0.0, 0.0))]);
    bodies.extend([
        body("truth", Pose::new(0.0, 0.0, 0.1), Colour::INK).filled(0.12),
        body("nominal", Pose::new(0.004, 0.003, 0.4), Colour::GREY),
        body("kalman", Pose::new(0.02, 0.01, 0.2), Colour::ORANGE),
        body("particle", Pose::new(0.0002, 0.0, 0.11), Colour::VERMILLION).line(Line::Dashed),
    ]);
    Ok(Overlay {
        title: "Final poses".to_owned(),
        bodies,
        ..Overlay::default()
    })
}

fn scene() -> Result<Scene, Box<dyn std::error::Error>> {
    let polygon = |vertices: &[[f64; 2]]| Part::Polygon {
        vertices: vertices.to_vec(),
    };
    let finger = Shape::new(vec![Part::Disc {
        radius: 0.005,
        centre: [0.0, 0.0],
    }])?;
    let shape = Shape::new(vec![
        polygon(&[[-0.03, -0.02], [0.0, -0.02], [0.0, 0.02], [-0.03, 0.02]]),
        polygon(&[[0.0, -0.02], [0.03, -0.02], [0.03, 0.0], [0.0, 0.0]]),
    ])?;
    Ok(Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2e-4,
            shape,
        },
        feet: Feet::Tripod { angle: 0.0 },
        pusher: Pusher {
            fingers: vec![finger.clone()],
            stall_force: None,
        },
        fixels: [[0.05, 0.02], [0.05, -0.03]]
            .map(|[x, y]| Fixel {
                pose: Pose::new(x, y, 0.0),
                shape: finger.clone(),
            })
            .to_vec(),
        nominal: Friction {
            mu_s: 0.3,
            mu_p: 0.3,
            mu_f: 0.3,
            d_tri: 0.02,
        },
    })
}
