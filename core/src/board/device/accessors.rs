//! The values of the objects: the result of a read, and the effect of a write.
//!
//! `objects` says which row uses which function, `served` how a value travels.

use super::change::Change;
use super::dictionary::{self, ObjectSource};
use super::objects;
use super::table::DROP;
use super::values::{ObjectValues, Told};
use crate::board::store::copy;
use crate::bus::{
    Abort, Beat, BoardBeat, BoardPlace, BoardSpindle, BoardStatus, HeartbeatProducer,
    HeartbeatWatch, Mapped, Object, Order,
};
use crate::link::{encode_alarm, encode_changes};
use crate::params::Params;
use crate::signals::Signals;
use crate::tick::Command;

/// A percentage that means no change.
const AS_IT_IS: u8 = 255;

impl ObjectValues {
    /// Puts the content of an object without a fixed length into the buffer. Returns the number of bytes.
    pub(super) fn domain(&mut self, object: Object, params: &Params) -> Result<usize, Abort> {
        objects::bytes(self, object, params)
    }

    /// The present number of an object.
    pub(super) fn number(
        &self,
        object: Object,
        place: ObjectSource,
        params: &Params,
    ) -> Result<i64, Abort> {
        let row = match place {
            ObjectSource::Parameter(entry) => {
                let told = self.current(params).told(entry);
                return Ok(dictionary::told(entry, told));
            }
            ObjectSource::Highest(highest) => return Ok(highest.into()),
            ObjectSource::Row(row) => row,
        };
        if let Some(pdo) = self.pdos.of(object.index) {
            return pdo.read(object.sub).map(i64::from);
        }
        let number = objects::get(self, object, params)?;
        Ok(number.unwrap_or_else(|| row.number(self.node)))
    }

    /// Puts a number into effect. Its kind and range have been checked.
    pub(super) fn take_number(
        &mut self,
        object: Object,
        value: u32,
        params: &Params,
    ) -> Result<(), Abort> {
        if let Some(pdo) = self.pdos.of_mut(object.index) {
            return pdo.write(object.sub, value);
        }
        objects::set(self, object, value, params)
    }
}

/// Reads.
impl ObjectValues {
    /// A value of 5001h, taken from the PDO that has it.
    pub(super) fn fact(&self, sub: u8) -> i64 {
        let (told, mapping) = match sub {
            ..=7 => (Told::Status, &BoardStatus::MAPPING[..]),
            8 | 9 => (Told::Place, &BoardPlace::MAPPING[..]),
            _ => (Told::Spindle, &BoardSpindle::MAPPING[..]),
        };
        self.mapped(told, mapping, sub)
    }

    /// Single block and dry run in the form of 5000h:03.
    pub(super) fn switches_now(&self) -> u8 {
        u8::from(self.snapshot.operator.single_block) | u8::from(self.dry_run) << 1
    }

    /// The identifier of the frame with all setpoints. `unused` is its identifier on node 0 while the parameters do not ask
    /// for the frame.
    pub(super) fn setpoints_cob_id(&self, unused: u32, params: &Params) -> u32 {
        let own = unused.saturating_add(self.node.get().into());
        if params.setpoint_frame() == 1 {
            own & !(1 << 31)
        } else {
            own
        }
    }

    pub(super) fn status_bytes(&mut self, params: &Params) -> Result<usize, Abort> {
        let status = self.record(params);
        status.encode(&mut self.buffer).map_err(|_| Abort::Internal)
    }

    pub(super) fn refusal(&mut self) -> Result<usize, Abort> {
        encode_alarm(self.parameter_store.reason(), &mut self.buffer).map_err(|_| Abort::Internal)
    }

    pub(super) fn offsets_refusal(&mut self) -> Result<usize, Abort> {
        let reason = self.offset_store.shelf.reason();
        encode_alarm(reason, &mut self.buffer).map_err(|_| Abort::Internal)
    }

    pub(super) fn staged_changes(&mut self, params: &Params) -> Result<usize, Abort> {
        encode_changes(params, &self.draft, &mut self.buffer).map_err(|_| Abort::OutOfMemory)
    }

    pub(super) fn tap_bytes(&mut self) -> Result<usize, Abort> {
        let record = self.snapshot.tap.as_ref().ok_or(Abort::NoData)?;
        Ok(copy(&record.encode(), &mut self.buffer))
    }

    pub(super) fn events(&mut self) -> Result<usize, Abort> {
        Ok(self.log.read(self.log_from, &mut self.buffer))
    }

    pub(super) fn certificates(&mut self) -> Result<usize, Abort> {
        self.recorder
            .read(self.late, &mut self.buffer)
            .map_err(|_| Abort::Internal)
    }
}

