//! Sliders of the page and what they set: [`Settings`].

use std::collections::BTreeMap;

use anyhow::Result;
use serde::{Deserialize, Serialize};
use stickslip::{Occlusion, RunOptions, TactileUse};
use stickslip_fit::Parameter;
use stickslip_formats::{Experiment, SceneEdit, read_scene};

use super::opened::Opened;
use crate::failure::hinted;
use crate::origin::quoted;

/// Particles by which the slider goes.
const PARTICLES: f64 = 50.0;

/// Time by which the sliders of the blackout go (s).
const INSTANT: f64 = 0.1;

/// Position of a slider or a switch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Of a switch.
    On(bool),
    /// Of a slider.
    Number(f64),
}

/// A slider or a switch as `crates/report/page/view.js` reads it.
#[derive(Debug, Serialize)]
pub struct Slider {
    key: String,
    label: String,
    value: Value,
    low: f64,
    high: f64,
    /// Absent where it moves by no steps.
    step: Option<f64>,
    unit: &'static str,
    /// Keys of the scene that it sets, and whether it was moved.
    #[serde(skip)]
    way: Option<[&'static str; 2]>,
    #[serde(skip)]
    moved: bool,
}

/// All sliders of a log.
pub struct Settings(Vec<Slider>);

impl Settings {
    /// Those of a log before any change: its scene, and the blackout that its facts know.
    pub fn new(opened: &Opened) -> Self {
        let Experiment {
            setup, log, facts, ..
        } = &opened.experiment;
        let defaults = RunOptions::default();
        let friction = |(parameter, label): (Parameter, &str)| {
            let [way, _] = parameter.scene_keys()?;
            let value = parameter.prior(setup).value(0.0);
            let (high, unit) = match parameter.unit() {
                // feet stand under the object
                "m" => (setup.scene.object.shape.bounding_radius(), " m"),
                _ => (1.0, ""),
            };
            Some(Slider {
                key: way.join("."),
                label: format!("{label} ({})", parameter.name()),
                value: Value::Number(value),
                low: high / 100.0,
                high: high.max(2.0 * value),
                step: None,
                unit,
                way: Some(way),
                moved: false,
            })
        };
        let frictions = [
            (true, (Parameter::MuS, "friction with the table")),
            (true, (Parameter::MuP, "friction with the pusher")),
            (
                !setup.scene.fixels.is_empty(),
                (Parameter::MuF, "friction with the fixels"),
            ),
            (
                setup.has_tripod(),
                (
                    Parameter::TripodRadius,
                    "distance of the feet from the middle",
                ),
            ),
        ];
        let mut sliders: Vec<Slider> = frictions
            .into_iter()
            .filter_map(|(is_there, slider)| is_there.then(|| friction(slider)).flatten())
            .collect();
        let mut other = |key: &str, label: &str, value, [low, high, step]: [f64; 3], unit| {
            sliders.push(Slider {
                key: key.to_owned(),
                label: label.to_owned(),
                value,
                low,
                high,
                step: Some(step),
                unit,
                way: None,
                moved: false,
            });
        };
        let particles = Value::Number(defaults.particles as f64);
        let range = [PARTICLES, 10.0 * defaults.particles as f64, PARTICLES];
        other("particles", "particles", particles, range, "");
        let ends = opened.times.first().zip(opened.times.last());
        let (first, last) = ends.map_or((0.0, 0.0), |(first, last)| (*first, *last));
        // the last row is before the end
        let [low, high] = [(first / INSTANT).floor(), (last / INSTANT).floor() + 1.0];
        let [low, high] = [low, high].map(|steps| steps * INSTANT);
        let off = match facts.occlusion() {
            Occlusion::Rows { from, .. } => opened.times.get(from).copied(),
            _ => None,
        };
        let off = Value::Number(off.unwrap_or(high));
        let range = [low, high, INSTANT];
        other("off_from", "camera off from", off, range, " s");
        other(
            "off_to",
            "camera on again at",
            Value::Number(high),
            range,
            " s",
        );
        if !log.tactile.is_empty() {
            other(
                "touch",
                "use the touch sensors",
                Value::On(true),
                [0.0; 3],
                "",
            );
        }
        Self(sliders)
    }

