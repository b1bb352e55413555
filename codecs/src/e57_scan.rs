// SPDX-License-Identifier: MIT
//! The scans of an E57 file: their descriptions, and their points from the first to the last.

use crate::{Error, Owned};
use e57::{E57Reader, PointCloud, PointCloudReaderRaw, RecordDataType, RecordName, RecordValue};
use std::io::{Read, Seek, SeekFrom};

impl From<e57::Error> for Error {
    fn from(e: e57::Error) -> Self {
        Error(e.to_string())
    }
}

/// Opens a file. Checks the size of the XML section first, since the crate `e57` allocates as many bytes as the header
/// claims.
fn open<R: Read + Seek>(mut source: R) -> Result<E57Reader<R>, Error> {
    let size = source.seek(SeekFrom::End(0))?;
    source.seek(SeekFrom::Start(32))?;
    let mut xml_bytes = [0; 8];
    source.read_exact(&mut xml_bytes)?;
    if u64::from_le_bytes(xml_bytes) > size {
        return Err(Error("its XML section is larger than the file".into()));
    }
    source.seek(SeekFrom::Start(0))?;
    Ok(E57Reader::new(source)?)
}

/// The descriptions of the scans of a file.
pub struct Contents {
    pub scans: Vec<PointCloud>,
    pub images: usize,
    pub coordinate_system: String,
}

impl Contents {
    pub fn read<R: Read + Seek>(source: R) -> Result<Self, Error> {
        let reader = open(source)?;
        let scans = reader.pointclouds();
        for (number, scan) in scans.iter().enumerate() {
            let constant = scan.prototype.iter().all(|r| is_constant(&r.data_type));
            if constant && scan.records > 0 {
                return Err(Error(format!("scan {} has no attribute with more than one value", number + 1)));
            }
        }
        let coordinate_system = reader.coordinate_metadata().unwrap_or("").to_string();
        Ok(Self { images: reader.images().len(), scans, coordinate_system })
    }
}

fn is_constant(kind: &RecordDataType) -> bool {
    match kind {
        RecordDataType::ScaledInteger { min, max, .. } | RecordDataType::Integer { min, max } => min == max,
        _ => false,
    }
}

pub fn name_of(name: &RecordName) -> String {
    match name {
        RecordName::CartesianX => "cartesianX",
        RecordName::CartesianY => "cartesianY",
        RecordName::CartesianZ => "cartesianZ",
        RecordName::CartesianInvalidState => "cartesianInvalidState",
        RecordName::SphericalRange => "sphericalRange",
        RecordName::SphericalAzimuth => "sphericalAzimuth",
        RecordName::SphericalElevation => "sphericalElevation",
        RecordName::SphericalInvalidState => "sphericalInvalidState",
        RecordName::Intensity => "intensity",
        RecordName::IsIntensityInvalid => "isIntensityInvalid",
        RecordName::ColorRed => "colorRed",
        RecordName::ColorGreen => "colorGreen",
        RecordName::ColorBlue => "colorBlue",
        RecordName::IsColorInvalid => "isColorInvalid",
        RecordName::RowIndex => "rowIndex",
        RecordName::ColumnIndex => "columnIndex",
        RecordName::ReturnCount => "returnCount",
        RecordName::ReturnIndex => "returnIndex",
        RecordName::TimeStamp => "timeStamp",
        RecordName::IsTimeStampInvalid => "isTimeStampInvalid",
        RecordName::Unknown { name, .. } => name,
    }
    .to_string()
}

/// A reader of the points of one scan, from the first to the last.
pub struct ScanReader<R: Read + Seek + 'static> {
    points: PointCloudReaderRaw<'static, R>, // borrows from `_file`, and is dropped before it
    kinds: Vec<RecordDataType>,
    _file: Owned<E57Reader<R>>,
}

impl<R: Read + Seek + 'static> ScanReader<R> {
    pub fn open(source: R, scan: &PointCloud) -> Result<Self, Error> {
        let file = Owned::new(open(source)?);
        let points = unsafe { &mut *file.get() }.pointcloud_raw(scan)?;
        Ok(Self { points, kinds: scan.prototype.iter().map(|r| r.data_type.clone()).collect(), _file: file })
    }

    /// Fills `values` with the next points: for each attribute of each point 64 bits, a double or the integer that the file
    /// stores, before scale and offset.
    pub fn read(&mut self, values: &mut [u64]) -> Result<(), Error> {
        for point in values.chunks_exact_mut(self.kinds.len()) {
            let raw = self.points.next().ok_or_else(|| Error("a scan has fewer points than it says".into()))??;
            for (to, from) in point.iter_mut().zip(raw) {
                *to = match from {
                    RecordValue::Single(v) => f64::from(v).to_bits(),
                    RecordValue::Double(v) => v.to_bits(),
                    RecordValue::ScaledInteger(v) | RecordValue::Integer(v) => v as u64,
                };
            }
        }
        Ok(())
    }
}
