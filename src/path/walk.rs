//! The random walk that makes a subpath: one for both directions.
//!
//! A walk carries all its wavelengths at once. Directions are drawn by the hero wavelength
//! (lane 0); the other lanes would have drawn them with other densities, and each vertex keeps
//! the density of all lanes. Where a lane cannot follow (smooth refraction with dispersion)
//! its density is zero from there on.

use super::eye::{Eye, EyeRay};
use super::fate::Fate;
use super::media::Media;
use super::roulette::Roulette;
use super::vertex::{Kind, Place, Surface, Vertex};
use super::weights;
use crate::geometry::{Hit, Ray, SurfacePoint};
use crate::light::EmittedRay;
use crate::material::{BsdfSample, Quantity};
use crate::measure::AreaPdf;
use crate::sampler::{Sampler, Stream};
use crate::scene::{Plan, Scene};
use crate::spectrum::{Dense, Spectrum, Wavelengths};
use glam::Vec3A;

/// Bounces before a subpath from the eye may be ended at random.
const SURE_BOUNCES: u32 = 3;
/// Bounces in a row without a loss after which light counts as trapped, as by total reflection in
/// clear glass.
pub const TRAPPED_BOUNCES: u32 = 1000;
/// What light may lose in that many bounces and still count as having lost nothing: what rounding
/// makes of as many factors of one.
const NOTHING_LOST: f32 = 1e-4;
/// Trapped light reaches bounce n since its last loss with probability (1000 / n)^3: such paths end,
/// after 500 more bounces on average. The weight of what lives on grows by a power of n, so the variance is
/// finite wherever light that is trapped for long is lost exponentially, however slowly; with a
/// constant probability it would be infinite where a bounce loses less than half of what that
/// gives away.
const TRAPPED_POWER: i32 = 3;

/// What a walk happens in.
#[derive(Clone, Copy)]
pub struct Walker<'a, 'd> {
    /// The scene.
    pub scene: &'a Scene,
    /// What it needs.
    pub plan: &'a Plan,
    /// The wavelengths of the path.
    pub wavelengths: &'d Wavelengths,
    /// The random numbers of the path.
    pub sampler: &'d Sampler,
}

/// A subpath on its way from its last vertex.
#[derive(Clone, Copy, Debug)]
pub struct Heading {
    /// Where it goes.
    pub ray: Ray,
    /// What it carries: [`Quantity::Radiance`] from the eye, [`Quantity::Importance`] from a
    /// light.
    pub quantity: Quantity,
    /// Scattering and geometry over the hero's density, with the last direction drawn.
    pub throughput: Spectrum,
    /// Density under each lane relative to the hero's, with the last direction drawn.
    pub lanes: Spectrum,
    /// Density of the last direction in sr^-1, or the coefficient of its delta.
    pub pdf: Spectrum,
    /// What brings a delta's coefficient to its measure; 1 for a density.
    pub delta_measure: f64,
    /// What the ray travels through.
    pub media: Media,
    /// Density with which the second vertex of a subpath from a light would ask for its first,
    /// once it is known.
    pub asked: f64,
    /// Probability with which roulette has let the subpath live so far.
    pub survival: f32,
    /// Surfaces left so far.
    pub bounce: u32,
    /// What has become of the walk.
    pub fate: Fate,
    /// What the throughput would be if no light had been lost: where the walk began, times the
    /// n^2 factors since then.
    lossless: f32,
    /// The bounce at which it last lost something.
    whole_since: u32,
    /// What was left of it then, had roulette not been played.
    whole: f32,
}

impl Heading {
    /// A subpath on its way from the eye.
    pub(super) fn from_eye(eye: &Eye<'_>, drawn: &EyeRay, media: Media) -> Self {
        Self::new(drawn.ray, Quantity::Radiance, eye.response(), drawn.pdf_solid_angle, media)
    }

