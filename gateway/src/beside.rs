//! The machine file beside a program: `leadscrew.toml` in its folder or the nearest folder above.
//!
//! A shop keeps one in the folder of its programs. This module finds it; what it says is read like any machine file.

use std::path::{Path, PathBuf};

/// Name of the file.
pub const NAME: &str = "leadscrew.toml";

/// The nearest machine file of a program, as short as it can be shown.
pub fn find(program: &Path) -> Option<PathBuf> {
    let own = program.parent()?.join(NAME);
    if own.is_file() {
        return Some(own);
    }
    let whole = std::path::absolute(program).ok()?;
    let folders = whole.parent()?.ancestors().skip(1);
    let file = folders
        .map(|folder| folder.join(NAME))
        .find(|file| file.is_file())?;
    let here = std::env::current_dir().ok();
    let short = here.and_then(|here| file.strip_prefix(here).ok().map(Path::to_owned));
    Some(short.unwrap_or(file))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_file_counts() {
        let root = std::env::temp_dir().join(format!("leadscrew-beside-{}", std::process::id()));
        let (shop, part) = (root.join("shop"), root.join("shop").join("part"));
        std::fs::create_dir_all(&part).unwrap();
        let program = part.join("p.nc");
        std::fs::write(root.join(NAME), "").unwrap();
        assert_eq!(find(&program), Some(root.join(NAME)));
        std::fs::write(shop.join(NAME), "").unwrap();
        assert_eq!(find(&program), Some(shop.join(NAME)));
        std::fs::write(part.join(NAME), "").unwrap();
        assert_eq!(find(&program), Some(part.join(NAME)));
        std::fs::remove_dir_all(&root).unwrap();
    }
}
