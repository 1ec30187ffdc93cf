//! From frames of a tag board to a calibrated camera: [`calibrate`].
//!
//! Homographies give a first focal length and first poses (Zhang 2000); bundle adjustment over all
//! frames gives the rest. Corners are first fitted as if the lens had no distortion, then twice
//! more in the image undistorted by the lens found so far.

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::board::BoardOnTable;
use crate::board_recording::{BoardRecording, CalibrationFrame};
use crate::bundle::{Adjusted, Bundle, View};
use crate::calibration_error::{CalibrationError, FEWEST_FRAMES, FEWEST_TAGS, WORST_MISFIT};
use crate::camera::Camera;
use crate::detector::FoundTag;
use crate::homography::{Match, focal_length, homography, plane_motion};
use crate::lens::Lens;
use crate::motion::Motion;

/// Times that corners are refitted with the lens found so far.
const ROUNDS: usize = 2;
/// A tag with a corner this many times the mean misfit off is left out.
const OUTLIER: f64 = 6.0;
/// Views whose corners are nearer than this on the mean are one view (px).
const SAME_VIEW: f64 = 3.0;
/// Largest relative standard deviation of the focal length.
const FOCAL_STD: f64 = 0.005;

/// A calibrated camera, and how well it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The camera.
    pub camera: Camera,
    /// Root mean square misfit of a corner's coordinate (px).
    pub rms: f64,
    /// Frames that were used.
    pub frames: usize,
    /// Tags in them that were used.
    pub tags: usize,
    /// Tags that were left out because no lines fit their border, or because they do not fit the
    /// rest.
    pub left_out: usize,
    /// Standard deviations of the lens's numbers fx, fy, cx, cy (px), k1, k2, p1, p2.
    pub lens_std: [f64; 8],
}

/// The board in one frame.
struct BoardView<'a> {
    /// Number of the frame.
    frame: usize,
    /// The board's tags in it.
    tags: &'a [&'a FoundTag],
    /// Corners on the board and where they are seen, four per tag.
    matches: Vec<Match>,
}

const NO_TILT: CalibrationError = CalibrationError::NoTilt { relative_std: None };

/// Calibrates a camera from frames of a board; in frame number `flat` the board lies on the table
/// as `board` says.
///
/// # Errors
/// [`CalibrationError`]: no tags, those of another board, too few frames, none tilted, or a board
/// that does not fit.
///
/// # Panics
/// If `flat` is not the number of a frame.
pub fn calibrate(
    recording: &BoardRecording,
    board: &BoardOnTable,
    flat: usize,
) -> Result<Calibration, CalibrationError> {
    let BoardRecording { frames, size } = recording;
    let on_board = board_tags(frames, board)?;
    let views = board_views(&on_board, board, *size);
    let (views, flat_view) = usable_views(views, frames, flat)?;

    // first guesses from homographies, then all numbers together
    let first = first_bundle(views.iter().map(|view| view.matches.as_slice()), *size);
    let mut adjusted = first.and_then(Bundle::adjust).ok_or(NO_TILT)?;

    // corners refitted with the lens found so far
    for _ in 0..ROUNDS {
        adjusted = refitted(&adjusted, &views, board).adjust().ok_or(NO_TILT)?;
    }
    check(&adjusted)?;
    check_distinct(&views)?;

    let bundle = &adjusted.bundle;
    let tags = bundle.views.iter().map(|view| view.matches.len() / 4).sum();
    let offered = views.iter().map(|view| view.tags.len()).sum::<usize>();
    let to_camera = world_to_camera(&bundle.views[flat_view], board);
    Ok(Calibration {
        camera: Camera::new(bundle.lens, to_camera),
        rms: adjusted.rms,
        frames: views.len(),
        tags,
        left_out: offered - tags,
        lens_std: adjusted.lens_std,
    })
}

