//! The paper's six experiments and two of our own: [`PaperExperiment`] and its [`PaperScene`].

macro_rules! embedded {
    ($name:literal, $story:literal) => {
        PaperScene {
            name: concat!("paper/", $name),
            story: $story,
            scene: include_str!(concat!("../../scenes/", $name, "/scene.toml")),
            truth: include_str!(concat!("../../scenes/", $name, "/truth.json")),
        }
    };
}

/// One of the paper's experiments, or one added to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaperExperiment {
    /// Table II, Figures 2 to 4: jams soon after the first fixel contact.
    A,
    /// Table III, Figures 5 to 7: slides along one fixel and ends on three.
    B,
    /// Table IV: contact with a fixel and slide.
    First,
    /// Table IV: contact with a fixel and slide.
    Second,
    /// Table IV: contact with a fixel and stop.
    Third,
    /// Table IV: contact with a fixel and stop.
    Fourth,
    /// Not the paper's: friction decides whether an edge is caught at a fixel.
    Edge,
    /// Not the paper's: friction decides on which side of a fixel a corner passes.
    Corner,
}

/// A scene, and the truth that is not in it.
#[derive(Clone, Copy, Debug)]
pub struct PaperScene {
    /// Name shown in errors and tables.
    pub name: &'static str,
    /// Story of the experiment.
    pub story: &'static str,
    /// scene.toml.
    pub scene: &'static str,
    /// truth.json: the true friction, and the occlusion where the paper states it.
    pub truth: &'static str,
}

impl PaperExperiment {
    /// All, in the paper's order, the added ones last.
    pub const ALL: [Self; 8] = [
        Self::A,
        Self::B,
        Self::First,
        Self::Second,
        Self::Third,
        Self::Fourth,
        Self::Edge,
        Self::Corner,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
            Self::First => "1",
            Self::Second => "2",
            Self::Third => "3",
            Self::Fourth => "4",
            Self::Edge => "5",
            Self::Corner => "6",
        }
    }

    /// Its scene.
    #[must_use]
    pub fn scene(self) -> PaperScene {
        match self {
            Self::A => embedded!("a", "the object turns on the thumb, meets a fixel and jams"),
            Self::B => embedded!("b", "the object slides along one fixel and ends on three"),
            Self::First => embedded!("1", "the object slides along a fixel"),
            Self::Second => embedded!("2", "the object slides along a fixel and turns"),
            Self::Third => embedded!(
                "3",
                "the object meets a fixel as it comes to lie on the thumb, and stops"
            ),
            Self::Fourth => embedded!(
                "4",
                "the object is squeezed between thumb and fixel, and stops"
            ),
            Self::Edge => embedded!(
                "5",
                "the object is caught at its edge by a fixel, or passes it"
            ),
            Self::Corner => embedded!(
                "6",
                "a corner of the object meets a fixel and passes it on one side"
            ),
        }
    }
}
