//! What a plan leaves out, and that nothing changes without it.
//!
//! `needs` holds scenes against what they are expected to need; `same` renders them bare and in
//! full; `page` holds what plans say they save against `validation/plan.md`.

#[path = "../common/mod.rs"]
mod common;
mod needs;
mod page;
mod same;
mod scenes;
