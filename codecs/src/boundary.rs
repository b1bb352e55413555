// SPDX-License-Identifier: MIT
//! Errors as text, and caught panics, for the functions of the C interface.

use std::ffi::c_char;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Once;

/// An error as a sentence for the user.
#[derive(Debug)]
pub struct Error(pub String);

impl From<laz::LasZipError> for Error {
    fn from(e: laz::LasZipError) -> Self {
        match e {
            laz::LasZipError::IoError(e) => e.into(),
            e => Error(e.to_string()),
        }
    }
}

impl From<std::io::Error> for Error {
    fn from(e: std::io::Error) -> Self {
        match e.kind() {
            std::io::ErrorKind::UnexpectedEof => Error("the compressed data end too early".into()),
            _ => Error(e.to_string()),
        }
    }
}

const ERROR_BYTES: usize = 256;

#[repr(C)]
pub struct ErrorText {
    text: [c_char; ERROR_BYTES],
}

/// Copies a text and a final 0. A text that is too long is cut at the end of a character.
pub fn put_text(text: &str, into: &mut [c_char]) {
    let mut end = text.len().min(into.len() - 1);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    for (to, from) in into.iter_mut().zip(&text.as_bytes()[..end]) {
        *to = *from as c_char;
    }
    into[end] = 0;
}

static QUIET: Once = Once::new();

/// Returns the result of `work`, or nothing if it panics. A panic prints nothing.
pub fn quietly<T>(work: impl FnOnce() -> T) -> Option<T> {
    QUIET.call_once(|| std::panic::set_hook(Box::new(|_| {})));
    catch_unwind(AssertUnwindSafe(work)).ok()
}

/// Performs `work`. Returns 0, or -1 with a sentence in `error`. A panic is reported in the same way, and prints nothing.
///
/// # Safety
/// `error` points to an `ErrorText`.
pub unsafe fn guarded(error: *mut ErrorText, work: impl FnOnce() -> Result<(), Error>) -> i32 {
    let sentence = match quietly(work) {
        Some(Ok(())) => return 0,
        Some(Err(Error(sentence))) => sentence,
        None => "the compressed data contradict themselves".to_string(),
    };
    put_text(&sentence, &mut (*error).text);
    -1
}
