//! G70 after G71, G72 and G73, as random programs: what the text says is what is cut.
//!
//! The roughing is that of the same contour with the same figures, which the columns judge, and knows nothing of F, S, T,
//! M and the nose inside the contour. The finishing cut is the contour itself, to the nanometre, with all of these where
//! they stand, and takes what the roughing has left and no more.

use std::fmt::Write as _;

use leadscrew_core::call::{Aux, CallKind, FeedRate, Position};
use leadscrew_core::params::Params;
use leadscrew_core::program::Event;

use super::case::{Case, MICROMETRE, Random};
use super::columns::{Columns, SLACK, Way, near, shifted};
use super::repeated::{self, Copies};
use super::{check, notation::span};
use crate::contour::{Allowance, Along, Contour};
use crate::dialect::Control;
use crate::plane::{Element, Point, Shape};
use crate::reading::{read_on, with};

/// What a program is told to do by its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Told {
    /// A move from A on, at a feed in nanometres a minute, or a turn at so many turns a minute.
    Move(Point, Shape, Option<(i64, u32)>),
    Speed(u32),
    M(u16),
    Tool(u16),
}

/// Words of a block besides its motion.
#[derive(Clone, Copy, Debug, Default)]
struct Extra {
    feed: Option<i64>,
    other: Option<Told>,
}

impl Extra {
    fn random(random: &mut Random) -> Self {
        Self {
            feed: random.one_in(3).then(|| random.within(20, 400)),
            other: match random.within(0, 8) {
                0 => Some(Told::Speed(random.within(100, 900) as u32)),
                1 => Some(Told::M(random.within(8, 9) as u16)),
                2 => Some(Told::Tool([101, 202][random.within(0, 1) as usize])),
                _ => None,
            },
        }
    }

    fn write(&self, writer: &mut Writer) {
        if let Some(feed) = self.feed {
            writer.feed(feed);
        }
        match self.other {
            Some(Told::Speed(rpm)) => writer.word(&format!("S{rpm}")),
            Some(Told::M(code)) => writer.word(&format!("M{code}")),
            Some(Told::Tool(number)) => writer.word(&format!("T{number:04}")),
            _ => {}
        }
    }
}

/// The feed and the speed in force, as the text sets them.
#[derive(Clone, Copy)]
struct Modes {
    per_turn: bool,
    feed: i64,
    rpm: u32,
}

impl Modes {
    fn set(&mut self, extra: &Extra, told: &mut Vec<Told>) {
        self.feed = extra.feed.unwrap_or(self.feed);
        if let Some(Told::Speed(rpm)) = extra.other {
            self.rpm = rpm;
        }
        told.extend(extra.other);
    }

    fn cut(&self, end: Point, shape: Shape) -> Told {
        let feed = match (shape, self.per_turn) {
            (Shape::Rapid, _) => None,
            (_, true) => Some((self.feed * MICROMETRE, self.rpm)),
            (_, false) => Some((self.feed * 1_000_000, 0)),
        };
        Told::Move(end, shape, feed)
    }
}

/// A length in micrometres as millimetres.
fn mm(um: i64) -> String {
    let sign = if um < 0 { "-" } else { "" };
    format!("{sign}{}.{:03}", um.abs() / 1000, um.abs() % 1000)
}

/// A text that grows by words.
struct Writer {
    text: String,
    control: Control,
    /// Where A is, µm.
    start: (i64, i64),
    per_turn: bool,
}

impl Writer {
    fn word(&mut self, word: &str) {
        self.text += word;
        self.text.push(' ');
    }

    fn end(&mut self) {
        self.text.push(';');
    }

    fn length(&mut self, letter: &str, nm: i64) {
        self.word(&format!("{letter}{}", mm(nm / MICROMETRE)));
    }

    fn feed(&mut self, feed: i64) {
        let feed = if self.per_turn {
            mm(feed)
        } else {
            format!("{feed}.")
        };
        self.word(&format!("F{feed}"));
    }

    const fn is_of_system_a(&self) -> bool {
        !matches!(self.control, Control::FanucB | Control::FanucC)
    }

    /// The words of a place seen from A.
    fn x(&mut self, from: Point, to: Point, random: &mut Random) {
        if self.is_of_system_a() && random.one_in(4) {
            self.length("U", 2 * (to.x - from.x).nm());
        } else {
            self.length("X", 2 * (self.start.0 * MICROMETRE + to.x.nm()));
        }
    }

    fn z(&mut self, from: Point, to: Point, random: &mut Random) {
        if self.is_of_system_a() && random.one_in(4) {
            self.length("W", (to.z - from.z).nm());
        } else {
            self.length("Z", self.start.1 * MICROMETRE + to.z.nm());
        }
    }

