//! The documentation builds without warnings, all its links lead somewhere, those of the pages included, and its pictures
//! are current.
//!
//! Comments cite decisions as `[D7]`, and rustdoc takes these for links. So the lint for dead links is off in an
//! ordinary build. Here it is on, and only these citations are accepted.

use anyhow::{Context, Result, anyhow, bail};
use serde_json::Value;

use crate::{manual, pages, pictures, run};

/// Builds the documentation, and lists its faults.
pub fn check() -> Result<()> {
    pages::check()?;
    manual::whole()?;
    pictures::check()?;
    let args = ["doc", "--no-deps", "--quiet", "--message-format", "json"];
    let mut doc = run::cargo(&run::root(), &[&args[..], &run::WHOLE].concat());
    doc.env(
        "RUSTDOCFLAGS",
        "--force-warn rustdoc::broken-intra-doc-links",
    );
    let mut wrong = Vec::new();
    for line in run::read(doc)?.lines() {
        let record: Value =
            serde_json::from_str(line).context("cargo doc prints what is not JSON")?;
        if record["reason"] != "compiler-message" {
            continue;
        }
        let message = &record["message"];
        let text = message["message"]
            .as_str()
            .ok_or_else(|| anyhow!("a message without text: {line}"))?;
        let is_summary = message["spans"].as_array().is_some_and(Vec::is_empty);
        if !is_summary && !is_citation(text) {
            wrong.push(message["rendered"].as_str().unwrap_or(text).to_owned());
        }
    }
    if wrong.is_empty() {
        return Ok(());
    }
    bail!(
        "the documentation has {} faults\n{}",
        wrong.len(),
        wrong.join("\n")
    )
}

/// True for a complaint about the number of a decision.
fn is_citation(message: &str) -> bool {
    message
        .strip_prefix("unresolved link to `D")
        .and_then(|rest| rest.strip_suffix('`'))
        .is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::is_citation;

    #[test]
    fn only_numbers_of_decisions_pass() {
        assert!(is_citation("unresolved link to `D17`"));
        assert!(!is_citation("unresolved link to `Duration`"));
        assert!(!is_citation("unresolved link to `D`"));
        assert!(!is_citation("missing documentation for a module"));
    }
}
