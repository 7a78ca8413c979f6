//! The links between the pages lead somewhere, and each cited decision is on record.
//!
//! This module knows README.md and docs/. rustdoc checks the links in comments of the source.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use pulldown_cmark::{Event, LinkType, Options, Parser, Tag, TagEnd};

use crate::{files, run};

/// The list of decisions, one in a row.
const DECISIONS: &str = "docs/decisions.md";

/// A page: its anchors, its links, and the decisions that it cites.
#[derive(Debug, Default)]
struct Page {
    anchors: BTreeSet<String>,
    links: Vec<String>,
    cited: BTreeSet<u32>,
}

/// Lists every link that leads nowhere, and every cited decision without a row.
pub fn check() -> Result<()> {
    let root = run::root();
    let mut pages = BTreeMap::new();
    for path in paths(&root)? {
        let text = fs::read_to_string(root.join(&path))
            .with_context(|| format!("cannot read {}", path.display()))?;
        pages.insert(path, read(&text));
    }
    let exists = |path: &Path| root.join(path).exists() || is_made(&root, path);
    let mut wrong = dead(&pages, exists);
    let decisions = fs::read_to_string(root.join(DECISIONS)).context(DECISIONS)?;
    wrong.extend(undecided(&pages, &listed(&decisions)));
    if wrong.is_empty() {
        return Ok(());
    }
    bail!(
        "the pages have {} faults\n{}",
        wrong.len(),
        wrong.join("\n")
    )
}

/// True for a picture that is made when the manual is built, of the program of its name.
fn is_made(root: &Path, path: &Path) -> bool {
    let program = path.strip_prefix("docs/cycles/pictures").map(|name| {
        let program = Path::new("examples/cycles").join(name);
        program.with_extension("nc")
    });
    program.is_ok_and(|program| root.join(program).is_file())
}

/// README.md and the pages below docs/, relative to the root.
pub fn paths(root: &Path) -> Result<Vec<PathBuf>> {
    let docs = files::below(&root.join("docs"))?;
    let pages = docs
        .iter()
        .filter(|file| file.extension().is_some_and(|ending| ending == "md"));
    let mut found = vec![PathBuf::from("README.md")];
    found.extend(pages.map(|page| Path::new("docs").join(page)));
    found.sort();
    Ok(found)
}

fn read(text: &str) -> Page {
    let mut page = Page::default();
    let mut heading: Option<String> = None;
    for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
            Event::End(TagEnd::Heading(_)) => {
                let anchor = anchor(&heading.take().unwrap_or_default());
                // A repeated heading gets a number.
                let mut own = anchor.clone();
                for number in 1.. {
                    if page.anchors.insert(own) {
                        break;
                    }
                    own = format!("{anchor}-{number}");
                }
            }
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
            ) if link_type != LinkType::Autolink => page.links.push(dest_url.into_string()),
            Event::Text(text) | Event::Code(text) => {
                if let Some(heading) = &mut heading {
                    heading.push_str(&text);
                }
            }
            _ => {}
        }
    }
    page.cited = cited(text);
    page
}

/// The anchor of a heading: small letters, digits, hyphens in place of spaces, nothing else.
fn anchor(heading: &str) -> String {
    heading
        .to_lowercase()
        .chars()
        .filter_map(|c| match c {
            ' ' => Some('-'),
            '-' | '_' => Some(c),
            c => c.is_alphanumeric().then_some(c),
        })
        .collect()
}

/// The numbers in `[D7]`.
fn cited(text: &str) -> BTreeSet<u32> {
    text.split("[D")
        .skip(1)
        .filter_map(|rest| rest.split_once(']')?.0.parse().ok())
        .collect()
}

/// The numbers of decisions that have a row.
fn listed(decisions: &str) -> BTreeSet<u32> {
    decisions
        .lines()
        .filter_map(|line| line.strip_prefix("| D")?.split_once(' ')?.0.parse().ok())
        .collect()
}

fn dead(pages: &BTreeMap<PathBuf, Page>, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let mut wrong = Vec::new();
    for (path, page) in pages {
        for link in &page.links {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                file => beside(path, file),
            };
            let there = match pages.get(&target) {
                Some(page) => anchor.is_empty() || page.anchors.contains(anchor),
                None => anchor.is_empty() && exists(&target),
            };
            if !there {
                wrong.push(format!("{}: {link} leads nowhere", path.display()));
            }
        }
    }
    wrong
}

fn undecided(pages: &BTreeMap<PathBuf, Page>, listed: &BTreeSet<u32>) -> Vec<String> {
    let cited = pages
        .iter()
        .flat_map(|(path, page)| page.cited.iter().map(move |number| (path, number)));
    cited
        .filter(|(_, number)| !listed.contains(number))
        .map(|(path, number)| format!("{}: D{number} has no row", path.display()))
        .collect()
}

/// The file that `page` means by `name`.
pub fn beside(page: &Path, name: &str) -> PathBuf {
    let mut path = page.parent().map(Path::to_owned).unwrap_or_default();
    for part in Path::new(name).components() {
        match part {
            std::path::Component::ParentDir => {
                path.pop();
            }
            std::path::Component::CurDir => {}
            part => path.push(part),
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pages(all: &[(&str, &str)]) -> BTreeMap<PathBuf, Page> {
        let read = |(path, text): &(&str, &str)| (PathBuf::from(path), read(text));
        all.iter().map(read).collect()
    }

    #[test]
    fn a_link_that_leads_nowhere_is_told_with_its_page() {
        let pages = pages(&[
            (
                "README.md",
                "[a](docs/a.md#the-2nd-part) [b](docs/b.md) <https://x.y>",
            ),
            (
                "docs/a.md",
                "# The 2nd `part`\n[up](../README.md) [gone](#first) ![there](images/p.png)\n# Twice\n# Twice\n[t](#twice-1)",
            ),
        ]);
        let exists = |path: &Path| path == Path::new("docs/images/p.png");
        assert_eq!(
            dead(&pages, exists),
            [
                "README.md: docs/b.md leads nowhere",
                "docs/a.md: #first leads nowhere"
            ]
        );
    }

    #[test]
    fn a_decision_without_a_row_is_told() {
        let pages = pages(&[("docs/a.md", "so it is [D1], [D12] and [Dx]")]);
        let listed = listed("| D1 | what | so |\n| D2 | what | D12 |\n");
        assert_eq!(undecided(&pages, &listed), ["docs/a.md: D12 has no row"]);
    }
}
