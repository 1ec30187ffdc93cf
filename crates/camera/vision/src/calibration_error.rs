//! Reason why a calibration was refused: [`CalibrationError`].

/// Fewest of the board's tags that make a frame usable.
pub(crate) const FEWEST_TAGS: usize = 4;
/// Fewest usable frames.
pub(crate) const FEWEST_FRAMES: usize = 4;
/// Largest mean misfit (px).
pub(crate) const WORST_MISFIT: f64 = 1.0;

/// Reason why a calibration was refused.
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
    /// A frame that the lens was not calibrated for.
    #[error(
        "{name}: the image has {found} pixels, the lens was calibrated at {expected}. Use a frame of the same camera at its full size, or the numbers of this one"
    )]
    LensSize {
        /// The frame.
        name: String,
        /// Its columns x rows.
        found: String,
        /// Those of the lens.
        expected: String,
    },
    /// The board is seen where no place of it is.
    #[error(
        "{name}: no place of the board explains where its tags are seen. Look whether it is the right board, and the lens that of this camera"
    )]
    NoPlace {
        /// The frame.
        name: String,
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
    /// The frames do not separate the focal length from the distance.
    #[error("the frames leave the focal length open{}: the board must be seen tilted. Record frames with the board tilted by 20 to 40 degrees to all sides", spread(*.relative_std))]
    NoTilt {
        /// Its relative standard deviation, where there is one.
        relative_std: Option<f64>,
    },
    /// Copies of a few views.
    #[error(
        "the {frames} usable frames show the board in only {distinct} different places; at least {FEWEST_FRAMES} are needed, better 20. Move and tilt the board between frames"
    )]
    SameViews {
        /// Views that differ.
        distinct: usize,
        /// Usable frames.
        frames: usize,
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

fn spread(relative_std: Option<f64>) -> String {
    relative_std.map_or_else(String::new, |std| format!(" by {:.1} %", 100.0 * std))
}
