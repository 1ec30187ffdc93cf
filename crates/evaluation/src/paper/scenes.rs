//! The paper's six experiments: [`PaperExperiment`] and its [`PaperScene`].

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

/// One of the paper's experiments.
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
}

/// A scene with the truth that it does not tell.
#[derive(Clone, Copy, Debug)]
pub struct PaperScene {
    /// Name shown in errors and tables.
    pub name: &'static str,
    /// What happens.
    pub story: &'static str,
    /// scene.toml.
    pub scene: &'static str,
    /// truth.json: the true friction, and the blackout where the paper says it.
    pub truth: &'static str,
}

impl PaperExperiment {
    /// All, in the paper's order.
    pub const ALL: [Self; 6] = [
        Self::A,
        Self::B,
        Self::First,
        Self::Second,
        Self::Third,
        Self::Fourth,
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
        }
    }
}
