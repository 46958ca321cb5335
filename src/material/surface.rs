//! A surface's description over all wavelengths, from which a path takes its [`Bsdf`].

use super::{Bsdf, Ggx, Interface, Lambertian, Mirror};
use crate::spectrum::{Dense, Wavelengths};

/// What a surface is made of.
#[derive(Clone, Debug)]
pub enum Material {
    /// Perfectly matte.
    Lambertian {
        /// Reflectance, 0 to 1.
        reflectance: Dense,
        /// Whether the back reflects; otherwise it is black.
        two_sided: bool,
    },
    /// Ideal mirror.
    Mirror {
        /// Reflectance at every angle, 0 to 1.
        reflectance: Dense,
        /// Whether the back reflects; otherwise it is black.
        two_sided: bool,
    },
    /// Boundary of a transparent medium.
    Dielectric {
        /// n_inside / n_outside - 1.
        excess_index: Dense,
        /// GGX roughness alpha; 0 is polished.
        roughness_alpha: f32,
        /// Absorption coefficient inside, per scene unit; `None` where nothing absorbs.
        absorption: Option<Dense>,
    },
    /// Metal.
    Conductor {
        /// Real part of the index.
        n: Dense,
        /// Imaginary part of the index.
        k: Dense,
        /// GGX roughness alpha; 0 is polished.
        roughness_alpha: f32,
        /// Whether the back reflects; otherwise it is black.
        two_sided: bool,
    },
}

impl Material {
    /// The material at the wavelengths of a path.
    #[inline]
    pub fn at(&self, wavelengths: &Wavelengths) -> Bsdf {
        match self {
            Self::Lambertian { reflectance, two_sided } => Bsdf::Lambertian(Lambertian {
                reflectance: reflectance.at(wavelengths),
                two_sided: *two_sided,
            }),
            Self::Mirror { reflectance, two_sided } => {
                Bsdf::Mirror(Mirror { reflectance: reflectance.at(wavelengths), two_sided: *two_sided })
            }
            Self::Dielectric { excess_index, roughness_alpha, .. } => {
                Bsdf::dielectric(Interface::from_excess(excess_index.at(wavelengths)), *roughness_alpha)
            }
            Self::Conductor { n, k, roughness_alpha, two_sided } => {
                Bsdf::conductor(n.at(wavelengths), k.at(wavelengths), *roughness_alpha, *two_sided)
            }
        }
    }

    /// What it is, in a word.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Lambertian { .. } => "lambertian",
            Self::Mirror { .. } => "mirror",
            Self::Dielectric { .. } => "dielectric",
            Self::Conductor { .. } => "conductor",
        }
    }

    /// Absorption coefficient per scene unit of the medium inside; `None` where light loses
    /// nothing.
    pub const fn absorption(&self) -> Option<&Dense> {
        match self {
            Self::Dielectric { absorption, .. } => absorption.as_ref(),
            _ => None,
        }
    }

    /// Whether light passes to the other side.
    pub const fn is_transparent(&self) -> bool {
        matches!(self, Self::Dielectric { .. })
    }

    /// Whether different wavelengths leave in different directions.
    pub const fn disperses(&self) -> bool {
        matches!(self, Self::Dielectric { excess_index, .. } if !excess_index.is_flat())
    }

    /// Whether the surface has ideal reflection or refraction, which no light can be aimed
    /// through; a roughness below [`Ggx::MIN_ALPHA`] is none.
    pub fn is_smooth(&self) -> bool {
        match self {
            Self::Lambertian { .. } => false,
            Self::Mirror { .. } => true,
            Self::Dielectric { roughness_alpha, .. } | Self::Conductor { roughness_alpha, .. } => {
                *roughness_alpha < Ggx::MIN_ALPHA
            }
        }
    }
}
