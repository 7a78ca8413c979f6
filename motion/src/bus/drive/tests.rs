#![allow(clippy::arithmetic_side_effects)]
extern crate std;

use super::*;
use crate::alarm::{Arg, Code};
use crate::bus::{CobId, DriveCommand, Emcy, Frame, Mode, NmtState, Scale, Statusword};
use crate::units::Length;
use std::string::String;
use std::vec::Vec;
use std::{format, vec};

const NODE: NodeId = NodeId::DRIVE_X;

fn master() -> DriveMaster {
    DriveMaster::new(DriveConfig {
        letter: b'X',
        node: NODE,
        scale: Scale::new(1, 100).unwrap(),
        step: Periods::new(20),
        silence: Periods::new(8),
        following: Some(FollowingLimit {
            increments: 1000,
            time: Periods::new(5),
            standing: false,
        }),
        reach: 1000,
        homes: None,
        mode: Mode::Position,
    })
}

fn answer(master: &mut DriveMaster, status: u16, actual: i32) {
    let frame = DriveStatus {
        status: Statusword::from_raw(status),
        actual: Increments::new(actual),
    }
    .frame(NODE);
    assert!(master.receive(&frame));
}

/// `210#0600D2040000 …` as candump prints frames.
fn sent(output: DriveOutput) -> String {
    [output.network, output.command]
        .iter()
        .flatten()
        .map(|frame| {
            let bytes: String = frame.payload().iter().map(|b| format!("{b:02X}")).collect();
            format!("{:03X}#{bytes} ", frame.id().get())
        })
        .collect::<String>()
        .trim_end()
        .into()
}

fn enabled() -> DriveMaster {
    let mut m = master();
    m.enable().unwrap();
    m.tick(None);
    for status in [0x0250, 0x0231, 0x0233, 0x0237] {
        answer(&mut m, status, 1234);
        m.tick(None);
    }
    assert!(m.is_enabled());
    m
}

#[test]
fn start_up_frame_by_frame() {
    let mut m = master();
    let mut log = vec![sent(m.tick(Some(Increments::new(777))))];
    m.enable().unwrap();
    log.push(sent(m.tick(None)));
    log.push(sent(m.tick(None)));
    for (status, actual) in [
        (0x0250, 1234),
        (0x0231, 1235),
        (0x0231, 1236),
        (0x0233, 1236),
        (0x0233, 1230),
        (0x0237, 1229),
        (0x0237, 1230),
    ] {
        answer(&mut m, status, actual);
        log.push(sent(m.tick(None)));
    }
    for demand in [1300, 1230, 1231] {
        log.push(sent(m.tick(Some(Increments::new(demand)))));
    }
    log.push(sent(m.tick(None)));
    let expected = [
        "",
        "000#0110",
        "",
        // 0250h: switch on disabled, at 1234 (4D2h).
        "210#0600D2040000",
        // Ready, at 1235.
        "210#0700D3040000",
        "210#0700D4040000",
        // Switched on, at 1236; then at 1230.
        "210#0F00D4040000",
        "210#0F00CE040000",
        // Enabled: its target stays 1230 from the enabling, whatever position it reports.
        "210#0F00CE040000",
        "210#0F00CE040000",
        // A demand elsewhere is refused. A demand at 1230 is taken, and then the next one.
        "210#0F00CE040000",
        "210#0F00CE040000",
        "210#0F00CF040000",
        "210#0F00CF040000",
    ];
    assert_eq!(log, expected);
}

#[test]
fn in_interpolated_position_it_follows_with_bit_4() {
    let config = DriveConfig {
        mode: Mode::Interpolated,
        ..*master().config()
    };
    let mut m = DriveMaster::new(config);
    m.enable().unwrap();
    let mut log = vec![sent(m.tick(None))];
    for status in [0x0250, 0x0231, 0x0233, 0x0237, 0x1237] {
        answer(&mut m, status, 4);
        log.push(sent(m.tick(Some(Increments::new(4)))));
    }
    // The usual tick and the slow one.
    log.push(sent(m.tick(Some(Increments::new(5)))));
    m.disable();
    log.push(sent(m.tick(None)));
    let expected = [
        "000#0110",
        "210#060004000000",
        "210#070004000000",
        "210#0F0004000000",
        "210#1F0004000000",
        "210#1F0004000000",
        "210#1F0005000000",
        "210#060005000000",
    ];
    assert_eq!(log, expected);
}

