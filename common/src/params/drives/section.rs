//! Reads `[drive.NAME]` of a file into a list of objects with their values.

use std::ops::Range;
use std::path::Path;

use leadscrew_core::alarm::Code;
use leadscrew_core::bus::{Mapped, Object};
use toml::Spanned;
use toml::de::{DeInteger, DeString, DeTable, DeValue};

use super::objects::{DriveName, KNOWN, Kind, Known, PDOS, PERIOD, PERIOD_EXPONENT, PERIOD_VALUE};
use super::{OfProfile, Setting, Wanted, period_of};
use crate::diagnostics::Place;
use crate::params::Loader;
use crate::params::file::{Source, in_order};
use crate::profiles::Profile;

/// The key of the profile.
const PROFILE: &str = "profile";

/// The mapping of RPDO1.
const COMMAND_MAPPING: u16 = 0x1600;

type Key<'a, 'i> = &'a Spanned<DeString<'i>>;
type Value<'a, 'i> = &'a Spanned<DeValue<'i>>;

/// Reads the sections under `drive`.
pub fn apply(loader: &mut Loader, source: &Source, key: Key, value: Value) {
    let DeValue::Table(drives) = value.get_ref() else {
        let figures = [String::new()];
        return loader.report(Code::DriveUnknown, &figures, &source.place(&key.span()));
    };
    for (name, value) in in_order(drives) {
        let text = name.get_ref().as_ref();
        match (DriveName::find(text), value.get_ref()) {
            (Some(drive), DeValue::Table(objects)) => {
                let mut section = Section {
                    loader,
                    source,
                    drive,
                };
                section.read(objects);
            }
            _ => loader.report(
                Code::DriveUnknown,
                &[text.to_owned()],
                &source.place(&name.span()),
            ),
        }
    }
}

struct Section<'l, 's> {
    loader: &'l mut Loader,
    source: &'s Source<'s>,
    drive: DriveName,
}

impl Section<'_, '_> {
    fn read(&mut self, objects: &DeTable) {
        for (key, value) in in_order(objects) {
            let name = key.get_ref().as_ref();
            match value.get_ref() {
                // `60C2.1 = 1` without quotes.
                DeValue::Table(parts) if !is_typed(parts) => {
                    for (part, value) in in_order(parts) {
                        let name = format!("{name}.{}", part.get_ref().as_ref());
                        self.object(&name, part, value);
                    }
                }
                _ => self.object(name, key, value),
            }
        }
    }

    fn object(&mut self, name: &str, key: Key, value: Value) {
        if name == PERIOD {
            return self.period(value);
        }
        if name == PROFILE {
            return self.profile(value);
        }
        if let Some(&(_, mapping, communication)) = PDOS.iter().find(|pdo| pdo.0 == name) {
            return self.mapping(name, value, mapping, communication);
        }
        let known = KNOWN.iter().find(|known| known.name == name);
        let object = known.map(|known| known.object).or_else(|| parse(name));
        let Some(object) = object else {
            let figures = [self.drive.to_string(), name.to_owned()];
            let place = self.source.place(&key.span());
            return self
                .loader
                .report(Code::DriveObjectUnknown, &figures, &place);
        };
        let known = KNOWN.iter().find(|known| known.object == object);
        self.number(name, object, known, value);
    }

