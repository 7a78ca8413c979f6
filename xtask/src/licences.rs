//! Every dependency has a licence that lets anyone use and change the whole.

use anyhow::{Result, anyhow, bail};
use spdx::{Expression, ParseMode};

use crate::run;

const ALLOWED: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Checks both workspaces.
pub fn check() -> Result<()> {
    let mut refused = Vec::new();
    let mut count = 0_usize;
    for dir in [run::root(), run::firmware()] {
        let metadata = run::metadata(&dir, &[])?;
        let packages = metadata["packages"]
            .as_array()
            .ok_or_else(|| anyhow!("cargo metadata lists no packages"))?;
        for package in packages {
            count += 1;
            let licence = package["license"].as_str().unwrap_or("");
            if !is_allowed(licence) {
                refused.push(format!(
                    "{} {}: `{licence}`",
                    package["name"], package["version"]
                ));
            }
        }
    }
    if refused.is_empty() {
        println!("{count} packages, every licence allowed");
        return Ok(());
    }
    bail!(
        "not in the list of allowed licences ({}):\n{}",
        ALLOWED.join(", "),
        refused.join("\n")
    )
}

/// True where allowed licences alone meet the expression. An exception only adds permissions.
fn is_allowed(licence: &str) -> bool {
    Expression::parse_mode(licence, ParseMode::LAX).is_ok_and(|expression| {
        expression.evaluate(|one| {
            one.license
                .id()
                .is_some_and(|id| ALLOWED.contains(&id.name))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::is_allowed;

    #[test]
    fn a_choice_needs_one_allowed_and_a_sum_needs_all() {
        assert!(is_allowed("MIT OR Apache-2.0"));
        assert!(is_allowed("MIT/Apache-2.0"));
        assert!(is_allowed("MIT OR GPL-3.0-only"));
        assert!(is_allowed("(MIT OR Apache-2.0) AND Unicode-3.0"));
        assert!(is_allowed("Apache-2.0 WITH LLVM-exception"));
        assert!(!is_allowed("MIT AND GPL-3.0-only"));
        assert!(!is_allowed("MPL-2.0"));
        assert!(!is_allowed(""));
    }
}