#[test]
fn demands_before_torque_are_not_sent() {
    let mut m = master();
    m.enable().unwrap();
    m.tick(Some(Increments::new(999_999)));
    for status in [0x0250, 0x0231, 0x0233] {
        answer(&mut m, status, -50);
        let output = m.tick(Some(Increments::new(999_999)));
        let (_, command) = DriveCommand::decode(&output.command.unwrap()).unwrap();
        assert_eq!(command.target, Increments::new(-50));
    }
    answer(&mut m, 0x0237, -51);
    assert_eq!(m.target(), Increments::new(-50));
}

#[test]
fn a_demand_elsewhere_never_moves_and_is_a_failure_in_the_end() {
    let mut m = enabled();
    for _ in 0..20 {
        answer(&mut m, 0x0237, 1234);
        assert_eq!(
            sent(m.tick(Some(Increments::new(2000)))),
            "210#0F00D2040000"
        );
        assert_eq!(m.failure(), None);
    }
    m.tick(Some(Increments::new(2000)));
    assert_eq!(
        m.failure(),
        Some(DriveFailure::Jump {
            target: Increments::new(1234),
            demand: Increments::new(2000),
        })
    );
    let alarm = m.alarm().unwrap();
    assert_eq!(alarm.number(), 4362);
    assert_eq!(alarm.args[2], Arg::Length(Length::from_nm(76_600)));
}

#[test]
fn each_step_has_its_time_and_its_name() {
    // Statuswords of the drive, the resulting failure, and the number of its alarm.
    let cases: [(&[u16], DriveFailure, u16); 6] = [
        (&[], DriveFailure::NoAnswer, 4350),
        (&[0x0200], step(Step::Contact, 0x0200), 4351),
        (&[0x0217], step(Step::Release, 0x0217), 4352),
        (&[0x0250], step(Step::Shutdown, 0x0250), 4353),
        (&[0x0250, 0x0231], step(Step::SwitchOn, 0x0231), 4354),
        (
            &[0x0250, 0x0231, 0x0233],
            step(Step::EnableOperation, 0x0233),
            4355,
        ),
    ];
    for (statuswords, failure, number) in cases {
        let mut m = master();
        m.enable().unwrap();
        m.tick(None);
        for status in statuswords {
            answer(&mut m, *status, 0);
            m.tick(None);
        }
        // One of the step's twenty ticks has passed; two where the answer did not end contact.
        let spent = match failure {
            DriveFailure::Step(Step::Contact, _) => 2,
            _ => 1,
        };
        for tick in spent..20 {
            assert_eq!(m.failure(), None, "{failure:?} at tick {tick}");
            if let Some(last) = statuswords.last() {
                answer(&mut m, *last, 0);
            }
            m.tick(None);
        }
        assert_eq!(m.failure(), None);
        m.tick(None);
        assert_eq!(m.failure(), Some(failure));
        let alarm = m.alarm().unwrap();
        assert_eq!(alarm.number(), number);
        assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(16)]);
        assert_eq!(m.enable(), Err(failure));
        let control = m.tick(None).command.map(|frame| frame.payload()[0]);
        let without_torque = (!statuswords.is_empty()).then_some(0x06);
        assert_eq!(control, without_torque);
    }
}

fn step(step: Step, status: u16) -> DriveFailure {
    DriveFailure::Step(step, Statusword::from_raw(status))
}

#[test]
fn a_drive_found_in_any_state_is_brought_to_enabled() {
    // Statusword at contact, then the answers of the drive, and the low bytes of the controlwords.
    let cases: [(u16, &[u16], &[u8]); 4] = [
        (0x0231, &[0x0231, 0x0233, 0x0237], &[6, 7, 15, 15]),
        (0x0233, &[0x0231, 0x0233, 0x0237], &[6, 7, 15, 15]),
        (0x0237, &[0x0231, 0x0233, 0x0237], &[6, 7, 15, 15]),
        (
            0x0217,
            &[0x0250, 0x0231, 0x0233, 0x0237],
            &[0, 6, 7, 15, 15],
        ),
    ];
    for (found, answers, controls) in cases {
        let mut m = master();
        m.enable().unwrap();
        m.tick(None);
        let mut seen = Vec::new();
        for status in [&[found], answers].concat() {
            answer(&mut m, status, 5);
            seen.push(m.tick(None).command.unwrap().payload()[0]);
        }
        assert_eq!(seen, controls, "found at {found:04X}h");
        assert!(m.is_enabled());
    }
}

