//! The orders of a page: by their names, and what belongs to each. Levels, no toggles: who orders twice has what he wants.

use leadscrew_core::bus::{BoardCommand, Order};
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::units::Axes;
use serde_json::Value;

use super::super::monitor::keys::INCREMENTS;
use super::desk::StartAt;
use crate::cli::{AxisWay, OverrideName, StepLength};

/// No block is longer.
const LONGEST_LINE: usize = 200;

/// What a page wants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// An order of its own.
    Order(Order),
    /// Overrides and switches.
    Levels(BoardCommand),
    /// One step.
    Step(AxisWay, StepLength),
    /// A line is carried out.
    Line {
        /// The line.
        text: String,
        /// Its answer is to be Chinese.
        zh: bool,
    },
    /// A tap is brought out of its hole.
    Retract {
        /// Turns per minute of the spindle; none: the slow speed of the way out.
        speed: Option<u32>,
        /// Its answer is to be Chinese.
        zh: bool,
    },
    /// A program of the panel's folder is sent and begun.
    Program {
        /// Its name.
        name: String,
        /// The tag of the text that the page shows.
        tag: String,
        /// The line that it is started at, as the page was shown it.
        start: Option<StartAt>,
        /// It follows a handwheel.
        wheel: bool,
        /// Its answer is to be Chinese.
        zh: bool,
    },
}

impl Wish {
    /// The wish of this name; `None`: there is none, or what belongs to it is wrong.
    pub fn of(op: &str, args: &Value) -> Option<Self> {
        let override_of = |what: OverrideName| {
            let (low, high) = what.range();
            let percent = u8::try_from(args["percent"].as_u64()?).ok()?;
            (low..=high).contains(&percent).then_some(percent)
        };
        let levels = BoardCommand::default();
        Some(match op {
            "hold" => Self::Order(Order::Hold),
            "stop" => Self::Order(Order::Stop),
            "start" => Self::Order(Order::Run),
            "resume" => Self::Order(Order::Resume),
            "reset" => Self::Order(Order::Reset),
            "home" => Self::Order(Order::Home(Axes::NONE)),
            "mode" => Self::Order(Order::Mode(mode(args["mode"].as_str()?)?)),
            "feed" => Self::Levels(BoardCommand {
                feed: Some(override_of(OverrideName::Feed)?),
                ..levels
            }),
            "rapid" => Self::Levels(BoardCommand {
                rapid: Some(override_of(OverrideName::Rapid)?),
                ..levels
            }),
            "spindle" => Self::Levels(BoardCommand {
                spindle: Some(override_of(OverrideName::Spindle)?),
                ..levels
            }),
            "single" => Self::Levels(BoardCommand {
                single_block: Some(args["on"].as_bool()?),
                ..levels
            }),
            "step" => {
                let way = args["axis"].as_str()?.parse().ok()?;
                let length: StepLength = args["by"].as_str()?.parse().ok()?;
                // A longer one would live by frames of its own.
                INCREMENTS
                    .contains(&length)
                    .then_some(Self::Step(way, length))?
            }
            "mdi" => {
                let text = args["line"].as_str()?.trim();
                let fits = !text.is_empty() && text.len() <= LONGEST_LINE;
                let obeyed = text.chars().any(crate::words::is_obeyed);
                (fits && !obeyed).then(|| Self::Line {
                    text: text.to_owned(),
                    zh: args["zh"] == true,
                })?
            }
            "retract" => Self::Retract {
                speed: match &args["speed"] {
                    Value::Null => None,
                    speed => Some(speed.as_u64()?.try_into().ok().filter(|rpm| *rpm > 0)?),
                },
                zh: args["zh"] == true,
            },
            "program" => Self::Program {
                name: args["name"].as_str()?.to_owned(),
                tag: args["tag"].as_str()?.to_owned(),
                start: match &args["start"] {
                    Value::Null => None,
                    start => Some(start_at(start)?),
                },
                // What is no flag is refused: without the wheel it would run at its feed.
                wheel: match &args["wheel"] {
                    Value::Null => false,
                    wheel => wheel.as_bool()?,
                },
                zh: args["zh"] == true,
            },
            _ => return None,
        })
    }

    /// Hold and stop.
    pub const fn halts(&self) -> bool {
        matches!(self, Self::Order(Order::Hold | Order::Stop))
    }

    /// A process of its own begins with it, which a hold of a machine at rest does not keep.
    pub const fn begins(&self) -> bool {
        matches!(
            self,
            Self::Line { .. } | Self::Retract { .. } | Self::Program { .. }
        )
    }

    /// It is ordered by what the page shows, so that must not be old.
    pub const fn needs_fresh(&self) -> bool {
        !matches!(self, Self::Order(Order::Hold | Order::Stop | Order::Reset))
    }
}

