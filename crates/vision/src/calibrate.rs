//! From frames of a tag board to a calibrated camera: [`calibrate`].
//!
//! Homographies give a first focal length and first poses (Zhang 2000), a bundle over all frames
//! the rest. Corners are first fitted as if edges were straight in the image, then twice more in
//! the image that the lens found so far straightens.

use image::GrayImage;
use nalgebra::{Matrix3, Vector2, Vector3};
use rayon::prelude::*;

use crate::board::BoardOnTable;
use crate::bundle::{Adjusted, Bundle, View};
use crate::camera::Camera;
use crate::detector::{Detector, FoundTag};
use crate::homography::{Match, focal_length, homography, plane_motion};
use crate::lens::Lens;
use crate::motion::Motion;

/// Fewest of the board's tags that make a frame usable.
const FEWEST_TAGS: usize = 4;
/// Fewest usable frames.
const FEWEST_FRAMES: usize = 4;
/// Times that corners are fitted anew with the lens found so far.
const ROUNDS: usize = 2;
/// A tag with a corner this many times the mean misfit off is left out.
const OUTLIER: f64 = 6.0;
/// Largest relative standard deviation of the focal length.
const FOCAL_STD: f64 = 0.005;
/// Largest mean misfit (px).
const WORST_MISFIT: f64 = 1.0;

/// A frame of the board.
#[derive(Clone, Debug)]
pub struct CalibrationFrame {
    /// Display name.
    pub name: String,
    /// The tags in it.
    pub tags: Vec<FoundTag>,
}

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
    /// Tags that were left out since they fit the rest badly, or their border no lines.
    pub left_out: usize,
    /// Standard deviations of the lens's numbers fx, fy, cx, cy (px), k1, k2, p1, p2.
    pub lens_std: [f64; 8],
}

/// Frames of one size, searched for tags.
#[derive(Clone, Debug)]
pub struct BoardRecording {
    /// The frames.
    pub frames: Vec<CalibrationFrame>,
    /// Their columns and rows.
    pub size: [u32; 2],
}

/// Why a calibration was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// Frames of several sizes.
    #[error(
        "{name}: the image has {found} pixels, {first} has {expected}; all frames of a calibration have one size. Take the odd ones out"
    )]
    Size {
        /// The frame.
        name: String,
        /// Its columns x rows.
        found: String,
        /// The first frame.
        first: String,
        /// Its columns x rows.
        expected: String,
    },
    /// No tag at all.
    #[error(
        "no tag of the family 36h11 is in any of the {frames} frames. Show the whole board, sharp, with its white margins, each tag at least 30 pixels wide"
    )]
    NoTag {
        /// Number of frames.
        frames: usize,
    },
    /// Only tags of another board.
    #[error(
        "none of the tags found is on the board, which has {from} to {to}; found: {found}. Correct first_tag, rows and columns of the board"
    )]
    ForeignTags {
        /// First tag of the board.
        from: u16,
        /// Last tag of the board.
        to: u16,
        /// The tags found.
        found: String,
    },
    /// The frame that fixes the world shows too little of the board.
    #[error(
        "{name}: {found} of the board's tags are usable in the frame in which it lies on the table; at least {FEWEST_TAGS} must be. Choose another such frame, or record one"
    )]
    FlatFrame {
        /// The frame.
        name: String,
        /// Usable tags in it.
        found: usize,
    },
    /// Too few frames.
    #[error(
        "{usable} of {frames} frames show at least {FEWEST_TAGS} usable tags of the board; at least {FEWEST_FRAMES} must, better 20. Record more"
    )]
    TooFewFrames {
        /// Frames that show enough.
        usable: usize,
        /// All frames.
        frames: usize,
    },
    /// The frames do not tell the focal length from the distance.
    #[error("the frames leave the focal length open{}: the board must be seen tilted. Record frames with the board tilted by 20 to 40 degrees to all sides", spread(*.relative_std))]
    NoTilt {
        /// Its relative standard deviation, where there is one.
        relative_std: Option<f64>,
    },
    /// The board does not fit the frames.
    #[error(
        "the board fits the frames to {rms:.2} px only; at most {WORST_MISFIT} px is good. Measure tag_size and gap on the print, and make the board flat"
    )]
    Misfit {
        /// Root mean square misfit (px).
        rms: f64,
    },
}

/// A tag's corners on the board and where they are seen, by frame.
type FrameMatches = Vec<[Match; 4]>;

