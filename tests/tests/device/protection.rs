//! Who may change parameters, and when: what the board refuses by itself, and the reason it gives.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::Flash;
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::device::{CommitState, LOAD, SAVE};
use leadscrew_core::bus::{Abort, CobId, Frame, Object, Order, SdoError, SdoProtocol, Service};
use leadscrew_core::link::identity;
use leadscrew_core::params::{Entry, PASSWORD, Params, TABLE_KEY};
use leadscrew_tests::gateway::{Gateway, NODE, Upload};
use leadscrew_tests::machine::calls;
use leadscrew_tests::params::with;

use super::kept::{
    command, flash_with, image, in_force, power_up, push, reason, reason_code, set, state,
};
use super::parameters::{IMAGE, parameter, refused, rest, write};

/// Milliseconds after which a silent gateway has left, by parameter 9024; a tick is one.
const SILENCE: usize = 1000;

fn wait(gateway: &mut Gateway, sim: &mut Sim, ticks: usize) {
    for _ in 0..ticks {
        sim.step();
        while sim.event().is_some() {}
        gateway.listen(sim);
    }
}

fn tolerance(gateway: &mut Gateway, sim: &mut Sim, value: i64) -> Result<(), SdoError> {
    write(gateway, sim, parameter(9007, 0), value, 1)
}

fn password(gateway: &mut Gateway, sim: &mut Sim, password: u32) -> Result<(), SdoError> {
    command(gateway, sim, 0x5010, 6, password)
}

fn locked(value: i64) -> Params {
    with(&[("9007", 10), ("9028", value)])
}

/// Tries every way to change the set.
fn every_way(gateway: &mut Gateway, sim: &mut Sim) -> [Result<(), SdoError>; 4] {
    [
        tolerance(gateway, sim, 11),
        gateway.write(sim, IMAGE, &image(&set(14)), SdoProtocol::Block),
        command(gateway, sim, 0x5010, 5, 1),
        command(gateway, sim, 0x1011, 1, LOAD),
    ]
}

#[test]
fn a_machine_at_work_keeps_its_parameters() {
    let (mut sim, mut gateway, _) = power_up(flash_with(&[set(10), set(12)]));
    let program = calls("G98 F500\nG01 X20\nM30\n", &set(12));
    Upload::new(1, &program).feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    wait(&mut gateway, &mut sim, 100);
    let before = sim.flash().written();
    for refusal in every_way(&mut gateway, &mut sim) {
        assert_eq!(refusal, refused(Abort::State));
    }
    assert_eq!(
        reason_code(&mut gateway, &mut sim),
        Some(Code::ParametersAtWork)
    );
    assert_eq!(state(&mut gateway, &mut sim), CommitState::Refused as u8);
    // A set that is stored already is no change.
    assert_eq!(command(&mut gateway, &mut sim, 0x1010, 1, SAVE), Ok(()));
    assert_eq!(sim.flash().written(), before);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&set(12)));
}

#[test]
fn a_board_that_is_write_protected_says_so() {
    let protected = with(&[("9007", 12), ("9026.0", 0)]);
    let (mut sim, mut gateway, _) = power_up(flash_with(&[set(10), protected.clone()]));
    for refusal in every_way(&mut gateway, &mut sim) {
        assert_eq!(refusal, refused(Abort::LocalControl));
        assert_eq!(
            reason_code(&mut gateway, &mut sim),
            Some(Code::ParametersProtected)
        );
    }
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&protected));
    let switch = parameter(9026, 0);
    assert_eq!(write(&mut gateway, &mut sim, switch, 1, 1), Ok(()));
    assert_eq!(reason(&mut gateway, &mut sim), None);
    assert_eq!(tolerance(&mut gateway, &mut sim, 11), Ok(()));
}

