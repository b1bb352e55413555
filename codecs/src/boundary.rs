// SPDX-License-Identifier: MIT
//! What every function of the C interface needs.

use std::ffi::c_char;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Once;

/// A sentence for the user.
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

impl ErrorText {
    fn set(&mut self, sentence: &str) {
        let mut end = sentence.len().min(ERROR_BYTES - 1);
        while !sentence.is_char_boundary(end) {
            end -= 1;
        }
        for (to, from) in self.text.iter_mut().zip(&sentence.as_bytes()[..end]) {
            *to = *from as c_char;
        }
        self.text[end] = 0;
    }
}

static QUIET: Once = Once::new();

/// Returns 0, or -1 with a sentence in `error`. A panic becomes a sentence too, and prints nothing.
///
/// # Safety
/// `error` points to an `ErrorText`.
pub unsafe fn guarded(error: *mut ErrorText, work: impl FnOnce() -> Result<(), Error>) -> i32 {
    QUIET.call_once(|| std::panic::set_hook(Box::new(|_| {})));
    let sentence = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return 0,
        Ok(Err(Error(sentence))) => sentence,
        Err(_) => "the compressed data contradict themselves".to_string(),
    };
    (*error).set(&sentence);
    -1
}
