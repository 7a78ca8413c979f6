//! `explain`: what an alarm or a warning means, what to do, and a program that raises it beside one that does not.
//!
//! The words are those of the core's table, with … in place of figures. The programs stand in `explained.toml`. The same
//! text of all numbers is the page `docs/alarms.md`.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use leadscrew_core::alarm::{Code, Lang};
use toml::de::DeTable;

use crate::cli::{Explain, Global};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::words::{both, pick};

/// A program that raises an alarm, and one that does not.
#[derive(Clone, Debug)]
struct Programs {
    wrong: String,
    right: String,
}

/// The programs by number.
fn programs() -> BTreeMap<String, Programs> {
    let mut programs = BTreeMap::new();
    // The file is part of the program, and a test reads all of it.
    let Ok(file) = DeTable::parse(include_str!("../explained.toml")) else {
        return programs;
    };
    for (number, entry) in file.get_ref() {
        let text = |key| entry.get_ref().get(key)?.get_ref().as_str();
        if let (Some(wrong), Some(right)) = (text("wrong"), text("right")) {
            let [wrong, right] = [wrong, right].map(str::to_owned);
            programs.insert(number.get_ref().to_string(), Programs { wrong, right });
        }
    }
    programs
}

/// Numbers that belong together: the last of them, their subject, and the page to read.
const SUBJECTS: &[(u16, &str, &str, &str)] = &[
    (60, "nose radius and corners", "刀尖半径与倒角", "nose.md"),
    (69, "contour cycles", "轮廓循环", "contours.md"),
    (
        199,
        "macros and program flow",
        "宏与程序流程",
        "language.md",
    ),
    (
        399,
        "threads, grooves and taps",
        "螺纹、切槽与攻丝",
        "decisions.md",
    ),
    (
        3999,
        "macros and program flow",
        "宏与程序流程",
        "language.md",
    ),
    (4099, "the text of a program", "程序文本", "language.md"),
    (4199, "the geometry of cycles", "循环的几何", "decisions.md"),
    (
        4299,
        "what the machine can do",
        "机床的能力",
        "how-it-works.md",
    ),
    (4399, "the machine and its bus", "机床与总线", "bus.md"),
    (4499, "parameters", "参数", "parameters.md"),
    (
        4549,
        "operating by hand, reference",
        "手动操作与回零",
        "operating.md",
    ),
    (4579, "machine functions", "机床辅助功能", "functions.md"),
    (4589, "offsets and tools", "偏置与刀具", "tools.md"),
    (
        4599,
        "away and back, start at a line",
        "离开与返回、从某行启动",
        "operating.md",
    ),
    (4699, "nose radius and corners", "刀尖半径与倒角", "nose.md"),
    (
        4849,
        "what a program hardly means",
        "程序可疑之处",
        "language.md",
    ),
    (4899, "program flow", "程序流程", "language.md"),
    (4919, "the text of a program", "程序文本", "language.md"),
    (4959, "cycles and motion", "循环与运动", "how-it-works.md"),
    (
        4979,
        "parameters and the board",
        "参数与控制板",
        "parameters.md",
    ),
    (
        u16::MAX,
        "what a program hardly means",
        "程序可疑之处",
        "language.md",
    ),
];

/// A code with all that is told of it.
struct Explained {
    code: Code,
    programs: Option<Programs>,
}

impl Explained {
    fn all() -> Vec<Self> {
        let mut programs = programs();
        let mut codes = Code::ALL.to_vec();
        codes.sort_by_key(|code| code.number());
        let explained = |code: Code| Self {
            code,
            programs: programs.remove(&code.number().to_string()),
        };
        codes.into_iter().map(explained).collect()
    }

    fn heading(&self, lang: Lang) -> String {
        let kind = match self.code.is_warning() {
            true => pick(lang, "warning", "警告"),
            false => pick(lang, "alarm", "报警"),
        };
        let (number, cause) = (self.code.number(), blanks(self.code.cause(lang)));
        format!("{kind} {number:04}: {cause}")
    }

    /// The subject, and the page that tells of it.
    fn subject(&self, lang: Lang) -> (&'static str, &'static str) {
        let number = self.code.number();
        let found = SUBJECTS.iter().find(|(last, ..)| number <= *last);
        let (_, en, zh, page) = found.copied().unwrap_or_default();
        (pick(lang, en, zh), page)
    }

    fn text(&self, lang: Lang) -> String {
        let mut text = self.heading(lang);
        let _ = write!(text, "\n  {}\n", blanks(self.code.help(lang)));
        if let Some(Programs { wrong, right }) = &self.programs {
            text.push_str(pick(lang, "\nraised by:\n", "\n引发示例：\n"));
            indent(&mut text, wrong);
            text.push_str(pick(lang, "\nnot raised by:\n", "\n正确示例：\n"));
            indent(&mut text, right);
        }
        let (subject, page) = self.subject(lang);
        let _ = writeln!(text, "\n{subject}: docs/{page}");
        text
    }

