//! The words of an alarm: a template of the core's table, with its figures in the reader's units.
//!
//! Must know no file, no terminal and no command line: the page in a browser says the same words as `leadscrew`.
//!
//! ```
//! use leadscrew_core::alarm::{Alarm, Code, Lang};
//!
//! let alarm = Alarm::of(Code::EmergencyStop, &[]);
//! assert_eq!(leadscrew_wording::fill(alarm.code.cause(Lang::En), &alarm, Lang::En, false), "emergency stop");
//! ```

pub mod number;

use leadscrew_core::alarm::{Alarm, Arg, Lang};
use leadscrew_core::bus::Statusword;
use leadscrew_core::operating::{Interlock, Zone};

/// Replaces `{0}`…`{3}` and `{w}` in a template with the figures of an alarm.
#[must_use]
pub fn fill(template: &str, alarm: &Alarm, lang: Lang, inch: bool) -> String {
    let figures = |n| alarm.args.get(n).map(|arg| figure(*arg, lang, inch));
    let mut text = fill_with(template, alarm.word, figures);
    // Figures at the end may be absent: an alarm names one axis, or three.
    text.truncate(text.trim_end().len());
    text
}

/// Replaces `{0}`… and `{w}` in a template.
#[must_use]
pub fn fill_with(
    template: &str,
    word: Option<u8>,
    figures: impl Fn(usize) -> Option<String>,
) -> String {
    let mut out = String::with_capacity(template.len() + 32);
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        out.push_str(before);
        let Some((key, after)) = after.split_once('}') else {
            out.push('{');
            rest = after;
            continue;
        };
        match key {
            "w" => out.push(word.map_or('?', char::from)),
            key => match key.parse().ok().and_then(&figures) {
                Some(figure) => out.push_str(&figure),
                // Not a figure: the braces belong to the text.
                None => out.extend(["{", key, "}"]),
            },
        }
        rest = after;
    }
    out.push_str(rest);
    out
}

/// One figure with its unit.
#[must_use]
pub fn figure(arg: Arg, lang: Lang, inch: bool) -> String {
    match arg {
        Arg::None => String::new(),
        Arg::Int(value) => value.to_string(),
        Arg::Length(value) => length(value.nm(), inch),
        Arg::Diameter(value) => length(value.nm(), inch),
        Arg::Angle(value) => format!("{}°", number::text::<6>(value.udeg())),
        Arg::Feed(value) => format!("{}/min", length(value.nm_per_min(), inch)),
        Arg::Rpm(value) => match lang {
            Lang::En => format!("{} rpm", value.get()),
            Lang::Zh => format!("{} r/min", value.get()),
        },
        Arg::Lead(none) => match none {},
        Arg::Percent(value) => format!("{value} %"),
        Arg::Decimal(mantissa, decimals) => written(mantissa, decimals),
        Arg::Letter(letter) => char::from(letter).to_string(),
        Arg::GCode(tenths) if tenths % 10 == 0 => format!("G{:02}", tenths / 10),
        Arg::GCode(tenths) => format!("G{:02}.{}", tenths / 10, tenths % 10),
        Arg::Hex(value) => format!("{value:04X}h"),
        Arg::Key(value) => format!("{value:08X}h"),
        Arg::Statusword(value) => match Statusword::from_raw(value).state() {
            Some(state) => format!("{value:04X}h ({})", state.name()),
            None => format!("{value:04X}h"),
        },
        Arg::Mode(mode) => mode.name().to_owned(),
        Arg::Interlock(interlock) => interlock_words(interlock, lang).to_owned(),
        Arg::Zone(zone) => zone_words(zone, lang).to_owned(),
    }
}

/// A zone.
#[must_use]
pub const fn zone_words(zone: Zone, lang: Lang) -> &'static str {
    match (zone, lang) {
        (Zone::Chuck, Lang::En) => "the chuck",
        (Zone::Chuck, Lang::Zh) => "卡盘",
        (Zone::Jaws, Lang::En) => "the jaws",
        (Zone::Jaws, Lang::Zh) => "卡爪",
        (Zone::Tailstock, Lang::En) => "the tailstock",
        (Zone::Tailstock, Lang::Zh) => "尾座",
    }
}