#[test]
fn a_fault_is_reset_on_request_only() {
    let mut m = enabled();
    let emcy = Emcy {
        code: 0x7305,
        register: 0x21,
        detail: [0; 5],
    };
    assert!(m.receive(&emcy.frame(NODE)));
    answer(&mut m, 0x0218, 1300);
    let failure = DriveFailure::Fault {
        status: Statusword::from_raw(0x0218),
        code: 0x7305,
    };
    assert_eq!(m.failure(), Some(failure));
    assert_eq!(
        m.alarm().unwrap().args[2..],
        [Arg::Statusword(0x0218), Arg::Hex(0x7305)]
    );
    for _ in 0..100 {
        answer(&mut m, 0x0218, 1300);
        let control = m.tick(Some(Increments::new(0))).command.unwrap();
        assert_eq!(control.payload(), [6, 0, 0x14, 5, 0, 0]);
    }
    assert_eq!(m.enable(), Err(failure));

    m.reset();
    assert_eq!(m.failure(), None);
    assert_eq!(sent(m.tick(None)), "210#000014050000");
    assert_eq!(sent(m.tick(None)), "210#800014050000");
    answer(&mut m, 0x0250, 1300);
    assert_eq!(m.phase(), Phase::Standby);
    assert_eq!(sent(m.tick(None)), "210#060014050000");
    assert!(!m.is_enabled());
    m.enable().unwrap();
    assert_eq!(sent(m.tick(None)), "000#0110");
}

#[test]
fn a_fault_that_stays_is_named() {
    let mut m = enabled();
    answer(&mut m, 0x0218, 0);
    m.reset();
    for _ in 0..21 {
        assert_eq!(m.failure(), None);
        answer(&mut m, 0x0218, 0);
        m.tick(None);
    }
    assert_eq!(m.failure(), Some(step(Step::FaultReset, 0x0218)));
    assert_eq!(m.alarm().unwrap().number(), 4356);
}

/// A drive may report a wrong frame length in every period; this is not the cause of a fault.
#[test]
fn what_a_drive_says_of_frames_does_not_hide_why_it_is_in_fault() {
    let told = |codes: &[u16]| {
        let mut m = enabled();
        for code in codes {
            let emcy = Emcy {
                code: *code,
                register: 0x11,
                detail: [0; 5],
            };
            assert!(m.receive(&emcy.frame(NODE)));
        }
        answer(&mut m, 0x0218, 1300);
        let failure = m.failure();
        let Some(DriveFailure::Fault { code, .. }) = failure else {
            panic!("{failure:?}");
        };
        code
    };
    for (codes, code) in [
        (&[0x8220, 0x8220][..], 0x8220),
        (&[0x8220, 0x7305, 0x8220, 0x8210], 0x7305),
        (&[0x7305, 0x8220], 0x7305),
        (&[0x7305, 0x2310], 0x2310),
        // The error is gone: the next one counts.
        (&[0x7305, 0, 0x8220], 0x8220),
        (&[0x8220, 0x8130], 0x8130),
        // No setpoint came in time: that is a cause.
        (&[0x8220, 0x8250], 0x8250),
        (&[0x4210, 0x8250, 0x8210], 0x8250),
    ] {
        assert_eq!(told(codes), code, "{codes:04X?}");
    }
}

#[test]
fn leaving_operation_enabled_by_itself_is_a_loss() {
    for status in [0x0250, 0x0231, 0x0233, 0x0217, 0x0200, 0x0221 & 0xFFBE] {
        let mut m = enabled();
        answer(&mut m, status, 1234);
        let lost = DriveFailure::Lost(Statusword::from_raw(status));
        assert_eq!(m.failure(), Some(lost), "{status:04X}h");
        assert_eq!(m.tick(None).command.unwrap().payload()[0], 0x06);
    }
}

#[test]
fn silence_is_found_and_the_command_goes_on() {
    let mut m = enabled();
    answer(&mut m, 0x0237, 1234);
    for _ in 0..8 {
        m.tick(None);
        assert_eq!(m.failure(), None);
    }
    m.tick(None);
    assert_eq!(m.failure(), Some(DriveFailure::Silent));
    // The board continues to brake: demands still reach the drive.
    m.tick(Some(Increments::new(1234)));
    let output = m.tick(Some(Increments::new(1240)));
    assert_eq!(sent(output), "210#0F00D8040000");
    m.disable();
    assert_eq!(m.tick(None).command.unwrap().payload()[0], 0x06);
}

