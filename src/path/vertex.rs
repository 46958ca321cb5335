//! A vertex of a subpath: one type for both directions.

use super::media::Media;
use crate::geometry::{Frame, Hit, SurfacePoint};
use crate::material::{Bsdf, BsdfValue, Quantity};
use crate::measure::{AreaPdf, solid_angle_per_area};
use crate::scene::Scene;
use crate::spectrum::{Spectrum, Wavelengths};
use glam::Vec3A;

/// A vertex of a subpath.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Where it is.
    pub point: SurfacePoint,
    /// What is there.
    pub kind: Kind,
    /// Unit direction to the vertex before it in its own subpath; none at an end.
    pub to_previous: Vec3A,
    /// What the subpath has multiplied up before this vertex scatters: scattering and
    /// geometry over the hero's density. Light emitted is kept apart.
    pub throughput: Spectrum,
    /// Density of the subpath up to here under each lane, relative to the hero's.
    pub lanes: Spectrum,
    /// Probability with which roulette has let the subpath live so far; the throughput is
    /// larger by its inverse, the densities know nothing of it.
    pub survival: f32,
    /// Density with which its own subpath reaches the vertex.
    pub forward: AreaPdf,
    /// Density with which a subpath from the other end would reach it, coming along this
    /// path; known once the subpath has gone on by two vertices.
    pub reverse: AreaPdf,
    /// Solid angle here over area at the previous vertex, where subpaths are joined.
    pub per_area_of_previous: f64,
    /// Sum over the strategies that give this vertex, and more of its subpath, to the other
    /// end: squared density relative to the one that keeps it. Known with `reverse`; not a
    /// number where it is out of range or where lanes differ.
    pub given_away: f64,
    /// What the subpath travelled through to get here.
    pub media: Media,
    /// Whether the subpath went on from here by a Dirac delta: no strategy can join here.
    pub is_delta: bool,
}

/// What a vertex is.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "nearly all vertices are surfaces")]
pub enum Kind {
    /// The eye; whether it has an area that light can meet.
    Eye {
        /// Whether it has.
        has_area: bool,
    },
    /// A point of a light.
    Light {
        /// Index in the scene's lights.
        light: u32,
        /// Primitive in the geometry; `None` for a point light, which no ray can meet.
        primitive: Option<u32>,
    },
    /// A surface.
    Surface(Surface),
}

/// A place where light is scattered.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Frame in which the material works.
    pub shading: Frame,
    /// The material at the wavelengths of the path.
    pub bsdf: Bsdf,
    /// Object in the scene.
    pub object: u32,
    /// Primitive in the geometry.
    pub primitive: u32,
    /// Light in the scene, where the object shines.
    pub light: Option<u32>,
}

impl Surface {
    /// The surface that a ray has hit, at the wavelengths of a path.
    pub fn of(scene: &Scene, hit: &Hit, wavelengths: &Wavelengths) -> Self {
        let object = &scene.objects[hit.object as usize];
        let material = &scene.materials[object.material as usize];
        Self {
            shading: hit.shading,
            bsdf: material.at(wavelengths),
            object: hit.object,
            primitive: hit.primitive,
            light: object.light,
        }
    }

    /// Whether a direction lies on the side of the true surface that the shading frame says it
    /// does.
    #[inline]
    pub fn sides_agree(&self, point: &SurfacePoint, direction: Vec3A) -> bool {
        point.normal.dot(direction) * self.shading.normal.dot(direction) > 0.0
    }

    /// The same at other wavelengths.
    #[must_use]
    pub fn at(&self, scene: &Scene, wavelengths: &Wavelengths) -> Self {
        let material = &scene.materials[scene.objects[self.object as usize].material as usize];
        Self { bsdf: material.at(wavelengths), ..*self }
    }
}

impl Vertex {
    /// A vertex by itself: in no subpath, so that nothing has been multiplied up.
    pub const fn at(point: SurfacePoint, kind: Kind, media: Media) -> Self {
        Self {
            point,
            kind,
            to_previous: Vec3A::ZERO,
            throughput: Spectrum::ONE,
            lanes: Spectrum::ONE,
            survival: 1.0,
            forward: AreaPdf::ZERO,
            reverse: AreaPdf::ZERO,
            per_area_of_previous: 0.0,
            given_away: f64::NAN,
            media,
            is_delta: false,
        }
    }

    /// The surface, unless the vertex is an end.
    #[inline]
    pub const fn surface(&self) -> Option<&Surface> {
        match &self.kind {
            Kind::Surface(surface) => Some(surface),
            Kind::Eye { .. } | Kind::Light { .. } => None,
        }
    }

    /// Whether nothing can be joined to the vertex.
    #[inline]
    pub fn is_mirror(&self) -> bool {
        self.surface().is_some_and(|surface| surface.bsdf.is_delta())
    }

