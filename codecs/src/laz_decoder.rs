// SPDX-License-Identifier: MIT
//! Decodes one chunk, from its first record to its last.

use crate::{Error, Layout};
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use std::io::{BufReader, Read, Seek, SeekFrom};

/// A stream over the bytes [begin, end) of a file. `read_at` takes the offset of a byte from the start of the file.
pub struct Source<F> {
    read_at: F,
    at: u64,
    begin: u64,
    end: u64,
}

impl<F: FnMut(u64, &mut [u8]) -> std::io::Result<usize>> Source<F> {
    pub fn new(read_at: F, begin: u64, end: u64) -> Self {
        Self { read_at, at: begin, begin, end }
    }
}

impl<F: FnMut(u64, &mut [u8]) -> std::io::Result<usize>> Read for Source<F> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let room = into.len().min(usize::try_from(self.end - self.at).unwrap_or(usize::MAX));
        if room == 0 {
            return Ok(0);
        }
        let read = (self.read_at)(self.at, &mut into[..room])?;
        self.at += read as u64;
        Ok(read)
    }
}

impl<F: FnMut(u64, &mut [u8]) -> std::io::Result<usize>> Seek for Source<F> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        let target = match to {
            SeekFrom::Start(offset) => self.begin as i128 + offset as i128,
            SeekFrom::Current(by) => self.at as i128 + by as i128,
            SeekFrom::End(by) => self.end as i128 + by as i128,
        };
        if target < self.begin as i128 || target > self.end as i128 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        self.at = target as u64;
        Ok(self.at - self.begin)
    }
}

type Decompressor<R> = Box<dyn RecordDecompressor<R> + Send + Sync>;

pub struct Decoder<R> {
    decompressor: Decompressor<BufReader<R>>,
    record_bytes: usize,
}

impl<R: Read + Seek + Send + Sync + 'static> Decoder<R> {
    /// `source` holds the chunk and nothing else.
    pub fn new(layout: &Layout, source: R) -> Result<Self, Error> {
        let mut input = BufReader::with_capacity(1 << 16, source);
        let mut decompressor: Decompressor<BufReader<R>> = if layout.is_layered() {
            check_layers(layout, &mut input)?;
            Box::new(LayeredPointRecordDecompressor::new(input))
        } else {
            Box::new(SequentialPointRecordDecompressor::new(input))
        };
        decompressor.set_fields_from(layout.items())?;
        Ok(Self { decompressor, record_bytes: layout.record_bytes() })
    }

    /// Decodes the next records, as many as fit in `records`.
    pub fn decode(&mut self, records: &mut [u8]) -> Result<(), Error> {
        for record in records.chunks_exact_mut(self.record_bytes) {
            self.decompressor.decompress_next(record)?;
        }
        Ok(())
    }
}

/// Returns an error if the layers are larger than the chunk. The crate `laz` allocates as many bytes as the sizes of the
/// layers claim.
fn check_layers(layout: &Layout, input: &mut (impl Read + Seek)) -> Result<(), Error> {
    let end = input.seek(SeekFrom::End(0))?;
    let sizes_begin = layout.record_bytes() as u64 + 4;
    input.seek(SeekFrom::Start(sizes_begin))?;
    let mut claimed = 0u64;
    for _ in 0..layout.layers() {
        let mut size = [0; 4];
        input.read_exact(&mut size)?;
        claimed += u64::from(u32::from_le_bytes(size));
    }
    if sizes_begin + 4 * layout.layers() as u64 + claimed > end {
        return Err(Error("the layers of a chunk are larger than the chunk".into()));
    }
    input.seek(SeekFrom::Start(0))?;
    Ok(())
}
