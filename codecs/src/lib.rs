// SPDX-License-Identifier: MIT
//! Compressed point formats behind the C interface `include/pointsweep_codecs.h`, which documents each function.
//!
//! `laz_*`: LASzip. `e57_scan`, `e57_writer`: E57. `boundary`: errors as text, and caught panics.

mod boundary;
mod e57_scan;
mod e57_writer;
mod laz_decoder;
mod laz_encoder;
mod laz_layout;
mod owned;

pub use boundary::{put_text, quietly, Error};
pub use e57_scan::{name_of, Contents, ScanReader};
pub use e57_writer::{About, Attribute, File, ScanWriter};
pub use laz_decoder::{Decoder, Source};
pub use laz_encoder::{encode, write_chunk_table};
pub use laz_layout::{Layout, VARIABLE_CHUNKS};
pub(crate) use owned::Owned;

mod c_interface;
