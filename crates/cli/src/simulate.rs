//! `stickslip simulate`: an experiment folder from a scene: scene.toml, log.csv, truth.csv,
//! truth.json.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result};
use stickslip::Setup;
use stickslip_formats::{
    TruthFacts, read_scene, read_truth_json, write_log, write_truth_csv, write_truth_json,
};
use stickslip_testbed::true_friction;

use crate::args::SimulateArgs;
use crate::experiment::{log_path, read_facts_file, text_of};
use crate::failure::hinted;
use crate::output::{show, talk};
use crate::paper::PaperScene;
use crate::simulation::{Options, REPEATS, Simulation};
use crate::verdict::Verdict;
use stickslip_report::Table;

/// A scene's text with what is known of its truth.
struct Source {
    name: String,
    scene: String,
    known: TruthFacts,
}

/// Runs the command.
pub fn simulate(args: &SimulateArgs) -> Result<Verdict> {
    refuse_recorded(&args.out)?;
    let source = source(args)?;
    let setup = read_scene(&source.scene, &source.name)?;
    let known = match args.friction_error {
        Some(share) => misjudged(&setup, share, args.seed),
        None => source.known,
    };
    let options = Options {
        physics: args.physics,
        seed: args.seed,
        rate: args.rate,
        repeats: REPEATS,
    };
    let simulation = Simulation::run(&setup, &source.name, &known, &options)?;
    write(&args.out, &source.scene, &simulation)?;
    show(tables(&source.name, &setup, &simulation))?;
    if simulation.trace.unsolved > 0 {
        talk(format_args!(
            "warning: {} steps have no certified solution",
            simulation.trace.unsolved
        ));
    }
    talk(format_args!("wrote {}", args.out.display()));
    Ok(Verdict::Done)
}

/// A log that is there may be a recorded one.
fn refuse_recorded(out: &Path) -> Result<()> {
    let log = log_path(out);
    if log.exists() {
        return Err(hinted(
            format!("{} is there already", log.display()),
            "give another folder with --out, or remove that log first",
        ));
    }
    Ok(())
}

fn source(args: &SimulateArgs) -> Result<Source> {
    if let Some(paper) = args.paper {
        let PaperScene {
            name,
            story,
            scene,
            truth,
        } = paper.scene();
        let known = read_truth_json(truth, name)?;
        return Ok(Source {
            name: format!("{name} ({story})"),
            scene: scene.to_owned(),
            known,
        });
    }
    let path = args
        .scene
        .as_deref()
        .context("a scene or --paper is needed")?;
    let known = args
        .truth
        .as_deref()
        .map(read_facts_file)
        .transpose()?
        .unwrap_or_default();
    Ok(Source {
        name: path.display().to_string(),
        scene: text_of(path, "scene")?,
        known,
    })
}

/// A truth that the scene's friction misses.
fn misjudged(setup: &Setup, share: f64, seed: u64) -> TruthFacts {
    let truth = true_friction(setup.scene.nominal, share, seed);
    TruthFacts {
        mu_s: Some(truth.mu_s),
        mu_p: Some(truth.mu_p),
        mu_f: Some(truth.mu_f),
        d_tri: Some(truth.d_tri),
        ..TruthFacts::default()
    }
}

fn write(folder: &Path, scene: &str, simulation: &Simulation) -> Result<()> {
    let write = |name: &str, content: &dyn Fn(&mut BufWriter<File>) -> std::io::Result<()>| {
        let path = folder.join(name);
        let write = || -> std::io::Result<()> {
            fs::create_dir_all(folder)?;
            let mut file = BufWriter::new(File::create(&path)?);
            content(&mut file)?;
            file.flush()
        };
        write().map_err(|error| {
            hinted(
                format!("{}: cannot be written: {error}", path.display()),
                "give a folder that can be written to with --out",
            )
        })
    };
    write("scene.toml", &|file| file.write_all(scene.as_bytes()))?;
    write("truth.csv", &|file| {
        write_truth_csv(file, &simulation.truth)
    })?;
    write("truth.json", &|file| {
        write_truth_json(file, &simulation.facts)
    })?;
    write("log.csv", &|file| write_log(file, &simulation.log))
}

fn tables(name: &str, setup: &Setup, simulation: &Simulation) -> String {
    let Simulation { log, facts, .. } = simulation;
    let length = log.time.last().copied().unwrap_or(0.0);
    let mut events = Table::new(["event", "row", "time [s]"]);
    let mut event = |what: String, row: Option<usize>| {
        let cells = row.map_or(["-".to_owned(), "-".to_owned()], |row| {
            [row.to_string(), format!("{:.2}", log.time[row])]
        });
        events.push([what].into_iter().chain(cells));
    };
    event("pusher touches".to_owned(), facts.first_pusher_contact);
    for (j, row) in facts.first_fixel_contacts.iter().enumerate() {
        event(format!("fixel {} touches", j + 1), *row);
    }
    event("camera dark from".to_owned(), facts.occlude_from);
    format!(
        "{name}: {} rows, {length:.1} s\n\n{events}\n{}",
        log.len(),
        friction(setup, facts)
    )
}

/// The friction that the scene tells beside the true one.
fn friction(setup: &Setup, facts: &TruthFacts) -> Table {
    let nominal = setup.scene.nominal;
    let mut table = Table::new(["friction", "told", "truth"]);
    let mut row =
        |name: &str, told: String, truth: String| table.push([name.to_owned(), told, truth]);
    let number = |value: f64| format!("{value:.3}");
    let length = |value: f64| format!("{:.1} mm", 1e3 * value);
    for (name, told, truth) in [
        ("mu_s", nominal.mu_s, facts.mu_s),
        ("mu_p", nominal.mu_p, facts.mu_p),
        ("mu_f", nominal.mu_f, facts.mu_f),
    ] {
        row(name, number(told), truth.map_or_else(String::new, number));
    }
    let told = if setup.has_tripod() {
        length(nominal.d_tri)
    } else {
        "-".to_owned()
    };
    row("d_tri", told, facts.d_tri.map_or_else(String::new, length));
    table
}
