//! T on a machine with a turret: the stations that it has.

use super::*;

#[test]
fn t_names_a_station_that_the_turret_has() {
    let turret = parameters::machine(&[
        ("9451", "2"),
        ("9452", "8"),
        ("9454", "2"),
        ("9455", "3"),
        ("9456", "7"),
    ]);
    let number = |params: &Params, text: &str| {
        let (_, alarm) = read_with(text.as_bytes(), params, Options::default());
        alarm.map(|alarm| (alarm.code.number(), alarm.span.column))
    };
    assert_eq!(number(&turret, "T0801\n"), None);
    assert_eq!(number(&turret, "T0032\n"), None);
    assert_eq!(number(&turret, "G0 T0901\n"), Some((4574, 4)));
    // By hand, and where T is an offset alone, any number is one.
    let by_hand = parameters::machine(&[("9451", "1"), ("9452", "8")]);
    assert_eq!(number(&by_hand, "T0901\n"), None);
    assert_eq!(number(&Params::sheets(), "T0901\n"), None);
}
