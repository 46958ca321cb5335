//! Algorithms that turn a scene into a picture: one list, one door.
//!
//! [`Integrator`] is what a user names; [`render`] runs it. All are one sample loop ([`Tracer`])
//! under different lists of strategies, whose blocks `blocks` takes; `run` takes blocks until
//! `stopping` ends it.

mod blocks;
mod cost;
mod depth;
mod direct;
mod in_order;
mod measure;
mod memory;
mod pyramid;
mod run;
mod stopping;
mod tracer;

pub(crate) use blocks::BlockOf;
pub use blocks::{Taken, block_size, size_of_block};
pub(crate) use cost::cpu_seconds;
pub use cost::{Cost, Stopwatch, Times, USUAL_TARGETS, share_done};
pub use depth::{Bounded, DIVERGENT_BOUNCES, Divergence, Truncation};
pub(crate) use direct::DirectLight;
pub(crate) use in_order::InOrder;
pub use measure::{
    MeterTaken, Reading, eye_of, instrument_plan, instrument_plan_under, meter_sensor, read_meters,
    read_meters_under,
};
pub use memory::Memory;
pub use pyramid::{Pyramid, StrategyFilms, render_pyramid};
pub(crate) use run::{Clock, Gathered, Source};
pub use run::{End, Progress, Rendering, Silent, Spent, State};
pub use stopping::{Budget, FEWEST_SAMPLES, Reason};
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
        self.go_on(scene, view, plan, budget, progress, None)
    }

    /// Goes on with a run from a state that [`Progress::keep`] was given; bit for bit what the
    /// run comes to without an interruption, unless its time is limited. Begins one without a state.
    ///
    /// The state must be of the same run ([`State::check`], and the same scene, plan and seed).
    pub fn go_on(
        self,
        scene: &Scene,
        view: &View,
        plan: &Plan,
        budget: &Budget,
        progress: &dyn Progress,
        from: Option<State>,
    ) -> Rendering {
        match self {
            Self::Path | Self::Light | Self::Bdpt => sample(scene, view, plan, budget, progress, from),
            Self::Mlt => crate::metropolis::go_on(scene, view, plan, budget, progress, from),
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
    sample(scene, view, plan, budget, progress, None)
}

fn sample(
    scene: &Scene,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    progress: &dyn Progress,
    from: Option<State>,
) -> Rendering {
    let clock = Clock::start(from.as_ref());
    let eye = Eye::Camera(&view.camera);
    let bounded = Bounded::of(scene, plan, eye);
    let tracer = Tracer::new(scene, &bounded.plan, eye);
    let source = blocks::Samples { tracer, view, plan: &bounded.plan };
    let mut state = from.unwrap_or_else(|| State::begin(&source, budget, &clock, None));
    state.run(&source, budget, &clock, progress);
    state.finish(&source, None, |film| bounded.truncation(&film.fates))
}
