// SPDX-License-Identifier: MIT
//! Errors of requests, as a status of the C interface and a short description.

use object_store::client::{HttpError, HttpErrorKind};
use object_store::Error as StoreError;
use std::error::Error;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    NotFound = 1,
    Denied = 2,
    Exists = 3,
    Changed = 4,
    NoRanges = 5,
    Unavailable = 6,
    Truncated = 7,
    Tls = 8,
    NotPossible = 9,
    WrongAddress = 10,
    File = 11,
    Cancelled = 12,
    Other = 13,
}

#[derive(Debug)]
pub struct Failure {
    pub status: Status,
    pub detail: String,
}

impl Failure {
    pub fn new(status: Status, detail: impl Into<String>) -> Self {
        Self { status, detail: detail.into() }
    }
    pub fn truncated() -> Self {
        Self::new(Status::Truncated, "the answer ended too early")
    }
}

/// Returns the error and its causes, the innermost last.
fn causes<'a>(error: &'a (dyn Error + 'static)) -> Vec<&'a (dyn Error + 'static)> {
    let mut all = vec![error];
    while let Some(cause) = all[all.len() - 1].source() {
        all.push(cause);
    }
    all
}

/// Returns the status code and line in the message of an error, e.g. 503 and "503 Service Unavailable".
fn status_line(text: &str) -> Option<(u16, String)> {
    let rest = text.split("status code: ").nth(1)?;
    let code: u16 = rest.get(..3)?.parse().ok()?;
    let line = rest.split(':').next().unwrap_or(rest);
    Some((code, line.split('<').next().unwrap_or(line).trim().chars().take(60).collect()))
}

/// Returns the words of an error without addresses, which may hold credentials.
fn without_addresses(text: &str) -> String {
    let shown = |word: &&str| !word.contains("://") && !word.contains('=');
    text.split_whitespace().filter(shown).collect::<Vec<_>>().join(" ").chars().take(160).collect()
}

fn is_certificate(text: &str) -> bool {
    ["certificate", "UnknownIssuer", "tls handshake", "InvalidContentType", "corrupt message"].iter().any(|word| text.contains(word))
}

/// Returns the failure for an error of the connection, or of an answer for which the crate has no kind of error.
fn of_causes(error: &(dyn Error + 'static)) -> Failure {
    let texts: Vec<String> = causes(error).iter().map(|e| e.to_string()).collect();
    let has = |word: &str| texts.iter().any(|text| text.contains(word));
    let last = without_addresses(texts.last().map_or("", |text| text.as_str()));
    if texts.iter().any(|text| is_certificate(text)) {
        return Failure::new(Status::Tls, last);
    }
    if let Some((code, line)) = texts.iter().find_map(|text| status_line(text)) {
        let status = match code {
            404 | 410 => Status::NotFound,
            401 | 403 => Status::Denied,
            405 | 501 => Status::NotPossible,
            412 => Status::Changed,
            408 | 429 | 500..=599 => Status::Unavailable,
            _ => Status::Other,
        };
        return Failure::new(status, line);
    }
    if has("169.254.") || has("metadata.google") || has("InstanceCredential") || has("No credentials") {
        return Failure::new(Status::Denied, "no credentials were found");
    }
    if has("end of file before message length reached") || has("unexpected EOF") || has("IncompleteMessage") || has("Requested ") {
        return Failure::truncated();
    }
    for cause in causes(error) {
        if let Some(http) = cause.downcast_ref::<HttpError>() {
            return match http.kind() {
                HttpErrorKind::Timeout => Failure::new(Status::Unavailable, "no answer in time"),
                HttpErrorKind::Connect | HttpErrorKind::Request | HttpErrorKind::Interrupted => Failure::new(Status::Unavailable, last),
                HttpErrorKind::Decode => Failure::truncated(),
                _ => Failure::new(Status::Other, last),
            };
        }
    }
    Failure::new(Status::Other, last)
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        let line = |usual: &str| causes(&error).into_iter().find_map(|e| status_line(&e.to_string())).map_or(usual.to_string(), |(_, line)| line);
        let failure = of_causes(&error);
        match &error {
            StoreError::NotFound { .. } => Self::new(Status::NotFound, line("404 Not Found")),
            StoreError::AlreadyExists { .. } => Self::new(Status::Exists, line("409 Conflict")),
            StoreError::Precondition { .. } => Self::new(Status::Changed, line("412 Precondition Failed")),
            StoreError::PermissionDenied { .. } => Self::new(Status::Denied, line("403 Forbidden")),
            StoreError::Unauthenticated { .. } => Self::new(Status::Denied, line("401 Unauthorized")),
            StoreError::InvalidPath { .. } => Self::new(Status::WrongAddress, "its path has a part that no key may have"),
            StoreError::NotImplemented { .. } => Self::new(Status::NotPossible, "this kind of server has no such operation"),
            // The request was for a range of an empty object, or the server does not support ranges.
            StoreError::NotSupported { .. } => Self::new(Status::NoRanges, "the server ignores the header Range"),
            _ if failure.detail.contains("non-partial response") => Self::new(Status::NoRanges, "the server ignores the header Range"),
            _ => failure,
        }
    }
}