/// The board's tags in every frame, corners fitted as if the lens had no distortion.
fn board_views<'a>(
    on_board: &'a [Vec<&'a FoundTag>],
    board: &BoardOnTable,
    size: [u32; 2],
) -> Vec<BoardView<'a>> {
    let straight = Lens::pinhole(size, f64::from(size[0].max(size[1])));
    let view = |(frame, tags): (usize, &'a Vec<&'a FoundTag>)| BoardView {
        frame,
        tags,
        matches: matches_of(tags, board, &straight),
    };
    on_board.iter().enumerate().map(view).collect()
}

/// The views with enough tags, and which of them is that of frame `flat`.
fn usable_views<'a>(
    views: Vec<BoardView<'a>>,
    frames: &[CalibrationFrame],
    flat: usize,
) -> Result<(Vec<BoardView<'a>>, usize), CalibrationError> {
    let flat_frame = CalibrationError::FlatFrame {
        name: frames[flat].name.clone(),
        found: views[flat].matches.len() / 4,
    };
    let usable: Vec<BoardView<'a>> = views
        .into_iter()
        .filter(|view| view.matches.len() >= 4 * FEWEST_TAGS)
        .collect();
    let flat_view = usable.iter().position(|view| view.frame == flat);
    let flat_view = flat_view.ok_or(flat_frame)?;
    if usable.len() < FEWEST_FRAMES {
        return Err(CalibrationError::TooFewFrames {
            usable: usable.len(),
            frames: frames.len(),
        });
    }
    Ok((usable, flat_view))
}

/// The bundle with corners fitted in the image that its lens straightens, without outliers.
fn refitted(adjusted: &Adjusted, views: &[BoardView<'_>], board: &BoardOnTable) -> Bundle {
    let lens = adjusted.bundle.lens;
    let refit = |(view, board_view): (&View, &BoardView<'_>)| {
        let view = View {
            matches: matches_of(board_view.tags, board, &lens),
            motion: view.motion,
        };
        without_outliers(view, &lens, adjusted.rms)
    };
    Bundle {
        lens,
        views: adjusted.bundle.views.iter().zip(views).map(refit).collect(),
    }
}

/// Refuses a bundle that does not fit, or that leaves the focal length open.
fn check(adjusted: &Adjusted) -> Result<(), CalibrationError> {
    if adjusted.rms > WORST_MISFIT {
        return Err(CalibrationError::Misfit { rms: adjusted.rms });
    }
    let (std, focal) = (adjusted.lens_std, adjusted.bundle.lens.focal);
    let relative_std = (std[0] / focal[0]).max(std[1] / focal[1]);
    if relative_std.is_nan() || relative_std > FOCAL_STD {
        let relative_std = Some(relative_std);
        return Err(CalibrationError::NoTilt { relative_std });
    }
    Ok(())
}

/// Refuses copies of few views: each makes the numbers seem better known, and none adds
/// information.
fn check_distinct(views: &[BoardView<'_>]) -> Result<(), CalibrationError> {
    let mut distinct: Vec<&BoardView<'_>> = Vec::new();
    for view in views {
        if !distinct.iter().any(|other| moved(view, other) < SAME_VIEW) {
            distinct.push(view);
        }
    }
    if distinct.len() < FEWEST_FRAMES {
        return Err(CalibrationError::SameViews {
            distinct: distinct.len(),
            frames: views.len(),
        });
    }
    Ok(())
}

/// Mean distance (px) of the corners that two views share; infinite where they share none.
fn moved(a: &BoardView<'_>, b: &BoardView<'_>) -> f64 {
    let shared = a.tags.iter().filter_map(|tag| {
        let other = b.tags.iter().find(|other| other.id == tag.id)?;
        let corners = tag.corners().into_iter().zip(other.corners());
        Some(
            corners
                .map(|([x, y], [u, v])| libm::hypot(x - u, y - v))
                .sum::<f64>()
                / 4.0,
        )
    });
    let shared: Vec<f64> = shared.collect();
    match shared.len() {
        0 => f64::INFINITY,
        count => shared.iter().sum::<f64>() / count as f64,
    }
}

/// The board's tags in each frame, but for those that are there twice.
pub(crate) fn board_tags<'a>(
    frames: &'a [CalibrationFrame],
    board: &BoardOnTable,
) -> Result<Vec<Vec<&'a FoundTag>>, CalibrationError> {
    let mut found: Vec<u16> = frames
        .iter()
        .flat_map(|frame| frame.tags.iter().map(|tag| tag.id))
        .collect();
    found.sort_unstable();
    found.dedup();
    let range = board.board.tags();
    if found.is_empty() {
        return Err(CalibrationError::NoTag {
            frames: frames.len(),
        });
    }
    if !found.iter().any(|id| range.contains(id)) {
        let found = found
            .iter()
            .map(u16::to_string)
            .collect::<Vec<_>>()
            .join(", ");
        return Err(CalibrationError::ForeignTags {
            from: range.start,
            to: range.end - 1,
            found,
        });
    }
    let once = |frame: &'a CalibrationFrame| {
        let count = |id: u16| frame.tags.iter().filter(|tag| tag.id == id).count();
        frame
            .tags
            .iter()
            .filter(|tag| range.contains(&tag.id) && count(tag.id) == 1)
            .collect()
    };
    Ok(frames.iter().map(once).collect())
}

