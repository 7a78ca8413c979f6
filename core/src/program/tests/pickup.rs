//! A thread that was picked up: whatever program cuts a helix, every other one with the same lead goes on in its groove.

use leadscrew_seed::Random;

use super::*;
use crate::alarm::{Arg, Code};
use crate::cycle::ThreadMoves;
use crate::moves::MoveKind;
use crate::offsets::{Offset, Offsets, PickedUp};
use crate::units::{Angle, Diameter, StartAngle};
use std::format;
use std::string::String;

/// The begin of the last pass of a helix (machine, nm, on the long axis), its angle there in µ° of the encoder, and the
/// way it goes.
#[derive(Debug)]
struct Begin {
    at: i64,
    udeg: i64,
    backward: bool,
    /// M04: the encoder counts down.
    reverse: bool,
}

const TURN: i64 = 360_000_000;

impl Begin {
    fn of(call: &ThreadCall) -> Self {
        let long_x = call.cycle == ThreadCycle::G32 && call.start.z == call.end_z.value;
        let of = |at: Position| if long_x { at.x.nm() } else { at.z.nm() };
        let moves = ThreadMoves::new(call, Span::default()).unwrap();
        let (mut from, mut found, mut pass) = (call.start, None, None);
        for step in moves {
            if let MoveKind::Thread(thread) = step.kind {
                let tag = step.tag.unwrap();
                if tag.start == 1 && pass != Some(tag.pass) {
                    pass = Some(tag.pass);
                    found = Some((from, thread.pass_angle, step.to));
                }
            }
            from = step.to;
        }
        let (begin, angle, to) = found.unwrap();
        let reverse = call.rpm.get() < 0;
        let udeg = i64::from(angle.mdeg()) * 1000;
        Self {
            at: of(begin),
            udeg: if reverse { -udeg } else { udeg },
            backward: of(to) < of(begin),
            reverse,
        }
    }

    /// The angle of the encoder where the helix is at `place`.
    fn angle_at(&self, place: i64, lead: i64) -> i64 {
        let way = if self.backward {
            self.at - place
        } else {
            place - self.at
        };
        let turned = i128::from(way) * i128::from(TURN) / i128::from(lead);
        let turned = if self.reverse { -turned } else { turned };
        (i128::from(self.udeg) + turned).rem_euclid(TURN.into()) as i64
    }
}

fn with_table(text: &str, table: Offsets) -> (Vec<Event>, Option<Alarm>) {
    let options = Options {
        offsets: Some(table),
        ..Options::default()
    };
    read_with(text.as_bytes(), &Params::sheets(), options)
}

fn threads(events: &[Event]) -> Vec<ThreadCall> {
    let of = |event: &Event| match event {
        Event::Call(Call {
            kind: CallKind::Thread(thread),
            ..
        }) => Some(*thread),
        _ => None,
    };
    events.iter().filter_map(of).collect()
}

fn last_thread(events: &[Event]) -> ThreadCall {
    *threads(events).last().unwrap()
}

fn warnings(events: &[Event]) -> Vec<Alarm> {
    let of = |event: &Event| match event {
        Event::Warning(alarm) => Some(*alarm),
        Event::Call(_) => None,
    };
    events.iter().filter_map(of).collect()
}

/// A program that cuts a thread of this lead (µm) along Z; its own place, speed, cycle and depth.
fn along_z(random: &mut Random, lead: i64, turning: &str) -> String {
    let mm = |um: usize| format!("{}.{:03}", um / 1000, um % 1000);
    let start = mm(5_000 + random.index(20_000));
    let end = mm(20_000 + random.index(30_000));
    let rpm = 50 + random.index(200);
    let lead = mm(lead as usize);
    let tool = 1 + random.index(3);
    let depth = 1 + random.index(3);
    let block = match random.index(5) {
        0 => format!("G92 X58 Z-{end} F{lead}"),
        1 => format!("G32 X60 Z-{end} F{lead}"),
        2 => format!(
            "G76 P02{:02}60 Q200 R0.05\nG76 X{} Z-{end} P{}000 Q500 F{lead}",
            random.index(5),
            60 - 2 * depth,
            depth
        ),
        3 => format!(
            "G78 P02{:02}55 Q0.1 R0.05\nG78 X{} Z-{end} P{depth} Q0.4 F{lead} L{}",
            random.index(5),
            60 - 2 * depth,
            1 + random.index(3)
        ),
        _ => format!("G32 Z-{end} F{lead} Q90000"),
    };
    format!("T0{tool}0{tool}\n{turning} S{rpm}\nG0 X64 Z{start}\n{block}\n")
}

/// Three tools of different length and wear.
fn table() -> Offsets {
    let mut table = Offsets::default();
    for (tool, z) in table.tools.iter_mut().zip([-40, 17, 3]) {
        tool.geometry.z = Length::from_nm(z * 1_000_700);
        tool.wear.z = Length::from_nm(z * 300);
    }
    table
}

/// Q of a call, and the change of it by the steps of a start angle.
fn own(text: &str) -> i64 {
    if text.contains("Q90000") {
        90_000_000
    } else {
        0
    }
}

