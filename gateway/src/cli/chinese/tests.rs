//! No text is in one language alone, and what is shown is Chinese and fits.

use std::collections::{BTreeMap, BTreeSet};

use clap::builder::StyledStr;
use leadscrew_common::words::is_wide;

use super::*;

/// The texts, by place: `io wait | args | level`.
type Texts = BTreeMap<String, String>;

/// Every command, with its place. `help` has no texts of its own.
fn commands() -> Vec<(String, Command)> {
    fn collect(command: Command, above: &str, all: &mut Vec<(String, Command)>) {
        let path = tables::path(above, command.get_name());
        for below in command.get_subcommands() {
            collect(below.clone(), &path, all);
        }
        all.push((path, command));
    }
    let mut all = Vec::new();
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    collect(command, "", &mut all);
    assert!(all.len() > 70, "{}", all.len());
    all
}

/// All English texts. What several commands have in the same words is under `shared` where the tables have it there.
fn english(tables: &Tables) -> Texts {
    let shared = |kind: &str, id: &str| {
        let of = tables.all().get(tables::SHARED).unwrap();
        let of = of.get_ref().get(kind).unwrap().get_ref();
        of.get(id).is_some()
    };
    let own = |path: &str, kind: &str, id: &str| {
        let of = tables.all().get(path).map(|words| words.get_ref());
        let of = of.and_then(|words| words.get(kind)).map(|of| of.get_ref());
        of.is_some_and(|of| of.get(id).is_some())
    };
    let whole = |short: Option<&StyledStr>, long: Option<&StyledStr>| {
        long.or(short).map(ToString::to_string)
    };
    let mut texts = Texts::new();
    texts.insert("shared | help".into(), "Print this message".into());
    for (path, command) in commands() {
        let about = whole(command.get_about(), command.get_long_about());
        texts.insert(format!("{path} | about"), about.unwrap_or_default());
        for arg in command.get_arguments().filter(|arg| !arg.is_hide_set()) {
            let id = arg.get_id().as_str();
            let mut add = |kind: &str, key: &str, text: String| {
                let at = match own(&path, kind, id) || !shared(kind, id) {
                    true => path.as_str(),
                    false => tables::SHARED,
                };
                let before = texts.insert(format!("{at} | {kind} | {key}"), text.clone());
                if let Some(before) = before {
                    assert_eq!(before, text, "{path}: `{id}` has two meanings");
                }
            };
            let text = match id {
                // Shorter where a command has no long help.
                "help" => "Print help".into(),
                _ => whole(arg.get_help(), arg.get_long_help()).unwrap_or_default(),
            };
            add("args", id, text);
            for value in arg.get_possible_values() {
                if let Some(text) = value.get_help() {
                    let key = format!("{id} | {}", value.get_name());
                    add("values", &key, text.to_string());
                }
            }
        }
    }
    texts
}

/// All Chinese texts but the remarks.
fn chinese(tables: &Tables) -> Texts {
    let mut texts = Texts::new();
    for (path, words) in tables.all() {
        let path = path.get_ref();
        for (kind, of) in words.get_ref().as_table().unwrap() {
            let kind = kind.get_ref();
            if kind == "remarks" {
                continue;
            }
            let of = of.get_ref();
            if let Some(text) = of.as_str() {
                texts.insert(format!("{path} | {kind}"), text.to_owned());
            }
            for (id, of) in of.as_table().into_iter().flatten() {
                let id = id.get_ref();
                let of = of.get_ref();
                if let Some(text) = of.as_str() {
                    texts.insert(format!("{path} | {kind} | {id}"), text.to_owned());
                }
                for (value, text) in of.as_table().into_iter().flatten() {
                    let text = text.get_ref().as_str().unwrap();
                    let at = format!("{path} | {kind} | {id} | {}", value.get_ref());
                    texts.insert(at, text.to_owned());
                }
            }
        }
    }
    texts
}

#[test]
fn the_files_are_read_whole_and_each_command_has_one_place() {
    let mut all = BTreeSet::new();
    for text in tables::FILES {
        for (path, _) in toml::de::DeTable::parse(text).unwrap().into_inner() {
            let path = path.into_inner();
            assert!(all.insert(path.clone()), "{path} is there twice");
        }
    }
}

/// Both ways: nobody adds an option in English alone, and no text stays of one that is gone.
#[test]
fn each_text_has_its_chinese_and_each_chinese_its_text() {
    let tables = Tables::read();
    let (english, chinese) = (english(&tables), chinese(&tables));
    let missing: Vec<_> = english
        .iter()
        .filter(|(at, _)| !chinese.contains_key(*at))
        .collect();
    assert!(missing.is_empty(), "no Chinese for {missing:#?}");
    let stale: Vec<_> = chinese
        .keys()
        .filter(|at| !english.contains_key(*at))
        .collect();
    assert!(stale.is_empty(), "nothing is called {stale:#?}");
    for (at, en) in &english {
        let zh = &chinese[at];
        assert!(!en.is_empty() && !zh.is_empty(), "{at} is empty");
        let longer = |text: &str| text.contains("\n\n");
        assert_eq!(longer(en), longer(zh), "{at}: one has a long text alone");
    }
}

