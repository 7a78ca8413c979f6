//! CANopen: what the tick needs of it (frames, the master of each CiA 402 drive) comes from the tick's crate; the service
//! data objects, which the background serves, are here.
//!
//! Must not know the purpose of positions or the meaning of objects.

mod sdo;

pub use leadscrew_motion::bus::*;
pub use sdo::{
    BlockSize, SdoBuffer, SdoDownload, SdoError, SdoProtocol, SdoServer, SdoSink, SdoUpload,
};
