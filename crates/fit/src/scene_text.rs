//! A scene file with the learnt values: [`Fit::scene_text`].

use stickslip::{Setup, counted};
use stickslip_dynamics::Feet;
use stickslip_formats::{SceneEdit, read_scene};

use crate::error::FitError;
use crate::fitted::{Fit, FittedParameter};
use crate::parameter::Parameter;
use crate::validation::CrossValidation;

impl Fit {
    /// A scene file with the fitted values and their spreads in place. Where the chains have not
    /// converged, the spreads stay as they are. A parameter that was not
    /// learnt stays as it is. So do all if `validation` says that fitting does not pay. Values
    /// without a key of their own (an offset, a scale) are worked into the outlines and feet, and
    /// said in comments on top. `name` is shown in errors.
    ///
    /// # Errors
    /// The text is no scene, or its outline is none once it is changed.
    pub fn scene_text(
        &self,
        text: &str,
        name: &str,
        validation: Option<&CrossValidation>,
    ) -> Result<String, FitError> {
        let mut edit = SceneEdit::new(text, name)?;
        if let Some(validation) = validation.filter(|validation| !validation.pays) {
            edit.comment(&refusal(validation));
            return Ok(edit.text());
        }
        let learnt: Vec<&FittedParameter> = self
            .parameters
            .iter()
            .filter(|fitted| fitted.learnt)
            .collect();
        for line in self.comments() {
            edit.comment(&line);
        }
        for fitted in &learnt {
            if let Some([value, spread]) = fitted.parameter.scene_keys() {
                edit.set(&value, fitted.value);
                if self.sampling.settled {
                    edit.set(&spread, fitted.std / fitted.value);
                }
            }
        }

        // what has no key
        let mut setup = read_scene(text, name)?;
        self.apply(&mut setup)?;
        let is = |group: fn(Parameter) -> bool| learnt.iter().any(|fitted| group(fitted.parameter));
        if is(|p| {
            matches!(
                p,
                Parameter::OutlineScale | Parameter::OutlineX | Parameter::OutlineY
            )
        }) {
            edit.set_shape("object", &setup.scene.object.shape);
        }
        if is(|p| matches!(p, Parameter::PusherX | Parameter::PusherY)) {
            edit.set_shape("pusher", &setup.scene.pusher.fingers[0]);
        }
        if let (Feet::Known { positions, loads }, true) = (
            setup.scene.feet,
            is(|p| matches!(p, Parameter::CentreX | Parameter::CentreY)),
        ) {
            edit.set_feet(positions, loads);
            // given feet would be known exactly
            let unknown = |key| ["uncertainty", key];
            let spread = match self.sampling.settled {
                true => self.spread_of_centre(&setup),
                false => setup.uncertainty.centre_of_friction,
            };
            edit.set(&unknown("centre_of_friction"), spread);
            edit.set(&unknown("tripod_angle"), setup.uncertainty.tripod_angle);
        }
        if let (Some(camera), true) = (setup.camera, is(|p| p == Parameter::Latency)) {
            edit.set(&["camera", "latency"], camera.latency);
        }
        Ok(edit.text())
    }

    /// Uncertainty of the centre of friction, on one axis, as a share of the radius of gyration.
    fn spread_of_centre(&self, setup: &Setup) -> f64 {
        let is_centre = |p| matches!(p, Parameter::CentreX | Parameter::CentreY);
        let centre = self
            .parameters
            .iter()
            .filter(|fitted| is_centre(fitted.parameter));
        let variance: f64 = centre.map(|fitted| fitted.std * fitted.std / 2.0).sum();
        variance.sqrt() / setup.scene.object.gyration_radius()
    }

    /// Comments on the parameters that were learnt, for people.
    fn comments(&self) -> Vec<String> {
        let value = |fitted: &FittedParameter| {
            let said = format!(
                "{} = {:.6} +- {:.6} {}",
                fitted.name, fitted.value, fitted.std, fitted.unit
            );
            let hint = if fitted.determined {
                ""
            } else {
                ", weakly identified"
            };
            said.trim_end().to_owned() + hint
        };
        let (learnt, left): (Vec<_>, Vec<_>) =
            self.parameters.iter().partition(|fitted| fitted.learnt);
        let mut lines = Vec::new();
        if !learnt.is_empty() {
            lines.push(format!(
                "fitted to {} by `stickslip fit`:",
                counted(self.pushes as u64, "push")
            ));
            lines.extend(learnt.into_iter().map(value));
        }
        if !self.sampling.settled {
            lines
                .push("the chains have not converged: the spreads are those before the fit".into());
        }
        if !left.is_empty() {
            let names: Vec<&str> = left.iter().map(|fitted| fitted.name).collect();
            lines.push(format!("not identifiable from them: {}", names.join(", ")));
        }
        lines
    }
}

/// Reason why a scene keeps its nominal values.
fn refusal(validation: &CrossValidation) -> String {
    let [gain, error] = validation.gain_mm;
    format!(
        "nominal values: `stickslip fit` does not improve predictions of pushes left out \
         (gain {gain:.2} +- {error:.2} mm in the mean)"
    )
}
