//! The estimator on scenes whose answer is known.

mod belief;
mod common;
mod contact_mode;
mod creep;
mod diagnosis;
mod extended_kalman;
mod fast_pusher;
mod friction_parameters;
mod jam;
mod known_friction;
mod moved_unseen;
mod particle_view;
mod pose_covariance;
mod prior_sample;
mod random_force;
mod refused;
mod rivals;
mod rows;
mod support;
mod tactile;
mod track;
mod tracker;
mod turned_table;
mod unseen_pusher;
mod wrapped_angles;
