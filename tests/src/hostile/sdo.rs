//! Frames of any content to an SDO server: what it commits is what was written, whole.

use leadscrew_core::bus::{
    Abort, BlockSize, CobId, Frame, NodeId, Object, Objects, Periods, SdoServer, Service,
};

/// Bytes an object may have here.
const ROOM: usize = 4096;

/// One value; what is written comes to stand in it at the end of a write, or not at all.
#[derive(Default)]
struct Value {
    committed: Vec<u8>,
    coming: Option<(Object, Option<u32>, Vec<u8>)>,
    reading: Option<Object>,
}

impl Objects for Value {
    fn size(&mut self, object: Object) -> Result<u32, Abort> {
        if object.index == 0 {
            return Err(Abort::NoObject);
        }
        self.reading = Some(object);
        Ok(self.committed.len() as u32)
    }

    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort> {
        assert_eq!(self.reading, Some(object), "read without size");
        let rest = self.committed.get(offset as usize..);
        let rest = rest.expect("never reads beyond the end");
        let count = rest.len().min(into.len());
        into[..count].copy_from_slice(&rest[..count]);
        Ok(count)
    }

    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort> {
        assert!(self.coming.is_none(), "two writes at once");
        if object.index == 0 {
            return Err(Abort::NoObject);
        }
        if size.is_some_and(|size| size as usize > ROOM) {
            return Err(Abort::TooLong);
        }
        self.coming = Some((object, size, Vec::new()));
        Ok(())
    }

    fn write(&mut self, object: Object, offset: u32, bytes: &[u8]) -> Result<(), Abort> {
        let (about, _, coming) = self.coming.as_mut().expect("write without begin_write");
        assert_eq!(*about, object);
        assert_eq!(coming.len(), offset as usize, "a gap, or bytes twice");
        if coming.len() + bytes.len() > ROOM {
            return Err(Abort::TooLong);
        }
        coming.extend_from_slice(bytes);
        Ok(())
    }

    fn end_write(&mut self, object: Object, length: u32) -> Result<(), Abort> {
        let (about, size, coming) = self.coming.take().expect("end_write without begin_write");
        assert_eq!(about, object);
        assert_eq!(coming.len(), length as usize);
        assert!(size.is_none_or(|size| size == length), "a part of it");
        self.committed = coming;
        Ok(())
    }

    fn abandon(&mut self, object: Object) {
        let (about, ..) = self.coming.take().expect("nothing to abandon");
        assert_eq!(about, object);
    }
}

/// Records of nine bytes: a frame's payload, and how many periods go by behind it.
///
/// # Panics
/// Where the server breaks the order of calls that [`Objects`] promises, answers with a frame that is none, or sends
/// without end.
pub fn sdo(data: &[u8]) {
    let node = NodeId::BOARD;
    let block = BlockSize::new(127).expect("127 is a block size");
    let mut server = SdoServer::new(node, Periods::new(100), block);
    let mut value = Value::default();
    let mut heard = Vec::new();
    for record in data.chunks_exact(9) {
        let (wait, payload) = record.split_first().expect("nine bytes");
        let frame = Frame::new(CobId::of(Service::SdoRequest, node), payload);
        let frame = frame.expect("eight bytes");
        heard.extend(server.receive(&frame, &mut value));
        for sent in 0.. {
            assert!(sent <= 127, "more than a block without an answer");
            let Some(frame) = server.poll(&mut value) else {
                break;
            };
            heard.push(frame);
        }
        heard.extend(server.elapse(Periods::new(u32::from(*wait)), &mut value));
        for answer in heard.drain(..) {
            assert_eq!(answer.id(), CobId::of(Service::SdoReply, node));
            assert_eq!(answer.payload().len(), 8);
        }
        assert!(value.coming.is_none() || server.is_busy(), "forgotten");
    }
    server.reset(&mut value);
    assert!(value.coming.is_none(), "not abandoned by a reset");
}
