//! Figures of a fit: what the pushes say of each parameter, and how well others are predicted.

use stickslip::quantile;
use stickslip_fit::{Agreement, CrossValidation, Fit, FittedParameter, HeldOut};
use stickslip_report::{
    Block, Colour, Curve, Drawing, Panel, PointSet, Scale, ScatterPlot, StripGroup, StripLane,
    StripPlot, TimeFigure,
};

use super::FitResult;

/// Of how many posterior draws one is shown.
const SHOWN: usize = 4;

/// Most parameters that are shown in pairs.
const PAIRED: usize = 4;

/// Smallest error shown (mm).
const FLOOR: f64 = 0.05;

/// Posterior of each parameter in standard deviations of its prior.
pub fn marginals(result: &FitResult) -> Block {
    let groups = result.fit.parameters.iter().map(|fitted| {
        let draws = result.draws(fitted);
        let coordinates = draws.iter().map(|draw| fitted.prior.coordinate(*draw));
        let values: Vec<f64> = coordinates.collect();
        let end = |q| quantile(&values, q);
        StripGroup {
            name: fitted.name().to_owned(),
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
pub fn pairs(result: &FitResult) -> Option<Block> {
    let all = result.fit.parameters.iter();
    let mut identified: Vec<_> = all.filter(|fitted| fitted.determined).collect();
    identified.sort_by(|a, b| a.std_ratio.total_cmp(&b.std_ratio));
    identified.truncate(PAIRED);
    let axis = |fitted: &FittedParameter| {
        let name = match fitted.name().starts_with("mu_") {
            true => fitted.name().to_owned(),
            false => fitted.name().replace('_', " "),
        };
        match fitted.unit.as_str() {
            "" => name,
            unit => format!("{name} ({unit})"),
        }
    };
    let panel = |(i, j): (usize, usize)| {
        let [a, b] = [identified[i], identified[j]];
        let points = result.draws(a).iter().zip(result.draws(b)).step_by(SHOWN);
        let set = PointSet {
            colour: Colour::BLUE,
            points: points.map(|(a, b)| [*a, *b]).collect(),
            ..PointSet::default()
        };
        let plot = ScatterPlot {
            label: format!("Joint posterior of {} and {}", a.name(), b.name()),
            axis_labels: [a, b].map(axis),
            mark: Some([a, b].map(|fitted| fitted.prior_value)),
            sets: vec![set],
        };
        plot.drawing()
    };
    let pairs = (0..identified.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let panels: Vec<Drawing> = pairs.map(panel).collect();
    let caption = "A dot is a draw from the posterior of two identified parameters; the dashed lines are the nominal values. A \
        slanted cloud is a sum or ratio that the pushes know better than its parts.";
    (!panels.is_empty()).then(|| Block::Figure(Drawing::grid(&panels, 2), caption.to_owned()))
}

/// Final pose of each push by the fit, predicted minus measured, with its interval.
pub fn finals(validation: &CrossValidation) -> Block {
    let axes = [
        ("x", Colour::BLUE),
        ("y", Colour::ORANGE),
        ("θ times the radius of gyration", Colour::GREEN),
    ];
    let group = |push: &HeldOut| {
        let lane = |(axis, (name, colour)): (usize, (&str, Colour))| StripLane {
            name: name.to_owned(),
            colour,
            values: vec![push.final_offset_mm[1][axis]],
            interval: Some(push.interval_90_mm[axis]),
            mark: Some(push.final_offset_mm[0][axis]),
            ..StripLane::default()
        };
        StripGroup {
            name: push.push.clone(),
            lanes: axes.into_iter().enumerate().map(lane).collect(),
        }
    };
    let plot = StripPlot {
        label: "Predicted minus measured final pose of each push".to_owned(),
        x_label: "final pose, predicted - measured (mm)".to_owned(),
        level: Some(0.0),
        mark_name: "nominal scene".to_owned(),
        groups: validation.pushes.iter().map(group).collect(),
        ..StripPlot::default()
    };
    let caption = "A dot is the median of the posterior, the dark line its 90 % interval, drift and camera noise included; the dashed \
        line at 0 is the measured pose. The fit has not seen the push.";
    Block::Figure(plot.drawing(), caption.to_owned())
}

/// Ways of the populations, parameter by parameter.
pub fn populations(fit: &Fit) -> Block {
    let colours = [Colour::BLUE, Colour::ORANGE, Colour::GREEN, Colour::PURPLE];
    let panel = |chain: &Agreement| {
        let curve = |(k, means): (usize, &Vec<f64>)| Curve {
            name: format!("population {}", k + 1),
            colour: colours[k % colours.len()],
            points: (1..)
                .zip(means)
                .map(|(k, mean)| [f64::from(k), *mean])
                .collect(),
            ..Curve::default()
        };
        Panel {
            title: format!(
                "{}: R-hat {:.3}, {:.0} effective samples",
                chain.name, chain.split_rhat, chain.effective_samples
            ),
            label: "mean".to_owned(),
            least_span: 1.0,
            curves: chain
                .population_means
                .iter()
                .enumerate()
                .map(curve)
                .collect(),
            ..Panel::default()
        }
    };
    let figure = TimeFigure {
        span: [1.0, 10.0],
        time_label: "tenth of the moves that count".to_owned(),
        panels: fit.chains.iter().map(panel).collect(),
        columns: 2,
        panel_size: [441.0, 130.0],
        ..TimeFigure::default()
    };
    let caption = "Mean of each of the four populations in standard deviations of the prior; 0 is the nominal value. They start and move \
        on their own. Where they agree and do not wander, the posterior is known.";
    let figure = Block::Figure(figure.drawing(), caption.to_owned());
    Block::Details("Convergence of the populations".to_owned(), vec![figure])
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
