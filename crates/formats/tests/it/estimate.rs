//! `estimate.csv`: the contract's columns, empty cells, bad input, and the way there and back.

use proptest::prelude::*;
use stickslip::{ContactSlip, CrossCovariance, Estimate, EstimateRow, Spread};
use stickslip_dynamics::{Friction, Pose, Twist};
use stickslip_formats::{read_estimate, write_estimate};

const HEADER: &str = "time,x,y,theta,vx,vy,omega,mu_s,mu_p,mu_f,d_tri,contact_pusher,contact_1,contact_2,\
                      std_x,std_y,std_theta,std_mu_s,std_mu_p,std_mu_f,std_d_tri,ess,resampled,visual,unsolved,failed,cov_x_y,cov_x_theta,cov_y_theta,\
                      collapsed,distinct,ancestors,modes,mode_weight,mode_x,mode_y,mode_theta,\
                      stick_pusher,left_pusher,right_pusher,stick_1,left_1,right_1,stick_2,left_2,right_2,\
                      p_held";

fn full_row() -> EstimateRow {
    EstimateRow {
        pose: Some(Pose::new(1.0, 2.0, 3.0)),
        twist: Some(Twist {
            vx: 4.0,
            vy: 5.0,
            omega: 6.0,
        }),
        friction: Some(Friction {
            mu_s: 0.1,
            mu_p: 0.2,
            mu_f: 0.3,
            d_tri: 0.4,
        }),
        contact_pusher: Some(0.5),
        contact_others: Some(vec![0.25, 0.75]),
        held: Some(0.125),
        spread: Some(Spread {
            pose: Pose::new(7.0, 8.0, 9.0),
            cross: Some(CrossCovariance {
                x_y: 1.5,
                x_theta: -2.5,
                y_theta: 3.5,
            }),
            friction: Some(Friction {
                mu_s: 0.5,
                mu_p: 0.6,
                mu_f: 0.7,
                d_tri: 0.8,
            }),
        }),
        ess: Some(250.5),
        resampled: Some(true),
        visual: false,
        unsolved: Some(3),
        failed: Some(1),
        slip: Some(slips([0.5, 0.0, 0.0, 0.0, 0.25, 0.0, 0.25, 0.0, 0.5])),
        distinct: Some(300),
        ancestors: Some(20),
        collapsed: Some(false),
        modes: Vec::new(),
    }
}

/// Of two fixels and the pusher before them.
fn slips(numbers: [f64; 9]) -> Vec<ContactSlip> {
    let slips = numbers.chunks(3).map(|of_body| ContactSlip {
        stick: of_body[0],
        left: of_body[1],
        right: of_body[2],
    });
    slips.collect()
}

/// The last cells of [`full_row`].
const BELIEF: &str = "0,300,20,,,,,,0.5,0,0,0,0.25,0,0.25,0,0.5,0.125";

fn estimate(rows: Vec<EstimateRow>, has_tripod: bool) -> Estimate {
    Estimate {
        time: (0..rows.len()).map(|row| row as f64).collect(),
        rows,
        others: 2,
        has_tripod,
    }
}

fn written(estimate: &Estimate) -> String {
    let mut bytes = Vec::new();
    write_estimate(&mut bytes, estimate).expect("memory takes everything");
    String::from_utf8(bytes).expect("text")
}

#[track_caller]
fn refused(text: &str, place: &str, words: &[&str]) {
    let message = read_estimate(text.as_bytes(), "estimate.csv")
        .expect_err("must be refused")
        .to_string();
    assert!(
        message.starts_with(&format!("estimate.csv:{place}: ")),
        "expected place {place}: {message}"
    );
    for word in words {
        assert!(message.contains(word), "expected `{word}`: {message}");
    }
}

#[test]
fn write_estimate_writes_the_contract() {
    let rows = vec![EstimateRow::default(), full_row()];
    let expected = format!(
        "{HEADER}\n0,,,,,,,,,,,,,,,,,,,,,,,0,,,,,{}\n1,1,2,3,4,5,6,0.1,0.2,0.3,0.4,0.5,0.25,0.75,7,8,9,0.5,0.6,0.7,0.8,250.5,1,0,3,1,1.5,-2.5,3.5,{BELIEF}\n",
        ",".repeat(18)
    );
    assert_eq!(written(&estimate(rows, true)), expected);
}

