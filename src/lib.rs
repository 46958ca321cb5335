//! Etalon renders scenes given in physical units into pictures that can be held against a
//! photograph, with the error stated.
//!
//! Every pixel is an integral over wavelengths, lens, pixel area and light paths of
//!
//! ```text
//! L(x, w, l) = Le(x, w, l) + integral over wi of f(x, w, wi, l) |cos wi| L(y, -wi, l)
//!              `- light       `- material         `- geometry finds y
//! picture(c) = integral over l of response_c(l) L(camera ray, l)
//!              `- spectrum, camera::Sensor       `- camera, integrator
//! ```
//!
//! (Kajiya 1986), and each factor has its module. The way of a render:
//! [`mod@scene::file`] (what the JSON says) is resolved into a [`scene::Scene`] (which cannot be
//! wrong), [`scene::Plan`] says what that scene needs, [`integrator::render`] fills a
//! [`camera::Film`] in absolute units, [`image`] writes it with its facts and develops it.
//!
//! # Words
//!
//! * *lane*: one of the wavelengths that a path carries; the *hero* is lane 0.
//! * *throughput*: what a path has multiplied up so far, per lane.
//! * *eye*: the camera or instrument that a path ends at; *subpath*: a walk from a light or
//!   from the eye; *strategy* (s, t): a path made of s vertices from a light and t from the eye.
//! * *bsdf*, *pdf*: scattering function and density; a pdf is per solid angle unless its
//!   name says otherwise.
//! * *delta*: a Dirac delta, stored by its coefficient.
//! * *scene unit*: a power of two of metres in which everything fits a box of about unit
//!   size; *luminance* in cd/m2, *radiance* in W sr^-1 m^-2 nm^-1 whatever the scene unit.
//! * *block*: samples of a pixel that are stratified together; blocks are independent.
//!
//! # Cargo features
//!
//! All are on by default. A library that only traces light needs none of them
//! (`default-features = false`): it reads scenes and spectra, renders films and tests them.
//!
//! * `cli`: the program, and every feature below.
//! * `meshes`: PLY and OBJ files. `exr`: OpenEXR files. `pictures`: developed pictures in PNG,
//!   TIFF, JPEG and EXR, flat fields from files; brings `exr`.
//! * `checkpoints`: runs that can be interrupted. `schema`: JSON Schema of the scene format.
//!   `harness`: the Python side.
//!
//! What a scene asks for and a build has not is an error that names the feature.
//!
//! # What it does not do
//!
//! No RGB in transport, no polarisation, no fluorescence, no diffraction, no clamping of
//! bright samples, no fixed epsilon.

pub mod camera;
pub mod error;
pub mod geometry;
pub mod image;
pub mod input;
pub mod integrator;
pub mod light;
pub mod material;
pub mod measure;
pub mod metropolis;
pub mod path;
pub mod pilot;
#[cfg(feature = "harness")]
pub mod python;
pub mod replay;
pub mod sampler;
pub mod scene;
pub mod spectrum;
pub mod statistics;
pub mod units;
