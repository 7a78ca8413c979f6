//! The manual: the pages of docs/ as a book in `target/manual`, with pictures that are made when it is built.
//!
//! The pages are written for a repository: some of their links lead out of docs/. A copy is made for the book, in which
//! these lead to copies of the files. This module knows pages and links; what a picture shows is the business of
//! `leadscrew plot`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, bail};
use pulldown_cmark::{Event, LinkType, Options, Parser, Tag};

use crate::{files, pages, run, tools};

const DOCS: &str = "docs";
/// The order of the pages.
const SUMMARY: &str = "docs/SUMMARY.md";
/// Each of these programs has a page of its name, whose picture is made of it.
const PROGRAMS: &str = "examples/cycles";
const PICTURES: &str = "cycles/pictures";
/// A file outside of docs/ is in this folder of the book; other pages and whole folders are looked at in the repository.
const OUTSIDE: &str = "repository";
const REPOSITORY: &str = "https://github.com/leadscrew/leadscrew/tree/main";

/// Builds the book.
pub fn write() -> Result<()> {
    let mdbook = tools::ensure(&tools::MDBOOK)?;
    let source = run::scratch("manual")?;
    fs::remove_dir_all(&source)?;
    copy(&source)?;
    pictures(&source.join(PICTURES))?;
    let out = out();
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("cannot renew {}", out.display()))?;
    }
    let mut build = run::command(&source, &mdbook.to_string_lossy(), &["build", "--dest-dir"]);
    build.arg(&out);
    run::read(build)?;
    println!("{} is the manual", out.join("index.html").display());
    Ok(())
}

/// Builds it, and looks for dead links, pages that are not in it, and programs that `check` refuses.
pub fn check() -> Result<()> {
    let mut wrong = lost()?;
    let leadscrew = run::programs(&["--bin", "leadscrew"])?.join("leadscrew");
    for program in programs()? {
        let check = ["check", &program];
        let check = run::command(&run::root(), &leadscrew.to_string_lossy(), &check);
        if let Err(error) = run::read(check) {
            wrong.push(format!("{program}: {error:#}"));
        }
    }
    pages::check()?;
    write()?;
    wrong.extend(dead(&out())?);
    if wrong.is_empty() {
        return Ok(());
    }
    bail!(
        "the manual has {} faults\n{}",
        wrong.len(),
        wrong.join("\n")
    )
}

/// Where it is built.
pub fn out() -> PathBuf {
    run::root().join("target").join("manual")
}

/// Lists pages that the book leaves out, and programs without a page. It builds nothing.
pub fn whole() -> Result<()> {
    let lost = lost()?;
    if lost.is_empty() {
        return Ok(());
    }
    bail!("the manual is not whole:\n{}", lost.join("\n"))
}

/// Pages that the summary does not name, and programs without a page.
fn lost() -> Result<Vec<String>> {
    let root = run::root();
    let summary = fs::read_to_string(root.join(SUMMARY)).context(SUMMARY)?;
    let named: BTreeSet<PathBuf> = links(&summary)
        .map(|(link, _)| pages::beside(Path::new(SUMMARY), &link))
        .collect();
    let pages = pages::paths(&root)?;
    let mut lost: Vec<String> = pages
        .iter()
        .filter(|page| *page != Path::new(SUMMARY) && !named.contains(*page))
        .map(|page| format!("{} is not in {SUMMARY}", page.display()))
        .collect();
    for program in programs()? {
        let page = Path::new(DOCS)
            .join("cycles")
            .join(Path::new(&program).file_name().unwrap_or_default());
        let page = page.with_extension("md");
        if !pages.contains(&page) {
            lost.push(format!("{program} has no page {}", page.display()));
        }
    }
    Ok(lost)
}

fn programs() -> Result<Vec<String>> {
    let names = files::of_kind(&run::root().join(PROGRAMS), "nc")?;
    let path = |name: String| format!("{PROGRAMS}/{name}.nc");
    Ok(names.into_iter().map(path).collect())
}

/// Draws each program as anybody does.
fn pictures(to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    let leadscrew = run::programs(&["--bin", "leadscrew"])?.join("leadscrew");
    for program in programs()? {
        let picture = to.join(Path::new(&program).file_name().unwrap_or_default());
        let picture = picture.with_extension("svg");
        let plot = [
            "plot",
            &program,
            "--lang",
            "en",
            "-o",
            &picture.to_string_lossy(),
        ];
        run::read(run::command(
            &run::root(),
            &leadscrew.to_string_lossy(),
            &plot,
        ))?;
    }
    Ok(())
}

/// Copies docs/ and README.md, with links as the book needs them, and what they lead to.
fn copy(to: &Path) -> Result<()> {
    let root = run::root();
    let docs = files::below(&root.join(DOCS))?;
    let docs = docs.iter().map(|file| Path::new(DOCS).join(file));
    let files = docs.chain([PathBuf::from("README.md")]);
    for file in files {
        let into = to.join(in_book(&file));
        if file.extension().is_none_or(|ending| ending != "md") {
            files::copy_file(&root.join(&file), &into)?;
            continue;
        }
        fs::create_dir_all(into.parent().unwrap_or(to))?;
        let text = fs::read_to_string(root.join(&file))?;
        let (text, outside) = with_links(&file, &text, |path| root.join(path).is_dir());
        fs::write(&into, text)?;
        for path in outside {
            files::copy_file(&root.join(&path), &to.join(in_book(&path)))
                .with_context(|| format!("{} links to {}", file.display(), path.display()))?;
        }
    }
    Ok(())
}

