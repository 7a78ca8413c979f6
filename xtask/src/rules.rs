//! The house rules that neither compiler nor clippy checks. This module reads the files as text.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::run;

/// The first folders that an absolute path may have: folders of every machine, and `no` as in *no such folder*. Any
/// other path belongs to one machine only.
const COMMON_FOLDERS: &[&str] = &[
    "bin", "dev", "etc", "lib", "no", "proc", "programs", "run", "sys", "tmp", "usr", "var",
];

/// Checks all files under version control.
pub fn check() -> Result<()> {
    let root = run::root();
    let files = run::read(run::command(
        &root,
        "git",
        &["ls-files", "--cached", "--others", "--exclude-standard"],
    ))
    .context("the list of files comes from git")?;
    let mut found = Vec::new();
    let mut count = 0_usize;
    for name in files.lines().filter(|name| is_ours(name)) {
        // A file that is listed but deleted in the working folder has no text.
        let Ok(text) = fs::read_to_string(root.join(name)) else {
            continue;
        };
        count += 1;
        found.extend(
            complaints(name, &text)
                .into_iter()
                .map(|(line, what)| format!("{name}:{line}: {what}")),
        );
    }
    if found.is_empty() {
        println!("{count} files keep the rules");
        return Ok(());
    }
    bail!(
        "{} places break the house rules:\n{}",
        found.len(),
        found.join("\n")
    )
}

/// The greatest width of a comment in code, in columns.
const COMMENT_WIDTH: usize = 124;

fn is_ours(name: &str) -> bool {
    let extension = Path::new(name)
        .extension()
        .and_then(|extension| extension.to_str())
        .unwrap_or("");
    matches!(extension, "rs" | "toml" | "md" | "x") || name.starts_with(".ci/")
}

fn complaints(name: &str, text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let in_core = ["core/src/", "motion/src/"]
        .iter()
        .any(|folder| name.starts_with(folder))
        && !name.ends_with("tests.rs")
        && !name.split('/').any(|part| part == "tests");
    for (number, line) in (1..).zip(text.lines()) {
        // Each word is written in parts, so that this file keeps its own rule.
        for word in [
            concat!("TO", "DO"),
            concat!("FIX", "ME"),
            concat!("X", "XX"),
        ] {
            if has_word(line, word) {
                found.push((number, format!("unfinished: `{word}`")));
            }
        }
        if name.ends_with(".rs") && line.trim_start().starts_with(concat!("#[ig", "nore")) {
            found.push((number, "a test that is switched off".into()));
        }
        if name.ends_with(".rs") && is_wide_comment(line) {
            found.push((
                number,
                format!("a comment wider than {COMMENT_WIDTH} columns"),
            ));
        }
        if is_of_a_merge(line) {
            found.push((number, "a merge that is not resolved".into()));
        }
        if let Some(path) = private_path(line) {
            found.push((number, format!("a path of one machine: `{path}`")));
        }
    }
    if in_core {
        for (number, line) in product_lines(text) {
            let code = line.split("//").next().unwrap_or("");
            for word in ["f32", "f64"] {
                if has_word(code, word) {
                    found.push((number, format!("floating point in the core: `{word}`")));
                }
            }
        }
    }
    found
}

/// The numbered lines outside `#[cfg(test)]` items.
fn product_lines(text: &str) -> Vec<(usize, &str)> {
    let mut kept = Vec::new();
    let mut lines = (1..).zip(text.lines());
    while let Some((number, line)) = lines.next() {
        if line.trim() != "#[cfg(test)]" {
            kept.push((number, line));
            continue;
        }
        // The item ends with a closing line at the attribute's own indentation, or after one line.
        let indent = line.len() - line.trim_start().len();
        for (_, line) in lines.by_ref() {
            let here = line.len() - line.trim_start().len();
            let end = here == indent
                && (line.trim_end().ends_with(';') || line.trim_start().starts_with('}'));
            if end && !line.trim().is_empty() {
                break;
            }
        }
    }
    kept
}

