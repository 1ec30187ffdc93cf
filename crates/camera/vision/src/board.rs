//! The tag board: [`Board`], and where it lies: [`BoardOnTable`], board.toml.

use serde::Deserialize;
use stickslip_dynamics::Pose;

use crate::config::{ConfigError, Document};
use crate::tag::TAG_COUNT;

/// Tags of the family 36h11 in rows and columns on a flat board.
///
/// The board's frame has its origin in the lower left corner of the first tag's black square, x to
/// the right and y up as printed. Tags are numbered on along x, then along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Board {
    /// Tags above each other.
    pub rows: u16,
    /// Tags in a row.
    pub columns: u16,
    /// Edge of a black square (m).
    pub tag_size: f64,
    /// White between neighbouring black squares (m).
    pub gap: f64,
    /// Number of the tag in the lower left.
    pub first_tag: u16,
}

/// A board, and how it lies on the table in one frame: that fixes the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardOnTable {
    /// The board.
    pub board: Board,
    /// Height of its print above the table (m).
    pub thickness: f64,
    /// Pose of its frame in the world.
    pub pose: Pose,
}

/// board.toml as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoardFile {
    rows: u16,
    columns: u16,
    tag_size: f64,
    gap: f64,
    #[serde(default)]
    first_tag: u16,
    #[serde(default)]
    thickness: f64,
    #[serde(default)]
    pose: [f64; 3],
}

impl Board {
    /// Numbers of its tags.
    pub fn tags(&self) -> std::ops::Range<u16> {
        self.first_tag..self.first_tag + self.rows * self.columns
    }

    /// Corners of a tag's black square in the board's frame (m), anti-clockwise from the lower
    /// left; `None` for another board's tag.
    pub fn corners(&self, id: u16) -> Option<[[f64; 2]; 4]> {
        let index = id
            .checked_sub(self.first_tag)
            .filter(|index| *index < self.rows * self.columns)?;
        let start = [index % self.columns, index / self.columns]
            .map(|n| f64::from(n) * (self.tag_size + self.gap));
        Some(
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
                .map(|[x, y]| [start[0] + x * self.tag_size, start[1] + y * self.tag_size]),
        )
    }
}

/// Reads board.toml; `name` is shown in errors.
///
/// # Errors
/// Not TOML, a key that is missing, unknown or of another type, or a number against its rule, each
/// with file and line.
///
/// ```
/// let text = "rows = 4\ncolumns = 6\ntag_size = 0.03\ngap = 0.01\nthickness = 0.003\n";
/// let on_table = stickslip_vision::read_board(text, "board.toml")?;
/// assert_eq!(on_table.board.tags(), 0..24);
/// assert_eq!(on_table.board.corners(7).unwrap()[0], [0.04, 0.04]);
/// # Ok::<(), stickslip_vision::ConfigError>(())
/// ```
pub fn read_board(text: &str, name: &str) -> Result<BoardOnTable, ConfigError> {
    let document = Document { name, text };
    let file: BoardFile =
        document.parse("Give rows, columns, tag_size and gap in metres, and if needed first_tag, thickness and pose = [x, y, angle]")?;
    file.check(&document)
}

impl BoardFile {
    fn check(self, document: &Document<'_>) -> Result<BoardOnTable, ConfigError> {
        let Self {
            rows,
            columns,
            tag_size,
            gap,
            first_tag,
            thickness,
            pose,
        } = self;
        document.require(rows > 0, "rows", rows.to_string(), "at least 1")?;
        document.require(columns > 0, "columns", columns.to_string(), "at least 1")?;
        let end = u32::from(first_tag) + u32::from(rows) * u32::from(columns);
        let rule = format!(
            "such that the last tag, now {}, is below {TAG_COUNT}, the number of tags of the family",
            end - 1
        );
        document.require(end <= u32::from(TAG_COUNT), "rows", rows.to_string(), &rule)?;
        document.require(
            (1e-3..2.0).contains(&tag_size),
            "tag_size",
            format!("{tag_size} m"),
            "between 0.001 m and 2 m",
        )?;
        let least = tag_size / 8.0;
        let rule = format!(
            "at least an eighth of tag_size, {least} m, since tags need a white margin, and at most 2 m"
        );
        document.require(
            (least * (1.0 - 1e-9)..2.0).contains(&gap),
            "gap",
            format!("{gap} m"),
            &rule,
        )?;
        document.require(
            (0.0..1.0).contains(&thickness),
            "thickness",
            format!("{thickness} m"),
            "between 0 m and 1 m",
        )?;
        document.require(
            pose.iter().all(|x| x.is_finite()),
            "pose",
            format!("{pose:?}"),
            "three finite numbers",
        )?;
        let board = Board {
            rows,
            columns,
            tag_size,
            gap,
            first_tag,
        };
        Ok(BoardOnTable {
            board,
            thickness,
            pose: Pose::new(pose[0], pose[1], pose[2]),
        })
    }
}

