//! Steps re-simulated with other random numbers, and the evidence of the two sets together.

use stickslip_filter::{
    Block, BlockMut, Draw, Model, ParticleFilter, Pool, Settings, WeightedSums,
};

/// A bifurcation: the first step leads a particle to 1 with probability [`RIGHT`], else to 0, for
/// good. An observation o says that ln L is o at 0, and 0 at 1.
struct Fork;

const RIGHT: f64 = 0.01;

#[derive(Default)]
struct Mean(f64);

impl WeightedSums for Mean {
    fn clear(&mut self) {
        self.0 = 0.0;
    }
    fn add(&mut self, other: &Self, scale: f64) {
        self.0 += scale * other.0;
    }
}

impl Model for Fork {
    /// True if the particles take a branch in this step.
    type Input = bool;
    type Observation = f64;
    type Scratch = ();
    type Sums = Mean;

    fn columns(&self) -> usize {
        1
    }
    fn scratch(&self) {}
    fn initialise(&self, _: Draw, _: &mut BlockMut<'_>) {}
    fn propagate(&self, fork: &bool, draw: Draw, block: &mut BlockMut<'_>, (): &mut ()) {
        for (i, particle) in block.particles().collect::<Vec<_>>() {
            if *fork {
                let right = draw.uniform(particle, 0) < RIGHT;
                block.column_mut(0)[i] = f64::from(u8::from(right));
            }
        }
    }
    fn log_likelihood(&self, observation: &f64, block: &Block<'_>, out: &mut [f64]) {
        for (out, place) in out.iter_mut().zip(block.column(0)) {
            *out = observation * (1.0 - place);
        }
    }
    fn sum(&self, _: &bool, block: &Block<'_>, weights: &[f64], mean: &mut Mean) {
        let places = block.column(0).iter().zip(weights);
        mean.0 = places.map(|(place, weight)| place * weight).sum();
    }
    fn reinitialise(&self, _: &f64, _: Draw, _: &mut BlockMut<'_>) {}
}

const ROWS: [(bool, f64); 3] = [(true, -1.0), (false, -2.0), (false, -1.0)];

/// [`ROWS`] by three sets of particles.
struct Thrice {
    evidences: [f64; 3],
    /// The mean place after all.
    place: f64,
}

impl Thrice {
    fn mean_evidence(&self) -> f64 {
        self.evidences.iter().sum::<f64>() / 3.0
    }
}

fn thrice(seed: u64, particles: usize) -> Thrice {
    let settings = Settings {
        particles,
        seed,
        ..Settings::default()
    };
    let mut filter = ParticleFilter::new(Fork, settings).expect("settings");
    let checkpoint = filter.checkpoint();
    let mut log_evidence = 0.0;
    for (fork, observation) in &ROWS {
        let report = filter.step(fork, Some(observation));
        let stickslip_filter::WeightUpdate::Weighed {
            log_evidence: of_row,
        } = report.weight_update
        else {
            panic!("{report:?}")
        };
        log_evidence += of_row;
    }
    let mut pool = Pool::of_one(log_evidence);
    let mut evidences = [libm::exp(log_evidence); 3];
    for attempt in 1..3 {
        let rows = ROWS
            .iter()
            .map(|(fork, observation)| (fork, Some(observation)));
        let tried = filter.try_again(&checkpoint, rows, pool, attempt);
        evidences[attempt as usize] = libm::exp(tried.log_evidence);
        pool = tried.pool;
    }
    assert_eq!(filter.steps(), ROWS.len() as u64);
    let thrice = Thrice {
        evidences,
        place: filter.sums().0,
    };
    let (mean, pooled) = (thrice.mean_evidence(), libm::exp(pool.log_evidence));
    assert!(
        (pooled / mean - 1.0).abs() < 1e-12,
        "{evidences:?}, {pooled}"
    );
    thrice
}

#[test]
fn the_mean_of_all_evidences_is_the_likelihood_and_their_shares_bayes_rule() {
    let exact = RIGHT + (1.0 - RIGHT) * libm::exp(-4.0);
    let runs: Vec<Thrice> = (0..400).map(|seed| thrice(seed, 64)).collect();
    let mean = |of: &dyn Fn(&Thrice) -> f64| runs.iter().map(of).sum::<f64>() / runs.len() as f64;
    // the evidence of a particle filter has no bias, nor have all; tries are independent
    let evidence = mean(&Thrice::mean_evidence);
    assert!((evidence / exact - 1.0).abs() < 0.08, "{evidence}, {exact}");
    for (j, k) in [(0, 1), (1, 2), (0, 2)] {
        let [first, second] = [j, k].map(|set| mean(&|run| run.evidences[set]));
        let product = mean(&|run| (run.evidences[j] - first) * (run.evidences[k] - second));
        assert!(product.abs() < 0.1 * exact * exact, "{j}, {k}: {product}");
    }
    // weighed by the evidence, as tries are, the place is the posterior's
    let right = mean(&|run| run.mean_evidence() * run.place) / evidence;
    let posterior = RIGHT / exact;
    assert!((right - posterior).abs() < 0.05, "{right}, {posterior}");
}

#[test]
fn a_set_that_went_the_wrong_way_is_replaced_by_one_that_did_not() {
    // e^-40 of the evidence on the wrong way: whoever has one particle on the right one, wins
    let settings = Settings {
        particles: 64,
        seed: 3,
        ..Settings::default()
    };
    let mut filter = ParticleFilter::new(Fork, settings).expect("settings");
    let checkpoint = filter.checkpoint();
    let _ = filter.step(&true, Some(&-40.0));
    let mut pool = Pool::of_one(if filter.sums().0 > 0.0 { -4.0 } else { -40.0 });
    let mut attempt = 0;
    while filter.sums().0 < 0.5 && attempt < 20 {
        attempt += 1;
        let row = [(&true, Some(&-40.0))];
        let tried = filter.try_again(&checkpoint, row.into_iter(), pool, attempt);
        pool = tried.pool;
    }
    assert!(
        filter.sums().0 > 0.999,
        "after {attempt}: {}",
        filter.sums().0
    );
    let places: Vec<f64> = filter.particles().column(0).collect();
    assert!(places.iter().all(|place| *place == 1.0), "{places:?}");
    assert!(attempt > 0, "the first set had it: choose another seed");
}

#[test]
fn a_try_is_given_up_where_its_evidence_falls_below_a_share_that_no_particle_would_get() {
    // both rows together say nothing; a set whose first row falls too far makes no second one
    let share_after = |fall: f64| {
        let settings = Settings {
            particles: 64,
            ..Settings::default()
        };
        let mut filter = ParticleFilter::new(Fork, settings).expect("settings");
        let checkpoint = filter.checkpoint();
        let rows = [(&false, Some(&-fall)), (&false, Some(&fall))];
        for (input, observation) in rows {
            let _ = filter.step(input, observation);
        }
        let tried = filter.try_again(&checkpoint, rows.into_iter(), Pool::of_one(0.0), 1);
        assert_eq!((filter.steps(), tried.pool.sets), (2, 2));
        assert_eq!(filter.weights().weights(), [1.0 / 64.0; 64]);
        (tried.share, tried.log_evidence)
    };
    let (share, log_evidence) = share_after(49.0);
    assert!((share - 0.5).abs() < 1e-12 && log_evidence.abs() < 1e-12);
    assert_eq!(share_after(51.0), (0.0, f64::NEG_INFINITY));
}
