//! One block of a control becomes a block of system A.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::units::Decimal;

use super::codes::leave_out;
use super::{Control, one_line};
use crate::flow::Modes;
use crate::value::Value;
use crate::word::{Given, Word};

/// What is in force at a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The code of group 01, of system A.
    pub motion: u8,
    /// Decimals of the input increment of a length.
    pub increment: u8,
    /// P and Q of G74 to G76 count increments on a GSK 980TD.
    pub counts: bool,
    /// A tapping cycle is in force, whose words come without its code.
    pub holes: bool,
    /// A drilling cycle is, and its words too.
    pub drills: bool,
    /// Lengths are inches.
    pub inch: bool,
    /// The feed is per turn.
    pub per_turn: bool,
    /// A number without a point counts increments.
    pub counts_increments: bool,
    /// C beside X or Z of a line is the axis: the spindle stands, and no contour is read.
    pub c_is_axis: bool,
}

impl Default for Setting {
    fn default() -> Self {
        Self {
            motion: 0,
            increment: 3,
            counts: false,
            holes: false,
            drills: false,
            inch: false,
            per_turn: false,
            counts_increments: false,
            c_is_axis: false,
        }
    }
}

/// Reads the blocks of a control.
#[derive(Clone, Copy, Debug)]
pub struct Translator {
    control: Control,
    /// The control of the program that was started.
    machine: Control,
    /// G91.
    incremental: bool,
    /// G99 of the systems B and C: a hole ends at R.
    returns_to_r: bool,
    /// M24 of a Haas: threads have no run-out.
    without_run_out: bool,
}

impl Translator {
    /// At the beginning of a program: G90, G98 of the systems B and C.
    #[must_use]
    pub const fn new(control: Control) -> Self {
        Self {
            control,
            machine: control,
            incremental: false,
            returns_to_r: false,
            without_run_out: false,
        }
    }

    /// Puts in force what the text before has left.
    pub const fn carry(&mut self, modes: Modes) {
        self.incremental = modes.incremental;
        self.without_run_out = modes.without_run_out;
    }

    /// The control.
    #[must_use]
    pub const fn control(&self) -> Control {
        self.control
    }

    /// Reads the blocks of another file from now on. G91 and G99 of the systems B and C stay in force for such files.
    pub const fn read_as(&mut self, control: Control) {
        self.control = control;
    }

    /// What is in force for blocks of the control that is read now.
    #[must_use]
    pub const fn modes(&self) -> Modes {
        let has_b = self.control.has_system_b();
        Modes {
            incremental: self.incremental && has_b,
            returns_to_r: self.returns_to_r && has_b,
            without_run_out: self.without_run_out && matches!(self.control, Control::Haas),
            calls: false,
        }
    }

    /// Turns the words of a block into those of system A. Gives M23 or M24, where it is the latest M of the block: the
    /// machine does not see it.
    ///
    /// # Errors
    /// A code that this control does not have, or a count with a point.
    pub fn translate(&mut self, words: &mut Vec<Word>, now: Setting) -> Result<Option<u16>, Alarm> {
        let heard = if self.control == Control::Haas {
            self.chamfers(words)
        } else {
            None
        };
        self.rest(words, now).map(|()| heard)
    }

    /// The same without M23 and M24.
    fn rest(&mut self, words: &mut Vec<Word>, now: Setting) -> Result<(), Alarm> {
        leave_out(words, self.control);
        refuse_decimal_codes(words)?;
        let increments = !self.control.is_gsk() && self.codes(words)?;
        if self.control.limits_every_speed() != self.machine.limits_every_speed() {
            refuse_speed_limit(words)?;
        }
        let motion = motion_of(words, now);
        let alone = !now.holes && !goes_on_drilling(words, now) && !words.iter().any(is_one_shot);
        if self.control.is_gsk() {
            if alone && matches!(motion, 1..=3) {
                corners_of_gsk(words);
            }
            return refuse_angle(words);
        }
        if alone && motion == 32 {
            refuse_run_out(words)?;
        }
        if alone && motion == 1 {
            let c_is_axis = now.c_is_axis && !words.iter().any(starts_spindle);
            corners(words, c_is_axis);
        } else {
            refuse_angle(words)?;
        }
        if increments {
            count_from_here(words);
        }
        if self.control == Control::Haas {
            of_haas(words, motion, alone, now.holes);
            return refuse_turns_per_inch(words, self.control, motion, alone);
        }
        if self.control == Control::FanucA && alone {
            old_tapers(words, motion);
        }
        refuse_turns_per_inch(words, self.control, motion, alone)?;
        of_fanuc(words, self.control, now)
    }

