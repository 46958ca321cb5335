//! Algorithms that turn a scene into a picture: one list, one door.
//!
//! [`Integrator`] is what a user names; [`render`] runs it. Path tracing asks each pixel for
//! its radiance (`path`); the block loop that feeds the film is `blocks`.

mod blocks;
mod measure;
mod media;
mod path;

pub use blocks::{Budget, Progress, Rendering, Silent};
pub use measure::{Reading, read_meters};
pub use path::PathTracer;

use crate::scene::{Plan, Scene, View};

/// The algorithms that can be named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Integrator {
    /// Path tracing from the camera with next-event estimation.
    #[default]
    Path,
}

impl Integrator {
    /// Every integrator, in the order they are listed to users.
    pub const ALL: [Self; 1] = [Self::Path];

    /// The name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
        }
    }

    /// The integrator of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|i| i.name() == name)
    }
}

/// Renders a view of a scene.
pub fn render(
    integrator: Integrator,
    scene: &Scene,
    view: &View,
    plan: &Plan,
    budget: &Budget,
    progress: &dyn Progress,
) -> Rendering {
    match integrator {
        Integrator::Path => {
            let eye = view.camera.placement().position.as_vec3a();
            let tracer = PathTracer::new(scene, plan).starting_at(eye);
            blocks::render(&tracer, view, plan, budget, progress)
        }
    }
}
