//! Axes that are moved by hand, and whoever moves them is killed (SIGKILL): the board comes to rest by itself. All times
//! are the board's, by its beat, so nothing depends on how fast this computer is.

use std::process::Stdio;
use std::time::Instant;

use leadscrew_can::{Can, Received};
use leadscrew_core::bus::{
    BoardBeat, BoardState, BoardStatus, CobId, DriveCommand, Frame, JogRequest, NodeId, Service,
};
use leadscrew_core::operating::PressState;

use crate::bus::{PATIENCE, open};
use crate::machine::{Board, bad, command, field, good, leadscrew, wait_for_status};

/// Parameter 9040, and the board's status period: it may tell so much later.
const WINDOW_MS: u16 = 100;
const STATUS_MS: u16 = 10;

fn z_setpoint(frame: &Frame) -> Option<i32> {
    if frame.id() != CobId::of(Service::Rpdo1, NodeId::DRIVE_Z) {
        return None;
    }
    DriveCommand::decode(frame).map(|(_, command)| command.target.get())
}

/// Presses that may end by themselves before the kill, for one that is killed: this computer was busy for longer than the
/// window, and the board did what it has to.
const LAPSES: u32 = 20;

#[test]
fn whoever_jogs_is_killed_and_the_axis_rests_in_time_and_stays() {
    let _board = Board::start(&[]);
    wait_for_status("its drives are up", |status| {
        field(status, "state") == "idle"
    });
    let kills = leadscrew_seed::amount(6, 200);
    let mut can = open();
    for kill in 0..kills {
        let killed = (0..LAPSES).any(|_| kills_a_jog(&mut can, kill));
        assert!(killed, "kill {kill}: each press ended before it");
    }
}

/// Jogs, kills whoever jogs, and sees the axis rest. False where the press ended before that.
fn kills_a_jog(can: &mut impl Can, kill: u32) -> bool {
    // To and fro, so that the travel lasts.
    let way = if kill.is_multiple_of(2) { "Z-" } else { "Z+" };
    let mut jogging = command(&["jog", way, "--hold"])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let began = Instant::now();
    let mut heard: Vec<Received> = Vec::new();
    let (mut echo, mut beat, mut idle) = (None, BoardBeat::default(), false);
    let (mut renewals, mut killed) = (0, false);
    let mut stands: Option<(i32, u32)> = None;
    while stands.is_none_or(|(_, times)| times < 100) {
        assert!(began.elapsed() < PATIENCE, "kill {kill}: {beat:?}");
        heard.clear();
        can.receive(&mut heard, PATIENCE).unwrap();
        for frame in heard.iter().filter_map(|heard| heard.packet.frame()) {
            if let Some((_, press)) = JogRequest::decode(frame) {
                echo = Some(press.echo);
                renewals += 1;
            }
            if let Some((_, status)) = BoardStatus::decode(frame) {
                idle = status.state == BoardState::Idle;
            }
            if let Some(told) = BoardBeat::decode(frame, NodeId::BOARD) {
                let ended =
                    killed && beat.state == PressState::Runs && told.state == PressState::Ended;
                if let (true, Some(echo)) = (ended, echo) {
                    let late = told.beat.age_of(echo).unwrap();
                    assert!(
                        late <= WINDOW_MS + STATUS_MS + 1,
                        "kill {kill}: {late} ms after the last beat that was echoed"
                    );
                }
                beat = told;
            }
            let at_rest = killed && beat.state == PressState::Ended && idle;
            if let (true, Some(z)) = (at_rest, z_setpoint(frame)) {
                let (at, times) = stands.unwrap_or((z, 0));
                assert_eq!(z, at, "kill {kill}: it moves again");
                stands = Some((at, times + 1));
            }
        }
        if killed {
            continue;
        }
        if renewals > kill % 13 && beat.state == PressState::Runs {
            jogging.kill().unwrap();
            killed = true;
        } else if jogging.try_wait().unwrap().is_some() {
            return false;
        }
    }
    jogging.wait().unwrap();
    true
}

#[test]
fn a_jog_by_a_length_says_where_it_has_come_to_and_what_is_refused_says_why() {
    // A step is not ended for want of frames by a computer that has other work.
    let _board = Board::start(&["--set", "9040=500"]);
    wait_for_status("its drives are up", |status| {
        field(status, "state") == "idle"
    });
    let moved = good(&leadscrew(&["jog", "X-", "--by", "0.02", "--json"]));
    assert_eq!(field(&moved, "mx"), "-0.02");
    let moved = good(&leadscrew(&["jog", "Z-", "--by", "2.5", "--json"]));
    assert_eq!(field(&moved, "mz"), "-2.5");
    let words = bad(&leadscrew(&["jog", "X+", "--by", "1600"]), 1);
    assert!(words.contains("4540"), "{words}");
    good(&leadscrew(&["hold"]));
    let words = bad(&leadscrew(&["jog", "Z-", "--by", "1"]), 1);
    assert!(
        words.contains("4506") && words.contains("resume"),
        "{words}"
    );
    good(&leadscrew(&["resume"]));
    let status = good(&leadscrew(&["status", "--json"]));
    assert_eq!(field(&status, "mode"), "step");
    assert_eq!(field(&status, "mz"), "-2.5");
    good(&leadscrew(&["mode", "manual"]));
    let status = good(&leadscrew(&["status", "--json"]));
    assert_eq!(field(&status, "mode"), "manual");
}