#[test]
fn a_protected_board_can_take_what_it_has_loaded() {
    use leadscrew_core::board::{KeptSet, Region};
    use leadscrew_store::Store;
    let protected = with(&[("9007", 12), ("9026.0", 0)]);
    let mut flash = flash_with(std::slice::from_ref(&protected));
    // Another set, which is damaged.
    let mut bytes = [0; Region::LONGEST];
    KeptSet {
        number: 2,
        params: &set(14),
    }
    .fill(&mut bytes);
    bytes[30] ^= 1;
    let mut store = Store::new(&mut flash).expect("a store");
    store.write(Region::ParametersB, &bytes).expect("written");
    let mark = leadscrew_core::board::Mark(2).encode();
    store.write(Region::ParametersMark, &mark).expect("written");
    let (mut sim, mut gateway, _) = power_up(flash);
    assert_eq!(command(&mut gateway, &mut sim, 0x5010, 5, 1), Ok(()));
    rest(&mut gateway, &mut sim);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&protected));
}

#[test]
fn a_password_is_asked_for_and_never_told() {
    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    push(&mut gateway, &mut sim, &locked(1234)).expect("it has none yet");
    let (mut sim, mut gateway, _) = power_up(sim.flash().clone());
    // A reader learns only that there is a password.
    let object = 0x2000 + PASSWORD;
    assert_eq!(gateway.number(&mut sim, object, 0), Ok(1));
    assert_eq!(
        in_force(&mut gateway, &mut sim),
        identity(&locked(u32::MAX.into()))
    );
    let read = gateway
        .read(&mut sim, IMAGE, SdoProtocol::Block)
        .expect("an image");
    assert_eq!(read, image(&locked(1)));
    assert_eq!(
        gateway.number(&mut sim, 0x5010, 6),
        Err(SdoError::Refused(Abort::WriteOnly.code()))
    );
    let before = sim.flash().written();
    for refusal in every_way(&mut gateway, &mut sim) {
        assert_eq!(refusal, refused(Abort::LocalControl));
        assert_eq!(
            reason_code(&mut gateway, &mut sim),
            Some(Code::PasswordMissing)
        );
    }
    assert_eq!(
        write(&mut gateway, &mut sim, parameter(9026, 0), 0, 1),
        refused(Abort::LocalControl),
        "the switch too"
    );
    assert_eq!(sim.flash().written(), before);

    assert_eq!(password(&mut gateway, &mut sim, 1234), Ok(()));
    assert_eq!(tolerance(&mut gateway, &mut sim, 11), Ok(()));
    // While the gateway is heard it stays open, and no longer.
    for _ in 0..5 {
        wait(&mut gateway, &mut sim, SILENCE - 100);
        assert!(gateway.number(&mut sim, 0x1001, 0).is_ok());
    }
    assert_eq!(tolerance(&mut gateway, &mut sim, 12), Ok(()));
    wait(&mut gateway, &mut sim, SILENCE + 1);
    assert_eq!(
        tolerance(&mut gateway, &mut sim, 13),
        refused(Abort::LocalControl)
    );
    assert_eq!(password(&mut gateway, &mut sim, 1234), Ok(()));
    let (mut sim, mut gateway, _) = power_up(sim.flash().clone());
    assert_eq!(
        tolerance(&mut gateway, &mut sim, 13),
        refused(Abort::LocalControl)
    );
}

