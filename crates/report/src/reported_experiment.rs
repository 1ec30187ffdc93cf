//! One experiment with the runs of several variants: [`ReportedExperiment`], its story, its scores
//! and its section of a report.

use stickslip::diagnosis::assumed_stall_force;
use stickslip::{Log, Occlusion, Setup};
use stickslip_evaluation::{Reference, Scores};
use stickslip_formats::Experiment;

use crate::colour::Line;
use crate::intervals::{intervals, row_ranges, times};
use crate::marks::Mark;
use crate::page::{Block, Section};
use crate::playback::{Playback, PlaybackRun};
use crate::reported_run::ReportedRun;
use crate::story::{Fate, Outcome, Story};
use crate::table::{Table, number};
use crate::touch::{TouchRule, true_touches};

/// Time that is shown before the first contact and after the last one begins (s).
const BEFORE: f64 = 1.0;
const AFTER: f64 = 4.0;

/// Time after the last contact begins at which the playback shows its first picture (s).
const POSTER: f64 = 1.5;

/// An experiment and what several variants made of it.
#[derive(Clone, Debug)]
pub struct ReportedExperiment<'a> {
    /// Name, as that of its folder.
    pub name: String,
    /// What moves, as "a bar pushes a square until it jams at a fixel"; empty where nobody knows.
    pub what: String,
    /// What was known before it.
    pub setup: &'a Setup,
    /// What was measured.
    pub log: &'a Log,
    /// What estimates are scored against.
    pub reference: Reference,
    /// What that is, as "truth".
    pub reference_name: String,
    /// Whether each row's object pose was hidden.
    pub hidden: Vec<bool>,
    /// Whether the object truly touches the pusher, then each fixel, row by row; `None` where that
    /// is not known.
    pub touches: Vec<Option<Vec<bool>>>,
    /// First contacts (s).
    pub contacts: Vec<Mark>,
    /// When the object first touched a fixel (s).
    pub first_fixel: Option<f64>,
    /// True values of μ_s, μ_p, μ_f and d_tri (m), where they are known.
    pub friction: [Option<f64>; 4],
    /// The runs.
    pub runs: Vec<ReportedRun>,
}

impl<'a> ReportedExperiment<'a> {
    /// An experiment with runs made while `occlusion` hid the object.
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
            .filter_map(|(k, row)| mark(*row, format!("fixel {k}")))
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

    /// What happened, in words made from numbers.
    #[must_use]
    pub fn story(&self) -> Story {
        let outcome = |run: &ReportedRun| Outcome {
            name: run.title().to_owned(),
            camera_on: run.camera_on(),
            wmse_mm: run.wmse_mm(),
        };
        let dark = self.darkness();
        let within = |row: &usize| dark.is_some_and(|[from, to]| (from..to).contains(row));
        let lost = (0..self.log.len()).filter(|row| self.log.object[*row].is_none());
        Story {
            what: self.what.clone(),
            duration: self.log.duration(),
            dark: dark.map(|rows| times(&self.log.time, rows)),
            lost: lost.filter(|row| !within(row)).count(),
            rows: self.log.len(),
            lag: self.reference.latency,
            first_fixel: self.first_fixel,
            outcomes: self.runs.iter().map(outcome).collect(),
            learnt: self.learnt(),
        }
    }

    /// What a reader should know after a minute.
    #[must_use]
    pub fn summary(&self) -> [Block; 2] {
        let story = self.story();
        let title = if self.what.is_empty() {
            String::new()
        } else {
            format!("{}. ", story.title())
        };
        [
            Block::Text(format!("{title}{}", story.darkness())),
            Block::Fates(story),
        ]
    }

    /// Playback, scores and figures.
    #[must_use]
    pub fn section(&self) -> Section {
        let title = if self.what.is_empty() {
            self.name.clone()
        } else {
            self.story().title()
        };
        let head = [
            Block::Playback(Box::new(self.playback())),
            Block::Table(self.scores(), self.name.clone()),
            Block::Note(format!(
                "WMSE, the paper's name for the weighted root mean square error: root of the mean of squared errors, \
                 angles weighted by the radius of gyration, against the {}{}. {} Own spread: what a method holds that error \
                 to be; moving: from the pusher's first contact to the object's last motion; final: at the last row. Unsolved: \
                 steps of particles that the solver left unsolved; collapses: rows that no particle explained. Contact: {}.",
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

    /// ", known in 2 of 199 rows" of what estimates are scored against; nothing where it always is.
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
        let wmse = if self.hidden.contains(&true) {
            "WMSE in the dark (mm)"
        } else {
            "WMSE (mm)"
        };
        let mut table = Table::new([
            "method",
            wmse,
            "own spread (mm)",
            "verdict",
            "WMSE moving (mm)",
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
        let dark = self.darkness().map(|rows| Mark {
            time: times(&self.log.time, rows)[0],
            name: "camera dark".to_owned(),
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

        let mut lowest_first: Vec<usize> = (0..self.runs.len()).collect();
        lowest_first.sort_by_key(|k| Line::of(self.runs[*k].scored.variant));

        let [from, to] = self.span();
        let name = if self.what.is_empty() {
            &self.name
        } else {
            &self.what
        };
        Playback {
            name: name.clone(),
            rows: self.row_at(from)..self.row_at(to) + 1,
            poster: self.poster(),
            reference_name: self.reference_name.clone(),
            marks: self.contacts.iter().cloned().chain(dark).collect(),
            runs: self.runs.iter().map(track).collect(),
            lowest_first,
            ..playback
        }
    }

    /// Whether no row's pose is there for the methods: it was hidden, or the camera has lost it.
    fn blind(&self) -> Vec<bool> {
        let rows = self.hidden.iter().zip(&self.log.object);
        rows.map(|(hidden, pose)| *hidden || pose.is_none())
            .collect()
    }

    /// The rows without a pose that hold the hidden ones, from..to: where the camera had lost the
    /// object before it was hidden, from there on.
    fn darkness(&self) -> Option<[usize; 2]> {
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

    /// From a little before the first contact to a while after the last one begins, and on to where
    /// the estimates can be compared to something; all times where no contact is known.
    pub(crate) fn span(&self) -> [f64; 2] {
        let time = &self.log.time;
        let first = time.first().copied().unwrap_or(0.0);
        let last = time.last().copied().unwrap_or(1.0);
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

    /// The last row up to a time.
    pub(crate) fn row_at(&self, time: f64) -> usize {
        let after = self.log.time.partition_point(|t| *t <= time + 1e-9);
        after.saturating_sub(1)
    }

    /// The row whose picture tells most.
    pub(crate) fn poster(&self) -> usize {
        let [from, to] = self.span();
        let contacts = self.contacts.iter().map(|mark| mark.time);
        let last = contacts.filter(|time| time.is_finite()).reduce(f64::max);
        let shown = last.map_or(to - AFTER, |last| last.min(to)) + POSTER;
        self.row_at(shown.min(to).max(from))
    }

    /// The run whose particles and friction are shown: the last one that learns friction with the
    /// camera dark.
    pub(crate) fn learner(&self) -> Option<&ReportedRun> {
        let learns = |run: &&ReportedRun| {
            let mut rows = run.scored.estimate.rows.iter();
            rows.any(|row| row.friction.is_some())
        };
        let mut learners = self.runs.iter().filter(learns);
        let first = learners.clone().next();
        learners.rfind(|run| !run.camera_on()).or(first)
    }
}
