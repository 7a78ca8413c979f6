//! Reads the parameter definitions (`params/*.toml`) and the built-in machine, and writes the typed table of
//! `core/src/params`.
//!
//! A `[[param]]` has `no`, sometimes `alias` (a second number of the same record) or `bit`, `name` (its key in machine
//! files), `accessor` (its function, where that is not `name`), `en` and `zh` (what it is), `type`, `unit`, `range` (as
//! printed in the sheets, in the unit), `default` (absent where the value belongs to a machine) and `sheet` (where it
//! comes from). `axes` makes one value an axis; `x_unit`, `rotary_unit` and `rotary_range` are those of X and C where
//! they differ. `none` ("max" or "min") allows the value `none`, kept as the largest or smallest integer. `members`
//! makes one parameter of each, with consecutive numbers; `{}` in the texts is the member.
// At build time a panic is the error message.
#![allow(
    clippy::panic,
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects
)]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

// One parser of values for definitions, machine files and command lines.
#[allow(dead_code)]
#[path = "src/params/unit.rs"]
mod unit;
use unit::{Unit, Writing};

/// One `[[param]]`, of a family one member.
struct Definition {
    no: u16,
    alias: Option<u16>,
    name: String,
    en: String,
    zh: String,
    sheet: String,
    family: Option<(u16, u16)>,
    values: Vec<Value>,
}

/// One value of a definition.
struct Value {
    part: Part,
    unit: Unit,
    min: i64,
    max: i64,
    none: Option<i64>,
    slot: usize,
    default: Option<i64>,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Whole,
    Bit(u8),
    Axis(char),
}

/// A function of `Params`.
struct Accessor {
    name: String,
    kind: String,
    doc: String,
    /// For each member of the family (one where there is no family) the slots of its values.
    members: Vec<(String, Vec<(Part, usize)>)>,
    family: bool,
}

#[derive(Default)]
struct Tables {
    definitions: Vec<Definition>,
    accessors: Vec<Accessor>,
    /// Slot of each number that has bits.
    bytes: BTreeMap<u16, usize>,
    slots: usize,
}

fn main() {
    let manifest = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let params = manifest.join("../params");
    let mut tables = Tables::default();
    for file in ["gsk980td.toml", "gsk988.toml", "motion.toml"] {
        read_definitions(&params.join(file), &mut tables);
    }
    check_unique(&tables.definitions);
    read_machine(
        &params.join("machines/slant-bed.toml"),
        &mut tables.definitions,
    );
    tables.definitions.sort_by_key(|d| (d.no, d.values[0].part));
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default()).join("params.rs");
    if let Err(e) = std::fs::write(&out, generate(&tables)) {
        panic!("{}: {e}", out.display());
    }
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/params/unit.rs");
}

fn read(path: &Path) -> String {
    println!("cargo::rerun-if-changed={}", path.display());
    match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(e) => panic!("{}: {e}", path.display()),
    }
}

// -- definitions ------------------------------------------------------------------------------------------------------

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