/// If the answer was lost, the write is sent again, and a wire may double a frame. Both count as one write, even if the
/// value is what shuts the board.
#[test]
fn a_password_that_is_set_twice_is_set_once() {
    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    let object = parameter(PASSWORD, 0);
    let done = CommitState::Done as u8;
    assert_eq!(write(&mut gateway, &mut sim, object, 1234, 4), Ok(()));
    rest(&mut gateway, &mut sim);
    let before = sim.flash().written();
    for _ in 0..3 {
        assert_eq!(write(&mut gateway, &mut sim, object, 1234, 4), Ok(()));
        assert_eq!(state(&mut gateway, &mut sim), done);
    }
    assert_eq!(sim.flash().written(), before);
    assert_eq!(
        tolerance(&mut gateway, &mut sim, 11),
        refused(Abort::LocalControl)
    );
    // Somebody has asked for another change: now the password is asked for first, whatever is written.
    for value in [1234, 1235, 1234] {
        assert_eq!(
            write(&mut gateway, &mut sim, object, value, 4),
            refused(Abort::LocalControl)
        );
    }
    // Nobody finds one by trying either.
    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    assert_eq!(write(&mut gateway, &mut sim, object, 1234, 4), Ok(()));
    rest(&mut gateway, &mut sim);
    for value in [1235, 1234] {
        assert_eq!(
            write(&mut gateway, &mut sim, object, value, 4),
            refused(Abort::LocalControl)
        );
    }
    // One frame that arrives twice at once, while the set is being stored.
    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    let [low, high] = object.index.to_le_bytes();
    let request = [0x23, low, high, object.sub, 0xD2, 0x04, 0, 0];
    let frame = Frame::new(CobId::of(Service::SdoRequest, NODE), &request).expect("eight bytes");
    sim.receive(&frame);
    sim.receive(&frame);
    let mut answers = Vec::new();
    while let Some(frame) = sim.transmit() {
        if frame.id() == CobId::of(Service::SdoReply, NODE) {
            answers.push(frame.payload()[0]);
        }
    }
    assert_eq!(answers, [0x60, 0x60]);
    rest(&mut gateway, &mut sim);
    assert_eq!(state(&mut gateway, &mut sim), done);
    assert_eq!(gateway.number(&mut sim, object.index, object.sub), Ok(1));
}

#[test]
fn a_pushed_set_keeps_changes_or_ends_the_password() {
    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    push(&mut gateway, &mut sim, &locked(1234)).expect("it has none yet");
    assert_eq!(password(&mut gateway, &mut sim, 1234), Ok(()));
    // A set that was read here, changed, and sent back.
    let changed = with(&[("9007", 13), ("9028", 1)]);
    push(&mut gateway, &mut sim, &changed).expect("open");
    let (mut sim, mut gateway, _) = power_up(sim.flash().clone());
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&changed));
    assert_eq!(password(&mut gateway, &mut sim, 1234), Ok(()));
    push(&mut gateway, &mut sim, &locked(99)).expect("open");
    let (mut sim, mut gateway, _) = power_up(sim.flash().clone());
    assert_eq!(
        password(&mut gateway, &mut sim, 1234),
        refused(Abort::LocalControl)
    );
    wait(&mut gateway, &mut sim, 1000);
    assert_eq!(password(&mut gateway, &mut sim, 99), Ok(()));
    // The built-in set has no password, and does not take one away.
    assert_eq!(command(&mut gateway, &mut sim, 0x1011, 1, LOAD), Ok(()));
    rest(&mut gateway, &mut sim);
    let object = parameter(PASSWORD, 0);
    assert_eq!(gateway.number(&mut sim, object.index, 0), Ok(1));
    assert_eq!(write(&mut gateway, &mut sim, object, 0, 4), Ok(()));
    let (mut sim, mut gateway, _) = power_up(sim.flash().clone());
    assert_eq!(tolerance(&mut gateway, &mut sim, 13), Ok(()));
    assert_eq!(password(&mut gateway, &mut sim, 5), Ok(()), "none is set");
    // 1 keeps the existing password, and there is none.
    assert_eq!(
        write(&mut gateway, &mut sim, object, 1, 4),
        refused(Abort::Value)
    );
    let why = reason(&mut gateway, &mut sim).expect("a reason");
    assert_eq!(why.code, Code::ParametersOutOfRange);
    assert_eq!(why.args[0], Arg::Int(PASSWORD.into()));
}

