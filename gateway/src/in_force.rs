//! A parameter set as an agent tells it: the values that are not the built-in machine's, by the names of a machine file.
//!
//! Both ends are here, so that what one writes the other reads. What comes from a broker may be anybody's, and of another
//! version: it is taken where it makes the set of the checksum that is told with it, and not otherwise.

use std::collections::BTreeMap;

use leadscrew_agent::set::Set;
use leadscrew_core::link::identity;
use leadscrew_core::params::{Entry, PASSWORD, PASSWORD_KEPT, Params, Writing};

use crate::params::difference::{Change, changes};
use crate::params::schema::SCHEMA;
use crate::params::{literal, name};
use crate::words::{Both, both, one_line};

/// Characters of a foreign name that are shown.
const SHOWN: usize = 60;

/// The values of a set. That it has a password is told, as the board tells it, and never the password.
#[must_use]
pub fn values(params: &Params) -> BTreeMap<String, String> {
    let changes = changes(&Params::slant_bed(), params);
    let value = |change: &Change| {
        let raw = match change.entry.no {
            PASSWORD => PASSWORD_KEPT,
            _ => change.new,
        };
        let text = literal(change.entry, raw);
        (name(change.entry), text.trim_matches('"').to_owned())
    };
    changes.iter().map(value).collect()
}

/// The set that a message tells.
///
/// # Errors
/// Why it is not known here.
pub fn params(set: &Set) -> Result<Params, Both> {
    let Some(values) = &set.values else {
        return Err(both!(
            "its agent does not know the table of its parameters: let the agent be of the board's version",
            "其代理程序不认识该参数表：请使用与控制板版本一致的代理程序"
        ));
    };
    if set.schema != SCHEMA {
        return Err(both!(
            "its table has version {of}, that of this program {SCHEMA}: use the version of its agent",
            "其参数表版本为 {of}，本程序为 {SCHEMA}：请使用与其代理程序相同的版本",
            of = set.schema
        ));
    }
    let mut params = Params::slant_bed();
    for (key, text) in values {
        let taken = Entry::find_text(key).is_ok_and(|entry| {
            let raw = entry.parse(text, Writing::UnitRequired);
            raw.is_ok_and(|raw| params.set(entry, raw).is_ok())
        });
        if !taken {
            return Err(both!(
                "`{key} = {text}` is no value of this program's table: use the version of its agent",
                "`{key} = {text}` 不是本程序参数表中的值：请使用与其代理程序相同的版本",
                key = shown(key),
                text = shown(text)
            ));
        }
    }
    let found = identity(&params);
    if found != set.parameters {
        return Err(both!(
            "its values make {found:08x} here and not {of:08x}: they are of another version of the table, or no agent has \
             told them",
            "其数值在此得到 {found:08x} 而不是 {of:08x}：参数表版本不同，或不是由代理程序发布",
            of = set.parameters
        ));
    }
    Ok(params)
}

/// A foreign text on one line, and no longer than a line.
#[must_use]
pub fn shown(text: &str) -> String {
    let mut shown: String = text.chars().take(SHOWN).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    one_line(&shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_agent::Moment;

    fn told(params: &Params) -> Set {
        Set {
            serial: 0,
            firmware: String::new(),
            parameters: identity(params),
            schema: SCHEMA,
            since: Moment(0),
            after: None,
            seen: Moment(0),
            values: Some(values(params)),
        }
    }

    #[test]
    fn every_value_comes_back() {
        assert_eq!(values(&Params::slant_bed()), BTreeMap::new());
        for which in [
            (|entry| entry.min()) as fn(&Entry) -> i64,
            |entry| entry.max(),
            |entry| entry.none().unwrap_or(entry.max()),
        ] {
            let mut params = Params::slant_bed();
            for entry in Entry::all() {
                params.set(entry, which(entry)).unwrap();
            }
            let set = told(&params);
            // The largest message that there can be.
            assert!(set.written().len() < 32 << 10, "{}", set.written().len());
            let back = super::params(&Set::read(&set.written()).unwrap()).unwrap();
            assert_eq!(identity(&back), identity(&params));
            assert!(
                changes(&back, &params)
                    .iter()
                    .all(|change| change.entry.no == PASSWORD)
            );
        }
    }

    #[test]
    fn a_password_is_not_told() {
        let mut params = Params::slant_bed();
        let password = Entry::find(PASSWORD, None).unwrap();
        params.set(password, 48_151_623).unwrap();
        let set = told(&params);
        let text = String::from_utf8(set.written()).unwrap();
        assert!(!text.contains("48151623"), "{text}");
        assert!(super::params(&set).is_ok());
    }

    #[test]
    fn what_makes_no_set_of_its_checksum_is_not_taken() {
        let mut params = Params::slant_bed();
        params
            .set(Entry::find_text("1420.X").unwrap(), 11_000_000_000)
            .unwrap();
        let good = told(&params);
        assert!(super::params(&good).is_ok());
        let refused = |key: &str, text: &str, words: &str| {
            let mut set = good.clone();
            let values = set.values.as_mut().unwrap();
            values.insert(key.to_owned(), text.to_owned());
            let why = super::params(&set).unwrap_err().en;
            assert!(why.contains(words), "{why}");
            assert!(
                why.len() < 300 && !why.contains(char::is_control),
                "{why:?}"
            );
        };
        refused("rapid_rate.X", "10000 mm/min", "make ");
        refused("rapid_rate.X", "10000", "no value");
        refused("rapid_rate.X", "-1 mm/min", "no value");
        refused("warp\u{1b}[2J", &"9".repeat(9_000), "`warp\\u{1b}[2J = 99");
        for (set, words) in [
            (
                Set {
                    schema: 1,
                    ..good.clone()
                },
                "has version 1",
            ),
            (
                Set {
                    values: None,
                    ..good.clone()
                },
                "does not know the table",
            ),
        ] {
            let why = super::params(&set).unwrap_err().en;
            assert!(why.contains(words), "{why}");
        }
    }
}
