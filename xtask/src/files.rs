//! Files in folders: listed, copied. Follows links to folders.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// All files of a folder and of the folders in it, relative to it, in order.
pub fn below(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut folders = vec![PathBuf::new()];
    while let Some(inner) = folders.pop() {
        let here = folder.join(&inner);
        let entries = fs::read_dir(&here).with_context(|| format!("no {}", here.display()))?;
        for entry in entries {
            let path = inner.join(entry?.file_name());
            let there = folder.join(&path);
            if there.is_dir() {
                folders.push(path);
            } else if there.is_file() {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Copies them to another folder.
pub fn copy(from: &Path, to: &Path) -> Result<()> {
    for file in below(from)? {
        copy_file(&from.join(&file), &to.join(&file))?;
    }
    Ok(())
}

/// Copies a file, and makes the folder that it is copied into.
pub fn copy_file(from: &Path, to: &Path) -> Result<()> {
    let into = to.parent().unwrap_or(to);
    fs::create_dir_all(into).with_context(|| format!("cannot make {}", into.display()))?;
    fs::copy(from, to).with_context(|| format!("cannot copy {}", from.display()))?;
    Ok(())
}

/// The names of the files of a folder with this ending, without it, in order. None where there is no such folder.
pub fn of_kind(folder: &Path, ending: &str) -> Result<Vec<String>> {
    let mut names = Vec::new();
    if !folder.exists() {
        return Ok(names);
    }
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|found| found == ending)
            && let Some(name) = path.file_stem()
        {
            names.push(name.to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}
