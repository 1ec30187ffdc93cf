//! `cargo bench -p stickslip-bench --bench variants`: the timing scene with other objects, a bar as
//! its pusher, and up to 50 fixels.
//!
//! The concave object is that of `slide-ell-disc-110`, where the recorded experiments are at hand
//! (`STICKSLIP_DATA`).

use std::error::Error;
use std::f64::consts::TAU;
use std::fs::read_to_string;

use stickslip_bench::{
    FRAMES, MOVING, PHASES, Results, TimedScene, pushed_object, time_scenes, timing_input,
    timing_scene,
};
use stickslip_dynamics::{Dynamics, Fixel, Part, Pose, Scene, Shape, ShapeError};
use stickslip_formats::read_scene;
use stickslip_testkit::data_root;

/// Rounds that are counted.
const ROUNDS: usize = 5;

/// Distance of the far fixels from the origin (m).
const FAR: f64 = 0.5;

fn main() -> Result<(), Box<dyn Error>> {
    let base = timing_scene()?;
    let mut scenes = vec![("square".to_owned(), base.clone())];
    for corners in [8, 64] {
        scenes.push((
            format!("{corners}-gon"),
            with_object(&base, regular(corners, 0.025)?),
        ));
    }
    scenes.push(("ellipse".to_owned(), with_object(&base, ellipse()?)));
    if let Some(concave) = concave()? {
        scenes.push(("concave".to_owned(), with_object(&base, concave)));
    }
    scenes.push((
        "bar pusher".to_owned(),
        pushed_object(base.object.shape.clone(), bar()?, base.fixels.clone()),
    ));
    for fixels in [10, 50] {
        scenes.push((
            format!("{fixels} fixels; 3 near"),
            with_far_fixels(&base, fixels),
        ));
    }
    write(scenes)
}

fn write(scenes: Vec<(String, Scene)>) -> Result<(), Box<dyn Error>> {
    let timed = |(name, scene)| TimedScene {
        name: format!("variants / {name}"),
        dynamics: Dynamics::new(scene),
        inputs: (0..FRAMES).map(timing_input).collect(),
    };
    let scenes: Vec<TimedScene> = scenes.into_iter().map(timed).collect();
    let timings = time_scenes(&scenes, ROUNDS);
    let [(pushed, pushed_frames), ..] = PHASES;
    let mut results = Results::open()?;
    for (scene, timing) in scenes.iter().zip(&timings) {
        timing.write("moving", MOVING, &mut results)?;
        timing.write(pushed, pushed_frames.clone(), &mut results)?;
        let ratio = timing.over(MOVING).nanoseconds / timings[0].over(MOVING).nanoseconds;
        results.write(
            &format!("{} / moving / of the square with 3 fixels", scene.name),
            ratio,
            "1",
        )?;
    }
    Ok(())
}

fn with_object(base: &Scene, shape: Shape) -> Scene {
    pushed_object(shape, base.pusher.fingers[0].clone(), base.fixels.clone())
}

/// The regular polygon whose first corner is at `radius` (m) in direction +x.
fn regular(corners: u32, radius: f64) -> Result<Shape, ShapeError> {
    let corner = |k: u32| libm::sincos(TAU * f64::from(k) / f64::from(corners));
    let vertices = (0..corners)
        .map(corner)
        .map(|(sin, cos)| [radius * cos, radius * sin])
        .collect();
    Shape::new(vec![Part::Polygon { vertices }])
}

fn ellipse() -> Result<Shape, ShapeError> {
    Shape::new(vec![Part::ellipse([0.025, 0.018], [0.0; 2], 0.0)])
}

/// A bar whose face is where the disc's foremost point is.
fn bar() -> Result<Shape, ShapeError> {
    let [x, y] = [0.005, 0.015];
    Shape::new(vec![Part::Polygon {
        vertices: vec![[-x, -y], [x, -y], [x, y], [-x, y]],
    }])
}

fn concave() -> Result<Option<Shape>, Box<dyn Error>> {
    let Some(root) = data_root() else {
        return Ok(None);
    };
    let name = "mujoco/slide-ell-disc-110/scene.toml";
    Ok(Some(
        read_scene(&read_to_string(root.join(name))?, name)?
            .scene
            .object
            .shape,
    ))
}

/// The scene with `count` fixels; the added ones are out of reach.
fn with_far_fixels(base: &Scene, count: usize) -> Scene {
    let mut scene = base.clone();
    for k in scene.fixels.len()..count {
        let (sin, cos) = libm::sincos(TAU * k as f64 / count as f64);
        scene.fixels.push(Fixel {
            pose: Pose::new(FAR * cos, FAR * sin, 0.0),
            shape: base.fixels[0].shape.clone(),
        });
    }
    scene
}
