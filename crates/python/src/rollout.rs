//! Many pushes at once, on NumPy arrays: [`rollout`].

use numpy::{
    PyArray1, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyReadwriteArray3,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use stickslip_dynamics::{
    Dynamics, Friction, Pose, ROLLOUT_BLOCK, RolloutArrays, RolloutEnd, RolloutError, RolloutStart,
    RolloutWork, Twist,
};

use crate::error::refused;
use crate::given::Given;
use crate::long_call::{Watch, long_call};
use crate::scene::Scene;
use crate::threads::Threads;

/// Numbers of a pose or twist, as arrays hold them.
type Numbers = [f64; 3];

/// Step (s), threads and arrays of a rollout, in C order; the motion is written into the last two.
///
/// states (N, 6), friction (N, 4), pushers (N, T + 1, 3 F) or (1, T + 1, 3 F) for all, with F
/// fingers, poses and twists (N, T + 1, 3).
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Arguments<'py> {
    h: f64,
    threads: Option<usize>,
    states: PyReadonlyArray2<'py, f64>,
    friction: PyReadonlyArray2<'py, f64>,
    pushers: PyReadonlyArray3<'py, f64>,
    poses: PyReadwriteArray3<'py, f64>,
    twists: PyReadwriteArray3<'py, f64>,
}

/// Simulates the trajectories into the given arrays; returns how they ended, (N,) or (N, 2) each.
#[pyfunction]
#[pyo3(signature = (scene, arguments, progress = None))]
pub fn rollout<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    arguments: Given<Arguments<'py>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut arrays = arguments.0;
    let (dynamics, h) = (&scene.get().dynamics, arrays.h);
    let fingers = dynamics.scene().pusher.fingers.len();
    let rows = arrays.check(fingers)?;
    let states = arrays.states.as_slice()?.as_chunks::<6>().0;
    let friction = arrays.friction.as_slice()?.as_chunks::<4>().0;
    let pushers = arrays.pushers.as_slice()?.as_chunks::<3>().0;
    let poses = arrays.poses.as_slice_mut()?.as_chunks_mut::<3>().0;
    let twists = arrays.twists.as_slice_mut()?.as_chunks_mut::<3>().0;

    // blocks of trajectories, each with its part of every array
    let shared = pushers.len() == rows * fingers;
    let blocks = states
        .par_chunks(ROLLOUT_BLOCK)
        .zip(friction.par_chunks(ROLLOUT_BLOCK))
        .zip(poses.par_chunks_mut(ROLLOUT_BLOCK * rows))
        .zip(twists.par_chunks_mut(ROLLOUT_BLOCK * rows))
        .enumerate();
    let threads = Threads {
        asked: arrays.threads,
        useful: states.len().div_ceil(ROLLOUT_BLOCK),
    };
    let count = states.len() as u64;
    let simulate =
        |watch: &Watch, work: &mut RolloutWork, (block, (((states, friction), poses), twists))| {
            let first = block * ROLLOUT_BLOCK;
            let block = Block {
                rows,
                fingers,
                pushers: if shared {
                    pushers
                } else {
                    &pushers[first * rows * fingers..]
                },
                shared,
                poses,
                twists,
                ends: [RolloutEnd::default(); ROLLOUT_BLOCK],
                watch,
            };
            let ends = block.simulate(dynamics, h, states, friction, work);
            watch.add(states.len() as u64);
            ends.map_err(|error| placed(error, first))
        };
    let results = long_call(py, threads, progress, |watch| {
        watch.show(0, count);
        blocks
            .map_init(RolloutWork::default, |work, block| {
                simulate(watch, work, block)
            })
            .collect::<Vec<_>>()
    })?;
    let ends: Vec<_> = results
        .into_iter()
        .collect::<Result<_, _>>()
        .map_err(refused)?;
    let mut ends = ends.concat();
    ends.truncate(states.len());
    to_dict(py, &ends)
}

