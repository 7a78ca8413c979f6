//! Reads the built-in machine.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use crate::definition::{Definition, Part, Value};
use crate::read;
use crate::unit::Writing;

/// Puts the values of the machine in the place of the defaults; afterwards every parameter must have one.
pub fn read_machine(path: &Path, definitions: &mut [Definition]) {
    let text = read(path);
    let file = match DeTable::parse(&text) {
        Ok(table) => table.into_inner(),
        Err(e) => panic!("{}: {e}", path.display()),
    };
    for (key, value) in &file {
        let name = key.get_ref().as_ref();
        let Some(d) = definitions.iter_mut().find(|d| d.name == name) else {
            panic!("{}: there is no parameter `{name}`", path.display());
        };
        match value.get_ref() {
            DeValue::Table(parts) => {
                for (part, value) in parts {
                    let letter = part.get_ref().chars().next().unwrap_or('?');
                    let entry = d.values.iter_mut().find(|v| v.part == Part::Axis(letter));
                    let Some(entry) = entry else {
                        panic!("{}: `{name}` has no {letter}", path.display());
                    };
                    set(path, name, entry, value.get_ref());
                }
            }
            value => set(path, name, &mut d.values[0], value),
        }
    }
    for d in definitions {
        for v in &d.values {
            assert!(
                v.default.is_some(),
                "`{}` has no default and no value in {}",
                d.name,
                path.display()
            );
        }
    }
}

fn set(path: &Path, name: &str, entry: &mut Value, value: &DeValue) {
    let text = match value {
        DeValue::String(text) => text.as_ref(),
        DeValue::Integer(integer) => integer.as_str(),
        _ => panic!(
            "{}: `{name}` must be a string or a whole number",
            path.display()
        ),
    };
    let raw = match (text, entry.none) {
        ("none", Some(none)) => none,
        _ => match entry.unit.parse(text, Writing::UnitRequired) {
            Ok(raw) if (entry.min..=entry.max).contains(&raw) => raw,
            Ok(_) => panic!("{}: `{name}`: {text} is out of range", path.display()),
            Err(e) => panic!("{}: `{name}`: {text}: {e:?}", path.display()),
        },
    };
    entry.default = Some(raw);
}
