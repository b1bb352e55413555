// SPDX-License-Identifier: MIT
//! Objects of HTTP servers and buckets behind a C interface, `include/pointsweep_remote.h`, which says what each function
//! does, and the codecs, since a program links one library of Rust.
//!
//! `address`: what an address names, and the client for it. `failure`: what went wrong, as a status and some words.
//! `service`: the runtime that performs requests. `objects`: reading, listing and writing.

pub use pointsweep_codecs::*;

mod address;
mod c_interface;
mod failure;
mod objects;
mod service;
