// SPDX-License-Identifier: MIT
//! The functions of `include/pointsweep_remote.h`. The header documents their pointers.
#![allow(clippy::missing_safety_doc)]

use crate::failure::{Failure, Status};
use crate::objects::{self, Version};
use crate::service::{perform, set_cancelled, Cancelled};
use pointsweep_codecs::{put_text, quietly};
use std::ffi::{c_char, c_void, CStr, CString};
use std::slice::{from_raw_parts, from_raw_parts_mut};

#[repr(C)]
pub struct Detail {
    text: [c_char; 256],
}

const ETAG_BYTES: usize = 116;

#[repr(C)]
pub struct ObjectVersion {
    size: u64,
    seconds: i64,
    nanoseconds: u32,
    etag: [c_char; ETAG_BYTES],
}

impl ObjectVersion {
    fn of(version: &Version) -> Self {
        let Version { size, seconds, nanoseconds, .. } = *version;
        let mut to = Self { size, seconds, nanoseconds, etag: [0; ETAG_BYTES] };
        if version.etag.len() < ETAG_BYTES {
            put_text(&version.etag, &mut to.etag);
        }
        to
    }
    unsafe fn version(&self) -> Version {
        let etag = CStr::from_ptr(self.etag.as_ptr()).to_string_lossy().into_owned();
        Version { size: self.size, seconds: self.seconds, nanoseconds: self.nanoseconds, etag }
    }
}

/// Performs `work`. Returns 0, or the status of a failure, with words in `detail`. A panic becomes `Status::Other`.
unsafe fn guarded(detail: *mut Detail, work: impl FnOnce() -> Result<(), Failure>) -> i32 {
    let failure = match quietly(work) {
        Some(Ok(())) => return 0,
        Some(Err(failure)) => failure,
        None => Failure::new(Status::Other, "the answer contradicts itself"),
    };
    put_text(&failure.detail, &mut (*detail).text);
    failure.status as i32
}

unsafe fn text<'a>(from: *const c_char) -> Result<&'a str, Failure> {
    CStr::from_ptr(from).to_str().map_err(|_| Failure::new(Status::WrongAddress, "it is not UTF-8"))
}

#[no_mangle]
pub unsafe extern "C" fn psr_set_cancelled(cancelled: Cancelled) {
    set_cancelled(cancelled);
}

#[no_mangle]
pub unsafe extern "C" fn psr_look(address: *const c_char, version: *mut ObjectVersion, detail: *mut Detail) -> i32 {
    guarded(detail, || {
        *version = ObjectVersion::of(&perform(objects::look(text(address)?))?);
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn psr_read(address: *const c_char, expected: *const ObjectVersion, offset: u64, into: *mut u8, bytes: usize,
                                  read: *mut usize, version: *mut ObjectVersion, detail: *mut Detail) -> i32 {
    guarded(detail, || {
        let expected = if expected.is_null() { None } else { Some((*expected).version()) };
        let into = if bytes == 0 { &mut [][..] } else { from_raw_parts_mut(into, bytes) };
        let (got, found) = perform(objects::read(text(address)?, expected.as_ref(), offset, into))?;
        *read = got;
        *version = ObjectVersion::of(&found);
        Ok(())
    })
}

type Visit = unsafe extern "C" fn(*mut c_void, *const c_char, u64);

#[no_mangle]
pub unsafe extern "C" fn psr_list(folder: *const c_char, recursive: i32, visit: Visit, context: *mut c_void, detail: *mut Detail) -> i32 {
    guarded(detail, || {
        perform(objects::list(text(folder)?, recursive != 0, |key, size| {
            if let Ok(key) = CString::new(key) {
                visit(context, key.as_ptr(), size);
            }
        }))
    })
}

#[no_mangle]
pub unsafe extern "C" fn psr_put_file(address: *const c_char, path: *const c_char, overwrite: i32, detail: *mut Detail) -> i32 {
    guarded(detail, || perform(objects::put_file(text(address)?, text(path)?, overwrite != 0)))
}

#[no_mangle]
pub unsafe extern "C" fn psr_put(address: *const c_char, data: *const u8, bytes: usize, overwrite: i32, detail: *mut Detail) -> i32 {
    guarded(detail, || {
        let data = if bytes == 0 { Vec::new() } else { from_raw_parts(data, bytes).to_vec() };
        perform(objects::put(text(address)?, data, overwrite != 0))
    })
}

#[no_mangle]
pub unsafe extern "C" fn psr_remove(address: *const c_char, detail: *mut Detail) -> i32 {
    guarded(detail, || perform(objects::remove(text(address)?)))
}
