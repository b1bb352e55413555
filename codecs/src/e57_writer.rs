// SPDX-License-Identifier: MIT
//! A writer of an E57 file with one scan, from its first point to its last.

use crate::{name_of, Error, Owned};
use e57::{E57Writer, Extension, PointCloudWriter, RawValues, Record, RecordDataType, RecordName, RecordValue};
use std::io::{Error as IoError, Read, Result as IoResult, Seek, SeekFrom, Write};

/// Reads and writes bytes at an offset of a new file.
pub trait File {
    fn read_at(&mut self, offset: u64, into: &mut [u8]) -> IoResult<usize>;
    fn write_at(&mut self, offset: u64, bytes: &[u8]) -> IoResult<()>;
}

const PENDING_BYTES: usize = 1 << 18;

/// A new file with a position. Joins the pages of 1,024 bytes that the crate `e57` writes to fewer, longer writes.
pub struct Sink<F: File> {
    file: F,
    position: u64,
    size: u64,
    pending: Vec<u8>, // bytes that belong at `pending_at` and are not yet written
    pending_at: u64,
}

impl<F: File> Sink<F> {
    pub fn new(file: F) -> Self {
        Self { file, position: 0, size: 0, pending: Vec::with_capacity(PENDING_BYTES), pending_at: 0 }
    }

    fn write_pending(&mut self) -> IoResult<()> {
        if !self.pending.is_empty() {
            self.file.write_at(self.pending_at, &self.pending)?;
            self.pending.clear();
        }
        Ok(())
    }
}

impl<F: File> Write for Sink<F> {
    fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
        let goes_on = self.position == self.pending_at + self.pending.len() as u64;
        if !goes_on || self.pending.len() + bytes.len() > PENDING_BYTES {
            self.write_pending()?;
        }
        if self.pending.is_empty() {
            self.pending_at = self.position;
        }
        self.pending.extend_from_slice(bytes);
        self.position += bytes.len() as u64;
        self.size = self.size.max(self.position);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> IoResult<()> {
        self.write_pending()
    }
}

impl<F: File> Read for Sink<F> {
    fn read(&mut self, into: &mut [u8]) -> IoResult<usize> {
        if self.position >= self.size {
            return Ok(0); // the crate `e57` tries to read after each page that it appends
        }
        self.write_pending()?;
        let most = usize::try_from(self.size.saturating_sub(self.position)).unwrap_or(usize::MAX).min(into.len());
        let read = self.file.read_at(self.position, &mut into[..most])?;
        self.position += read as u64;
        Ok(read)
    }
}

impl<F: File> Seek for Sink<F> {
    fn seek(&mut self, to: SeekFrom) -> IoResult<u64> {
        let position = match to {
            SeekFrom::Start(offset) => Some(offset),
            SeekFrom::End(offset) => self.size.checked_add_signed(offset),
            SeekFrom::Current(offset) => self.position.checked_add_signed(offset),
        };
        self.position = position.ok_or_else(|| IoError::other("a position before the file"))?;
        Ok(self.position)
    }
}

/// Returns the name of an attribute: `cartesianX` or another name of the standard, or `namespace:name` of an extension.
fn record_name(text: &str) -> Result<RecordName, Error> {
    if let Some((namespace, name)) = text.split_once(':') {
        return Ok(RecordName::Unknown { namespace: namespace.into(), name: name.into() });
    }
    use RecordName::*;
    let known = [
        CartesianX, CartesianY, CartesianZ, CartesianInvalidState, Intensity, ColorRed, ColorGreen, ColorBlue, RowIndex, ColumnIndex,
        ReturnCount, ReturnIndex, TimeStamp,
    ];
    known.into_iter().find(|name| name_of(name) == text).ok_or_else(|| Error(format!("E57 has no attribute '{text}'")))
}

pub struct Attribute {
    pub name: String,
    pub data_type: RecordDataType,
}

/// The statements of a file in addition to its points.
pub struct About<'a> {
    pub guid: &'a str,
    pub description: &'a str,
    pub coordinate_system: &'a str,
    /// Namespaces of the extensions that attributes name, with their identifiers.
    pub extensions: &'a [(&'a str, &'a str)],
}

fn text_or_none(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_string())
}

pub struct ScanWriter<F: File + 'static> {
    points: Option<PointCloudWriter<'static, Sink<F>>>, // borrows from `file`, and is dropped before it
    kinds: Vec<RecordDataType>,
    file: Owned<E57Writer<Sink<F>>>,
}

impl<F: File + 'static> ScanWriter<F> {
    pub fn create(file: F, attributes: Vec<Attribute>, about: &About) -> Result<Self, Error> {
        let mut writer = E57Writer::new(Sink::new(file), about.guid)?;
        writer.set_coordinate_metadata(text_or_none(about.coordinate_system));
        for (namespace, url) in about.extensions {
            writer.register_extension(Extension::new(namespace, url))?;
        }
        let kinds = attributes.iter().map(|a| a.data_type.clone()).collect();
        let mut prototype = Vec::new();
        for attribute in attributes {
            prototype.push(Record { name: record_name(&attribute.name)?, data_type: attribute.data_type });
        }
        let file = Owned::new(writer);
        let mut points = unsafe { &mut *file.get() }.add_pointcloud(about.guid, prototype)?;
        points.set_description(text_or_none(about.description));
        Ok(Self { points: Some(points), kinds, file })
    }

    /// Appends points, in the form in which `ScanReader::read` returns points.
    pub fn write(&mut self, values: &[u64]) -> Result<(), Error> {
        let points = self.points.as_mut().ok_or_else(|| Error("the scan is complete already".into()))?;
        for point in values.chunks_exact(self.kinds.len()) {
            let mut raw = RawValues::with_capacity(self.kinds.len());
            for (&value, kind) in point.iter().zip(&self.kinds) {
                raw.push(match kind {
                    RecordDataType::Single { .. } => RecordValue::Single(f64::from_bits(value) as f32),
                    RecordDataType::Double { .. } => RecordValue::Double(f64::from_bits(value)),
                    RecordDataType::ScaledInteger { .. } => RecordValue::ScaledInteger(value as i64),
                    RecordDataType::Integer { .. } => RecordValue::Integer(value as i64),
                });
            }
            points.add_point(raw)?;
        }
        Ok(())
    }

    /// Completes the file. Must be the last call.
    pub fn finish(&mut self) -> Result<(), Error> {
        let mut points = self.points.take().ok_or_else(|| Error("the scan is complete already".into()))?;
        points.finalize()?;
        drop(points);
        let file = unsafe { &mut *self.file.get() };
        file.finalize()?;
        Ok(())
    }
}
