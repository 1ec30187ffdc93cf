//! The particle filter in random scenes, 10,000 by default, 300 frames each, with every step
//! judged:
//!
//! ```text
//! cargo run --release -p stickslip-experiments --bin closed_loop
//!     [SCENES] [SEED] [--frames FRAMES] [--only INDEX]
//! ```
//!
//! `--only` runs one scene and prints the problems of its steps that have no solution, and of the
//! slowest. Exits with 1 where a step failed, a proof of infeasibility is wrong, or a residual
//! contradicts the solver's.

use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

use stickslip_experiments::{
    ClosedLoop, Existence, LoopTally, NotedStep, PusherPoses, SceneKind, SceneRun, StepAddress,
};
use stickslip_testkit::residual_rows_si;

const USAGE: &str =
    "usage: closed_loop [SCENES] [SEED] [--frames FRAMES] [--only INDEX], all whole numbers";

const PARTICLES: usize = 64;

/// Steps of each outcome that `--only` prints.
const NOTES: usize = 3;

/// Scenes after which progress is reported.
const PROGRESS: u64 = 500;

type Failure = Box<dyn std::error::Error + Send + Sync>;

struct Arguments {
    scenes: u64,
    only: Option<u64>,
    scene_loop: ClosedLoop,
}

fn main() -> ExitCode {
    let Some(arguments) = parse(std::env::args().skip(1)) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let mut out = io::stdout().lock();
    let sound = match arguments.only {
        Some(index) => print_scene(&arguments.scene_loop, index, &mut out),
        None => print_all(&arguments.scene_loop, arguments.scenes, &mut out),
    };
    match sound {
        Ok(sound) => ExitCode::from(u8::from(!sound)),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(1)
        }
    }
}

fn parse(mut given: impl Iterator<Item = String>) -> Option<Arguments> {
    let (mut plain, mut frames, mut only) = (Vec::new(), 300, None);
    while let Some(word) = given.next() {
        match word.as_str() {
            "--frames" => frames = given.next()?.parse().ok().filter(|frames| *frames >= 2)?,
            "--only" => only = Some(given.next()?.parse().ok()?),
            number => plain.push(number.parse::<u64>().ok()?),
        }
    }
    let [scenes, seed] = match plain[..] {
        [] => [10_000, 1],
        [scenes] => [scenes, 1],
        [scenes, seed] => [scenes, seed],
        _ => return None,
    };
    let scene_loop = ClosedLoop {
        seed,
        frames,
        particles: PARTICLES,
    };
    Some(Arguments {
        scenes,
        only,
        scene_loop,
    })
}

/// All scenes in a table; whether all went well.
fn print_all(scene_loop: &ClosedLoop, scenes: u64, out: &mut impl Write) -> Result<bool, Failure> {
    let done = AtomicU64::new(0);
    let runs = scene_loop.run_all(0..scenes, &|_| {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(PROGRESS) {
            eprintln!("{done} of {scenes} scenes");
        }
    })?;
    writeln!(out, "{:<18} {}", "scenes", LoopTally::titles())?;
    for kind in SceneKind::ALL {
        let name = format!("{kind:?}");
        print_row(out, &name, &runs, &|run| !run.rigid && run.kind == kind)?;
    }
    print_row(out, "all", &runs, &|run| !run.rigid)?;
    for poses in PusherPoses::ALL {
        let name = format!("  {poses:?} poses");
        print_row(out, &name, &runs, &|run| {
            !run.rigid && run.pusher_poses == poses
        })?;
    }
    print_row(out, "rigid pushers", &runs, &|run| run.rigid)?;
    let total = sum(&runs, &|_| true);
    print_addresses(out, "failed", &total.failed_at)?;
    print_addresses(out, "said to be solved", &total.refuted_at)?;
    print_addresses(out, "infeasible, but solved", &total.contradicted_at)?;
    Ok(total.is_sound())
}

fn sum(runs: &[SceneRun], belongs: &dyn Fn(&SceneRun) -> bool) -> LoopTally {
    let mut total = LoopTally::default();
    for run in runs.iter().filter(|run| belongs(run)) {
        total.add(&run.tally);
    }
    total
}

fn print_row(
    out: &mut impl Write,
    name: &str,
    runs: &[SceneRun],
    belongs: &dyn Fn(&SceneRun) -> bool,
) -> io::Result<()> {
    writeln!(out, "{name:<18} {}", sum(runs, belongs))
}

fn print_addresses(out: &mut impl Write, what: &str, steps: &[StepAddress]) -> io::Result<()> {
    for StepAddress {
        scene,
        frame,
        particle,
    } in steps
    {
        writeln!(
            out,
            "{what}: scene {scene}, frame {frame}, particle {particle}"
        )?;
    }
    Ok(())
}

/// One scene with its problems; whether all went well.
fn print_scene(scene_loop: &ClosedLoop, index: u64, out: &mut impl Write) -> Result<bool, Failure> {
    writeln!(out, "{}", scene_loop.describe(index))?;
    let run = scene_loop.run(index, NOTES)?;
    writeln!(out, "{:<18} {}", "scene", LoopTally::titles())?;
    writeln!(out, "{:<18} {}", format!("{:?}", run.kind), run.tally)?;
    let noted = &run.noted;
    for (what, steps) in [
        ("failed", &noted.failed[..]),
        ("infeasible", &noted.infeasible[..]),
        ("not solved", &noted.refuted[..]),
        ("slowest", noted.slowest.as_slice()),
    ] {
        for step in steps {
            print_step(out, what, step)?;
        }
    }
    Ok(run.tally.is_sound())
}

fn print_step(out: &mut impl Write, what: &str, step: &NotedStep) -> io::Result<()> {
    let StepAddress {
        frame, particle, ..
    } = step.address;
    let existence = Existence::enumerated(&step.problem);
    writeln!(
        out,
        "\n{what}: frame {frame}, particle {particle}; solution {existence:?}"
    )?;
    let rows = residual_rows_si(&step.problem, &step.solution);
    let worst = rows.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    writeln!(out, "{:?}, worst row {worst:?} m/s", step.report)?;
    writeln!(out, "{:?}\n{:?}", step.problem, step.solution)
}