    /// M23 and M24 of a Haas: threads with and without a run-out. Gives it where it is the latest M of the block.
    fn chamfers(&mut self, words: &[Word]) -> Option<u16> {
        let codes = words.iter().filter(|word| word.letter == b'M');
        let mut heard = None;
        for code in codes.filter_map(|word| word.value().whole()) {
            heard = match code {
                23 => Some(23),
                24 => Some(24),
                _ => None,
            };
            if let Some(code) = heard {
                self.without_run_out = code == 24;
            }
        }
        heard
    }

    /// The G codes. True where the axis words of the block count from where the tool is.
    fn codes(&mut self, words: &mut Vec<Word>) -> Result<bool, Alarm> {
        let (control, mut here) = (self.control, None);
        let mut wrong = None;
        words.retain_mut(|word| {
            let Some(code) = code_of(word) else {
                return true;
            };
            match code {
                90 | 91 if control.has_system_b() => self.incremental = code == 91,
                98 | 99 if control.has_system_b() => self.returns_to_r = code == 99,
                91 if control == Control::Haas => here = Some(*word),
                _ => {
                    match control.to_a(code) {
                        Some(a) if a != code => word.given = Given::Written(Decimal::new(a, 0)),
                        Some(_) => {}
                        None => {
                            let named = u16::try_from(code.saturating_mul(10)).unwrap_or(0);
                            let alarm = word.alarm(Code::UnknownG).with([Arg::GCode(named)]);
                            wrong.get_or_insert(alarm);
                        }
                    }
                    return true;
                }
            }
            false
        });
        // G91 of a Haas is in force for the words of its block, and alone it would change nothing [D543].
        if let Some(word) = here
            && !words.iter().any(|word| b"XUZWCH".contains(&word.letter))
            && !has_code(words, 28)
            && !has_code(words, 30)
        {
            let alarm = word.alarm(Code::GNotAvailable);
            wrong.get_or_insert(alarm.with([Arg::GCode(910)]));
        }
        let incremental = self.incremental && control.has_system_b();
        wrong.map_or(Ok(here.is_some() || incremental), Err)
    }
}

/// The code of a G word.
pub(crate) fn code_of(word: &Word) -> Option<i64> {
    (word.letter == b'G').then(|| word.value().whole())?
}

/// True with this G code in the block.
pub(crate) fn has_code(words: &[Word], code: i64) -> bool {
    words.iter().any(|word| code_of(word) == Some(code))
}

/// M03 and M04.
fn starts_spindle(word: &Word) -> bool {
    word.letter == b'M' && matches!(word.value().whole(), Some(3 | 4))
}

/// M19.
pub(crate) fn is_m19(word: &Word) -> bool {
    word.letter == b'M' && word.value().whole() == Some(19)
}

/// True for a block that brings the spindle to an angle and moves nothing.
pub(super) fn orients(words: &[Word]) -> bool {
    let moves = |word: &Word| b"XUZWCH".contains(&word.letter) || is_one_shot(word);
    words.iter().any(is_m19) && !words.iter().any(moves)
}

/// The codes of group 01 that are motions, a cycle before a plain one.
const MOTIONS: [i64; 9] = [90, 92, 94, 32, 34, 0, 1, 2, 3];

/// The code of group 01 that is in force in a block.
pub(super) fn motion_of(words: &[Word], now: Setting) -> i64 {
    let written = MOTIONS.into_iter().find(|motion| has_code(words, *motion));
    written.unwrap_or_else(|| i64::from(now.motion))
}

/// True for a block of the drilling cycle in force, without its code.
fn goes_on_drilling(words: &[Word], now: Setting) -> bool {
    let ends = |word: &Word| code_of(word).is_some_and(|code| MOTIONS.contains(&code));
    now.drills && !words.iter().any(|word| ends(word) || is_one_shot(word))
}

/// True for a code that gives the axis words of its block another meaning than motion.
pub(super) fn is_one_shot(word: &Word) -> bool {
    let call = word.letter == b'M' && matches!(word.value().whole(), Some(97 | 98));
    call || matches!(
        code_of(word),
        Some(4 | 10 | 28 | 30 | 50 | 53 | 65 | 66 | 70..=76 | 78 | 80..=89)
    )
}

/// G12.1, G84.1 and their like: the alarm names them.
fn refuse_decimal_codes(words: &[Word]) -> Result<(), Alarm> {
    for word in words.iter().filter(|word| word.letter == b'G') {
        if let Given::Written(number) = word.given
            && number.decimals() == 1
            && let Ok(tenths @ 1..) = u16::try_from(number.mantissa())
            && tenths % 10 != 0
        {
            return Err(word.alarm(Code::GNotAvailable).with([Arg::GCode(tenths)]));
        }
    }
    Ok(())
}