/// Corners fitted in the image that `lens` straightens, and where they are seen through it.
pub(crate) fn matches_of(tags: &[&FoundTag], board: &BoardOnTable, lens: &Lens) -> Vec<Match> {
    let of_tag = |tag: &&FoundTag| -> Option<[Match; 4]> {
        let on_board = board.board.corners(tag.id)?;
        let square = tag.outline.fit(lens)?;
        Some(std::array::from_fn(|k| {
            (
                on_board[k].into(),
                lens.distort(square.corners[k].into()).into(),
            )
        }))
    };
    tags.iter().filter_map(of_tag).flatten().collect()
}

fn first_bundle<'a>(
    views: impl Iterator<Item = &'a [Match]> + Clone,
    size: [u32; 2],
) -> Option<Bundle> {
    let centre = Lens::pinhole(size, 1.0).centre;
    let maps: Vec<Matrix3<f64>> = views.clone().map(homography).collect::<Option<_>>()?;
    let lens = Lens::pinhole(size, focal_length(&maps, Vector2::from(centre))?);
    let to_direction = Matrix3::new(
        1.0,
        0.0,
        -centre[0],
        0.0,
        1.0,
        -centre[1],
        0.0,
        0.0,
        lens.focal[0],
    ) / lens.focal[0];
    let view = |(map, matches): (&Matrix3<f64>, &[Match])| {
        Some(View {
            motion: plane_motion(to_direction * map)?,
            matches: matches.to_vec(),
        })
    };
    Some(Bundle {
        lens,
        views: maps.iter().zip(views).map(view).collect::<Option<_>>()?,
    })
}

/// The view without tags that have a corner far off.
pub(crate) fn without_outliers(view: View, lens: &Lens, rms: f64) -> View {
    let Some(misfits) = view.misfits(lens) else {
        return view;
    };
    let good = |tag: &(&[Match], &[Vector2<f64>])| {
        tag.1.iter().all(|misfit| misfit.amax() < OUTLIER * rms)
    };
    let kept: Vec<Match> = view
        .matches
        .chunks(4)
        .zip(misfits.chunks(4))
        .filter(good)
        .flat_map(|(tag, _)| tag.to_vec())
        .collect();
    // a frame that fits nowhere tells of a wrong board, not of outliers
    if kept.len() < 4 * FEWEST_TAGS {
        view
    } else {
        View {
            matches: kept,
            ..view
        }
    }
}

pub(crate) fn world_to_camera(flat: &View, board: &BoardOnTable) -> Motion {
    let to_world = Motion::planar(
        board.pose.theta,
        Vector3::new(board.pose.x, board.pose.y, board.thickness),
    );
    flat.motion.after(&to_world.inverse())
}
