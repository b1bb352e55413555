// SPDX-License-Identifier: MIT
//! The store of the crate `object_store` that an address names, and the path of the object in the store. Stores of
//! buckets, and clients of HTTP servers, are kept for later requests.

use crate::failure::{Failure, Status};
use object_store::aws::AmazonS3Builder;
use object_store::azure::MicrosoftAzureBuilder;
use object_store::client::{HttpClient, HttpConnector, ReqwestConnector};
use object_store::gcp::GoogleCloudStorageBuilder;
use object_store::http::HttpBuilder;
use object_store::path::Path;
use object_store::{BackoffConfig, ClientOptions, HeaderMap, HeaderValue, ObjectStore, RetryConfig};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use url::Url;

pub type Store = Arc<dyn ObjectStore>;

/// The purpose of a client, which decides how long the client waits for an answer. A server answers an upload only after
/// it has received all bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    Reading,
    Writing,
}

pub struct Place {
    pub store: Store,
    pub path: Path,
    pub is_bucket: bool,
}

/// Returns the rules of retries: a request to a host that does not answer fails after about half a minute.
fn retries() -> RetryConfig {
    let backoff = BackoffConfig { init_backoff: Duration::from_millis(100), max_backoff: Duration::from_secs(4), base: 2.0 };
    RetryConfig { backoff, max_retries: 6, retry_timeout: Duration::from_secs(25) }
}

fn client_options(purpose: Purpose) -> ClientOptions {
    let silence = Duration::from_secs(if purpose == Purpose::Writing { 60 } else { 10 });
    ClientOptions::new()
        .with_allow_http(true)
        .with_timeout_disabled()
        .with_connect_timeout(Duration::from_secs(5))
        .with_read_timeout(silence)
}

/// A client, with its connections, that the stores of HTTP servers share.
#[derive(Clone, Debug)]
struct SharedClient(HttpClient);

impl HttpConnector for SharedClient {
    fn connect(&self, _: &ClientOptions) -> object_store::Result<HttpClient> {
        Ok(self.0.clone())
    }
}

type Key = (u32, Purpose, String);
static STORES: Mutex<Option<HashMap<Key, Store>>> = Mutex::new(None);
static CLIENTS: Mutex<Option<HashMap<Key, SharedClient>>> = Mutex::new(None);

/// Returns the value that `all` keeps for `key`. If there is none, calls `make` and keeps its value.
fn kept<T: Clone>(all: &Mutex<Option<HashMap<Key, T>>>, key: Key, make: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    let mut all = all.lock().unwrap_or_else(|e| e.into_inner());
    let all = all.get_or_insert_with(HashMap::new);
    if let Some(known) = all.get(&key) {
        return Ok(known.clone());
    }
    let made = make()?;
    all.insert(key, made.clone());
    Ok(made)
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn base64(bytes: &[u8]) -> String {
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let number = three.iter().fold(0u32, |n, b| n << 8 | u32::from(*b)) << (8 * (3 - three.len()));
        for i in 0..4 {
            let digit = DIGITS[(number >> (18 - 6 * i) & 63) as usize] as char;
            text.push(if i <= three.len() { digit } else { '=' });
        }
    }
    text
}

/// Returns the client for a user, "NAME:PASSWORD", or for requests without a user if `user` is empty.
fn http_client(purpose: Purpose, user: &str) -> Result<SharedClient, Failure> {
    kept(&CLIENTS, (std::process::id(), purpose, user.to_string()), || {
        let mut options = client_options(purpose);
        if !user.is_empty() {
            let mut value = HeaderValue::from_str(&format!("Basic {}", base64(user.as_bytes())))
                .map_err(|_| Failure::new(Status::WrongAddress, "its user has a letter that no header may have"))?;
            value.set_sensitive(true);
            options = options.with_default_headers(HeaderMap::from_iter([(reqwest::header::AUTHORIZATION, value)]));
        }
        Ok(SharedClient(ReqwestConnector::default().connect(&options)?))
    })
}

fn decoded(text: &str) -> String {
    Path::from_url_path(text).map_or_else(|_| text.to_string(), |path| path.to_string())
}

/// Returns the place of an object on an HTTP server. The store has the address of the object itself, so that the query of
/// the address stays unchanged. Only the client is kept for later requests.
fn http_place(address: &str, purpose: Purpose) -> Result<Place, Failure> {
    let wrong = |e: url::ParseError| Failure::new(Status::WrongAddress, e.to_string());
    let mut url = Url::parse(address).map_err(wrong)?;
    let user = match (url.username(), url.password()) {
        ("", None) => String::new(),
        (name, password) => format!("{}:{}", decoded(name), decoded(password.unwrap_or(""))),
    };
    let _ = url.set_username("");
    let _ = url.set_password(None);
    url.set_fragment(None);
    let store = HttpBuilder::new()
        .with_url(url.as_str())
        .with_retry(retries())
        .with_http_connector(http_client(purpose, &user)?)
        .build()?;
    Ok(Place { store: Arc::new(store), path: Path::default(), is_bucket: false })
}

fn bucket_store(scheme: &str, bucket: &str, purpose: Purpose) -> Result<Store, Failure> {
    let (options, retry) = (client_options(purpose), retries());
    Ok(match scheme {
        "s3" | "s3a" => Arc::new(AmazonS3Builder::from_env().with_client_options(options).with_retry(retry).with_bucket_name(bucket).build()?),
        "gs" => Arc::new(GoogleCloudStorageBuilder::from_env().with_client_options(options).with_retry(retry).with_bucket_name(bucket).build()?),
        _ => Arc::new(MicrosoftAzureBuilder::from_env().with_client_options(options).with_retry(retry).with_container_name(bucket).build()?),
    })
}

/// Returns the place of an object in a bucket. The key is the unchanged text after the name of the bucket.
fn bucket_place(scheme: &str, rest: &str, purpose: Purpose) -> Result<Place, Failure> {
    let (bucket, key) = rest.split_once('/').unwrap_or((rest, ""));
    let bucket = bucket.split('@').next().unwrap_or(bucket); // abfs://CONTAINER@ACCOUNT.dfs.core.windows.net/KEY
    if bucket.is_empty() {
        return Err(Failure::new(Status::WrongAddress, "it names no bucket"));
    }
    let settings: Vec<String> = std::env::vars_os()
        .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)))
        .filter(|(name, _)| ["AWS_", "GOOGLE_", "AZURE_"].iter().any(|prefix| name.starts_with(prefix)))
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    let key_of_store = format!("{scheme}://{bucket} {}", settings.join(" "));
    let store = kept(&STORES, (std::process::id(), purpose, key_of_store), || bucket_store(scheme, bucket, purpose))?;
    let path = Path::parse(key).map_err(|e| Failure::from(object_store::Error::from(e)))?;
    Ok(Place { store, path, is_bucket: true })
}

pub fn place_of(address: &str, purpose: Purpose) -> Result<Place, Failure> {
    match address.split_once("://") {
        Some(("http" | "https", _)) => http_place(address, purpose),
        Some((scheme @ ("s3" | "s3a" | "gs" | "az" | "azure" | "abfs" | "abfss" | "adl"), rest)) => bucket_place(scheme, rest, purpose),
        _ => Err(Failure::new(Status::WrongAddress, "its scheme is not http, https, s3, gs or az")),
    }
}
