//! ISO, shutter and f-stop: how much light makes which level of the picture.
//!
//! The focal-plane exposure is H = q L t / N^2 (ISO 12232), with q = (pi/4) T v cos^4 (f/i)^2
//! for lens transmission T, mechanical vignetting v, an angle of ten degrees from the axis,
//! focal length f and image distance i. The standard's q = 0.65 stands for all of them. Where
//! one is stated by itself, it must leave q: with a vignetting model q is that of the axis, and
//! with a lens transmission, which is weighted wavelength by wavelength, it is (pi/4) (f/i)^2.

use crate::scene::file::Anchor;
use crate::units::{CandelasPerSquareMeter, FStop, Iso, Seconds};

/// The lens constant of ISO 12232 (T = 0.9, v = 0.98, 10 degrees).
pub const STANDARD_Q: f64 = 0.65;

/// The same on the optical axis, without the fall-off to 10 degrees: (pi/4) T v.
pub const STANDARD_Q_ON_AXIS: f64 = std::f64::consts::FRAC_PI_4 * 0.9 * 0.98;

/// The lens constant of a lens that passes everything, on the axis: (pi/4) (f/i)^2.
pub fn clear_lens_q(focal_length_mm: f64, image_distance_mm: f64) -> f64 {
    std::f64::consts::FRAC_PI_4 * (focal_length_mm / image_distance_mm).powi(2)
}

/// Saturation exposure of ISO 12232 in lx s at ISO 1: H_sat = 78 / S.
const SATURATION_LX_S: f64 = 78.0;
/// Exposure of the standard output sensitivity in lx s at ISO 1: H = 10 / S.
const SOS_LX_S: f64 = 10.0;
/// Calibration constant of reflected-light meters in cd s m^-2 (ISO 2720).
const METER_K: f64 = 12.5;
/// Level that standard output sensitivity and meters place their exposure at.
const MID_GREY: f64 = 0.18;

/// The exposure settings of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// Exposure index.
    pub iso: Iso,
    /// Exposure time.
    pub shutter: Seconds,
    /// f-number.
    pub f_stop: FStop,
    /// Lens constant q.
    pub q: f64,
    /// Which speed point fixes the developed level.
    pub anchor: Anchor,
}

impl Exposure {
    /// N^2 / (S t): luminances of equal meaning scale with it.
    fn scale(&self) -> f64 {
        self.f_stop.0 * self.f_stop.0 / (self.iso.0 * self.shutter.0)
    }

    /// Exposure value at ISO 100: log2(N^2 / t) - log2(S / 100).
    pub fn ev100(&self) -> f64 {
        (100.0 * self.scale()).log2()
    }

    /// Focal-plane exposure in lx s of a luminance: H = q L t / N^2.
    pub fn focal_plane_exposure_lx_s(&self, luminance: CandelasPerSquareMeter) -> f64 {
        self.q * luminance.0 * self.shutter.0 / (self.f_stop.0 * self.f_stop.0)
    }

    /// Luminance that just saturates the sensor: 78 N^2 / (q S t).
    pub fn saturation_luminance(&self) -> CandelasPerSquareMeter {
        CandelasPerSquareMeter(SATURATION_LX_S / self.q * self.scale())
    }

    /// Luminance that is developed to 1.0 (display white) under the chosen anchor.
    pub fn white_luminance(&self) -> CandelasPerSquareMeter {
        match self.anchor {
            Anchor::Saturation => self.saturation_luminance(),
            Anchor::Sos => CandelasPerSquareMeter(SOS_LX_S / self.q * self.scale() / MID_GREY),
            Anchor::Meter => CandelasPerSquareMeter(METER_K * self.scale() / MID_GREY),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sunny(anchor: Anchor) -> Exposure {
        Exposure {
            iso: Iso(100.0),
            shutter: Seconds(1.0 / 125.0),
            f_stop: FStop(16.0),
            q: STANDARD_Q,
            anchor,
        }
    }

    /// f/16, 1/125 s, ISO 100: EV 14.966 and 38 400 cd/m2 (ISO 12232 closed forms).
    #[test]
    fn sunny_sixteen_has_its_textbook_values() {
        let exposure = sunny(Anchor::Saturation);
        assert!((exposure.ev100() - 14.966).abs() < 5e-4);
        assert!((exposure.saturation_luminance().0 / 38_400.0 - 1.0).abs() < 1e-12);
        assert!((sunny(Anchor::Sos).white_luminance().0 * 0.18 - 4923.0).abs() < 0.1);
        assert!((sunny(Anchor::Meter).white_luminance().0 * 0.18 - 4000.0).abs() < 1e-9);
        let at_saturation = exposure.focal_plane_exposure_lx_s(exposure.saturation_luminance());
        assert!((at_saturation - 0.78).abs() < 1e-12);
    }

    /// 0.65 is (pi/4) 0.9 * 0.98 cos^4 of 10 degrees, rounded to two digits.
    #[test]
    fn the_standard_constant_is_the_axis_constant_at_ten_degrees() {
        let at_ten = STANDARD_Q_ON_AXIS * crate::camera::cos4(10.0_f64.to_radians().tan());
        assert!((at_ten - STANDARD_Q).abs() < 0.005, "{at_ten}");
        // A lens at life size stands twice its focal length from the image: two stops.
        assert!((clear_lens_q(50.0, 100.0) * 4.0 / clear_lens_q(50.0, 50.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn extremes_stay_finite_and_exact() {
        let at = |iso, shutter, stop| Exposure {
            iso: Iso(iso),
            shutter: Seconds(shutter),
            f_stop: FStop(stop),
            q: STANDARD_Q,
            anchor: Anchor::Saturation,
        };
        let dim = at(4e6, 3600.0, 0.5);
        let bright = at(1.0, 1.0 / 8000.0, 1000.0);
        assert!((dim.saturation_luminance().0 / 2.083_333_333_333e-9 - 1.0).abs() < 1e-9);
        assert!((bright.saturation_luminance().0 / 9.6e11 - 1.0).abs() < 1e-12);
        assert!((dim.ev100() + 29.1).abs() < 0.1 && (bright.ev100() - 39.5).abs() < 0.1);
    }
}
