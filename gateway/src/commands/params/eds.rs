//! `params docs --eds`: the object dictionary of a board as an electronic data sheet, for CANopen tools of other people.
//! Made from the list the board itself answers from, never written by hand.

use std::fmt::{self, Write as _};

use leadscrew_core::board::device::dictionary::{Initial, Item, Kind, items};
use leadscrew_core::board::device::{GROUPS, PRODUCT};

/// Object types of CiA 306.
const VARIABLE: u8 = 7;
const ARRAY: u8 = 8;
const RECORD: u8 = 9;

/// Bit rates a board is made for, in kbit/s, out of those that the format knows.
const RATES: [(u16, bool); 8] = [
    (10, false),
    (20, false),
    (50, false),
    (125, false),
    (250, false),
    (500, true),
    (800, false),
    (1000, true),
];

/// The whole sheet.
pub fn sheet() -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut out);
    out
}

fn write(out: &mut String) -> fmt::Result {
    let items: Vec<Item> = items().collect();
    let objects: Vec<&[Item]> = items
        .chunk_by(|a, b| a.object.index == b.object.index)
        .collect();
    head(out, &objects)?;
    lists(out, &objects)?;
    for object in objects {
        match object {
            // A record with nothing in it is one all the same.
            [alone] if GROUPS.iter().all(|group| group.index != index(object)) => {
                let index = alone.object.index;
                writeln!(out, "[{index:04X}]")?;
                value(out, alone, alone.name())?;
            }
            _ => group(out, object)?,
        }
    }
    Ok(())
}

fn head(out: &mut String, objects: &[&[Item]]) -> fmt::Result {
    let count = |range: std::ops::Range<u16>| {
        let inside = |object: &&&[Item]| range.contains(&index(object));
        objects.iter().filter(inside).count()
    };
    write!(
        out,
        "[FileInfo]\nFileName=leadscrew.eds\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\n\
         Description=Leadscrew board {}\n\n",
        env!("CARGO_PKG_VERSION")
    )?;
    write!(
        out,
        "[DeviceInfo]\nVendorName=Leadscrew\nVendorNumber=0\nProductName=Leadscrew board\n\
         ProductNumber={PRODUCT:#010X}\nRevisionNumber=0\nOrderCode=\n"
    )?;
    for (rate, possible) in RATES {
        writeln!(out, "BaudRate_{rate}={}", u8::from(possible))?;
    }
    write!(
        out,
        "SimpleBootUpMaster=0\nSimpleBootUpSlave=1\nGranularity=0\nDynamicChannelsSupported=0\n\
         GroupMessaging=0\nNrOfRXPDO={}\nNrOfTXPDO={}\nLSS_Supported=0\n\n",
        count(0x1400..0x1600),
        count(0x1800..0x1A00)
    )?;
    writeln!(out, "[DummyUsage]")?;
    for kind in 1..=7 {
        writeln!(out, "Dummy{kind:04}=0")?;
    }
    write!(out, "\n[Comments]\nLines=0\n\n")
}

