//! `explain`: what an alarm or a warning means, what to do, what raises it and what does it right.
//!
//! The words are those of the core's table, with … in place of figures. What raises them is in the files of `entries`.
//! The same text of all numbers is the page `docs/alarms.md`, and in Chinese `docs/zh/alarms.md`.

mod entries;
mod shown;
mod subjects;

use std::fmt::Write as _;

use leadscrew_core::alarm::{Code, Lang};
use leadscrew_language::dialect::remedies;

use self::entries::{Entry, entries};
use self::subjects::SUBJECTS;
use crate::cli::{Explain, Global};
use crate::diagnostics::blanks;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::words::{both, pick};

/// A code with all that is told of it.
struct Explained {
    code: Code,
    entry: Option<Entry>,
}

impl Explained {
    fn all() -> Vec<Self> {
        let mut entries = entries();
        let mut codes = Code::ALL.to_vec();
        codes.sort_by_key(|code| code.number());
        let explained = |code: Code| Self {
            code,
            entry: entries.remove(&code.number()),
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

    /// What to do. Where that depends on the word, each has a line of its own.
    fn helps(&self, lang: Lang) -> Vec<String> {
        let helps = remedies::helps(self.code, lang);
        if helps.is_empty() {
            return vec![blanks(self.code.help(lang))];
        }
        let colon = pick(lang, ": ", "：");
        let line = |(word, help)| format!("{word}{colon}{help}");
        helps.into_iter().map(line).collect()
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
        text.push('\n');
        for help in self.helps(lang) {
            let _ = writeln!(text, "  {help}");
        }
        if let Some(entry) = &self.entry {
            shown::typed(entry, lang, &mut text);
        }
        let (subject, page) = self.subject(lang);
        let _ = writeln!(text, "\n{subject}: docs/{page}");
        text
    }

    fn section(&self, lang: Lang) -> String {
        let mut text = format!("\n### {}\n\n", self.heading(lang));
        let end = pick(lang, ".", "。");
        match self.helps(lang).as_slice() {
            [help] => {
                let _ = writeln!(text, "{}{end}", sentence(help));
            }
            helps => {
                for help in helps {
                    let _ = writeln!(text, "- {help}");
                }
            }
        }
        if let Some(entry) = &self.entry {
            shown::page(entry, lang, &mut text);
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
                        o.text("help", &one.helps(lang).join(pick(lang, "; ", "；")));
                        if let Some(entry) = &one.entry {
                            shown::json(entry, lang, o);
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
         one of them. … stands for a figure of the case. A warning stops nothing.\n\n\
         Below each stands what raises it and what does it right. A program is looked at by `leadscrew check`, and a machine file \
         by `leadscrew params validate`. A line with `(1001 times)` behind it is written so often, and a word with `×200` too, in \
         its line. Commands are typed at [a machine on the desk](desk.md), after `export LEADSCREW_BUS=sim:desk`; `leadscrew \
         down` ends it. A test does all of this.\n",
        "# 报警与警告\n\n由 `leadscrew explain --docs --lang zh` 生成，请勿手工修改。`leadscrew explain 编号` 只打印一条。… 代表具体数值。警告不会停止运行。\n\n\
         每条下面是引发它的示例和正确的做法。程序由 `leadscrew check` 检查，机床文件由 `leadscrew params validate` 检查。行末的 `(1001 times)` 表示该行重复这么多次，\
         字后的 `×200` 表示该字在行中重复这么多次。命令在[桌面机床](../desk.md)上输入，先执行 `export LEADSCREW_BUS=sim:desk`；`leadscrew down` 结束机床。\
         以上都有测试执行。\n",
    ));
    // The other pages that it leads to are English ones, a folder above the Chinese page.
    let folder = pick(lang, "", "../");
    let mut before = "";
    for one in all {
        let (subject, file) = one.subject(lang);
        if subject != before {
            let _ = write!(
                text,
                "\n## {}\n\n[{file}]({folder}{file})\n",
                sentence(subject)
            );
        }
        text.push_str(&one.section(lang));
        before = subject;
    }
    text
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
    fn the_pages_of_the_manual_are_current() {
        let pages = [
            (Lang::En, include_str!("../../../../docs/alarms.md")),
            (Lang::Zh, include_str!("../../../../docs/zh/alarms.md")),
        ];
        for (lang, kept) in pages {
            assert!(
                page(&Explained::all(), lang) == kept,
                "the alarms of the manual are not current in {lang:?}: `cargo xtask renew` writes them anew"
            );
        }
    }

    #[test]
    fn every_number_has_a_subject_and_a_page_that_is_there() {
        let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/");
        for one in Explained::all() {
            let (_, page) = one.subject(Lang::En);
            assert!(std::path::Path::new(&format!("{docs}{page}")).exists());
            for lang in [Lang::En, Lang::Zh] {
                let text = one.heading(lang) + &blanks(one.code.help(lang));
                assert!(!text.contains('{'), "{text}");
            }
        }
    }
}
