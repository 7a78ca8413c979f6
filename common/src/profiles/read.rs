//! Reads a profile. A fact without a source is refused, as is a source without a fact, and whatever nobody would read.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

use super::Profile;
use super::facts::{Fact, Kind, Quirk, Reference, Value, kind};
use crate::values::{Mistake, decimal, mistake};
use crate::words::{Both, both};

/// Keys at the top that are no facts.
const NAME: &str = "name";
const TITLE: &str = "title";
const SOURCE: &str = "source";
const QUIRK: &str = "quirk";

/// A profile from the text of a file.
///
/// # Errors
/// The first thing that is wrong, with its line.
pub(super) fn profile(file: &str, text: &str) -> Result<Profile, Mistake> {
    let reader = Reader { file, text };
    let table = DeTable::parse(text).map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        reader.wrong(&span, &Both::same(error.message().to_owned()))
    })?;
    let table = table.get_ref();
    let sources = reader.sources(table)?;
    let mut used = vec![false; sources.len()];
    let mut facts = Vec::new();
    for (path, value) in leaves(table) {
        let span = value.span();
        let value = reader.value(&path, value)?;
        let source = reader.source_of(&path, &sources, &mut used, &span)?;
        facts.push((
            span.start,
            Fact {
                path,
                value,
                source,
            },
        ));
    }
    facts.sort_by_key(|(at, _)| *at);
    let facts = facts.into_iter().map(|(_, fact)| fact).collect();
    let quirks = reader.quirks(table, &sources, &mut used)?;
    if let Some((unused, _)) = sources.iter().zip(used).find(|(_, used)| !used) {
        let path = &unused.fact;
        return Err(reader.wrong(
            &unused.span,
            &both!(
                "the source of `{path}` has no fact: write the fact, or remove the source",
                "`{path}` 只有来源，没有内容：请写出内容，或删去来源"
            ),
        ));
    }
    Ok(Profile {
        name: reader.text(table, NAME)?,
        title: reader.text(table, TITLE)?,
        facts,
        quirks,
    })
}

/// A source, as it stands in the file.
struct Source {
    fact: String,
    reference: Reference,
    span: Range<usize>,
}

struct Reader<'a> {
    file: &'a str,
    text: &'a str,
}

