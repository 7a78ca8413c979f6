//! Which frames a board takes from the bus, and which it ignores.

use leadscrew_app::ResetCause;
use leadscrew_core::alarm::Code;
use leadscrew_core::board::State;
use leadscrew_core::bus::{
    BusState, CobId, Controller, DataRates, ErrorCounts, Frame, NodeId, Service,
};
use leadscrew_core::params::Params;

use crate::board::{Apart, alarm, calls};

#[test]
fn a_controller_that_leaves_the_bus_stops_the_machine_and_comes_back_once_it_stands() {
    leaves(BusState::Off, Code::BusOff);
}

#[test]
fn a_controller_that_has_stopped_sending_does_too() {
    leaves(BusState::Restricted, Code::BusRestricted);
}

fn leaves(state: BusState, code: Code) {
    let params = Params::sheets();
    let mut apart = Apart::new(&params);
    let calls = calls("G0 X60 Z5\nG98 G1 Z-50 F1000\nM30\n", &params);
    let mut calls = calls.iter();
    let mut next = calls.next();
    for _ in 0..200 {
        while next.is_some_and(|call| apart.background.offer(call)) {
            next = calls.next();
        }
        apart.step();
    }
    assert_eq!(apart.snapshot().state, State::Running);
    apart.bench.controller = Controller {
        state,
        errors: ErrorCounts {
            sending: 248,
            receiving: 0,
        },
    };
    apart.steps(3);
    assert_eq!(apart.bench.rejoined, 0, "not while it moves");
    assert_eq!(alarm(&mut apart, 1000), Some(code));
    assert_eq!(apart.bench.rejoined, 1);
    // The drives have been let go, as far as they receive the frame.
    for drive in [NodeId::DRIVE_X, NodeId::DRIVE_Z, NodeId::DRIVE_C] {
        let told = CobId::of(Service::Rpdo1, drive);
        let told = apart.output.frames.iter().find(|frame| frame.id() == told);
        let control = told.expect("a setpoint").payload().first_chunk();
        assert_eq!(control, Some(&[0x06, 0x00]), "{drive:?}");
    }
    let boot_up = CobId::of(Service::Heartbeat, NodeId::BOARD);
    assert!(
        apart
            .bench
            .sent
            .iter()
            .any(|frame| frame.id() == boot_up && frame.payload() == [0])
    );
}

#[test]
fn a_second_master_is_noticed_whichever_side_hears_it() {
    let params = Params::sheets();
    let setpoint = CobId::of(Service::Rpdo1, NodeId::DRIVE_X);
    let frame = Frame::new(setpoint, &[0x0F, 0, 0, 0, 0, 0, 0]).expect("a frame");
    for heard_by_tick in [true, false] {
        let mut apart = Apart::new(&params);
        if heard_by_tick {
            apart.bench.answers.push_back(frame);
        } else {
            apart.bench.others.push_back(frame);
        }
        assert_eq!(alarm(&mut apart, 1000), Some(Code::SecondSetpoints));
    }
}

#[test]
fn the_serial_number_is_an_object() {
    let mut apart = Apart::started(&Params::sheets(), None, ResetCause::Power);
    assert_eq!(apart.object(0x1018, 4), 0x1234_5678);
}

#[test]
fn setpoints_in_a_frame_that_its_controller_does_not_send_are_refused() {
    let some = DataRates::of(|kbit| kbit == 2000);
    for (rates, refused) in [
        (DataRates::NONE, Some(Code::NoFd)),
        (some, Some(Code::FdRateOfBoard)),
        (DataRates::ALL, None),
    ] {
        let mut apart = Apart::new(&Params::sheets());
        apart.background.state_mut().set_data_rates(rates);
        // 9031 = 1.
        let [low, high] = (0x2000 + 9031_u16).to_le_bytes();
        let request = CobId::of(Service::SdoRequest, NodeId::BOARD);
        let write = Frame::new(request, &[0x2F, low, high, 0, 1, 0, 0, 0]);
        apart.bench.others.push_back(write.expect("a frame"));
        apart.steps(50);
        apart.bench.sent.clear();
        let told = apart.object(0x5010, 7);
        assert_eq!(told, refused.map_or(0, |code| u16::from(code).into()));
        apart.bench.sent.clear();
        let in_force = apart.object(0x2000 + 9031, 0) & 0xFF;
        assert_eq!(in_force, u32::from(refused.is_none()));
    }
}