#[test]
fn wrong_passwords_are_counted_and_make_the_board_deaf() {
    let (mut sim, mut gateway, _) = power_up(flash_with(&[locked(1234)]));
    for (wrong, seconds) in [
        (1, 1),
        (2, 2),
        (3, 4),
        (4, 8),
        (5, 16),
        (6, 32),
        (7, 60),
        (8, 60),
    ] {
        for _ in 0..2 {
            // The board does not even hear the second of them.
            assert_eq!(
                password(&mut gateway, &mut sim, 1235),
                refused(Abort::LocalControl)
            );
            let why = reason(&mut gateway, &mut sim).expect("a reason");
            assert_eq!(why.code, Code::PasswordWrong);
            assert_eq!(why.args[..2], [Arg::Int(wrong), Arg::Int(seconds)]);
        }
        wait(&mut gateway, &mut sim, seconds as usize * 1000 - 1);
        assert_eq!(
            password(&mut gateway, &mut sim, 1234),
            refused(Abort::LocalControl),
            "the right one, too soon"
        );
        wait(&mut gateway, &mut sim, 1);
    }
    assert_eq!(password(&mut gateway, &mut sim, 1234), Ok(()));
    assert_eq!(tolerance(&mut gateway, &mut sim, 11), Ok(()));
}

#[test]
fn an_image_that_is_not_taken_has_its_reason() {
    let (mut sim, mut gateway, _) = power_up(flash_with(&[set(10)]));
    let good = image(&set(12));
    let mut damaged = good.clone();
    damaged[40] ^= 1;
    let mut foreign = good.clone();
    foreign[3] ^= 0x80;
    let mut beyond = good.clone();
    let entry = Entry::find_text("9007").expect("a parameter");
    // In its place a value that no parameter may have, and the checksum of that.
    let at = (6..good.len() - 4)
        .step_by(8)
        .find(|at| image(&set(13))[*at..at + 8] != good[*at..at + 8])
        .expect("where they differ");
    beyond[at..at + 8].copy_from_slice(&(entry.max() + 1).to_le_bytes());
    let end = beyond.len() - 4;
    let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&beyond[..end]);
    beyond[end..].copy_from_slice(&sum.to_le_bytes());
    for (bytes, abort, code, figures) in [
        (
            &damaged[..],
            Abort::Crc,
            Code::ParametersIncomplete,
            [Arg::None; 2],
        ),
        (
            &good[..good.len() - 8],
            Abort::Length,
            Code::ParametersIncomplete,
            [Arg::None; 2],
        ),
        (
            &foreign[..],
            Abort::Incompatible,
            Code::ImageForeign,
            [Arg::Key(TABLE_KEY ^ 0x8000_0000), Arg::Key(TABLE_KEY)],
        ),
        (
            &beyond[..],
            Abort::Value,
            Code::ParametersOutOfRange,
            [Arg::Int(9007), Arg::None],
        ),
        (
            &image(&with(&[("9007", 20)]))[..],
            Abort::Incompatible,
            Code::ToleranceAboveVariation,
            [Arg::Percent(20), Arg::Percent(15)],
        ),
    ] {
        let written = gateway.write(&mut sim, IMAGE, bytes, SdoProtocol::Segmented);
        assert_eq!(written, refused(abort), "{code:?}");
        let why = reason(&mut gateway, &mut sim).expect("a reason");
        assert_eq!(why.code, code);
        assert_eq!(why.args[..2], figures);
        assert_eq!(state(&mut gateway, &mut sim), CommitState::Refused as u8);
        assert_eq!(in_force(&mut gateway, &mut sim), identity(&set(10)));
    }
    // A transfer that is broken off changes nothing.
    let none = Object::new(0x5010, 2);
    assert!(
        gateway
            .write(&mut sim, none, &[1], SdoProtocol::Short)
            .is_err()
    );
    push(&mut gateway, &mut sim, &set(12)).expect("a good one");
    assert_eq!(reason(&mut gateway, &mut sim), None);
}