/// True for a comment that is too wide. A row of a table may be wide, because it cannot go on in the next line.
fn is_wide_comment(line: &str) -> bool {
    let text = line.trim_start();
    let said = text.trim_start_matches(['/', '!']).trim_start();
    text.starts_with("//") && !said.starts_with('|') && line.chars().count() > COMMENT_WIDTH
}

/// True for the first and the last line of an unresolved merge.
fn is_of_a_merge(line: &str) -> bool {
    ["<<<<<<<", ">>>>>>>"]
        .into_iter()
        .filter_map(|marker| line.strip_prefix(marker))
        .any(|rest| rest.is_empty() || rest.starts_with(' '))
}

/// True where `line` contains `word` as a whole word.
fn has_word(line: &str, word: &str) -> bool {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    line.match_indices(word).any(|(at, _)| {
        let before = line.get(..at).and_then(|text| text.chars().next_back());
        let after = line
            .get(at + word.len()..)
            .and_then(|text| text.chars().next());
        !before.is_some_and(is_part) && !after.is_some_and(is_part)
    })
}

/// An absolute path (after a space, a quote or a bracket) in a folder that not every machine has.
fn private_path(line: &str) -> Option<&str> {
    line.match_indices('/').find_map(|(at, _)| {
        let before = line.get(..at)?.chars().next_back();
        if !before.is_none_or(|c| c == '"' || c == '`' || c == '(' || c == '=' || c.is_whitespace())
        {
            return None;
        }
        let path = line.get(at..)?;
        let folder = path.get(1..)?.split('/').next()?;
        let is_name = !folder.is_empty() && folder.bytes().all(|b| b.is_ascii_lowercase());
        let goes_on = path.get(1 + folder.len()..)?.starts_with('/');
        (is_name && goes_on && !COMMON_FOLDERS.contains(&folder)).then_some(path)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_count_outside_tests_only() {
        let text = "fn a(b: f64) {}\n#[cfg(test)]\nuse x::f64;\nfn c() -> f32 {}\n// f64\n\
                    #[cfg(test)]\nmod tests {\n    fn d() -> f64 {}\n}\n";
        let lines: Vec<usize> = complaints("core/src/a.rs", text)
            .iter()
            .map(|(line, _)| *line)
            .collect();
        assert_eq!(lines, [1, 4]);
        assert!(complaints("gateway/src/a.rs", text).is_empty());
    }

    #[test]
    fn private_paths_are_found_and_common_ones_are_not() {
        assert!(private_path(concat!("see \"", "/home", "/", "me/x\"")).is_some());
        assert!(private_path("open /dev/ttyACM0 or /usr/share/x").is_none());
        assert!(private_path("X/Z/C and and/or/not, //! text, `/N10 G01`").is_none());
    }

    #[test]
    fn comments_have_their_width() {
        let wide = |line: &str| is_wide_comment(line);
        let of = |begin: &str, width: usize| format!("{begin}{}", "ä".repeat(width - begin.len()));
        assert!(wide(&of("    /// ", 125)) && !wide(&of("    /// ", 124)));
        assert!(wide(&of("//! ", 125)) && wide(&of("// ", 125)));
        assert!(!wide(&of("//! | ", 200)) && !wide(&of("let a = \"", 200)));
        let text = format!("fn a() {{}}\n{}\n", of("// ", 125));
        assert_eq!(complaints("a.rs", &text).len(), 1);
        assert!(complaints("a.md", &text).is_empty());
    }

    #[test]
    fn merges_are_resolved() {
        let text = "a\n<<<<<<< HEAD\nb\n=======\nc\n>>>>>>> 1234567 (d)\n";
        let lines: Vec<usize> = complaints("README.md", text)
            .into_iter()
            .map(|(line, _)| line)
            .collect();
        assert_eq!(lines, [2, 6]);
        assert!(!is_of_a_merge("Vec<Vec<u8>>>>>>>"));
        assert!(!is_of_a_merge("=======") && !is_of_a_merge("<<<<<<<x"));
    }

    #[test]
    fn words_stand_alone() {
        assert!(has_word("a word here", "word"));
        assert!(!has_word("a sword here", "word"));
        assert!(!has_word("wordy", "word"));
    }
}
