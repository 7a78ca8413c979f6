//! Chinese in clap's lines: where a line may end, how wide it is, and clap's own words.
//!
//! Clap breaks lines at spaces, of which Chinese has none, and counts characters, of which a Chinese one takes two places.
//! So a text is given to it spread: each wide character with a space behind it where a line may end there, else with
//! a filler. Clap then counts places and breaks as it does in English. What it has written is joined again. The source of
//! a manual page says with `\:` where a line may end.
//!
//! It must not know the commands.

use std::iter;

use clap::Command;

use crate::words::is_wide;

/// Behind a wide character: no line ends here. A character that no text has.
const FILLER: char = '\u{e000}';
/// A space at which no line ends.
const BOUND: char = '\u{e001}';
/// Before a remark.
const REMARK: char = '\u{e002}';
/// As in the command itself.
const WIDEST: usize = 110;

/// The places that a line may have, less one: a wide character at the end of a line is one place longer than clap counts.
pub(super) fn width() -> usize {
    // Clap tells nobody how wide it writes; a text of short words does.
    let words = iter::repeat_n("a ", 2 * WIDEST).collect::<String>();
    let mut probe = Command::new("")
        .max_term_width(WIDEST)
        .help_template("{after-help}")
        .after_help(words);
    let text = probe.render_help().to_string();
    let longest = text.lines().map(str::len).max();
    longest.unwrap_or(WIDEST).saturating_sub(1)
}

/// What the texts are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum For {
    /// A help: [`joined`] has to be called for what clap has written.
    Help,
    /// The source of a manual page.
    Page,
}

impl For {
    /// A text.
    pub(super) fn text(self, text: &str) -> String {
        match self {
            Self::Help => spread(text),
            Self::Page => text.to_owned(),
        }
    }

    /// Words behind an example: all in one line, a line of their own where there is no room.
    pub(super) fn remark(self, text: &str) -> String {
        if self == Self::Page {
            return text.to_owned();
        }
        let mut out = String::from(REMARK);
        for c in text.chars() {
            out.push(if c == ' ' { BOUND } else { c });
            if is_wide(c) {
                out.push(FILLER);
            }
        }
        out
    }
}

/// The text as clap can lay it out.
fn spread(text: &str) -> String {
    broken(text, " ", &FILLER.to_string())
}

/// The text with this behind each wide character, where a line may end and where not.
pub(super) fn broken(text: &str, ends: &str, stays: &str) -> String {
    let mut out = String::with_capacity(2 * text.len());
    let mut all = text.chars().peekable();
    while let Some(c) = all.next() {
        out.push(c);
        if is_wide(c) {
            let may = all.peek().is_some_and(|next| may_end(c, *next));
            out.push_str(if may { ends } else { stays });
        }
    }
    out
}

/// True where a line may end between the two.
fn may_end(c: char, next: char) -> bool {
    !matches!(c, '（' | '「' | '《')
        && !next.is_whitespace()
        && !"，。；：、）」》？！…,.;:)]".contains(next)
}

/// What clap has written, with its own words in Chinese.
pub(super) fn joined(text: &str) -> String {
    let own_line = format!("\n  {REMARK}");
    let text = text.replace(&own_line, "\n      ");
    let mut out = String::with_capacity(text.len());
    let mut all = text.chars().peekable();
    while let Some(c) = all.next() {
        match c {
            FILLER | REMARK => {}
            BOUND => out.push(' '),
            c => {
                out.push(c);
                if is_wide(c) {
                    all.next_if_eq(&' ');
                }
            }
        }
    }
    let out = OF_CLAP
        .iter()
        .fold(out, |text, (en, zh)| text.replace(en, zh));
    values(&out)
}

/// Words of clap that no text can change, and the one heading of ours. None becomes longer.
const OF_CLAP: [(&str, &str); 10] = [
    ("Options of every command:", "各命令共用的选项："),
    ("Usage:", "用法："),
    ("Commands:", "命令："),
    ("Arguments:", "参数："),
    ("Options:", "选项："),
    ("Possible values:", "可用的值："),
    ("[default:", "[默认："),
    ("[OPTIONS]", "[选项]"),
    ("<COMMAND>", "<命令>"),
    ("[COMMAND]", "[命令]"),
];

/// `[possible values:`, which clap may have broken: the line then ends before it.
fn values(text: &str) -> String {
    let mut parts = text.split("[possible");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let rest = part.trim_start();
        let gap = &part[..part.len() - rest.len()];
        if gap.contains('\n') {
            out.truncate(out.trim_end_matches(' ').len());
            out.push_str(gap);
        }
        out.push_str("[可用：");
        let rest = rest.strip_prefix("values:").unwrap_or(rest);
        out.push_str(rest.strip_prefix(' ').unwrap_or(rest));
    }
    out.replace("[默认： ", "[默认：")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_comes_back_as_it_was() {
        for text in [
            "检查 `--bus` 后（如 can0），再运行。",
            "M8：a中 b",
            "",
            "中\n\n文",
        ] {
            assert_eq!(joined(&spread(text)), text);
        }
    }

    #[test]
    fn words_of_clap_are_found_where_it_has_broken_them() {
        for (en, zh) in [
            ("a [possible values: x, y]", "a [可用：x, y]"),
            ("a [possible\n    values: x]", "a\n    [可用：x]"),
            ("a [possible values:\n    x]", "a [可用：\n    x]"),
            (
                "a [default: 1] [possible values: x]",
                "a [默认：1] [可用：x]",
            ),
            ("a [default:\n  1]", "a [默认：\n  1]"),
        ] {
            assert_eq!(joined(en), zh);
        }
    }

    #[test]
    fn a_remark_has_a_line_of_its_own_where_there_is_no_room() {
        let written = |remark: &str| {
            let mut probe = Command::new("")
                .term_width(30)
                .help_template("{after-help}")
                .after_help(format!("  run a.nc   {}", For::Help.remark(remark)));
            joined(&probe.render_help().to_string()).trim().to_owned()
        };
        assert_eq!(written("逐行 3 次"), "run a.nc   逐行 3 次");
        assert_eq!(
            written("逐行运行 3 次之后停止"),
            "run a.nc\n      逐行运行 3 次之后停止"
        );
    }

    #[test]
    fn a_line_is_as_wide_as_it_is_counted_and_begins_with_no_stop() {
        let text = "螺纹，".repeat(40) + "a" + &"主轴（停）".repeat(30);
        let mut probe = Command::new("")
            .term_width(40)
            .help_template("{after-help}")
            .after_help(spread(&text));
        let written = joined(&probe.render_help().to_string());
        let wide = |line: &str| -> usize {
            let places = |c| 1 + usize::from(is_wide(c));
            line.chars().map(places).sum()
        };
        let lines: Vec<&str> = written.trim().lines().collect();
        for line in &lines[..lines.len() - 1] {
            assert!((36..=41).contains(&wide(line)), "{line}");
        }
        for line in &lines {
            assert!(!line.starts_with(['，', '）']), "{line}");
            assert!(!line.ends_with('（'), "{line}");
        }
        assert_eq!(lines.concat(), text);
    }
}
