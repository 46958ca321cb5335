//! The reference cases, as data: what each renders, with what, and what it is held against.
//! A new case is a folder in `reference/` and a line here.

use super::{growth, peers, self_test};
use etalon::error::{Error, Result};
use etalon::integrator::Integrator;

/// What a render is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// A photograph, or the region table measured on one.
    Photograph,
    /// The photographs of a camera with a wheel of narrow-band filters.
    Bands,
    /// Nothing but the exposure that its camera is set to.
    Exposure,
    /// A photograph, with what is unknown fitted on another one: the cases of both, the fitted
    /// first.
    Another([&'static str; 2]),
    /// Another renderer.
    Peer,
}

/// A reference case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// What it is called on the command line.
    pub name: &'static str,
    /// Its folder in `reference/`.
    pub folder: &'static str,
    /// What it is held against.
    pub against: Against,
    /// Algorithm where none is asked for.
    pub integrator: Integrator,
    /// Samples per pixel where nothing is said: a few minutes on two cores.
    pub samples_per_pixel: u64,
}

/// Every case, in the order of the index page.
pub const CASES: [Case; 10] = [
    Case::photographed("cornell", "cornell-photo"),
    Case::photographed("yale-grey", "yale-grey"),
    Case::photographed("yale-brown", "yale-brown"),
    Case::photographed("stanford", "stanford"),
    Case::photographed("stanford-left", "stanford-left"),
    Case::predicted("yale-cross", ["yale-grey", "yale-brown"]),
    Case::predicted("stanford-cross", ["stanford", "stanford-left"]),
    Case {
        against: Against::Exposure,
        integrator: Integrator::Bdpt,
        samples_per_pixel: 256,
        ..Case::photographed("schoedl", "schoedl-2007")
    },
    // Five times the pixels of the others.
    Case {
        against: Against::Bands,
        samples_per_pixel: 128,
        ..Case::photographed("cornell-ccd", "cornell-ccd")
    },
    Case { against: Against::Peer, samples_per_pixel: 8192, ..Case::photographed(peers::NAME, "cornell") },
];

impl Case {
    /// A case with a photograph, path-traced.
    const fn photographed(name: &'static str, folder: &'static str) -> Self {
        Self {
            name,
            folder,
            against: Against::Photograph,
            integrator: Integrator::Path,
            samples_per_pixel: 512,
        }
    }

    /// A photograph predicted from another; three pictures of each scene, of a lamp that is a point.
    const fn predicted(name: &'static str, cases: [&'static str; 2]) -> Self {
        Self { against: Against::Another(cases), samples_per_pixel: 128, ..Self::photographed(name, name) }
    }

    /// The case of a name.
    pub fn named(name: &str) -> Result<&'static Self> {
        let names = || CASES.iter().map(|case| case.name).chain([self_test::NAME, growth::NAME, "all"]);
        CASES.iter().find(|case| case.name == name).ok_or_else(|| Error::unknown_name("case", name, names()))
    }

    /// Whether `validate all` takes it in: peers need an environment of their own and much time.
    pub fn is_in_all(&self) -> bool {
        self.against != Against::Peer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_single_and_found() {
        for case in &CASES {
            assert_eq!(CASES.iter().filter(|other| other.name == case.name).count(), 1, "{}", case.name);
            assert_eq!(Case::named(case.name).expect("its own name").folder, case.folder);
        }
        let wrong = Case::named("cornel").expect_err("no such case").to_string();
        assert!(wrong.contains("did you mean \"cornell\"?"), "{wrong}");
    }
}
