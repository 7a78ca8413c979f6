//! What is published on crates.io can be: each crate says what it is, depends on published crates alone, and builds from
//! its own files.
//!
//! Nothing is sent anywhere. Whether crates.io takes the names and categories, only it can say (`cargo publish --dry-run`).

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::run;

/// The limits of crates.io.
const MOST_WORDS: usize = 5;
const LONGEST_WORD: usize = 20;

/// Looks at what the crates say of themselves, and packs them.
pub fn check() -> Result<()> {
    pack(&["--no-verify"])
}

/// The same, and builds each from what was packed.
pub fn build() -> Result<()> {
    pack(&[])
}

fn pack(how: &[&str]) -> Result<()> {
    let root = run::root();
    let metadata = ["metadata", "--format-version", "1", "--no-deps"];
    let text = run::read(run::cargo(&root, &metadata))?;
    let metadata: Value = serde_json::from_str(&text).context("cargo metadata is not JSON")?;
    let empty = Vec::new();
    let all = metadata["packages"].as_array().unwrap_or(&empty);
    let wrong = wrong(all);
    if !wrong.is_empty() {
        bail!("these crates cannot be published:\n{}", wrong.join("\n"));
    }
    let names: Vec<&str> = published(all).filter_map(name).collect();
    // The rest need not be clean: what is packed are the files as they are.
    let mut args = vec!["package", "--quiet", "--locked", "--allow-dirty"];
    args.extend_from_slice(how);
    for name in &names {
        args.extend_from_slice(&["--package", name]);
    }
    run::read(run::cargo(&root, &args))?;
    println!(
        "{} crates can be published: {}",
        names.len(),
        names.join(", ")
    );
    Ok(())
}

fn published(all: &[Value]) -> impl Iterator<Item = &Value> {
    all.iter().filter(|package| package["publish"].is_null())
}

fn name(package: &Value) -> Option<&str> {
    package["name"].as_str()
}

/// What crates.io refuses, or a reader misses.
fn wrong(all: &[Value]) -> Vec<String> {
    let mut wrong = Vec::new();
    let names: Vec<&str> = published(all).filter_map(name).collect();
    for package in published(all) {
        let name = name(package).unwrap_or_default();
        for field in ["description", "license", "repository", "readme"] {
            if package[field].as_str().is_none_or(str::is_empty) {
                wrong.push(format!("{name}: no {field}"));
            }
        }
        for field in ["keywords", "categories"] {
            let words = package[field].as_array().map_or(&[][..], Vec::as_slice);
            if words.is_empty() || words.len() > MOST_WORDS {
                wrong.push(format!("{name}: {} {field}, not 1 to 5", words.len()));
            }
        }
        for word in package["keywords"].as_array().into_iter().flatten() {
            let word = word.as_str().unwrap_or_default();
            let plain = |c: char| c.is_ascii_alphanumeric() || "-_+".contains(c);
            if word.len() > LONGEST_WORD || !word.chars().all(plain) {
                wrong.push(format!("{name}: `{word}` is no keyword"));
            }
        }
        for needed in package["dependencies"].as_array().into_iter().flatten() {
            // A dependency of tests alone is left out where it has no version.
            let own = needed["path"].is_string() && needed["kind"] != "dev";
            let other = needed["name"].as_str().unwrap_or_default();
            if own && needed["req"] == "*" {
                wrong.push(format!("{name}: {other} has a path, and no version"));
            }
            if own && !names.contains(&other) {
                wrong.push(format!("{name}: needs {other}, which is not published"));
            }
        }
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(name: &str, more: &Value) -> Value {
        let mut package = serde_json::json!({
            "name": name, "publish": null, "description": "d", "license": "MIT", "repository": "r", "readme": "README.md",
            "keywords": ["lathe"], "categories": ["science"], "dependencies": [],
        });
        for (key, value) in more.as_object().into_iter().flatten() {
            package[key] = value.clone();
        }
        package
    }

    #[test]
    fn what_is_missing_is_told() {
        let seed = serde_json::json!({"name": "seed", "path": "/seed", "req": "*", "kind": "dev"});
        let whole = package("whole", &serde_json::json!({"dependencies": [seed]}));
        assert_eq!(wrong(&[whole]), [""; 0]);

        let inner =
            serde_json::json!({"name": "inner", "path": "/inner", "req": "*", "kind": null});
        let poor =
            serde_json::json!({"readme": null, "keywords": ["not one"], "dependencies": [inner]});
        let secret = package("inner", &serde_json::json!({"publish": [], "readme": null}));
        assert_eq!(
            wrong(&[package("poor", &poor), secret]),
            [
                "poor: no readme",
                "poor: `not one` is no keyword",
                "poor: inner has a path, and no version",
                "poor: needs inner, which is not published",
            ]
        );
    }
}
