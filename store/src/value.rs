//! What a board asks for, as a value of the map: put into the map's own buffer, so that there is no second copy.

use leadscrew_core::board::StoreRequest;
use sequential_storage::map::{SerializationError, Value};

/// A request on its way into the flash.
pub struct Wanted<'a>(pub &'a StoreRequest<'a>);

impl Value<'_> for Wanted<'_> {
    fn serialize_into(&self, buffer: &mut [u8]) -> Result<usize, SerializationError> {
        if buffer.len() < self.0.region.bytes() {
            return Err(SerializationError::BufferTooSmall);
        }
        Ok(self.0.fill(buffer).len())
    }

    fn deserialize_from(_: &[u8]) -> Result<(Self, usize), SerializationError> {
        // Never read: what comes back is bytes.
        Err(SerializationError::InvalidFormat)
    }
}
