//! Against a board inside this process.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use leadscrew_board_sim::plant::Flash;
use leadscrew_board_sim::stored_params;
use leadscrew_can::Can as _;
use leadscrew_core::alarm::Code;
use leadscrew_core::board::Found;
use leadscrew_core::board::device::objects::{COMMIT, STAGED_CHANGES};
use leadscrew_core::bus::{
    Abort, BoardBeat, BoardCommand, BoardSpindle, CobId, Frame, NmtState, NodeId, Object, Order,
    Service,
};
use leadscrew_core::link::{ImageWriter, identity};
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::params::{Entry, Params};

use super::bench::{Fate, between, link, machine, machine_of};
use super::{Inside, Link, Trouble};

fn set(values: &[(&str, i64)]) -> Params {
    let mut params = Params::sheets();
    for (key, raw) in values {
        params.set(Entry::find_text(key).unwrap(), *raw).unwrap();
    }
    params
}

/// A set as a whole.
fn push(link: &mut Link, params: &Params) -> super::LinkResult {
    link.stage(params)?;
    link.commit(params)
}

/// Lets so many milliseconds of the board's time go by, however many that are here.
fn pass(link: &mut Link, ms: u64) {
    let end = link.status().unwrap().tick + ms;
    while link.status().unwrap().tick < end {
        link.idle(Duration::from_millis(5)).unwrap();
    }
}

/// A flash in which this set is stored.
fn flash_with(params: &Params) -> Flash {
    let inside = machine(Flash::erased());
    push(&mut link(&inside), params).unwrap();
    inside.sim().flash().clone()
}

fn stored(inside: &Inside) -> (Found, Params) {
    let mut flash = inside.sim().flash().clone();
    flash.power(true);
    let up = stored_params(&mut flash, &Params::sheets()).unwrap();
    (up.found, up.params)
}

#[test]
fn a_push_that_ends_at_any_frame_leaves_the_old_set_or_the_new_one() {
    let old = set(&[("9007", 12), ("1420.X", 11_000_000_000)]);
    let new = set(&[
        ("9007", 13),
        ("1420.Z", 15_000_000_000),
        ("9101.X", 500_000),
    ]);
    let flash = flash_with(&old);
    let (mut olds, mut news) = (0, 0);
    for frames in 0.. {
        let inside = machine(flash.clone());
        // The plug is pulled out after so many frames.
        let mut left = frames;
        let pull = move |_: &Frame| {
            if left == 0 {
                return Fate::Closed;
            }
            left -= 1;
            Fate::Arrives
        };
        let sent = push(&mut between(&inside, pull, |frame| frame), &new);
        let complete = sent.is_ok();
        // What is under way ends, and somebody else comes.
        let mut other = link(&inside);
        // In the middle of a block the board takes a request for a piece of it: it is asked again then.
        other.set_patience(Duration::from_millis(20));
        let in_force = other.parameters().unwrap();
        let (found, kept) = stored(&inside);
        assert_eq!(found, Found::Newest, "after {frames} frames");
        assert_eq!(in_force.params, kept, "after {frames} frames");
        if kept == new {
            news += 1;
        } else {
            assert_eq!(kept, old, "after {frames} frames");
            assert_eq!(news, 0, "once it is taken, more frames change nothing");
            assert!(!complete);
            olds += 1;
        }
        if complete {
            break;
        }
        // The next push works.
        if frames % 50 == 0 {
            push(&mut other, &new).unwrap();
            assert_eq!(stored(&inside).1, new);
        }
    }
    // Seven bytes a frame, and the beginning and the end of the transfer come with them.
    let segments = ImageWriter::BYTES.div_ceil(7);
    assert!(olds >= segments, "{olds} of {segments}");
    assert!(news > 1, "{news}");
}

