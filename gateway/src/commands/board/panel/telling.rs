//! What the machine does, as JSON for the page: state, places, messages. It must not know how the page gets it.

use std::collections::VecDeque;

use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::BoardStatus;
use leadscrew_core::link::{Logged, Status};
use leadscrew_core::units::Length;

use super::super::monitor::told::{Told, of_alarm, told};
use super::super::monitor::view::Tone;
use super::super::names;
use super::{object, text};
use crate::json::Json;
use crate::place::SourceLine;

/// State, alarm, overrides and place in the program.
pub fn levels(json: &mut Json, record: &Status, status: &BoardStatus) {
    json.text("state", status.state.name());
    match status.alarm {
        Some(number) => json.integer("number", i64::from(number)),
        None => json.null("number"),
    }
    match record.alarm.filter(|_| status.alarm.is_some()) {
        Some(alarm) => json.object_at("alarm", |json| {
            let told = [Lang::En, Lang::Zh].map(|lang| of_alarm(&alarm, Tone::Bad, lang));
            message(json, &told);
        }),
        None => json.null("alarm"),
    }
    json.flag("hold", status.flags.hold);
    json.flag("single", status.flags.single_block);
    json.flag("dry", status.flags.dry_run);
    match record.line {
        0 => json.null("line"),
        line => json.text("line", &SourceLine(line).to_string()),
    }
    json.integer("move", i64::from(record.number));
    json.integer("rpm", i64::from(record.speed.rpm().get()));
    json.integer("commanded", i64::from(record.command.get()));
    json.integer("feed", i64::from(record.feed_percent));
    json.integer("rapid", i64::from(record.rapid_percent));
    json.integer("turn", i64::from(record.spindle_percent));
    match record.sync_error {
        Some(error) => json.decimal::<3>("sync_um", error.nm()),
        None => json.null("sync_um"),
    }
    json.integer("late", i64::from(record.late));
}

/// Where the axes are, X as a diameter, by the work's zero and by the machine's.
pub fn places(json: &mut Json, record: &Status, zero: Option<[Length; 2]>) {
    let place = record.position;
    match zero {
        Some([x, z]) => {
            json.decimal::<6>("wx", (place.x - x).nm().saturating_mul(2));
            json.decimal::<6>("wz", (place.z - z).nm());
        }
        None => {
            json.null("wx");
            json.null("wz");
        }
    }
    json.decimal::<6>("mx", place.x.nm().saturating_mul(2));
    json.decimal::<6>("mz", place.z.nm());
    json.decimal::<6>("mc", place.c.udeg());
    match record.left {
        Some(left) => json.object_at("left", |json| {
            json.decimal::<6>("mx", left.x.nm().saturating_mul(2));
            json.decimal::<6>("mz", left.z.nm());
        }),
        None => json.null("left"),
    }
    json.text("referenced", &names(record.referenced));
    json.text("unreferenced", &names(record.unreferenced));
}

/// A message of the log in both languages.
pub fn in_both(entry: &Logged) -> Option<[Told; 2]> {
    Some([told(entry, Lang::En)?, told(entry, Lang::Zh)?])
}

/// The list of these messages.
pub fn log(messages: &VecDeque<[Told; 2]>) -> String {
    let mut json = Json::new();
    let items: Vec<String> = messages
        .iter()
        .map(|told| object(|json| message(json, told)))
        .collect();
    json.item(&format!("[{}]", items.join(",")));
    text(json)
}

fn message(json: &mut Json, told: &[Told; 2]) {
    let [en, zh] = told;
    let tone = match en.tone {
        Tone::Bad => "bad",
        Tone::Care => "care",
        Tone::Plain | Tone::Good | Tone::Old => "plain",
    };
    json.text("tone", tone);
    for (key, [en, zh]) in [
        ("text", [&en.text, &zh.text]),
        ("help", [&en.help, &zh.help]),
    ] {
        json.array_at(key, |json| {
            json.text_item(en);
            json.text_item(zh);
        });
    }
}
