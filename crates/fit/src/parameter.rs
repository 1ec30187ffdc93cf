//! Parameters that can be learnt: [`Parameter`].

use std::f64::consts::FRAC_PI_3;

use serde::{Deserialize, Serialize};
use stickslip::{Setup, Surface};
use stickslip_dynamics::{Friction, Lanes, Part, Shape, ShapeError, Support};
use stickslip_formats::nearest;

use crate::error::FitError;
use crate::prior::Prior;

/// Standard deviation of the size of an outline.
const SCALE_STD: f64 = 0.02;

/// Standard deviation of the place of an outline about the tracked frame (m).
const OFFSET_STD: f64 = 1e-3;

/// A number of a scene that pushes can teach; in files, its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum Parameter {
    /// μ_s, friction between object and support.
    MuS,
    /// μ_p, friction between object and pusher.
    MuP,
    /// μ_f, friction between object and fixels.
    MuF,
    /// d_tri, radius of the support tripod (m).
    TripodRadius,
    /// x of the centre of friction in the object frame (m).
    CentreX,
    /// y of it.
    CentreY,
    /// x of a vector that points in three times the angle by which the feet are turned. A third of
    /// a turn changes nothing, so the vector has no angle at which a feet's turn jumps.
    PhaseX,
    /// y of it.
    PhaseY,
    /// ln of the factor by which the feet's triangle is stretched along x and shrunk along y.
    StretchX,
    /// ln of such a factor along the diagonal of x and y.
    StretchXy,
    /// Factor of the object's outline.
    OutlineScale,
    /// Offset of the object's outline from the scene's along x, object frame (m).
    OutlineX,
    /// Offset of the object's outline from the scene's along y, object frame (m).
    OutlineY,
    /// Offset of the pusher's outline from the scene's along x, pusher frame (m).
    PusherX,
    /// Offset of the pusher's outline from the scene's along y, pusher frame (m).
    PusherY,
    /// Time by which object poses lag the pusher's (s).
    Latency,
}

/// Numbers of the support: any triangle of equal feet.
const SUPPORT: &[Parameter] = &[
    Parameter::TripodRadius,
    Parameter::CentreX,
    Parameter::CentreY,
    Parameter::PhaseX,
    Parameter::PhaseY,
    Parameter::StretchX,
    Parameter::StretchXy,
];

/// Parameters for each name on the command line.
const GROUPS: [(&str, &[Parameter]); 10] = [
    ("mu_s", &[Parameter::MuS]),
    ("mu_p", &[Parameter::MuP]),
    ("mu_f", &[Parameter::MuF]),
    ("tripod_radius", &[Parameter::TripodRadius]),
    (
        "centre_of_friction",
        &[Parameter::CentreX, Parameter::CentreY],
    ),
    ("support", SUPPORT),
    ("outline_scale", &[Parameter::OutlineScale]),
    (
        "outline_offset",
        &[Parameter::OutlineX, Parameter::OutlineY],
    ),
    ("pusher_offset", &[Parameter::PusherX, Parameter::PusherY]),
    ("latency", &[Parameter::Latency]),
];

impl From<Parameter> for &'static str {
    fn from(parameter: Parameter) -> Self {
        parameter.name()
    }
}

impl TryFrom<String> for Parameter {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let mut all = GROUPS.iter().flat_map(|(_, group)| *group);
        let found = all.find(|parameter| parameter.name() == name);
        found.copied().ok_or(format!("`{name}` is no parameter"))
    }
}

