//! What raises an alarm, as text, as Markdown and as JSON. It must not know which alarm it is.

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;

use super::entries::{Entry, File, Pair};
use crate::json::Json;
use crate::words::pick;

/// Over the wrong one and the right one.
fn labels(entry: &Entry, lang: Lang) -> [&'static str; 2] {
    match entry {
        Entry::Programs(_) => [
            pick(lang, "raised by", "引发示例"),
            pick(lang, "not raised by", "正确示例"),
        ],
        Entry::Machines(_) => [
            pick(lang, "raised by this machine file", "引发它的机床文件"),
            pick(lang, "not raised by this one", "正确的机床文件"),
        ],
        Entry::Commands(_) => [
            pick(lang, "raised by these commands", "引发它的命令"),
            pick(lang, "set right by these", "随后的处理命令"),
        ],
        Entry::Words(_) => [pick(lang, "comes about so", "产生原因"), ""],
    }
}

/// Puts it behind what a number means, at a terminal.
pub(super) fn typed(entry: &Entry, lang: Lang, text: &mut String) {
    let [wrong, right] = labels(entry, lang);
    let colon = pick(lang, ":", "：");
    let mut part = |label: &str, lines: &str| {
        let _ = writeln!(text, "\n{label}{colon}");
        for line in lines.lines() {
            let _ = writeln!(text, "  {line}");
        }
    };
    let pair = match entry {
        Entry::Words(words) => {
            part(wrong, words.get(lang));
            return;
        }
        Entry::Programs(pair) | Entry::Machines(pair) | Entry::Commands(pair) => pair,
    };
    let with = |file: &File| match lang {
        Lang::En => format!("with this in {}", file.name),
        Lang::Zh => format!("{} 的内容", file.name),
    };
    part(wrong, &pair.wrong);
    for file in &pair.wrong_files {
        part(&with(file), &file.text);
    }
    part(right, &pair.right);
    for file in &pair.right_files {
        part(&with(file), &file.text);
    }
    for file in &pair.files {
        let with = with(file);
        let both = pick(lang, "both ", "两者共用：");
        part(&format!("{both}{with}"), &file.text);
    }
}

/// Puts it on the page of the manual.
pub(super) fn page(entry: &Entry, lang: Lang, text: &mut String) {
    let pair = match entry {
        Entry::Words(words) => {
            let _ = writeln!(text, "\n{}", words.get(lang));
            return;
        }
        Entry::Programs(pair) | Entry::Machines(pair) | Entry::Commands(pair) => pair,
    };
    let (raises, not) = match entry {
        Entry::Commands(_) => (
            pick(lang, "raises it", "引发"),
            pick(lang, "sets it right", "处理"),
        ),
        _ => (
            pick(lang, "raises it", "引发"),
            pick(lang, "does not", "正确"),
        ),
    };
    let kind = Comment::of(entry);
    files(text, &pair.files, "");
    files(text, &pair.wrong_files, raises);
    files(text, &pair.right_files, not);
    let Pair { wrong, right, .. } = pair;
    let (language, raises, not) = (kind.language(), kind.around(raises), kind.around(not));
    let _ = writeln!(
        text,
        "\n```{language}\n{raises}\n{wrong}\n{not}\n{right}```"
    );
}

fn files(text: &mut String, files: &[File], of: &str) {
    for File { name, text: lines } in files {
        let comment = Comment::in_file(name);
        let of = if of.is_empty() {
            name.clone()
        } else {
            format!("{name}: {of}")
        };
        let (language, head) = (comment.language(), comment.around(&of));
        let _ = writeln!(text, "\n```{language}\n{head}\n{lines}```");
    }
}

/// How a language writes a remark.
#[derive(Clone, Copy)]
enum Comment {
    Program,
    Toml,
    Shell,
}

impl Comment {
    const fn of(entry: &Entry) -> Self {
        match entry {
            Entry::Machines(_) => Self::Toml,
            Entry::Commands(_) => Self::Shell,
            Entry::Programs(_) | Entry::Words(_) => Self::Program,
        }
    }

    fn in_file(name: &str) -> Self {
        match name.ends_with(".toml") {
            true => Self::Toml,
            false => Self::Program,
        }
    }

    const fn language(self) -> &'static str {
        match self {
            Self::Program => "gcode",
            Self::Toml => "toml",
            Self::Shell => "sh",
        }
    }

    fn around(self, text: &str) -> String {
        match self {
            Self::Program => format!("({text})"),
            Self::Toml | Self::Shell => format!("# {text}"),
        }
    }
}

/// Tells it to a program.
pub(super) fn json(entry: &Entry, lang: Lang, o: &mut Json) {
    let (keys, pair) = match entry {
        Entry::Programs(pair) => (["wrong", "right"], pair),
        Entry::Machines(pair) => (["wrong_machine", "right_machine"], pair),
        Entry::Commands(pair) => (["raise", "mend"], pair),
        Entry::Words(words) => {
            o.text("how", words.get(lang));
            return;
        }
    };
    let [wrong, right] = keys;
    o.text(wrong, &pair.wrong);
    o.text(right, &pair.right);
    for (key, files) in [
        ("files", &pair.files),
        ("wrong_files", &pair.wrong_files),
        ("right_files", &pair.right_files),
    ] {
        if !files.is_empty() {
            o.object_at(key, |o| {
                for file in files {
                    o.text(&file.name, &file.text);
                }
            });
        }
    }
}