const fn interlock_words(interlock: Interlock, lang: Lang) -> &'static str {
    match (interlock, lang) {
        (Interlock::Hold, Lang::En) => "feed hold",
        (Interlock::Hold, Lang::Zh) => "进给保持",
        (Interlock::Door, Lang::En) => "the open door",
        (Interlock::Door, Lang::Zh) => "门打开",
        (Interlock::Chuck, Lang::En) => "the open chuck",
        (Interlock::Chuck, Lang::Zh) => "卡盘松开",
        (Interlock::ChuckPressure, Lang::En) => "missing pressure of the chuck",
        (Interlock::ChuckPressure, Lang::Zh) => "卡盘压力缺失",
        (Interlock::TailstockPressure, Lang::En) => "missing pressure of the tailstock",
        (Interlock::TailstockPressure, Lang::Zh) => "尾座压力缺失",
        (Interlock::Enable, Lang::En) => "the enabling switch, which nobody holds,",
        (Interlock::Enable, Lang::Zh) => "使能开关未按住",
        (Interlock::Spindle, Lang::En) => "the spindle, which has not stood for a second,",
        (Interlock::Spindle, Lang::Zh) => "主轴静止未满一秒",
    }
}

/// A length in the program's unit: exact in millimetres, to the tenth of a micro-inch in inches.
fn length(nm: i64, inch: bool) -> String {
    if !inch {
        return format!("{} mm", number::text::<6>(nm));
    }
    // A nanometre is 10⁷ / 25 400 000 = 100 / 254 ten-millionths of an inch.
    let scaled = i128::from(nm) * 100;
    let half = 127 * scaled.signum();
    let value = i64::try_from((scaled + half) / 254).unwrap_or(i64::MAX);
    format!("{} in", number::text::<7>(value))
}

/// A decimal with the digits of its source.
fn written(mantissa: i64, decimals: u8) -> String {
    let digits = format!(
        "{:0width$}",
        mantissa.unsigned_abs(),
        width = usize::from(decimals) + 1
    );
    let (whole, fraction) = digits.split_at(digits.len() - usize::from(decimals));
    let sign = if mantissa < 0 { "-" } else { "" };
    let point = if fraction.is_empty() { "" } else { "." };
    format!("{sign}{whole}{point}{fraction}")
}

#[cfg(test)]
mod tests {
    use leadscrew_core::alarm::{Code, Span};
    use leadscrew_core::units::{Diameter, Length, Rpm};

    use super::*;

    fn alarm() -> Alarm {
        Alarm::new(
            Code::LeadMissing,
            Span {
                line: 1,
                column: 1,
                end: 4,
            },
        )
        .word(b'F')
        .with([
            Arg::Length(Length::from_nm(1_500_000)),
            Arg::Diameter(Diameter::from_nm(60_640_000)),
            Arg::Rpm(Rpm::new(-300)),
            Arg::GCode(760),
        ])
    }

    #[test]
    fn figures_take_their_places() {
        let text = fill(
            "{w}: {0} of {1} at {2} in {3}, {9} {x}",
            &alarm(),
            Lang::En,
            false,
        );
        assert_eq!(text, "F: 1.5 mm of 60.64 mm at -300 rpm in G76, {9} {x}");
        assert_eq!(fill("open {", &alarm(), Lang::En, false), "open {");
    }

    #[test]
    fn inches_are_rounded_only_in_print() {
        assert_eq!(length(25_400_000, true), "1 in");
        assert_eq!(length(1_000_000, true), "0.0393701 in");
        assert_eq!(length(-1_000_000, true), "-0.0393701 in");
    }

    #[test]
    fn decimals_keep_their_digits() {
        assert_eq!(written(1500, 3), "1.500");
        assert_eq!(written(-5, 2), "-0.05");
        assert_eq!(written(7, 0), "7");
    }

    #[test]
    fn every_template_names_only_figures_that_can_be_filled() {
        for code in Code::ALL {
            for lang in [Lang::En, Lang::Zh] {
                for template in [code.cause(lang), code.help(lang)] {
                    let filled = fill(template, &alarm(), lang, false);
                    assert!(
                        !template.is_empty() && !filled.contains(['{', '}']),
                        "{code:?}: {template}"
                    );
                }
            }
        }
    }
}
