//! One experiment with the runs of several variants: [`ReportedExperiment`], its scores and its
//! section of a report.

use stickslip::diagnosis::assumed_stall_force;
use stickslip::{Log, Occlusion, Setup};
use stickslip_evaluation::{Reference, Scores, Variant};
use stickslip_formats::Experiment;

use crate::colour::Line;
use crate::intervals::{intervals, row_ranges, times};
use crate::marks::Mark;
use crate::page::{Block, Section};
use crate::playback::{Playback, PlaybackRun};
use crate::reported_run::ReportedRun;
use crate::sentences::Fate;
use crate::table::{Table, number};
use crate::touch::{TouchRule, true_touches};

/// Time that is shown before the first contact and after the last one begins (s).
const BEFORE: f64 = 1.0;
const AFTER: f64 = 4.0;

/// Time after the last contact begins at which the playback shows its first picture (s).
const POSTER: f64 = 1.5;

/// An experiment and the runs of several variants on it.
#[derive(Clone, Debug)]
pub struct ReportedExperiment<'a> {
    /// Name, as that of its folder.
    pub name: String,
    /// Motion, as "a bar pushes a square until it jams at a fixel"; empty if unknown.
    pub what: String,
    /// The scene.
    pub setup: &'a Setup,
    /// The log.
    pub log: &'a Log,
    /// Poses that estimates are scored against.
    pub reference: Reference,
    /// Name of these poses, as "truth".
    pub reference_name: String,
    /// For each row, true if the object is occluded.
    pub hidden: Vec<bool>,
    /// True contacts of the object with the pusher, then with each fixel, row by row; `None` if
    /// unknown.
    pub touches: Vec<Option<Vec<bool>>>,
    /// First contacts (s).
    pub contacts: Vec<Mark>,
    /// When the object first touched a fixel (s).
    pub first_fixel: Option<f64>,
    /// True values of μ_s, μ_p, μ_f and d_tri (m), if known.
    pub friction: [Option<f64>; 4],
    /// The runs.
    pub runs: Vec<ReportedRun>,
}

/// The largest table that a page holds (bytes).
const MOST_DOWNLOAD: usize = 1_000_000;

impl<'a> ReportedExperiment<'a> {
    /// An experiment with runs under an `occlusion`.
    #[must_use]
    pub fn new(
        name: &str,
        what: &str,
        experiment: &'a Experiment,
        occlusion: Occlusion,
        runs: Vec<ReportedRun>,
    ) -> Self {
        let Experiment {
            setup,
            log,
            truth,
            facts,
        } = experiment;

        // the first contacts, pusher before fixels
        let mark = |row: Option<usize>, name: String| {
            let time = *log.time.get(row?)?;
            Some(Mark { time, name })
        };
        let fixels: Vec<Mark> = (1..)
            .zip(&facts.first_fixel_contacts)
            .filter_map(|(k, row)| mark(*row, setup.scene.contact(k).to_string()))
            .collect();
        let pusher = mark(facts.first_pusher_contact, "pusher".to_owned());

        let reference_name = if truth.is_some() {
            "truth"
        } else {
            "log's own poses"
        };
        let reference = Reference::of(experiment);
        let touches = true_touches(experiment, &reference);
        Self {
            name: name.to_owned(),
            what: what.to_owned(),
            setup,
            log,
            reference,
            reference_name: reference_name.to_owned(),
            hidden: occlusion.hidden(log),
            touches,
            first_fixel: fixels.iter().map(|mark| mark.time).reduce(f64::min),
            contacts: pusher.into_iter().chain(fixels).collect(),
            friction: [facts.mu_s, facts.mu_p, facts.mu_f, facts.d_tri],
            runs,
        }
    }

