//! The random problems: fixed, in scale, of every kind, and truthful about their witnesses.

use stickslip_dynamics::StepProblem;
use stickslip_testkit::{Corpus, Family, gap_margin, residual_si};

const CORPUS: Corpus = Corpus { seed: 2012 };

fn indices() -> std::ops::Range<u64> {
    0..40 * Family::ALL.len() as u64
}

fn of(family: Family) -> impl Iterator<Item = StepProblem> {
    indices()
        .filter(move |&index| CORPUS.family(index) == family)
        .map(|index| CORPUS.problem(index))
}

/// FNV-1a over the shortest decimal form of every number.
fn digest(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[test]
fn problem_is_a_function_of_seed_and_index() {
    let backwards: Vec<_> = (0..200).rev().map(|index| CORPUS.problem(index)).collect();
    for (index, problem) in (0..200).rev().zip(backwards) {
        assert_eq!(problem, CORPUS.problem(index));
        assert_ne!(problem, CORPUS.problem(index + Family::ALL.len() as u64));
        assert_ne!(problem, Corpus { seed: 2013 }.problem(index));
    }
}

#[test]
fn problem_digest_is_the_recorded_one() {
    let all: String = (0..220)
        .map(|index| format!("{:?}\n", CORPUS.problem(index)))
        .collect();
    assert_eq!(
        digest(&all),
        RECORDED,
        "the corpus has changed: failures counted before and after cannot be compared"
    );
}

const RECORDED: u64 = 3273404749949657146;

#[test]
fn family_every_one_appears_once_per_cycle() {
    let cycle: Vec<_> = (100..100 + Family::ALL.len() as u64)
        .map(|index| CORPUS.family(index))
        .collect();
    for family in Family::ALL {
        assert_eq!(
            cycle.iter().filter(|&&other| other == family).count(),
            1,
            "{family:?}"
        );
    }
}

#[test]
fn problem_keeps_to_the_scale_of_a_table_top() {
    for index in indices() {
        let p = CORPUS.problem(index);
        let gyration = (p.inertia / p.mass).sqrt();
        assert!(
            (0.02..=5.0).contains(&p.mass)
                && (2.9e-3..=61e-3).contains(&gyration)
                && (1e-4..=0.034).contains(&p.h),
            "{index}"
        );
        assert!(
            libm::hypot(p.twist.vx, p.twist.vy) <= 0.3 && p.twist.omega.abs() * gyration <= 0.31,
            "{index}"
        );
        assert!(p.contacts.len() <= 12, "{index}");
        for c in &p.contacts {
            assert!(
                (libm::hypot(c.normal[0], c.normal[1]) - 1.0).abs() < 1e-14,
                "{index}"
            );
            assert!(
                c.gap.abs() <= 2e-3 && (0.0..=1.5).contains(&c.mu),
                "{index}: {c:?}"
            );
            assert!(
                libm::hypot(c.arm[0], c.arm[1]) <= 3.3 * gyration,
                "{index}: {c:?}"
            );
            assert!(
                c.yields.is_some() || c.surface_velocity == [0.0; 2],
                "{index}: fixels do not move"
            );
        }
    }
}

#[test]
fn feet_carry_the_weight_in_balance() {
    for index in indices() {
        let p = CORPUS.problem(index);
        let moment = |axis: usize| {
            p.feet
                .iter()
                .map(|foot| foot.bound * foot.arm[axis])
                .sum::<f64>()
        };
        let total = p.feet.iter().map(|foot| foot.bound).sum::<f64>();
        assert!(
            moment(0).abs() + moment(1).abs() <= 1e-14 * total,
            "{index}"
        );
        assert!(total <= 1.0001 * p.mass * 9.81 * p.h, "{index}");
    }
}

#[test]
fn witness_solves_its_problem() {
    let mut witnesses = 0;
    for index in indices() {
        if let Some(witness) = CORPUS.witness(index) {
            let residual = residual_si(&CORPUS.problem(index), &witness);
            assert!(
                residual < 1e-13,
                "{:?} {index}: {residual:e}",
                CORPUS.family(index)
            );
            witnesses += 1;
        }
    }
    assert_eq!(witnesses, 3 * 40);
}

#[test]
fn problems_hold_what_their_families_promise() {
    assert!(of(Family::Sliding).all(|p| p.contacts.is_empty()));
    assert!(of(Family::Frictionless).all(|p| p.contacts.iter().all(|c| c.mu == 0.0)));
    assert!(of(Family::StalledJam).all(|p| p.stall.is_some()));
    assert!(of(Family::SlipperySupport).all(|p| p.feet.iter().all(|foot| foot.bound == 0.0)));
    assert!(of(Family::Overlapping).all(|p| p.contacts.iter().all(|c| c.gap < 0.0)));
    assert!(of(Family::Duplicated).all(|p| {
        p.contacts
            .iter()
            .all(|a| p.contacts.iter().filter(|&b| a == b).count() >= 2)
    }));
    assert!(of(Family::TinyTripod).all(|p| {
        p.feet
            .iter()
            .all(|foot| libm::hypot(foot.arm[0], foot.arm[1]) < 5.1e-4)
    }));
}

#[test]
fn corpus_holds_what_is_rare() {
    let all: Vec<_> = indices().map(|index| CORPUS.problem(index)).collect();
    let has = |what: &dyn Fn(&StepProblem) -> bool| all.iter().filter(|p| what(p)).count();
    assert!(has(&|p| p.contacts.len() == 8) > 5);
    assert!(has(&|p| p.contacts.iter().any(|c| c.gap == 0.0)) > 100);
    assert!(has(&|p| p.contacts.iter().any(|c| c.gap < -1e-3)) > 10);
    assert!(has(&|p| p.contacts.iter().any(|c| c.mu == 0.0)) > 50);
    assert!(has(&|p| p.twist == Default::default()) > 50);
    assert!(has(&|p| p.stall.is_some()) > 50);
    assert!(
        has(&|p| gap_margin(p, 1.0) < -1e-6) > 10,
        "some have no rigid solution"
    );
    assert!(
        has(&|p| gap_margin(p, 1.0) > 1e-6) > 500,
        "most are not excluded by their gap rows"
    );
}