/// What is typed is written once, in the English examples.
#[test]
fn the_words_of_examples_are_as_many() {
    let tables = Tables::read();
    for (path, command) in commands() {
        let lines = command.get_after_help().map(ToString::to_string);
        let lines = lines.unwrap_or_default();
        let words = tables::parts(&lines).map(|parts| parts.1);
        let words = words.filter(|words| !matches!(*words, "" | "Example:" | "Examples:"));
        let remarks = tables.all().get(path.as_str()).map(|of| of.get_ref());
        let remarks = remarks.and_then(|of| of.get("remarks"));
        let remarks = remarks.map_or(0, |of| of.get_ref().as_array().unwrap().len());
        assert_eq!(remarks, words.count(), "{path}");
    }
}

/// What `-h` and `--help` of each command show, so many places wide and one more.
fn helps(width: usize) -> Vec<(String, String)> {
    let mut all = Cli::command().term_width(width);
    all.build();
    let mut helps = Vec::new();
    collect(&mut translated(all, For::Help), &mut helps);
    return helps;

    fn collect(command: &mut Command, helps: &mut Vec<(String, String)>) {
        let name = command.get_bin_name().unwrap_or_default().to_owned();
        for text in [command.render_help(), command.render_long_help()] {
            helps.push((name.clone(), lines::joined(&text.to_string())));
        }
        for below in command.get_subcommands_mut() {
            collect(below, helps);
        }
    }
}

/// Three words of English beside each other that are no part of a command, a name or what is typed.
fn english_words(line: &str) -> bool {
    let (typed, words) = tables::parts(line).next().unwrap_or_default();
    let words = match typed.split_whitespace().next() {
        Some("leadscrew" | "export") => words,
        _ if line.starts_with("用法：") => "",
        _ => line,
    };
    let spoken = words.split('`').step_by(2);
    spoken
        .flat_map(|part| part.split(|c: char| is_wide(c) || ",.:;()[]…".contains(c)))
        .any(|part| {
            let plain =
                |word: &&str| word.len() > 1 && word.chars().all(|c| c.is_ascii_lowercase());
            let all: Vec<&str> = part.split_whitespace().collect();
            all.windows(3).any(|three| three.iter().all(plain))
        })
}

#[test]
fn a_help_in_chinese_has_no_english_sentence_and_fits_its_width() {
    assert!(english_words("  Print the move list"));
    for (name, help) in helps(10_000) {
        for line in help.lines() {
            assert!(!english_words(line), "{name}: {line}");
        }
    }
    let helps = helps(79);
    assert!(helps.len() > 140, "{}", helps.len());
    for (name, help) in helps {
        for line in help.lines() {
            let width: usize = line.chars().map(|c| 1 + usize::from(is_wide(c))).sum();
            let one_word = !line.trim_start().contains(' ') && !line.contains(is_wide);
            assert!(width <= 80 || one_word, "{name}: {width}: {line}");
            let private = |c| ('\u{e000}'..='\u{e00f}').contains(&c);
            assert!(!line.contains(private), "{name}: {line}");
        }
        for words in ["Usage", "Options", "[default", "Print", "possible"] {
            assert!(!help.contains(words), "{name}: {words}: {help}");
        }
        assert!(help.contains("用法："), "{name}");
    }
}

#[test]
fn a_help_in_english_has_no_chinese() {
    for (path, mut command) in commands() {
        let help = command.render_long_help().to_string();
        assert!(!help.contains(is_wide), "{path}: {help}");
    }
}

#[test]
fn a_page_has_no_english_heading() {
    let mut all = Cli::command().disable_help_subcommand(true);
    all.build();
    for name in ["leadscrew", "params", "run", "jog"] {
        let all = translated(all.clone(), For::Page);
        let command = all.find_subcommand(name).cloned().unwrap_or(all);
        let mut page = Vec::new();
        clap_mangen::Man::new(command).render(&mut page).unwrap();
        let page = in_chinese(&String::from_utf8(page).unwrap());
        let headings: Vec<_> = page
            .lines()
            .filter(|line| line.starts_with(".SH"))
            .collect();
        assert!(headings.len() > 4, "{headings:?}");
        for heading in headings {
            assert!(heading.contains(is_wide), "{name}: {heading}");
        }
        for line in page.lines().filter(|line| !line.contains("leadscrew")) {
            assert!(!english_words(line), "{name}: {line}");
        }
    }
}
