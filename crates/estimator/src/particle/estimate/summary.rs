//! Estimate of a particle set: weighted means and standard deviations of its columns, about the
//! pose that is published: [`summarise`].

use std::f64::consts::FRAC_PI_2;

use stickslip_dynamics::Pose;
use stickslip_filter::ParticleFilter;

use crate::estimate::{CrossCovariance, EstimateRow, Spread};
use crate::filter_model::FilterModel;
use crate::particle::estimate::geometric_median::way_to_median;
use crate::particle::estimate::sums::{ANGLE, Reference};
use crate::particle::model::ContactModel;

/// Writes weighted means and standard deviations, from sums about `reference`, to `row`. θ is the
/// angle nearest to that of the reference. The robust model publishes the pose at the least mean
/// distance from the particles, with its spread about that pose.
pub(crate) fn summarise(
    filter: &ParticleFilter<ContactModel<'_>>,
    reference: &Reference,
    row: &mut EstimateRow,
) {
    let sums = filter.sums();

    // position and friction, from deviations about the reference
    let means = reference.linear.zip(sums.first, |near, d| near + d);
    let variances = sums.second.zip(sums.first, |square, d| square - d * d);
    let stds = variances.map(|variance| variance.max(0.0).sqrt());

    // θ on the circle
    let turn = libm::atan2(sums.angle.sin, sums.angle.cos);
    let theta = reference.angle + turn;
    let theta_std = if sums.widest <= FRAC_PI_2 {
        sums.angle.std_about(turn)
    } else {
        filter.weighted_circular_std_about(theta, ANGLE)
    };

    // covariances of the errors: about the means of x and y, so that the mean of θ drops out
    let [x, y] = sums.first.position;
    let [x_y, x_theta, y_theta] = sums.cross;
    let cross = CrossCovariance {
        x_y: x_y - x * y,
        x_theta: x_theta - x * sums.angle.first,
        y_theta: y_theta - y * sums.angle.first,
    };

    let pose = |[x, y]: [f64; 2], theta: f64| Pose { x, y, theta };
    let mut spread = Spread {
        pose: pose(stds.position, theta_std),
        cross: Some(cross),
        friction: Some(stds.friction),
    };
    let mut published = pose(means.position, theta);
    if filter.model().columns().model() == FilterModel::Robust {
        let way = way_to_median(filter, published);
        published = Pose::new(
            published.x + way.x,
            published.y + way.y,
            published.theta + way.theta,
        );
        spread.move_centre(way);
        spread.add(unsettled(filter));
    }
    row.pose = Some(published);
    row.twist = Some(sums.twist);
    row.friction = Some(means.friction);
    row.spread = Some(spread);
    row.contact_pusher = Some(sums.contact_pusher);
    row.held = Some(sums.held);
    row.contact_others
        .get_or_insert_default()
        .clone_from(&sums.contact_others);
    row.slip.get_or_insert_default().clone_from(&sums.slips);
    row.unsolved = Some(sums.unsolved as u32);
    row.failed = Some(sums.failed as u32);
    row.ess = Some(filter.weights().effective_sample_size());
}

/// Standard deviations of the camera's errors that poses of the present kind do not average out.
fn unsettled(filter: &ParticleFilter<ContactModel<'_>>) -> Pose {
    let first = filter.model().columns().camera_noise();
    let noise = [0, 1, 2].map(|k| filter.expectation(first + k, |number| number));
    filter.model().camera_likelihood().unsettled(noise)
}
