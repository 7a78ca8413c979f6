//! What is published on crates.io can be: each crate says what it is, depends on published crates alone, and builds from
//! its own files.
//!
//! Nothing is sent anywhere. The test packs the crates without a network. `cargo xtask packages` does what publishing
//! does, up to the upload: cargo itself chooses the crates and their order, asks the index whether a version is there
//! already, and builds each from what was packed. Whether crates.io takes the names and categories, only it can say.

use anyhow::{Result, bail};
use serde_json::Value;

use crate::run;

/// The limits of crates.io.
const MOST_WORDS: usize = 5;
const LONGEST_WORD: usize = 20;

/// Looks at what the crates say of themselves, and packs them.
pub fn check() -> Result<()> {
    let names = good()?;
    let mut args = vec!["package", "--offline", "--no-verify"];
    for name in &names {
        args.extend_from_slice(&["--package", name]);
    }
    let told = pack(&args)?;
    same("packed", &names, &after(&told, "Packaging"))
}

/// The same, and publishes them without the upload.
pub fn build() -> Result<()> {
    let names = good()?;
    let told = pack(&["publish", "--workspace", "--dry-run"])?;
    same("published", &names, &after(&told, "Uploading"))
}

/// The names of the crates that are published, where nothing is wrong with them.
fn good() -> Result<Vec<String>> {
    let metadata = run::metadata(&run::root(), &["--no-deps"])?;
    let empty = Vec::new();
    let all = metadata["packages"].as_array().unwrap_or(&empty);
    let wrong = wrong(all);
    if !wrong.is_empty() {
        bail!("these crates cannot be published:\n{}", wrong.join("\n"));
    }
    Ok(published(all).filter_map(name).map(str::to_owned).collect())
}

/// What cargo says of its work. Files need not be clean: what is packed are the files as they are.
fn pack(args: &[&str]) -> Result<String> {
    let args = [args, &["--locked", "--allow-dirty", "--color=never"]].concat();
    run::told(run::cargo(&run::root(), &args))
}

/// The crates of which cargo says that it does this.
fn after(told: &str, what: &str) -> Vec<String> {
    let lines = told
        .lines()
        .filter_map(|line| line.trim().strip_prefix(what));
    let first = |line: &str| line.split_whitespace().next().map(str::to_owned);
    lines.filter_map(first).collect()
}

/// All of them, and no other.
fn same(done: &str, names: &[String], told: &[String]) -> Result<()> {
    let [mut wanted, mut found] = [names, told].map(<[String]>::to_vec);
    wanted.sort_unstable();
    found.sort_unstable();
    if wanted != found {
        bail!("to be {done}: {wanted:?}; cargo has {done} {found:?}");
    }
    println!("{} crates can be {done}: {}", told.len(), told.join(", "));
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
    fn what_cargo_has_done_is_all_that_is_published() {
        let told = "    Updating crates.io index\n   Packaging one v0.1.0 (/one)\n   Packaging two v0.1.0 (/two)\n";
        let found = after(told, "Packaging");
        assert_eq!(found, ["one", "two"]);
        let names = ["two", "one"].map(str::to_owned);
        assert!(same("packed", &names, &found).is_ok());
        assert!(same("packed", &names[..1], &found).is_err());
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
