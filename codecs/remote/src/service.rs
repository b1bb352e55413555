// SPDX-License-Identifier: MIT
//! The runtime that performs requests. The first request makes the runtime; a forked process makes its own.

use crate::failure::{Failure, Status};
use std::future::Future;
use std::sync::atomic::{AtomicPtr, Ordering};
use std::sync::{Arc, Mutex, Once};
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};

const THREADS: usize = 2;
const LOOKS_AT_CANCELLATION: Duration = Duration::from_millis(100);

static RUNTIME: Mutex<Option<(u32, Arc<Runtime>)>> = Mutex::new(None);
static CANCELLED: AtomicPtr<()> = AtomicPtr::new(std::ptr::null_mut());
static PROVIDER: Once = Once::new();

pub type Cancelled = extern "C" fn() -> i32;

pub fn set_cancelled(cancelled: Cancelled) {
    CANCELLED.store(cancelled as *mut (), Ordering::Relaxed);
}

fn is_cancelled() -> bool {
    let function = CANCELLED.load(Ordering::Relaxed);
    // set_cancelled() stores only functions of this type.
    !function.is_null() && unsafe { std::mem::transmute::<*mut (), Cancelled>(function) }() != 0
}

fn runtime() -> Result<Arc<Runtime>, Failure> {
    PROVIDER.call_once(|| drop(rustls::crypto::ring::default_provider().install_default()));
    let mut runtime = RUNTIME.lock().unwrap_or_else(|e| e.into_inner());
    let process = std::process::id();
    if let Some((owner, running)) = &*runtime {
        if *owner == process {
            return Ok(running.clone());
        }
    }
    let made = Builder::new_multi_thread().worker_threads(THREADS).thread_name("remote").enable_all().build();
    let made = Arc::new(made.map_err(|e| Failure::new(Status::Other, e.to_string()))?);
    // A forked process does not have the threads of its parent. Dropping the runtime of the parent would wait for these
    // threads, so the runtime is leaked.
    std::mem::forget(runtime.replace((process, made.clone())));
    Ok(made)
}

/// Performs a request and blocks this thread. Fails with `Status::Cancelled` if the work of the thread is cancelled.
pub fn perform<T>(work: impl Future<Output = Result<T, Failure>>) -> Result<T, Failure> {
    runtime()?.block_on(async {
        let mut work = std::pin::pin!(work);
        loop {
            if is_cancelled() {
                return Err(Failure::new(Status::Cancelled, "cancelled"));
            }
            if let Ok(done) = tokio::time::timeout(LOOKS_AT_CANCELLATION, &mut work).await {
                return done;
            }
        }
    })
}