/// A block's segments carry nothing but their number: the board takes a request of somebody else for one of them where the
/// number fits.
#[test]
fn what_another_client_says_in_a_transfer_does_not_spoil_it() {
    let flash = flash_with(&Params::sheets());
    let new = set(&[("9007", 13)]);
    // Upload of either kind, its pieces, its ends, an abort.
    for command in [0x40, 0x60, 0x70, 0x80, 0xA0, 0xA1, 0xA2, 0xA3] {
        let number = usize::from(command & 0x7F);
        // At its own number, one before and behind, at the beginning, late.
        for place in [0, 1, number.saturating_sub(1), number, number + 1, 120] {
            let inside = machine(flash.clone());
            let said = [command, 0x08, 0x10, 0, 0, 0, 0, 0];
            let request = CobId::of(Service::SdoRequest, NodeId::BOARD);
            let said = Frame::new(request, &said).unwrap();
            let mut left = Some(place);
            let meddle = move |frame: &Frame| {
                if frame.payload().len() < 8 {
                    return Fate::Arrives;
                }
                let now = left == Some(0);
                left = left.and_then(|left| left.checked_sub(1));
                if now {
                    Fate::AndThen(said)
                } else {
                    Fate::Arrives
                }
            };
            let sent = push(&mut between(&inside, meddle, |frame| frame), &new);
            assert!(sent.is_ok(), "{command:02X}h at {place}: {sent:?}");
            assert_eq!(stored(&inside), (Found::Newest, new.clone()));
        }
    }
}

