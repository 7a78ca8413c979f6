//! Keeps what an observation tells before anything is sent, and goes on only from what was kept.

use std::sync::Arc;

use crate::model::{Model, Observation};
use crate::record::{Moment, Numbered, Record};
use crate::store::{Store, StoreError};

/// A model of one machine, with the store of all.
#[derive(Debug)]
pub struct Keeper {
    machine: String,
    model: Model,
    store: Option<Arc<Store>>,
}

impl Keeper {
    /// Goes on where the store ends.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn new(store: Arc<Store>, machine: &str) -> Result<Self, StoreError> {
        let model = Model::new(store.memory(machine)?);
        Ok(Self {
            machine: machine.to_owned(),
            model,
            store: Some(store),
        })
    }

    /// Keeps nothing: there is nobody to send it to. Its records have the number 0.
    #[must_use]
    pub fn without_store(machine: &str) -> Self {
        Self {
            machine: machine.to_owned(),
            model: Model::from_now(),
            store: None,
        }
    }

    /// The model as far as it was kept.
    #[must_use]
    pub const fn model(&self) -> &Model {
        &self.model
    }

    /// The disk is full, and states go for want of room on it.
    #[must_use]
    pub fn is_tight(&self) -> bool {
        self.store.as_ref().is_some_and(|store| store.is_tight())
    }

    /// Keeps what an observation tells. Where nothing is new, nothing is written.
    ///
    /// # Errors
    /// It could not be kept: the observation has not been made.
    pub fn take(&mut self, at: Moment, seen: &Observation) -> Result<Vec<Numbered>, StoreError> {
        let mut next = self.model.clone();
        let records = next.take(at, seen);
        let of_machine = |body| Record {
            at,
            machine: self.machine.clone(),
            body,
        };
        let records: Vec<Record> = records.into_iter().map(of_machine).collect();
        let kept = match &self.store {
            _ if records.is_empty() => Vec::new(),
            Some(store) => store.keep(&self.machine, &records, next.memory())?,
            None => {
                let number = |record| Numbered { number: 0, record };
                records.into_iter().map(number).collect()
            }
        };
        self.model = next;
        Ok(kept)
    }
}
