// SPDX-License-Identifier: MIT
use e57::RecordDataType;
use pointsweep_codecs::{About, Attribute, Contents, Error, File, ScanReader, ScanWriter};
use std::io::Cursor;
use std::sync::{Arc, Mutex};

/// A file in memory, which grows by writes and refuses writes beyond `most` bytes.
#[derive(Clone)]
struct Memory {
    bytes: Arc<Mutex<Vec<u8>>>,
    most: usize,
}

impl File for Memory {
    fn read_at(&mut self, offset: u64, into: &mut [u8]) -> std::io::Result<usize> {
        let bytes = self.bytes.lock().unwrap();
        into.copy_from_slice(&bytes[offset as usize..][..into.len()]);
        Ok(into.len())
    }
    fn write_at(&mut self, offset: u64, from: &[u8]) -> std::io::Result<()> {
        let (mut bytes, end) = (self.bytes.lock().unwrap(), offset as usize + from.len());
        if end > self.most {
            return Err(std::io::Error::other("no space"));
        }
        let size = bytes.len().max(end);
        bytes.resize(size, 0);
        bytes[offset as usize..end].copy_from_slice(from);
        Ok(())
    }
}

fn attributes() -> Vec<Attribute> {
    let scaled = |offset| RecordDataType::ScaledInteger { min: -(1 << 31), max: (1 << 31) - 1, scale: 0.01, offset };
    let named = |name: &str, data_type| Attribute { name: name.into(), data_type };
    vec![
        named("cartesianX", scaled(500.0)),
        named("cartesianY", RecordDataType::Double { min: None, max: None }),
        named("cartesianZ", RecordDataType::Single { min: None, max: None }),
        named("cartesianInvalidState", RecordDataType::Integer { min: 0, max: 2 }),
        named("intensity", RecordDataType::Integer { min: 0, max: 65535 }),
        named("nor:normalX", RecordDataType::Single { min: None, max: None }),
        named("ps:all", RecordDataType::Integer { min: i64::MIN, max: i64::MAX }),
    ]
}

fn values(points: usize) -> Vec<u64> {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        state >> 16
    };
    let mut values = Vec::new();
    for _ in 0..points {
        let raw = random() as i32;
        let single = random() as i16 as f32 / 3.0;
        values.extend([i64::from(raw) as u64, (random() as f64).sqrt().to_bits(), f64::from(single).to_bits()]);
        values.extend([random() % 3, random() % 65536, f64::from(single / 7.0).to_bits(), random() << 20 | random()]);
    }
    values
}

fn write(points: usize, most: usize) -> Result<Vec<u8>, Error> {
    let file = Memory { bytes: Arc::default(), most };
    let about = About {
        guid: "{0}",
        description: "a < b & c\nsecond line",
        coordinate_system: "PROJCS[\"x\"]",
        extensions: &[("nor", "urn:n"), ("ps", "urn:p")],
    };
    let mut writer = ScanWriter::create(file.clone(), attributes(), &about)?;
    for some in values(points).chunks(7 * 1000) {
        writer.write(some)?;
    }
    writer.finish()?;
    drop(writer);
    let bytes = file.bytes.lock().unwrap().clone();
    Ok(bytes)
}

#[test]
fn what_is_written_is_read() {
    for points in [0, 1, 2000, 100_000] {
        let bytes = write(points, usize::MAX).unwrap();
        let contents = Contents::read(Cursor::new(bytes.clone())).unwrap();
        assert_eq!(contents.coordinate_system, "PROJCS[\"x\"]");
        assert_eq!(contents.scans.len(), 1);
        assert_eq!(contents.scans[0].records, points as u64);
        assert_eq!(contents.scans[0].description.as_deref(), Some("a < b & c\nsecond line"));
        let mut found = vec![0; 7 * points];
        if points > 0 {
            ScanReader::open(Cursor::new(bytes), &contents.scans[0]).unwrap().read(&mut found).unwrap();
        }
        assert!(found == values(points), "{points} points");
    }
}

#[test]
fn a_file_that_cannot_be_written_is_an_error() {
    for most in [0, 2000, 300_000, 2_500_000] {
        assert!(write(100_000, most).is_err(), "{most} bytes");
    }
}