impl Parameter {
    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::MuS => "mu_s",
            Self::MuP => "mu_p",
            Self::MuF => "mu_f",
            Self::TripodRadius => "tripod_radius",
            Self::CentreX => "centre_of_friction_x",
            Self::CentreY => "centre_of_friction_y",
            Self::PhaseX => "foot_phase_x",
            Self::PhaseY => "foot_phase_y",
            Self::StretchX => "foot_stretch_x",
            Self::StretchXy => "foot_stretch_xy",
            Self::OutlineScale => "outline_scale",
            Self::OutlineX => "outline_offset_x",
            Self::OutlineY => "outline_offset_y",
            Self::PusherX => "pusher_offset_x",
            Self::PusherY => "pusher_offset_y",
            Self::Latency => "latency",
        }
    }

    /// Symbol of its unit; empty for a bare number.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::MuS | Self::MuP | Self::MuF | Self::OutlineScale => "",
            Self::PhaseX | Self::PhaseY | Self::StretchX | Self::StretchXy => "",
            Self::Latency => "s",
            _ => "m",
        }
    }

    /// Names that a list of free parameters may have.
    #[must_use]
    pub fn known_names() -> [&'static str; 10] {
        GROUPS.map(|(name, _)| name)
    }

    /// The parameters that a list of names asks for, in one order whatever that of the names.
    ///
    /// # Errors
    /// A name that is none, or no name.
    pub fn parse_list(names: &[String]) -> Result<Vec<Self>, FitError> {
        let known = Self::known_names();
        for name in names {
            if !known.contains(&name.as_str()) {
                return Err(FitError::UnknownParameter {
                    name: name.clone(),
                    nearest: nearest(name, known).map_or("", |(nearest, _)| nearest),
                    known: known.join(", "),
                });
            }
        }
        let asked = |group: &&(&str, _)| names.iter().any(|name| name == group.0);
        let groups = GROUPS.iter().filter(asked);
        let mut parameters: Vec<Self> = Vec::new();
        for parameter in groups.flat_map(|(_, group)| *group) {
            if !parameters.contains(parameter) {
                parameters.push(*parameter);
            }
        }
        match parameters.is_empty() {
            true => Err(FitError::NothingFree {
                known: known.join(", "),
            }),
            false => Ok(parameters),
        }
    }

    /// The parameters of a list of names, by [`parse_list`](Self::parse_list); by
    /// [`default_list`](Self::default_list) for `setup` where there are no names.
    ///
    /// # Errors
    /// A name that is none.
    pub fn list_or_default(names: &[String], setup: &Setup) -> Result<Vec<Self>, FitError> {
        match names.is_empty() {
            true => Ok(Self::default_list(setup)),
            false => Self::parse_list(names),
        }
    }

    /// The parameters that are free by default: μ_p, and all that `setup` leaves open of the
    /// support.
    #[must_use]
    pub fn default_list(setup: &Setup) -> Vec<Self> {
        let all = [&[Self::MuP], SUPPORT].concat();
        let open = |free: &Self| free.prior(setup).is_open();
        let has = |free: &Self| setup.has_tripod() || !free.is_of_support();
        all.into_iter().filter(has).filter(open).collect()
    }

    /// Returns true if predictions with several values of it have one scene, but for friction and
    /// support.
    pub(crate) fn keeps_scene(self) -> bool {
        self.is_of_support() || matches!(self, Self::MuS | Self::MuP | Self::MuF | Self::Latency)
    }

    /// Returns true if it is a number of the support.
    pub(crate) fn is_of_support(self) -> bool {
        SUPPORT.contains(&self)
    }

    /// Friction and image of the feet by the values of some parameters, from `nominal` on.
    pub(crate) fn surface(values: &[(Self, f64)], nominal: Friction) -> Surface {
        let mut friction = nominal;
        let [mut centre, mut phase, mut stretch] = [[0.0; 2], [1.0, 0.0], [0.0; 2]];
        for &(parameter, value) in values {
            match parameter {
                Self::MuS => friction.mu_s = value,
                Self::MuP => friction.mu_p = value,
                Self::MuF => friction.mu_f = value,
                Self::TripodRadius => friction.d_tri = value,
                Self::CentreX => centre[0] = value,
                Self::CentreY => centre[1] = value,
                Self::PhaseX => phase[0] = value,
                Self::PhaseY => phase[1] = value,
                Self::StretchX => stretch[0] = value,
                Self::StretchXy => stretch[1] = value,
                _ => {}
            }
        }
        let turn = libm::atan2(phase[1], phase[0]) / 3.0;
        let one = |x: f64| Lanes([x]);
        let support = Support::new(centre.map(one), one(turn), stretch.map(one));
        Surface {
            friction,
            support: support.map(|x| x.0[0]),
        }
    }

    /// Keys of a scene file for it, and for the standard deviation of its logarithm.
    #[must_use]
    pub fn scene_keys(self) -> Option<[[&'static str; 2]; 2]> {
        let keys = match self {
            Self::MuS => (["support", "friction"], "mu_s"),
            Self::MuP => (["pusher", "friction"], "mu_p"),
            Self::MuF => (["fixels", "friction"], "mu_f"),
            Self::TripodRadius => (["support", "tripod_radius"], "d_tri"),
            _ => return None,
        };
        Some([keys.0, ["uncertainty", keys.1]])
    }

    /// Its prior by `setup`.
    #[must_use]
    pub fn prior(self, setup: &Setup) -> Prior {
        let log_normal = |median, relative_std| Prior::LogNormal {
            median,
            relative_std,
        };
        let normal = |mean, std| Prior::Normal { mean, std };
        let (nominal, open) = (&setup.scene.nominal, &setup.uncertainty);
        match self {
            Self::MuS => log_normal(nominal.mu_s, open.friction.mu_s),
            Self::MuP => log_normal(nominal.mu_p, open.friction.mu_p),
            Self::MuF => log_normal(nominal.mu_f, open.friction.mu_f),
            Self::TripodRadius => log_normal(nominal.d_tri, open.friction.d_tri),
            Self::CentreX | Self::CentreY => normal(
                0.0,
                open.centre_of_friction * setup.scene.object.gyration_radius(),
            ),
            // any angle is a vector about zero, a known one about (1, 0)
            Self::PhaseX | Self::PhaseY if open.tripod_angle >= FRAC_PI_3 => normal(0.0, 1.0),
            Self::PhaseX => normal(1.0, 3.0 * open.tripod_angle),
            Self::PhaseY => normal(0.0, 3.0 * open.tripod_angle),
            Self::StretchX | Self::StretchXy => normal(0.0, open.foot_stretch),
            Self::OutlineScale => log_normal(1.0, SCALE_STD),
            Self::OutlineX | Self::OutlineY | Self::PusherX | Self::PusherY => {
                normal(0.0, OFFSET_STD)
            }
            Self::Latency => {
                let latency = setup.camera.map_or(0.0, |camera| camera.latency);
                normal(latency, open.latency_std())
            }
        }
    }

    /// Writes the values of some parameters into `setup`, those of others as if they were not
    /// there.
    ///
    /// # Errors
    /// An outline that is scaled or moved to where it is none.
    pub fn apply(values: &[(Self, f64)], setup: &mut Setup) -> Result<(), ShapeError> {
        let mut object = Change::default();
        let mut pusher = Change::default();
        for &(parameter, value) in values {
            match parameter {
                Self::OutlineScale => object.scale = value,
                Self::OutlineX => object.offset[0] = value,
                Self::OutlineY => object.offset[1] = value,
                Self::PusherX => pusher.offset[0] = value,
                Self::PusherY => pusher.offset[1] = value,
                Self::Latency => {
                    if let Some(camera) = &mut setup.camera {
                        camera.latency = value.max(0.0);
                    }
                }
                _ => {}
            }
        }
        let Surface { friction, support } = Self::surface(values, setup.scene.nominal);
        setup.scene.nominal = friction;
        if support != Support::default() {
            setup.scene.feet = setup.scene.image_of_feet(&support);
        }
        object.apply(&mut setup.scene.object.shape)?;
        pusher.apply(&mut setup.scene.pusher.fingers[0])
    }
}

/// An outline scaled about the origin of its frame, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    pub scale: f64,
    pub offset: [f64; 2],
}

impl Default for Change {
    fn default() -> Self {
        Self {
            scale: 1.0,
            offset: [0.0; 2],
        }
    }
}

impl Change {
    fn apply(self, shape: &mut Shape) -> Result<(), ShapeError> {
        if self == Self::default() {
            return Ok(());
        }
        let parts = shape.parts().iter().map(|part| self.of_part(part));
        *shape = Shape::new(parts.collect())?;
        Ok(())
    }

    fn of_part(self, part: &Part) -> Part {
        let Self { scale, .. } = self;
        match part {
            Part::Polygon { vertices } => Part::Polygon {
                vertices: vertices
                    .iter()
                    .map(|vertex| self.of_point(*vertex))
                    .collect(),
            },
            Part::Disc { radius, centre } => Part::Disc {
                radius: scale * radius,
                centre: self.of_point(*centre),
            },
        }
    }

    /// Place of a point of the outline then (m).
    pub fn of_point(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.scale * x + self.offset[0],
            self.scale * y + self.offset[1],
        ]
    }
}
