//! `drives`: the profiles of drives, and what they say.

use leadscrew_core::alarm::Lang;

use crate::cli::{DrivesCommand, Global};
use crate::failure::Outcome;
use crate::json::Json;
use crate::output;
use crate::profiles::{IDEAL, Profile, Reference};
use crate::words::{both, pick};

/// Prints profiles.
pub fn run(global: &Global, command: &DrivesCommand) -> Outcome {
    match command {
        DrivesCommand::List => list(global),
        DrivesCommand::Show { name } => show(global, name),
    }
}

fn list(global: &Global) -> Outcome {
    let all: Vec<Profile> = Profile::built_in().collect();
    if global.json {
        return output::json(|json| {
            json.array_at("drives", |json| {
                for profile in &all {
                    json.object(|json| head(profile, json));
                }
            });
        });
    }
    let lang = global.lang();
    let width = all
        .iter()
        .map(|profile| profile.name.len())
        .max()
        .unwrap_or(0);
    let ideal = pick(
        lang,
        "is where it is told; what counts where no drive is named",
        "始终在设定位置；未指定驱动器时即为此项",
    );
    let mut text = format!("{IDEAL:width$}  {ideal}\n");
    for profile in &all {
        let (name, title) = (&profile.name, &profile.title);
        let (facts, unverified) = profile.counts();
        let told = both!(
            "{name:width$}  {title}; {unverified} of its {facts} facts not verified\n",
            "{name:width$}  {title}；{facts} 项中 {unverified} 项未核实\n"
        );
        text.push_str(told.get(lang));
    }
    output::write(text.as_bytes())
}

fn head(profile: &Profile, json: &mut Json) {
    let (facts, unverified) = profile.counts();
    json.text("name", &profile.name);
    json.text("title", &profile.title);
    json.number("facts", facts);
    json.number("not_verified", unverified);
}

fn show(global: &Global, name: &str) -> Outcome {
    let profile = Profile::find(name, global.lang())?;
    if global.json {
        return output::json(|json| {
            head(&profile, json);
            json.array_at("all_facts", |json| {
                for fact in &profile.facts {
                    json.object(|json| {
                        json.text("fact", &fact.path);
                        json.text("value", &fact.value.text());
                        of(&fact.source, json);
                    });
                }
            });
            json.array_at("quirks", |json| {
                for quirk in &profile.quirks {
                    json.object(|json| {
                        json.text("id", &quirk.id);
                        json.text("note", &quirk.note);
                        json.flag("simulated", quirk.test.is_some());
                        of(&quirk.source, json);
                    });
                }
            });
        });
    }
    output::write(text(&profile, global.lang()).as_bytes())
}

fn of(source: &Reference, json: &mut Json) {
    json.text("kind", &source.kind);
    json.text("ref", &source.place);
    json.flag("verified", source.verified);
}

fn text(profile: &Profile, lang: Lang) -> String {
    let mut text = format!("{}: {}\n", profile.name, profile.title);
    let rows: Vec<[String; 3]> = profile
        .facts
        .iter()
        .map(|fact| {
            let source = fact.source.words().get(lang).to_owned();
            [fact.path.clone(), fact.value.text(), source]
        })
        .collect();
    let width = |of: usize| {
        rows.iter()
            .map(|row| row[of].chars().count())
            .max()
            .unwrap_or(0)
    };
    let (paths, values) = (width(0), width(1));
    for [path, value, source] in &rows {
        text.push_str(&format!("  {path:paths$}  {value:values$}  {source}\n"));
    }
    for quirk in &profile.quirks {
        let simulated = match quirk.test {
            Some(_) => pick(lang, "simulated", "已模拟"),
            None => pick(lang, "not simulated", "未模拟"),
        };
        let source = quirk.source.words();
        let (id, note, source) = (&quirk.id, &quirk.note, source.get(lang));
        text.push_str(&format!("  quirk {id}: {note} ({simulated}; {source})\n"));
    }
    if !profile
        .facts
        .iter()
        .any(|fact| fact.path.starts_with("figures."))
    {
        let typical = crate::profiles::TYPICAL;
        let told = both!(
            "  loops and mechanics: the figures of {typical}\n",
            "  控制环与机械参数：采用 {typical} 的数值\n"
        );
        text.push_str(told.get(lang));
    }
    text
}
