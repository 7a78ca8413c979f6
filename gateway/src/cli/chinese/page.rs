//! What of a manual page no text of a command can change: its headings, and where its lines end.

use super::lines::broken;

/// The page with Chinese headings, and with lines that may end behind a Chinese character and are not spaced out.
///
/// ```
/// let page = leadscrew::cli::chinese::in_chinese(".TH a 1\n.SH NAME\na \\- 运行\n.SH EXTRA\n运行\n");
/// assert_eq!(page, ".TH a 1\n.ad l\n.SH 名称\na \\- 运行\n.SH 补充\n运\\:行\n");
/// ```
#[must_use]
pub fn in_chinese(page: &str) -> String {
    let page = OF_PAGES
        .iter()
        .fold(page.to_owned(), |page, (en, zh)| page.replace(en, zh));
    let mut out = String::with_capacity(2 * page.len());
    let mut before = "";
    for line in page.lines() {
        // Programs that list all pages read the line below the name as it is.
        if line.starts_with('.') || before == NAME {
            out.push_str(line);
        } else {
            out.push_str(&broken(line, "\\:", ""));
        }
        out.push('\n');
        if line.starts_with(".TH ") {
            out.push_str(".ad l\n");
        }
        before = line;
    }
    out
}

const NAME: &str = ".SH 名称";

/// As they stand in the source of a page.
const OF_PAGES: [(&str, &str); 10] = [
    (".SH NAME\n", ".SH 名称\n"),
    (".SH SYNOPSIS\n", ".SH 用法\n"),
    (".SH DESCRIPTION\n", ".SH 说明\n"),
    (
        ".SH \"OPTIONS OF EVERY COMMAND\"\n",
        ".SH 各命令共用的选项\n",
    ),
    (".SH OPTIONS\n", ".SH 选项\n"),
    (".SH SUBCOMMANDS\n", ".SH 命令\n"),
    (".SH EXTRA\n", ".SH 补充\n"),
    (".SH VERSION\n", ".SH 版本\n"),
    ("Possible values:", "可用的值："),
    ("[default: ", "[默认："),
];
