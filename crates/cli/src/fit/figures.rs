//! Figures of a fit: what the pushes say of each parameter, and how well others are predicted.

use stickslip::quantile;
use stickslip_fit::{CrossValidation, Fit, FittedParameter};
use stickslip_report::{
    Block, Colour, Drawing, PointSet, Scale, ScatterPlot, StripGroup, StripLane, StripPlot,
};

/// Of how many posterior draws one is shown.
const SHOWN: usize = 4;

/// Most parameters that are shown in pairs.
const PAIRED: usize = 4;

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

/// Joint posterior of the identified parameters, of at most [`PAIRED`]; `None` for fewer than two.
pub fn pairs(fit: &Fit) -> Option<Block> {
    let draws = fit.draws();
    let all = fit.parameters.iter().zip(&draws);
    let mut identified: Vec<_> = all.filter(|(fitted, _)| fitted.determined).collect();
    identified.sort_by(|(a, _), (b, _)| a.std_ratio.total_cmp(&b.std_ratio));
    identified.truncate(PAIRED);
    let axis = |fitted: &FittedParameter| {
        let name = match fitted.name.starts_with("mu_") {
            true => fitted.name.to_owned(),
            false => fitted.name.replace('_', " "),
        };
        match fitted.unit {
            "" => name,
            unit => format!("{name} ({unit})"),
        }
    };
    let panel = |(i, j): (usize, usize)| {
        let [(a, (_, of_a)), (b, (_, of_b))] = [identified[i], identified[j]];
        let points = of_a.iter().zip(of_b).step_by(SHOWN);
        let set = PointSet {
            colour: Colour::BLUE,
            points: points.map(|(a, b)| [*a, *b]).collect(),
            ..PointSet::default()
        };
        let plot = ScatterPlot {
            label: format!("Joint posterior of {} and {}", a.name, b.name),
            axis_labels: [a, b].map(axis),
            mark: Some([a, b].map(|fitted| fitted.prior_value)),
            sets: vec![set],
            ..ScatterPlot::default()
        };
        plot.drawing()
    };
    let pairs = (0..identified.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let panels: Vec<Drawing> = pairs.map(panel).collect();
    let caption = "A dot is a draw from the posterior of two identified parameters; the dashed lines are the nominal values. A \
        slanted cloud is a sum or ratio that the pushes know better than its parts.";
    (!panels.is_empty()).then(|| Block::Figure(Drawing::grid(&panels, 2), caption.to_owned()))
}

/// Predicted minus measured final position of each push, with the nominal scene and by the fit.
pub fn offsets(validation: &CrossValidation) -> Block {
    let pushes = || validation.pushes.iter();
    let points = |k: usize| pushes().map(move |push| push.final_offset_mm[k]).collect();
    let set = |name: &str, colour: Colour, k: usize, from| PointSet {
        name: name.to_owned(),
        colour,
        points: points(k),
        labels: pushes().map(|push| push.push.clone()).collect(),
        from,
    };
    let plot = ScatterPlot {
        label: "Predicted minus measured final positions of pushes that the fit has not seen"
            .to_owned(),
        axis_labels: ["x", "y"].map(|axis| format!("{axis}, predicted - measured (mm)")),
        mark: Some([0.0; 2]),
        equal: true,
        sets: vec![
            set("nominal scene", Colour::GREY, 0, Vec::new()),
            set("median of the posterior", Colour::BLUE, 1, points(0)),
        ],
    };
    let caption = "A pair of dots is a push, at its last measured pose; the line goes from the nominal prediction to the fit's. The \
        measured position is where the dashed lines cross.";
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