    /// G70 to G73, as this control writes them.
    fn cycle(&mut self, code: u32) {
        let code = code
            + if self.control == Control::FanucC {
                2
            } else {
                0
            };
        self.word(&format!("G{code}"));
    }
}

/// A program and what it says.
#[derive(Debug)]
struct Program {
    copies: Copies,
    /// G71, G72 or G73.
    code: u32,
    control: Control,
    /// G41, G42, or neither.
    side: Option<u32>,
    start: (i64, i64),
    text: String,
    roughing: Vec<Told>,
    finishing: Vec<Told>,
}

impl Program {
    fn random(random: &mut Random) -> Self {
        let control = Control::ALL[random.within(0, 5) as usize];
        let mut copies = Copies::written(random);
        let pattern = random.one_in(3);
        let case = &mut copies.case;
        case.rapid_retract = !matches!(control, Control::Gsk980td | Control::Gsk988);
        let one_line = random.one_in(2);
        let leaves = one_line || case.rapid_retract;
        if !pattern && leaves && random.one_in(3) {
            let along = if case.two_axes { 0 } else { 500 };
            case.left = (
                random.within(0, 500) * MICROMETRE,
                random.within(0, along) * MICROMETRE,
            );
        }
        let code = match (pattern, case.along) {
            (true, _) => 73,
            (_, Along::Z) => 71,
            (_, Along::X) => 72,
        };
        let mut program = Self {
            copies,
            code,
            control,
            side: random.one_in(4).then(|| random.within(41, 42) as u32),
            start: (100_000, random.within(-200_000, 200_000)),
            text: String::new(),
            roughing: Vec::new(),
            finishing: Vec::new(),
        };
        program.write(one_line, random);
        program
    }

    fn case(&self) -> &Case {
        &self.copies.case
    }

    fn write(&mut self, one_line: bool, random: &mut Random) {
        let contour = self.case().contour();
        let mut modes = Modes {
            per_turn: random.one_in(2),
            feed: random.within(20, 400),
            rpm: random.within(100, 900) as u32,
        };
        let mut writer = Writer {
            text: String::new(),
            control: self.control,
            start: self.start,
            per_turn: modes.per_turn,
        };
        let per_minute = if writer.is_of_system_a() { 98 } else { 94 };
        writer.word(&format!("G{}", per_minute + u32::from(modes.per_turn)));
        writer.word(&format!("G97 S{} M3", modes.rpm));
        writer.feed(modes.feed);
        writer.end();
        let tool = if self.side.is_some() {
            "T0303"
        } else {
            "T0101"
        };
        writer.word(&format!("{tool};G0"));
        writer.length("X", 2 * self.start.0 * MICROMETRE);
        writer.length("Z", self.start.1 * MICROMETRE);
        writer.end();
        let line = Extra::random(random);
        let by_word = self.write_cycle(one_line, &line, &mut writer, random);
        modes.set(&line, &mut self.roughing);
        let moves = if self.code == 73 {
            repeated::repeat(&self.copies, &contour)
        } else {
            check::rough(self.case(), &contour)
        };
        let moves = moves.expect("a cycle");
        let cuts = moves.iter().map(|cut| cut.element);
        let cuts = cuts.map(|element| modes.cut(element.end, element.shape));
        self.roughing.extend(cuts);
        let behind = random.one_in(4);
        let (mut ends, mut blocks) = (String::new(), String::new());
        std::mem::swap(&mut ends, &mut writer.text);
        self.write_contour(&contour, by_word, &mut modes, &mut writer, random);
        std::mem::swap(&mut blocks, &mut writer.text);
        writer.text = ends;
        if !behind {
            writer.text += &blocks;
        }
        writer.cycle(70);
        writer.word("P1 Q2;G1");
        // What the contour has left in force.
        let further = Point::from_nm(0, 1_000_000);
        writer.length("Z", self.start.1 * MICROMETRE + 1_000_000);
        writer.word(";M30;");
        self.finishing
            .push(modes.cut(Point::default(), Shape::Rapid));
        self.finishing.push(modes.cut(further, Shape::Line));
        if behind {
            writer.text += &blocks;
        }
        self.text = writer.text;
    }

