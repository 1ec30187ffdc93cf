//! `stickslip simulate`: an experiment folder from a scene: scene.toml, log.csv, truth.csv,
//! truth.json.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use stickslip::Setup;
use stickslip::diagnosis::assumed_stall_force;
use stickslip_evaluation::paper::{PaperExperiment, PaperScene};
use stickslip_evaluation::{
    PUSHER_MEMORY, REPEATS, Seeds, Simulation, SimulationError, SimulationOptions,
};
use stickslip_formats::{
    TruthFacts, read_scene, read_truth_json, write_log, write_truth_csv, write_truth_json,
};
use stickslip_report::Table;
use stickslip_testbed::true_friction;

use crate::experiment::{read_facts_file, text_of};
use crate::failure::hinted;
use crate::files::write_out;
use crate::log_files::log_path;
use crate::output::{counted, show, talk};
use crate::simulation_args::SimulateArgs;
use crate::verdict::Verdict;

/// A scene's text with the known part of its truth.
struct Source {
    name: String,
    scene: String,
    known: TruthFacts,
}

/// Runs the command.
pub fn simulate(args: &SimulateArgs) -> Result<Verdict> {
    let all = wanted(args);
    all.iter().try_for_each(|(_, out)| refuse_recorded(out))?;
    let source = source(args)?;
    let setup = read_scene(&source.scene, &source.name)?;
    for (k, (seeds, out)) in all.iter().enumerate() {
        let known = match args.friction_error {
            Some(share) => misjudged(&setup, share, seeds.rig),
            None => source.known.clone(),
        };
        let options = SimulationOptions {
            physics: args.physics.into(),
            seeds: *seeds,
            rate: args.rate,
            repeats: REPEATS,
            pusher_memory: PUSHER_MEMORY,
        };
        let simulation = Simulation::run(&setup, &known, &options, &mut |_, _| ())
            .map_err(|error| refused(error, &source.name))?;
        write(out, &source.scene, &simulation)?;
        if k == 0 {
            // of the others, only the noise differs
            show(tables(&source.name, &setup, &simulation))?;
        }
        if simulation.trace.unsolved > 0 {
            talk(format_args!(
                "warning: {} without a certified solution",
                counted(simulation.trace.unsolved as u64, "step")
            ));
        }
        talk(format_args!("wrote {}", out.display()));
    }
    Ok(Verdict::Done)
}

/// Seeds and folder of each simulation.
fn wanted(args: &SimulateArgs) -> Vec<(Seeds, PathBuf)> {
    let [rig, noise] = [args.rig_seed, args.noise_seed].map(|seed| seed.unwrap_or(args.seed));
    let Some(count) = args.count else {
        return vec![(Seeds { rig, noise }, args.out.clone())];
    };
    let seeds = (0..count).map(|k| noise.wrapping_add(k));
    let folder = |noise| args.out.join(format!("noise-{noise}"));
    seeds
        .map(|noise| (Seeds { rig, noise }, folder(noise)))
        .collect()
}

/// Names the scene, and says what to change in it where that is known.
fn refused(error: SimulationError, name: &str) -> anyhow::Error {
    let help = match error {
        SimulationError::NoStart => {
            "add [start] with object = [x, y, theta], pusher = [x, y, theta], speed = ... in m/s and duration = ... in s"
        }
        SimulationError::RigidDrive => {
            "give the force in N at which the drive yields, or use --physics model"
        }
        _ => return anyhow::Error::new(error).context(name.to_owned()),
    };
    hinted(format!("{name}: {error}"), help)
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
        } = PaperExperiment::from(paper).scene();
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
    let path = |name: &str| folder.join(name);
    write_out(&path("scene.toml"), |file| file.write_all(scene.as_bytes()))?;
    write_out(&path("truth.csv"), |file| {
        write_truth_csv(file, &simulation.truth)
    })?;
    write_out(&path("truth.json"), |file| {
        write_truth_json(file, &simulation.facts)
    })?;
    write_out(&path("log.csv"), |file| write_log(file, &simulation.log))
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
        let name = setup.scene.other(j);
        event(format!("{name} touches"), *row);
    }
    event("camera off from".to_owned(), facts.occlude_from);
    let assumed = assumed_stall_force(setup).map(|finding| format!("\nnote: {finding}\n"));
    format!(
        "{name}: {}, {length:.1} s\n\n{events}\n{}{}",
        counted(log.len() as u64, "row"),
        friction(setup, facts),
        assumed.unwrap_or_default()
    )
}

/// The nominal friction next to the true one.
fn friction(setup: &Setup, facts: &TruthFacts) -> Table {
    let nominal = setup.scene.nominal;
    let number = |value: f64| format!("{value:.3}");
    let length = |value: f64| format!("{:.1} mm", 1e3 * value);
    let d_tri = if setup.has_tripod() {
        length(nominal.d_tri)
    } else {
        "-".to_owned()
    };
    let mut table = Table::new(["friction", "nominal", "truth"]);
    for (name, nominal, truth) in [
        ("mu_s", number(nominal.mu_s), facts.mu_s.map(number)),
        ("mu_p", number(nominal.mu_p), facts.mu_p.map(number)),
        ("mu_f", number(nominal.mu_f), facts.mu_f.map(number)),
        ("d_tri", d_tri, facts.d_tri.map(length)),
    ] {
        table.push([name.to_owned(), nominal, truth.unwrap_or_default()]);
    }
    table
}