#[test]
fn known_feet_leave_the_d_tri_columns_empty() {
    let text = written(&estimate(vec![full_row()], false));
    assert_eq!(
        text.lines().nth(1),
        Some(
            format!("0,1,2,3,4,5,6,0.1,0.2,0.3,,0.5,0.25,0.75,7,8,9,0.5,0.6,0.7,,250.5,1,0,3,1,1.5,-2.5,3.5,{BELIEF}")
                .as_str()
        )
    );
    let back = read_estimate(text.as_bytes(), "estimate.csv").expect("an estimate");
    assert!(!back.has_tripod);
    assert_eq!(
        back.rows[0].friction,
        Some(Friction {
            mu_s: 0.1,
            mu_p: 0.2,
            mu_f: 0.3,
            d_tri: 0.0
        })
    );
}

#[test]
fn estimate_without_fixels_has_no_contact_columns() {
    let none = Estimate {
        time: vec![0.0],
        rows: vec![EstimateRow::default()],
        others: 0,
        has_tripod: true,
    };
    let text = written(&none);
    assert_eq!(
        text.lines().next(),
        Some(
            HEADER
                .replace("contact_1,contact_2,", "")
                .replace(",stick_1,left_1,right_1,stick_2,left_2,right_2", "")
                .as_str()
        )
    );
    assert_eq!(read_estimate(text.as_bytes(), "estimate.csv"), Ok(none));
}

#[test]
fn header_of_another_order_or_kind_is_refused() {
    let row = format!(
        "0,1,2,3,4,5,6,0.1,0.2,0.3,0.4,0.5,0.25,0.75,7,8,9,0.5,0.6,0.7,0.8,250.5,1,0,3,1,0,0,0,{BELIEF}"
    );
    refused(
        &format!(
            "{}\n{row}\n",
            HEADER.replace("x,y,theta,vx", "y,x,theta,vx")
        ),
        "1: column 2 (y)",
        &["`x` belongs here"],
    );
    refused(
        &format!("{}\n{row}\n", HEADER.replace(",ess", ",esss")),
        "1",
        &["`ess`", "missing", "`esss`"],
    );
    refused(
        &format!("{HEADER},more\n{row},0\n"),
        "1: column 48 (more)",
        &["no such column", "`p_held`"],
    );
    refused(
        &format!("{}\n{row}\n", HEADER.replace("contact_2", "contact_3")),
        "1",
        &["`contact_2`", "missing"],
    );
}

#[test]
fn bad_cells_are_refused() {
    let good = format!(
        "0,1,2,3,4,5,6,0.1,0.2,0.3,0.4,0.5,0.25,0.75,7,8,9,0.5,0.6,0.7,0.8,250.5,1,0,3,1,1.5,2.5,3.5,{BELIEF}"
    );
    let with = |from: &str, to: &str| format!("{HEADER}\n{}\n", good.replacen(from, to, 1));
    refused(&with("1,2,3", "1,,3"), "2: column 3 (y)", &["empty", "`x`"]);
    refused(
        &with("0.25", "nan"),
        "2: column 13 (contact_1)",
        &["`nan`", "not finite"],
    );
    refused(
        &with("1,0,3", "2,0,3"),
        "2: column 23 (resampled)",
        &["`2`", "neither 0 nor 1"],
    );
    refused(&with("1,0,3", "1,,3"), "2: column 24 (visual)", &["empty"]);
    refused(
        &with("1,0,3", "1,0,-3"),
        "2: column 25 (unsolved)",
        &["`-3`", "whole number"],
    );
    refused(
        &with(",0.8,", ",,"),
        "2: column 21 (std_d_tri)",
        &["empty", "known"],
    );
    refused(
        &with("1.5,2.5", "1.5,"),
        "2: column 28 (cov_x_theta)",
        &["empty"],
    );
    refused(
        &with("0,300,20", "3,300,20"),
        "2: column 30 (collapsed)",
        &["`3`", "neither 0 nor 1"],
    );
    refused(
        &with("0,300,20", "0,300,-20"),
        "2: column 32 (ancestors)",
        &["`-20`", "whole number"],
    );
    refused(
        &with("0.25,0,0.5", "0.25,,0.5"),
        "2: column 45 (left_2)",
        &["empty"],
    );
    refused(&with("7,8,9", ",,"), "2: column 15 (std_x)", &["empty"]);
    refused(&with("0.1,0.2,0.3", ",,"), "2: column 8 (mu_s)", &["empty"]);
    refused(
        &format!("{HEADER}\n{good}\n{good}\n"),
        "3: column 1 (time)",
        &["rise"],
    );
    refused(&format!("{HEADER}\n"), "1", &["no rows"]);
}