    /// Those of a log after the page's changes.
    pub fn changed(opened: &Opened, changed: &BTreeMap<String, Value>) -> Result<Self> {
        let mut settings = Self::new(opened);
        for (key, value) in changed {
            let slider = settings.0.iter_mut().find(|slider| slider.key == *key);
            let Some(slider) = slider else {
                return Err(hinted(
                    format!("`{key}`: there is no such slider"),
                    "load the page again",
                ));
            };
            let fits = match (slider.value, *value) {
                (Value::Number(_), Value::Number(now)) => (slider.low..=slider.high).contains(&now),
                (Value::On(_), Value::On(_)) => true,
                _ => false,
            };
            if !fits {
                let rule = format!("choose from {} to {}", slider.low, slider.high);
                return Err(hinted(format!("`{key}` cannot be {value:?}"), rule));
            }
            (slider.value, slider.moved) = (*value, true);
        }
        Ok(settings)
    }

    /// The sliders, in their order on the page.
    pub fn sliders(&self) -> &[Slider] {
        &self.0
    }

    fn number(&self, key: &str) -> f64 {
        let slider = self.0.iter().find(|slider| slider.key == key);
        match slider.map(|slider| slider.value) {
            Some(Value::Number(number)) => number,
            _ => 0.0,
        }
    }

    /// Options of a run.
    pub fn options(&self, opened: &Opened) -> RunOptions {
        let row = |key: &str| {
            let time = self.number(key);
            opened.times.partition_point(|row| *row < time)
        };
        let [from, to] = [row("off_from"), row("off_to")];
        let blind = self.0.iter().any(|slider| slider.value == Value::On(false));
        RunOptions {
            particles: self.number("particles") as usize,
            tactile: if blind {
                TactileUse::Ignored
            } else {
                TactileUse::Used
            },
            occlusion: match from < to {
                true => Occlusion::Rows {
                    from,
                    to: Some(to).filter(|to| *to < opened.times.len()),
                },
                false => Occlusion::None,
            },
            ..RunOptions::default()
        }
    }

    /// Sliders that were moved and set a scene's value: the way of its keys and the value.
    fn of_scene(&self) -> impl Iterator<Item = ([&'static str; 2], f64)> {
        let moved = self.0.iter().filter(|slider| slider.moved);
        moved.filter_map(|slider| Some((slider.way?, self.number(&slider.key))))
    }

    /// The scene's file with the changes.
    pub fn scene_text(&self, opened: &Opened) -> Result<String> {
        let mut edit = SceneEdit::new(&opened.scene, &opened.given[1])?;
        for (way, value) in self.of_scene() {
            edit.comment(&format!(
                "{} = {value}: set in `stickslip view`",
                way.join(".")
            ));
            edit.set(&way, value);
        }
        Ok(edit.text())
    }

    /// The experiment with the changed scene.
    pub fn experiment(&self, opened: &Opened) -> Result<Experiment> {
        Ok(Experiment {
            setup: read_scene(&self.scene_text(opened)?, &opened.given[1])?,
            ..opened.experiment.clone()
        })
    }

    /// Scene values that were changed, and the command that runs the same.
    pub fn words(&self, opened: &Opened) -> String {
        let options = self.options(opened);
        let values = self
            .of_scene()
            .map(|(way, value)| format!("{} = {value}", way.join(".")));
        let values: Vec<String> = values.collect();
        let scene = match values.is_empty() {
            true => opened.given[1].clone(),
            false => "scene.toml".to_owned(),
        };
        let mut command = format!(
            "stickslip filter {} --scene {}",
            quoted(&opened.given[0]),
            quoted(&scene)
        );
        if let Occlusion::Rows { from, to } = options.occlusion {
            let to = to.map_or(String::new(), |to| format!(":{to}"));
            command += &format!(" --occlude {from}{to}");
        }
        if options.particles != RunOptions::default().particles {
            command += &format!(" --particles {}", options.particles);
        }
        if options.tactile == TactileUse::Ignored {
            command += " --no-tactile";
        }
        match values.is_empty() {
            true => format!("the scene as it is. In a terminal: {command}"),
            false => format!(
                "{}. Save the scene, then in a terminal: {command}",
                values.join(", ")
            ),
        }
    }
}
