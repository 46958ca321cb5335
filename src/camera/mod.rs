//! From radiance to a picture: lens, exposure, sensor, film, electrons, development.
//!
//! The chain, and where each link of it is. Names are those of the stages that `etalon check`,
//! `etalon develop` and the record of a render list.
//!
//! 1. `lens_transmission`: T(l), by wavelength, in the film's `sensor.*` channels
//!    ([`Sensor::behind`]).
//! 2. `vignetting`: v(x), relative to the axis ([`Vignetting`]).
//! 3. `exposure`: H = q L t / N^2 ([`Exposure`]), ISO 12232.
//! 4. `sensitivity`: what a channel holds is the integral over l of r(l) T(l) L(l) ([`Sensor`]).
//! 5. `electrons`, `full_well`, `dark_current`, `shot_noise`, `read_noise`, `digital_values`:
//!    the linear model of EMVA 1288 ([`Electronics`]).
//! 6. `white_balance`, `matrix`, `tone`: development ([`Darkroom`]).
//!
//! Together, for a pixel of area A and the channel's value F in the film,
//!
//! ```text
//! electrons = A (q t / N^2) v F QE / (h c max_l(r(l) / l)) + dark current t
//! digital   = black + electrons / gain, rounded, within 0 .. 2^bits - 1
//! value     = (digital - black) gain - dark signal, back on the scale of F
//! picture   = tone(matrix(value / what the channel holds of the white) / white luminance)
//! ```
//!
//! with the value cut off where the first channel is full for the white, so that highlights are
//! white, the quantum efficiency QE where it is largest and the gain in electrons per number,
//! in inverse proportion to the ISO setting.
//!
//! What depends on wavelength happens while rendering; all else happens after it, from numbers
//! that the EXR holds ([`CameraRecord`]), so that it can be changed later. The film is
//! scene-referred: neither exposure, nor vignetting, nor noise is in it.
//!
//! Sources: ISO 12232:2019 (speed points, q), ISO 2720 (meters), EMVA Standard 1288 release 4.0
//! (electrons, noise, gain), IEC 61966-2-1 (sRGB), Lam 1985 (Bradford).

mod cells;
mod darkroom;
mod develop;
mod electrons;
mod exposure;
mod film;
mod fit;
mod lens;
mod noise;
mod picture_error;
mod record;
mod sensor;
mod stages;
mod vignetting;
mod witnesses;

pub(crate) use cells::CellGrid;
pub use cells::{CellErrors, LevelErrors};
pub use darkroom::{Darkroom, Planes, planes, shows_recorded};
pub use develop::{Development, Matrix, MatrixTarget, Tone};
pub use electrons::{
    Count, Counter, Digital, Electronics, Noise, electrons_per_weighted_joule, photons_per_um2_lx_s,
};
pub use exposure::{Exposure, STANDARD_Q, STANDARD_Q_ON_AXIS, clear_lens_q};
pub use film::{BlockStatistics, Film};
pub(crate) use film::{Finished, LUMINANCE};
pub use lens::{Camera, CameraPlacement, Crop, LensAperture};
pub use picture_error::PictureError;
pub use record::{CameraRecord, ChannelRecord, Optics, Responses, Seen, White};
pub use sensor::{CIE_SENSOR, Channel, Detector, Sensor};
pub use stages::{SWITCHES, Stage};
pub use vignetting::{Coordinate, FLAT_FIELD_CHANNEL, FlatField, Vignetting, cos4};
pub use witnesses::batch_numbers;
pub(crate) use witnesses::{Batches, Scatter};