/// `,A` in a block that is no line of a FANUC or a Haas.
fn refuse_angle(words: &[Word]) -> Result<(), Alarm> {
    match words.iter().find(|word| word.letter == Word::ANGLE) {
        Some(word) => Err(Alarm::new(Code::WordWithoutUse, word.span).word(b'A')),
        None => Ok(()),
    }
}

/// S of G50 in a file of another control, which limits other speeds than that of the program does [D273].
fn refuse_speed_limit(words: &[Word]) -> Result<(), Alarm> {
    let speed = words.iter().find(|word| word.letter == b'S');
    match speed.filter(|_| has_code(words, 50)) {
        Some(word) => Err(word
            .alarm(Code::SpeedLimitElsewhere)
            .with([Arg::GCode(500)])),
        None => Ok(()),
    }
}

/// J and K of a stroke of G32, which are words of a GSK. (K of G34 is another word.)
fn refuse_run_out(words: &[Word]) -> Result<(), Alarm> {
    match words.iter().find(|word| matches!(word.letter, b'J' | b'K')) {
        Some(word) => Err(word
            .alarm(Code::StrokeWithoutRunOut)
            .with([Arg::Letter(word.letter), Arg::GCode(320)])),
        None => Ok(()),
    }
}

/// I of a thread that is not one line of G76: turns per inch of a GSK, which an old FANUC takes for a taper [D440].
fn refuse_turns_per_inch(
    words: &[Word],
    control: Control,
    motion: i64,
    alone: bool,
) -> Result<(), Alarm> {
    let two_lines = [76, 78].into_iter().find(|code| has_code(words, *code));
    let code = match two_lines {
        Some(code) if !one_line::is_thread(words, control) => code,
        None if alone && matches!(motion, 32 | 34 | 92) => motion,
        _ => return Ok(()),
    };
    let is_written = |word: &&Word| word.letter == b'I' && !word.value().is_null();
    match words.iter().find(is_written) {
        Some(word) => {
            let code = u16::try_from(code * 10).unwrap_or(0);
            Err(word.alarm(Code::TurnsPerInch).with([Arg::GCode(code)]))
        }
        None => Ok(()),
    }
}

/// I of G90 and K of G94 in an old FANUC: the taper.
fn old_tapers(words: &mut [Word], motion: i64) {
    for word in words {
        if let (b'I', 90) | (b'K', 94) = (word.letter, motion) {
            word.letter = b'R';
        }
    }
}

/// G91: X, Z and C become U, W and H, where they are no coordinates, times or arguments.
fn count_from_here(words: &mut [Word]) {
    const ELSEWHERE: [i64; 6] = [4, 10, 50, 53, 65, 66];
    let call = |word: &Word| {
        word.letter == b'M' && matches!(word.value().whole(), Some(97 | 98))
            || code_of(word).is_some_and(|code| ELSEWHERE.contains(&code))
    };
    if words.iter().any(call) {
        return;
    }
    for word in words {
        word.letter = match word.letter {
            b'X' => b'U',
            b'Z' => b'W',
            b'C' => b'H',
            other => other,
        };
    }
}

/// Counts of increments as lengths.
fn of_fanuc(words: &mut [Word], control: Control, now: Setting) -> Result<(), Alarm> {
    let axes = words
        .iter()
        .any(|word| matches!(word.letter, b'X' | b'U' | b'Z' | b'W'));
    let goes_on = now.holes && !words.iter().any(is_one_shot);
    let taps = goes_on || has_code(words, 84) || has_code(words, 88);
    let letters: &[u8] = if has_code(words, 74) || has_code(words, 75) {
        b"PQD"
    } else if has_code(words, 76) {
        // P of the first line has digits.
        if axes { b"PQD" } else { b"Q" }
    } else if has_code(words, 71) || has_code(words, 72) {
        b"D"
    } else if taps || has_code(words, 83) || has_code(words, 87) || goes_on_drilling(words, now) {
        b"Q"
    } else {
        return Ok(());
    };
    // P of the one-line G76 is the way of the infeed, and Q its start angle.
    let one_line = one_line::is_thread(words, control);
    for word in words {
        if letters.contains(&word.letter) && !(one_line && word.letter != b'D') {
            word.given = counted(word, now.increment, taps)?;
        }
    }
    Ok(())
}

