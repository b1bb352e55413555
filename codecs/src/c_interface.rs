// SPDX-License-Identifier: MIT
//! The functions of `include/pointsweep_codecs.h`. The header documents their pointers.
#![allow(clippy::missing_safety_doc)]

use crate::boundary::{guarded, put_text, ErrorText};
use crate::{
    encode, name_of, write_chunk_table, About, Attribute, Contents, Decoder, Error, File, Layout, ScanReader, ScanWriter, Source,
};
use e57::RecordDataType;
use std::ffi::{c_char, c_void, CStr};
use std::io::BufReader;
use std::slice::{from_raw_parts, from_raw_parts_mut};

type ReadAt = unsafe extern "C" fn(*mut c_void, u64, *mut u8, usize) -> isize;

/// The read function of the caller and its context. `Send` and `Sync`, since the caller may use a decoder on several
/// threads, one after another.
struct Caller {
    read: ReadAt,
    context: *mut c_void,
}
unsafe impl Send for Caller {}
unsafe impl Sync for Caller {}

impl Caller {
    fn read(&self, offset: u64, into: &mut [u8]) -> std::io::Result<usize> {
        let read = unsafe { (self.read)(self.context, offset, into.as_mut_ptr(), into.len()) };
        usize::try_from(read).map_err(|_| std::io::Error::other("the file cannot be read"))
    }
}

type ReadFile = Box<dyn FnMut(u64, &mut [u8]) -> std::io::Result<usize> + Send + Sync>;
pub type FileDecoder = Decoder<Source<ReadFile>>;

unsafe fn bytes<'a>(data: *const u8, size: usize) -> &'a [u8] {
    if size == 0 { &[] } else { from_raw_parts(data, size) }
}