/// A master whose drive was enabled, followed at 1234, and has just become silent.
fn silent(config: DriveConfig) -> DriveMaster {
    let mut m = DriveMaster::new(config);
    m.enable().unwrap();
    m.tick(None);
    for status in [0x0250, 0x0231, 0x0233, 0x0237] {
        answer(&mut m, status, 1234);
        m.tick(None);
    }
    m.tick(Some(Increments::new(1234)));
    for _ in 0..8 {
        m.tick(Some(Increments::new(1234)));
    }
    assert_eq!(m.failure(), Some(DriveFailure::Silent));
    m
}

#[test]
fn a_silent_drive_has_its_reach_whether_its_following_is_watched_or_not() {
    for following in [master().config.following, None] {
        let config = DriveConfig {
            following,
            reach: 700,
            ..master().config
        };
        let mut m = silent(config);
        m.tick(Some(Increments::new(1934)));
        m.tick(Some(Increments::new(1934)));
        assert!(m.is_enabled());
        // The drive followed, and its next status shows that.
        let mut mute = m;
        answer(&mut mute, 0x0237, 1934);
        mute.tick(Some(Increments::new(1940)));
        assert!(mute.is_enabled());
        // The drive stood, within reach of its target.
        let mut near = m;
        answer(&mut near, 0x0237, 1234);
        near.tick(Some(Increments::new(1934)));
        assert!(near.is_enabled());
        // The drive stands too far away.
        let mut far = m;
        answer(&mut far, 0x0237, 1233);
        assert_eq!(far.phase(), Phase::Standby);
        // A demand that would make the drive leap.
        assert_eq!(
            sent(m.tick(Some(Increments::new(1935)))),
            "210#02008E070000"
        );
        assert_eq!(m.phase(), Phase::Halted);
    }
}

#[test]
fn a_reach_is_counted_across_the_wrap() {
    let config = DriveConfig {
        following: None,
        reach: 700,
        ..master().config
    };
    let mut m = silent(config);
    m.status = Some(DriveStatus {
        status: Statusword::from_raw(0x0237),
        actual: Increments::new(i32::MAX - 100),
    });
    m.tick(Some(Increments::new(i32::MIN + 599)));
    assert!(m.is_enabled());
    m.tick(Some(Increments::new(i32::MIN + 600)));
    assert_eq!(m.phase(), Phase::Halted);
}

#[test]
fn a_drive_without_demands_has_no_reach() {
    let mut m = enabled();
    for _ in 0..20 {
        m.tick(None);
    }
    assert_eq!(m.failure(), Some(DriveFailure::Silent));
    // A spindle in speed mode has continued to turn.
    m.config.following = None;
    answer(&mut m, 0x0237, 90_000);
    m.tick(None);
    assert!(m.is_enabled());
}

#[test]
fn silence_behind_another_failure_is_silence_too() {
    let mut m = enabled();
    m.tick(Some(Increments::new(1234)));
    m.tick(Some(Increments::new(2000)));
    m.tick(Some(Increments::new(2000)));
    answer(&mut m, 0x0237, 999);
    for _ in 0..7 {
        m.tick(Some(Increments::new(2000)));
    }
    assert!(matches!(m.failure(), Some(DriveFailure::Following { .. })));
    assert!(!m.is_silent());
    for _ in 0..2 {
        assert!(m.is_enabled());
        m.tick(Some(Increments::new(2000)));
    }
    assert!(m.is_silent());
    assert_eq!(m.phase(), Phase::Halted);
}

