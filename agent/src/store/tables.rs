//! The tables of the file, and what stands in them: bytes of JSON by number, and by name in the head.
//!
//! It must not know which records stay.

use std::ops::RangeInclusive;

use redb::{ReadTransaction, ReadableTable as _, Table, TableDefinition};
use serde::{Deserialize, Serialize};

use super::error::{StoreError, StoreResult};
use crate::record::{Class, Numbered, Record};

const STATES: TableDefinition<'_, u64, &[u8]> = TableDefinition::new("states");
const EVENTS: TableDefinition<'_, u64, &[u8]> = TableDefinition::new("events");
pub(super) const CERTIFICATES: TableDefinition<'_, u64, &[u8]> =
    TableDefinition::new("certificates");
pub(super) const HEAD: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("head");
/// Entries of the head.
pub(super) const FIGURES: &str = "figures";
/// What was remembered of a machine stands behind this and its name. Earlier versions had one machine, and no name.
pub(super) const MEMORY: &str = "memory";
/// Whose the records are that name no machine.
pub(super) const NAMELESS: &str = "nameless";

pub(super) const fn table(class: Class) -> TableDefinition<'static, u64, &'static [u8]> {
    match class {
        Class::State => STATES,
        Class::Event => EVENTS,
        Class::Certificate => CERTIFICATES,
    }
}

/// Takes out the first record where its number is meant; its number and its bytes.
pub(super) fn first(
    table: &mut Table<'_, u64, &'static [u8]>,
    is_meant: impl Fn(u64) -> bool,
) -> StoreResult<Option<(u64, u64)>> {
    let found = table.first()?.map(|(number, _)| number.value());
    match found.filter(|number| is_meant(*number)) {
        Some(number) => take(table, number),
        None => Ok(None),
    }
}

/// The same with the first that is in none of these ranges.
pub(super) fn oldest_but(
    table: &mut Table<'_, u64, &'static [u8]>,
    stays: &[RangeInclusive<u64>],
) -> StoreResult<Option<(u64, u64)>> {
    let mut from = 0;
    loop {
        let found = match table.range(from..)?.next() {
            Some(entry) => entry?.0.value(),
            None => return Ok(None),
        };
        match stays.iter().find(|range| range.contains(&found)) {
            Some(range) => from = range.end() + 1,
            None => return take(table, found),
        }
    }
}

/// The first records in a range of numbers, in order.
pub(super) fn records(
    reading: &ReadTransaction,
    range: RangeInclusive<u64>,
    most: usize,
) -> StoreResult<Vec<Numbered>> {
    let nameless: Option<String> = get(&reading.open_table(HEAD)?, NAMELESS)?;
    let nameless = nameless.unwrap_or_default();
    let mut records = Vec::new();
    for class in Class::ALL {
        let table = reading.open_table(table(class))?;
        for entry in table.range(range.clone())?.take(most) {
            let (number, bytes) = entry?;
            let number = number.value();
            let mut record: Record = parsed(bytes.value())?;
            if record.machine.is_empty() {
                record.machine.clone_from(&nameless);
            }
            records.push(Numbered { number, record });
        }
    }
    records.sort_by_key(|record| record.number);
    records.truncate(most);
    Ok(records)
}

fn take(table: &mut Table<'_, u64, &'static [u8]>, number: u64) -> StoreResult<Option<(u64, u64)>> {
    let removed = table.remove(number)?;
    Ok(removed.map(|bytes| (number, bytes.value().len() as u64)))
}

pub(super) fn memory_of(machine: &str) -> String {
    format!("{MEMORY} {machine}")
}

pub(super) fn written(value: &impl Serialize) -> StoreResult<Vec<u8>> {
    serde_json::to_vec(value).map_err(StoreError::Content)
}

fn parsed<T: for<'de> Deserialize<'de>>(bytes: &[u8]) -> StoreResult<T> {
    serde_json::from_slice(bytes).map_err(StoreError::Content)
}

pub(super) fn put(
    head: &mut Table<'_, &'static str, &'static [u8]>,
    entry: &str,
    value: &impl Serialize,
) -> StoreResult {
    head.insert(entry, &written(value)?[..])?;
    Ok(())
}

pub(super) fn get<T: for<'de> Deserialize<'de>>(
    head: &impl redb::ReadableTable<&'static str, &'static [u8]>,
    entry: &str,
) -> StoreResult<Option<T>> {
    match head.get(entry)? {
        Some(bytes) => parsed(bytes.value()).map(Some),
        None => Ok(None),
    }
}
