//! Every file of the repository that the program writes, written anew or compared: pages, pictures, golden files.
//!
//! Each has its own command, which anybody may use alone. Measured tables are not among them (`ticks`, `sizes`, `bits`,
//! `bench` with `--write`): a new figure there has a reason that somebody gives.

use std::fs;

use anyhow::{Context, Result, bail};

use crate::{pictures, run};

/// The pages of text, with the arguments of `leadscrew` that print them.
const PAGES: &[(&str, &[&str])] = &[
    ("docs/alarms.md", &["explain", "--docs", "--lang", "en"]),
    ("docs/zh/alarms.md", &["explain", "--docs", "--lang", "zh"]),
    ("docs/parameters.md", &["params", "docs", "--lang", "en"]),
];

/// The tests that write what they compare where `BLESS` is set: the target, and the beginning of the tests' names.
const GOLDEN: &[(&[&str], &str)] = &[
    (&["--lib"], "commands::board::monitor::draw::"),
    (&["--test", "cli"], ""),
    (&["--test", "host"], "the_page_offers_"),
];
const BLESS: &str = "LEADSCREW_BLESS";

/// Writes all of them.
pub fn all() -> Result<()> {
    let root = run::root();
    for (page, text) in printed()? {
        fs::write(root.join(page), text).with_context(|| format!("cannot write {page}"))?;
        println!("{page}");
    }
    pictures::write()?;
    for (target, filter) in GOLDEN {
        let test = ["test", "--quiet"];
        let mut golden = run::cargo(&root, &[&test[..], &run::WHOLE, target, &[filter]].concat());
        golden.env(BLESS, "1");
        run::show(golden)?;
    }
    println!("read the difference before you commit it: git diff --stat");
    Ok(())
}

/// Compares the pages of text. This takes seconds, so that the test has it before what takes long.
pub fn check() -> Result<()> {
    let root = run::root();
    let kept = |page: &str| fs::read_to_string(root.join(page)).ok();
    let stale = stale(&printed()?, kept);
    if stale.is_empty() {
        return Ok(());
    }
    bail!(
        "not as the program writes it now: {}\n`cargo xtask renew` writes all such files anew; read the difference",
        stale.join(", ")
    )
}

/// The pages of text, as the program prints them now.
fn printed() -> Result<Vec<(&'static str, String)>> {
    let program = run::programs(&["--bin", "leadscrew"])?.join("leadscrew");
    let print = |(page, args): &(&'static str, &[&str])| {
        let text = run::read(run::command(&run::root(), &program.to_string_lossy(), args))?;
        Ok((*page, text))
    };
    PAGES.iter().map(print).collect()
}

/// The pages whose file is not what is printed, or is missing.
fn stale<'a>(printed: &[(&'a str, String)], kept: impl Fn(&str) -> Option<String>) -> Vec<&'a str> {
    let changed = printed
        .iter()
        .filter(|(page, text)| kept(page).as_ref() != Some(text));
    changed.map(|(page, _)| *page).collect()
}

#[cfg(test)]
mod tests {
    use super::stale;

    #[test]
    fn a_page_that_differs_or_is_missing_is_stale() {
        let printed = ["same", "differs", "missing"].map(|page| (page, format!("{page} now")));
        let kept = |page: &str| match page {
            "same" => Some("same now".to_owned()),
            "differs" => Some("differs before".to_owned()),
            _ => None,
        };
        assert_eq!(stale(&printed, kept), ["differs", "missing"]);
    }
}
