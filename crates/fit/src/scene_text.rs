//! A scene file with the learnt values: [`Fit::scene_text`].

use std::f64::consts::SQRT_2;

use stickslip::{Setup, Uncertainty, counted};
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
        if let (Feet::Known { positions, loads }, true) =
            (setup.scene.feet, is(Parameter::is_of_support))
        {
            edit.set_feet(positions, loads);
            // given feet would be known exactly
            let unsure = match self.sampling.settled {
                true => self.support_spreads(&setup),
                false => setup.uncertainty,
            };
            let spreads = [
                ("d_tri", unsure.friction.d_tri),
                ("centre_of_friction", unsure.centre_of_friction),
                ("tripod_angle", unsure.tripod_angle),
                ("foot_stretch", unsure.foot_stretch),
            ];
            for (key, spread) in spreads {
                edit.set(&["uncertainty", key], spread);
            }
        }
        if let (Some(camera), true) = (setup.camera, is(|p| p == Parameter::Latency)) {
            edit.set(&["camera", "latency"], camera.latency);
        }
        Ok(edit.text())
    }

    /// Uncertainty of the support after the fit; what was not free keeps that of `setup`.
    fn support_spreads(&self, setup: &Setup) -> Uncertainty {
        use Parameter::{CentreX, CentreY, PhaseX, PhaseY, StretchX, StretchXy, TripodRadius};
        let of = |parameter| {
            self.parameters
                .iter()
                .find(|fitted| fitted.parameter == parameter)
        };
        let both = |one, other| {
            let [one, other] = [of(one)?, of(other)?];
            Some(libm::hypot(one.std, other.std) / SQRT_2)
        };
        let mut unsure = setup.uncertainty;
        if let Some(fitted) = of(TripodRadius) {
            unsure.friction.d_tri = fitted.std / fitted.value;
        }
        if let Some(std) = both(CentreX, CentreY) {
            unsure.centre_of_friction = std / setup.scene.object.gyration_radius();
        }
        if let Some(std) = both(StretchX, StretchXy) {
            unsure.foot_stretch = std;
        }
        if let (Some(x), Some(y), Some(std)) = (of(PhaseX), of(PhaseY), both(PhaseX, PhaseY)) {
            // to first order, of an angle three times as large
            let turn = std / libm::hypot(x.value, y.value) / 3.0;
            unsure.tripod_angle = turn.min(unsure.tripod_angle);
        }
        unsure
    }

    /// Comments on the parameters that were learnt, for people.
    fn comments(&self) -> Vec<String> {
        let value = |fitted: &FittedParameter| {
            let said = format!(
                "{} = {:.6} +- {:.6} {}",
                fitted.name(),
                fitted.value,
                fitted.std,
                fitted.unit
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
            let names: Vec<&str> = left.iter().map(|fitted| fitted.name()).collect();
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