fn read_definitions(path: &Path, tables: &mut Tables) {
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

fn read_definition(mut f: Fields, tables: &mut Tables) {
    let no = f
        .number("no")
        .unwrap_or_else(|| panic!("{}: `no` is missing", f.place));
    let alias = f.number("alias");
    let bit = f.number("bit");
    let name = f.needed("name");
    let accessor = f.text("accessor").unwrap_or_else(|| name.clone());
    let (en, zh, sheet) = (f.needed("en"), f.needed("zh"), f.needed("sheet"));
    let kind = f.needed("type");
    let unit = f.text("unit").unwrap_or_default();
    let x_unit = f.text("x_unit").unwrap_or_else(|| unit.clone());
    let rotary_unit = f.text("rotary_unit");
    let switch = Some(vec!["0".to_owned(), "1".to_owned()]);
    let is_switch = kind == "bit" || kind == "flag";
    let range = f.list("range").or_else(|| switch.filter(|_| is_switch));
    let range = range.unwrap_or_else(|| panic!("{}: `range` is missing", f.place));
    let rotary_range = f.list("rotary_range");
    let none = f.text("none").map(|none| match none.as_str() {
        "max" => i64::MAX,
        "min" => i64::MIN,
        _ => panic!("{}: `none` must be \"max\" or \"min\"", f.place),
    });
    let default = f.text("default");
    let axes = f.list("axes");
    let members = f.list("members");
    if let Some(key) = f.table.keys().next() {
        panic!("{}: unknown field `{}`", f.place, key.get_ref());
    }
    assert_eq!(
        kind == "bit",
        bit.is_some(),
        "{}: `bit` and type \"bit\" go together",
        f.place
    );

    let parts: Vec<Part> = match (&axes, bit) {
        (Some(axes), None) => axes
            .iter()
            .map(|a| Part::Axis(a.chars().next().unwrap_or('?')))
            .collect(),
        (None, Some(bit)) => vec![Part::Bit(bit as u8)],
        (None, None) => vec![Part::Whole],
        (Some(_), Some(_)) => panic!("{}: bit and axes", f.place),
    };
    let mut accessor = Accessor {
        name: accessor,
        kind,
        doc: en.replace("{}", "`member`"),
        members: Vec::new(),
        family: members.is_some(),
    };
    let members = members.unwrap_or_else(|| vec![String::new()]);
    let family = accessor.family.then(|| (no, no + members.len() as u16 - 1));
    for (index, member) in members.iter().enumerate() {
        let no = no + index as u16;
        let mut values = Vec::new();
        for &part in &parts {
            let (unit, range) = match part {
                Part::Axis('C') => (
                    rotary_unit.as_ref().unwrap_or(&unit),
                    rotary_range.as_ref().unwrap_or(&range),
                ),
                Part::Axis('X') => (&x_unit, &range),
                _ => (&unit, &range),
            };
            let unit =
                unit_named(unit).unwrap_or_else(|| panic!("{}: unknown unit `{unit}`", f.place));
            let parse = |text: &str| {
                unit.parse(text, Writing::UnitOptional)
                    .unwrap_or_else(|e| panic!("{}: `{text}`: {e:?}", f.place))
            };
            let (min, max) = (parse(&range[0]), parse(&range[1]));
            let default = default.as_deref().map(parse);
            assert!(min <= max, "{}: empty range", f.place);
            assert!(
                default.is_none_or(|d| (min..=max).contains(&d)),
                "{}: default outside the range",
                f.place
            );
            let slot = match part {
                Part::Bit(_) => *tables.bytes.entry(no).or_insert_with(|| {
                    tables.slots += 1;
                    tables.slots - 1
                }),
                _ => {
                    tables.slots += 1;
                    tables.slots - 1
                }
            };
            values.push(Value {
                part,
                unit,
                min,
                max,
                none,
                slot,
                default,
            });
        }
        let slots = values.iter().map(|v| (v.part, v.slot)).collect();
        accessor.members.push((member.clone(), slots));
        let suffix = if member.is_empty() {
            String::new()
        } else {
            format!("_{}", member.to_lowercase())
        };
        tables.definitions.push(Definition {
            no,
            alias,
            name: format!("{name}{suffix}"),
            en: en.replace("{}", member),
            zh: zh.replace("{}", member),
            sheet: sheet.clone(),
            family,
            values,
        });
    }
    let first = &tables.definitions[tables.definitions.len() - accessor.members.len()];
    let number = match (accessor.family, bit) {
        (true, _) => format!(
            "{}…{}",
            first.no,
            first.no as usize + accessor.members.len() - 1
        ),
        (_, Some(bit)) => format!("{}.{bit}", first.no),
        _ => alias.map_or_else(
            || format!("{:03}", first.no),
            |a| format!("{:03}/{a}", first.no),
        ),
    };
    accessor.doc = format!("{} (parameter {number}; [{sheet}]).", accessor.doc);
    tables.accessors.push(accessor);
}

fn unit_named(name: &str) -> Option<Unit> {
    Some(match name {
        "" => Unit::Number,
        "0.1 lead" => Unit::TenthLead,
        "0.1 rpm" => Unit::TenthRpm,
        "whole °" => Unit::WholeDegree,
        "%" => Unit::Percent,
        "Hz" => Unit::Hertz,
        "rpm" => Unit::Rpm,
        "ms" => Unit::Millisecond,
        "µs" => Unit::Microsecond,
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
fn check_unique(definitions: &[Definition]) {
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

// -- the built-in machine ---------------------------------------------------------------------------------------------

/// Puts the values of the machine in the place of the defaults; afterwards every parameter must have one.
fn read_machine(path: &Path, definitions: &mut [Definition]) {
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

// -- output -----------------------------------------------------------------------------------------------------------

fn generate(tables: &Tables) -> String {
    let mut out = String::from("// Generated by build.rs from params/*.toml.\n");
    let mut built_in = vec![0_i64; tables.slots];
    let (mut entries, mut texts) = (String::new(), String::new());
    let mut count = 0;
    for (index, d) in tables.definitions.iter().enumerate() {
        write_line(
            &mut texts,
            format_args!(
                "Text {{ name: {:?}, en: {:?}, zh: {:?}, sheet: {:?}, family: {:?} }},",
                d.name, d.en, d.zh, d.sheet, d.family
            ),
        );
        for v in &d.values {
            count += 1;
            let part = match v.part {
                Part::Whole => "Part::Whole".to_owned(),
                Part::Bit(bit) => format!("Part::Bit({bit})"),
                Part::Axis(axis) => format!("Part::Axis(Axis::{axis})"),
            };
            write_line(
                &mut entries,
                format_args!(
                    "Entry {{ no: {}, alias: {:?}, part: {part}, unit: Unit::{:?}, min: {}, max: {}, none: {:?}, slot: {}, text: {index} }},",
                    d.no, d.alias, v.unit, v.min, v.max, v.none, v.slot,
                ),
            );
            let default = v.default.unwrap_or_default();
            match v.part {
                Part::Bit(bit) => built_in[v.slot] |= default << bit,
                _ => built_in[v.slot] = default,
            }
        }
    }
    let slots = tables.slots;
    write_line(
        &mut out,
        format_args!(
            "/// Values in a set; the bits of one number share one.\nconst SLOTS: usize = {slots};"
        ),
    );
    write_line(
        &mut out,
        format_args!("static ENTRIES: [Entry; {count}] = [\n{entries}];"),
    );
    write_line(
        &mut out,
        format_args!(
            "static TEXTS: [Text; {}] = [\n{texts}];",
            tables.definitions.len()
        ),
    );
    write_line(
        &mut out,
        format_args!("const BUILT_IN: [i64; SLOTS] = {built_in:?};"),
    );
    write_line(&mut out, format_args!("impl Params {{"));
    for accessor in &tables.accessors {
        write_accessor(&mut out, accessor);
    }
    write_line(&mut out, format_args!("}}"));
    out
}

fn write_line(out: &mut String, line: std::fmt::Arguments) {
    // Writing into a String cannot fail.
    let _ = writeln!(out, "{line}");
}

/// Type of a value and the expression that makes it of the raw one.
fn typed(kind: &str, raw: &str) -> (&'static str, String) {
    match kind {
        "flag" => ("bool", format!("{raw} != 0")),
        "u8" => ("u8", format!("{raw} as u8")),
        "u32" => ("u32", format!("{raw} as u32")),
        "length" => ("Length", format!("Length::from_nm({raw})")),
        "feed" => ("Feed", format!("Feed::from_nm_per_min({raw})")),
        "acceleration" => (
            "Acceleration",
            format!("Acceleration::from_nm_per_s2({raw})"),
        ),
        "jerk" => ("Jerk", format!("Jerk::from_nm_per_s3({raw})")),
        "position" => ("i64", raw.to_owned()),
        _ => panic!("unknown type `{kind}`"),
    }
}

fn write_accessor(out: &mut String, a: &Accessor) {
    write_line(out, format_args!("/// {}", a.doc));
    let name = &a.name;
    let raw = |slot: usize| format!("self.raw[{slot}]");
    let [(_, first), ..] = a.members.as_slice() else {
        panic!("`{name}` has no members");
    };
    if a.family {
        // Counted as the trade counts them: G54 is 0, tool 1 is 1.
        let base = usize::from(a.members[0].0 == "1");
        let value = |slots: &[(Part, usize)]| {
            let values: Vec<_> = slots
                .iter()
                .map(|&(_, slot)| typed(&a.kind, &raw(slot)).1)
                .collect();
            format!("[{}]", values.join(", "))
        };
        let (t, zero) = (typed(&a.kind, "").0, typed(&a.kind, "0").1);
        let (n, last) = (first.len(), base + a.members.len() - 1);
        write_line(
            out,
            format_args!(
                "/// `member` counts {base}…{last}; zero for any other. One value an axis, X (a radius) first."
            ),
        );
        write_line(
            out,
            format_args!(
                "#[must_use] pub const fn {name}(&self, member: u8) -> [{t}; {n}] {{ match member {{"
            ),
        );
        for (index, (_, slots)) in a.members.iter().enumerate() {
            write_line(out, format_args!("{} => {},", base + index, value(slots)));
        }
        write_line(out, format_args!("_ => [{zero}; {n}], }} }}"));
        return;
    }
    match first.as_slice() {
        [(Part::Bit(bit), slot)] => write_line(
            out,
            format_args!(
                "#[must_use] pub const fn {name}(&self) -> bool {{ {} & {:#04x} != 0 }}",
                raw(*slot),
                1 << bit
            ),
        ),
        [(Part::Whole, slot)] => {
            let (t, value) = typed(&a.kind, &raw(*slot));
            write_line(
                out,
                format_args!("#[must_use] pub const fn {name}(&self) -> {t} {{ {value} }}"),
            );
        }
        axes => {
            let t = typed(&a.kind, "").0;
            write_line(
                out,
                format_args!(
                    "#[must_use] pub const fn {name}(&self, axis: Axis) -> {t} {{ match axis {{"
                ),
            );
            for &(part, slot) in axes {
                let Part::Axis(axis) = part else {
                    panic!("`{name}`: not an axis")
                };
                write_line(
                    out,
                    format_args!("Axis::{axis} => {},", typed(&a.kind, &raw(slot)).1),
                );
            }
            write_line(out, format_args!("}} }}"));
        }
    }
}
