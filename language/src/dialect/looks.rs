//! Which control a text looks as if it was written for.
//!
//! Some codes and words belong to one control, or mean nothing in another. Each gives points; a text that has five, and
//! three more than the control that was set, is told of. Nothing is changed by it.

use super::Control;

/// Points from which a control is told, and how far before the one that was set.
const ENOUGH: u32 = 5;
const AHEAD: u32 = 3;

/// What the blocks so far have shown.
#[derive(Clone, Debug, Default)]
pub struct Looks {
    /// Points, and the line of the first of them, in the order of [`Control::ALL`].
    seen: [(u32, u32); Control::ALL.len()],
    /// A T of three digits was there. Each program with one has several, and other controls read them too: one counts.
    short_tool: bool,
    /// A line that Mach and LinuxCNC alone read.
    foreign: bool,
}

/// A word: its letter, its number, and how that is written.
pub(super) struct Word {
    pub(super) letter: u8,
    pub(super) value: f64,
    pub(super) has_point: bool,
    digits: usize,
    /// Byte of the letter in its line.
    pub(super) from: usize,
    /// Byte behind the number.
    pub(super) to: usize,
}

/// The words of a block.
pub(super) struct Words(pub(super) Vec<Word>);

impl Words {
    /// Reads a line without its comments. What is no plain number is passed over.
    pub(super) fn of(text: &[u8]) -> Self {
        let mut words = Vec::new();
        let (mut at, mut depth) = (0, 0_u32);
        while let Some(byte) = text.get(at) {
            at += 1;
            match byte {
                b'(' => depth += 1,
                b')' => depth = depth.saturating_sub(1),
                b';' if depth == 0 => break,
                letter if depth == 0 && letter.is_ascii_alphabetic() => {
                    let rest = &text[at..];
                    let is_part = |byte: &u8| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+');
                    let end = rest.iter().position(|byte| !is_part(byte));
                    let number = &rest[..end.unwrap_or(rest.len())];
                    let value = std::str::from_utf8(number).ok();
                    if let Some(value) = value.and_then(|text| text.parse::<f64>().ok()) {
                        words.push(Word {
                            letter: letter.to_ascii_uppercase(),
                            value,
                            has_point: number.contains(&b'.'),
                            digits: number.len(),
                            from: at - 1,
                            to: at + number.len(),
                        });
                    }
                    at += number.len();
                }
                _ => {}
            }
        }
        Self(words)
    }

    fn has(&self, letters: &[u8]) -> bool {
        self.0.iter().any(|word| letters.contains(&word.letter))
    }

    fn code(&self, letter: u8, codes: &[u16]) -> bool {
        let is = |word: &Word| {
            word.letter == letter && codes.iter().any(|code| word.value == f64::from(*code))
        };
        self.0.iter().any(is)
    }

    fn g(&self, codes: &[u16]) -> bool {
        self.code(b'G', codes)
    }

    /// A T of three digits.
    fn short_tool(&self) -> bool {
        let is = |word: &Word| word.letter == b'T' && word.digits == 3 && !word.has_point;
        self.0.iter().any(is)
    }
}

/// True for a line that Mach or LinuxCNC alone read: X as a diameter by G7, a thread by their G76, a named variable, a flow
/// of O words.
fn is_foreign(text: &[u8], words: &Words) -> bool {
    const FLOW: [&[u8]; 6] = [
        b"endsub",
        b"endwhile",
        b"endif",
        b"endrepeat",
        b"call",
        b"while",
    ];
    let thread = b"PZIJRK".iter().all(|letter| words.has(&[*letter]));
    if words.g(&[7]) || words.g(&[76]) && thread {
        return true;
    }
    let code = text.split(|byte| matches!(byte, b'(' | b';')).next();
    let code = code.unwrap_or_default();
    let plain = code.iter().filter(|byte| !byte.is_ascii_whitespace());
    let plain: Vec<u8> = plain.map(u8::to_ascii_lowercase).collect();
    let number = |byte: &u8| byte.is_ascii_digit();
    let behind_number = match plain.strip_prefix(b"o") {
        Some(rest) => &rest[rest.iter().take_while(|byte| number(byte)).count()..],
        None => &[],
    };
    plain.windows(2).any(|pair| pair == b"#<")
        || FLOW.iter().any(|word| behind_number.starts_with(word))
}