    /// Playback and picture, then sentences, scores and the other figures.
    #[must_use]
    pub fn section(&self) -> Section {
        let title = if self.what.is_empty() {
            self.name.clone()
        } else {
            self.title()
        };
        let head = [
            Block::Playback(Box::new(self.playback())),
            Block::Text(self.occlusion()),
            Block::Sentences(self.results()),
            Block::Table(self.scores(), self.name.clone()),
            Block::Note(format!(
                "Pose RMSE: root of the mean squared error of the pose against the {}{}. Angles are multiplied by the radius \
                 of gyration. (The paper calls it WMSE.) {} Contact: {}.",
                self.reference_name,
                self.where_known(),
                Fate::rule(),
                TouchRule::measured(self.setup).words()
            )),
        ];
        let estimate = self.learner().map(|run| {
            let mut csv = Vec::new();
            let written = stickslip_formats::write_estimate(&mut csv, &run.scored.estimate);
            written.expect("memory can be written to");
            if csv.len() > MOST_DOWNLOAD {
                return Block::Note(format!(
                    "The table of every row of the {} has {:.0} MB and is not in this page; stickslip filter writes it.",
                    run.title(),
                    1e-6 * csv.len() as f64
                ));
            }
            Block::Download {
                name: format!("{}-estimate.csv", self.name),
                what: format!("every row of the {}", run.title()),
                bytes: csv,
            }
        });
        let assumed =
            assumed_stall_force(self.setup).map(|finding| Block::Note(finding.to_string()));
        let figures = self
            .figures()
            .into_iter()
            .map(|figure| Block::Figure(figure.drawing, figure.caption));
        Section {
            title,
            blocks: head
                .into_iter()
                .chain(assumed)
                .chain(figures)
                .chain(estimate)
                .collect(),
        }
    }

    /// ", known in 2 of 199 rows" of the reference; empty if it is known in all rows.
    fn where_known(&self) -> String {
        let rows = &self.reference.pose;
        let known = rows.iter().filter(|pose| pose.is_some()).count();
        match known == rows.len() {
            true => String::new(),
            false => format!(", known in {known} of {} rows", rows.len()),
        }
    }

    /// The scores of all runs.
    #[must_use]
    pub fn scores(&self) -> Table {
        let rmse = if self.hidden.contains(&true) {
            "pose RMSE, camera off (mm)"
        } else {
            "pose RMSE (mm)"
        };
        let mut table = Table::new([
            "method",
            rmse,
            "expected error (mm)",
            "verdict",
            "pose RMSE, moving (mm)",
            "final (mm)",
            "final (°)",
            "unsolved",
            "collapses",
        ]);
        for run in &self.runs {
            let Scores {
                wmse_moving_mm,
                spread_occluded_mm,
                final_error_mm,
                final_error_deg,
                ..
            } = run.scored.scores;
            let verdict = if run.camera_on() {
                "camera on"
            } else {
                Fate::of(run.wmse_mm()).name()
            };
            let [dark, spread] = [run.wmse_mm(), spread_occluded_mm].map(|score| number(score, 3));
            let scores = [wmse_moving_mm, final_error_mm, final_error_deg];
            let counts = [
                run.scored.unsolved.to_string(),
                run.scored.collapses.to_string(),
            ];
            let cells = [run.title().to_owned(), dark, spread, verdict.to_owned()]
                .into_iter()
                .chain(scores.map(|score| number(score, 3)))
                .chain(counts);
            table.push_coloured(run.colour(), cells);
        }
        table
    }

    /// The experiment to be played back.
    #[must_use]
    pub fn playback(&self) -> Playback {
        let mut playback =
            Playback::new(&self.setup.scene, self.log, &self.reference, self.blind());
        for (touch, truth) in playback.touches.iter_mut().zip(&self.touches) {
            touch.truth.clone_from(truth);
        }
        let off = self.occluded().map(|rows| Mark {
            time: times(&self.log.time, rows)[0],
            name: "camera off".to_owned(),
        });

        // contacts are shown of the learner only
        let learner = self.learner().map(ReportedRun::title);
        let track = |run: &ReportedRun| {
            let mut track = PlaybackRun::new(
                run.title(),
                (run.colour(), Line::of(run.scored.variant)),
                &run.scored.estimate,
                &self.reference,
                run.cloud.clone(),
            );
            if learner == Some(run.title()) {
                track.contacts = self.touch_probabilities(run);
            }
            track
        };

        let drawn: Vec<&ReportedRun> = self.drawn().collect();
        let mut lowest_first: Vec<usize> = (0..drawn.len()).collect();
        lowest_first.sort_by_key(|k| Line::of(drawn[*k].scored.variant));

        let [from, to] = self.span();
        let name = if self.what.is_empty() {
            &self.name
        } else {
            &self.what
        };
        Playback {
            name: name.clone(),
            focus: self.row_at(from)..self.row_at(to) + 1,
            poster: self.poster(),
            reference_name: self.reference_name.clone(),
            marks: self.contacts.iter().cloned().chain(off).collect(),
            runs: drawn.into_iter().map(track).collect(),
            lowest_first,
            ..playback
        }
    }

