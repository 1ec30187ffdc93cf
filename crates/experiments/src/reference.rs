//! Agreement of few particles with the belief of model and data: [`Agreement`] with a reference of
//! very many particles. It shows whether an error is owed to sampling or to the model.

use stickslip::{Estimate, FilterModel, RunError, RunOptions, Tracking, quantile, run, wrapped};

use stickslip_evaluation::paper::{Replicate, RunSettings};
use stickslip_evaluation::{ScoredRun, Scores, Variant};

/// Two runs over the same experiment with touch, its camera off as the experiment says. One has a
/// few particles, as the program runs them. The reference has many particles, which weighing alone
/// updates.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// Scores of the few.
    pub few: Scores,
    /// Scores of the reference.
    pub reference: Scores,
    /// Root mean square over the occluded rows and x, y, θ of (mean − the reference's mean) / its
    /// standard deviation. It would be 1/√N for N independent particles.
    pub distance: f64,
    /// Median over the same of the standard deviation over the reference's.
    pub spread: f64,
}

impl Agreement {
    /// Of so many `few` and `many` particles, both with the replicate's seed.
    ///
    /// # Errors
    /// Those of [`stickslip::run`].
    pub fn of(replicate: &Replicate, few: usize, many: usize) -> Result<Self, RunError> {
        let few = scored(replicate, few, true)?;
        let reference = scored(replicate, many, false)?;
        let hidden = replicate.occlusion.hidden(&replicate.experiment.log);
        let pairs = apart(&few.estimate, &reference.estimate, |row| hidden[row]);
        let squares: f64 = pairs.iter().map(|(distance, _)| distance * distance).sum();
        let spreads: Vec<f64> = pairs.iter().map(|(_, spread)| *spread).collect();
        Ok(Self {
            distance: (squares / pairs.len() as f64).sqrt(),
            spread: quantile(&spreads, 0.5).unwrap_or(f64::NAN),
            few: few.scores,
            reference: reference.scores,
        })
    }
}

/// One run with touch.
fn scored(
    replicate: &Replicate,
    particles: usize,
    camera_moves: bool,
) -> Result<ScoredRun, RunError> {
    let Replicate { experiment, .. } = replicate;
    let conditions = replicate.conditions(RunSettings {
        model: FilterModel::Robust,
        particles,
        tracking: Tracking::Smoothed,
    });
    let options = RunOptions {
        camera_moves,
        ..conditions.options(Variant::Particle)
    };
    let run = run(&experiment.setup, &experiment.log, &options, &mut |_| ())?;
    let scored_on = (replicate.occlusion, experiment.setup.virtual_radius());
    Ok(ScoredRun::of(Variant::Particle, run, experiment, scored_on))
}

/// Of every number of the pose at the rows wanted: distance of the means in standard deviations of
/// the reference, and the ratio of the standard deviations. Rows without a spread are left out.
fn apart(few: &Estimate, many: &Estimate, wanted: impl Fn(usize) -> bool) -> Vec<(f64, f64)> {
    let rows = few.rows.iter().zip(&many.rows).enumerate();
    let rows = rows.filter(|(row, _)| wanted(*row));
    let poses = rows.filter_map(|(_, (few, many))| {
        let (mean, std) = (few.pose?, few.spread.as_ref()?.pose);
        let (to, of) = (many.pose?, many.spread.as_ref()?.pose);
        let turned = wrapped(mean.theta - to.theta);
        Some([
            ((mean.x - to.x) / of.x, std.x / of.x),
            ((mean.y - to.y) / of.y, std.y / of.y),
            (turned / of.theta, std.theta / of.theta),
        ])
    });
    let numbers = poses.flatten();
    numbers
        .filter(|(distance, _)| distance.is_finite())
        .collect()
}

#[cfg(test)]
mod tests {
    use stickslip::dynamics::Pose;
    use stickslip::{EstimateRow, Spread};

    use super::*;

    fn estimate(poses: &[(Pose, Pose)]) -> Estimate {
        let rows = poses.iter().map(|(pose, std)| EstimateRow {
            pose: Some(*pose),
            spread: Some(Spread {
                pose: *std,
                ..Spread::default()
            }),
            ..EstimateRow::default()
        });
        Estimate {
            rows: rows.collect(),
            ..Estimate::default()
        }
    }

    #[test]
    fn distances_are_in_standard_deviations_of_the_reference_and_angles_are_wrapped() {
        let turn = std::f64::consts::TAU;
        let few = [
            (Pose::new(1.0, 2.0, 0.1 + turn), Pose::new(1.0, 1.0, 1.0)),
            (Pose::new(9.0, 9.0, 9.0), Pose::new(9.0, 9.0, 9.0)),
        ];
        let many = [
            (Pose::new(0.0, 4.0, 0.0), Pose::new(0.5, 2.0, 0.1)),
            (Pose::new(0.0, 0.0, 0.0), Pose::new(1.0, 1.0, 1.0)),
        ];
        let found = apart(&estimate(&few), &estimate(&many), |row| row == 0);
        let expected = [(2.0, 2.0), (-1.0, 0.5), (1.0, 10.0)];
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found.0 - expected.0).abs() < 1e-9, "{found:?}");
            assert!((found.1 - expected.1).abs() < 1e-9, "{found:?}");
        }
    }
}