/// A board as board.toml; every number reads back to the same bits.
pub fn write_board(on_table: &BoardOnTable) -> String {
    let BoardOnTable {
        board:
            Board {
                rows,
                columns,
                tag_size,
                gap,
                first_tag,
            },
        thickness,
        pose,
    } = on_table;
    format!(
        "# A board of AprilTags 36h11. Its frame: origin in the lower left corner of the first tag's black square, x right, y up as printed.\n\
         rows = {rows}\n\
         columns = {columns}\n\
         tag_size = {tag_size}     # edge of a black square (m)\n\
         gap = {gap}          # white between neighbouring black squares (m)\n\
         first_tag = {first_tag}     # in the lower left; the others are numbered on along x, then along y\n\
         thickness = {thickness}    # height of the print above the table (m)\n\
         pose = [{}, {}, {}]   # x, y (m), angle (rad) of the board's frame on the table in the flat frame: that fixes the world\n",
        pose.x, pose.y, pose.theta
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "rows = 4\ncolumns = 6\ntag_size = 0.03\ngap = 0.01\nfirst_tag = 10\npose = [0.1, 0.2, 0.3]\n";

    #[test]
    fn corners_are_those_of_the_boards_tags_only() {
        let board = read_board(GOOD, "b").unwrap().board;
        assert_eq!(board.tags(), 10..34);
        let [_, _, upper_right, _] = board.corners(33).unwrap();
        assert!((upper_right[0] - 0.23).abs() < 1e-12 && (upper_right[1] - 0.15).abs() < 1e-12);
        assert_eq!(board.corners(9), None);
        assert_eq!(board.corners(34), None);
    }

    #[test]
    fn write_board_reads_back() {
        let on_table = read_board(GOOD, "b").unwrap();
        assert_eq!(read_board(&write_board(&on_table), "b").unwrap(), on_table);
    }

    #[test]
    fn read_board_names_line_value_rule_and_next_step() {
        for (from, to, words) in [
            (
                "gap = 0.01",
                "gap = 0.003",
                ["b:4: `gap` is 0.003 m", "eighth of tag_size"],
            ),
            (
                "tag_size = 0.03",
                "tag_size = 30.0",
                ["b:3: `tag_size` is 30 m", "between 0.001 m and 2 m"],
            ),
            (
                "rows = 4",
                "rows = 400",
                ["b:1: `rows` is 400", "the last tag, now 2409, is below 587"],
            ),
            (
                "columns = 6",
                "columns = 0",
                ["b:2: `columns` is 0", "at least 1"],
            ),
            (
                "columns = 6",
                "collumns = 6",
                [
                    "b:2: `collumns = 6`: unknown field `collumns`",
                    "Give rows, columns",
                ],
            ),
            (
                "rows = 4\n",
                "",
                ["missing field `rows`", "Give rows, columns"],
            ),
            (
                "pose = [0.1, 0.2, 0.3]",
                "pose = [0.1, 0.2]",
                ["b:6: `pose = [0.1, 0.2]`", "pose = [x, y, angle]"],
            ),
            (
                "rows = 4",
                "rows = 4 tags",
                ["b:1: `rows = 4 tags`", "Give rows"],
            ),
        ] {
            let text = read_board(&GOOD.replace(from, to), "b")
                .unwrap_err()
                .to_string();
            assert!(words.iter().all(|word| text.contains(word)), "{text}");
        }
    }
}