unsafe fn hand_over(made: Vec<u8>, out: *mut *mut u8, size: *mut usize) {
    let made = made.into_boxed_slice();
    *size = made.len();
    *out = Box::into_raw(made) as *mut u8;
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_parse(vlr: *const u8, size: usize, out: *mut *mut Layout, error: *mut ErrorText) -> i32 {
    guarded(error, || {
        *out = Box::into_raw(Box::new(Layout::parse(bytes(vlr, size))?));
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_for_format(point_format: u8, extra_bytes: u16, chunk_points: u32, out: *mut *mut Layout,
                                            error: *mut ErrorText) -> i32 {
    guarded(error, || {
        *out = Box::into_raw(Box::new(Layout::for_format(point_format, extra_bytes, chunk_points)?));
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_free(laz: *mut Layout) {
    if !laz.is_null() {
        drop(Box::from_raw(laz));
    }
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_record_bytes(laz: *const Layout) -> u32 {
    (*laz).record_bytes() as u32
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_chunk_points(laz: *const Layout) -> u32 {
    (*laz).chunk_points()
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_vlr(laz: *const Layout, into: *mut u8, room: usize) -> usize {
    let vlr = (*laz).vlr();
    if room >= vlr.len() {
        from_raw_parts_mut(into, vlr.len()).copy_from_slice(&vlr);
    }
    vlr.len()
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_read_chunk_table(laz: *const Layout, table: *const u8, size: usize, count: usize,
                                                  points: *mut u64, sizes: *mut u64, error: *mut ErrorText) -> i32 {
    guarded(error, || {
        for (i, chunk) in (*laz).read_chunk_table(bytes(table, size), count)?.into_iter().enumerate() {
            (*points.add(i), *sizes.add(i)) = chunk;
        }
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_write_chunk_table(laz: *const Layout, points: *const u64, sizes: *const u64, count: usize,
                                                   out: *mut *mut u8, size: *mut usize, error: *mut ErrorText) -> i32 {
    guarded(error, || {
        let chunks: Vec<_> = (0..count).map(|i| (*points.add(i), *sizes.add(i))).collect();
        hand_over(write_chunk_table(&*laz, &chunks)?, out, size);
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_decoder_open(laz: *const Layout, read: ReadAt, context: *mut c_void, begin: u64, end: u64,
                                              out: *mut *mut FileDecoder, error: *mut ErrorText) -> i32 {
    guarded(error, || {
        let caller = Caller { read, context };
        let read_at: ReadFile = Box::new(move |offset, into| caller.read(offset, into));
        let source = Source::new(read_at, begin, end.max(begin));
        *out = Box::into_raw(Box::new(Decoder::new(&*laz, source)?));
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_decode(decoder: *mut FileDecoder, records: *mut u8, size: usize, error: *mut ErrorText) -> i32 {
    guarded(error, || match size {
        0 => Ok(()),
        _ => (*decoder).decode(from_raw_parts_mut(records, size)),
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_decoder_free(decoder: *mut FileDecoder) {
    if !decoder.is_null() {
        drop(Box::from_raw(decoder));
    }
}

#[no_mangle]
pub unsafe extern "C" fn psc_laz_encode(laz: *const Layout, records: *const u8, size: usize, out: *mut *mut u8,
                                        out_size: *mut usize, error: *mut ErrorText) -> i32 {
    guarded(error, || {
        if size == 0 || size % (*laz).record_bytes() != 0 {
            return Err(Error("a chunk needs whole records, at least one".into()));
        }
        hand_over(encode(&*laz, bytes(records, size))?, out, out_size);
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_free_bytes(data: *mut u8, size: usize) {
    if !data.is_null() {
        drop(Box::from_raw(std::ptr::slice_from_raw_parts_mut(data, size)));
    }
}

const NAME_BYTES: usize = 256;

#[repr(C)]
pub struct E57Scan {
    points: u64,
    attributes: usize,
    has_pose: i32,
    rotation: [f64; 4],
    translation: [f64; 3],
}

#[repr(C)]
pub struct E57Attribute {
    name: [c_char; NAME_BYTES],
    kind: i32,
    least: i64,
    most: i64,
    scale: f64,
    offset: f64,
}

type FileSource = BufReader<Source<ReadFile>>;

fn source_of(read: ReadAt, context: *mut c_void, size: u64) -> FileSource {
    let caller = Caller { read, context };
    let read_at: ReadFile = Box::new(move |offset, into| caller.read(offset, into));
    BufReader::with_capacity(1 << 16, Source::new(read_at, 0, size))
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_open(read: ReadAt, context: *mut c_void, size: u64, out: *mut *mut Contents,
                                      error: *mut ErrorText) -> i32 {
    guarded(error, || {
        *out = Box::into_raw(Box::new(Contents::read(source_of(read, context, size))?));
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_free(file: *mut Contents) {
    if !file.is_null() {
        drop(Box::from_raw(file));
    }
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_scans(file: *const Contents) -> usize {
    (*file).scans.len()
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_images(file: *const Contents) -> usize {
    (*file).images
}

unsafe fn put_bytes(text: &str, into: *mut u8, room: usize) -> usize {
    if room >= text.len() && room > 0 {
        from_raw_parts_mut(into, text.len()).copy_from_slice(text.as_bytes());
    }
    text.len()
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_coordinate_system(file: *const Contents, into: *mut u8, room: usize) -> usize {
    put_bytes(&(*file).coordinate_system, into, room)
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_description(file: *const Contents, scan: usize, into: *mut u8, room: usize) -> usize {
    let scan = &(&(*file).scans)[scan];
    put_bytes(scan.description.as_deref().unwrap_or(""), into, room)
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_scan_info(file: *const Contents, scan: usize, out: *mut E57Scan) {
    let scan = &(&(*file).scans)[scan];
    let (rotation, translation) = match &scan.transform {
        Some(t) => ([t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z], [t.translation.x, t.translation.y, t.translation.z]),
        None => ([1.0, 0.0, 0.0, 0.0], [0.0; 3]),
    };
    let has_pose = i32::from(scan.transform.is_some());
    *out = E57Scan { points: scan.records, attributes: scan.prototype.len(), has_pose, rotation, translation };
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_attribute_info(file: *const Contents, scan: usize, attribute: usize, out: *mut E57Attribute) {
    let record = &(&(*file).scans)[scan].prototype[attribute];
    let (kind, least, most, scale, offset) = match record.data_type {
        RecordDataType::Single { .. } => (0, 0, 0, 1.0, 0.0),
        RecordDataType::Double { .. } => (1, 0, 0, 1.0, 0.0),
        RecordDataType::ScaledInteger { min, max, scale, offset } => (2, min, max, scale, offset),
        RecordDataType::Integer { min, max } => (3, min, max, 1.0, 0.0),
    };
    *out = E57Attribute { name: [0; NAME_BYTES], kind, least, most, scale, offset };
    put_text(&name_of(&record.name), &mut (*out).name);
}

pub type FileScanReader = ScanReader<FileSource>;

#[no_mangle]
pub unsafe extern "C" fn psc_e57_reader_open(file: *const Contents, scan: usize, read: ReadAt, context: *mut c_void, size: u64,
                                             out: *mut *mut FileScanReader, error: *mut ErrorText) -> i32 {
    guarded(error, || {
        let scan = &(&(*file).scans)[scan];
        *out = Box::into_raw(Box::new(ScanReader::open(source_of(read, context, size), scan)?));
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_read(reader: *mut FileScanReader, values: *mut u64, count: usize, error: *mut ErrorText) -> i32 {
    guarded(error, || match count {
        0 => Ok(()),
        _ => (*reader).read(from_raw_parts_mut(values, count)),
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_reader_free(reader: *mut FileScanReader) {
    if !reader.is_null() {
        drop(Box::from_raw(reader));
    }
}

type WriteAt = unsafe extern "C" fn(*mut c_void, u64, *const u8, usize) -> i32;

/// A file that functions of the caller read and write.
struct CallersFile {
    caller: Caller,
    write: WriteAt,
}

impl File for CallersFile {
    fn read_at(&mut self, offset: u64, into: &mut [u8]) -> std::io::Result<usize> {
        self.caller.read(offset, into)
    }
    fn write_at(&mut self, offset: u64, bytes: &[u8]) -> std::io::Result<()> {
        match unsafe { (self.write)(self.caller.context, offset, bytes.as_ptr(), bytes.len()) } {
            0 => Ok(()),
            _ => Err(std::io::Error::other("the file cannot be written")),
        }
    }
}

pub struct FileScanWriter(ScanWriter<CallersFile>);

unsafe fn text<'a>(from: *const c_char) -> Result<&'a str, Error> {
    CStr::from_ptr(from).to_str().map_err(|_| Error("a text is not UTF-8".into()))
}

unsafe fn attribute_of(from: &E57Attribute) -> Result<Attribute, Error> {
    let data_type = match from.kind {
        0 => RecordDataType::Single { min: None, max: None },
        1 => RecordDataType::Double { min: None, max: None },
        2 => RecordDataType::ScaledInteger { min: from.least, max: from.most, scale: from.scale, offset: from.offset },
        _ => RecordDataType::Integer { min: from.least, max: from.most },
    };
    Ok(Attribute { name: text(from.name.as_ptr())?.to_string(), data_type })
}

#[repr(C)]
pub struct E57About {
    guid: *const c_char,
    description: *const c_char,
    coordinate_system: *const c_char,
}

const EXTENSIONS: [(&str, &str); 2] =
    [("nor", "http://www.libe57.org/E57_EXT_surface_normals.txt"), ("ps", "urn:pointsweep:attributes")];

#[no_mangle]
pub unsafe extern "C" fn psc_e57_writer_create(read: ReadAt, write: WriteAt, context: *mut c_void, attributes: *const E57Attribute,
                                               count: usize, about: *const E57About, out: *mut *mut FileScanWriter,
                                               error: *mut ErrorText) -> i32 {
    guarded(error, || {
        let attributes = from_raw_parts(attributes, count).iter().map(|a| attribute_of(a)).collect::<Result<Vec<_>, _>>()?;
        let uses = |namespace: &str| attributes.iter().any(|a| a.name.split_once(':').is_some_and(|(n, _)| n == namespace));
        let extensions: Vec<_> = EXTENSIONS.into_iter().filter(|(namespace, _)| uses(namespace)).collect();
        let about = About {
            guid: text((*about).guid)?,
            description: text((*about).description)?,
            coordinate_system: text((*about).coordinate_system)?,
            extensions: &extensions,
        };
        let file = CallersFile { caller: Caller { read, context }, write };
        *out = Box::into_raw(Box::new(FileScanWriter(ScanWriter::create(file, attributes, &about)?)));
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_write(writer: *mut FileScanWriter, values: *const u64, count: usize, error: *mut ErrorText) -> i32 {
    guarded(error, || match count {
        0 => Ok(()),
        _ => (*writer).0.write(from_raw_parts(values, count)),
    })
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_writer_finish(writer: *mut FileScanWriter, error: *mut ErrorText) -> i32 {
    guarded(error, || (*writer).0.finish())
}

#[no_mangle]
pub unsafe extern "C" fn psc_e57_writer_free(writer: *mut FileScanWriter) {
    if !writer.is_null() {
        drop(Box::from_raw(writer));
    }
}
