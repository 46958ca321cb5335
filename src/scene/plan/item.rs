//! One decision of a plan, with its reason and what it saves.

use super::leaving::Leaving;
use super::savings::{Saving, saving_of};
use serde::Serialize;
use std::fmt;

/// What became of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Decision {
    /// The scene does not need it.
    #[serde(rename = "left out")]
    LeftOut,
    /// The scene needs it, or it was asked for.
    #[serde(rename = "kept")]
    Kept,
}

impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::LeftOut { "left out" } else { "kept" })
    }
}

/// A decision.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Item {
    /// What it is about: one of [`super::ITEMS`].
    pub name: &'static str,
    /// Whether it is left out.
    pub decision: Decision,
    /// Why, in plain words.
    pub reason: String,
    /// What leaving it out saves where that was measured; `None` for what is kept or was not
    /// measured.
    pub saves: Option<Saving>,
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)?;
        self.saves.as_ref().map_or(Ok(()), |saving| write!(f, "; {saving}"))
    }
}

/// The decisions of a plan, as they are taken.
pub(super) struct Decisions<'l> {
    pub leaving: &'l Leaving,
    pub items: Vec<Item>,
    /// Whether light is followed as well, so that a saving of such a render is shown.
    pub both_ends: bool,
}

impl Decisions<'_> {
    /// Leaves an item out where it is not needed and may be, and says why; whether it did.
    pub fn leave_out(&mut self, name: &'static str, unneeded: bool, reason: &str, needed: &str) -> bool {
        let left_out = unneeded && self.leaving.may(name);
        let reason = match (unneeded, left_out) {
            (true, true) => reason.to_owned(),
            (true, false) => format!("kept as asked for, though {reason}"),
            (false, _) => needed.to_owned(),
        };
        let decision = if left_out { Decision::LeftOut } else { Decision::Kept };
        let saves = if left_out { saving_of(name, self.both_ends) } else { None };
        if !reason.is_empty() {
            self.items.push(Item { name, decision, reason, saves });
        }
        left_out
    }
}