    /// Solid angle at another position over area here; zero for what no direction meets.
    #[inline]
    pub fn solid_angle_per_area_from(&self, position: Vec3A) -> f64 {
        match self.kind {
            Kind::Surface(_) | Kind::Eye { has_area: true } | Kind::Light { primitive: Some(_), .. } => {
                solid_angle_per_area(position, self.point.position, self.point.normal)
            }
            Kind::Eye { .. } | Kind::Light { .. } => 0.0,
        }
    }

    /// The surface as the subpath has reached it; `None` at an end.
    #[inline]
    pub(super) fn place(&self) -> Option<Place<'_>> {
        let Self { point, to_previous, media, .. } = self;
        Some(Place { point, surface: self.surface()?, to_previous: *to_previous, media })
    }

    /// Scattering from the previous vertex into a direction: value (with the cosine at this
    /// vertex towards `direction`) and density; nothing for ends and deltas.
    #[inline]
    pub fn scatter(&self, direction: Vec3A, quantity: Quantity) -> BsdfValue {
        self.place().map_or(BsdfValue::ZERO, |place| place.scatter(direction, quantity))
    }

    /// Density in sr^-1 with which a subpath that arrives from `direction` would go on to the
    /// previous vertex; `quantity` is what this vertex's own subpath carries.
    #[inline]
    pub fn reverse_pdf(&self, direction: Vec3A, quantity: Quantity) -> Spectrum {
        self.place().map_or(Spectrum::ZERO, |place| place.reverse_pdf(direction, quantity))
    }

    /// See [`Place::adjoint_factor`]; 1 at an end.
    #[inline]
    pub(super) fn adjoint_factor(&self, direction: Vec3A) -> f32 {
        self.place().map_or(1.0, |place| place.adjoint_factor(direction))
    }

    /// What light travels through on the way in a direction, given what the subpath came
    /// through.
    #[inline]
    pub(super) fn media_towards(&self, direction: Vec3A) -> Media {
        self.place().map_or(self.media, |place| place.media_towards(direction))
    }
}

/// A point of a surface as a subpath has reached it: what scattering there depends on.
#[derive(Clone, Copy)]
pub(super) struct Place<'v> {
    pub point: &'v SurfacePoint,
    pub surface: &'v Surface,
    /// Unit direction to where the subpath came from.
    pub to_previous: Vec3A,
    /// What the subpath travelled through to get here.
    pub media: &'v Media,
}

impl Place<'_> {
    /// Whether both directions lie on the sides of the true surface that the shading frame
    /// says they do; light does not leak through where the two normals disagree.
    #[inline]
    pub fn sides_agree(&self, direction: Vec3A) -> bool {
        self.surface.sides_agree(self.point, self.to_previous)
            && self.surface.sides_agree(self.point, direction)
    }

    /// See [`Vertex::scatter`].
    #[inline]
    pub fn scatter(&self, direction: Vec3A, quantity: Quantity) -> BsdfValue {
        if !self.sides_agree(direction) {
            return BsdfValue::ZERO;
        }
        let wo = self.surface.shading.to_local(self.to_previous);
        let wi = self.surface.shading.to_local(direction);
        let mut scattered = self.surface.bsdf.evaluate(wo, wi, quantity);
        if quantity == Quantity::Importance {
            scattered.value *= self.adjoint_factor(direction);
        }
        scattered
    }

    /// See [`Vertex::reverse_pdf`].
    #[inline]
    pub fn reverse_pdf(&self, direction: Vec3A, quantity: Quantity) -> Spectrum {
        let wo = self.surface.shading.to_local(direction);
        let wi = self.surface.shading.to_local(self.to_previous);
        self.surface.bsdf.pdf(wo, wi, quantity.opposite())
    }

    /// What carrying power over a surface with shading normals differs by from gathering
    /// radiance over it (Veach 1997, equation 5.19): cosines with the true normal for those
    /// with the shading normal. One where the two normals are the same.
    #[inline]
    pub fn adjoint_factor(&self, direction: Vec3A) -> f32 {
        let (true_normal, shading_normal) = (self.point.normal, self.surface.shading.normal);
        if true_normal == shading_normal {
            return 1.0;
        }
        let ratio = |w: Vec3A| (shading_normal.dot(w) / true_normal.dot(w)).abs();
        ratio(self.to_previous) / ratio(direction)
    }

    /// What light travels through on the way in a direction.
    #[inline]
    pub fn media_towards(&self, direction: Vec3A) -> Media {
        let mut media = *self.media;
        let (towards, from) = (self.point.normal.dot(direction), self.point.normal.dot(self.to_previous));
        if towards * from < 0.0 && self.surface.bsdf.transmits() {
            media.cross(self.surface.object, towards < 0.0);
        }
        media
    }
}
