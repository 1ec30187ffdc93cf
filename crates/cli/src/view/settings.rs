//! Sliders of the page and what they set: [`Settings`].

use std::collections::BTreeMap;

use anyhow::Result;
use serde::Serialize;
use stickslip::{Occlusion, RunOptions, TactileUse};
use stickslip_fit::Parameter;
use stickslip_formats::{Experiment, SceneEdit, read_scene};

use super::opened::Opened;
use crate::failure::hinted;
use crate::origin::quoted;

/// Particles by which the slider goes.
const PARTICLES: f64 = 50.0;

/// Steps of the sliders of the occlusion in a second.
const PER_SECOND: f64 = 10.0;

/// A slider as `crates/report/page/view.js` reads it; from 0 to 1 by 1 it is a switch.
#[derive(Debug, Serialize)]
pub struct Slider {
    /// Keys of the scene with a dot between them, or a name of its own.
    key: String,
    label: String,
    value: f64,
    range: [f64; 2],
    /// Absent where it moves by no steps.
    step: Option<f64>,
    unit: &'static str,
}

impl Slider {
    fn new(
        key: impl Into<String>,
        label: impl Into<String>,
        value: f64,
        (range, step, unit): ([f64; 2], Option<f64>, &'static str),
    ) -> Self {
        let (key, label) = (key.into(), label.into());
        Self {
            key,
            label,
            value,
            range,
            step,
            unit,
        }
    }
}

/// All sliders of a log.
pub struct Settings<'a> {
    opened: &'a Opened,
    /// The sliders, in their order on the page.
    pub sliders: Vec<Slider>,
    /// Keys and values of scene values that were changed.
    scene: Vec<([String; 2], f64)>,
}

impl<'a> Settings<'a> {
    /// Those of a log before any change: its scene, and the occlusion that its facts know.
    pub fn new(opened: &'a Opened) -> Self {
        let Experiment {
            setup, log, facts, ..
        } = &opened.experiment;
        let frictions = [
            (Parameter::MuS, "friction with the table (mu_s)"),
            (Parameter::MuP, "friction with the pusher (mu_p)"),
            (Parameter::MuF, "friction with the fixels (mu_f)"),
            (Parameter::TripodRadius, "radius of feet (d_tri)"),
        ];
        let counts = |parameter| match parameter {
            Parameter::MuF => !setup.scene.fixels.is_empty(),
            Parameter::TripodRadius => setup.has_tripod(),
            _ => true,
        };
        let frictions = frictions.into_iter().filter(|(own, _)| counts(*own));
        let frictions = frictions.filter_map(|(parameter, label)| {
            let value = parameter.prior(setup).value(0.0);
            let (most, unit) = match parameter.unit() {
                // feet stand under the object
                "m" => (setup.scene.object.shape.bounding_radius(), " m"),
                _ => (1.0, ""),
            };
            let key = parameter.scene_keys()?[0].join(".");
            let range = [most / 100.0, most.max(2.0 * value)];
            Some(Slider::new(key, label, value, (range, None, unit)))
        });

        let particles = RunOptions::default().particles as f64;
        let numbers = ([PARTICLES, 10.0 * particles], Some(PARTICLES), "");
        let ends = opened.times.first().zip(opened.times.last());
        let (first, last) = ends.map_or((0.0, 0.0), |(first, last)| (*first, *last));
        // the last row is before the end
        let ends = [first, last].map(|time| (PER_SECOND * time).floor());
        let ends = [ends[0] / PER_SECOND, (ends[1] + 1.0) / PER_SECOND];
        let off = facts.occlude_from.and_then(|row| opened.times.get(row));
        let off = off.copied().unwrap_or(ends[1]);
        let times = (ends, Some(1.0 / PER_SECOND), " s");
        let mut sliders: Vec<Slider> = frictions.collect();
        sliders.extend([
            Slider::new("particles", "particles", particles, numbers),
            Slider::new("off_from", "camera off from", off, times),
            Slider::new("off_to", "camera on again at", ends[1], times),
        ]);
        if !log.tactile.is_empty() {
            let switch = ([0.0, 1.0], Some(1.0), "");
            sliders.push(Slider::new("touch", "touch sensors", 1.0, switch));
        }
        Self {
            opened,
            sliders,
            scene: Vec::new(),
        }
    }