    /// The cycle in one line or in two. True where the first block of the contour has one axis, though it may go down
    /// again: a word of the cycle says so.
    fn write_cycle(
        &self,
        one_line: bool,
        line: &Extra,
        writer: &mut Writer,
        random: &mut Random,
    ) -> bool {
        let (case, repeats) = (self.case(), self.copies.words());
        let (depth, passes) = (case.depth, repeats.passes.value);
        let figures: Vec<(&str, i64)> = match (self.code, one_line) {
            (71, false) => vec![("U", depth), ("R", case.retract)],
            (72, false) => vec![("W", depth), ("R", case.retract)],
            (_, false) => vec![("U", repeats.x.nm()), ("W", repeats.z.nm())],
            (73, true) => vec![],
            (_, true) => vec![("R", case.retract)],
        };
        if !figures.is_empty() {
            writer.cycle(self.code);
            for (letter, length) in figures {
                writer.length(letter, length);
            }
            if self.code == 73 {
                writer.word(&format!("R{passes}"));
            }
            writer.end();
        }
        writer.cycle(self.code);
        writer.word("P1 Q2");
        let Allowance { x, z } = case.words().allowance;
        if x.nm() != 0 || random.one_in(2) {
            writer.length("U", x.nm());
        }
        if z.nm() != 0 || random.one_in(2) {
            writer.length("W", z.nm());
        }
        let left = case.left();
        match (self.code, one_line) {
            (73, true) => {
                writer.length("I", repeats.x.nm());
                writer.length("K", repeats.z.nm());
                writer.word(&format!("D{passes}"));
            }
            (73, false) => {}
            _ => {
                if left != Allowance::NONE {
                    writer.length("I", left.x.radius().nm());
                    writer.length("K", left.z.nm());
                }
                if one_line {
                    writer.length("D", depth);
                }
            }
        }
        let slanted = case.pieces[0].l != 0;
        let by_word = self.code != 73 && case.two_axes && !slanted && self.control == Control::Haas;
        if by_word {
            writer.word("R1");
        }
        line.write(writer);
        writer.end();
        by_word
    }

    fn write_contour(
        &mut self,
        contour: &Contour,
        by_word: bool,
        modes: &mut Modes,
        writer: &mut Writer,
        random: &mut Random,
    ) {
        let axes = (
            self.case().two_axes && !by_word || self.case().along == Along::Z,
            self.case().two_axes && !by_word || self.case().along == Along::X,
        );
        let (mut from, mut code) = (Point::default(), None);
        let last = contour.elements().len() - 1;
        for (index, element) in contour.elements().iter().enumerate() {
            let Element { end, shape, .. } = *element;
            let number = match index {
                0 => "N1",
                _ if index == last => "N2",
                _ => "",
            };
            writer.word(number);
            match (self.side, index) {
                (Some(side), 1) => writer.word(&format!("G{side}")),
                (Some(_), _) if index == last => writer.word("G40"),
                _ => {}
            }
            let own = match shape {
                Shape::Rapid => 0,
                Shape::Line => 1,
                Shape::Arc { clockwise, .. } => 3 - u32::from(clockwise),
            };
            if code != Some(own) || random.one_in(2) {
                writer.word(&format!("G{own}"));
            }
            code = Some(own);
            let moves = (end.x != from.x, end.z != from.z);
            let whole = random.one_in(4);
            if moves.0 || (index == 0 && axes.0) || (index > 0 && whole) {
                writer.x(from, end, random);
            }
            if moves.1 || (index == 0 && axes.1) || (index > 0 && whole) {
                writer.z(from, end, random);
            }
            if let Shape::Arc { i, k, .. } = shape {
                writer.length("I", i.nm());
                writer.length("K", k.nm());
            }
            let mut extra = Extra::random(random);
            if self.side.is_some() {
                // The nose is that of the tool.
                extra.other = None;
            }
            extra.write(writer);
            writer.end();
            modes.set(&extra, &mut self.finishing);
            self.finishing.push(modes.cut(end, shape));
            // M9 ends its block, the others begin theirs.
            let many = self.finishing.len();
            if extra.other == Some(Told::M(9)) {
                self.finishing.swap(many - 2, many - 1);
            }
            from = end;
        }
    }

    /// What the program does from its first place on, and the alarm that ends it.
    fn run(&self) -> (Vec<Told>, Option<u16>) {
        let noses = [("nose_radius_3", 400_000), ("nose_direction_3", 3)];
        let params = with(Params::sheets(), &noses);
        let (events, alarm) = read_on(&params, self.control, &self.text);
        let place = |to: &Position| {
            let (x, z) = (to.x.nm(), to.z.nm());
            Point::from_nm(x - self.start.0 * MICROMETRE, z - self.start.1 * MICROMETRE)
        };
        let feed = |feed: FeedRate| {
            Some(match feed {
                FeedRate::PerMinute(feed) => (feed.nm_per_min(), 0),
                FeedRate::PerTurn(feed, rpm) => (feed.nm(), rpm.abs()),
            })
        };
        let told = events.iter().filter_map(|event| {
            let Event::Call(call) = event else {
                return None;
            };
            Some(match &call.kind {
                CallKind::Rapid(to) => Told::Move(place(to), Shape::Rapid, None),
                CallKind::Line(to, rate) => Told::Move(place(to), Shape::Line, feed(*rate)),
                CallKind::Arc(arc) => {
                    let shape = Shape::Arc {
                        i: arc.i,
                        k: arc.k,
                        clockwise: arc.clockwise,
                    };
                    Told::Move(place(&arc.end), shape, feed(arc.feed))
                }
                CallKind::Spindle(speed) => Told::Speed(speed.rpm.abs()),
                CallKind::Aux(Aux::M(code)) => Told::M(*code),
                CallKind::Aux(Aux::T(number)) => Told::Tool(*number),
                CallKind::End(_) => return None,
                other => panic!("{other:?} in {}", self.text),
            })
        });
        let first = Told::Move(Point::default(), Shape::Rapid, None);
        let told = told.skip_while(|told| *told != first).skip(1).collect();
        (told, alarm.map(|alarm| alarm.number()))
    }