#[track_caller]
fn refused(written: super::LinkResult, expected: Code) {
    match written {
        Err(Trouble::Parameters { reason, .. }) => {
            assert_eq!(reason.map(|alarm| alarm.code), Some(expected));
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_board_says_why_it_does_not_take_a_set() {
    let protected = set(&[("9026.0", 0)]);
    let inside = machine(flash_with(&protected));
    let mut link = link(&inside);
    let wanted = set(&[("9026.0", 0), ("9007", 13)]);
    refused(link.stage(&wanted), Code::ParametersProtected);
    refused(link.commit(&wanted), Code::ParametersProtected);
    let open = set(&[("9026.0", 1)]);
    let entry = Entry::find_text("9026.0").unwrap();
    link.commit_value(entry, &open).unwrap();
    // What is not staged cannot be committed.
    refused(link.commit(&wanted), Code::StagedSetGone);
    push(&mut link, &wanted).unwrap();
    assert_eq!(stored(&inside), (Found::Newest, wanted));
    assert_eq!(link.last_good().unwrap(), Some(identity(&open)));
}

#[test]
fn a_password_opens_writing() {
    let password = Entry::find_text("parameter_password").unwrap();
    let mut secret = Params::sheets();
    secret.set(password, 4711).unwrap();
    let inside = machine(flash_with(&secret));
    let mut link = link(&inside);
    link.attend().unwrap();
    let mut wanted = link.parameters().unwrap().params;
    assert_eq!(wanted.get(password), 1, "it is not told");
    wanted.set(Entry::find_text("9007").unwrap(), 13).unwrap();
    refused(link.stage(&wanted), Code::PasswordMissing);
    refused(link.open_parameters(4712), Code::PasswordWrong);
    // The board hears nothing for a second.
    pass(&mut link, 1100);
    link.open_parameters(4711).unwrap();
    push(&mut link, &wanted).unwrap();
    let (_, kept) = stored(&inside);
    assert_eq!(kept.get(password), 4711, "and stays");
    assert_eq!(
        kept.spindle_tolerance_percent(),
        wanted.spindle_tolerance_percent()
    );
}

#[test]
fn the_last_good_set_comes_back() {
    let first = set(&[("9007", 12)]);
    let second = set(&[("9007", 13)]);
    let inside = machine(flash_with(&first));
    let mut link = link(&inside);
    assert_eq!(link.last_good().unwrap(), None);
    push(&mut link, &second).unwrap();
    assert_eq!(link.last_good().unwrap(), Some(identity(&first)));
    link.recall().unwrap();
    assert_eq!(link.parameters().unwrap().params, first);
    assert_eq!(stored(&inside), (Found::Newest, first));
    link.hear_status().unwrap();
    link.order(Order::Reset).unwrap();
}

#[test]
fn a_staged_set_is_committed_by_its_hash_and_once() {
    let old = set(&[("9007", 12), ("1420.X", 11_000_000_000)]);
    let new = set(&[("9007", 13)]);
    let inside = machine(flash_with(&old));
    let mut link = link(&inside);
    link.stage(&new).unwrap();
    assert_eq!(link.before(&new).unwrap(), old, "staged, and not in force");
    assert_eq!(link.parameters().unwrap().params, old);
    assert_eq!(stored(&inside), (Found::Newest, old.clone()));
    refused(link.commit(&old), Code::StagedSetGone);
    // Somebody else writes a value in between, even one that is so already.
    link.stage(&new).unwrap();
    link.write(Object::new(0x2000 + 9007, 0), &[12]).unwrap();
    pass(&mut link, 200);
    refused(link.commit(&new), Code::StagedSetGone);
    assert_eq!(stored(&inside), (Found::Newest, old.clone()));
    // The answer is lost, and the order comes again.
    link.stage(&new).unwrap();
    link.write(COMMIT, &identity(&new).to_le_bytes()).unwrap();
    link.commit(&new).unwrap();
    link.commit(&new).unwrap();
    assert_eq!(stored(&inside), (Found::Newest, new));
    assert_eq!(link.last_good().unwrap(), Some(identity(&old)));
}

/// As above, where the set that is in force by then lets nobody change anything.
#[test]
fn a_commit_comes_twice_also_of_a_set_that_shuts_the_board() {
    for (key, raw) in [("9026.0", 0), ("9028", 4711)] {
        let old = set(&[("9007", 12)]);
        let new = set(&[("9007", 13), (key, raw)]);
        let inside = machine(flash_with(&old));
        let mut link = link(&inside);
        link.stage(&new).unwrap();
        link.commit(&new).unwrap();
        link.commit(&new).unwrap();
        assert_eq!(stored(&inside), (Found::Newest, new), "{key}");
        assert_eq!(link.last_good().unwrap(), Some(identity(&old)), "once");
        // It is shut.
        assert!(link.stage(&old).is_err());
        refused(
            link.commit(&old),
            if raw == 0 {
                Code::ParametersProtected
            } else {
                Code::PasswordMissing
            },
        );
    }
}

/// Two who set another password, or one who sets one and one who does not: each commits what is his own.
#[test]
fn a_set_that_differs_in_nothing_but_its_password_is_not_committed_for_another() {
    let old = set(&[("9007", 12)]);
    let [mine, theirs, open] = [4711, 4712, 0].map(|raw| set(&[("9007", 13), ("9028", raw)]));
    assert_eq!(identity(&mine), identity(&theirs));
    for other in [&theirs, &open] {
        let inside = machine(flash_with(&old));
        let mut link = link(&inside);
        link.stage(&mine).unwrap();
        link.stage(other).unwrap();
        refused(link.commit(&mine), Code::StagedSetGone);
        assert_eq!(stored(&inside), (Found::Newest, old.clone()));
        link.commit(other).unwrap();
        assert_eq!(stored(&inside).1, *other);
    }
    // Put into force in one step, theirs is not taken for mine either.
    let inside = machine(flash_with(&old));
    let mut link = link(&inside);
    link.stage(&mine).unwrap();
    let mut image = vec![0; ImageWriter::BYTES as usize];
    ImageWriter::with_password(&theirs).read(0, &mut image);
    link.write(Object::new(0x5010, 1), &image).unwrap();
    link.wait_until_stored(Duration::from_secs(5)).unwrap();
    refused(link.commit(&mine), Code::PasswordMissing);
    assert_eq!(stored(&inside), (Found::Newest, theirs));
}

/// A file may name the password that is in force already.
#[test]
fn a_set_with_the_password_in_force_goes_in() {
    let inside = machine(flash_with(&set(&[("9028", 4711)])));
    let mut link = link(&inside);
    link.attend().unwrap();
    link.open_parameters(4711).unwrap();
    let new = set(&[("9007", 13), ("9028", 4711)]);
    push(&mut link, &new).unwrap();
    assert_eq!(stored(&inside), (Found::Newest, new));
}

/// What has been committed can be committed again; what has not says nothing about the password.
#[test]
fn a_password_is_not_found_by_trying_to_commit() {
    let secret = set(&[("9007", 13), ("9028", 4711)]);
    let [right, wrong] = [4711, 4712].map(|raw| {
        let guess = set(&[("9007", 13), ("9028", raw)]);
        ImageWriter::with_password(&guess).checksum()
    });
    let commit = |link: &mut Link, checksum: u32| link.write(COMMIT, &checksum.to_le_bytes());
    // Of a board that has it in force.
    let inside = machine(flash_with(&secret));
    let mut link = link(&inside);
    assert!(commit(&mut link, right).is_err());
    commit(&mut link, identity(&secret)).expect("the set in force is there, and says nothing");
    assert!(commit(&mut link, right).is_err());
    // Of one that has been given it.
    link.open_parameters(4711).unwrap();
    let other = set(&[("9007", 13), ("9028", 815)]);
    link.stage(&other).unwrap();
    link.commit(&other).unwrap();
    let checksum = ImageWriter::with_password(&other).checksum();
    commit(&mut link, checksum).unwrap();
    assert!(commit(&mut link, wrong).is_err());
    commit(&mut link, identity(&other)).unwrap();
    refused(link.commit(&other), Code::StagedSetGone);
}

#[test]
fn what_somebody_else_has_changed_since_it_was_read_is_not_put_back() {
    let old = set(&[("9007", 12)]);
    let inside = machine(flash_with(&old));
    let mut link = link(&inside);
    let read = link.parameters().unwrap().params;
    let mut wanted = read.clone();
    wanted
        .set(Entry::find_text("1420.X").unwrap(), 11_000_000_000)
        .unwrap();
    link.write(Object::new(0x2000 + 9007, 0), &[13]).unwrap();
    pass(&mut link, 200);
    refused(link.stage_over(&read, &wanted), Code::StagedSetGone);
    let (_, kept) = stored(&inside);
    assert_eq!(
        kept.spindle_tolerance_percent(),
        set(&[("9007", 13)]).spindle_tolerance_percent()
    );
    // Read again it goes.
    let read = link.parameters().unwrap().params;
    link.stage_over(&read, &set(&[("9007", 13), ("1420.X", 11_000_000_000)]))
        .unwrap();
}

/// Only a refusal says that the old set is in force.
#[test]
fn a_board_that_does_not_say_what_became_of_a_set_has_not_refused_it() {
    let inside = machine(Flash::erased());
    // Its 5010h:02h says something else than it is.
    let told = |state| {
        let tell = move |frame: Frame| match frame.payload() {
            [0x4F, 0x10, 0x50, 2, ..] => {
                Frame::new(frame.id(), &[0x4F, 0x10, 0x50, 2, state, 0, 0, 0]).unwrap()
            }
            _ => frame,
        };
        between(&inside, |_| Fate::Arrives, tell).wait_until_stored(Duration::ZERO)
    };
    assert!(matches!(
        told(0),
        Err(Trouble::Unsettled {
            restarted: true,
            ..
        })
    ));
    assert!(matches!(
        told(1),
        Err(Trouble::Unsettled {
            restarted: false,
            ..
        })
    ));
    assert!(matches!(told(2), Ok(())));
    assert!(matches!(told(3), Err(Trouble::Parameters { .. })));
    assert!(matches!(told(4), Err(Trouble::Strange { .. })));
}

/// The same of a table of offsets and tools.
#[test]
fn a_board_that_does_not_say_what_became_of_a_table_has_not_refused_it() {
    let inside = machine(Flash::erased());
    // Its 5011h:02h says something else than it is.
    let told = |state| {
        let tell = move |frame: Frame| match frame.payload() {
            [0x4F, 0x11, 0x50, 2, ..] => {
                Frame::new(frame.id(), &[0x4F, 0x11, 0x50, 2, state, 0, 0, 0]).unwrap()
            }
            _ => frame,
        };
        between(&inside, |_| Fate::Arrives, tell).wait_for_offsets(Duration::ZERO)
    };
    let unsettled = |state| match told(state) {
        Err(Trouble::UnsettledOffsets { restarted, .. }) => Some(restarted),
        _ => None,
    };
    assert_eq!((unsettled(0), unsettled(1)), (Some(true), Some(false)));
    assert!(matches!(told(2), Ok(())));
    assert!(matches!(told(3), Err(Trouble::Offsets { .. })));
    assert!(matches!(told(4), Err(Trouble::Strange { .. })));
}

/// More values change than their list has room for: the set in force is read as a whole.
#[test]
fn a_set_that_changes_everywhere_is_told_whole() {
    let new = Params::sheets();
    let mut old = new.clone();
    for entry in Entry::all() {
        let raw = old.get(entry);
        // The plant is made of some of them, and the bus of others.
        if (9000..9100).contains(&entry.no) {
            continue;
        }
        for other in [entry.max(), entry.min()] {
            if other != raw && old.set(entry, other).is_ok() && old.validate().is_ok() {
                break;
            }
            old.set(entry, raw).unwrap();
        }
    }
    let inside = machine(flash_with(&old));
    let mut link = link(&inside);
    link.stage(&new).unwrap();
    let list = link.read(STAGED_CHANGES);
    assert!(list.is_err_and(|trouble| trouble.is_abort(Abort::OutOfMemory)));
    assert_eq!(link.before(&new).unwrap(), old);
}

#[test]
fn no_more_certificates_are_taken_than_there_are_and_an_older_board_need_not_know() {
    let inside = machine(Flash::erased());
    let mut link = link(&inside);
    link.take_threads(0).unwrap();
    let refused = link.take_threads(1).unwrap_err();
    assert!(refused.is_abort(Abort::TooHigh), "{refused:?}");
    let older = |frame: &Frame| {
        let data = frame.exactly().unwrap_or([0_u8; 8]);
        if frame.id() != CobId::of(Service::SdoRequest, NodeId::BOARD) || data[1..3] != [0x42, 0x50]
        {
            return Fate::Arrives;
        }
        let mut abort = [0x80, 0x42, 0x50, 0, 0, 0, 0, 0];
        abort[4..].copy_from_slice(&Abort::NoObject.code().to_le_bytes());
        let id = CobId::of(Service::SdoReply, NodeId::BOARD);
        Fate::Lost(Frame::new(id, &abort))
    };
    between(&inside, older, |frame| frame)
        .take_threads(0)
        .unwrap();
}

/// It is this side that stands still, not the board.
#[test]
fn who_stood_still_hears_what_came_meanwhile_before_he_calls_it_late() {
    const PATIENCE: Duration = Duration::from_millis(20);
    let inside = machine(Flash::erased());
    let mut frames = 0;
    let aborts = Arc::new(AtomicU32::new(0));
    let told = aborts.clone();
    let sent = move |frame: &Frame| {
        frames += 1;
        if frame.payload().first() == Some(&0x80) {
            told.fetch_add(1, Ordering::Relaxed);
        }
        // In some places of any transfer.
        if frames < 6 || frames % 50 == 0 {
            std::thread::sleep(PATIENCE * 3);
        }
        Fate::Arrives
    };
    let mut link = between(&inside, sent, |frame| frame);
    link.set_patience(PATIENCE);
    let mut new = link.parameters().unwrap().params;
    new.set(Entry::find_text("9007").unwrap(), 13).unwrap();
    push(&mut link, &new).unwrap();
    assert_eq!(stored(&inside).1, new);
    assert_eq!(aborts.load(Ordering::Relaxed), 0);
}

/// One that is slow answers all questions at once, and is one board all the same.
#[test]
fn late_answers_are_not_those_of_a_second_board() {
    let inside = machine(Flash::erased());
    let mut wire = inside.clone();
    let mut questions = 0;
    let sent = move |frame: &Frame| {
        if frame.payload().starts_with(&[0x40, 0x18, 0x10, 4]) {
            questions += 1;
            match questions {
                1 | 2 => return Fate::Lost(None),
                // With those from before.
                3 => wire.send(&[*frame; 2]).unwrap(),
                _ => {}
            }
        }
        Fate::Arrives
    };
    let mut link = between(&inside, sent, |frame| frame);
    link.set_patience(Duration::from_millis(20));
    link.greet().unwrap();
}

/// What `own` says first has what somebody else says behind it, which this side hears of, or only by the status; then it
/// stands still. How often it said it comes with the result.
fn overtaken(
    inside: &Inside,
    is_heard: bool,
    theirs: fn(BoardCommand) -> BoardCommand,
    own: impl FnOnce(&mut Link) -> super::LinkResult,
) -> (super::LinkResult, u32) {
    let said = Arc::new(AtomicU32::new(0));
    let count = said.clone();
    let mut wire = inside.clone();
    let sent = move |frame: &Frame| {
        let Some((node, command)) = BoardCommand::decode(frame) else {
            return Fate::Arrives;
        };
        if count.fetch_add(1, Ordering::Relaxed) > 0 {
            return Fate::Arrives;
        }
        let theirs = theirs(command).frame(node);
        wire.send(&[*frame, theirs]).unwrap();
        std::thread::sleep(Duration::from_millis(100));
        Fate::Lost(is_heard.then_some(theirs))
    };
    let result = own(&mut between(inside, sent, |frame| frame));
    (result, said.load(Ordering::Relaxed))
}

/// A repetition asks the board for its beat. What confirms the order may come with the answer.
#[test]
fn an_order_is_confirmed_by_whatever_is_heard_in_its_repetition() {
    let inside = machine(Flash::erased());
    let mut wire = inside.clone();
    let mut given = None;
    let question = CobId::of(Service::SdoRequest, NodeId::BOARD);
    let sent = move |frame: &Frame| {
        if BoardCommand::decode(frame).is_some() && given.is_none() {
            // It is on its way for long.
            given = Some(*frame);
            return Fate::Lost(None);
        }
        if frame.id() == question && given.is_some() {
            wire.send(&given.into_iter().collect::<Vec<_>>()).unwrap();
            std::thread::sleep(Duration::from_millis(100));
        }
        Fate::Arrives
    };
    // The beat of the board does not come by itself.
    let other = NmtState::Operational.frame(NodeId::new(99).unwrap());
    let heard = move |frame: Frame| match BoardBeat::decode(&frame, NodeId::BOARD) {
        Some(_) => other,
        None => frame,
    };
    let mut link = between(&inside, sent, heard);
    link.order(Order::Mode(OperatingMode::Manual)).unwrap();
    assert_eq!(link.mode().unwrap(), OperatingMode::Manual);
}

#[test]
fn an_order_is_not_given_again_behind_that_of_somebody_else() {
    for is_heard in [false, true] {
        let inside = machine(Flash::erased());
        let mut link = link(&inside);
        link.order(Order::Hold).unwrap();
        let hold = |resume: BoardCommand| BoardCommand::order(Order::Hold, resume.count);
        let (result, said) = overtaken(&inside, is_heard, hold, |link| link.order(Order::Resume));
        match result {
            Err(Trouble::Unconfirmed {
                order: "resume",
                overtaken: true,
                ..
            }) => {}
            other => panic!("{other:?}"),
        }
        assert_eq!(said, 1);
        assert!(link.status().unwrap().hold, "as the other one wants it");
        link.order(Order::Resume).unwrap();
        assert!(!link.status().unwrap().hold);
    }
}

#[test]
fn to_halt_is_ordered_again_behind_whatever_somebody_else_orders() {
    let at_once = |hold: BoardCommand| BoardCommand {
        order: Some(Order::Resume),
        ..hold
    };
    let behind = |hold: BoardCommand| BoardCommand::order(Order::Resume, hold.count);
    for (theirs, is_heard) in [
        (at_once as fn(_) -> _, true),
        (behind, true),
        (behind, false),
    ] {
        // The other one has no echo.
        let inside = machine_of(&set(&[("9047", 0)]), Flash::erased());
        let (result, said) = overtaken(&inside, is_heard, theirs, |link| link.order(Order::Hold));
        result.unwrap();
        assert_eq!(said, 2);
        assert!(link(&inside).status().unwrap().hold);
    }
}

#[test]
fn overrides_are_not_set_again_behind_those_of_somebody_else() {
    let feed = |percent| BoardCommand {
        feed: Some(percent),
        ..BoardCommand::default()
    };
    let inside = machine(Flash::erased());
    let theirs = |_| BoardCommand {
        feed: Some(70),
        ..BoardCommand::default()
    };
    let (result, said) = overtaken(&inside, true, theirs, |link| link.set_levels(feed(50)));
    result.unwrap();
    assert_eq!(said, 1);
    assert_eq!(link(&inside).status().unwrap().feed_percent, 70);
    // Where nobody else says anything, they are sent more than once.
    let mut sent = 0;
    let lose_one = move |frame: &Frame| {
        sent += u32::from(BoardCommand::decode(frame).is_some());
        if sent == 1 {
            Fate::Lost(None)
        } else {
            Fate::Arrives
        }
    };
    let mut link = between(&inside, lose_one, |frame| frame);
    link.set_levels(feed(50)).unwrap();
    assert_eq!(link.status().unwrap().feed_percent, 50);
}

/// What goes out once a hold is wanted: asked is `own`, and `wanted` is told each frame that is sent and each that is heard
/// (true), until it says that it is wanted.
fn behind_the_wish(
    inside: &Inside,
    mut fate: impl FnMut(&Frame) -> Fate + Send + 'static,
    mut hear: impl FnMut(Frame) -> Frame + Send + 'static,
    wanted: impl FnMut(&Frame, bool) -> bool + Send + 'static,
    own: impl FnOnce(&mut Link),
) -> Vec<Frame> {
    let hold = Arc::new(AtomicBool::new(false));
    let sent = Arc::new(Mutex::new(Vec::new()));
    let wanted = Arc::new(Mutex::new(wanted));
    let [asks, here, there] = std::array::from_fn(|_| hold.clone());
    let (wanted_too, log) = (wanted.clone(), sent.clone());
    let mut link = between(
        inside,
        move |frame| {
            if here.load(Ordering::Relaxed) {
                log.lock().unwrap().push(*frame);
            } else if wanted.lock().unwrap()(frame, false) {
                here.store(true, Ordering::Relaxed);
            }
            fate(frame)
        },
        move |frame| {
            let frame = hear(frame);
            if wanted_too.lock().unwrap()(&frame, true) {
                there.store(true, Ordering::Relaxed);
            }
            frame
        },
    );
    link.set_patience(Duration::from_millis(100));
    link.hear_status().unwrap();
    link.hold_when(move || asks.load(Ordering::Relaxed));
    own(&mut link);
    assert!(hold.load(Ordering::Relaxed), "it was wanted at all");
    sent.lock().unwrap().clone()
}

fn holds(frame: &Frame) -> bool {
    BoardCommand::decode(frame).is_some_and(|(_, told)| told.order == Some(Order::Hold))
}

fn asks_the_board(frame: &Frame) -> bool {
    frame.id() == CobId::of(Service::SdoRequest, NodeId::BOARD)
}

/// The hold is process data. [D178]
#[test]
fn a_hold_waits_neither_for_a_transfer_nor_for_a_turn() {
    // In the middle of one, at any of its frames.
    for place in 0..6 {
        let inside = machine(Flash::erased());
        let mut left = place;
        let wanted = move |frame: &Frame, heard: bool| {
            if heard || !asks_the_board(frame) {
                return false;
            }
            left -= 1;
            left < 0
        };
        let read = |link: &mut Link| {
            link.status().and(link.parameters()).unwrap();
        };
        let sent = behind_the_wish(&inside, |_| Fate::Arrives, |frame| frame, wanted, read);
        assert!(holds(&sent[0]), "{place}: {sent:?}");
        assert_eq!(sent.iter().filter(|frame| holds(frame)).count(), 1);
        assert!(link(&inside).status().unwrap().hold);
    }
    // Where the answer does not come, and is waited for.
    let inside = machine(Flash::erased());
    let mut lost = 0;
    let lose = move |frame: &Frame| {
        lost += u32::from(asks_the_board(frame));
        if lost == 1 && asks_the_board(frame) {
            Fate::Lost(None)
        } else {
            Fate::Arrives
        }
    };
    let mut asked = false;
    let wanted = move |frame: &Frame, heard: bool| {
        asked |= !heard && asks_the_board(frame);
        asked && heard
    };
    let read = |link: &mut Link| {
        link.status().unwrap();
    };
    let sent = behind_the_wish(&inside, lose, |frame| frame, wanted, read);
    assert!(holds(&sent[0]), "{sent:?}");
    // While another client, that never pauses, keeps this side from its turn.
    let inside = machine(Flash::erased());
    let poll = |frame: Frame| match BoardSpindle::decode(&frame) {
        Some(_) => {
            let request = CobId::of(Service::SdoRequest, NodeId::BOARD);
            Frame::new(request, &[0x40, 0x01, 0x50, 1, 0, 0, 0, 0]).unwrap()
        }
        None => frame,
    };
    let polls = Arc::new(AtomicU32::new(0));
    let (heard_of, sent_behind) = (polls.clone(), Arc::new(AtomicU32::new(0)));
    let wanted = move |frame: &Frame, heard: bool| {
        let one = u32::from(heard && asks_the_board(frame));
        heard_of.fetch_add(one, Ordering::Relaxed) + one == 3
    };
    let behind = sent_behind.clone();
    let note = move |frame: &Frame| {
        if holds(frame) {
            behind.store(polls.load(Ordering::Relaxed), Ordering::Relaxed);
        }
        Fate::Arrives
    };
    let sent = behind_the_wish(&inside, note, poll, wanted, read);
    assert!(holds(&sent[0]), "{sent:?}");
    // Heard are no more than what came in one piece; a turn is waited for through thirty.
    let polls = sent_behind.load(Ordering::Relaxed);
    assert!((3..20).contains(&polls), "{polls}");
    assert!(link(&inside).status().unwrap().hold);
}

#[test]
fn a_machine_that_is_to_be_held_is_not_told_to_run() {
    let runs = |frame: &Frame| {
        BoardCommand::decode(frame).is_some_and(|(_, told)| told.order == Some(Order::Run))
    };
    // Before it was told, and behind it, where that is lost or arrives.
    for (before, arrives) in [(true, true), (false, true), (false, false)] {
        let inside = machine(Flash::erased());
        let wanted = move |frame: &Frame, heard: bool| !heard && (before || runs(frame));
        let fate = move |frame: &Frame| {
            if arrives || !runs(frame) {
                Fate::Arrives
            } else {
                Fate::Lost(None)
            }
        };
        let own = |link: &mut Link| {
            if before {
                link.start_node().unwrap();
            } else {
                link.set_mode(OperatingMode::Automatic).unwrap();
            }
            link.order(Order::Run).unwrap();
            link.idle(Duration::from_millis(30)).unwrap();
            // The way the runner goes on.
            link.order(Order::Hold).unwrap();
            link.order(Order::Reset).unwrap();
        };
        let sent = behind_the_wish(&inside, fate, |frame| frame, wanted, own);
        assert!(holds(&sent[0]), "{sent:?}");
        assert!(!sent.iter().any(runs), "{sent:?}");
        // The runner's own is the same one.
        assert_eq!(sent.iter().filter(|frame| holds(frame)).count(), 1);
        // Behind the mode and the order to run, which have the counts before it.
        let (_, hold) = BoardCommand::decode(&sent[0]).unwrap();
        assert_eq!(hold.count, if before { 1 } else { 3 });
    }
}

/// Whether a node is a board is told where it says so, not where a question or its answer gets lost.
#[test]
fn a_board_whose_answers_get_lost_is_not_told_as_another_device() {
    // 1018h:02h, the product code.
    let asks = |frame: &Frame| frame.payload().get(..4) == Some(&[0x40, 0x18, 0x10, 2]);
    let reply = CobId::of(Service::SdoReply, NodeId::BOARD);
    let absent = Frame::new(reply, &[0x80, 0x18, 0x10, 2, 0, 0, 2, 6]);
    for (heard, is_another) in [(None, false), (absent, true)] {
        let inside = machine(Flash::erased());
        let fate = move |frame: &Frame| match asks(frame) {
            true => Fate::Lost(heard),
            false => Fate::Arrives,
        };
        let mut link = between(&inside, fate, |frame| frame);
        link.set_patience(Duration::from_millis(20));
        let told = link.greet().unwrap_err();
        let another = matches!(told, Trouble::NotABoard { product: None, .. });
        assert_eq!(another, is_another, "{told:?}");
    }
}
