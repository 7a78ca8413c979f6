//! A whole set as a machine file: every value with its unit, and its meaning next to it.

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Entry, Params};

use super::schema::{KEY, SCHEMA};
use super::{CHAPTERS, functions, literal, meaning, name, value_text};
use crate::words::pick;

/// The file. `head` is printed at its top, each line as a comment.
#[must_use]
pub fn file(params: &Params, head: &[String], lang: Lang) -> String {
    let mut out = String::new();
    for line in head {
        let _ = writeln!(out, "# {line}");
    }
    let _ = writeln!(out, "{KEY} = {SCHEMA}");
    for chapter in &CHAPTERS {
        let _ = writeln!(out, "\n# ---- {} ----", chapter.title(lang));
        let mut last = None;
        for entry in Entry::all().iter().filter(|e| (chapter.numbers)(e.no)) {
            // The meaning once for all axes of a number; a bit has a meaning of its own.
            let about = (entry.no, meaning(entry, lang));
            if last != Some(about) {
                let alias = entry.alias().map(|a| format!("/{a}")).unwrap_or_default();
                let _ = writeln!(
                    out,
                    "\n# {:03}{alias}  {}",
                    entry.no,
                    about.1.replace('\n', " ")
                );
                last = Some(about);
            }
            value(&mut out, params, entry, lang);
        }
    }
    out
}

fn value(out: &mut String, params: &Params, entry: &Entry, lang: Lang) {
    let (raw, built_in) = (params.get(entry), Params::slant_bed().get(entry));
    let _ = match functions::row_of(entry).and_then(|_| functions::line(entry, raw)) {
        Some(line) => write!(out, "{line}"),
        None => write!(out, "{} = {}", name(entry), literal(entry, raw)),
    };
    if raw != built_in {
        let words = pick(lang, "built in:", "内置值：");
        let _ = write!(out, "  # {words} {}", value_text(entry, built_in));
    }
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_comes_back_from_its_file() {
        let mut params = Params::slant_bed();
        for (key, raw) in [
            ("9101.X", 1_234_500),
            ("1320.C", 90_000_000),
            ("019", 7),
            ("5200.4", 1),
            ("9401", 81_011_010_200),
            ("9403", 9_998_162_169_999),
        ] {
            params.set(Entry::find_text(key).unwrap(), raw).unwrap();
        }
        for lang in [Lang::En, Lang::Zh] {
            let text = file(&params, &["a lathe".into()], lang);
            let loaded = super::super::load_text("f", &text, Lang::En);
            assert!(loaded.is_good(), "{:?}", loaded.diagnostics);
            assert_eq!(loaded.params, params);
            for entry in Entry::all() {
                assert!(loaded.source(entry).is_some(), "{entry}");
            }
        }
        let text = file(&params, &["a lathe".into(), "of mine".into()], Lang::En);
        assert!(text.starts_with(
            "# a lathe\n# of mine\nschema = 2\n\n# ---- Cycles: numbers of the 980TD ----\n\n\
             # 019/5130  Length of the run-out (chamfer) of G76, G78 and G92 threads\n\
             thread_chamfer = 7  # built in: 5\u{20}× 0.1 lead\n"
        ));
        assert!(text.contains(
            "\n# 1320  Travel limit in the positive direction, machine coordinates (X: radius)\n\
             soft_limit_plus.X = \"300 mm\"\nsoft_limit_plus.Z = \"1000 mm\"\n\
             soft_limit_plus.C = \"90 °\"  # built in: none\n"
        ));
    }
}