/// The place in the book of a file of the repository.
fn in_book(path: &Path) -> PathBuf {
    match path.strip_prefix(DOCS) {
        Ok(inside) => inside.to_owned(),
        Err(_) if path == Path::new("README.md") => PathBuf::from("introduction.md"),
        Err(_) => Path::new(OUTSIDE).join(path),
    }
}

/// The text of a page with the links of the book, and the files outside of docs/ that it leads to.
fn with_links(
    page: &Path,
    text: &str,
    is_folder: impl Fn(&Path) -> bool,
) -> (String, Vec<PathBuf>) {
    let mut out = text.to_owned();
    let mut outside = Vec::new();
    let found: Vec<_> = links(text).collect();
    // From behind, so that the places before stay.
    for (link, place) in found.into_iter().rev() {
        let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
        if file.is_empty() || link.contains("://") || link.starts_with("mailto:") {
            continue;
        }
        let path = pages::beside(page, file);
        let inside = path.starts_with(DOCS) || path == Path::new("README.md");
        let page_outside = !inside && path.extension().is_some_and(|ending| ending == "md");
        let mut new = if page_outside || is_folder(&path) {
            format!("{REPOSITORY}/{}", path.display())
        } else {
            if !inside {
                outside.push(path.clone());
            }
            let from = in_book(page);
            relative(from.parent().unwrap_or(Path::new("")), &in_book(&path))
        };
        if !anchor.is_empty() {
            new = format!("{new}#{anchor}");
        }
        if let Some(at) = out[place.clone()].rfind(&format!("]({link}")) {
            let at = place.start + at + 2;
            out.replace_range(at..at + link.len(), &new);
        }
    }
    (out, outside)
}

/// Links and pictures of a text, with their places.
fn links(text: &str) -> impl Iterator<Item = (String, std::ops::Range<usize>)> {
    let events = Parser::new_ext(text, Options::ENABLE_TABLES).into_offset_iter();
    events.filter_map(|(event, place)| match event {
        Event::Start(
            Tag::Link {
                link_type,
                dest_url,
                ..
            }
            | Tag::Image {
                link_type,
                dest_url,
                ..
            },
        ) if link_type != LinkType::Autolink => Some((dest_url.into_string(), place)),
        _ => None,
    })
}

/// The way from a folder to a file.
fn relative(from: &Path, to: &Path) -> String {
    let (from, to): (Vec<_>, Vec<_>) = (from.components().collect(), to.components().collect());
    let same = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[same..].iter().map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(to[same..].iter().copied()).collect();
    way.to_string_lossy().into_owned()
}

/// The links of the built pages that lead nowhere.
fn dead(book: &Path) -> Result<Vec<String>> {
    let mut dead = Vec::new();
    for file in files::below(book)? {
        let path = book.join(file);
        // The page of what is not found is seen anywhere.
        let is_page = path.extension().is_some_and(|ending| ending == "html");
        if !is_page || path.ends_with("404.html") {
            continue;
        }
        let text = fs::read_to_string(&path)?;
        for link in targets(&text) {
            if !leads(path.parent().unwrap_or(book), link) {
                dead.push(format!("{}: {link} leads nowhere", path.display()));
            }
        }
    }
    dead.sort();
    Ok(dead)
}

/// What a built page links to and shows.
fn targets(html: &str) -> impl Iterator<Item = &str> {
    let of = |key: &'static str| {
        html.split(key)
            .skip(1)
            .filter_map(|rest| rest.split('"').next())
    };
    of(" href=\"").chain(of(" src=\""))
}

fn leads(folder: &Path, link: &str) -> bool {
    let file = link.split(['#', '?']).next().unwrap_or_default();
    let elsewhere =
        link.contains("://") || link.starts_with("mailto:") || link.starts_with("data:");
    elsewhere || file.is_empty() || folder.join(file).exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_to_their_place_in_the_book() {
        let text = "[a](../README.md#x) ![p](../docs/images/p.png) [b](b.md) [c](../../examples/a.nc) [f](../../params) [r](../../a/README.md) <https://x.y>";
        let page = Path::new("docs/cycles/g1.md");
        let (text, outside) = with_links(page, text, |path| path == Path::new("params"));
        assert_eq!(
            text,
            "[a](../README.md#x) ![p](../docs/images/p.png) [b](b.md) [c](../repository/examples/a.nc) \
             [f](https://github.com/leadscrew/leadscrew/tree/main/params) \
             [r](https://github.com/leadscrew/leadscrew/tree/main/a/README.md) <https://x.y>"
        );
        assert_eq!(outside, [PathBuf::from("examples/a.nc")]);
        let (text, _) = with_links(
            Path::new("README.md"),
            "[a](docs/a.md) [b](LICENSE)",
            |_| false,
        );
        assert_eq!(text, "[a](a.md) [b](repository/LICENSE)");
        let (text, _) = with_links(Path::new("docs/SUMMARY.md"), "[a](../README.md)", |_| false);
        assert_eq!(text, "[a](introduction.md)");
    }

    #[test]
    fn what_a_built_page_shows_has_to_be_there() {
        let html =
            "<a href=\"#top\"><img src=\"none.svg\"> <a class=\"x\" href=\"https://x.y/none\">";
        let found: Vec<_> = targets(html).collect();
        assert_eq!(found, ["#top", "https://x.y/none", "none.svg"]);
        let here = run::root();
        let dead: Vec<_> = found
            .into_iter()
            .filter(|link| !leads(&here, link))
            .collect();
        assert_eq!(dead, ["none.svg"]);
    }
}
