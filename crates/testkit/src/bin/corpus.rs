//! `cargo run --release -p stickslip-testkit --bin corpus [PROBLEMS] [SEED]`: the solver over hard random problems, a million by
//! default. Exits with 1 where a problem was neither solved nor proven infeasible, or the proof contradicts a known solution.

use std::process::ExitCode;

use stickslip_testkit::{Corpus, Tally, survey};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let (Ok(problems), Ok(seed)) = (arguments.next().unwrap_or(Ok(1_000_000)), arguments.next().unwrap_or(Ok(1))) else {
        eprintln!("usage: corpus [PROBLEMS] [SEED], both whole numbers");
        return ExitCode::from(2);
    };
    println!(
        "{:<16} {:>9} {:>9} {:>12} {:>9} {:>7} {:>11} {:>7} {:>12}",
        "family", "problems", "newton", "continuation", "homotopy", "modes", "infeasible", "failed", "residual"
    );
    let mut total = Tally::default();
    for (family, tally) in survey(&Corpus { seed }, 0..problems) {
        print_row(&format!("{family:?}"), &tally);
        total.problems += tally.problems;
        (0..4).for_each(|k| total.solved[k] += tally.solved[k]);
        total.infeasible += tally.infeasible;
        total.failed.extend(tally.failed);
        total.contradicted.extend(tally.contradicted);
        total.worst_residual = total.worst_residual.max(tally.worst_residual);
    }
    print_row("all", &total);
    for (what, indices) in [("failed", &total.failed), ("infeasible against a known solution", &total.contradicted)] {
        if !indices.is_empty() {
            println!("{what}: {:?}", &indices[..indices.len().min(20)]);
        }
    }
    ExitCode::from(u8::from(!total.failed.is_empty() || !total.contradicted.is_empty()))
}

fn print_row(name: &str, t: &Tally) {
    let [newton, continuation, homotopy, modes] = t.solved;
    println!(
        "{name:<16} {:>9} {newton:>9} {continuation:>12} {homotopy:>9} {modes:>7} {:>11} {:>7} {:>12.1e}",
        t.problems,
        t.infeasible,
        t.failed.len(),
        t.worst_residual
    );
}
