// SPDX-License-Identifier: MIT
//! Reading, listing, writing and removing objects.

use crate::address::{place_of, Place, Purpose};
use crate::failure::{Failure, Status};
use futures::{StreamExt, TryStreamExt};
use object_store::{GetOptions, GetRange, MultipartUpload, ObjectMeta, ObjectStoreExt, PutMode, PutMultipartOptions, PutOptions, PutPayload};
use std::collections::VecDeque;
use std::fs::File;
use std::os::unix::fs::FileExt;
use std::time::Duration;
use tokio::task::JoinHandle;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Version {
    pub size: u64,
    pub seconds: i64,
    pub nanoseconds: u32,
    pub etag: String,
}

impl Version {
    fn of(meta: &ObjectMeta) -> Self {
        let time = meta.last_modified;
        let is_known = time.timestamp() > 0;
        Self {
            size: meta.size,
            seconds: if is_known { time.timestamp() } else { 0 },
            nanoseconds: if is_known { time.timestamp_subsec_nanos() } else { 0 },
            etag: meta.e_tag.clone().unwrap_or_default(),
        }
    }
    /// Returns whether `other`, from a later request, is this version: sizes are equal, ETags are equal if both are
    /// known, and times are equal if this version has a time but no ETag.
    fn is(&self, other: &Self) -> bool {
        self.size == other.size && (self.etag.is_empty() || other.etag.is_empty() || self.etag == other.etag)
            && (!self.etag.is_empty() || self.seconds == 0 || self.seconds == other.seconds)
    }
}

async fn head(place: &Place) -> Result<Version, Failure> {
    Ok(Version::of(&place.store.head(&place.path).await?))
}

/// Returns the version of an object. Sends GET, not HEAD, to HTTP servers, since an address may be signed for GET alone.
pub async fn look(address: &str) -> Result<Version, Failure> {
    let place = place_of(address, Purpose::Reading)?;
    if place.is_bucket {
        return head(&place).await;
    }
    match read_once(&place, None, 0, &mut [0]).await {
        Ok((_, version)) => Ok(version),
        Err(failure) if failure.status == Status::NoRanges => Err(failure),
        Err(failure) => head(&place).await.map_err(|_| failure), // the first byte of an empty file cannot be read
    }
}

async fn read_once(place: &Place, expected: Option<&Version>, offset: u64, into: &mut [u8]) -> Result<(usize, Version), Failure> {
    let end = offset + into.len() as u64;
    // A weak ETag may stand for several versions, so it is not sent as a condition.
    let if_match = expected.map(|version| version.etag.clone()).filter(|etag| !etag.is_empty() && !etag.starts_with("W/"));
    let options = GetOptions { range: Some(GetRange::Bounded(offset..end)), if_match, ..Default::default() };
    let got = place.store.get_opts(&place.path, options).await?;
    let version = Version::of(&got.meta);
    if expected.is_some_and(|expected| !expected.is(&version)) {
        return Err(Failure::new(Status::Changed, "another size, ETag or time"));
    }
    let size = usize::try_from(got.range.end - got.range.start).unwrap_or(0);
    let mut filled = 0;
    let mut parts = got.into_stream();
    while let Some(part) = parts.try_next().await? {
        let to = into.get_mut(filled..filled + part.len()).ok_or_else(|| Failure::new(Status::Other, "more bytes than were asked for"))?;
        to.copy_from_slice(&part);
        filled += part.len();
    }
    if filled == size { Ok((filled, version)) } else { Err(Failure::truncated()) }
}

const TRUNCATED_ANSWERS: u32 = 3;

pub async fn read(address: &str, expected: Option<&Version>, offset: u64, into: &mut [u8]) -> Result<(usize, Version), Failure> {
    let place = place_of(address, Purpose::Reading)?;
    for attempt in 1.. {
        match read_once(&place, expected, offset, into).await {
            Err(failure) if failure.status == Status::Truncated && attempt < TRUNCATED_ANSWERS => {
                tokio::time::sleep(Duration::from_millis(100 << attempt)).await;
            }
            Err(failure) if expected.is_none() && offset == 0 && failure.status == Status::Other => {
                let version = head(&place).await.map_err(|_| failure)?;
                return Ok((0, version)).and_then(|empty: (usize, Version)| match empty.1.size {
                    0 => Ok(empty),
                    _ => Err(Failure::new(Status::Other, "its first bytes cannot be read")),
                });
            }
            done => return done,
        }
    }
    unreachable!()
}

