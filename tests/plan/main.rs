//! What a plan leaves out, and that nothing changes without it.
//!
//! `needs` holds scenes against what they are expected to need; `same` renders them bare and in
//! full; `measure` finds out what is saved, and `page` writes it down.

#[path = "../common/mod.rs"]
mod common;
mod measure;
mod needs;
mod page;
mod same;
mod scenes;
