//! Algorithms that turn a scene into a picture: one list, one door.
//!
//! [`Integrator`] is what a user names; [`render`] runs it. All are one sample loop ([`Tracer`])
//! under different lists of strategies; the block loop that feeds the film is `blocks`.

mod blocks;
mod depth;
mod direct;
mod in_order;
mod measure;
mod pyramid;
mod tracer;

pub use blocks::{Budget, Progress, Rendering, Silent, Taken, block_size};
pub use depth::{Bounded, DIVERGENT_BOUNCES, Divergence, Truncation};
pub use direct::DirectLight;
pub(crate) use in_order::InOrder;
pub use measure::{
    MeterTaken, Reading, eye_of, instrument_plan, meter_sensor, read_meters, read_meters_under,
};
pub use pyramid::{Pyramid, StrategyFilms, render_pyramid};
pub use tracer::{Draw, Tracer};

use crate::path::Eye;
use crate::path::Strategies;
use crate::scene::{Plan, Scene, View};

/// The algorithms that can be named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Integrator {
    /// Path tracing from the camera with next-event estimation.
    #[default]
    Path,
    /// Light tracing: paths from the lights that are joined to the camera.
    Light,
    /// Bidirectional path tracing: every way to join paths from both ends.
    Bdpt,
    /// Metropolis light transport over all bidirectional strategies.
    Mlt,
}

impl Integrator {
    /// Every integrator, in the order they are listed to users.
    pub const ALL: [Self; 4] = [Self::Path, Self::Light, Self::Bdpt, Self::Mlt];

    /// The name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Light => "light",
            Self::Bdpt => "bdpt",
            Self::Mlt => "mlt",
        }
    }

    /// The integrator of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|i| i.name() == name)
    }

    /// The strategies that it stands for, before a plan leaves out what a scene does not need.
    pub const fn strategies(self) -> Strategies {
        match self {
            Self::Path => Strategies::PATH,
            Self::Light => Strategies::LIGHT,
            Self::Bdpt | Self::Mlt => Strategies::ALL,
        }
    }

    /// Renders a view of a scene under a plan of its strategies.
    pub fn render(
        self,
        scene: &Scene,
        view: &View,
        plan: &Plan,
        budget: &Budget,
        progress: &dyn Progress,
    ) -> Rendering {
        match self {
            Self::Path | Self::Light | Self::Bdpt => render(scene, view, plan, budget, progress),
            Self::Mlt => crate::metropolis::render(scene, view, plan, budget, progress),
        }
    }
}

/// Renders a view of a scene under a plan, by independent samples. Where radiance has no finite
/// value, paths are cut off and the rendering says so.
pub fn render(
    scene: &Scene,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    progress: &dyn Progress,
) -> Rendering {
    let eye = Eye::Camera(&view.camera);
    let bounded = Bounded::of(scene, plan, eye);
    blocks::render(&Tracer::new(scene, &bounded.plan, eye), view, &bounded, budget, progress)
}
