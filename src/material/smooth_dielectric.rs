//! Polished glass: one mirrored and one refracted ray.
//!
//! All wavelengths are mirrored alike and differ in the share only. They stay together in
//! refraction when their indices are equal bit for bit; otherwise the hero goes on alone.

use glam::Vec3A;

use super::facing::{Upright, mirrored};
use super::fresnel::Shares;
use super::{BsdfSample, Interface, Quantity};
use crate::spectrum::{LANES, Spectrum};

/// Two deltas, chosen between by the hero's Fresnel reflectance; `+z` is outside.
#[derive(Clone, Copy, Debug)]
pub struct SmoothDielectric {
    /// The relative index.
    pub interface: Interface,
}

impl SmoothDielectric {
    pub(super) fn sample(&self, wo: Vec3A, u_lobe: f32, quantity: Quantity) -> Option<BsdfSample> {
        let upright = Upright::of(wo)?;
        let seen = self.interface.seen_from(wo.z > 0.0);
        let hero = seen.shares(0, wo.z.abs());
        let is_flat = seen.is_flat();
        let shares: [Shares; LANES] =
            if is_flat { [hero; LANES] } else { std::array::from_fn(|lane| seen.shares(lane, wo.z.abs())) };
        let reflects = u_lobe < hero.reflected as f32 || hero.crossing == 0.0;
        let sample = |wi, value, pdf| BsdfSample {
            wi,
            value,
            pdf,
            is_delta: true,
            is_transmission: !reflects,
            hero_only: false,
        };
        if reflects {
            let reflected = Spectrum::from_fn(|lane| shares[lane].reflected as f32);
            return Some(sample(mirrored(wo), reflected, reflected));
        }
        let transmitted = Spectrum::from_fn(|lane| shares[lane].crossing as f32);
        let value = match quantity {
            Quantity::Importance => transmitted,
            Quantity::Radiance => {
                transmitted.zip(Spectrum::from_fn(|lane| seen.eta(lane)), |share, eta| share / (eta * eta))
            }
        };
        let wi = upright.turn(refracted(upright.turn(wo), &seen)?);
        let together = sample(wi, value, transmitted);
        Some(if is_flat { together } else { together.for_hero_only() })
    }

    /// Probability of the delta on the side of `wi`.
    pub(super) fn lobe_probability(&self, wo: Vec3A, wi: Vec3A) -> f64 {
        let shares = self.interface.seen_from(wo.z > 0.0).shares(0, wo.z.abs());
        shares.of_lobe(wo.z * wi.z)
    }
}

/// The hero's refracted direction for `wo` above; `None` in total reflection.
fn refracted(wo: Vec3A, seen: &Interface) -> Option<Vec3A> {
    let q_squared = wo.z * wo.z + seen.eta_squared_minus_one(0);
    (q_squared > 0.0).then(|| Vec3A::new(-wo.x, -wo.y, -q_squared.sqrt()) / seen.eta(0))
}
