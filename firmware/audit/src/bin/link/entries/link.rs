//! Messages between gateway and board.

use audit::any::{any, sink};
use leadscrew_core::board::Event;
use leadscrew_core::call::Call;
use leadscrew_core::link::{
    Batch, BatchWriter, Certificate, EventReader, ImageReader, ImageWriter, LinkError, Logged,
    Status, ThreadReader, bounds, decode_changes, encode_call, encode_certificates, encode_changes,
    encode_event, identity,
};
use leadscrew_core::offsets::Revision;
use leadscrew_core::params::Params;

/// Calls all entries of this module.
pub fn all() {
    batch();
    records();
    image();
}

#[inline(never)]
fn batch() {
    let call: Call = any();
    sink(bounds::call(&call));
    let mut writer = BatchWriter::new(any(), Revision(any()), any());
    while any() {
        sink(encode_call(&call).and_then(|bytes| writer.push(&bytes)));
    }
    sink((writer.bytes().len(), writer.count()));
    let bytes: [u8; 64] = any();
    if let Ok(batch) = Batch::new(bytes.get(..any()).unwrap_or(&bytes)) {
        for call in batch {
            sink(call);
        }
    }
}

#[inline(never)]
fn records() {
    let bytes: [u8; 64] = any();
    let bytes = bytes.get(..any()).unwrap_or(&bytes);
    sink(Status::decode(bytes));
    let mut room = [0; 64];
    for entry in EventReader::new(bytes) {
        sink(entry.and_then(|entry: Logged| {
            encode_event(entry.number, entry.tick, &entry.event, &mut room)
        }));
    }
    if let Ok(Ok(status)) = Status::decode(bytes) {
        sink(status.encode(&mut room));
    }
    sink((Event::Ready, LinkError::Malformed));
    if let Ok(Ok(run)) = Certificate::decode(bytes)
        && let Ok(threads) = ThreadReader::new(bytes)
    {
        for thread in threads.flatten() {
            let records = [thread.record];
            sink(encode_certificates(
                &run,
                thread.number,
                &records,
                &mut room,
            ));
        }
    }
}

#[inline(never)]
fn image() {
    let params: Params = any();
    let mut bytes: [u8; 16] = any();
    sink((
        ImageWriter::new(&params).read(any(), &mut bytes),
        identity(&params),
    ));
    let other: Params = any();
    sink((
        encode_changes(&params, &other, &mut bytes),
        decode_changes(&bytes, &other),
    ));
    let mut staged = params;
    let mut reader = ImageReader::new();
    while any() {
        sink(reader.take(&any::<[u8; 8]>(), &mut staged));
    }
    sink(reader.finish(&staged));
}