    fn new(ray: Ray, quantity: Quantity, throughput: f32, pdf_solid_angle: f64, media: Media) -> Self {
        Self {
            ray,
            quantity,
            throughput: Spectrum::splat(throughput),
            lanes: Spectrum::ONE,
            pdf: Spectrum::splat(pdf_solid_angle as f32),
            delta_measure: 1.0,
            media,
            asked: 0.0,
            survival: 1.0,
            bounce: 0,
            fate: Fate::default(),
            lossless: throughput,
            whole_since: 0,
            whole: 1.0,
        }
    }

    /// Whether everything that it carries is a number.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.throughput.is_finite() && self.lanes.is_finite() && self.ray.direction.is_finite()
    }

    /// What it carries of what it set out with, n^2 factors aside: those come back when it
    /// leaves the medium.
    fn carried(&self, throughput: f32) -> f32 {
        throughput / (self.lanes.mean() * self.lossless)
    }

    /// Whether a walk that carries so much has lost nothing but what rounding takes.
    fn has_lost_nothing(&self, carried: f32) -> bool {
        carried * self.survival >= 1.0 - NOTHING_LOST
    }

    /// Bounces since the last loss.
    const fn bounces_without_loss(&self) -> u32 {
        self.bounce - self.whole_since
    }

    /// Notes whether the walk has lost something, or nothing in very many bounces. Light may be
    /// trapped long after it began, with as much as walls have left of it.
    fn note_trapped(&mut self, carried: f32) {
        if self.fate.trapped.is_some() {
            return;
        }
        let left = carried * self.survival;
        if left < self.whole * (1.0 - NOTHING_LOST) {
            (self.whole, self.whole_since) = (left, self.bounce);
        } else if self.bounces_without_loss() >= TRAPPED_BOUNCES {
            self.fate.trapped = Some(self.carried(self.throughput.mean()));
        }
    }

    /// Density per area with which the ray reaches a vertex.
    #[inline]
    pub fn pdf_area(&self, from: &Vertex, to: &Vertex) -> AreaPdf {
        let per_area = to.solid_angle_per_area_from(from.point.position);
        AreaPdf::of_direction(self.pdf, per_area * self.delta_measure)
    }
}