fn number() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("finite", |value| value.is_finite())
}

fn any_pose() -> impl Strategy<Value = Pose> {
    (number(), number(), number()).prop_map(|(x, y, theta)| Pose::new(x, y, theta))
}

fn any_cross() -> impl Strategy<Value = Option<CrossCovariance>> {
    let numbers = (number(), number(), number());
    prop::option::of(numbers.prop_map(|(x_y, x_theta, y_theta)| CrossCovariance {
        x_y,
        x_theta,
        y_theta,
    }))
}

fn any_friction() -> impl Strategy<Value = Option<Friction>> {
    prop::option::of((number(), number(), number(), number()).prop_map(
        |(mu_s, mu_p, mu_f, d_tri)| Friction {
            mu_s,
            mu_p,
            mu_f,
            d_tri,
        },
    ))
}

prop_compose! {
    fn any_row()(
        pose in prop::option::of(any_pose()),
        twist in prop::option::of(any_pose()),
        friction in any_friction(),
        contact_pusher in prop::option::of(number()),
        contact_others in prop::option::of(prop::collection::vec(number(), 2)),
        spread in prop::option::of((any_pose(), any_cross(), any_friction())),
        ess in prop::option::of(number()),
        (resampled, visual, unsolved, failed) in any::<(Option<bool>, bool, Option<u32>, Option<u32>)>(),
        (slip, held) in (prop::option::of(prop::array::uniform9(number())), prop::option::of(number())),
        (collapsed, distinct, ancestors) in any::<(Option<bool>, Option<u32>, Option<u32>)>(),
    ) -> EstimateRow {
        EstimateRow {
            pose,
            twist: twist.map(|t| Twist { vx: t.x, vy: t.y, omega: t.theta }),
            friction,
            contact_pusher,
            contact_others,
            held,
            spread: spread.map(|(pose, cross, friction)| Spread { pose, cross, friction }),
            ess,
            resampled,
            visual,
            unsolved,
            failed,
            slip: slip.map(slips),
            distinct,
            ancestors,
            collapsed,
            modes: Vec::new(),
        }
    }
}

#[test]
fn files_without_the_columns_that_came_later_are_read() {
    let estimate = estimate(vec![full_row()], true);
    let text = written(&estimate);
    let without = |columns: usize| {
        let cut = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            cells[..cells.len() - columns].join(",")
        };
        let earlier: Vec<_> = text.lines().map(cut).collect();
        read_estimate(earlier.join("\n").as_bytes(), "estimate.csv")
    };
    let belief = BELIEF.split(',').count();
    let row = without(belief).expect("sound");
    let row = &row.rows[0];
    assert_eq!(
        (row.failed, row.distinct, &row.slip),
        (Some(1), None, &None)
    );
    assert!(row.spread.expect("a spread").cross.is_some());
    for (columns, failed) in [(belief + 3, Some(1)), (belief + 4, None)] {
        let row = &without(columns).expect("sound").rows[0];
        assert_eq!((row.unsolved, row.failed), (Some(3), failed));
        let spread = row.spread.expect("a spread");
        assert_eq!((spread.pose.x, spread.cross), (7.0, None));
    }
    let row = &without(1).expect("sound").rows[0];
    assert_eq!((row.held, &row.slip), (None, &full_row().slip));
    // no version ended there
    for columns in [2, 3, belief - 1, belief + 1, belief + 2] {
        let error = without(columns).expect_err("must be refused").to_string();
        assert!(error.contains("missing"), "{error}");
    }
}

proptest! {
    #[test]
    fn written_estimate_reads_back(rows in prop::collection::vec(any_row(), 1..10)) {
        let estimate = estimate(rows, true);
        let back = read_estimate(written(&estimate).as_bytes(), "estimate.csv").map_err(|error| TestCaseError::fail(error.to_string()))?;
        prop_assert_eq!(back, estimate);
    }
}
