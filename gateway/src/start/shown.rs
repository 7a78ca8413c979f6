//! What was shown of a start, told to whoever carries it out: what runs has to be what was shown [D499].
//!
//! ```text
//! axes, parameters, table, kept variables, all that runs ─► a checksum each ─► `--shown` ─► compared before anything moves
//! ```
//!
//! All that runs is made anew of the files, so a subprogram that has changed is another one. It must not know who shows it.

use std::fmt::{self, Display, Write as _};
use std::str::FromStr;

use crc::{CRC_32_ISO_HDLC, Crc, Digest, Table};
use leadscrew_core::link::identity;

use super::{Found, lead, shown};
use crate::failure::{Doing, Failure, Outcome};
use crate::program::Start;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::values::{Mistake, mistake};
use crate::words::{Both, both};

static CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// How many things decide what runs.
const PARTS: usize = 5;

/// A checksum of each thing that decides what runs. As a text: eight hexadecimal digits each, with `-` between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown([u32; PARTS]);

impl Shown {
    /// Of a start that was found. The program is read to its end, as it would be carried out once.
    ///
    /// # Errors
    /// The file cannot be read any further.
    pub fn of(found: Found<'_>, setup: &Setup, source: &SourceFile) -> Outcome<(Start, Self)> {
        let Found { start, mut program } = found;
        let mut runs = Sum::default();
        runs.add(&shown(&start, setup).en);
        runs.add(&format_args!("{start:?}"));
        runs.add(&format_args!("{:?}", lead(&start, setup)));
        loop {
            let next = program.next_event();
            let next = next.map_err(|error| Failure::file(Doing::Read, source.name(), &error))?;
            let Some(event) = next else { break };
            runs.add(&format_args!("{event:?}"));
        }
        let mut variables = Sum::default();
        for (number, value) in setup.variables.values.values() {
            variables.add(&format_args!("#{number} {value:?}"));
        }
        let parts = [
            Sum::of(&format_args!("{:?}", setup.options().position)),
            identity(&setup.params),
            Sum::of(&format_args!("{:?}", setup.offsets)),
            variables.end(),
            runs.end(),
        ];
        Ok((start, Self(parts)))
    }

    /// Refuses what is another one than was shown, and says what has changed.
    ///
    /// # Errors
    /// It is.
    pub fn has_to_be(self, now: Self) -> Outcome {
        let pairs = self.0.into_iter().zip(now.0);
        let differs = pairs.zip(names()).find(|((shown, now), _)| shown != now);
        // The first names the cause: where any of them is another one, so is what runs.
        differs.map_or(Ok(()), |(_, what)| {
            Err(Failure::WrongBecause(both!(
                "not begun: {en} changed since this start was shown: look at it again; nothing has moved",
                "未开始：显示此起点之后，{zh}：请重新查看；机床未移动",
                en = what.en,
                zh = what.zh
            )))
        })
    }
}

/// In the order of the checksums.
fn names() -> [Both; PARTS] {
    [
        both!("the place of the axes has", "坐标轴位置已改变"),
        both!("parameters have", "参数已改变"),
        both!("work offsets or tools have", "工件偏置或刀具已改变"),
        both!("variables that are kept have", "保存的变量已改变"),
        both!(
            "the program, a subprogram or the gear has",
            "程序、子程序或档位已改变"
        ),
    ]
}

impl Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (n, part) in self.0.iter().enumerate() {
            let between = if n == 0 { "" } else { "-" };
            write!(f, "{between}{part:08x}")?;
        }
        Ok(())
    }
}

impl FromStr for Shown {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let part = |text: &str| {
            let is_whole = text.len() == 8 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
            let part = u32::from_str_radix(text, 16).ok();
            part.filter(|_| is_whole)
        };
        let parts: Option<Vec<u32>> = text.split('-').map(part).collect();
        let parts = parts.and_then(|parts| parts.try_into().ok());
        parts.map(Self).ok_or_else(|| {
            mistake!(
                "it is what a panel has told of a start",
                "应为面板给出的起点校验值"
            )
        })
    }
}

/// A checksum of texts, each with its end.
struct Sum(Digest<'static, u32, Table<16>>);

impl Default for Sum {
    fn default() -> Self {
        Self(CRC.digest())
    }
}

impl Sum {
    fn of(text: &dyn Display) -> u32 {
        let mut sum = Self::default();
        sum.add(text);
        sum.end()
    }

    fn add(&mut self, text: &dyn Display) {
        // It takes every text.
        let _ = writeln!(self, "{text}");
    }

    fn end(self) -> u32 {
        self.0.finalize()
    }
}

impl fmt::Write for Sum {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_what_it_was_made_of_and_every_other_one_is_refused() {
        let shown = Shown([0, 1, 0xdead_beef, u32::MAX, 7]);
        let text = shown.to_string();
        assert_eq!(text, "00000000-00000001-deadbeef-ffffffff-00000007");
        assert_eq!(text.parse(), Ok(shown));
        for wrong in [
            "",
            "0-1-2-3-4",
            &text[9..],
            &format!("{text}-{text}"),
            &text.replace("0-", "x-"),
        ] {
            assert!(wrong.parse::<Shown>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_has_changed_is_named() {
        let shown = Shown([1, 2, 3, 4, 5]);
        assert!(shown.has_to_be(shown).is_ok());
        let parts = [
            "the place of the axes",
            "parameters",
            "work offsets",
            "variables",
            "a subprogram",
        ];
        for (n, name) in parts.into_iter().enumerate() {
            // What runs is made of all of the others.
            let mut now = shown;
            now.0[4] = 0;
            now.0[n] = 0;
            let words = shown.has_to_be(now).unwrap_err().words().unwrap();
            assert!(words.en.contains(name), "{}", words.en);
        }
    }
}
