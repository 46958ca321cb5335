//! What a plan may leave out.
//!
//! Ordinarily everything that a scene does not need. Single items can be kept all the same, to
//! measure what they cost and to show that the picture does not change without them; so each
//! has a name, and a setting is written as users type it: `lean`, `full`, or `keep=media,lens`.

use crate::error::{Error, Result};
use std::fmt;
use std::str::FromStr;

/// Everything that a plan may leave out, by the names that users give.
pub const ITEMS: [&str; 13] = [
    OUTER_WAVELENGTHS,
    EVEN_WAVELENGTHS,
    LANE_DENSITIES,
    MEDIA,
    LENS,
    LAMP_CHOICE,
    MEETS_LIGHTS,
    ASKS_LIGHTS,
    JOINS,
    ASKS_EYE,
    DIRECT_ASKS_EYE,
    LIGHT_TO_EYE,
    MEETS_EYE,
];

/// Wavelengths at which nothing shines or nothing responds.
pub const OUTER_WAVELENGTHS: &str = "outer-wavelengths";
/// Drawing all wavelengths alike.
pub const EVEN_WAVELENGTHS: &str = "even-wavelengths";
/// Densities of a path under each of its wavelengths.
pub const LANE_DENSITIES: &str = "lane-densities";
/// Knowing what a path travels through.
pub const MEDIA: &str = "media";
/// Points of the lens.
pub const LENS: &str = "lens";
/// Numbers that choose among lamps.
pub const LAMP_CHOICE: &str = "lamp-choice";
/// Strategy s = 0.
pub const MEETS_LIGHTS: &str = "meets-lights";
/// Strategies s = 1, t > 1.
pub const ASKS_LIGHTS: &str = "asks-lights";
/// Strategies s > 1, t > 1.
pub const JOINS: &str = "joins";
/// Strategies s > 1, t = 1.
pub const ASKS_EYE: &str = "asks-eye";
/// Strategy s = 2, t = 1.
pub const DIRECT_ASKS_EYE: &str = "direct-asks-eye";
/// Strategy s = t = 1.
pub const LIGHT_TO_EYE: &str = "light-to-eye";
/// Strategy t = 0.
pub const MEETS_EYE: &str = "meets-eye";

/// A choice of items that may be left out where a scene does not need them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaving {
    /// Bit by bit, in the order of [`ITEMS`]: those that are kept in any case.
    kept: u32,
}

impl Leaving {
    const EVERY: u32 = (1 << ITEMS.len()) - 1;

    /// Everything may be left out.
    pub const fn all() -> Self {
        Self { kept: 0 }
    }

    /// Nothing may: the full plan.
    pub const fn none() -> Self {
        Self { kept: Self::EVERY }
    }

    /// Everything but some items.
    ///
    /// # Errors
    /// A name that is none of [`ITEMS`].
    pub fn all_but<'n>(names: impl IntoIterator<Item = &'n str>) -> Result<Self> {
        let mut kept = 0;
        for name in names {
            let place = ITEMS.iter().position(|item| *item == name);
            let place = place.ok_or_else(|| Error::unknown_name("plan item", name, ITEMS))?;
            kept |= 1 << place;
        }
        Ok(Self { kept })
    }

    /// Whether an item of [`ITEMS`] may be left out.
    pub fn may(&self, name: &str) -> bool {
        let place = ITEMS.iter().position(|item| *item == name);
        place.is_some_and(|place| self.kept & 1 << place == 0)
    }
}

impl Default for Leaving {
    fn default() -> Self {
        Self::all()
    }
}

impl fmt::Display for Leaving {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kept {
            0 => write!(f, "lean"),
            Self::EVERY => write!(f, "full"),
            _ => {
                let kept: Vec<&str> = ITEMS.into_iter().filter(|item| !self.may(item)).collect();
                write!(f, "keep={}", kept.join(","))
            }
        }
    }
}

impl FromStr for Leaving {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match (text, text.strip_prefix("keep=")) {
            ("lean", _) => Ok(Self::all()),
            ("full", _) => Ok(Self::none()),
            (_, Some(names)) => Self::all_but(names.split(',').map(str::trim)),
            _ => Err(Error::new(format!("there is no plan \"{text}\""))
                .hint(format!("give lean, full, or keep= and names of {}", ITEMS.join(", ")))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_come_back_from_their_words() {
        for text in ["lean", "full", "keep=media", "keep=outer-wavelengths,meets-eye"] {
            assert_eq!(text.parse::<Leaving>().expect(text).to_string(), text);
        }
        let every = format!("keep={}", ITEMS.join(","));
        assert_eq!(every.parse::<Leaving>().expect("all items"), Leaving::none());
        for wrong in ["", "bare", "keep=", "keep=medium", "full,media"] {
            assert!(wrong.parse::<Leaving>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_item_that_is_kept_is_not_left_out() {
        for item in ITEMS {
            let leaving = Leaving::all_but([item]).expect("an item");
            ITEMS.iter().for_each(|other| assert_eq!(leaving.may(other), *other != item));
            assert!(Leaving::all().may(item) && !Leaving::none().may(item));
        }
        assert!(!Leaving::all().may("anything else"));
    }
}
