//! `cargo run --release -p stickslip-testkit --bin corpus [PROBLEMS] [SEED]`: the solver over hard
//! random problems, a million by default. Exits with 1 where a problem was neither solved nor
//! proven infeasible, or the proof contradicts a known solution.

use std::process::ExitCode;

use stickslip_testkit::{Corpus, Tally, survey};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let (Ok(problems), Ok(seed)) = (
        arguments.next().unwrap_or(Ok(1_000_000)),
        arguments.next().unwrap_or(Ok(1)),
    ) else {
        eprintln!("usage: corpus [PROBLEMS] [SEED], both whole numbers");
        return ExitCode::from(2);
    };
    println!("{:<16} {}", "family", Tally::TITLES);
    let mut total = Tally::default();
    for (family, tally) in survey(&Corpus { seed }, 0..problems) {
        println!("{:<16} {tally}", format!("{family:?}"));
        total.add(tally);
    }
    println!("{:<16} {total}", "all");
    for (what, indices) in [
        ("failed", &total.failed),
        ("infeasible against a known solution", &total.contradicted),
    ] {
        if !indices.is_empty() {
            println!("{what}: {:?}", &indices[..indices.len().min(20)]);
        }
    }
    ExitCode::from(u8::from(
        !total.failed.is_empty() || !total.contradicted.is_empty(),
    ))
}
