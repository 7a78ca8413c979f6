//! SHA-256 of each file, as `sha256sum -c` reads them.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};

use crate::files;

/// The file with the sums, at the top of the folder.
const NAME: &str = "SHA256SUMS";

/// Writes the sums of all files of a folder into it.
pub fn write(folder: &Path) -> Result<()> {
    fs::write(folder.join(NAME), of(folder)?).with_context(|| format!("cannot write {NAME}"))
}

/// Compares what was written with the files, both ways.
pub fn check(folder: &Path) -> Result<()> {
    let written = fs::read_to_string(folder.join(NAME)).with_context(|| format!("no {NAME}"))?;
    let found = of(folder)?;
    let differ = |a: &str, b: &str| -> Vec<String> {
        let lines = a
            .lines()
            .filter(|line| !b.lines().any(|other| other == *line));
        lines.map(str::to_owned).collect()
    };
    let (gone, new) = (differ(&written, &found), differ(&found, &written));
    if gone.is_empty() && new.is_empty() {
        return Ok(());
    }
    bail!(
        "{NAME} says\n{}\nand the files have\n{}",
        gone.join("\n"),
        new.join("\n")
    )
}

fn of(folder: &Path) -> Result<String> {
    let mut lines = String::new();
    for file in files::below(folder)?
        .iter()
        .filter(|file| *file != Path::new(NAME))
    {
        let bytes = fs::read(folder.join(file))?;
        for byte in Sha256::digest(&bytes) {
            lines.push_str(&format!("{byte:02x}"));
        }
        lines.push_str(&format!("  {}\n", file.display()));
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_a_missing_and_a_new_file_are_told() {
        let folder = std::env::temp_dir().join(format!("leadscrew-sums-{}", std::process::id()));
        fs::create_dir_all(folder.join("in")).unwrap();
        fs::write(folder.join("in/abc"), "abc").unwrap();
        write(&folder).unwrap();
        // The first example of FIPS 180-2.
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  in/abc\n";
        assert_eq!(fs::read_to_string(folder.join(NAME)).unwrap(), abc);
        check(&folder).unwrap();
        fs::write(folder.join("new"), "").unwrap();
        assert!(check(&folder).is_err());
        fs::remove_file(folder.join("new")).unwrap();
        fs::write(folder.join("in/abc"), "abd").unwrap();
        assert!(check(&folder).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }
}
