//! Two pictures compared: how often equal ones are called different, what faults are found, and
//! what the program makes of files of any renderer.

#[path = "../common/mod.rs"]
mod common;
mod files;
mod foreign;
mod rates;
mod written;
