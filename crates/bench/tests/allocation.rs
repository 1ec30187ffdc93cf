//! After warm-up, a step of a block allocates nothing.

use stickslip_bench::{Batch, FRAMES, timing_input, timing_scene};
use stickslip_dynamics::Dynamics;

#[test]
fn step_block_allocates_nothing_after_warm_up() {
    let dynamics = Dynamics::new(timing_scene().unwrap());
    let mut batch = Batch::scattered(&dynamics, 1);
    // from here on two fixels and the pusher have touched
    let warm = 180;
    (0..warm).for_each(|frame| {
        batch.step(&dynamics, &timing_input(frame));
    });
    let start = batch.clone();
    let info = allocation_counter::measure(|| {
        (warm..FRAMES).for_each(|frame| {
            batch.step(&dynamics, &timing_input(frame));
        });
    });
    assert_eq!(info.count_total, 0, "{info:?}");
    // the counter sees what the step does: cold working memory has to grow
    let cold = allocation_counter::measure(|| {
        Batch::scattered(&dynamics, 1).step(&dynamics, &timing_input(0));
    });
    assert!(cold.count_total > 0 && start.first() != batch.first());
}