    fn number(&mut self, name: &str, object: Object, known: Option<&Known>, value: Value) {
        let place = self.source.place(&value.span());
        let mut span = value.span();
        let (kind, value) = match value.get_ref() {
            DeValue::Integer(integer) => {
                let Some(known) = known else {
                    let figures = [self.drive.to_string(), name.to_owned()];
                    return self.loader.report(Code::DriveType, &figures, &place);
                };
                (known.kind, integer_of(integer))
            }
            DeValue::Table(table) => {
                let kind = match table.get("type").map(Spanned::get_ref) {
                    Some(DeValue::String(kind)) => Kind::find(kind),
                    _ => None,
                };
                let inner = table.get("value");
                span = inner.map_or(span, Spanned::span);
                let value = match inner.map(Spanned::get_ref) {
                    Some(DeValue::Integer(integer)) => integer_of(integer),
                    _ => None,
                };
                let right = known.is_none_or(|known| kind == Some(known.kind));
                let Some(kind) = kind.filter(|_| right && table.len() == 2) else {
                    let expected = match known {
                        Some(known) => format!("`{}`", known.kind.name()),
                        None => "`{ type = \"u16\", value = 0 }`".into(),
                    };
                    return self.wrong(name, "such a table", &expected, &place);
                };
                (kind, value)
            }
            other => {
                let (low, high) = known.map_or((0, i64::from(u32::MAX)), |k| k.kind.range());
                let shown = match other {
                    DeValue::String(_) => "a text",
                    DeValue::Float(_) => "a decimal number",
                    _ => "anything but a number",
                };
                return self.wrong(name, shown, &range(low, high), &place);
            }
        };
        let (low, high) = kind.range();
        match value.filter(|value| (low..=high).contains(value)) {
            Some(value) => self.push(
                Wanted::Number {
                    object,
                    kind,
                    value,
                },
                place,
                span,
            ),
            None => {
                let shown = format!("`{}`", &place_text(&place));
                self.wrong(name, &shown, &range(low, high), &place);
            }
        }
    }

    /// `interpolation_period = "1 ms"`: both sub-indices of 60C2h.
    fn period(&mut self, whole: Value) {
        let place = self.source.place(&whole.span());
        let us = match whole.get_ref() {
            DeValue::String(text) => microseconds(text),
            _ => None,
        };
        let Some((value, exponent)) = us.and_then(period_of) else {
            let shown = format!("`{}`", place_text(&place));
            return self.wrong(
                PERIOD,
                &shown,
                "a time such as `\"1 ms\"`, `\"250 µs\"`",
                &place,
            );
        };
        let span = whole.span();
        for (object, kind, value) in [
            (PERIOD_VALUE, Kind::U8, i64::from(value)),
            (PERIOD_EXPONENT, Kind::I8, i64::from(exponent)),
        ] {
            let wanted = Wanted::Number {
                object,
                kind,
                value,
            };
            self.push(wanted, place.clone(), span.clone());
        }
    }

    /// `profile = "maxon-epos4"`, or a file beside this one.
    fn profile(&mut self, value: Value) {
        let place = self.source.place(&value.span());
        let DeValue::String(name) = value.get_ref() else {
            let expected = "a name that `leadscrew drives list` prints: `\"maxon-epos4\"`";
            return self.wrong(PROFILE, "anything but a text", expected, &place);
        };
        let path = Path::new(self.source.name()).with_file_name(name.as_ref());
        match Profile::find_at(name, &path, self.loader.lang) {
            Ok(profile) => {
                let drive = self.drive;
                let named = &mut self.loader.loaded.profiles;
                named.retain(|before| before.drive != drive);
                named.push(OfProfile {
                    drive,
                    profile,
                    layer: self.loader.layer,
                    place,
                    span: value.span(),
                });
            }
            Err(failure) => {
                let words = failure.words().unwrap_or_default();
                let figures = [
                    self.drive.to_string(),
                    words.get(self.loader.lang).to_owned(),
                ];
                self.loader.report(Code::DriveProfile, &figures, &place);
            }
        }
    }

    /// `rpdo1 = ["6040/16", "607A/32"]`.
    fn mapping(&mut self, name: &str, value: Value, mapping: u16, communication: u16) {
        let place = self.source.place(&value.span());
        let objects = match value.get_ref() {
            DeValue::Array(list) => list
                .iter()
                .map(|item| match item.get_ref() {
                    DeValue::String(text) => mapped(text),
                    _ => None,
                })
                .collect::<Option<Vec<_>>>(),
            _ => None,
        };
        // In the frame with all setpoints (9031) the objects of a drive follow those of other drives. No other PDO is
        // longer than eight bytes. No object is shorter than one byte.
        let room = match mapping {
            COMMAND_MAPPING => 64,
            _ => 8,
        };
        let fits = |list: &Vec<Mapped>| {
            let bytes = usize::from(Mapped::bytes(list));
            bytes <= room && list.len() <= room
        };
        match objects.filter(fits) {
            Some(objects) => self.push(
                Wanted::Mapping {
                    mapping,
                    communication,
                    objects,
                },
                place,
                value.span(),
            ),
            None => {
                let shown = format!("`{}`", place_text(&place));
                let expected = format!(
                    "objects with their bits, {} at most: `[\"6040/16\", \"607A/32\"]`",
                    8 * room
                );
                self.wrong(name, &shown, &expected, &place);
            }
        }
    }