fn start_at(start: &Value) -> Option<StartAt> {
    Some(StartAt {
        line: u32::try_from(start["line"].as_u64()?).ok()?,
        shown: start["shown"].as_str()?.parse().ok()?,
    })
}

fn mode(name: &str) -> Option<OperatingMode> {
    OperatingMode::ALL
        .into_iter()
        .find(|mode| mode.name() == name)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn orders_are_levels_within_their_ranges() {
        for (op, args, wish) in [
            ("hold", Value::Null, Some(Wish::Order(Order::Hold))),
            ("start", json!({}), Some(Wish::Order(Order::Run))),
            (
                "mode",
                json!({"mode": "reference"}),
                Some(Wish::Order(Order::Mode(OperatingMode::Reference))),
            ),
            ("mode", json!({"mode": "next"}), None),
            (
                "feed",
                json!({"percent": 150}),
                Some(Wish::Levels(BoardCommand {
                    feed: Some(150),
                    ..BoardCommand::default()
                })),
            ),
            ("feed", json!({"percent": 151}), None),
            ("feed", json!({"percent": -1}), None),
            ("rapid", json!({"percent": 101}), None),
            ("spindle", json!({"percent": 49}), None),
            ("single", json!({}), None),
            ("toggle", json!({}), None),
            ("", Value::Null, None),
        ] {
            assert_eq!(Wish::of(op, &args), wish, "{op} {args}");
        }
    }

    #[test]
    fn a_program_is_named_with_the_text_that_is_meant() {
        let args = json!({"name": "a.nc", "tag": "4-x", "wheel": true, "zh": false});
        let wish = Wish::Program {
            name: "a.nc".into(),
            tag: "4-x".into(),
            start: None,
            wheel: true,
            zh: false,
        };
        assert!(wish.needs_fresh() && !wish.halts());
        assert_eq!(Wish::of("program", &args), Some(wish));
        assert_eq!(Wish::of("program", &json!({"name": "a.nc"})), None);
        assert_eq!(Wish::of("program", &json!({"tag": "4-x"})), None);
        let wheel = json!({"name": "a.nc", "tag": "4-x", "wheel": "true"});
        assert_eq!(Wish::of("program", &wheel), None);
        let at = |start: Value| {
            let args = json!({"name": "a.nc", "tag": "4-x", "start": start});
            Wish::of("program", &args)
        };
        let shown = "00000001-00000002-00000003-00000004-00000005";
        let start = StartAt {
            line: 7,
            shown: shown.parse().unwrap(),
        };
        let seen = json!({"line": 7, "shown": shown});
        assert!(matches!(at(seen), Some(Wish::Program { start: Some(at), .. }) if at == start));
        for wrong in [
            json!(7),
            json!({"line": 7}),
            json!({"line": 7, "shown": "1"}),
            json!({"line": -7, "shown": shown}),
        ] {
            assert_eq!(at(wrong), None);
        }
    }

    #[test]
    fn the_way_out_of_a_hole_is_at_a_speed_or_at_its_own() {
        let speed = |speed: Value| Wish::of("retract", &json!({"speed": speed, "zh": true}));
        let wish = |speed| Some(Wish::Retract { speed, zh: true });
        assert_eq!(speed(Value::Null), wish(None));
        assert_eq!(speed(json!(200)), wish(Some(200)));
        for wrong in [
            json!(0),
            json!(-1),
            json!(1.5),
            json!("200"),
            json!(1_u64 << 32),
        ] {
            assert_eq!(speed(wrong.clone()), None, "{wrong}");
        }
        assert!(wish(None).is_some_and(|wish| wish.needs_fresh() && !wish.halts()));
    }

    #[test]
    fn a_step_is_one_of_four_and_a_line_is_one_line() {
        let step = |by: &str| Wish::of("step", &json!({"axis": "X-", "by": by}));
        assert!(matches!(step("0.01"), Some(Wish::Step(..))));
        assert!(step("1").is_some() && step("2").is_none() && step("0.0001").is_none());
        assert_eq!(Wish::of("step", &json!({"axis": "Y+", "by": "1"})), None);
        let line = |text: &str| Wish::of("mdi", &json!({"line": text, "zh": true}));
        let text = "G0 X1".to_owned();
        assert_eq!(line(" G0 X1 "), Some(Wish::Line { text, zh: true }));
        let long = "X".repeat(LONGEST_LINE + 1);
        for wrong in ["", "  ", "G0 X1\nG0 X2", "\u{1b}[2J", &long] {
            assert_eq!(line(wrong), None, "{wrong}");
        }
    }
}