impl Reader<'_> {
    fn wrong(&self, span: &Range<usize>, why: &Both) -> Mistake {
        let before = self.text.get(..span.start).unwrap_or(self.text);
        let (file, line) = (self.file, before.matches('\n').count() + 1);
        mistake!(
            "{file}:{line}: {en}",
            "{file}:{line}：{zh}",
            en = why.en,
            zh = why.zh
        )
    }

    fn text(&self, table: &DeTable, key: &str) -> Result<String, Mistake> {
        match table.get(key).map(|value| (value.get_ref(), value.span())) {
            Some((DeValue::String(text), _)) if !text.trim().is_empty() => Ok(text.to_string()),
            found => {
                let span = found.map_or(0..0, |(_, span)| span);
                Err(self.wrong(
                    &span,
                    &both!("`{key}` is missing, a text", "缺少文本 `{key}`"),
                ))
            }
        }
    }

    /// The tables of an array of tables.
    fn tables<'t, 'i>(
        &self,
        table: &'t DeTable<'i>,
        key: &str,
    ) -> Result<Vec<(&'t DeTable<'i>, Range<usize>)>, Mistake> {
        let Some(value) = table.get(key) else {
            return Ok(Vec::new());
        };
        let wrong = || {
            self.wrong(
                &value.span(),
                &both!(
                    "`{key}` has to be a list of tables",
                    "`{key}` 必须是表的列表"
                ),
            )
        };
        let DeValue::Array(all) = value.get_ref() else {
            return Err(wrong());
        };
        all.iter()
            .map(|one| match one.get_ref() {
                DeValue::Table(table) => Ok((table, one.span())),
                _ => Err(wrong()),
            })
            .collect()
    }

    fn sources(&self, table: &DeTable) -> Result<Vec<Source>, Mistake> {
        let mut sources = Vec::new();
        for (source, span) in self.tables(table, SOURCE)? {
            self.only(source, &["fact", "kind", "ref", "verified"], &span)?;
            let text = |key: &str| match source.get(key).map(Spanned::get_ref) {
                Some(DeValue::String(text)) => Some(text.to_string()),
                _ => None,
            };
            let verified = match source.get("verified").map(Spanned::get_ref) {
                Some(DeValue::Boolean(verified)) => Some(*verified),
                _ => None,
            };
            let kind = text("kind").filter(|kind| Reference::KINDS.contains(&kind.as_str()));
            let (Some(fact), Some(kind), Some(place), Some(verified)) =
                (text("fact"), kind, text("ref"), verified)
            else {
                let kinds = Reference::KINDS.join(", ");
                return Err(self.wrong(
                    &span,
                    &both!(
                        "a source has `fact`, `kind` (one of {kinds}), `ref` and `verified` (true or false)",
                        "来源需有 `fact`、`kind`（{kinds} 之一）、`ref` 和 `verified`（true 或 false）"
                    ),
                ));
            };
            let reference = Reference {
                kind,
                place,
                verified,
            };
            sources.push(Source {
                fact,
                reference,
                span,
            });
        }
        Ok(sources)
    }

    /// Refuses a key that nobody would read.
    fn only(&self, table: &DeTable, keys: &[&str], span: &Range<usize>) -> Result<(), Mistake> {
        match table
            .iter()
            .find(|(key, _)| !keys.contains(&key.get_ref().as_ref()))
        {
            None => Ok(()),
            Some((key, _)) => Err(self.unknown(key.get_ref(), span)),
        }
    }

    fn unknown(&self, key: &str, span: &Range<usize>) -> Mistake {
        self.wrong(
            span,
            &both!(
                "a profile has no key `{key}`: `leadscrew drives show {typical}` shows what there is",
                "配置中没有键 `{key}`：`leadscrew drives show {typical}` 可列出已有的键",
                typical = super::TYPICAL
            ),
        )
    }

    /// The most exact source of a fact.
    fn source_of(
        &self,
        path: &str,
        sources: &[Source],
        used: &mut [bool],
        span: &Range<usize>,
    ) -> Result<Reference, Mistake> {
        let covers = |fact: &str| {
            let rest = path.strip_prefix(fact);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let best = (0..sources.len())
            .filter(|at| covers(&sources[*at].fact))
            .max_by_key(|at| sources[*at].fact.len());
        let Some(best) = best else {
            return Err(self.wrong(
                span,
                &both!(
                    "`{path}` has no source: say in `source` where it is from, and `verified = false` if nobody has checked it",
                    "`{path}` 没有来源：请在 `source` 中注明出处，未核实时写 `verified = false`"
                ),
            ));
        };
        used[best] = true;
        Ok(sources[best].reference.clone())
    }

    fn value(&self, path: &str, value: &Spanned<DeValue>) -> Result<Value, Mistake> {
        let span = value.span();
        let kind = kind(path).ok_or_else(|| self.unknown(path, &span))?;
        let read = match (kind, value.get_ref()) {
            (Kind::Flag, DeValue::Boolean(flag)) => Some(Value::Flag(*flag)),
            (Kind::Text, DeValue::String(text)) => Some(Value::Text(text.to_string())),
            (Kind::Word(words), DeValue::String(text)) if words.contains(&text.as_ref()) => {
                Some(Value::Text(text.to_string()))
            }
            (Kind::Number(decimals, low, high), value) => number(value)
                .filter(|text| {
                    decimal(text, decimals).is_ok_and(|value| (low..=high).contains(&value))
                })
                .map(Value::Number),
            (Kind::Numbers, DeValue::Array(all)) => {
                let all = all.iter().map(|value| match value.get_ref() {
                    DeValue::Integer(value) => integer(value),
                    _ => None,
                });
                all.collect::<Option<Vec<_>>>().map(Value::List)
            }
            (Kind::Texts, DeValue::Array(all)) => {
                let all = all.iter().map(|value| match value.get_ref() {
                    DeValue::String(text) => Some(text.to_string()),
                    _ => None,
                });
                all.collect::<Option<Vec<_>>>().map(Value::List)
            }
            _ => None,
        };
        read.ok_or_else(|| {
            let expected = expected(kind);
            self.wrong(
                &span,
                &both!(
                    "`{path}` has to be {en}",
                    "`{path}` 必须是{zh}",
                    en = expected.en,
                    zh = expected.zh
                ),
            )
        })
    }

    fn quirks(
        &self,
        table: &DeTable,
        sources: &[Source],
        used: &mut [bool],
    ) -> Result<Vec<Quirk>, Mistake> {
        let mut quirks = Vec::new();
        for (quirk, span) in self.tables(table, QUIRK)? {
            self.only(quirk, &["id", "note", "test"], &span)?;
            let id = self.text(quirk, "id")?;
            let test = match quirk.get("test") {
                None => None,
                Some(_) => Some(self.text(quirk, "test")?),
            };
            quirks.push(Quirk {
                note: self.text(quirk, "note")?,
                test,
                source: self.source_of(&format!("{QUIRK}.{id}"), sources, used, &span)?,
                id,
            });
        }
        Ok(quirks)
    }
}

