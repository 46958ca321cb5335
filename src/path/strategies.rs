//! Which strategies a render uses: data, not code.
//!
//! Strategy (s, t) makes a path of s + t vertices from a subpath of s vertices that starts at a
//! light and one of t vertices that starts at the eye (Veach 1997, section 10.2). Path tracing,
//! light tracing and bidirectional path tracing are three lists of strategies.

/// A list of strategies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Strategies {
    /// s = 0: the subpath from the eye meets a light by itself.
    pub meets_lights: bool,
    /// s = 1, t > 1: a vertex seen by the eye asks a light.
    pub asks_lights: bool,
    /// s > 1, t > 1: vertices of both subpaths are joined.
    pub joins: bool,
    /// s > 1, t = 1: vertices that light reaches are joined to the eye.
    pub asks_eye: bool,
    /// s = 2, t = 1: also those that it reaches directly.
    pub direct_asks_eye: bool,
    /// s = t = 1: a light is joined to the eye.
    pub light_to_eye: bool,
    /// t = 0: the subpath from a light meets the eye by itself.
    pub meets_eye: bool,
    /// The only strategy of those above that is used.
    pub only: Option<(usize, usize)>,
}

impl Strategies {
    /// Subpaths from the eye that meet lights and ask them.
    pub const PATH: Self = Self {
        meets_lights: true,
        asks_lights: true,
        joins: false,
        asks_eye: false,
        direct_asks_eye: false,
        light_to_eye: false,
        meets_eye: false,
        only: None,
    };
    /// Subpaths from lights that ask the eye and meet it.
    pub const LIGHT: Self = Self {
        meets_lights: false,
        asks_lights: false,
        joins: false,
        asks_eye: true,
        direct_asks_eye: true,
        light_to_eye: true,
        meets_eye: true,
        only: None,
    };
    /// As `PATH`, and point lights in the eye's view.
    pub const DIRECT: Self = Self { light_to_eye: true, ..Self::PATH };
    /// Every strategy.
    pub const ALL: Self = Self {
        meets_lights: true,
        asks_lights: true,
        joins: true,
        asks_eye: true,
        direct_asks_eye: true,
        light_to_eye: true,
        meets_eye: true,
        only: None,
    };

    /// The same for instruments: unlike a picture's pixels, the point of an illuminance meter
    /// is lit by lights directly.
    #[must_use]
    pub const fn for_instruments(self) -> Self {
        Self { light_to_eye: true, ..self }
    }

    /// One strategy alone; a path that another finds is not weighed against it.
    #[must_use]
    pub const fn only(self, light_vertices: usize, eye_vertices: usize) -> Self {
        Self { only: Some((light_vertices, eye_vertices)), ..self }
    }

    /// Whether strategy (s, t) is in the list.
    #[inline]
    pub const fn plans(&self, light_vertices: usize, eye_vertices: usize) -> bool {
        let listed = match (light_vertices, eye_vertices) {
            (0, _) => self.meets_lights,
            (_, 0) => self.meets_eye,
            (1, 1) => self.light_to_eye,
            (1, _) => self.asks_lights,
            (2, 1) => self.asks_eye && self.direct_asks_eye,
            (_, 1) => self.asks_eye,
            _ => self.joins,
        };
        listed
            && match self.only {
                Some((light, eye)) => light == light_vertices && eye == eye_vertices,
                None => true,
            }
    }

    /// Whether any strategy has more than one vertex from a light, so that light is followed.
    #[inline]
    pub const fn follows_light(&self) -> bool {
        self.joins || self.asks_eye || self.meets_eye
    }

    /// Whether any strategy has more than one vertex from the eye.
    #[inline]
    pub const fn follows_eye(&self) -> bool {
        self.meets_lights || self.asks_lights || self.joins
    }

    /// Whether subpaths from both ends find the same paths, so that weights need the densities
    /// of both.
    #[inline]
    pub const fn joins_both_ways(&self) -> bool {
        self.follows_light() && self.follows_eye()
    }

    /// Whether any strategy contributes to pixels other than its own.
    #[inline]
    pub const fn splats(&self) -> bool {
        self.asks_eye || self.light_to_eye || self.meets_eye
    }

    /// Fewest and most vertices from a light among the strategies for paths of `vertices`, two
    /// or more.
    #[inline]
    pub const fn span(&self, vertices: usize) -> (usize, usize) {
        let asks = if vertices == 2 { self.light_to_eye } else { self.asks_lights };
        let asks_eye = self.asks_eye && vertices > 2;
        let joins = self.joins && vertices > 3;
        let fewest = if self.meets_lights {
            0
        } else if asks {
            1
        } else if joins {
            2
        } else if asks_eye {
            vertices - 1
        } else {
            vertices
        };
        let most = if self.meets_eye {
            vertices
        } else if asks_eye {
            vertices - 1
        } else if joins {
            vertices - 2
        } else if asks {
            1
        } else {
            0
        };
        (fewest, most)
    }
}