impl<'a> Walker<'a, '_> {
    /// A point of the eye as a vertex.
    pub fn eye_vertex(&self, eye: &Eye<'_>, point: SurfacePoint, media: Media) -> Vertex {
        let kind = Kind::Eye { has_area: eye.has_aperture() };
        end(kind, point, AreaPdf::of_all_lanes(eye.pdf_area()), !eye.is_open(), media)
    }

    /// Begins a subpath at the eye: its first vertex, and where it goes.
    pub fn from_eye(&self, eye: &Eye<'_>, drawn: &EyeRay, media: Media) -> (Vertex, Heading) {
        (self.eye_vertex(eye, drawn.point, media), Heading::from_eye(eye, drawn, media))
    }

    /// Begins a subpath at a light that was chosen with a probability.
    pub fn from_light(&self, light: u32, probability: f64, emitted: &EmittedRay) -> (Vertex, Heading) {
        let media =
            if self.plan.tracks_media { Media::around(self.scene, emitted.ray.origin) } else { Media::NONE };
        let lamp = self.scene.lights.get(light);
        let pdf_area = probability * lamp.pdf_area();
        let pdf_solid_angle = lamp.pdf_emission(emitted.point.normal, emitted.ray.direction);
        let kind = Kind::Light { light, primitive: emitted.primitive };
        let mut vertex = end(kind, emitted.point, AreaPdf::of_all_lanes(pdf_area), false, media);
        vertex.throughput = Spectrum::splat((1.0 / pdf_area) as f32);
        let throughput = f64::from(emitted.share) / (pdf_area * pdf_solid_angle);
        let heading =
            Heading::new(emitted.ray, Quantity::Importance, throughput as f32, pdf_solid_angle, media);
        (vertex, heading)
    }

    /// Follows the ray to the vertex that it meets; `None` where it leaves the scene.
    #[inline]
    pub fn arrive(&self, from: &Vertex, heading: &mut Heading) -> Option<Vertex> {
        let hit = self.meet(heading)?;
        let mut vertex = Vertex {
            point: hit.point,
            kind: Kind::Surface(Surface::of(self.scene, &hit, self.wavelengths)),
            to_previous: -heading.ray.direction,
            throughput: heading.throughput,
            lanes: heading.lanes,
            survival: heading.survival,
            forward: AreaPdf::ZERO,
            reverse: AreaPdf::ZERO,
            per_area_of_previous: 0.0,
            given_away: f64::NAN,
            media: heading.media,
            is_delta: false,
        };
        let joins = self.plan.strategies.joins_both_ways();
        // Where nothing is joined, only the density of meeting a light matters.
        if joins || vertex.surface().is_some_and(|surface| surface.light.is_some()) {
            vertex.forward = heading.pdf_area(from, &vertex);
        }
        if joins {
            vertex.per_area_of_previous = from.solid_angle_per_area_from(vertex.point.position);
        }
        Some(vertex)
    }

    /// Follows the ray to the surface that it meets, through what absorbs on the way.
    #[inline]
    pub(super) fn meet(&self, heading: &mut Heading) -> Option<Hit> {
        let hit = self.scene.geometry.intersect(&heading.ray)?;
        if self.plan.tracks_media
            && let Some(absorption) = heading.media.absorption(self.scene)
        {
            heading.throughput *= transmittance(absorption, hit.t, self.wavelengths);
        }
        Some(hit)
    }

    /// Draws where the subpath goes on from its last vertex, and completes what the last two
    /// vertices know; false where it ends. Where that is because something is no number, the
    /// heading is not finite either.
    #[inline]
    pub fn leave(&self, subpath: &mut [Vertex], heading: &mut Heading) -> bool {
        let (last, before) = subpath.split_last_mut().expect("a walk has come from somewhere");
        let Some(place) = last.place() else { return false };
        let Some((drawn, direction)) = self.draw(&place, heading) else { return false };
        if self.plan.strategies.joins_both_ways() {
            let previous = before.last_mut().expect("a surface was reached from somewhere");
            let per_area = last.per_area_of_previous;
            previous.reverse = if drawn.is_delta {
                // A delta is drawn with the same probability from either side.
                let wo = place.surface.shading.to_local(place.to_previous);
                AreaPdf::of_direction(drawn.pdf, per_area * f64::from(place.surface.bsdf.delta_measure(wo)))
            } else {
                AreaPdf::of_direction(place.reverse_pdf(direction, heading.quantity), per_area)
            };
            if !self.plan.lanes_differ {
                weights::note_given_away(before, heading.quantity, heading.asked, &self.plan.strategies);
            }
        }
        self.turn(&place, &drawn, direction, heading);
        last.is_delta = drawn.is_delta;
        heading.is_finite() && self.survives(heading)
    }

    /// Draws the direction in which a subpath goes on; `None` where it ends. Where that is because
    /// something is no number, the heading is not finite either.
    #[inline]
    pub(super) fn draw(&self, place: &Place<'_>, heading: &mut Heading) -> Option<(BsdfSample, Vec3A)> {
        let surface = place.surface;
        let (direction, lobe) = match heading.quantity {
            Quantity::Radiance => (Stream::Direction, Stream::Lobe),
            Quantity::Importance => (Stream::LightDirection, Stream::LightLobe),
        };
        let u = self.sampler.pair(direction, heading.bounce);
        let u_lobe = if surface.bsdf.transmits() { self.sampler.single(lobe, heading.bounce) } else { 0.0 };
        let wo = surface.shading.to_local(place.to_previous);
        if !wo.is_finite() {
            heading.ray.direction = wo;
            return None;
        }
        let drawn = surface.bsdf.sample(wo, u_lobe, u, heading.quantity)?;
        let direction = surface.shading.to_world(drawn.wi).normalize();
        if !direction.is_finite() {
            heading.ray.direction = direction;
            return None;
        }
        (!drawn.value.is_black() && place.sides_agree(direction)).then_some((drawn, direction))
    }

    /// Sends a subpath on in a direction drawn.
    #[inline]
    pub(super) fn turn(
        &self,
        place: &Place<'_>,
        drawn: &BsdfSample,
        direction: Vec3A,
        heading: &mut Heading,
    ) {
        // Divided, not multiplied by a reciprocal: the hero's own density stays exactly one.
        let hero = Spectrum::splat(drawn.pdf.hero());
        heading.throughput *= drawn.value / hero;
        if self.plan.lanes_differ {
            heading.lanes *= drawn.pdf / hero;
        }
        if heading.quantity == Quantity::Importance {
            heading.throughput *= place.adjoint_factor(direction);
        } else if drawn.is_transmission {
            heading.lossless *= place.surface.bsdf.radiance_scale(drawn.wi);
        }
        heading.pdf = drawn.pdf;
        heading.delta_measure =
            if drawn.is_delta { f64::from(place.surface.bsdf.delta_measure(drawn.wi)) } else { 1.0 };
        if self.plan.tracks_media && drawn.is_transmission {
            heading.media = place.media_towards(direction);
        }
        heading.ray = place.point.ray_along(direction);
        heading.bounce += 1;
    }

    /// Russian roulette on what the subpath still carries. Subpaths from a light are ended from
    /// the first bounce on, in proportion to the power that they lose: all that go on carry the
    /// same.
    #[inline]
    pub(super) fn survives(&self, heading: &mut Heading) -> bool {
        if self.plan.most_bounces.is_some_and(|most| heading.bounce > most) {
            // The first trapped bounce may be this one.
            heading.note_trapped(heading.carried(heading.throughput.max()));
            heading.fate.cut = Some(heading.carried(heading.throughput.mean()));
            return false;
        }
        let (stream, sure) = match (heading.quantity, self.plan.roulette) {
            (Quantity::Radiance, Roulette::Carried) => (Stream::Roulette, SURE_BOUNCES),
            (Quantity::Radiance, Roulette::Constant(_)) => (Stream::Roulette, 0),
            (Quantity::Importance, _) => (Stream::LightRoulette, 0),
        };
        if heading.bounce <= sure {
            return true;
        }
        let carried = heading.carried(heading.throughput.max());
        heading.note_trapped(carried);
        let survival = if heading.fate.trapped.is_some() {
            trapped_survival(heading.bounces_without_loss()).min(carried)
        } else {
            self.plan.roulette.survival(carried)
        };
        if survival >= 1.0 {
            return true;
        }
        let survives = self.sampler.single(stream, heading.bounce) < survival;
        heading.fate.ended_by_rounding =
            !survives && heading.fate.trapped.is_none() && heading.has_lost_nothing(carried);
        if survives {
            // The reciprocal of a survival this small may be infinite; the quotient is not.
            let weight = 1.0 / survival;
            heading.throughput = if weight.is_finite() {
                heading.throughput * weight
            } else {
                heading.throughput / Spectrum::splat(survival)
            };
            heading.survival *= survival;
        }
        survives
    }
}

/// Probability with which trapped light reaches a bounce since its last loss from the one before.
fn trapped_survival(bounce: u32) -> f32 {
    (1.0 - 1.0 / bounce as f32).powi(TRAPPED_POWER)
}

/// The vertex at an end.
fn end(kind: Kind, point: SurfacePoint, forward: AreaPdf, is_delta: bool, media: Media) -> Vertex {
    Vertex { forward, is_delta, ..Vertex::at(point, kind, media) }
}

/// Beer-Lambert over a distance in scene units.
pub fn transmittance(absorption: &Dense, distance: f32, wavelengths: &Wavelengths) -> Spectrum {
    match absorption {
        Dense::Flat(a) => Spectrum::splat((-a * distance).exp()),
        Dense::Grid(_) => absorption.at(wavelengths).map(|a| (-a * distance).exp()),
    }
}
