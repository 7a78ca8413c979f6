//! Frames and drives.

use audit::any::{Any as _, any, sink};
use leadscrew_core::bus::{
    CobId, DriveCommand, DriveMaster, DriveStatus, Emcy, FdBits, FdFrame, Frame, Increments,
    MilliRpm, NmtCommand, NmtState, Scale, Setpoints, SpindleCommand, SpindleMaster, Statusword,
    SyncProducer, is_sync,
};

/// Calls all entries of this module.
pub fn all() {
    frames();
    fd_frames();
    encode();
    decode();
    increments();
    drive();
    spindle();
    serial_line();
}

#[inline(never)]
fn frames() {
    let frame: Frame = any();
    sink((
        frame.id().service(),
        frame.payload().len(),
        frame.exactly::<3>(),
    ));
    sink(CobId::new(any()));
    let mut sync = SyncProducer::new();
    for _ in 0..u8::MAX {
        sink(sync.next());
    }
}

#[inline(never)]
fn fd_frames() {
    let payload: [u8; 80] = any();
    let frame = payload
        .get(..usize::any())
        .and_then(|payload| FdFrame::new(any(), payload, any()))
        .unwrap_or(FdFrame::from(&any::<Frame>()));
    sink((
        frame.id(),
        frame.payload().len(),
        frame.length_code(),
        frame.is_rate_switched(),
        frame.classical(),
    ));
    sink(FdFrame::length_for(any()));
    sink(FdBits::of(any()).at(any(), any()));
    sink(Setpoints::command(frame.payload(), any()));
    for mapped in Setpoints::mapping(usize::any() & 0xFF) {
        sink(mapped.raw());
    }
    let mut lines = leadscrew_slcan::Lines::<143>::with_room();
    sink(lines.push(any()).is_some());
}

#[inline(never)]
fn encode() {
    sink(any::<DriveCommand>().frame(any()));
    sink(any::<DriveStatus>().frame(any()));
    sink(any::<SpindleCommand>().frame(any()));
    sink(any::<NmtCommand>().frame(any()));
    sink(any::<NmtState>().frame(any()));
    sink(any::<Emcy>().frame(any()));
    sink(Emcy::of_alarm(any()).frame(any()));
}

#[inline(never)]
fn decode() {
    let frame: Frame = any();
    sink(DriveCommand::decode(&frame));
    sink(DriveStatus::decode(&frame));
    sink(SpindleCommand::decode(&frame));
    sink(NmtCommand::decode(&frame));
    sink(NmtState::decode(&frame));
    sink(Emcy::decode(&frame));
    sink((is_sync(&frame), any::<Statusword>().state()));
}

#[inline(never)]
fn serial_line() {
    let mut lines = leadscrew_slcan::Lines::new();
    let mut adapter = leadscrew_slcan::Adapter::new(any(), any(), any());
    for _ in 0..u8::MAX {
        let Some(heard) = lines.push(any()) else {
            continue;
        };
        if let Some(reply) = leadscrew_slcan::Reply::of(heard) {
            sink(reply.line().bytes());
        }
        if let Some(request) = leadscrew_slcan::Request::of(heard) {
            sink(request.line().bytes());
        }
        let handled = adapter.handle(heard);
        sink(handled.reply.line().bytes());
        adapter.flag(leadscrew_slcan::Flags::WARNING);
        if let Some(frame) = handled.send {
            sink(adapter.received(&frame, any()).map(|reply| reply.line()));
        }
        sink((adapter.is_open(), adapter.bit_rate(), adapter.timing()));
    }
    let frame: Frame = any();
    sink(leadscrew_slcan::Request::Send(leadscrew_slcan::SlcanFrame::Data(frame)).line());
}

#[inline(never)]
fn increments() {
    let scale: Scale = any();
    sink(scale.increments(any()));
    sink((
        scale.position(any()),
        scale.length(any()),
        scale.limit(any()),
    ));
    sink(any::<Increments>().distance(any()));
    sink(MilliRpm::of(any(), any()));
}

#[inline(never)]
fn drive() {
    let mut master = DriveMaster::new(any());
    sink(master.enable().is_ok());
    while any() {
        sink(master.receive(&any()));
        sink(master.tick(any()));
        sink((
            master.phase(),
            master.failure(),
            master.status(),
            master.target(),
            master.alarm(),
        ));
        if any() {
            master.disable();
        }
        if any() {
            master.reset();
        }
    }
}

#[inline(never)]
fn spindle() {
    let mut master = SpindleMaster::new(any());
    while any() {
        sink(master.drive_mut().enable().is_ok());
        sink(master.drive_mut().receive(&any()));
        sink(master.engage());
        master.tick(any(), &mut |frame| {
            sink(frame);
        });
    }
}