impl Looks {
    /// Looks at a line.
    pub fn line(&mut self, number: u32, text: &[u8]) {
        use Control::{FanucA, FanucB, FanucC, Gsk980td, Gsk988, Haas};
        let words = Words::of(text);
        self.foreign |= is_foreign(text, &words);
        let axes = words.has(b"XUZW");
        let pq = words.has(b"P") && words.has(b"Q");
        let first_short_tool = words.short_tool() && !self.short_tool;
        self.short_tool |= first_short_tool;
        let mut add = |controls: &[Control], points: u32| {
            for (place, control) in self.seen.iter_mut().zip(Control::ALL) {
                if controls.contains(&control) {
                    *place = (
                        place.0 + points,
                        if place.0 == 0 { number } else { place.1 },
                    );
                }
            }
        };
        if words.g(&[77, 79]) && axes || words.g(&[78]) && axes && !words.has(b"PQ") {
            add(&[FanucB], 4);
        }
        if words.g(&[78]) && words.has(b"PQ") {
            add(&[Gsk980td, Gsk988], 5);
            add(&[FanucC], 3);
        }
        if words.g(&[20, 21, 24]) && axes && words.has(b"F") {
            add(&[FanucC], 6);
        }
        if words.g(&[94, 95]) && !axes {
            add(&[FanucB, FanucC], 3);
        }
        if words.g(&[92]) && words.has(b"S") && !axes {
            add(&[FanucB, FanucC], 5);
        }
        if words.g(&[33]) {
            add(&[FanucB, FanucC], 2);
        }
        if words.g(&[70]) && !words.has(b"PQ") {
            add(&[FanucC], 5);
        }
        if words.g(&[90, 91]) && !axes && !words.has(b"FR") {
            add(&[FanucB, FanucC], 2);
        }
        if words.g(&[71, 72]) && pq && words.has(b"D") {
            let point = words
                .0
                .iter()
                .any(|word| word.letter == b'D' && word.has_point);
            add(&[Haas], if point { 6 } else { 4 });
            add(&[FanucA], 4);
        }
        if words.g(&[76]) && words.has(b"K") && words.has(b"D") {
            add(&[Haas], 5);
            add(&[FanucA], 3);
        }
        if words.code(b'M', &[97])
            || words.g(&[112])
            || words.g(&[53]) && words.g(&[0])
            || first_short_tool
        {
            add(&[Haas], 2);
        }
        if words.g(&[1]) && axes && words.has(b"LD") {
            add(&[Gsk980td, Gsk988], 3);
        }
        if words.g(&[65]) && words.has(b"H") {
            add(&[Gsk980td, Gsk988], 4);
        }
        if words.g(&[32, 92]) && axes && words.has(b"JK") {
            add(&[Gsk980td, Gsk988], 3);
        }
        if words.g(&[30]) && words.code(b'P', &[99]) {
            add(&[Gsk980td, Gsk988], 5);
        }
    }

    /// The text is clearly for Mach or LinuxCNC, which none of the controls is.
    #[must_use]
    pub const fn is_foreign(&self) -> bool {
        self.foreign
    }

    /// The control that the text looks like, where it is another than the one that was set; with the first line that says
    /// so.
    #[must_use]
    pub fn like(&self, set: Control) -> Option<(Control, u32)> {
        let all = || Control::ALL.into_iter().zip(self.seen);
        if self.foreign {
            return None;
        }
        let own = all().find(|(control, _)| *control == set);
        let own = own.map_or(0, |(_, seen)| seen.0);
        let best = all().map(|(_, seen)| seen.0).max()?;
        let (control, (points, line)) = all().find(|(_, seen)| seen.0 == best)?;
        (points >= ENOUGH && points >= own + AHEAD).then_some((control, line))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn like(text: &str, set: Control) -> Option<(Control, u32)> {
        let mut looks = Looks::default();
        for (number, line) in (1..).zip(text.split(';')) {
            looks.line(number, line.as_bytes());
        }
        looks.like(set)
    }

    #[test]
    fn a_text_for_none_of_the_controls_shows_it() {
        let is = |text: &str| {
            let mut looks = Looks::default();
            for (number, line) in (1..).zip(text.split(';')) {
                looks.line(number, line.as_bytes());
            }
            assert!(!looks.is_foreign() || looks.like(Control::Haas).is_none());
            looks.is_foreign()
        };
        for text in [
            "G40 G90 G94;G7",
            "G21;G07 G90",
            "G76 P1.5 Z-20 I-1 J0.2 R1.5 K0.92 Q29.5 H2 E1 L2",
            "o100 sub;G0 X5;o100 endsub",
            "O100 call [5]",
            "o101 while [#1 LT 3]",
            "#<dia> = 20",
            "G0 X[#<_dia>+2]",
        ] {
            assert!(is(text), "{text}");
        }
        for text in [
            "G8 P1",
            "G76 X17.5 Z-25 I-1 K1.2 D0.4 F2 A60 P2",
            "G76 P010060 Q100 R0.05",
            "O100 SUB",
            "O0100;WHILE[#1LT3]DO1",
            "O1 (O2 CALL #<X>)",
            "IF[#1<2]GOTO3",
            "G71 P1 Q2 U.4 W.1 D1.5 F.2 I.1 K.1",
        ] {
            assert!(!is(text), "{text}");
        }
    }

    #[test]
    fn a_text_shows_its_control() {
        let set = Control::Gsk980td;
        for (text, control, line) in [
            ("G0 X50;G77 X40 Z-5 F.2;G79 X0 Z0 F.2", Control::FanucB, 2),
            ("G92 S2000;G95", Control::FanucB, 1),
            ("G70;G21 X30 Z-5 F2", Control::FanucC, 1),
            ("T101;G76 X17 Z-25 K1.2 D0.4 F2", Control::Haas, 1),
            ("G71 P1 Q2 U.4 W.1 D1.5 F.2", Control::Haas, 1),
        ] {
            assert_eq!(like(text, set), Some((control, line)), "{text}");
            assert_eq!(like(text, control), None, "{text}");
        }
        let gsk = "G78 P010060 Q.1 R.05;G78 X28 Z-20 P1 Q.3 F1.5";
        assert_eq!(like(gsk, Control::FanucA), Some((Control::Gsk980td, 1)));
        assert_eq!(like(gsk, set), None);
        // Not in comments, and not by what every control has.
        for text in [
            "(G77 X1 F1);(G79 X1 F1)",
            "G20;G21;G90 X40 Z-5 F.2;X38",
            "G50 S2000;G96 S150;G98 G1 X1 F100",
            "G71 U2 R.5;G71 P1 Q2 U.4 W.1;G70 P1 Q2",
            "T0101;T0202;T0303;T0404",
            "T101;T202;T303;T404",
        ] {
            assert_eq!(like(text, set), None, "{text}");
        }
    }
}
