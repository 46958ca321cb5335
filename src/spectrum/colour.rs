//! From spectra to the numbers that people name colours and lamps by.
//!
//! Sums over the 1 nm grid with the CIE 1931 2 degree observer, as CIE 015 has it.

use super::curve::Curve;
use super::library;
use super::wavelengths::{FIRST_NM, GRID_POINTS, LAST_NM, between_grid_points, grid_nm};
use crate::units::Kelvin;
use crate::units::constants::LUMINOUS_EFFICACY_LM_W;
use std::sync::LazyLock;

/// CIE 1931 tristimulus values; Y carries the unit of the quantity (cd/m2 for radiance).
pub type Xyz = [f64; 3];

/// The CIE 1931 2 degree observer at 1 nm.
pub struct Observer {
    /// x-bar, y-bar, z-bar at each grid point.
    pub matching: [[f64; GRID_POINTS]; 3],
}

/// The standard observer, read once from the built-in table.
pub static CIE_1931: LazyLock<Observer> = LazyLock::new(|| {
    let table = library::table("cie-1931-2deg").expect("the observer is built in");
    let column = |name: &str| -> [f64; GRID_POINTS] {
        let values = table.column(name).expect("the observer has columns x, y, z");
        values.try_into().expect("the observer covers the grid at 1 nm")
    };
    Observer { matching: [column("x"), column("y"), column("z")] }
});

/// Tristimulus values of a spectral quantity at the grid points, per nm: 683 lm/W times the
/// sums with the matching functions.
pub fn xyz_of_grid(values: &[f64]) -> Xyz {
    CIE_1931.matching.each_ref().map(|matching| {
        let sum: f64 = matching.iter().zip(values).map(|(m, v)| m * v).sum();
        LUMINOUS_EFFICACY_LM_W * sum
    })
}

/// Tristimulus values of one unit of power at a wavelength from 360 to 830 nm: 683 lm/W times
/// the matching functions there; zero at other wavelengths.
pub fn xyz_at(nm: f64) -> Xyz {
    if !(FIRST_NM..=LAST_NM).contains(&nm) {
        return [0.0; 3];
    }
    CIE_1931.matching.each_ref().map(|matching| LUMINOUS_EFFICACY_LM_W * between_grid_points(matching, nm))
}

/// Tristimulus values of a curve in absolute units.
pub fn xyz_of(curve: &Curve) -> Xyz {
    let values: Vec<f64> = grid_nm().map(|nm| curve.at(nm)).collect();
    xyz_of_grid(&values)
}

/// Chromaticity (x, y) of a curve by its shape alone, so that it exists for bodies too cold
/// to shine in f64; `None` for black.
pub fn chromaticity_of(curve: &Curve) -> Option<[f64; 2]> {
    xy_of(xyz_of_grid(&curve.shape(grid_nm())))
}

/// Chromaticity (x, y); `None` for black.
pub fn xy_of(xyz: Xyz) -> Option<[f64; 2]> {
    let sum: f64 = xyz.iter().sum();
    (sum > 0.0).then(|| [xyz[0] / sum, xyz[1] / sum])
}

/// CIE 1960 uniform chromaticity (u, v) from (x, y).
pub fn uv_1960([x, y]: [f64; 2]) -> [f64; 2] {
    let denominator = -2.0 * x + 12.0 * y + 3.0;
    [4.0 * x / denominator, 6.0 * y / denominator]
}

/// Correlated colour temperature and distance from the Planckian locus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourTemperature {
    /// Temperature of the black body nearest in CIE 1960 (u, v).
    pub kelvin: Kelvin,
    /// Signed distance, positive above the locus (greenish).
    pub duv: f64,
}

/// The correlated colour temperature of a chromaticity, sought from 1000 K to 100 000 K.
///
/// `None` farther than 0.05 from the locus, where CIE 015 no longer defines it. Golden
/// section search on the distance itself over the reciprocal temperature.
pub fn colour_temperature(xy: [f64; 2]) -> Option<ColourTemperature> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    const FARTHEST: f64 = 0.05;
    /// The locus at the reciprocal temperatures of the coarse scan: a scene may have thousands
    /// of lamps, each of which needs them all.
    static COARSE: LazyLock<Vec<(f64, [f64; 2])>> =
        LazyLock::new(|| (10..=1000).step_by(15).map(f64::from).map(|mired| (mired, locus(mired))).collect());
    let target = uv_1960(xy);
    let apart = |[u, v]: [f64; 2]| (u - target[0]).hypot(v - target[1]);
    let distance = |mired: f64| apart(locus(mired));
    // A coarse scan first: the distance has more than one minimum over the whole range.
    let (best, _) = *COARSE.iter().min_by(|(_, a), (_, b)| apart(*a).total_cmp(&apart(*b)))?;
    let (mut low, mut high) = ((best - 15.0).max(10.0), (best + 15.0).min(1000.0));
    while high - low > 1e-4 {
        let span = (high - low) * GOLDEN;
        if distance(high - span) < distance(low + span) {
            high = low + span;
        } else {
            low = high - span;
        }
    }
    let mired = 0.5 * (low + high);
    let duv = distance(mired).copysign(target[1] - locus(mired)[1]);
    (duv.abs() <= FARTHEST && mired > 10.5 && mired < 999.5)
        .then_some(ColourTemperature { kelvin: Kelvin(1e6 / mired), duv })
}

/// CIE 1960 (u, v) of a black body of 1e6 K over `mired`.
fn locus(mired: f64) -> [f64; 2] {
    let body = Curve::Blackbody(Kelvin(1e6 / mired));
    uv_1960(chromaticity_of(&body).expect("a black body has a chromaticity"))
}

/// Linear sRGB (ITU-R BT.709 primaries, D65 white) from XYZ on the same scale; values
/// outside 0..1 are colours outside the gamut or the range.
pub fn xyz_to_linear_srgb([x, y, z]: Xyz) -> [f64; 3] {
    // IEC 61966-2-1, inverse of the primaries' matrix with white (0.3127, 0.3290).
    [
        3.240_969_941_904_521 * x - 1.537_383_177_570_093 * y - 0.498_610_760_293_003 * z,
        -0.969_243_636_280_879 * x + 1.875_967_501_507_72 * y + 0.041_555_057_407_175 * z,
        0.055_630_079_696_993 * x - 0.203_976_958_888_976 * y + 1.056_971_514_242_878 * z,
    ]
}

/// The sRGB encoding of a linear value in 0..1 (IEC 61966-2-1).
pub fn srgb_encode(linear: f64) -> f64 {
    let v = linear.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Adapts tristimulus values from one white to another: Bradford cone space, complete
/// adaptation.
pub fn adapt(xyz: Xyz, from_white: Xyz, to_white: Xyz) -> Xyz {
    use glam::{DMat3, DVec3};
    // Lam 1985; the rows are the cone responses.
    let bradford = DMat3::from_cols_array_2d(&[
        [0.8951, -0.7502, 0.0389],
        [0.2664, 1.7135, -0.0685],
        [-0.1614, 0.0367, 1.0296],
    ]);
    let cones = |white: Xyz| bradford * DVec3::from_array(white);
    let gains = cones(to_white) / cones(from_white);
    (bradford.inverse() * (gains * (bradford * DVec3::from_array(xyz)))).to_array()
}
