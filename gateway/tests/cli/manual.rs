//! The pages of the cycles: their programs run, and each mistake gives the number that the page says. The Chinese pages
//! have the same programs, pictures and mistakes.

use crate::{Folder, code, leadscrew, root, stderr, stdout};

/// A page: its name, its text, and the program of the same name.
fn pages() -> Vec<(String, String, String)> {
    let read = |path: String| std::fs::read_to_string(root().join(path)).unwrap();
    let entries = std::fs::read_dir(root().join("docs/cycles")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names
        .filter_map(|name| Some(name.strip_suffix(".md")?.to_owned()))
        .map(|name| {
            let (page, program) = (
                format!("docs/cycles/{name}.md"),
                format!("examples/cycles/{name}.nc"),
            );
            (name, read(page), read(program))
        })
        .collect()
}

#[test]
fn each_page_shows_its_program_which_is_checked_and_run_without_a_warning() {
    let pages = pages();
    assert_eq!(pages.len(), 15);
    for (name, page, program) in pages {
        assert!(
            page.contains(&format!("```gcode\n{program}```\n")),
            "{name}: the page shows another program"
        );
        let path = format!("examples/cycles/{name}.nc");
        for command in ["check", "run"] {
            let output = leadscrew(&[command, &path]);
            assert_eq!(code(&output), 0, "{command} {path}: {}", stderr(&output));
            let told = stdout(&output) + &stderr(&output);
            assert!(!told.contains("warning"), "{command} {path}: {told}");
        }
    }
}

/// What a cell shows: code, with ⏎ between blocks, or nothing.
fn written(cell: &str) -> String {
    match cell {
        "(nothing)" => String::new(),
        cell => cell.trim_matches('`').replace(" ⏎ ", "\n"),
    }
}

#[test]
fn each_mistake_gives_the_number_that_its_page_says() {
    let folder = Folder::new("mistakes");
    let machine = root().join("examples/cycles/leadscrew.toml");
    std::fs::copy(machine, folder.file("leadscrew.toml")).unwrap();
    for (name, page, program) in pages() {
        let table = page.split_once("## Mistakes").unwrap().1;
        let rows = table.lines().filter(|line| line.starts_with("| `"));
        let mut count = 0;
        for row in rows {
            let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
            let [instead, other, number, _] = cells[..] else {
                panic!("{name}: {row}");
            };
            let instead = written(instead);
            assert!(
                program.contains(&instead),
                "{name}: the program has no `{instead}`"
            );
            let path = folder.file("mistake.nc");
            std::fs::write(&path, program.replace(&instead, &written(other))).unwrap();
            let output = leadscrew(&["check", &path]);
            let told = stdout(&output) + &stderr(&output);
            let first = told
                .split_once('[')
                .map_or("", |(_, rest)| rest.split(']').next().unwrap());
            assert_eq!(first, number, "{name}: {row}\n{told}");
            count += 1;
        }
        assert!(count >= 2, "{name} has {count} mistakes");
    }
}

/// What both languages have in common, in its order: blocks of code, the picture, and of each mistake the cells of code
/// and the number.
fn common(page: &str) -> Vec<String> {
    let mut inside = false;
    let mut common = Vec::new();
    for line in page.lines() {
        let fence = line.starts_with("```");
        if fence || inside {
            common.push(line.to_owned());
            inside ^= fence;
        } else if line.starts_with("![") {
            let picture = line.rsplit('/').next().unwrap_or_default();
            common.push(picture.to_owned());
        } else if line.starts_with("| `") {
            let cells: Vec<_> = line.split(" | ").take(3).collect();
            common.push(cells.join(" | ").replace("（不写）", "(nothing)"));
        }
    }
    common
}

#[test]
fn each_page_has_a_chinese_one_with_its_programs_pictures_and_mistakes() {
    for (name, page, _) in pages() {
        let chinese = root().join(format!("docs/zh/cycles/{name}.md"));
        let chinese = std::fs::read_to_string(&chinese).unwrap_or_default();
        assert_eq!(common(&chinese), common(&page), "{name}");
    }
}