    /// Those of a log after the page's changes.
    pub fn changed(opened: &'a Opened, changed: &BTreeMap<String, f64>) -> Result<Self> {
        let mut settings = Self::new(opened);
        for (key, value) in changed {
            let mut sliders = settings.sliders.iter_mut();
            let Some(slider) = sliders.find(|slider| slider.key == *key) else {
                return Err(hinted(
                    format!("`{key}`: there is no such slider"),
                    "load the page again",
                ));
            };
            let [low, high] = slider.range;
            if !(low..=high).contains(value) {
                let rule = format!("choose from {low} to {high}");
                return Err(hinted(format!("`{key}` cannot be {value}"), rule));
            }
            slider.value = *value;
            if let Some((table, key)) = key.split_once('.') {
                let way = [table, key].map(str::to_owned);
                settings.scene.push((way, *value));
            }
        }
        Ok(settings)
    }

    /// Value of a slider; 1 where it is absent.
    fn value(&self, key: &str) -> f64 {
        let slider = self.sliders.iter().find(|slider| slider.key == key);
        slider.map_or(1.0, |slider| slider.value)
    }

    /// Refuses a camera that is on again before it is off.
    pub fn check_order(&self) -> Result<()> {
        let [off, on] = ["off_from", "off_to"].map(|key| self.value(key));
        if on < off {
            let found = format!("the camera is off from {off} s, and on again before, at {on} s");
            let rule =
                "move `camera on again at` behind `camera off from`; equal times: no occlusion";
            return Err(hinted(found, rule));
        }
        Ok(())
    }

    /// Options of a run.
    pub fn options(&self) -> RunOptions {
        let value = |key: &str| self.value(key);
        let times = &self.opened.times;
        let row = |key: &str| times.partition_point(|row| *row < value(key));
        let [from, to] = [row("off_from"), row("off_to")];
        let rows = Occlusion::Rows {
            from,
            to: Some(to).filter(|to| *to < times.len()),
        };
        RunOptions {
            particles: value("particles") as usize,
            tactile: if value("touch") > 0.5 {
                TactileUse::Used
            } else {
                TactileUse::Ignored
            },
            occlusion: if from < to { rows } else { Occlusion::None },
            ..RunOptions::default()
        }
    }

    /// The scene's file with the changes.
    pub fn scene_text(&self) -> Result<String> {
        let mut edit = SceneEdit::new(&self.opened.scene, &self.opened.given[1])?;
        for ([table, key], value) in &self.scene {
            edit.comment(&format!("{table}.{key} = {value}: set in `stickslip view`"));
            edit.set(&[table, key], *value);
        }
        Ok(edit.text())
    }

    /// The experiment with the changed scene.
    pub fn experiment(&self) -> Result<Experiment> {
        Ok(Experiment {
            setup: read_scene(&self.scene_text()?, &self.opened.given[1])?,
            ..self.opened.experiment.clone()
        })
    }

    /// Scene values that were changed, and the command that runs the same.
    pub fn words(&self) -> String {
        let options = self.options();
        let [log, scene] = &self.opened.given;
        let values = self
            .scene
            .iter()
            .map(|([table, key], value)| format!("{table}.{key} = {value}"));
        let values: Vec<String> = values.collect();
        let (what, scene) = match values.is_empty() {
            true => ("the scene as it is. In".to_owned(), scene.as_str()),
            false => (
                format!("{}. Save the scene, then in", values.join(", ")),
                "scene.toml",
            ),
        };
        let hidden = match options.occlusion {
            Occlusion::Rows { from, to: Some(to) } => format!(" --occlude {from}:{to}"),
            Occlusion::Rows { from, to: None } => format!(" --occlude {from}"),
            _ => String::new(),
        };
        let touch = if options.tactile == TactileUse::Ignored {
            " --no-tactile"
        } else {
            ""
        };
        format!(
            "{what} a terminal: stickslip filter {} --scene {} --particles {}{hidden}{touch}",
            quoted(log),
            quoted(scene),
            options.particles
        )
    }
}
