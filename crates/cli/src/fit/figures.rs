//! Figures of a fit: what the pushes say of each parameter, and how well others are predicted.

use stickslip::quantile;
use stickslip_fit::{CrossValidation, Fit};
use stickslip_report::{Block, Colour, Scale, StripGroup, StripLane, StripPlot};

/// Of how many posterior draws one is shown.
const SHOWN: usize = 4;

/// Smallest error shown (mm).
const FLOOR: f64 = 0.05;

/// Posterior of each parameter in standard deviations of its prior.
pub fn marginals(fit: &Fit) -> Block {
    let draws = fit.draws();
    let of_parameters = fit.parameters.iter().zip(&draws);
    let groups = of_parameters.map(|(fitted, (_, draws))| {
        let coordinates = draws.iter().map(|draw| fitted.prior.coordinate(*draw));
        let values: Vec<f64> = coordinates.collect();
        let end = |q| quantile(&values, q);
        StripGroup {
            name: fitted.name.to_owned(),
            lanes: vec![StripLane {
                name: "posterior".to_owned(),
                colour: Colour::BLUE,
                interval: end(0.05).zip(end(0.95)).map(|(low, high)| [low, high]),
                values: values.into_iter().step_by(SHOWN).collect(),
                ..StripLane::default()
            }],
        }
    });
    let plot = StripPlot {
        label: "Posterior of each parameter".to_owned(),
        x_label: "posterior draws, in standard deviations of the prior".to_owned(),
        level: Some(0.0),
        groups: groups.collect(),
        ..StripPlot::default()
    };
    let caption = "A dot is a draw from the posterior, the dark line its 90 % interval; 0 is the nominal value, and 90 % of the prior is \
        from -1.6 to 1.6. Of a parameter that fills this range the pushes say nothing.";
    Block::Figure(plot.drawing(), caption.to_owned())
}

/// Final position error of each push, with the nominal scene and by the fit.
pub fn errors(validation: &CrossValidation) -> Block {
    let lane = |name: &str, colour: Colour, k: usize| StripLane {
        name: name.to_owned(),
        colour,
        values: validation
            .pushes
            .iter()
            .map(|push| push.final_mm[k])
            .collect(),
        labels: validation
            .pushes
            .iter()
            .map(|push| push.push.clone())
            .collect(),
        ..StripLane::default()
    };
    let plot = StripPlot {
        label: "Final position error of pushes that the fit has not seen".to_owned(),
        x_label: "final position error (mm)".to_owned(),
        scale: Scale::Log { floor: FLOOR },
        groups: vec![
            StripGroup {
                name: "nominal".to_owned(),
                lanes: vec![lane("nominal scene", Colour::GREY, 0)],
            },
            StripGroup {
                name: "fitted".to_owned(),
                lanes: vec![lane("median of the posterior", Colour::BLUE, 1)],
            },
        ],
        ..StripPlot::default()
    };
    let caption = "A dot is a push, predicted from its first pose and the pusher alone; the bar is the median.";
    Block::Figure(plot.drawing(), caption.to_owned())
}
