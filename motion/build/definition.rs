//! Reads the definitions.

use std::collections::BTreeMap;
use std::path::Path;

use toml::de::{DeTable, DeValue};

use crate::read;
use crate::unit::{Unit, Writing};

/// One `[[param]]`, of a family one member.
pub struct Definition {
    pub no: u16,
    pub alias: Option<u16>,
    pub name: String,
    pub en: String,
    pub zh: String,
    pub sheet: String,
    pub family: Option<(u16, u16)>,
    pub values: Vec<Value>,
}

/// Where a value is kept in a set.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Slot {
    pub place: usize,
    /// Which quarter of the place it has, from 1 on; 0 where it has all of it.
    pub quarter: u8,
}

/// One value of a definition.
pub struct Value {
    pub part: Part,
    pub unit: Unit,
    pub min: i64,
    pub max: i64,
    pub none: Option<i64>,
    pub slot: Slot,
    pub default: Option<i64>,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    Whole,
    Bit(u8),
    Axis(char),
}

/// A function of `Params`.
pub struct Accessor {
    pub name: String,
    pub kind: String,
    pub doc: String,
    /// For each member of the family (one where there is no family) the slots of its values.
    pub members: Vec<(String, Vec<(Part, Slot)>)>,
    pub family: bool,
}

#[derive(Default)]
pub struct Tables {
    pub definitions: Vec<Definition>,
    pub accessors: Vec<Accessor>,
    /// Slot of each number that has bits.
    pub bytes: BTreeMap<u16, usize>,
    /// The last quarter that is taken, of each axis.
    pub quarters: BTreeMap<Part, Slot>,
    pub slots: usize,
}

/// The fields of one `[[param]]`, taken out one by one so that a misspelt one is noticed.
struct Fields<'a> {
    place: String,
    table: DeTable<'a>,
}

impl Fields<'_> {
    fn text(&mut self, key: &str) -> Option<String> {
        let value = self.table.remove(key)?.into_inner();
        match value.as_str() {
            Some(text) => Some(text.to_owned()),
            None => panic!("{}: `{key}` must be a string", self.place),
        }
    }

    fn needed(&mut self, key: &str) -> String {
        self.text(key)
            .unwrap_or_else(|| panic!("{}: `{key}` is missing", self.place))
    }

    fn number(&mut self, key: &str) -> Option<u16> {
        let value = self.table.remove(key)?.into_inner();
        match value
            .as_integer()
            .filter(|i| i.radix() == 10)
            .and_then(|i| i.as_str().parse().ok())
        {
            Some(number) => Some(number),
            None => panic!("{}: `{key}` must be a whole number up to 65535", self.place),
        }
    }

    fn list(&mut self, key: &str) -> Option<Vec<String>> {
        let value = self.table.remove(key)?.into_inner();
        let texts = value.as_array().map(|array| {
            array
                .iter()
                .map(|v| v.get_ref().as_str().unwrap_or_default().to_owned())
                .collect()
        });
        match texts {
            Some(texts) => Some(texts),
            None => panic!("{}: `{key}` must be an array of strings", self.place),
        }
    }
}

pub fn read_definitions(path: &Path, tables: &mut Tables) {
    let text = read(path);
    let mut file = match DeTable::parse(&text) {
        Ok(table) => table.into_inner(),
        Err(e) => panic!("{}: {e}", path.display()),
    };
    let Some(DeValue::Array(list)) = file.remove("param").map(toml::Spanned::into_inner) else {
        panic!("{}: no [[param]]", path.display());
    };
    assert!(
        file.is_empty(),
        "{}: only [[param]] belongs here",
        path.display()
    );
    for item in list {
        let line = text[..item.span().start].lines().count() + 1;
        let DeValue::Table(table) = item.into_inner() else {
            panic!("{}: [[param]] must be a table", path.display());
        };
        let place = format!("{}:{line}", path.display());
        read_definition(Fields { place, table }, tables);
    }
}

/// What all members and axes of one `[[param]]` share.
struct Record {
    no: u16,
    alias: Option<u16>,
    parts: Vec<Part>,
    kind: String,
    /// Unit and range of X, of C, and of everything else.
    x: Scale,
    rotary: Scale,
    other: Scale,
    /// What stands for "none", which C alone may have: a slide has ends.
    rotary_none: Option<i64>,
    default: Option<String>,
}

