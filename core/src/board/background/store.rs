//! What the board stores: the tap journal's entries, parameter sets and tables of offsets. The owner has the storage.

use super::orders::has_room;
use super::{Background, BackgroundSide};
use crate::board::kept::Held;
use crate::board::request::{Content, StoreRequest};
use crate::board::store::Region;
use crate::tick::{Order, StoreError};

impl Background {
    /// The next write for the storage; the owner answers it with [`stored`](BackgroundSide::stored). `None` where nothing
    /// is to be stored, or where the last write has not been answered yet. Of entries that come meanwhile, only the newest
    /// counts.
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        let request = match self.journal.newest.as_ref() {
            Some(record) if self.journal.wanted && self.journal.under_way.is_none() => {
                self.journal.wanted = false;
                self.journal.under_way = Some(record.sequence);
                StoreRequest {
                    region: Region::TapJournal,
                    content: Content::Tap(record.encode()),
                }
            }
            _ => self.device.store()?,
        };
        self.storing = Some(request.region);
        Some(request)
    }

    /// What is being stored: the last write of [`store`](Self::store), until it is answered.
    #[must_use]
    pub const fn storing(&self) -> Option<Region> {
        self.storing
    }

    /// The next region to read; the owner answers with [`loaded`](Self::loaded).
    pub const fn load(&mut self) -> Option<Region> {
        self.device.load()
    }

    /// The content of the region that [`load`](Self::load) asked for.
    pub fn loaded(&mut self, held: Held<'_>) {
        self.device.loaded(held);
    }
}

impl BackgroundSide<'_> {
    /// True where there is room for the consequences of [`stored`](Self::stored).
    #[must_use]
    pub fn takes_stored(&self) -> bool {
        has_room(&self.ends)
    }

    /// The last write of [`store`](Background::store) has been done, or has failed. A parameter set may come into force
    /// with it.
    pub fn stored(&mut self, region: Region, result: Result<(), StoreError>) {
        self.state.storing = None;
        match region {
            Region::TapJournal => {
                if let Some(sequence) = self.state.journal.under_way.take() {
                    let orders = &mut self.state.orders;
                    orders.give(&mut self.ends, Order::Stored(sequence, result));
                }
            }
            _ => self.state.device.has_stored(region, result),
        }
        self.carry_out();
    }
}
