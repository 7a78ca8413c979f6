//! axe-core, which finds what keeps people from using a page. Tests of pages run it, at one version with its checksum
//! (`tests/axe`); it is linked into nothing, for its licence (MPL-2.0) is none of those that may be.

use std::fs;

use anyhow::{Context, Result};

use crate::{run, setup};

const FILES: [&str; 2] = ["package.json", "package-lock.json"];

/// Puts the script below `target/axe`, where it is not there or is another one.
pub fn ensure() -> Result<()> {
    let wanted = run::root().join("tests").join("axe");
    let folder = run::root().join("target").join("axe");
    let script = folder.join("node_modules/axe-core/axe.min.js");
    let is_same = |name: &str| {
        let read = |dir: &std::path::Path| fs::read(dir.join(name)).ok();
        read(&wanted) == read(&folder)
    };
    if script.is_file() && FILES.into_iter().all(is_same) {
        return Ok(());
    }
    setup::tools(&[setup::NPM])?;
    println!("installing axe-core below target/");
    fs::create_dir_all(&folder)?;
    let _ = fs::remove_dir_all(folder.join("node_modules"));
    for name in FILES {
        fs::copy(wanted.join(name), folder.join(name))?;
    }
    let quiet = [
        "ci",
        "--ignore-scripts",
        "--no-audit",
        "--no-fund",
        "--silent",
    ];
    run::read(run::command(&folder, "npm", &quiet)).context(
        "axe-core does not install; see that the npm registry is reachable, then start again",
    )?;
    Ok(())
}
