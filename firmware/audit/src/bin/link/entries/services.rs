//! The services of a node on the bus, apart from its drives: SDO, network management, heartbeats, emergencies, the
//! board's own PDOs.

use core::time::Duration;

use audit::any::{any, sink};
use leadscrew_core::bus::{
    Abort, Beat, BoardBeat, BoardCommand, BoardPlace, BoardSpindle, BoardStatus, EmcyProducer,
    HeartbeatConsumer, HeartbeatProducer, HeartbeatWatch, JogRequest, NmtSlave, Object, Objects,
    Order, OrderGate, PdoCommunication, SdoBuffer, SdoDownload, SdoProtocol, SdoServer, SdoUpload,
    Service, StepRequest, WheelRequest,
};

/// Calls all entries of this module.
pub fn all() {
    server();
    download();
    upload();
    network();
    emergencies();
    board_pdos();
    communication();
}

/// Objects that answer with arbitrary values.
struct Unknown;

impl Objects for Unknown {
    fn size(&mut self, object: Object) -> Result<u32, Abort> {
        sink(object);
        any()
    }

    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort> {
        sink((object, offset));
        into.fill(any());
        any()
    }

    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort> {
        sink((object, size));
        any()
    }

    fn write(&mut self, object: Object, offset: u32, bytes: &[u8]) -> Result<(), Abort> {
        sink((object, offset, bytes.len()));
        any()
    }

    fn end_write(&mut self, object: Object, length: u32) -> Result<(), Abort> {
        sink((object, length));
        any()
    }

    fn abandon(&mut self, object: Object) {
        sink(object);
    }
}

#[inline(never)]
fn server() {
    let mut server = SdoServer::new(any(), any(), any());
    while any() {
        sink(server.receive(&any(), &mut Unknown));
        sink(server.poll(&mut Unknown));
        sink(server.elapse(any(), &mut Unknown));
        sink(server.is_busy());
        if any() {
            server.reset(&mut Unknown);
        }
    }
}

#[inline(never)]
fn download() {
    let data: [u8; 20] = any();
    let data = data.get(..any()).unwrap_or_default();
    let protocol = any::<SdoProtocol>();
    let mut client = SdoDownload::new(any(), any(), data, protocol, any(), any());
    while any() {
        client.receive(&any(), any());
        sink(client.poll(any()));
        sink((client.outcome(), client.deadline(), client.progress()));
    }
}

#[inline(never)]
fn upload() {
    let mut into = [0; 20];
    let mut buffer = SdoBuffer::new(&mut into);
    let mut client = SdoUpload::new(any(), any(), &mut buffer, any(), any::<Duration>(), any());
    while any() {
        client.receive(&any(), any());
        sink(client.poll(any()));
        sink((client.outcome(), client.deadline(), client.progress()));
        sink(client.size());
    }
    sink(buffer.bytes().len());
}

#[inline(never)]
fn network() {
    let mut slave = NmtSlave::new(any());
    let mut producer = HeartbeatProducer::new(any(), any());
    let mut consumer = HeartbeatConsumer::<4>::new();
    while any() {
        sink(slave.boot());
        sink(slave.receive(&any()));
        sink((slave.heartbeat(), slave.state().allows_sdo()));
        sink(producer.elapse(any()));
        sink(consumer.set(any(), any(), any()));
        sink((consumer.get(any()), consumer.state(any())));
        sink(consumer.receive(&any()));
        sink(consumer.elapse(any()));
    }
    sink(HeartbeatWatch::from_raw(any()).map(HeartbeatWatch::raw));
}

#[inline(never)]
fn emergencies() {
    let mut producer = EmcyProducer::<8>::new(any());
    while any() {
        producer.set_inhibit(any());
        producer.raise(any());
        producer.clear();
        producer.elapse(any());
        sink(producer.poll());
        sink((producer.register(), producer.history(any())));
        sink(producer.write_history(any(), any()));
    }
}

#[inline(never)]
fn board_pdos() {
    let mut gate = OrderGate::new();
    while any() {
        let command = BoardCommand::decode(&any());
        sink(command.and_then(|(_, command)| gate.take(command.count, command.order)));
        sink(gate.count());
        sink(gate.is_new(any(), any()));
    }
    sink(any::<BoardBeat>().frame(any()));
    sink(BoardBeat::decode(&any(), any()));
    sink(any::<Beat>().age_of(any()));
    sink(any::<JogRequest>().frame(any()));
    sink(JogRequest::decode(&any()));
    sink(any::<StepRequest>().frame(any()));
    sink(StepRequest::decode(&any()));
    sink(any::<WheelRequest>().frame(any()));
    sink(WheelRequest::decode(&any()));
    sink(Order::from_raw(any()));
    sink(any::<BoardCommand>().frame(any()));
    sink(BoardCommand::order(any(), any()));
    sink(any::<BoardStatus>().frame(any()));
    sink(any::<BoardPlace>().frame(any()));
    sink(any::<BoardSpindle>().frame(any()));
    sink(BoardStatus::decode(&any()));
    sink(BoardPlace::decode(&any()));
    sink(BoardSpindle::decode(&any()));
}

#[inline(never)]
fn communication() {
    let service = if any() {
        Service::Tpdo1
    } else {
        Service::Rpdo1
    };
    let mut pdo = PdoCommunication::sent(service, any(), any());
    while any() {
        sink((pdo.read(any()), pdo.size(any())));
        sink(pdo.write(any(), any()));
        sink((pdo.is_valid(), pdo.event_ms()));
    }
}