#[test]
fn following_error_has_a_limit_and_a_time() {
    let mut m = enabled();
    m.tick(Some(Increments::new(1234)));
    m.tick(Some(Increments::new(3000)));
    m.tick(None);
    // At the limit: no failure, for any time.
    for _ in 0..50 {
        answer(&mut m, 0x0237, 2000);
        m.tick(None);
        assert_eq!(m.failure(), None);
    }
    // Beyond it for five ticks, then back.
    for _ in 0..5 {
        answer(&mut m, 0x0237, 1999);
        m.tick(None);
    }
    answer(&mut m, 0x0237, 2000);
    m.tick(None);
    assert_eq!(m.failure(), None);
    // Six ticks, with a status in every fourth.
    answer(&mut m, 0x0237, 4001);
    for _ in 0..5 {
        m.tick(None);
        assert_eq!(m.failure(), None);
    }
    m.tick(None);
    assert_eq!(
        m.failure(),
        Some(DriveFailure::Following {
            target: Increments::new(3000),
            actual: Increments::new(4001),
        })
    );
    let alarm = m.alarm().unwrap();
    assert_eq!(alarm.code, Code::FollowingError);
    assert_eq!(
        alarm.args[2..],
        [
            Arg::Length(Length::from_nm(100_100)),
            Arg::Length(Length::from_nm(100_000))
        ]
    );
    assert!(m.is_enabled());
}

#[test]
fn a_restart_is_not_taken_for_normal() {
    let mut m = enabled();
    assert!(m.receive(&NmtState::BootUp.frame(NODE)));
    assert_eq!(m.failure(), Some(DriveFailure::Restarted));
    assert_eq!(m.tick(Some(Increments::new(0))), DriveOutput::default());

    // At contact a boot-up message only makes the master send the start again.
    let mut m = master();
    m.enable().unwrap();
    assert_eq!(sent(m.tick(None)), "000#0110");
    assert!(m.receive(&NmtState::BootUp.frame(NODE)));
    assert_eq!(sent(m.tick(None)), "000#0110");
    assert_eq!(m.failure(), None);
}

#[test]
fn frames_of_others_are_not_its_own() {
    let mut m = enabled();
    let before = m;
    let other = DriveStatus {
        status: Statusword::from_raw(0x0218),
        actual: Increments::new(0),
    };
    assert!(!m.receive(&other.frame(NodeId::DRIVE_Z)));
    assert!(!m.receive(&NmtState::BootUp.frame(NodeId::DRIVE_Z)));
    assert!(!m.receive(&Emcy::of_alarm(1).frame(NodeId::DRIVE_Z)));
    assert!(!m.receive(&Frame::new(CobId::of(Service::Tpdo1, NODE), &[1, 2]).unwrap()));
    assert!(!m.receive(&Frame::new(CobId::SYNC, &[1]).unwrap()));
    assert_eq!(m, before);
}

#[test]
fn ticks_from_milliseconds_round_up() {
    assert_eq!(Periods::from_ms(500, 1000), Some(Periods::new(500)));
    assert_eq!(Periods::from_ms(1, 3000), Some(Periods::new(1)));
    assert_eq!(Periods::from_ms(10, 750), Some(Periods::new(14)));
    assert_eq!(Periods::from_ms(u32::MAX, 1), Some(Periods::new(u32::MAX)));
    assert_eq!(Periods::from_ms(1, 0), None);
}

#[test]
fn inputs_are_told_or_awaited_or_not_told() {
    let mut m = enabled();
    let told = |m: &mut DriveMaster, bytes: &[u8]| {
        let id = CobId::of(Service::Tpdo2, NODE);
        m.receive(&Frame::new(id, bytes).unwrap())
    };
    // What it has told before does not count.
    assert!(told(&mut m, &[8, 7, 0, 0, 0]));
    m.forget_inputs();
    for _ in 0..48 {
        assert_eq!(m.look_at_inputs(), Inputs::Awaited);
    }
    assert_eq!(m.look_at_inputs(), Inputs::Untold);
    // Mode and inputs, or the inputs alone; another length is no report.
    assert!(told(&mut m, &[8, 4, 0, 1, 0]));
    assert_eq!(m.look_at_inputs(), Inputs::Told(4));
    assert!(told(&mut m, &[3, 1, 0, 0]));
    assert!(!told(&mut m, &[0, 0, 0]));
    assert!(!told(&mut m, &[8, 0, 0, 0, 0, 0]));
    for _ in 0..48 {
        assert_eq!(m.look_at_inputs(), Inputs::Told(3));
    }
    assert_eq!(m.look_at_inputs(), Inputs::Untold);
    // Longer than a byte can count.
    for _ in 0..300 {
        assert_eq!(m.look_at_inputs(), Inputs::Untold);
    }
    assert!(told(&mut m, &[8, 0, 0, 0, 0]));
    assert_eq!(m.look_at_inputs(), Inputs::Told(0));
    // They are no command and no failure.
    assert!(m.is_enabled() && !m.has_failed());
}