/// Searches the frames 0 to `count` - 1, which `load` brings as a name and an image, from any
/// thread.
///
/// # Errors
/// Those of `load`; frames of several sizes.
pub fn search_board<E: From<CalibrationError> + Send>(
    count: usize,
    load: impl Fn(usize) -> Result<(String, GrayImage), E> + Sync,
) -> Result<BoardRecording, E> {
    let search = |index: usize| {
        let (name, image) = load(index)?;
        let size = [image.width(), image.height()];
        Ok((
            CalibrationFrame {
                name,
                tags: Detector::new(size).find(&image),
            },
            size,
        ))
    };
    let found: Vec<(CalibrationFrame, [u32; 2])> = (0..count)
        .into_par_iter()
        .map(search)
        .collect::<Result<_, E>>()?;
    let size = found.first().map_or([0; 2], |first| first.1);
    if let Some((odd, other)) = found.iter().find(|(_, other)| *other != size) {
        let text = |[columns, rows]: [u32; 2]| format!("{columns} x {rows}");
        let (name, first) = (odd.name.clone(), found[0].0.name.clone());
        return Err(CalibrationError::Size {
            name,
            found: text(*other),
            first,
            expected: text(size),
        }
        .into());
    }
    Ok(BoardRecording {
        frames: found.into_iter().map(|(frame, _)| frame).collect(),
        size,
    })
}

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
    let size = *size;
    let on_board = board_tags(frames, board)?;
    let straight = Lens::pinhole(size, f64::from(size[0].max(size[1])));
    let seen: Vec<FrameMatches> = on_board
        .iter()
        .map(|tags| matches_of(tags, board, &straight))
        .collect();
    let usable: Vec<usize> = (0..frames.len())
        .filter(|frame| seen[*frame].len() >= FEWEST_TAGS)
        .collect();
    let flat_view = usable.iter().position(|frame| *frame == flat);
    let flat_view = flat_view.ok_or_else(|| CalibrationError::FlatFrame {
        name: frames[flat].name.clone(),
        found: seen[flat].len(),
    })?;
    if usable.len() < FEWEST_FRAMES {
        return Err(CalibrationError::TooFewFrames {
            usable: usable.len(),
            frames: frames.len(),
        });
    }
    let no_tilt = |relative_std| CalibrationError::NoTilt { relative_std };
    let first = first_bundle(usable.iter().map(|frame| seen[*frame].as_flattened()), size)
        .ok_or(no_tilt(None))?;
    let mut adjusted = first.adjust().ok_or(no_tilt(None))?;
    for _ in 0..ROUNDS {
        let views = adjusted.bundle.views.iter().zip(&usable);
        let refitted = |(view, frame): (&View, &usize)| {
            let matches = matches_of(&on_board[*frame], board, &adjusted.bundle.lens);
            without_outliers(
                View {
                    matches: matches.concat(),
                    ..view.clone()
                },
                &adjusted,
            )
        };
        let bundle = Bundle {
            lens: adjusted.bundle.lens,
            views: views.map(refitted).collect(),
        };
        adjusted = bundle.adjust().ok_or(no_tilt(None))?;
    }
    if adjusted.rms > WORST_MISFIT {
        return Err(CalibrationError::Misfit { rms: adjusted.rms });
    }
    let lens = adjusted.bundle.lens;
    let relative_std =
        (adjusted.lens_std[0] / lens.focal[0]).max(adjusted.lens_std[1] / lens.focal[1]);
    if relative_std.is_nan() || relative_std > FOCAL_STD {
        return Err(no_tilt(Some(relative_std)));
    }
    let tags = adjusted
        .bundle
        .views
        .iter()
        .map(|view| view.matches.len() / 4)
        .sum();
    let offered = usable
        .iter()
        .map(|frame| on_board[*frame].len())
        .sum::<usize>();
    Ok(Calibration {
        camera: Camera::new(
            lens,
            world_to_camera(&adjusted.bundle.views[flat_view], board),
        ),
        rms: adjusted.rms,
        frames: usable.len(),
        tags,
        left_out: offered - tags,
        lens_std: adjusted.lens_std,
    })
}

/// The board's tags in each frame, but for those that are there twice.
fn board_tags<'a>(
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
fn matches_of(tags: &[&FoundTag], board: &BoardOnTable, lens: &Lens) -> FrameMatches {
    let of_tag = |tag: &&FoundTag| {
        let on_board = board.board.corners(tag.id)?;
        let square = tag.outline.fit(lens)?;
        Some(std::array::from_fn(|k| {
            (
                on_board[k].into(),
                lens.distort(square.corners[k].into()).into(),
            )
        }))
    };
    tags.iter().filter_map(of_tag).collect()
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
fn without_outliers(view: View, adjusted: &Adjusted) -> View {
    let Some(misfits) = view.misfits(&adjusted.bundle.lens) else {
        return view;
    };
    let good = |tag: &(&[Match], &[Vector2<f64>])| {
        tag.1
            .iter()
            .all(|misfit| misfit.amax() < OUTLIER * adjusted.rms)
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

fn world_to_camera(flat: &View, board: &BoardOnTable) -> Motion {
    let to_world = Motion::planar(
        board.pose.theta,
        Vector3::new(board.pose.x, board.pose.y, board.thickness),
    );
    flat.motion.after(&to_world.inverse())
}

fn spread(relative_std: Option<f64>) -> String {
    relative_std.map_or_else(String::new, |std| format!(" by {:.1} %", 100.0 * std))
}