fn lists(out: &mut String, objects: &[&[Item]]) -> fmt::Result {
    let mandatory = |index: u16| matches!(index, 0x1000 | 0x1001 | 0x1018);
    let maker = |index: u16| (0x2000..0x6000).contains(&index);
    let sections: [(&str, &dyn Fn(u16) -> bool); 3] = [
        ("MandatoryObjects", &mandatory),
        ("OptionalObjects", &|index| {
            !mandatory(index) && !maker(index)
        }),
        ("ManufacturerObjects", &maker),
    ];
    for (name, belongs) in sections {
        let inside: Vec<u16> = objects
            .iter()
            .map(|object| index(object))
            .filter(|index| belongs(*index))
            .collect();
        writeln!(out, "[{name}]\nSupportedObjects={}", inside.len())?;
        for (number, index) in (1..).zip(inside) {
            writeln!(out, "{number}={index:#06X}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// An object with sub-indices.
fn group(out: &mut String, object: &[Item]) -> fmt::Result {
    let index = index(object);
    let known = GROUPS.iter().find(|group| group.index == index);
    // A parameter with a value for each axis has no name but that of its values.
    let of_parameter = object.iter().find_map(|item| item.entry);
    let name = match (known, of_parameter) {
        (Some(group), _) => group.name,
        (None, Some(entry)) => entry.text().name,
        (None, None) => "",
    };
    let kind = match known {
        Some(group) if !group.array => RECORD,
        _ => ARRAY,
    };
    writeln!(
        out,
        "[{index:04X}]\nParameterName={name}\nObjectType={kind:#X}\nSubNumber={}\n",
        object.len()
    )?;
    for item in object {
        let sub = item.object.sub;
        writeln!(out, "[{index:04X}sub{sub:X}]")?;
        let namesakes = object.iter().filter(|other| other.name() == item.name());
        if namesakes.count() > 1 {
            value(out, item, &format!("{} {sub}", item.name()))?;
        } else {
            value(out, item, item.name())?;
        }
    }
    Ok(())
}

fn value(out: &mut String, item: &Item, name: &str) -> fmt::Result {
    writeln!(out, "ParameterName={name}")?;
    writeln!(out, "ObjectType={VARIABLE:#X}")?;
    writeln!(out, "DataType={:#06X}", item.kind.code())?;
    writeln!(out, "AccessType={}", item.access.name())?;
    if let Some((low, high)) = item.range {
        writeln!(out, "LowLimit={low}\nHighLimit={high}")?;
    }
    match item.initial {
        Initial::Unknown => {}
        Initial::Number(number) if matches!(item.kind, Kind::U32 | Kind::U64) => {
            writeln!(out, "DefaultValue={number:#X}")?;
        }
        Initial::Number(number) => writeln!(out, "DefaultValue={number}")?,
        Initial::OfNode(base) => writeln!(out, "DefaultValue=$NODEID+{base:#X}")?,
        Initial::Text(text) => writeln!(out, "DefaultValue={text}")?,
    }
    writeln!(out, "PDOMapping={}\n", u8::from(item.mappable))
}

fn index(object: &[Item]) -> u16 {
    object.first().map_or(0, |item| item.object.index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_object_has_its_section_once() {
        let sheet = sheet();
        let mut sections: Vec<&str> = sheet.lines().filter(|line| line.starts_with('[')).collect();
        let all = sections.len();
        sections.sort_unstable();
        sections.dedup();
        assert_eq!(sections.len(), all);
        for item in items() {
            let index = item.object.index;
            assert!(
                sheet.contains(&format!("\n[{index:04X}]\n")),
                "{index:04X}h"
            );
        }
        assert!(!sheet.contains("ParameterName=\n"));
    }

    #[test]
    fn a_mapped_fact_as_it_is_printed() {
        let sheet = sheet();
        let credit = "[5001sub7]\nParameterName=program credit\nObjectType=0x7\nDataType=0x0006\n\
                      AccessType=ro\nPDOMapping=1\n\n";
        assert!(sheet.contains(credit));
        let cob_id = "[1801sub1]\nParameterName=COB-ID\nObjectType=0x7\nDataType=0x0007\n\
                      AccessType=rw\nDefaultValue=$NODEID+0x40000280\nPDOMapping=0\n\n";
        assert!(sheet.contains(cob_id));
        // "None" is within the limits, and a slide has no such value [D197].
        for (section, low, high) in [
            ("2528sub1", -99_999_999_900_i64, 99_999_999_900_i64),
            ("2528sub3", -99_999_999_900, 99_999_999_901),
            ("2529sub3", -99_999_999_901, 99_999_999_900),
        ] {
            let (_, text) = sheet.split_once(&format!("[{section}]\n")).unwrap();
            let limits = format!("LowLimit={low}\nHighLimit={high}\n");
            let (text, _) = text.split_once("\n\n").unwrap();
            assert!(text.contains(&limits), "{section}: {text}");
        }
        assert!(sheet.contains("NrOfRXPDO=4\nNrOfTXPDO=5\n"));
        assert!(sheet.contains("ParameterName=mapped object 2\n"));
    }
}
