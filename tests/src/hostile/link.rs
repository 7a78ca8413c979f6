//! Messages of any content between gateway and board: refused, or understood and within bounds.

use leadscrew_core::cycle::{Context, expand};
use leadscrew_core::link::{
    self, Batch, EventReader, ImageReader, ImageWriter, Status, bounds, encode_call, encode_event,
};
use leadscrew_core::offsets::Revision;
use leadscrew_core::params::Params;

/// The first byte chooses the message.
///
/// # Panics
/// Where a message is understood but does not encode to the same bytes, or is out of bounds.
pub fn link(data: &[u8]) {
    let Some((choice, message)) = data.split_first() else {
        return;
    };
    match choice % 4 {
        0 => calls(message),
        1 => {
            if let Ok(Ok(status)) = Status::decode(message) {
                let mut again = [0; 512];
                let used = status.encode(&mut again).expect("as long as it was");
                assert_eq!(Status::decode(&again[..used]), Ok(Ok(status)));
            }
        }
        2 => {
            for entry in EventReader::new(message).map_while(Result::ok) {
                let mut again = [0; 512];
                let used = encode_event(entry.number, entry.tick, &entry.event, &mut again)
                    .expect("as long as it was");
                let mut reader = EventReader::new(&again[..used]);
                assert_eq!(reader.next(), Some(Ok(entry)));
            }
        }
        _ => {
            image(message);
            changes(message);
        }
    }
}

/// Calls after a right head, so that the calls are reached.
fn calls(message: &[u8]) {
    let mut bytes = link::BatchWriter::new(1, Revision(0), 0).bytes().to_vec();
    bytes.extend_from_slice(message);
    let batch = Batch::new(&bytes).expect("a right head");
    for (call, taken) in batch.map_while(Result::ok) {
        assert_eq!(bounds::call(&call), Ok(()));
        let again = encode_call(&call).expect("a bounded call is short");
        assert!(again.len() <= taken.len(), "{call:?}");
        if let Ok(moves) = expand(&call, &Context::default()) {
            for next in moves.take(200) {
                for nm in [next.to.x.nm(), next.to.z.nm(), next.to.c.udeg()] {
                    assert!(nm.abs() < 1 << 44, "{call:?}: {next:?}");
                }
            }
        }
    }
}

/// A right image with some bytes changed: only an unchanged image may be accepted.
fn image(message: &[u8]) {
    let params = Params::sheets();
    let mut bytes = vec![0; ImageWriter::BYTES as usize];
    assert_eq!(ImageWriter::new(&params).read(0, &mut bytes), bytes.len());
    let right = bytes.clone();
    for change in message.chunks_exact(3) {
        let at = usize::from(u16::from_le_bytes([change[0], change[1]])) % bytes.len();
        bytes[at] ^= change[2];
    }
    let mut staged = params.clone();
    let mut reader = ImageReader::new();
    let size = message.len() % 61 + 1;
    let taken = bytes
        .chunks(size)
        .try_for_each(|piece| reader.take(piece, &mut staged))
        .and_then(|()| reader.finish(&staged));
    // A checksum of 32 bits finds any change of up to three bytes in a row. Other changes are found except by chance.
    assert!(
        taken.is_err() || bytes == right || message.len() > 9,
        "a changed image is taken"
    );
}

/// The changes of a staged set: accepted bytes give a set with their identity that may be stored.
fn changes(message: &[u8]) {
    let after = Params::sheets();
    let Ok(before) = link::decode_changes(message, &after) else {
        return;
    };
    let head = message.first_chunk().copied().unwrap_or_default();
    assert_eq!(link::identity(&before), u32::from_le_bytes(head));
    let mut bytes = vec![0; message.len().max(4)];
    let length = link::encode_changes(&before, &after, &mut bytes);
    assert!(length.is_ok_and(|length| length <= message.len()));
}
