//! From radiance to a picture: lens, exposure, sensor, film, development.

mod develop;
mod exposure;
mod film;
mod lens;
mod sensor;

pub use develop::Development;
pub use exposure::{Exposure, STANDARD_Q};
pub use film::{BlockStatistics, Film};
pub use lens::{Camera, CameraPlacement, LensAperture};
pub use sensor::{CIE_SENSOR, Channel, Sensor, uncovered_share};