    fn section(&self, lang: Lang) -> String {
        let mut text = format!("\n### {}\n\n", self.heading(lang));
        let _ = writeln!(text, "{}.", sentence(&blanks(self.code.help(lang))));
        if let Some(Programs { wrong, right }) = &self.programs {
            let (raises, not) = (
                pick(lang, "raises it", "引发"),
                pick(lang, "does not", "正确"),
            );
            let _ = write!(
                text,
                "\n```gcode\n({raises})\n{wrong}\n({not})\n{right}```\n"
            );
        }
        text
    }
}

/// Explains the numbers that were typed, or lists all.
pub fn run(global: &Global, args: &Explain) -> Outcome {
    let lang = global.lang();
    let all = Explained::all();
    if args.docs {
        return output::write(page(&all, lang).as_bytes());
    }
    if args.numbers.is_empty() {
        let lines: String = all.iter().map(|one| one.heading(lang) + "\n").collect();
        return output::write(lines.as_bytes());
    }
    let mut chosen = Vec::new();
    for number in &args.numbers {
        match all.iter().find(|one| one.code.number() == *number) {
            Some(one) => chosen.push(one),
            None => {
                return Err(Failure::Usage(both!(
                    "there is no alarm and no warning {number:04}: `leadscrew explain` lists all",
                    "没有编号为 {number:04} 的报警或警告：`leadscrew explain` 列出全部编号"
                )));
            }
        }
    }
    if global.json {
        return output::json(|o| {
            o.flag("ok", true);
            o.array_at("alarms", |list| {
                for one in &chosen {
                    list.object(|o| {
                        o.integer("no", one.code.number().into());
                        o.flag("warning", one.code.is_warning());
                        o.text("message", &blanks(one.code.cause(lang)));
                        o.text("help", &blanks(one.code.help(lang)));
                        if let Some(programs) = &one.programs {
                            o.text("wrong", &programs.wrong);
                            o.text("right", &programs.right);
                        }
                    });
                }
            });
        });
    }
    let texts: Vec<_> = chosen.iter().map(|one| one.text(lang)).collect();
    output::write(texts.join("\n").as_bytes())
}

/// The page of the manual.
fn page(all: &[Explained], lang: Lang) -> String {
    let mut text = String::from(pick(
        lang,
        "# Alarms and warnings\n\nMade by `leadscrew explain --docs`; do not edit it by hand. `leadscrew explain NUMBER` prints \
         one of them. … stands for a figure of the case. A warning stops nothing.\n",
        "# 报警与警告\n\n由 `leadscrew explain --docs` 生成，请勿手工修改。`leadscrew explain 编号` 只打印一条。…… 代表具体数值。警告不会停止运行。\n",
    ));
    let mut before = "";
    for one in all {
        let (subject, file) = one.subject(lang);
        if subject != before {
            let _ = write!(text, "\n## {}\n\n[{file}]({file})\n", sentence(subject));
        }
        text.push_str(&one.section(lang));
        before = subject;
    }
    text
}

/// A template with … in place of its figures.
fn blanks(template: &str) -> String {
    let keys = ["{0}", "{1}", "{2}", "{3}", "{w}"];
    let fill = |text: String, key: &&str| text.replace(*key, "…");
    keys.iter().fold(template.to_owned(), fill)
}

fn indent(text: &mut String, program: &str) {
    for line in program.lines() {
        let _ = writeln!(text, "  {line}");
    }
}

/// The same with a capital letter in front, if its first word is one of letters.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    match letters.next() {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_of_programs_is_read_whole_and_names_codes_that_exist() {
        let read = programs();
        let file = DeTable::parse(include_str!("../explained.toml")).unwrap();
        assert_eq!(read.len(), file.get_ref().len());
        for number in read.keys() {
            let code = Code::from_number(number.parse().unwrap());
            assert!(code.is_some(), "{number}");
        }
        assert!(read.len() > 100, "{}", read.len());
    }

    #[test]
    fn the_page_of_the_manual_is_current() {
        assert!(
            page(&Explained::all(), Lang::En) == include_str!("../../../docs/alarms.md"),
            "docs/alarms.md is not current: `cargo xtask renew` writes it anew"
        );
    }

    #[test]
    fn every_number_has_a_subject_and_a_page_that_is_there() {
        let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/");
        for one in Explained::all() {
            let (_, page) = one.subject(Lang::En);
            assert!(std::path::Path::new(&format!("{docs}{page}")).exists());
            let text = one.text(Lang::Zh) + &one.text(Lang::En);
            assert!(!text.contains('{'), "{text}");
        }
    }
}
