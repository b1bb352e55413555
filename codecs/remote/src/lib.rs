// SPDX-License-Identifier: MIT
//! Objects of HTTP servers and buckets behind the C interface `include/pointsweep_remote.h`, which documents each
//! function. The library includes the codecs, since a program should link only one Rust library.
//!
//! `address`: the store and path that an address names, and the client. `failure`: errors as a status and a description.
//! `service`: the runtime that performs requests. `objects`: reading, listing and writing.

pub use pointsweep_codecs::*;

mod address;
mod c_interface;
mod failure;
mod objects;
mod service;
