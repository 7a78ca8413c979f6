//! The page of the shop's programs, docs/shop.md, and their pictures below docs/pictures/shop.
//!
//! `leadscrew plot --path` draws, as for anybody. This module says what each program is for; it knows nothing of their
//! language.

use std::collections::BTreeMap;
use std::fs;

use anyhow::{Context, Result, bail};

use crate::{files, run};

const PROGRAMS: &str = "examples/shop";
const PICTURES: &str = "docs/pictures/shop";
const PAGE: &str = "docs/shop.md";
/// A picture with more bytes than this shows more than anyone sees.
const MOST: usize = 60_000;

/// A program: its name, what it makes, and what it shows of the language. The page has them in this order.
#[rustfmt::skip]
const SHOP: &[(&str, &str, &str)] = &[
    ("shaft-roughing", "a shaft 40×60 with a thread M20×2.5", "`G71` over a shoulder, an arc and a taper, `G70`, `G92`"),
    ("pocket-g71", "a pulley with three grooves", "`G71` type II: the first block of the contour names X and Z; `G70`"),
    ("casting-g73", "a casting, cut in three steps", "`G73` follows the contour, `G70` finishes it at a constant surface speed"),
    ("bush", "a bush 50×32, parted off", "`G94` faces, `G90` bores and turns, `G75` parts off; three tools"),
    ("face-g96", "a disc 100×20", "`G96` with the limit of `G50 S`, past the centre line"),
    ("corners-gsk", "a pin", "corners by `L` and `D`, as on a GSK 980TD"),
    ("nose-outside", "a stud", "a round nose on the right, `G42`, with `,C` and `,R` in a contour of `G71` and `G70`"),
    ("nose-bore", "the bore of a bush", "a round nose on the left, `G41`, with `G3`"),
    ("drill-bore-tap", "a flange with a hole M12", "`G83` with pecks, `G90` in a bore, rigid tapping by `M29` and `G84`"),
    ("side-holes", "four holes in the side of a shaft", "`G87` with a driven tool; C takes each hole under it, so that all four are one line here"),
    ("pipe-g92", "a taper pipe thread R1/2", "`G92` with `R`"),
    ("pipe-g76", "the same thread", "`G76` with `R`, finishing passes and run-out"),
    ("worm-g78", "a worm of module 2 with two starts", "`G78` with `L`, in millimetres with points"),
    ("face-g32", "the scroll of a chuck", "a thread on the face by `G32`, in a loop of a macro"),
    ("nipple-g32", "a nipple with a thread that runs out as a taper", "strokes of `G32` that are one thread: straight, taper, out of the work"),
    ("groove-bank", "five ring grooves with broken corners", "`M98` with repeats, subprograms that call others, `G75`, `W`"),
    ("part-off", "eight rings from a tube", "a subprogram that is repeated, `G75`"),
    ("part-family", "a stepped pin", "macro B: `G65` with arguments, `IF`, `WHILE`, alarms of the program's own by `#3000`"),
    ("macro-a", "four grooves, each deeper than the one before", "macro A: `G65 H`, with a jump"),
    ("cam-posted", "a shaft with two tools", "what CAM programs post: `N` in each block, `G28 U0 W0`, `G96`, `G42`, arcs by `I K`"),
    ("shaft-fanuc-b", "a threaded shaft", "`(DIALECT FANUC-B)`: `G90` and `G91`, `G92` sets coordinates, `G78` and `G79` are cycles"),
    ("shaft-fanuc-c", "a threaded shaft", "`(DIALECT FANUC-C)`: `G71` is millimetres, `G73` roughs, `G72` finishes, `G20` and `G21` are cycles"),
    ("shaft-haas", "a threaded shaft", "`(DIALECT HAAS)`: `G71` and `G76` in one block each, `T101`, `G53`"),
];

const HEAD: &str = "\
# Programs of a shop

Small programs for real parts, one for each idea of the language. All of them are checked, simulated and run by the tests.
[Their machine file](../examples/shop/leadscrew.toml) lies beside them. This page and its pictures are made by
`cargo xtask pictures`, each picture by `leadscrew plot PROG --path -o FILE.svg`: Z to the right, X upwards as a
diameter, cuts drawn solid, rapids dashed.

| path | program | makes | shows |
|---|---|---|---|
";

/// Draws all pictures and writes the page.
pub fn write() -> Result<()> {
    let root = run::root();
    let folder = root.join(PICTURES);
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {PICTURES}"))?;
    let made = made()?;
    for name in files::of_kind(&folder, "svg")? {
        if !made.contains_key(&picture(&name)) {
            fs::remove_file(folder.join(format!("{name}.svg")))?;
        }
    }
    for (path, text) in &made {
        fs::write(root.join(path), text).with_context(|| format!("cannot write {path}"))?;
    }
    let bytes: usize = made.values().map(String::len).sum();
    println!("{} files, {bytes} bytes", made.len());
    Ok(())
}

