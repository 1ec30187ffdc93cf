//! Touch against no touch on pinned scenes: [`PinnedResults`].

use serde::Serialize;

use super::comparison::CLEAR;
use super::pinned_scene::PinnedGroup;
use super::published::PUBLISHED;
use crate::statistics::{Band, Direction, PairedDifference, sign_test};
use crate::variant::Variant;

/// Scores of one scene over seeds of the filter: weighted RMSE over all rows, as the paper's (mm).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PinnedScores {
    /// Name of the scene.
    pub name: String,
    /// Its group.
    #[serde(skip)]
    pub group: PinnedGroup,
    /// Without touch, seed by seed.
    pub without_touch_mm: Vec<f64>,
    /// With touch, seed by seed.
    pub with_touch_mm: Vec<f64>,
    /// With touch and the camera on, one seed.
    pub camera_on_mm: f64,
}

/// One method on the scenes of a group.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PinnedCell {
    /// Medians over seeds, over the scenes (mm).
    pub ours_mm: Band,
    /// The paper's number (mm).
    pub paper_mm: Option<f64>,
    /// Share of our scenes that are below it.
    pub paper_quantile: Option<f64>,
}

/// Number of scenes in which touch is better, unclear or worse: by more than two standard errors of
/// the median difference over seeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TouchVerdicts {
    /// Touch is better.
    pub better: u32,
    /// Neither.
    pub unclear: u32,
    /// Touch is worse.
    pub worse: u32,
    /// p-value of the sign test of better against worse, two-sided.
    pub p_value: f64,
}

/// A row of the table: the scenes of one or more groups.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PinnedRow {
    /// Its title.
    pub title: String,
    /// Number of scenes.
    pub scenes: usize,
    /// Without touch.
    pub without_touch: PinnedCell,
    /// With touch.
    pub with_touch: PinnedCell,
    /// With touch, the camera on.
    pub camera_on: PinnedCell,
    /// Touch against no touch, scene by scene.
    pub touch: TouchVerdicts,
}

/// The table, with what it was made from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PinnedResults {
    /// Rows: each group, all slides, all stops.
    pub rows: Vec<PinnedRow>,
    /// Every scene.
    pub scenes: Vec<PinnedScores>,
}

impl PinnedScores {
    /// Touch minus no touch, seed by seed.
    ///
    /// # Panics
    /// If there is no seed.
    #[must_use]
    pub fn difference(&self) -> PairedDifference {
        let pairs = PairedDifference::of(&self.with_touch_mm, &self.without_touch_mm);
        pairs.expect("at least one seed")
    }
}

impl PinnedResults {
    /// The table of these scenes. Groups without scenes have no row.
    #[must_use]
    pub fn new(scenes: Vec<PinnedScores>) -> Self {
        let groups = PinnedGroup::ALL.into_iter();
        let groups = groups.map(|group| (group.name().to_owned(), vec![group]));
        let of = |slides| {
            PinnedGroup::ALL
                .into_iter()
                .filter(move |g| g.slides() == slides)
        };
        let sums = [
            ("all slides", of(true).collect()),
            ("all stops", of(false).collect()),
        ];
        let sums = sums.map(|(title, groups): (&str, Vec<_>)| (title.to_owned(), groups));
        let rows = groups.chain(sums).filter_map(|(title, groups)| {
            let own = scenes.iter().filter(|scene| groups.contains(&scene.group));
            PinnedRow::new(title, &groups, &own.collect::<Vec<_>>())
        });
        Self {
            rows: rows.collect(),
            scenes,
        }
    }
}

impl PinnedRow {
    fn new(title: String, groups: &[PinnedGroup], scenes: &[&PinnedScores]) -> Option<Self> {
        let medians = |of: fn(&PinnedScores) -> &[f64]| -> Vec<f64> {
            let scores = scenes.iter().filter_map(|scene| Band::of(of(scene)));
            scores.map(|band| band.median).collect()
        };
        let cell = |variant, values: &[f64]| {
            // groups of several experiments have no number of the paper
            let paper_mm = match groups {
                [one] => one.published(variant),
                _ => None,
            };
            let below = |paper: f64| values.iter().filter(|value| **value < paper).count();
            Some(PinnedCell {
                ours_mm: Band::of(values)?,
                paper_mm,
                paper_quantile: paper_mm.map(|paper| below(paper) as f64 / values.len() as f64),
            })
        };
        let without = medians(|scene| &scene.without_touch_mm);
        let with = medians(|scene| &scene.with_touch_mm);
        let on = medians(|scene| std::slice::from_ref(&scene.camera_on_mm));
        Some(Self {
            title,
            scenes: scenes.len(),
            without_touch: cell(Variant::ParticleNoTouch, &without)?,
            with_touch: cell(Variant::Particle, &with)?,
            camera_on: cell(Variant::ParticleCameraOn, &on)?,
            touch: TouchVerdicts::of(scenes),
        })
    }
}

impl TouchVerdicts {
    fn of(scenes: &[&PinnedScores]) -> Self {
        let mut verdicts = Self::default();
        for scene in scenes {
            let count = match scene.difference().direction(CLEAR) {
                Direction::Below => &mut verdicts.better,
                Direction::Unclear => &mut verdicts.unclear,
                Direction::Above => &mut verdicts.worse,
            };
            *count += 1;
        }
        verdicts.p_value = sign_test(verdicts.better, verdicts.worse);
        verdicts
    }
}

impl PinnedGroup {
    /// The paper's number for a variant (mm).
    #[must_use]
    pub fn published(self, variant: Variant) -> Option<f64> {
        let rows = PUBLISHED.iter().flat_map(|table| table.rows);
        let own = rows.filter(|row| row.experiment == self.paper());
        let mut cells = own.flat_map(|row| row.cells);
        cells.find(|(of, _)| *of == variant).map(|(_, mm)| *mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(group: PinnedGroup, without: f64, with: f64) -> PinnedScores {
        PinnedScores {
            name: String::new(),
            group,
            without_touch_mm: (0..10).map(|k| without + 1e-3 * f64::from(k)).collect(),
            with_touch_mm: (0..10).map(|k| with + 2e-3 * f64::from(k)).collect(),
            camera_on_mm: 0.2,
        }
    }

    #[test]
    fn rows_count_scenes_and_place_the_papers_number_among_them() {
        let scenes = [(10.0, 1.0), (20.0, 0.1), (16.0, 0.2), (3.0, 4.0)];
        let scenes = scenes.map(|(without, with)| scene(PinnedGroup::First, without, with));
        let scenes = scenes
            .into_iter()
            .chain([scene(PinnedGroup::Third, 1.0, 0.9955)]);
        let results = PinnedResults::new(scenes.collect());
        let titles: Vec<&str> = results.rows.iter().map(|row| row.title.as_str()).collect();
        assert_eq!(titles, ["1", "3", "all slides", "all stops"]);

        let first = &results.rows[0];
        assert_eq!((first.touch.better, first.touch.worse), (3, 1));
        assert_eq!(first.touch.p_value, 0.625);
        // 14.2866 and 0.3754 mm
        assert_eq!(first.without_touch.paper_quantile, Some(0.5));
        assert_eq!(first.with_touch.paper_quantile, Some(0.5));
        assert_eq!(results.rows[2].with_touch.paper_mm, None);
        assert_eq!(results.rows[3].touch.unclear, 1);
    }
}