    fn wrong(&mut self, name: &str, found: &str, expected: &str, place: &Place) {
        let figures = [
            self.drive.to_string(),
            name.to_owned(),
            found.to_owned(),
            expected.to_owned(),
        ];
        self.loader.report(Code::DriveValue, &figures, place);
    }

    fn push(&mut self, wanted: Wanted, place: Place, span: Range<usize>) {
        let setting = Setting {
            drive: self.drive,
            wanted,
            layer: self.loader.layer,
            place,
            span,
            by_profile: false,
        };
        let before = self.loader.loaded.drives.iter_mut().find(|other| {
            other.drive == setting.drive && other.wanted.object() == setting.wanted.object()
        });
        match before {
            Some(before) if before.layer == setting.layer => {
                let figures = [
                    self.drive.to_string(),
                    super::object_text(before.wanted.object()),
                    before.place.line.to_string(),
                ];
                self.loader
                    .report(Code::DriveTwice, &figures, &setting.place);
            }
            Some(before) => *before = setting,
            None => self.loader.loaded.drives.push(setting),
        }
    }
}

/// The text at a place, cut to one line.
fn place_text(place: &Place) -> String {
    let taken = place.end_column.saturating_sub(place.column);
    place
        .text
        .chars()
        .skip(place.column.saturating_sub(1))
        .take(taken.min(60))
        .collect()
}

fn range(low: i64, high: i64) -> String {
    format!("{low} … {high}")
}

/// `{ type = …, value = … }`.
fn is_typed(table: &DeTable) -> bool {
    table.contains_key("type") || table.contains_key("value")
}

/// Any whole number of a file, in any base.
fn integer_of(integer: &DeInteger) -> Option<i64> {
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

/// `60C2.1`, `60C2h:01`: both hexadecimal.
fn parse(name: &str) -> Option<Object> {
    let (index, sub) = match name.split_once(['.', ':']) {
        Some((index, sub)) => (index, sub),
        None => (name, "0"),
    };
    let hex = |text: &str, digits: usize| {
        let text = text.strip_suffix(['h', 'H']).unwrap_or(text);
        let good =
            (1..=digits).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_hexdigit());
        good.then(|| u16::from_str_radix(text, 16).ok()).flatten()
    };
    // Four digits, so that a misspelt name is not taken for a number.
    let index = (index.trim_end_matches(['h', 'H']).len() == 4)
        .then(|| hex(index, 4))
        .flatten()?;
    Some(Object::new(index, u8::try_from(hex(sub, 2)?).ok()?))
}

/// `607A/32`.
fn mapped(text: &str) -> Option<Mapped> {
    let (object, bits) = text.split_once('/')?;
    let object = parse(object.trim())?;
    let bits: u8 = bits.trim().parse().ok()?;
    matches!(bits, 8 | 16 | 24 | 32 | 64).then(|| Mapped::new(object.index, object.sub, bits))
}

/// `1 ms`, `250 µs`.
fn microseconds(text: &str) -> Option<i64> {
    let text = text.trim();
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    let (number, unit) = text.split_at(digits);
    let number: i64 = number.parse().ok()?;
    match unit.trim() {
        "ms" => number.checked_mul(1000),
        // The micro sign, the Greek letter, and the letter on keyboards.
        "\u{b5}s" | "\u{3bc}s" | "us" => Some(number),
        _ => None,
    }
}