/// Unit and range, as written.
#[derive(Clone)]
struct Scale {
    unit: String,
    range: Vec<String>,
}

fn read_definition(mut f: Fields, tables: &mut Tables) {
    let name = f.needed("name");
    let accessor = f.text("accessor").unwrap_or_else(|| name.clone());
    let (en, zh, sheet) = (f.needed("en"), f.needed("zh"), f.needed("sheet"));
    let members = f.list("members");
    let record = read_record(&mut f);
    if let Some(key) = f.table.keys().next() {
        panic!("{}: unknown field `{}`", f.place, key.get_ref());
    }

    let family = members
        .as_ref()
        .map(|m| (record.no, record.no + m.len() as u16 - 1));
    let number = match (family, record.parts.as_slice(), record.alias) {
        (Some((first, last)), ..) => format!("{first}…{last}"),
        (_, [Part::Bit(bit)], _) => format!("{}.{bit}", record.no),
        (.., Some(alias)) => format!("{:03}/{alias}", record.no),
        _ => format!("{:03}", record.no),
    };
    let mut accessor = Accessor {
        name: accessor,
        kind: record.kind.clone(),
        doc: format!(
            "{}. Parameter {number} ({sheet}).",
            en.replace("{}", "`member`")
        ),
        members: Vec::new(),
        family: family.is_some(),
    };
    let members = members.unwrap_or_else(|| vec![String::new()]);
    for (no, member) in (record.no..).zip(&members) {
        let values: Vec<Value> = record
            .parts
            .iter()
            .map(|&part| record.value(no, part, tables, &f.place))
            .collect();
        let slots = values.iter().map(|v| (v.part, v.slot)).collect();
        accessor.members.push((member.clone(), slots));
        let suffix = match member.as_str() {
            "" => String::new(),
            member => format!("_{}", member.to_lowercase()),
        };
        tables.definitions.push(Definition {
            no,
            alias: record.alias,
            name: format!("{name}{suffix}"),
            en: en.replace("{}", member),
            zh: zh.replace("{}", member),
            sheet: sheet.clone(),
            family,
            values,
        });
    }
    tables.accessors.push(accessor);
}

fn read_record(f: &mut Fields) -> Record {
    let no = f
        .number("no")
        .unwrap_or_else(|| panic!("{}: `no` is missing", f.place));
    let kind = f.needed("type");
    let bit = f.number("bit");
    assert_eq!(
        kind == "bit",
        bit.is_some_and(|bit| bit < 8),
        "{}: type \"bit\" and `bit` from 0 to 7 go together",
        f.place
    );
    let parts: Vec<Part> = match (f.list("axes"), bit) {
        (Some(axes), None) => axes
            .iter()
            .map(|a| Part::Axis(a.chars().next().unwrap_or('?')))
            .collect(),
        (None, Some(bit)) => vec![Part::Bit(bit as u8)],
        (None, None) => vec![Part::Whole],
        (Some(_), Some(_)) => panic!("{}: bit and axes", f.place),
    };
    let is_switch = kind == "bit" || kind == "flag";
    let range = match f.list("range") {
        Some(range) => range,
        None if is_switch => vec!["0".to_owned(), "1".to_owned()],
        None => panic!("{}: `range` is missing", f.place),
    };
    let unit = f.text("unit").unwrap_or_default();
    let other = Scale { unit, range };
    let x = Scale {
        unit: f.text("x_unit").unwrap_or_else(|| other.unit.clone()),
        range: other.range.clone(),
    };
    let rotary = Scale {
        unit: f.text("rotary_unit").unwrap_or_else(|| other.unit.clone()),
        range: f
            .list("rotary_range")
            .unwrap_or_else(|| other.range.clone()),
    };
    let rotary_none = f.text("rotary_none").map(|none| match none.as_str() {
        "max" => i64::MAX,
        "min" => i64::MIN,
        _ => panic!("{}: `rotary_none` must be \"max\" or \"min\"", f.place),
    });
    Record {
        no,
        alias: f.number("alias"),
        parts,
        kind,
        x,
        rotary,
        other,
        rotary_none,
        default: f.text("default"),
    }
}

