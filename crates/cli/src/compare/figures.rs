//! A comparison as pictures over its logs: [`figures`].

use std::path::Path;

use stickslip_evaluation::{PIT_BINS, PairedDifference, Variant, quantile};
use stickslip_report::{
    Block, Colour, Histogram, Histograms, Scale, StripGroup, StripLane, StripPlot,
};

use super::results::{Comparison, FolderResult, ShownScores};

/// Logs from which a distribution is worth a picture.
const FEWEST: usize = 3;

/// Smallest error drawn (mm).
const FLOOR: f64 = 0.01;

/// Coverage of intervals that are as wide as they should be (%).
const NOMINAL: f64 = 90.0;

/// Caption of the histograms.
const PIT: &str = "Place of the reference in the belief (probability integral transform, PIT): 0 is its lower end, 0.5 its median, 1 its upper end, \
     over x, y and θ of the rows while the camera is off. Each log counts the same. A calibrated belief fills every tenth with 10 % (dashed). \
     High outer bars: overconfident. High middle bars: too cautious. A slope: biased.";

/// Errors, ratios to the particle filter's errors, and coverage: a dot per log, a lane per method.
/// The place of the reference in the belief: a histogram per method.
pub fn figures(comparison: &Comparison) -> Vec<Block> {
    let folders = &comparison.folders;
    if folders.len() < FEWEST {
        return Vec::new();
    }
    let error = |scores: &ShownScores| scores.wmse_mm;
    let covered = |scores: &ShownScores| scores.covered_90.map(|share| 100.0 * share);
    let mut methods: Vec<(Variant, f64)> = Variant::COMPARED
        .into_iter()
        .filter_map(|variant| {
            Some((
                variant,
                quantile(&lane(folders, variant, error).values, 0.5)?,
            ))
        })
        .collect();
    methods.sort_by(|(a, error), (b, other)| {
        let camera = a.camera_on().cmp(&b.camera_on());
        camera.then(error.total_cmp(other))
    });
    let groups = |lane: &dyn Fn(Variant) -> StripLane| -> Vec<StripGroup> {
        let group = |(variant, _): &(Variant, f64)| StripGroup {
            name: variant.title().to_owned(),
            lanes: vec![lane(*variant)],
        };
        let groups = methods.iter().map(group);
        groups
            .filter(|group| !group.lanes[0].values.is_empty())
            .collect()
    };
    let errors = StripPlot {
        label: "Pose RMSE of every log, method by method".to_owned(),
        x_label: "pose RMSE (mm)".to_owned(),
        scale: Scale::Log { floor: FLOOR },
        groups: groups(&|variant| lane(folders, variant, error)),
        ..StripPlot::default()
    };
    let ratios = StripPlot {
        label: "Pose RMSE over that of the particle filter, log by log".to_owned(),
        x_label: "pose RMSE over the particle filter's".to_owned(),
        scale: Scale::Log { floor: FLOOR },
        level: Some(1.0),
        groups: groups(&|variant| ratio(folders, variant)),
        ..StripPlot::default()
    };
    let coverage = StripPlot {
        label: "Coverage of 90 % intervals, log by log".to_owned(),
        x_label: "truth in the 90 % intervals (%)".to_owned(),
        level: Some(NOMINAL),
        groups: groups(&|variant| lane(folders, variant, covered)),
        ..StripPlot::default()
    };
    let captions = [
        "Pose RMSE while the camera is off, on all rows if it never is. A dot is a log, a bar the median of the logs. \
         Methods are sorted by their median; those whose camera stays on follow.",
        "Each method against the particle filter on the same log. Right of the line the particle filter is nearer. The bar is the median, \
         the dark line its 95 % interval: the difference is clear if the interval does not contain 1.",
        "Share of the rows whose x, y and θ lie in their 90 % intervals. Left of the line, a method is overconfident on that log. \
         Methods without a spread have none.",
    ];
    let plots = [errors, ratios, coverage].into_iter().zip(captions);
    let drawn = plots.filter(|(plot, _)| !plot.groups.is_empty());
    let places = histograms(folders, methods.iter().map(|(variant, _)| *variant));
    drawn
        .map(|(plot, caption)| Block::Figure(plot.drawing(), caption.to_owned()))
        .chain(places.map(|places| Block::Figure(places.drawing(), PIT.to_owned())))
        .collect()
}

/// Mean over the logs of each method's histogram; `None` where no method has a belief.
fn histograms(
    folders: &[FolderResult],
    methods: impl Iterator<Item = Variant>,
) -> Option<Histograms> {
    let histogram = |variant: Variant| {
        let scores = folders.iter().filter_map(|folder| folder.scores(variant));
        let shares = ShownScores::mean(&scores.collect::<Vec<_>>()).pit?;
        Some(Histogram {
            name: variant.title().to_owned(),
            colour: Colour::of(variant),
            bars: shares.map(|share| 100.0 * share).to_vec(),
        })
    };
    let all: Vec<Histogram> = methods.filter_map(histogram).collect();
    (!all.is_empty()).then(|| Histograms {
        x_label: "place in the belief".to_owned(),
        y_label: "rows (%)".to_owned(),
        level: 100.0 / PIT_BINS as f64,
        all,
    })
}

/// The last part of a folder's path.
pub fn short(folder: &str) -> &str {
    let name = Path::new(folder).file_name();
    name.and_then(|name| name.to_str()).unwrap_or(folder)
}

/// A score of a method on all folders that have it.
fn lane(
    folders: &[FolderResult],
    variant: Variant,
    score: impl Fn(&ShownScores) -> Option<f64>,
) -> StripLane {
    let value = |folder: &FolderResult| score(&folder.scores(variant)?);
    of_folders(folders, variant, value)
}

/// Errors of a method over those of the particle filter, with the interval of their median.
fn ratio(folders: &[FolderResult], variant: Variant) -> StripLane {
    if variant == Variant::Particle {
        return StripLane::default();
    }
    let error = |folder: &FolderResult, variant| folder.scores(variant)?.wmse_mm;
    let lane = of_folders(folders, variant, |folder| {
        Some(error(folder, variant)? / error(folder, Variant::Particle)?)
    });
    let logarithms: Vec<f64> = lane.values.iter().map(|ratio| libm::log(*ratio)).collect();
    let median = PairedDifference::of(&logarithms, &vec![0.0; logarithms.len()]);
    let interval = median.and_then(|of| of.interval);
    StripLane {
        interval: interval.map(|ends| ends.map(libm::exp)),
        ..lane
    }
}

fn of_folders(
    folders: &[FolderResult],
    variant: Variant,
    value: impl Fn(&FolderResult) -> Option<f64>,
) -> StripLane {
    let named = |folder: &FolderResult| {
        let value = value(folder).filter(|value| value.is_finite())?;
        Some((value, format!("{}: {value:.2}", short(&folder.folder))))
    };
    let (values, labels) = folders.iter().filter_map(named).unzip();
    StripLane {
        colour: Colour::of(variant),
        values,
        labels,
        ..StripLane::default()
    }
}