/// All values below the tables, each with its path.
fn leaves<'t, 'i>(table: &'t DeTable<'i>) -> Vec<(String, &'t Spanned<DeValue<'i>>)> {
    let mut found = Vec::new();
    for (key, value) in table.iter() {
        let key = key.get_ref();
        if ![NAME, TITLE, SOURCE, QUIRK].contains(&key.as_ref()) {
            below(key.to_string(), value, &mut found);
        }
    }
    found
}

fn below<'t, 'i>(
    path: String,
    value: &'t Spanned<DeValue<'i>>,
    found: &mut Vec<(String, &'t Spanned<DeValue<'i>>)>,
) {
    match value.get_ref() {
        DeValue::Table(table) => {
            for (key, value) in table.iter() {
                below(format!("{path}.{}", key.get_ref()), value, found);
            }
        }
        _ => found.push((path, value)),
    }
}

/// A number as it is written, where it is a plain decimal.
fn number(value: &DeValue) -> Option<String> {
    match value {
        DeValue::Integer(value) => integer(value),
        DeValue::Float(value) => Some(value.as_str().to_owned()),
        _ => None,
    }
}

fn integer(value: &DeInteger) -> Option<String> {
    (value.radix() == 10).then(|| value.as_str().to_owned())
}

fn expected(kind: Kind) -> Both {
    match kind {
        Kind::Flag => Both::same("true / false".to_owned()),
        Kind::Number(decimals, low, high) => {
            let shown = |value: i64| {
                let unit = 10_i64.pow(u32::try_from(decimals).unwrap_or(0));
                let (whole, rest) = (value / unit, value % unit);
                if rest == 0 {
                    whole.to_string()
                } else {
                    let text = format!("{whole}.{rest:0decimals$}");
                    text.trim_end_matches('0').to_owned()
                }
            };
            let (low, high) = (shown(low), shown(high));
            both!(
                "a decimal number from {low} to {high}, with {decimals} decimals at most",
                "{low} 至 {high} 的十进制数，最多 {decimals} 位小数"
            )
        }
        Kind::Word(words) => {
            let words = words.join(", ");
            both!("one of {words}", " {words} 之一")
        }
        Kind::Text => both!("a text", "文本"),
        Kind::Numbers => both!("a list of whole numbers", "整数列表"),
        Kind::Texts => both!("a list of texts", "文本列表"),
    }
}