fn follow(random: &mut Random) {
    let lead = 500 + random.index(9_500) as i64;
    let turning = ["M3", "M4"][random.index(2)];
    let (first, second) = (
        along_z(random, lead, turning),
        along_z(random, lead, turning),
    );
    let mut table = table();
    let (events, alarm) = with_table(&first, table);
    assert_eq!(alarm, None, "{first}");
    let cut = Begin::of(&last_thread(&events));

    // Touched anywhere along the groove, by a tool of any length.
    let place = -(random.index(60_000) as i64) * 1000;
    let touching = random.index(3);
    let tool = table.tools[touching];
    let tip = place - tool.geometry.z.nm() - tool.wear.z.nm();
    let udeg = cut.angle_at(place, lead * 1000);
    table.thread = PickedUp {
        tip: Offset {
            x: Diameter::from_nm(0),
            z: Length::from_nm(tip),
        },
        angle: Some(Angle::from_udeg(udeg / 100 * 100)),
    };
    assert_eq!(table.beyond(), None);
    let (events, alarm) = with_table(&second, table);
    assert_eq!(alarm, None, "{second}");
    let told = warnings(&events)
        .into_iter()
        .filter(|told| told.code == Code::PickedUp);
    assert_eq!(told.count(), 1, "{second}");
    let again = Begin::of(&last_thread(&events));

    // The other tool stands elsewhere with its tip in the same place.
    let number = usize::from(second.as_bytes()[2] - b'0');
    let cutting = table.tools[number - 1];
    let there = tip + cutting.geometry.z.nm() + cutting.wear.z.nm();
    let sign = if again.reverse { -1 } else { 1 };
    let expected = udeg + sign * own(&second);
    let beside = (again.angle_at(there, lead * 1000) - expected).rem_euclid(TURN);
    let beside = beside.min(TURN - beside);
    assert!(
        beside <= 700,
        "{beside} µ° beside the groove of\n{first}\nin\n{second}\n{cut:?} {again:?}"
    );
}

#[test]
fn another_program_goes_on_in_the_groove() {
    leadscrew_seed::volume(7, |seed| {
        let mut random = Random(seed);
        for _ in 0..leadscrew_seed::amount(500, 50_000) {
            follow(&mut random);
        }
    });
}

fn picked_up(x: i64, z: i64, udeg: i64) -> Offsets {
    Offsets {
        thread: PickedUp {
            tip: Offset {
                x: Diameter::from_nm(x * 1_000_000),
                z: Length::from_nm(z * 1_000_000),
            },
            angle: Some(Angle::from_udeg(udeg)),
        },
        ..Offsets::default()
    }
}

/// By hand: Z 1 is two turns of lead 2 after Z 5, Z 1.5 a quarter turn less.
#[test]
fn the_start_angle_is_that_of_the_place_less_the_turns_to_it() {
    let angle = |z: i64, udeg: i64, turning: &str, block: &str| {
        let text = format!("{turning} S300\nG0 X40 Z5\n{block}\n");
        let (events, alarm) = with_table(&text, picked_up(40, z, udeg));
        assert_eq!(alarm, None, "{text}");
        last_thread(&events).first_angle
    };
    assert_eq!(angle(1, 0, "M3", "G32 Z-20 F2"), StartAngle::INDEX);
    assert_eq!(
        angle(1, 30_000_000, "M3", "G32 Z-20 F2"),
        StartAngle::from_mdeg(30_000)
    );
    assert_eq!(
        angle(1, 30_000_000, "M4", "G32 Z-20 F2"),
        StartAngle::from_mdeg(330_000)
    );
    assert_eq!(
        angle(2, 0, "M3", "G32 Z-20 F2"),
        StartAngle::from_mdeg(180_000)
    );
    // Z 2 is a turn and a half from the start; of lead 8 three eighths.
    assert_eq!(
        angle(2, 0, "M3", "G92 X39 Z-20 F8"),
        StartAngle::from_mdeg(225_000)
    );
    // Behind the start.
    assert_eq!(
        angle(7, 0, "M3", "G92 X39 Z-20 F8"),
        StartAngle::from_mdeg(90_000)
    );
    // Along X it is X that counts: 40 in diameter is where it begins, 10 of the radius is five turns.
    assert_eq!(
        angle(0, 45_000_000, "M3", "G32 X20 F2"),
        StartAngle::from_mdeg(45_000)
    );
}

/// A stroke that goes on is in the groove of the one before; the warning comes once.
#[test]
fn a_chain_follows_as_a_whole() {
    let text = "M3 S300\nG0 X40 Z5\nG32 Z-1 F2\nZ-4 F4\nG0 X50\nZ5\nX40\nG32 Z-1 F2\n";
    let (events, alarm) = with_table(text, picked_up(40, 1, 30_000_000));
    assert_eq!(alarm, None);
    let told = warnings(&events);
    let told: Vec<_> = told
        .iter()
        .map(|told| (told.code, told.span.line))
        .collect();
    assert_eq!(told, [(Code::PickedUp, 3)]);
    let threads = threads(&events);
    let angles: Vec<_> = threads
        .iter()
        .map(|thread| thread.first_angle.mdeg())
        .collect();
    // Three turns to Z -1.
    assert_eq!(angles, [30_000, 30_000, 30_000]);
}

#[test]
fn a_lead_that_changes_follows_no_groove() {
    let text = "M3 S300\nG0 X40 Z5\nG34 Z-20 F2 K0.1\n";
    let (_, alarm) = with_table(text, picked_up(40, 1, 0));
    let alarm = alarm.unwrap();
    assert_eq!(
        (alarm.code, alarm.span.line, alarm.word),
        (Code::PickedUpVariable, 3, None)
    );
    assert_eq!(with_table(text, Offsets::default()).1, None);
}

#[test]
fn the_warning_names_place_and_angles() {
    let (events, _) = with_table(
        "M3 S300\nG0 X40 Z5\nG32 Z-20 F2\n",
        picked_up(40, 2, 30_000_000),
    );
    let alarm = warnings(&events)[0];
    let angle = |udeg| Arg::Angle(Angle::from_udeg(udeg));
    let [a, b, c, d] = [
        Arg::Letter(b'Z'),
        Arg::Length(mm(2)),
        angle(30_000_000),
        angle(210_000_000),
    ];
    assert_eq!(alarm.args[..4], [a, b, c, d]);
}