/// Writes.
impl ObjectValues {
    /// Takes the last good set into force.
    pub(super) fn recall(&mut self, params: &Params) -> Result<(), Abort> {
        self.admit(params, Change::Recall)?;
        self.parameter_store.recall()
    }

    /// 1016h:01.
    pub(super) fn watch_gateway(&mut self, value: u32, params: &Params) -> Result<(), Abort> {
        let watch = HeartbeatWatch::from_raw(value);
        if watch.is_none() && value != 0 {
            return Err(Abort::Value);
        }
        self.watch.set(0, watch, params.tick_us())
    }

    /// 1017h.
    pub(super) fn beat_every(&mut self, ms: u32, params: &Params) -> Result<(), Abort> {
        self.heartbeat = HeartbeatProducer::new(ms as u16, params.tick_us());
        Ok(())
    }

    /// The count of the next order.
    pub(super) fn put_count(&mut self, count: u32) -> Result<(), Abort> {
        self.count = count as u8;
        Ok(())
    }

    /// An order by its number; 0 is none.
    pub(super) fn order_number(&mut self, number: u32, params: &Params) -> Result<(), Abort> {
        if number == 0 {
            return Ok(());
        }
        let order = Order::from_raw(number as u8).ok_or(Abort::Value)?;
        let echo = self.echo.take();
        if !self.is_fresh((self.count, order), echo, params) {
            return Err(Abort::State);
        }
        self.order(order, params).map_err(|_| Abort::State)
    }

    /// The echo for the order that is written next.
    pub(super) fn put_echo(&mut self, value: u32) -> Result<(), Abort> {
        self.echo = Some(Beat::new(value as u16));
        Ok(())
    }

    /// A value of 5002h, taken from the PDO that has it.
    pub(super) fn beat_fact(&self, sub: u8) -> i64 {
        self.mapped(Told::Beat, &BoardBeat::MAPPING, sub)
    }

    /// 5002h:07.
    pub(super) fn put_by_wheel(&mut self, value: u32) -> Result<(), Abort> {
        self.set_by_wheel(value != 0).map_err(|alarm| {
            self.deny(&alarm);
            Abort::State
        })
    }

    /// The value with this sub-index in a PDO.
    fn mapped(&self, told: Told, mapping: &[Mapped], sub: u8) -> i64 {
        let before = mapping.iter().take_while(|mapped| mapped.object.sub != sub);
        let bits = before.fold(0, |bits: u32, mapped| bits.wrapping_add(mapped.bits.into()));
        let raw = u64::from_le_bytes(self.tell(told).exactly().unwrap_or_default());
        raw.wrapping_shr(bits) as i64
    }

    /// A switch or an override of 5000h.
    pub(super) fn put_setting(&mut self, sub: u8, value: u32) -> Result<(), Abort> {
        self.setting(sub, value as u8);
        Ok(())
    }

    /// A switch or an override of 5000h.
    pub fn setting(&mut self, sub: u8, value: u8) {
        if sub == 3 {
            let on = |bit: u8| (value >> bit & 0x10 != 0).then_some(value >> bit & 1 != 0);
            self.switches(on(0), on(1));
            return;
        }
        if value == AS_IT_IS {
            return;
        }
        match sub {
            4 => self.command(Command::FeedOverride(value)),
            5 => self.command(Command::RapidOverride(value)),
            6 => self.command(Command::SpindleOverride(value)),
            _ => {}
        }
    }

    fn switches(&mut self, single_block: Option<bool>, dry_run: Option<bool>) {
        if let Some(on) = single_block {
            self.command(Command::SingleBlock(on));
        }
        self.dry_run = dry_run.unwrap_or(self.dry_run);
    }

    /// Requests that the entry of the tap journal be dropped.
    pub(super) fn discard_tap(&mut self, value: u32) -> Result<(), Abort> {
        if value != DROP {
            return Err(Abort::Value);
        }
        if self.snapshot.tap.is_none_or(|tap| !tap.in_hole) {
            return Err(Abort::NoData);
        }
        if !self.snapshot.is_at_rest() {
            return Err(Abort::State);
        }
        self.drops_tap = true;
        Ok(())
    }

    pub(super) fn read_events_from(&mut self, number: u32) -> Result<(), Abort> {
        self.log_from = number;
        Ok(())
    }

    /// The inputs, for the tick.
    pub(super) fn put_signals(&mut self, bits: u32) -> Result<(), Abort> {
        self.signals = Some(Signals::from_bits(bits as u16).ok_or(Abort::Value)?);
        Ok(())
    }
}
