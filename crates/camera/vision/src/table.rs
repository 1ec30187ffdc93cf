//! Pose of the table relative to a camera whose lens is known: [`find_table`].

use nalgebra::{SMatrix, Vector2};

use crate::board::BoardOnTable;
use crate::board_recording::BoardRecording;
use crate::bundle::{RULES, View, ViewEquations, damped};
use crate::calibrate::{board_tags, matches_of, without_outliers, world_to_camera};
use crate::calibration_error::{CalibrationError, FEWEST_TAGS, WORST_MISFIT};
use crate::camera::Camera;
use crate::homography::{Match, homography, plane_motion};
use crate::lens::Lens;
use crate::levenberg_marquardt::{LeastSquares, Minimum, Step, minimise};

/// A camera whose table was found, and the uncertainty of its pose for the given lens.
#[derive(Clone, Debug, PartialEq)]
pub struct TableFit {
    /// The camera.
    pub camera: Camera,
    /// Root mean square misfit of a corner's coordinate (px).
    pub rms: f64,
    /// Tags that were used.
    pub tags: usize,
    /// Tags that were left out because no lines fit their border, or because they do not fit the
    /// rest.
    pub left_out: usize,
    /// Standard deviations of the table's turn about the camera's axes x, y, z (rad).
    pub rotation_std: [f64; 3],
    /// Standard deviations of its place along them (m).
    pub translation_std: [f64; 3],
}

/// Finds the table from a frame of a board that lies on it, the first of `recording`, through a
/// lens that is known.
///
/// # Errors
/// [`CalibrationError`]: no tags, those of another board, too few, a frame of another size than the
/// lens's, a board that does not fit.
///
/// # Panics
/// If the recording has no frame.
pub fn find_table(
    recording: &BoardRecording,
    board: &BoardOnTable,
    lens: &Lens,
) -> Result<TableFit, CalibrationError> {
    let BoardRecording { frames, size } = recording;
    let name = || frames[0].name.clone();
    if *size != lens.size {
        let text = |[columns, rows]: [u32; 2]| format!("{columns} x {rows}");
        return Err(CalibrationError::LensSize {
            name: name(),
            found: text(*size),
            expected: text(lens.size),
        });
    }
    let tags = board_tags(&frames[..1], board)?.remove(0);
    let matches = matches_of(&tags, board, lens);
    if matches.len() < 4 * FEWEST_TAGS {
        return Err(CalibrationError::FlatFrame {
            name: name(),
            found: matches.len() / 4,
        });
    }
    let nowhere = || CalibrationError::NoPlace { name: name() };
    let first = first_view(matches, lens).ok_or_else(nowhere)?;
    let placed = Placed { lens, view: first }.fit().ok_or_else(nowhere)?;
    let view = without_outliers(placed.view, lens, placed.rms);
    let placed = Placed { lens, view }.fit().ok_or_else(nowhere)?;
    if placed.rms.is_nan() || placed.rms > WORST_MISFIT {
        return Err(CalibrationError::Misfit { rms: placed.rms });
    }
    let used = placed.view.matches.len() / 4;
    let std = |k: usize| placed.covariance[(k, k)].sqrt();
    Ok(TableFit {
        camera: Camera::new(*lens, world_to_camera(&placed.view, board)),
        rms: placed.rms,
        tags: used,
        left_out: tags.len() - used,
        rotation_std: [0, 1, 2].map(std),
        translation_std: [3, 4, 5].map(std),
    })
}

/// The view by the projective map from the plane to directions.
fn first_view(matches: Vec<Match>, lens: &Lens) -> Option<View> {
    let direction = |(point, seen): &Match| {
        let ideal = lens.undistort((*seen).into())?;
        Some((*point, lens.direction(Vector2::from(ideal))))
    };
    let directions: Vec<Match> = matches.iter().map(direction).collect::<Option<_>>()?;
    Some(View {
        motion: plane_motion(homography(&directions)?)?,
        matches,
    })
}

/// A plane seen through a lens that stays as it is.
struct Placed<'l> {
    lens: &'l Lens,
    view: View,
}

/// Best fit of the plane.
struct Fit {
    view: View,
    rms: f64,
    covariance: SMatrix<f64, 6, 6>,
}

impl Placed<'_> {
    fn fit(self) -> Option<Fit> {
        let Minimum { at, equations, .. } = minimise(self, &RULES)?;
        let free = (2 * at.view.matches.len()).checked_sub(6);
        let free = free.filter(|free| *free > 0)?;
        let variance = equations.squares / free as f64;
        let covariance = equations.view.cholesky()?.inverse() * variance;
        Some(Fit {
            view: at.view,
            rms: variance.sqrt(),
            covariance,
        })
    }
}

impl LeastSquares for Placed<'_> {
    type Equations = ViewEquations;

    /// `None` where a point is behind the camera.
    fn equations(&self) -> Option<ViewEquations> {
        self.view.equations(self.lens)
    }

    fn squares(equations: &ViewEquations) -> f64 {
        equations.squares
    }

    fn step(&self, equations: &ViewEquations, damping: f64) -> Option<Step<Self>> {
        let by = damped(equations.view, damping)
            .cholesky()?
            .solve(&equations.view_gradient);
        Some(Step::To(Self {
            lens: self.lens,
            view: self.view.moved(&by),
        }))
    }
}
