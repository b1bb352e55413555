// SPDX-License-Identifier: MIT
//! The owner of a file from which readers and writers of the crate `e57` borrow.

/// A box whose content does not move. A borrower must be dropped before the box.
pub struct Owned<T>(*mut T);

impl<T> Owned<T> {
    pub fn new(content: T) -> Self {
        Self(Box::into_raw(Box::new(content)))
    }
    pub fn get(&self) -> *mut T {
        self.0
    }
}

impl<T> Drop for Owned<T> {
    fn drop(&mut self) {
        drop(unsafe { Box::from_raw(self.0) });
    }
}
