// SPDX-License-Identifier: MIT
//! Encodes one chunk.

use crate::{Error, Layout};
use laz::compressors::IntegerCompressorBuilder;
use laz::encoders::ArithmeticEncoder;
use laz::record::{LayeredPointRecordCompressor, RecordCompressor, SequentialPointRecordCompressor};

/// Compresses whole records, at least one, to a chunk.
pub fn encode(layout: &Layout, records: &[u8]) -> Result<Vec<u8>, Error> {
    let room = Vec::with_capacity(records.len() / 2);
    let mut compressor: Box<dyn RecordCompressor<Vec<u8>>> = if layout.is_layered() {
        Box::new(LayeredPointRecordCompressor::new(room))
    } else {
        Box::new(SequentialPointRecordCompressor::new(room))
    };
    compressor.set_fields_from(layout.items())?;
    for record in records.chunks_exact(layout.record_bytes()) {
        compressor.compress_next(record)?;
    }
    compressor.done()?;
    Ok(compressor.box_into_inner())
}

/// Returns a chunk table. `chunks`: number of points and of compressed bytes of each chunk.
pub fn write_chunk_table(layout: &Layout, chunks: &[(u64, u64)]) -> Result<Vec<u8>, Error> {
    let count = u32::try_from(chunks.len()).map_err(|_| Error("there are too many chunks".into()))?;
    let mut table = [0u32.to_le_bytes(), count.to_le_bytes()].concat();
    if chunks.is_empty() {
        return Ok(table);
    }
    let mut encoder = ArithmeticEncoder::new(&mut table);
    let mut compressor = IntegerCompressorBuilder::new().bits(32).contexts(2).build_initialized();
    let mut last = (0, 0);
    for &(points, bytes) in chunks {
        if layout.is_variable() {
            compressor.compress(&mut encoder, last.0 as i32, points as i32, 0)?;
        }
        compressor.compress(&mut encoder, last.1 as i32, bytes as i32, 1)?;
        last = (points, bytes);
    }
    encoder.done()?;
    Ok(table)
}