    /// The experiment without runs, as it was measured, with the object's feet.
    #[must_use]
    pub fn scene_playback(&self) -> Playback {
        let scene = &self.setup.scene;
        let feet = scene.feet_at(0.0, &scene.nominal, 1.0);
        Playback {
            feet: feet.map(|foot| foot.arm).to_vec(),
            ..self.playback()
        }
    }

    /// Runs that figures show: those of [`Variant::DRAWN`] if there are more runs than these.
    pub(crate) fn drawn(&self) -> impl Iterator<Item = &ReportedRun> {
        let all = self.runs.len() <= Variant::DRAWN.len();
        self.runs
            .iter()
            .filter(move |run| all || Variant::DRAWN.contains(&run.scored.variant))
    }

    /// For each row, true if the methods get no pose of the object.
    pub(crate) fn blind(&self) -> Vec<bool> {
        let rows = self.hidden.iter().zip(self.log.object_out_of_sight());
        rows.map(|(hidden, unseen)| *hidden || unseen).collect()
    }

    /// Occluded rows from..to, with the rows next to them in which the camera lost the object.
    pub(crate) fn occluded(&self) -> Option<[usize; 2]> {
        let first = self.hidden.iter().position(|hidden| *hidden)?;
        let last = self.hidden.iter().rposition(|hidden| *hidden)?;
        let blind = row_ranges(self.blind());
        let holds = |row: usize| {
            blind
                .iter()
                .find(move |[from, to]| (*from..*to).contains(&row))
        };
        Some([holds(first)?[0], holds(last)?[1]])
    }

    /// Times without a pose (s).
    pub(crate) fn dark(&self) -> Vec<[f64; 2]> {
        intervals(&self.log.time, &self.blind())
    }

    /// Times from a little before the first contact to a while after the last one begins, extended
    /// to the next reference pose; all times if no contact is known.
    pub(crate) fn span(&self) -> [f64; 2] {
        let time = &self.log.time;
        let [first, last] = self.whole_span();
        let contacts = self.contacts.iter().map(|mark| mark.time);
        let contacts = contacts.filter(|time| time.is_finite());
        let Some(start) = contacts.clone().reduce(f64::min) else {
            return [first, last];
        };
        let end = contacts.fold(start, f64::max) + AFTER;
        let mut later = time[self.row_at(end)..].iter().copied();
        let compared = later.find(|time| self.reference.pose_at(*time).is_some());
        [
            (start - BEFORE).max(first),
            compared.map_or(end, |time| time.max(end)).min(last),
        ]
    }

    /// First and last time of the log.
    pub(crate) fn whole_span(&self) -> [f64; 2] {
        let time = &self.log.time;
        let ends = time.first().zip(time.last());
        ends.map_or([0.0, 1.0], |(first, last)| [*first, *last])
    }

    /// The last row up to a time.
    pub(crate) fn row_at(&self, time: f64) -> usize {
        let after = self.log.time.partition_point(|t| *t <= time + 1e-9);
        after.saturating_sub(1)
    }

    /// Row that the playback shows first.
    pub(crate) fn poster(&self) -> usize {
        let [from, to] = self.span();
        let contacts = self.contacts.iter().map(|mark| mark.time);
        let last = contacts.filter(|time| time.is_finite()).reduce(f64::max);
        let shown = last.map_or(to - AFTER, |last| last.min(to)) + POSTER;
        self.row_at(shown.min(to).max(from))
    }

    /// Run whose particles and friction are shown: the last one that estimates friction with the
    /// camera off.
    pub(crate) fn learner(&self) -> Option<&ReportedRun> {
        let learns = |run: &&ReportedRun| {
            let mut rows = run.scored.estimate.rows.iter();
            rows.any(|row| row.friction.is_some())
        };
        let mut learners = self.runs.iter().filter(learns);
        let first = learners.clone().next();
        learners.rfind(|run| !run.camera_on()).or(first)
    }

    /// Probabilities of contact with the pusher, then with each fixel, row by row; `None` in rows
    /// without.
    pub(crate) fn touch_probabilities(&self, run: &ReportedRun) -> Vec<Option<Vec<f64>>> {
        let rule = TouchRule::measured(self.setup);
        let rows = run.scored.estimate.rows.iter().enumerate();
        rows.map(|(row, estimate)| {
            let particles = run.cloud.get(row).map_or(&[][..], Vec::as_slice);
            rule.probabilities(estimate, particles, &self.log.fingers_at(row))
        })
        .collect()
    }
}