/// Ends of trajectories, as arrays.
fn to_dict<'py>(py: Python<'py>, ends: &[RolloutEnd]) -> PyResult<Bound<'py, PyDict>> {
    let lags = PyArray1::from_iter(py, ends.iter().flat_map(|end| end.pusher_lag));
    let most = PyArray1::from_iter(py, ends.iter().map(|end| end.most_pusher_lag));
    let dict = PyDict::new(py);
    dict.set_item(
        "unsolved",
        PyArray1::from_iter(py, ends.iter().map(|end| end.unsolved)),
    )?;
    dict.set_item("pusher_lag", lags.reshape([ends.len(), 2])?)?;
    dict.set_item("most_pusher_lag", most)?;
    Ok(dict)
}

impl Arguments<'_> {
    /// T + 1, where the arrays go together; the package makes them so.
    fn check(&self, fingers: usize) -> PyResult<usize> {
        let (states, pushers) = (self.states.shape(), self.pushers.shape());
        let (count, rows) = (states[0], pushers[1]);
        let of = [count, rows, 3];
        let right = states[1] == 6
            && self.friction.shape() == [count, 4]
            && pushers[2] == 3 * fingers
            && [1, count].contains(&pushers[0])
            && self.poses.shape() == of
            && self.twists.shape() == of;
        if right && rows > 1 {
            Ok(rows)
        } else {
            Err(refused("the arrays of a rollout do not go together"))
        }
    }
}

/// An error of a block whose first trajectory has this number.
fn placed(error: RolloutError, first: usize) -> RolloutError {
    match error {
        RolloutError::NotFinite {
            what,
            index,
            trajectory,
        } => RolloutError::NotFinite {
            what,
            index,
            trajectory: first + trajectory,
        },
        other => other,
    }
}

/// Some trajectories' parts of the arrays.
struct Block<'a> {
    rows: usize,
    fingers: usize,
    pushers: &'a [Numbers],
    /// True if all trajectories have one pusher.
    shared: bool,
    poses: &'a mut [Numbers],
    twists: &'a mut [Numbers],
    /// Ends of the trajectories; those past the last trajectory mean nothing.
    ends: [RolloutEnd; ROLLOUT_BLOCK],
    watch: &'a Watch,
}

impl Block<'_> {
    fn simulate(
        mut self,
        dynamics: &Dynamics,
        h: f64,
        states: &[[f64; 6]],
        friction: &[[f64; 4]],
        work: &mut RolloutWork,
    ) -> Result<[RolloutEnd; ROLLOUT_BLOCK], RolloutError> {
        let start = |(state, friction): (&[f64; 6], &[f64; 4])| {
            let [x, y, theta, vx, vy, omega] = *state;
            let [mu_s, mu_p, mu_f, d_tri] = *friction;
            RolloutStart {
                pose: Pose::new(x, y, theta),
                twist: Twist { vx, vy, omega },
                friction: Friction {
                    mu_s,
                    mu_p,
                    mu_f,
                    d_tri,
                },
            }
        };
        let starts: Vec<RolloutStart> = states.iter().zip(friction).map(start).collect();
        dynamics.rollout_into(h, self.rows - 1, &starts, &mut self, work)?;
        Ok(self.ends)
    }
}

impl RolloutArrays for Block<'_> {
    fn finger(&self, trajectory: usize, row: usize, finger: usize) -> Pose {
        self.watch.check();
        let first = if self.shared {
            0
        } else {
            trajectory * self.rows
        };
        let [x, y, theta] = self.pushers[(first + row) * self.fingers + finger];
        Pose::new(x, y, theta)
    }

    fn keep(&mut self, trajectory: usize, row: usize, pose: Pose, twist: Twist) {
        let at = trajectory * self.rows + row;
        self.poses[at] = [pose.x, pose.y, pose.theta];
        self.twists[at] = [twist.vx, twist.vy, twist.omega];
    }

    fn keep_end(&mut self, trajectory: usize, end: RolloutEnd) {
        self.ends[trajectory] = end;
    }
}
