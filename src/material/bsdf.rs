//! The closed list of models, and the questions that integrators ask of them.

use glam::Vec3A;

use super::{
    Ggx, Interface, Lambertian, Mirror, RoughConductor, RoughDielectric, SmoothConductor, SmoothDielectric,
};
use crate::spectrum::Spectrum;

/// What a path carries, which decides who is scaled by n^2 at an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The path started at the camera and gathers radiance, which is compressed into a
    /// smaller solid angle as it enters a denser medium.
    Radiance,
    /// The path started at a light and carries power, weighted by the camera's importance.
    Importance,
}

impl Quantity {
    /// What a path from the other end carries.
    pub const fn opposite(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }
}

/// What a model says about one pair of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfValue {
    /// f(wo, wi) |cos(wi)| in sr^-1.
    pub value: Spectrum,
    /// Density of `wi` given `wo` in sr^-1, each lane as if it were the hero.
    pub pdf: Spectrum,
}

impl BsdfValue {
    /// No scattering between the two directions.
    pub const ZERO: Self = Self { value: Spectrum::ZERO, pdf: Spectrum::ZERO };
}

/// A direction drawn by the hero wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Where the path goes on.
    pub wi: Vec3A,
    /// f(wo, wi) |cos(wi)| in sr^-1; for a delta its coefficient.
    pub value: Spectrum,
    /// Density of `wi` in sr^-1; for a delta the probability of choosing it.
    pub pdf: Spectrum,
    /// Whether `value` and `pdf` belong to a Dirac delta.
    pub is_delta: bool,
    /// Whether the path crosses to the other side.
    pub is_transmission: bool,
    /// Whether the direction is right for the hero wavelength alone; the other lanes of
    /// `value` and `pdf` are then zero.
    pub hero_only: bool,
}

impl BsdfSample {
    /// A draw from a lobe, with what the model says about it; `None` where the hero's
    /// density vanishes.
    #[inline]
    pub(super) fn of_lobe(wi: Vec3A, judged: BsdfValue, is_transmission: bool) -> Option<Self> {
        let BsdfValue { value, pdf } = judged;
        // What is no number is handed on, to be counted; only nothing is nothing.
        let is_nothing = pdf.hero() <= 0.0;
        (!is_nothing).then_some(Self { wi, value, pdf, is_delta: false, is_transmission, hero_only: false })
    }

    /// The same draw for the hero alone.
    pub(super) fn for_hero_only(self) -> Self {
        Self { value: self.value.hero_only(), pdf: self.pdf.hero_only(), hero_only: true, ..self }
    }
}

/// A material at the wavelengths of one path.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf {
    /// Perfectly matte.
    Lambertian(Lambertian),
    /// Reflects without blur and without regard to the angle.
    Mirror(Mirror),
    /// A polished boundary between transparent media.
    SmoothDielectric(SmoothDielectric),
    /// A ground boundary between transparent media.
    RoughDielectric(RoughDielectric),
    /// Polished metal.
    SmoothConductor(SmoothConductor),
    /// Brushed or blasted metal.
    RoughConductor(RoughConductor),
}

impl Bsdf {
    /// A dielectric of GGX roughness `alpha`, which is polished below [`Ggx::MIN_ALPHA`]
    /// or where no lane's refraction is blurred measurably.
    #[inline]
    pub fn dielectric(interface: Interface, alpha: f32) -> Self {
        if alpha >= Ggx::MIN_ALPHA {
            let rough = RoughDielectric { interface, facets: Ggx::isotropic(alpha) };
            if !rough.is_delta() {
                return Self::RoughDielectric(rough);
            }
        }
        Self::SmoothDielectric(SmoothDielectric { interface })
    }

    /// A conductor of relative index n + ik and GGX roughness `alpha`, which is polished
    /// below [`Ggx::MIN_ALPHA`].
    pub fn conductor(n: Spectrum, k: Spectrum, alpha: f32, two_sided: bool) -> Self {
        let metal = SmoothConductor { n, k, two_sided };
        if alpha >= Ggx::MIN_ALPHA {
            Self::RoughConductor(RoughConductor { metal, facets: Ggx::isotropic(alpha) })
        } else {
            Self::SmoothConductor(metal)
        }
    }