/// A count of increments as a length. With a point D, and Q of a tap, are lengths as they stand [D544].
fn counted(word: &Word, increment: u8, taps: bool) -> Result<Given, Alarm> {
    let steps = libm::pow(10.0, f64::from(increment));
    Ok(match word.given {
        Given::Written(number) if number.has_point() && word.letter != b'D' && !taps => {
            // With a point behind them they are a count all the same: nobody pecks by 0.1 m.
            let count = match number.scaled(0) {
                Ok(whole @ 100..) => whole,
                _ => in_steps(number, increment),
            };
            let figures = [Arg::Int(count), Arg::Letter(word.letter)];
            return Err(word.alarm(Code::PointInIncrements).with(figures));
        }
        Given::Written(number) if number.has_point() => Given::Written(number),
        Given::Written(number) => Given::Written(Decimal::new(number.mantissa(), increment)),
        Given::Calculated(Value::Null) => word.given,
        Given::Calculated(Value::Number(number)) => {
            Given::Calculated(Value::Number(libm::round(number) / steps))
        }
        Given::Calculated(Value::Increments(count)) => {
            Given::Calculated(Value::Number(count / steps))
        }
    })
}

/// How many increments a number is; what is finer is rounded.
fn in_steps(number: Decimal, increment: u8) -> i64 {
    number.scaled(increment).unwrap_or_else(|_| {
        let finer = number.decimals().saturating_sub(increment);
        let step = 10_i64.saturating_pow(finer.into());
        (number.mantissa() + step / 2 * number.mantissa().signum()) / step
    })
}

/// G28 without an axis, which is X and Z from where they are, and the words that a Haas writes with another letter.
fn of_haas(words: &mut Vec<Word>, motion: i64, alone: bool, taps: bool) {
    let names_axis = |word: &Word| b"XUZWCH".contains(&word.letter);
    if let Some(home) = words.iter().find(|word| code_of(word) == Some(28)).copied()
        && !words.iter().any(names_axis)
    {
        words.extend([b'U', b'W'].map(|letter| Word {
            letter,
            given: Given::Written(Decimal::new(0, 0)),
            variable: None,
            span: home.span,
        }));
    }
    let orients = orients(words);
    let dwell = has_code(words, 4);
    let taps = !dwell && (taps || has_code(words, 84) || has_code(words, 88));
    for word in words {
        if taps && word.letter == b'P' {
            *word = in_milliseconds(word);
        }
        let point = matches!(word.given, Given::Written(number) if number.has_point());
        word.letter = match (word.letter, motion) {
            (b'P', _) if dwell && point => b'X',
            (b'P', _) if orients => b'R',
            (b'I', 90 | 92) | (b'K', 94) if alone => b'R',
            (b'E', 92 | 32 | 34) if alone => b'F',
            (letter, _) => letter,
        };
    }
}

/// P of a dwell in a Haas: with a point it is seconds.
pub(crate) fn in_milliseconds(word: &Word) -> Word {
    let given = match word.given {
        Given::Written(number) if number.has_point() => match number.scaled(3) {
            Ok(count) => Given::Written(Decimal::new(count, 0)),
            Err(_) => word.given,
        },
        given => given,
    };
    Word { given, ..*word }
}

/// `L` and `D` of a cut: a chamfer and a rounding at its end.
fn corners_of_gsk(words: &mut [Word]) {
    for word in words {
        word.letter = match word.letter {
            b'L' => Word::CHAMFER_L,
            b'D' => Word::ROUND,
            letter => letter,
        };
    }
}

/// `C`, `I`, `K` and `R` of a straight cut along one axis: a corner at its end, whose sign says where the next motion goes.
/// Beside the angle of a line the corner is that of `,C` and `,R`. `C` may be the axis [D566].
fn corners(words: &mut [Word], c_is_axis: bool) {
    let has = |letters: &[u8]| words.iter().any(|word| letters.contains(&word.letter));
    if has(&[b'A', Word::ANGLE]) {
        for word in words {
            word.letter = match word.letter {
                b'A' => Word::ANGLE,
                b'C' => Word::CHAMFER,
                b'R' => Word::ROUND,
                letter => letter,
            };
        }
        return;
    }
    let (along_x, along_z) = (has(b"XU"), has(b"ZW"));
    if along_x == along_z {
        return;
    }
    for word in words {
        word.letter = match word.letter {
            b'C' if !c_is_axis => Word::CHAMFER_TOWARD,
            b'I' if along_z => Word::CHAMFER_TOWARD,
            b'K' if along_x => Word::CHAMFER_TOWARD,
            b'R' => Word::ROUND_TOWARD,
            letter => letter,
        };
    }
}
