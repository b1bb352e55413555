// SPDX-License-Identifier: MIT
//! The content of the LASzip VLR: the parts of a record, their compression, and the size of chunks.

use crate::Error;
use laz::laszip::{ChunkTable, CompressorType};
use laz::{LazItem, LazItemType, LazVlr, LazVlrBuilder};
use std::io::Cursor;

/// The value of `chunk_points` if the chunk table states the points of each chunk.
pub const VARIABLE_CHUNKS: u32 = 0;
/// The value of `chunk_points` if all points are in one run, without a chunk table.
pub const NO_CHUNKS: u32 = u32::MAX;

pub struct Layout {
    vlr: LazVlr,
    record_bytes: usize,
    chunk_points: u32,
}

impl Layout {
    pub fn parse(vlr: &[u8]) -> Result<Self, Error> {
        let compressor = u16::from_le_bytes(*vlr.first_chunk().ok_or_else(too_short)?);
        let coder = u16::from_le_bytes(*vlr.get(2..).and_then(|b| b.first_chunk()).ok_or_else(too_short)?);
        if coder != 0 {
            return Err(Error(format!("its entropy coder {coder} is unknown")));
        }
        let parsed = LazVlr::from_buffer(vlr)?;
        let chunk_points = match compressor {
            c if c == CompressorType::PointWise as u16 => NO_CHUNKS,
            c if c == CompressorType::PointWiseChunked as u16 || c == CompressorType::LayeredChunked as u16 => {
                if parsed.uses_variable_size_chunks() {
                    VARIABLE_CHUNKS
                } else {
                    parsed.chunk_size()
                }
            }
            c => return Err(Error(format!("its compressor {c} is unknown"))),
        };
        let layered = compressor == CompressorType::LayeredChunked as u16;
        if parsed.items().iter().any(|item| (item.version() >= 3) != layered) {
            return Err(Error("it mixes parts in layers with others".into()));
        }
        Ok(Self { record_bytes: record_bytes(parsed.items())?, vlr: parsed, chunk_points })
    }

    pub fn for_format(point_format: u8, extra_bytes: u16, chunk_points: u32) -> Result<Self, Error> {
        let parts = LazVlrBuilder::default().with_point_format(point_format, extra_bytes)?;
        let built = match chunk_points {
            VARIABLE_CHUNKS => parts.with_variable_chunk_size(),
            fixed => parts.with_fixed_chunk_size(fixed),
        }
        .build();
        let vlr = LazVlr::from_buffer(with_wave_packets_of_version_1(bytes_of(&built)))?;
        Ok(Self { record_bytes: record_bytes(vlr.items())?, vlr, chunk_points })
    }

    pub fn record_bytes(&self) -> usize {
        self.record_bytes
    }

    /// Returns the points in each chunk but the last, or `VARIABLE_CHUNKS` or `NO_CHUNKS`.
    pub fn chunk_points(&self) -> u32 {
        self.chunk_points
    }

    pub fn is_variable(&self) -> bool {
        self.chunk_points == VARIABLE_CHUNKS
    }

    pub fn is_layered(&self) -> bool {
        self.vlr.items().first().is_some_and(|item| item.version() >= 3)
    }

    pub fn items(&self) -> &Vec<LazItem> {
        self.vlr.items()
    }

    /// Returns the number of layers in a chunk, for compression in layers. The sizes of all layers come before the first
    /// layer.
    pub fn layers(&self) -> usize {
        let of = |item: &LazItem| match item.item_type() {
            LazItemType::Point14 => 9,
            LazItemType::RGBNIR14 => 2,
            LazItemType::Byte14(bytes) => bytes as usize,
            _ => 1,
        };
        self.items().iter().map(of).sum()
    }

    pub fn vlr(&self) -> Vec<u8> {
        bytes_of(&self.vlr)
    }

    /// Returns the number of points (0 unless `is_variable()`) and of compressed bytes of each chunk, or an error if the
    /// table does not state `count` chunks.
    pub fn read_chunk_table(&self, table: &[u8], count: usize) -> Result<Vec<(u64, u64)>, Error> {
        let claimed = u32::from_le_bytes(*table.get(4..).and_then(|b| b.first_chunk()).ok_or_else(too_short)?);
        if claimed as usize != count {
            return Err(Error(format!("its chunk table has {claimed} chunks instead of {count}")));
        }
        let read = ChunkTable::read(&mut Cursor::new(table), self.is_variable())?;
        // The crate `laz` extends numbers of 32 bits by their sign.
        let plain = |number: u64| u64::from(number as u32);
        Ok((0..read.len()).map(|i| (plain(read[i].point_count), plain(read[i].byte_count))).collect())
    }
}

fn too_short() -> Error {
    Error("the compressed data end too early".into())
}

fn bytes_of(vlr: &LazVlr) -> Vec<u8> {
    let mut bytes = Vec::new();
    vlr.write_to(&mut bytes).expect("a vector takes all bytes");
    bytes
}

/// Sets the version of wave packets in point formats 4 and 5 to 1. LASzip refuses files that state another version; the
/// crate `laz` states 2, although the compressed bytes are those of version 1.
fn with_wave_packets_of_version_1(mut vlr: Vec<u8>) -> Vec<u8> {
    const ITEMS: usize = 34;
    let wave_packet = u16::from(LazItemType::WavePacket13).to_le_bytes();
    for item in vlr[ITEMS..].chunks_exact_mut(6).filter(|item| item[..2] == wave_packet) {
        item[4..].copy_from_slice(&1u16.to_le_bytes());
    }
    vlr
}

/// Returns the bytes of a record, or an error if a part does not have the size of its type. The crate `laz` relies on
/// these sizes.
fn record_bytes(items: &[LazItem]) -> Result<usize, Error> {
    if items.is_empty() {
        return Err(Error("it names no part of a record".into()));
    }
    let mut sum = 0;
    for item in items {
        let size = match item.item_type() {
            LazItemType::Byte(size) | LazItemType::Byte14(size) => size,
            LazItemType::Point10 => 20,
            LazItemType::GpsTime => 8,
            LazItemType::RGB12 | LazItemType::RGB14 => 6,
            LazItemType::RGBNIR14 => 8,
            LazItemType::WavePacket13 | LazItemType::WavePacket14 => 29,
            LazItemType::Point14 => 30,
        };
        if item.size() != size || size == 0 {
            return Err(Error(format!("a part of its records has {} bytes instead of {size}", item.size())));
        }
        sum += size as usize;
    }
    Ok(sum)
}