    fn check(&self) -> Result<(), String> {
        let (told, alarm) = self.run();
        let many = self.roughing.len();
        is_told("roughs", &self.roughing, &told[..many.min(told.len())])?;
        let cuts = &told[many..];
        match (self.side, alarm) {
            // The nose may not fit into each contour.
            (Some(_), _) => return Ok(()),
            (None, Some(number)) => return Err(format!("refused: {number}")),
            (None, None) => is_told("finishes", &self.finishing, cuts)?,
        }
        self.is_cut_from_what_is_left(cuts)
    }

    /// The finishing cut over the columns that the roughing has left.
    fn is_cut_from_what_is_left(&self, cuts: &[Told]) -> Result<(), String> {
        let case = self.case();
        let contour = case.contour();
        let mut from = Point::default();
        let mut ways = Vec::new();
        for told in cuts {
            if let Told::Move(end, shape, _) = *told {
                let element = Element {
                    end,
                    shape,
                    span: span(1),
                };
                ways.push(Way::of(case, from, &element));
                from = end;
            }
        }
        // The last two lead home and away.
        ways.truncate(ways.len() - 2);
        let columns = if self.code == 73 {
            let cuts = repeated::repeat(&self.copies, &contour)?;
            repeated::judge(&self.copies, &contour, &cuts, &ways)
        } else {
            let cuts = check::rough(case, &contour)?;
            check::judge(case, &contour, &cuts, &ways)
        };
        finished(case, &contour, columns?, &ways)
    }
}

fn finished(case: &Case, contour: &Contour, columns: Columns, ways: &[Way]) -> Result<(), String> {
    let drawn = shifted(case, contour, &Allowance::NONE);
    let end = drawn[drawn.len() - 1].to.1;
    for (l, left, (_, most)) in columns
        .all
        .into_iter()
        .filter(|(l, ..)| (1.0..end).contains(l))
    {
        let (low, high) = near(&drawn, l);
        let mut top = left;
        for way in ways {
            let Some(h) = way.height(l) else { continue };
            if way.rapid && h < top - SLACK && case.pieces[0].l == 0 {
                return Err(format!("finishes at rapid through {} at {l}", top - h));
            }
            if top - h > most - low + SLACK {
                return Err(format!("finishes {} deep at {l}: {way:?}", top - h));
            }
            top = top.min(h);
        }
        if !(low - SLACK..=high + SLACK).contains(&top) {
            return Err(format!("finishes to {top} on {low}..{high} at {l}"));
        }
    }
    Ok(())
}

/// Fails at the first thing that is not what the text says.
fn is_told(what: &str, wanted: &[Told], found: &[Told]) -> Result<(), String> {
    let mut pairs = wanted.iter().zip(found).enumerate();
    if let Some((at, (wanted, found))) = pairs.find(|(_, (wanted, found))| wanted != found) {
        return Err(format!("{what} {found:?} at {at}, and not {wanted:?}"));
    }
    if wanted.len() != found.len() {
        let (wanted, found) = (wanted.len(), found.len());
        return Err(format!("{what} {found} times, and not {wanted}"));
    }
    Ok(())
}

#[test]
fn random_programs_rough_and_finish_what_they_say() {
    leadscrew_seed::volume(70, |seed| {
        let many = leadscrew_seed::amount(1_000, 3_000);
        let mut random = Random(seed);
        let mut tried = [[0; 2]; 3];
        for number in 0..many {
            let program = Program::random(&mut random);
            let nose = usize::from(program.side.is_some());
            tried[program.code as usize - 71][nose] += 1;
            if let Err(why) = program.check() {
                let mut lines = String::new();
                for line in program.text.split(';') {
                    let _ = writeln!(lines, "{line}");
                }
                let (control, case) = (program.control, program.case());
                panic!("case {number}: {why}\n{control:?}\n{lines}\n{case:?}");
            }
        }
        println!("{many} programs with G71, G72, G73, without the nose and with it: {tried:?}");
    });
}
