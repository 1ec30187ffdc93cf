//! The self-contained HTML report: [`Report`], one file that opens anywhere and loads nothing.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};

use crate::drawing::Drawing;
use crate::font::{BOLD, REGULAR};
use crate::playback::Playback;
use crate::sentences::{Fate, Sentence};
use crate::table::Table;
use crate::terms::explained;

const STYLE: &str = include_str!("../page/report.css");
/// Characters that are escaped in an address of a table, mostly digits and commas.
const ESCAPED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b',')
    .remove(b'.')
    .remove(b'-')
    .remove(b'_');

pub(crate) const SCRIPT: &str = include_str!("../page/player.js");
pub(crate) const FIGURES: &str = include_str!("../page/figures.js");

/// A page with a summary on top.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Title.
    pub title: String,
    /// Warnings and findings above the sections.
    pub summary: Vec<Block>,
    /// The rest.
    pub sections: Vec<Section>,
    /// Origin, name by name: program, command, seed.
    pub origin: Vec<(String, String)>,
}

/// A part of a page.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Heading; may be empty.
    pub title: String,
    /// Content below the heading.
    pub blocks: Vec<Block>,
}

/// Part of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A list of sentences, as which methods kept track of an object, and which lost it.
    Sentences(Vec<Sentence>),
    /// A remark in small letters.
    Note(String),
    /// A table under a caption, which may be empty.
    Table(Table, String),
    /// Blocks behind a line that opens them.
    Details(String, Vec<Block>),
    /// A figure over a caption, which may be empty.
    Figure(Drawing, String),
    /// An experiment to be played back.
    Playback(Box<Playback>),
    /// A file that the page holds.
    Download {
        /// Its name.
        name: String,
        /// Its content in words, as "every row of the particle filter".
        what: String,
        /// Its content, text.
        bytes: Vec<u8>,
    },
}

impl Report {
    /// A player and nothing else.
    #[must_use]
    pub fn player(playback: Playback) -> Self {
        let section = Section {
            title: String::new(),
            blocks: vec![Block::Playback(Box::new(playback))],
        };
        Self {
            sections: vec![section],
            ..Self::default()
        }
    }

    /// The page as HTML text, with styles, fonts, figures, data and script in it.
    #[must_use]
    pub fn to_html(&self) -> String {
        let sections = self.sections.iter().flat_map(|section| &section.blocks);
        let mut blocks = self.summary.iter().chain(sections);
        let moves = |block: &Block| matches!(block, Block::Playback(_) | Block::Figure(..));
        let moves = blocks.any(moves);
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                (head(&self.title))
                body {
                    main {
                        h1 { (self.title) }
                        (self.body())
                        @if !self.origin.is_empty() {
                            footer { h2 { "How this page was made" } dl { @for (name, value) in &self.origin { dt { (name) } dd { (value) } } } }
                        }
                    }
                    @if moves { script { (PreEscaped(SCRIPT)) (PreEscaped(FIGURES)) } }
                }
            }
        };
        page.into_string()
    }

    /// Summary and sections as HTML text, for a page that has the styles and scripts.
    #[must_use]
    pub fn to_part(&self) -> String {
        self.body().into_string()
    }

    fn body(&self) -> Markup {
        html! {
            @if !self.summary.is_empty() { div class="summary" { @for block in &self.summary { (block.html()) } } }
            (self.contents())
            @for section in &self.sections { (section.html()) }
        }
    }

    /// Links to the sections, where there are several.
    fn contents(&self) -> Markup {
        let titled = self.sections.iter().filter(|part| !part.title.is_empty());
        html! {
            @if titled.clone().count() > 1 {
                nav aria-label="contents" { ol { @for part in titled { li { a href={ "#" (part.anchor()) } { (part.title) } } } } }
            }
        }
    }
}

/// The head of a page, with styles and fonts in it.
pub(crate) fn head(title: &str) -> Markup {
    html! {
        head {
            meta charset="utf-8";
            meta name="viewport" content="width=device-width, initial-scale=1";
            link rel="icon" href="data:,";
            title { (title) }
            style { (PreEscaped(font_face(REGULAR, "normal"))) (PreEscaped(font_face(BOLD, "bold"))) (PreEscaped(STYLE)) }
        }
    }
}

impl Section {
    /// Name of its place in the page: the letters and digits of its title.
    #[must_use]
    pub fn anchor(&self) -> String {
        let words = self.title.split(|letter: char| !letter.is_alphanumeric());
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        words.join("-").to_lowercase()
    }

    fn html(&self) -> Markup {
        let anchor = self.anchor();
        html! {
            div class="part" id=[(!anchor.is_empty()).then_some(anchor)] {
                @if !self.title.is_empty() { h2 { (self.title) } }
                @for block in &self.blocks { (block.html()) }
            }
        }
    }
}

impl Block {
    fn html(&self) -> Markup {
        match self {
            Self::Text(text) => html! { p { (explained(text)) } },
            Self::Sentences(all) => {
                html! { ul class="fates" { @for sentence in all { (sentence.html()) } } }
            }
            Self::Note(text) => html! { p class="note" { (text) } },
            Self::Table(table, caption) => table.html(caption),
            Self::Details(summary, blocks) => {
                html! { details { summary { (summary) } @for block in blocks { (block.html()) } } }
            }
            Self::Figure(drawing, caption) => html! {
                figure class=[drawing.narrow.is_some().then_some("two")] { (PreEscaped(drawing.to_svg())) @if let Some(narrow) = &drawing.narrow { (PreEscaped(narrow.to_svg())) } @if !caption.is_empty() { figcaption { (explained(caption)) } } }
            },
            Self::Playback(playback) => playback.html(),
            Self::Download { name, what, bytes } => {
                let data = format!("data:text/csv,{}", percent_encode(bytes, ESCAPED));
                html! { p class="download" { a download=(name) href=(data) { (name) } " " (what) } }
            }
        }
    }
}

impl Sentence {
    fn html(&self) -> Markup {
        let (class, sign) = match self.fate {
            Some(Fate::Kept) => ("kept", "✓"),
            Some(Fate::Drifted) => ("drifted", "≈"),
            Some(Fate::Lost) => ("lost", "✗"),
            Some(Fate::Unknown) => ("unknown", "?"),
            None => ("", "•"),
        };
        html! {
            li class=(class) { span aria-hidden="true" { (sign) } @if let Some(fate) = self.fate { b { (fate.name()) } } (self.text) }
        }
    }
}

/// The style rule by which a font comes from the page itself.
fn font_face(font: &[u8], weight: &str) -> String {
    let data = BASE64_STANDARD.encode(font);
    format!(
        "@font-face{{font-family:Roboto;font-weight:{weight};src:url(data:font/ttf;base64,{data}) format('truetype')}}\n"
    )
}
