//! A tool or a work offset touched off from the page: looked at by where the machine stands, then written, as
//! `leadscrew touch` does. Nothing moves by it.

use clap::ValueEnum as _;
use leadscrew_core::offsets::TOOLS;
use serde_json::Value;

use super::super::object;
use super::tools::texts;
use super::{put_changes, said, short};
use crate::cli::{AxisName, Global, SystemName, Touch};
use crate::commands::tools::{Home, touch};
use crate::failure::{Failure, Outcome};
use crate::tools::Change;
use crate::words::{Both, both, one_line};

/// What is to be touched off.
#[derive(Debug)]
pub struct Touching {
    axis: AxisName,
    what: What,
    pub(super) zh: bool,
}

#[derive(Debug)]
enum What {
    /// Where the axis stands is remembered.
    Mark,
    Value {
        /// Coordinate of the work, as it was typed.
        value: String,
        /// Number of the tool offset, as it was typed; none: no tool.
        tool: String,
        system: SystemName,
        /// The work offset is to be set, and not the tool.
        work: bool,
        /// What the page was shown; none: it is looked at, and not written.
        seen: Option<String>,
    },
}

/// What has become of it.
struct Told {
    words: Both,
    /// What it was made in: the revision of the table, and where the axis stood.
    seen: String,
    changes: Vec<Change>,
}

impl Touching {
    /// The touch of this order; `None`: it is none, or what belongs to it is wrong.
    pub fn of(op: &str, args: &Value) -> Option<Self> {
        if op != "touch" {
            return None;
        }
        let text = |key: &str| short(args[key].as_str()?);
        let what = match args["mark"] == true {
            true => What::Mark,
            false => What::Value {
                value: text("value")?.trim().to_owned(),
                tool: text("tool")?.trim().to_owned(),
                system: SystemName::from_str(&text("system")?, false).ok()?,
                work: args["work"].as_bool()?,
                seen: match &args["seen"] {
                    Value::Null => None,
                    _ => Some(text("seen")?),
                },
            },
        };
        Some(Self {
            axis: AxisName::from_str(&text("axis")?, false).ok()?,
            what,
            zh: args["zh"] == true,
        })
    }

    /// Looks at it or does it, and says what has become of it, as JSON.
    pub fn answer(&self, global: &Global) -> String {
        let told = self.told(global).map_err(said);
        object(|json| {
            json.flag("ok", told.is_ok());
            let (Ok(Told { words, .. }) | Err(words)) = &told;
            json.text("en", &words.en);
            json.text("zh", &words.zh);
            let Ok(told) = &told else { return };
            json.text("seen", &told.seen);
            put_changes(json, &texts(&told.changes));
        })
    }

    fn told(&self, global: &Global) -> Outcome<Told> {
        let mut args = Touch {
            axis: self.axis,
            value: None,
            tool: None,
            work: None,
            system: SystemName::G54,
            mark: false,
        };
        let What::Value {
            value,
            tool,
            system,
            work,
            seen,
        } = &self.what
        else {
            let (axis, at) = touch::mark(&mut Home::open(global)?, &args, false)?;
            return Ok(Told {
                words: touch::marked(axis, at),
                seen: String::new(),
                changes: Vec::new(),
            });
        };
        args.value = Some(value.clone());
        args.tool = number(tool, *work).map_err(Failure::WrongBecause)?;
        args.system = *system;
        args.work = work.then_some(*system);
        let mut home = Home::open(global)?;
        let made = touch::Made::of(&mut home, &args)?;
        let now = made.made_in(&home);
        if let Some(seen) = seen {
            if *seen != now {
                return Err(Failure::WrongBecause(moved()));
            }
            made.write(&mut home)?;
        }
        let Both { en, zh } = made.words();
        let words = match made.is_marked() {
            true => both!("{en}, where it was marked", "{zh}（已记下的位置）"),
            false => Both { en, zh },
        };
        Ok(Told {
            words,
            seen: now,
            changes: made.changes,
        })
    }
}

/// The number of a tool; none where nothing was typed, which is enough for a work offset alone.
fn number(text: &str, work: bool) -> Result<Option<u8>, Both> {
    let number = text
        .parse()
        .ok()
        .filter(|number| (1..=TOOLS as u8).contains(number));
    match number {
        None if work && matches!(text, "" | "0") => Ok(None),
        Some(number) => Ok(Some(number)),
        None => Err(both!(
            "`{text}` is no number of a tool offset: type 1 to {TOOLS}; without one only a work offset is touched off",
            "`{text}` 不是刀具偏置号：请输入 1 至 {TOOLS}；不用刀具时只能设定工件零点",
            text = one_line(text)
        )),
    }
}

/// The axis, the mark or the table is another one than was shown.
fn moved() -> Both {
    both!(
        "nothing has been written: the axis stands elsewhere by now, or the mark or the table of offsets has changed since this \
         was shown; review it again, then write it",
        "未写入任何内容：自显示以来，轴位置、标记或偏置表已改变；请重新核对后再写入"
    )
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_is_no_touch_is_none() {
        let good = json!({"axis": "X", "value": "38.42", "tool": "1", "system": "G54", "work": false, "seen": null});
        assert!(Touching::of("touch", &good).is_some());
        assert!(Touching::of("tools", &good).is_none());
        assert!(Touching::of("touch", &json!({"axis": "Z", "mark": true})).is_some());
        let long = "1".repeat(65);
        for (key, wrong) in [
            ("axis", json!("C")),
            ("axis", Value::Null),
            ("value", json!(38.42)),
            ("value", json!("1\n2")),
            ("value", json!(long)),
            ("tool", json!(1)),
            ("system", json!("G53")),
            ("work", json!("true")),
            ("seen", json!(7)),
        ] {
            let mut args = good.clone();
            args[key] = wrong;
            assert!(Touching::of("touch", &args).is_none(), "{args}");
        }
    }

    #[test]
    fn a_tool_is_needed_for_its_geometry_and_not_for_a_work_offset() {
        assert_eq!(number("12", false), Ok(Some(12)));
        assert_eq!(number("", true), Ok(None));
        assert_eq!(number("3", true), Ok(Some(3)));
        for (text, work) in [
            ("", false),
            ("0", false),
            ("33", true),
            ("T1", true),
            ("-1", false),
        ] {
            let told = number(text, work).unwrap_err();
            assert!(told.en.contains("type 1 to 32"), "{text}: {}", told.en);
        }
    }
}