    /// `eval` and `pdf` at once, which share most of their work.
    #[inline]
    pub fn evaluate(&self, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> BsdfValue {
        match self {
            Self::Lambertian(model) => model.evaluate(wo, wi),
            Self::RoughDielectric(model) => model.evaluate(wo, wi, quantity),
            Self::RoughConductor(model) => model.evaluate(wo, wi),
            Self::Mirror(_) | Self::SmoothDielectric(_) | Self::SmoothConductor(_) => BsdfValue::ZERO,
        }
    }

    /// f(wo, wi) |cos(wi)| in sr^-1; zero for deltas.
    #[inline]
    pub fn eval(&self, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> Spectrum {
        self.evaluate(wo, wi, quantity).value
    }

    /// Density in sr^-1 with which `sample` draws `wi`; zero for deltas.
    #[inline]
    pub fn pdf(&self, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> Spectrum {
        match self {
            Self::Lambertian(model) => Spectrum::splat(model.pdf(wo, wi)),
            _ => self.evaluate(wo, wi, quantity).pdf,
        }
    }

    /// Draws where the path goes on, from three numbers in [0, 1): `u_lobe` chooses between
    /// reflection and transmission, `u` the direction within.
    ///
    /// Within a lobe the map is continuous and one to one. `None`: the path ends here.
    #[inline]
    pub fn sample(&self, wo: Vec3A, u_lobe: f32, u: [f32; 2], quantity: Quantity) -> Option<BsdfSample> {
        match self {
            Self::Lambertian(model) => model.sample(wo, u),
            Self::Mirror(model) => model.sample(wo),
            Self::SmoothDielectric(model) => model.sample(wo, u_lobe, quantity),
            Self::RoughDielectric(model) => model.sample(wo, u_lobe, u, quantity),
            Self::SmoothConductor(model) => model.sample(wo),
            Self::RoughConductor(model) => model.sample(wo, u),
        }
    }

    /// The two numbers `u` with which `sample` draws `wi`, once `u_lobe` has chosen the lobe on
    /// the side of `wi`; `None` for deltas and for directions that are never drawn.
    ///
    /// Directions given back differ by no more than the rounding of `f32`: that of directions,
    /// and that of the numbers, which tell the rims of hemispheres and caps coarsely.
    pub fn invert(&self, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> Option<[f32; 2]> {
        if self.pdf(wo, wi, quantity).hero() <= 0.0 {
            return None;
        }
        match self {
            Self::Lambertian(model) => Some(model.invert(wi)),
            Self::RoughDielectric(model) => model.invert(wo, wi),
            Self::RoughConductor(model) => model.invert(wo, wi),
            Self::Mirror(_) | Self::SmoothDielectric(_) | Self::SmoothConductor(_) => None,
        }
    }

    /// Probability with which `sample` chooses the lobe on the side of `wi`, for the hero.
    ///
    /// Between transparent media it is the share of Fresnel (reflected, or crossing) at the
    /// facet that joins the two directions, or at the surface for a delta, whichever `wi` of
    /// that side is asked for; zero where no facet joins them. 1 where there is no choice.
    pub fn lobe_probability(&self, wo: Vec3A, wi: Vec3A, quantity: Quantity) -> f64 {
        match self {
            Self::SmoothDielectric(model) => model.lobe_probability(wo, wi),
            Self::RoughDielectric(model) => model.lobe_probability(wo, wi, quantity),
            Self::Lambertian(_) | Self::RoughConductor(_) | Self::Mirror(_) | Self::SmoothConductor(_) => 1.0,
        }
    }

    /// Whether the model has deltas only, so that no light can be aimed at from here.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Mirror(_) | Self::SmoothDielectric(_) | Self::SmoothConductor(_) => true,
            Self::RoughDielectric(model) => model.is_delta(),
            Self::Lambertian(_) | Self::RoughConductor(_) => false,
        }
    }

    /// The n^2 factor that radiance took on by crossing to the side of `wi`, at the hero; 1
    /// where nothing crosses.
    #[inline]
    pub fn radiance_scale(&self, wi: Vec3A) -> f32 {
        self.index_squared(-wi) / self.index_squared(wi)
    }

    /// n^2 |cos| of a direction at the hero: with it the coefficients of a delta seen from
    /// either side belong to the same measure (see [`crate::measure`]).
    #[inline]
    pub fn delta_measure(&self, w: Vec3A) -> f32 {
        self.index_squared(w) * w.z.abs()
    }

    /// Square of the hero's index on the side of a direction relative to the outside.
    #[inline]
    fn index_squared(&self, w: Vec3A) -> f32 {
        let interface = match self {
            Self::SmoothDielectric(model) => model.interface,
            Self::RoughDielectric(model) => model.interface,
            _ => return 1.0,
        };
        let eta = 1.0 + interface.excess().hero();
        if w.z < 0.0 { eta * eta } else { 1.0 }
    }

    /// Whether light crosses to the other side.
    #[inline]
    pub fn transmits(&self) -> bool {
        matches!(self, Self::SmoothDielectric(_) | Self::RoughDielectric(_))
    }
}
