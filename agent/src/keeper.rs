//! Keeps what an observation tells before anything is sent, and goes on only from what was kept.

use std::sync::Arc;

use crate::model::{Model, Observation};
use crate::record::{Moment, Numbered};
use crate::store::{Store, StoreError};

/// A model with its store.
#[derive(Debug)]
pub struct Keeper {
    model: Model,
    store: Arc<Store>,
}

impl Keeper {
    /// Goes on where the store ends.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn new(store: Arc<Store>) -> Result<Self, StoreError> {
        let model = Model::new(store.memory()?);
        Ok(Self { model, store })
    }

    /// The model as far as it was kept.
    #[must_use]
    pub const fn model(&self) -> &Model {
        &self.model
    }

    /// Keeps what an observation tells. Where nothing is new, nothing is written.
    ///
    /// # Errors
    /// It could not be kept: the observation has not been made.
    pub fn take(&mut self, at: Moment, seen: &Observation) -> Result<Vec<Numbered>, StoreError> {
        let mut next = self.model.clone();
        let records = next.take(at, seen);
        let kept = if records.is_empty() {
            Vec::new()
        } else {
            self.store.keep(&records, next.memory())?
        };
        self.model = next;
        Ok(kept)
    }
}
