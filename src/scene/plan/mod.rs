//! What this scene needs, found out once, and what is left out and why.

mod item;
mod leaving;
mod savings;
mod strategies;
mod wavelengths;

pub use item::{Decision, Item};
pub use leaving::{
    ASKS_EYE, ASKS_LIGHTS, DIRECT_ASKS_EYE, EVEN_WAVELENGTHS, ITEMS, JOINS, LAMP_CHOICE, LANE_DENSITIES,
    LENS, LIGHT_TO_EYE, Leaving, MEDIA, MEETS_EYE, MEETS_LIGHTS, OUTER_WAVELENGTHS,
};
pub use savings::{Saving, savings};

use self::item::Decisions;
use super::Scene;
use super::reach::{Unreachable, unreachable};
use crate::camera::Sensor;
use crate::material::Material;
use crate::path::{Roulette, Strategies};
use crate::spectrum::WavelengthSampler;

/// Why a picture is black in every pixel.
pub const NOTHING_SHINES: &str = "nothing shines: the picture is black";

/// How a scene is to be rendered.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Distribution of the wavelengths that paths carry.
    pub wavelengths: WavelengthSampler,
    /// The strategies that are used.
    pub strategies: Strategies,
    /// Whether every joint of two subpaths is looked along, not one in proportion to what they
    /// contribute: for pictures of single strategies.
    pub joins_each: bool,
    /// Whether paths end behind the first vertex that is no mirror: direct light alone.
    pub direct_only: bool,
    /// Bounces after which paths are cut off, which loses light; `None`: only roulette ends them.
    pub most_bounces: Option<u32>,
    /// How paths are ended at random.
    pub roulette: Roulette,
    /// Whether the densities of a path differ between its wavelengths.
    pub lanes_differ: bool,
    /// Whether any medium absorbs, so that paths must know what they travel through.
    pub tracks_media: bool,
    /// Whether a number is drawn that chooses among the lamps.
    pub chooses_lamps: bool,
    /// Whether points of a lens are drawn even for an eye without one.
    pub draws_any_lens: bool,
    /// What was to be left out.
    pub leaving: Leaving,
    /// The decisions.
    pub items: Vec<Item>,
    /// What else is to be said of the plan.
    pub remarks: Vec<String>,
    /// The decisions and the remarks in plain words.
    pub reasons: Vec<String>,
    /// Paths that carry light and that none of the strategies can make.
    pub unreachable: Vec<Unreachable>,
}

impl Plan {
    /// The plan for a scene as a sensor sees it, with strategies to choose from; all is left out
    /// that the scene does not need.
    pub fn of(scene: &Scene, sensor: &Sensor, strategies: Strategies) -> Self {
        Self::under(scene, sensor, strategies, &Leaving::all())
    }

    /// The same with a say in what may be left out. The expected picture does not depend on it.
    pub fn under(scene: &Scene, sensor: &Sensor, listed: Strategies, leaving: &Leaving) -> Self {
        let both_ends = listed.follows_light();
        let mut decisions = Decisions { leaving, items: Vec::new(), both_ends };
        let mut remarks = Vec::new();
        let wavelengths = wavelengths::wavelengths(scene, sensor, &mut decisions, &mut remarks);
        let lanes_differ = !decisions.leave_out(
            LANE_DENSITIES,
            !scene.used_materials().any(Material::disperses),
            "no dispersive medium: all wavelengths of a path stay together",
            "a dispersive medium: its smooth refractions keep the hero wavelength alone",
        );
        let tracks_media = !decisions.leave_out(
            MEDIA,
            scene.used_materials().all(|material| material.absorption().is_none()),
            "nothing absorbs between surfaces: media are not tracked",
            "a medium absorbs: paths know what they travel through",
        );
        let pinhole = scene.view.as_ref().is_none_or(|view| !view.camera.has_aperture());
        let lens =
            if scene.view.is_some() { "pinhole: no lens sampling" } else { "no camera: no lens sampling" };
        let draws_any_lens =
            !decisions.leave_out(LENS, pinhole, lens, "a lens with an opening: its points are drawn")
                && pinhole;
        let shining = scene.emitters.iter().filter(|emitter| emitter.weight() > 0.0).count();
        let chooses_lamps =
            !decisions.leave_out(LAMP_CHOICE, shining < 2, "one lamp at most: none is chosen", "");
        let strategies = strategies::needed(scene, listed, &mut decisions);
        remarks.push(wavelengths::per_path(lanes_differ));
        if shining == 0 {
            remarks.push(NOTHING_SHINES.into());
        }
        let reasons = decisions.items.iter().map(Item::to_string).chain(remarks.iter().cloned()).collect();
        Self {
            wavelengths,
            strategies,
            joins_each: false,
            direct_only: false,
            most_bounces: None,
            roulette: Roulette::Carried,
            lanes_differ,
            tracks_media,
            chooses_lamps,
            draws_any_lens,
            leaving: *leaving,
            items: decisions.items,
            remarks,
            reasons,
            // What is left out carries no light that others do not find.
            unreachable: unreachable(scene, &listed),
        }
    }

    /// The decision on an item of [`ITEMS`]; `None` where there was none to be taken.
    pub fn item(&self, name: &str) -> Option<&Item> {
        self.items.iter().find(|item| item.name == name)
    }
}
