use std::fs;

use leadscrew_core::alarm::Lang;

use super::*;
use crate::failure::Failure;

fn set(texts: &[&str]) -> Offsets {
    let mut table = Offsets::default();
    for text in texts {
        assign(&mut table, text).unwrap_or_else(|why| panic!("{text}: {}", why.en));
    }
    table
}

#[test]
fn every_key_names_itself_alone() {
    let keys: Vec<_> = Key::all().collect();
    assert_eq!(keys.len(), 2 + 6 * 2 + 3 + 32 * 8);
    for key in keys {
        assert_eq!(Key::find(&key.to_string()), [key]);
        let (min, max) = key.range();
        let mut table = Offsets::default();
        for raw in [min, max] {
            key.set(&mut table, raw).unwrap();
            assert_eq!(key.get(&table), raw, "{key}");
            assert_eq!(key.parse(&key.shown(raw)), Ok(raw), "{key}");
            assert_eq!(table.beyond(), None, "{key}");
        }
        assert!(key.set(&mut table, max + 1).is_err(), "{key}");
        assert!(key.set(&mut table, min - 1).is_err(), "{key}");
        assert_eq!(key.get(&table), max, "{key}");
    }
    assert_eq!(Key::find("1.x"), [Key::Tool(1, Field::Geometry(Axis::X))]);
    assert_eq!(Key::find("t32").len(), 8);
    assert_eq!(Key::find("g59").len(), 2);
    for nothing in [
        "T0.X", "T33", "G53.X", "G60.Z", "T1.Y", "", "shift.C", "wear.X",
    ] {
        assert_eq!(Key::find(nothing), [], "{nothing}");
    }
}

#[test]
fn values_are_set_and_added() {
    let table = set(&[
        "G54.Z=-400",
        "T1.X=-250.76",
        "1.wear.X=0.5",
        "1.wear.X-=0.02",
        "1.wear.X+=0.001",
        "T1.radius=400 um",
        "T1.measured=xz",
        "T2.Z=1 in",
    ]);
    let value = |key| {
        let [key] = Key::find(key)[..] else {
            panic!("{key}")
        };
        key.shown(key.get(&table))
    };
    for (key, shown) in [
        ("G54.Z", "-400"),
        ("T1.X", "-250.76"),
        ("T1.wear.X", "0.481"),
        ("T1.radius", "0.4"),
        ("T1.measured", "XZ"),
        ("T2.Z", "25.4"),
    ] {
        assert_eq!(value(key), shown, "{key}");
    }
}

#[test]
fn what_is_no_value_is_refused_and_changes_nothing() {
    let mut table = set(&["T1.X=1"]);
    let before = table;
    for (text, part) in [
        ("T1.X", "sets nothing"),
        ("T1=5", "there is no `T1`"),
        ("T40.X=1", "there is no `T40.X`"),
        ("T1.X=abc", "is no value"),
        ("T1.X=38,42", "write a point, not a comma"),
        (
            "T1.X=10000",
            "4582: T1.X: `10000` is outside -9999.9999 to 9999.9999 mm",
        ),
        ("T1.X+=9999", "4582"),
        ("T1.wear.Z=100", "outside -99.9999 to 99.9999 mm"),
        ("T1.radius=-0.4", "outside 0 to 99.9999 mm"),
        ("T1.X=0.00005", "finer than 0.0001 mm"),
        ("T1.tip=10", "outside 0 to 9,"),
        ("T1.tip=1.5", "is no value"),
        ("T1.station=33", "outside 0 to 32,"),
        ("T1.measured=Y", "is no value"),
    ] {
        let Err(why) = assign(&mut table, text) else {
            panic!("{text}");
        };
        assert!(why.en.contains(part), "{text}: {}", why.en);
        assert_eq!(table, before);
    }
}

#[test]
fn a_file_comes_back_as_it_was_written() {
    let folder = std::env::temp_dir().join(format!("leadscrew-tools-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("tools.toml");
    let table = set(&[
        "shift.X=0.0001",
        "G59.Z=-99999.9999",
        "T1.X=-250.76",
        "T1.wear.Z=-0.02",
        "T32.radius=0.8",
        "T32.tip=3",
        "T32.station=12",
        "T32.measured=Z",
    ]);
    fs::write(&path, whole(&table, "of a test", Lang::En)).unwrap();
    assert_eq!(read(&path, Lang::En).unwrap(), table);
    // What a file does not name stays.
    fs::write(&path, "T1.wear.X = -0.5\n[G54]\nZ = \"-1 in\"\n").unwrap();
    let mut over = table;
    apply(&mut over, &path, Lang::En).unwrap();
    let told: Vec<_> = changes(&table, &over)
        .iter()
        .map(|c| c.key.to_string())
        .collect();
    assert_eq!(told, ["G54.Z", "T1.wear.X"]);
    assert_eq!(
        text(&changes(&table, &over)),
        "G54.Z      0 → -25.4\nT1.wear.X  0 → -0.5\n"
    );
    for (content, told) in [
        ("T1.X = 1\nT77 = 5\n", ":2: there is no `T77`"),
        ("\n\nT1 = { X = 1, tip = 12 }\n", ":3: 4582: T1.tip"),
        ("T1.X = 1\nT1.X = 2\n", ":2: duplicate key"),
        ("T1.X = [1]\n", ":1: T1.X: `?` is no value"),
    ] {
        fs::write(&path, content).unwrap();
        let Err(Failure::WrongBecause(why)) = read(&path, Lang::En) else {
            panic!("{content}");
        };
        assert!(why.en.contains(told), "{content}: {}", why.en);
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_wear_that_jumps_is_much() {
    let old = Offsets::default();
    let new = set(&[
        "T1.wear.X=1",
        "T2.wear.X=-1.0001",
        "T3.X=200",
        "T3.wear.Z=20",
    ]);
    let keys: Vec<_> = much(&changes(&old, &new))
        .iter()
        .map(Key::to_string)
        .collect();
    assert_eq!(keys, ["T2.wear.X", "T3.wear.Z"]);
}