/// Calls `visit` with the key, without the folder, and the size of each object in a folder, and in its folders if
/// `recursive`.
pub async fn list(folder: &str, recursive: bool, mut visit: impl FnMut(&str, u64)) -> Result<(), Failure> {
    let place = place_of(folder, Purpose::Reading)?;
    if !place.is_bucket {
        return Err(Failure::new(Status::NotPossible, "a server of HTTP has no listing"));
    }
    let below = if place.path.as_ref().is_empty() { 0 } else { place.path.as_ref().len() + 1 };
    let prefix = (below > 0).then_some(&place.path);
    let mut see = |meta: &ObjectMeta| {
        if let Some(key) = meta.location.as_ref().get(below..) {
            visit(key, meta.size);
        }
    };
    if recursive {
        let mut objects = place.store.list(prefix);
        while let Some(meta) = objects.next().await {
            see(&meta?);
        }
    } else {
        place.store.list_with_delimiter(prefix).await?.objects.iter().for_each(see);
    }
    Ok(())
}

fn require_bucket(place: &Place) -> Result<(), Failure> {
    match place.is_bucket {
        true => Ok(()),
        false => Err(Failure::new(Status::NotPossible, "a server of HTTP is read alone")),
    }
}

async fn require_new(place: &Place) -> Result<(), Failure> {
    match head(place).await {
        Ok(_) => Err(Failure::new(Status::Exists, "it exists")),
        Err(failure) if failure.status == Status::NotFound => Ok(()),
        Err(failure) => Err(failure),
    }
}

pub async fn put(address: &str, data: Vec<u8>, overwrite: bool) -> Result<(), Failure> {
    let place = place_of(address, Purpose::Writing)?;
    require_bucket(&place)?;
    let mode = if overwrite { PutMode::Overwrite } else { PutMode::Create };
    let done = place.store.put_opts(&place.path, PutPayload::from(data), PutOptions::from(mode)).await;
    match done.map_err(Failure::from) {
        Err(failure) if !overwrite && failure.status == Status::Changed => Err(Failure::new(Status::Exists, failure.detail)),
        done => done.map(drop),
    }
}

const PART_BYTES: u64 = 8 << 20;
const PARTS_AT_ONCE: usize = 2;
const MOST_PARTS: u64 = 9_000; // a bucket accepts 10,000 parts

fn part_of(file: &File, offset: u64, bytes: u64) -> Result<Vec<u8>, Failure> {
    let mut part = vec![0; bytes as usize];
    file.read_exact_at(&mut part, offset).map_err(|e| Failure::new(Status::File, e.to_string()))?;
    Ok(part)
}

/// Sends the parts in order. Up to PARTS_AT_ONCE parts are under way at the same time.
async fn put_parts(upload: &mut dyn MultipartUpload, file: &File, size: u64) -> Result<(), Failure> {
    let part_bytes = PART_BYTES.max(size / MOST_PARTS + 1);
    let mut sent = VecDeque::new();
    for offset in (0..size).step_by(part_bytes as usize) {
        if sent.len() == PARTS_AT_ONCE {
            finish(sent.pop_front()).await?;
        }
        let part = part_of(file, offset, part_bytes.min(size - offset))?;
        sent.push_back(tokio::spawn(upload.put_part(PutPayload::from(part))));
    }
    while !sent.is_empty() {
        finish(sent.pop_front()).await?;
    }
    Ok(())
}

async fn finish(part: Option<JoinHandle<object_store::Result<()>>>) -> Result<(), Failure> {
    match part {
        Some(part) => Ok(part.await.map_err(|e| Failure::new(Status::Other, e.to_string()))??),
        None => Ok(()),
    }
}

pub async fn put_file(address: &str, path: &str, overwrite: bool) -> Result<(), Failure> {
    let file = File::open(path).map_err(|e| Failure::new(Status::File, e.to_string()))?;
    let size = file.metadata().map_err(|e| Failure::new(Status::File, e.to_string()))?.len();
    if size <= PART_BYTES {
        return put(address, part_of(&file, 0, size)?, overwrite).await;
    }
    let place = place_of(address, Purpose::Writing)?;
    require_bucket(&place)?;
    let mut upload = place.store.put_multipart_opts(&place.path, PutMultipartOptions::default()).await?;
    let mut done = put_parts(&mut *upload, &file, size).await;
    if done.is_ok() && !overwrite {
        done = require_new(&place).await;
    }
    if done.is_ok() {
        done = upload.complete().await.map(drop).map_err(Failure::from);
    }
    if done.is_err() {
        let _ = upload.abort().await;
    }
    done
}

pub async fn remove(address: &str) -> Result<(), Failure> {
    let place = place_of(address, Purpose::Writing)?;
    require_bucket(&place)?;
    match place.store.delete(&place.path).await.map_err(Failure::from) {
        Err(failure) if failure.status == Status::NotFound => Ok(()),
        done => done,
    }
}