/// Draws them again, and compares.
pub fn check() -> Result<()> {
    let root = run::root();
    let kept = |path: &str| fs::read_to_string(root.join(path)).ok();
    let there = files::of_kind(&root.join(PICTURES), "svg")?;
    let there: Vec<String> = there.iter().map(|name| picture(name)).collect();
    let stale = stale(&made()?, &there, kept);
    if stale.is_empty() {
        return Ok(());
    }
    bail!(
        "not current; `cargo xtask renew` makes them, with all other files that the program writes:\n{}",
        stale.join("\n")
    )
}

/// What is not as it would be made now, and pictures of no program.
fn stale(
    made: &BTreeMap<String, String>,
    there: &[String],
    kept: impl Fn(&str) -> Option<String>,
) -> Vec<String> {
    let changed = made
        .iter()
        .filter(|(path, text)| kept(path).as_ref() != Some(*text))
        .map(|(path, _)| path.clone());
    let left = there.iter().filter(|path| !made.contains_key(*path));
    changed.chain(left.cloned()).collect()
}

/// The page and the pictures, by their paths.
fn made() -> Result<BTreeMap<String, String>> {
    let root = run::root();
    let programs = files::of_kind(&root.join(PROGRAMS), "nc")?;
    let mut made = BTreeMap::from([(PAGE.to_owned(), page(SHOP, &programs)?)]);
    let leadscrew = run::programs(&["--bin", "leadscrew"])?.join("leadscrew");
    let scratch = run::scratch("pictures")?.join("picture.svg");
    for name in programs {
        let program = format!("{PROGRAMS}/{name}.nc");
        let to = scratch.to_string_lossy();
        let args = ["plot", &program, "--path", "--lang", "en", "-o", &to];
        run::read(run::command(&root, &leadscrew.to_string_lossy(), &args))?;
        let text = fs::read_to_string(&scratch)?;
        if text.len() > MOST {
            bail!("the picture of {program} takes {} bytes", text.len());
        }
        made.insert(picture(&name), text);
    }
    Ok(made)
}

fn picture(name: &str) -> String {
    format!("{PICTURES}/{name}.svg")
}

/// The page, where each program has a row and each row a program.
fn page(rows: &[(&str, &str, &str)], programs: &[String]) -> Result<String> {
    if let Some(name) = programs
        .iter()
        .find(|name| rows.iter().all(|row| row.0 != **name))
    {
        bail!("{PROGRAMS}/{name}.nc has no row in xtask/src/pictures.rs");
    }
    let mut text = HEAD.to_owned();
    for (name, makes, shows) in rows {
        if programs.iter().all(|program| program != name) {
            bail!("xtask/src/pictures.rs has a row for {name}, and {PROGRAMS} no program of it");
        }
        text.push_str(&format!(
            "| <img src=\"pictures/shop/{name}.svg\" alt=\"tool path of {name}.nc\" width=\"420\"> \
             | [{name}.nc](../{PROGRAMS}/{name}.nc) | {makes} | {shows} |\n"
        ));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: &[(&str, &str, &str)] = &[("b", "a pin", "`G1`"), ("a", "a ring", "`G75`")];

    fn names(all: &[&str]) -> Vec<String> {
        all.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn each_program_has_its_row_in_the_order_of_the_table() {
        let text = page(ROWS, &names(&["a", "b"])).unwrap();
        let rows: Vec<&str> = text.lines().filter(|line| line.contains("<img")).collect();
        assert_eq!(rows.len(), 2);
        assert!(rows[0].contains("pictures/shop/b.svg") && rows[0].ends_with("| a pin | `G1` |"));
        let missing = page(ROWS, &names(&["a", "b", "c"])).unwrap_err();
        assert!(missing.to_string().contains("c.nc has no row"));
        let gone = page(ROWS, &names(&["a"])).unwrap_err();
        assert!(gone.to_string().contains("a row for b"));
    }

    #[test]
    fn what_has_changed_is_missing_or_is_of_no_program_is_stale() {
        let made = ["x", "y", "z"].map(|path| (path.to_owned(), format!("{path} new")));
        let kept = |path: &str| match path {
            "x" => Some("x new".to_owned()),
            "y" => Some("y old".to_owned()),
            _ => None,
        };
        let there = names(&["x", "y", "left"]);
        assert_eq!(
            stale(&BTreeMap::from(made), &there, kept),
            ["y", "z", "left"]
        );
    }
}