impl Record {
    fn value(&self, no: u16, part: Part, tables: &mut Tables, place: &str) -> Value {
        let scale = match part {
            Part::Axis('X') => &self.x,
            Part::Axis('C') => &self.rotary,
            _ => &self.other,
        };
        let unit = unit_named(&scale.unit)
            .unwrap_or_else(|| panic!("{place}: unknown unit `{}`", scale.unit));
        let parse = |text: &str| {
            unit.parse(text, Writing::UnitOptional)
                .unwrap_or_else(|e| panic!("{place}: `{text}`: {e:?}"))
        };
        let [min, max] = scale.range.as_slice() else {
            panic!("{place}: a range is two values");
        };
        let (min, max) = (parse(min), parse(max));
        let default = self.default.as_deref().map(parse);
        assert!(min <= max, "{place}: empty range");
        assert!(
            default.is_none_or(|d| (min..=max).contains(&d)),
            "{place}: default outside the range"
        );
        // The accessor converts without a check.
        let widest = match self.kind.as_str() {
            "bit" | "flag" => 0..=1,
            "u8" => 0..=i64::from(u8::MAX),
            "i16" => i64::from(i16::MIN)..=i64::from(i16::MAX),
            "u32" => 0..=i64::from(u32::MAX),
            _ => i64::MIN..=i64::MAX,
        };
        assert!(
            widest.contains(&min) && widest.contains(&max),
            "{place}: the range does not fit `{}`",
            self.kind
        );
        Value {
            part,
            unit,
            min,
            max,
            none: self.rotary_none.filter(|_| part == Part::Axis('C')),
            slot: tables.slot(no, part, self.kind == "i16"),
            default,
        }
    }
}

impl Tables {
    /// The place of a value in the set. Four values of 16 bits of one axis share a place.
    fn slot(&mut self, no: u16, part: Part, short: bool) -> Slot {
        let next = self.slots;
        let whole = |place| Slot { place, quarter: 0 };
        let slot = match (part, short) {
            (_, true) => match self.quarters.get(&part) {
                Some(Slot { place, quarter }) if *quarter < 4 => Slot {
                    place: *place,
                    quarter: quarter + 1,
                },
                _ => Slot {
                    place: next,
                    quarter: 1,
                },
            },
            (Part::Bit(_), _) => whole(*self.bytes.entry(no).or_insert(next)),
            (Part::Whole | Part::Axis(_), _) => whole(next),
        };
        if short {
            self.quarters.insert(part, slot);
        }
        if slot.place == next {
            self.slots += 1;
        }
        slot
    }
}

fn unit_named(name: &str) -> Option<Unit> {
    Some(match name {
        "" => Unit::Number,
        "0.1 lead" => Unit::TenthLead,
        "0.1 rpm" => Unit::TenthRpm,
        "0.1 /s" => Unit::TenthPerSecond,
        "0.1 %" => Unit::TenthPercent,
        "whole °" => Unit::WholeDegree,
        "%" => Unit::Percent,
        "Hz" => Unit::Hertz,
        "rpm" => Unit::Rpm,
        "ms" => Unit::Millisecond,
        "µs" => Unit::Microsecond,
        "µm" => Unit::Micrometre,
        "mm" => Unit::Millimetre,
        "mm diameter" => Unit::DiameterMillimetre,
        "mm/min" => Unit::MillimetrePerMinute,
        "m/s²" => Unit::MetrePerSecond2,
        "m/s³" => Unit::MetrePerSecond3,
        "°" => Unit::Degree,
        "°/min" => Unit::DegreePerMinute,
        "°/s²" => Unit::DegreePerSecond2,
        "°/s³" => Unit::DegreePerSecond3,
        _ => return None,
    })
}

/// No number, alias or name may mean two things.
pub fn check_unique(definitions: &[Definition]) {
    let mut numbers = BTreeMap::new();
    let mut names = BTreeMap::new();
    for d in definitions {
        for value in &d.values {
            for no in [Some(d.no), d.alias].into_iter().flatten() {
                if let Some(other) = numbers.insert((no, value.part), &d.name) {
                    panic!("No. {no} is both `{other}` and `{}`", d.name);
                }
            }
        }
        assert!(
            names.insert(&d.name, ()).is_none(),
            "`{}` is defined twice",
            d.name
        );
    }
    for d in definitions
        .iter()
        .filter(|d| d.values[0].part == Part::Whole)
    {
        let others = definitions.iter().filter(|o| o.no == d.no).count();
        assert!(others == 1, "No. {} is a value and has parts", d.no);
    }
}
