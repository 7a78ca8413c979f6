//! From text to moves: the sheets' complete programs as printed, and millimetres against inches.

use leadscrew_core::call::*;
use leadscrew_core::cycle::*;
use leadscrew_core::moves::*;
use leadscrew_core::params::Params;
use leadscrew_core::program::*;
use leadscrew_core::units::*;

use crate::build::*;
use crate::random::cycles;
use leadscrew_tests::random::Random;

/// Everything a program yields: moves and the numbers of warnings, in order; or the number of its alarm.
fn try_text(text: &str) -> Result<(Vec<Move>, Vec<u16>), u16> {
    let params = Params::sheets();
    let options = Options::default();
    let mut here = options.position;
    let (mut moves, mut warnings) = (Vec::new(), Vec::new());
    for event in Events::new(text.as_bytes(), &params, options) {
        match event.map_err(|alarm| alarm.number())? {
            Event::Warning(warning) => warnings.push(warning.number()),
            Event::Call(call) => {
                let list =
                    expand(&call, &Context::standing(here)).map_err(|alarm| alarm.number())?;
                warnings.extend(list.warning().map(|warning| warning.number()));
                for m in list {
                    here = m.to;
                    moves.push(m);
                }
            }
        }
    }
    Ok((moves, warnings))
}

fn expand_text(text: &str) -> (Vec<Move>, Vec<u16>) {
    try_text(text).unwrap_or_else(|number| panic!("alarm {number} in {text}"))
}

fn of(moves: &[Move], cycle: Cycle) -> Vec<Move> {
    let mine = moves
        .iter()
        .filter(|m| m.tag.is_some_and(|tag| tag.cycle == cycle));
    mine.copied().collect()
}

/// End points, stages, depths: all that a change of units must leave alone.
fn shape(moves: &[Move]) -> Vec<(Position, Option<Stage>, Option<Length>)> {
    let row = |m: &Move| (m.to, m.tag.map(|tag| tag.stage), m.tag.map(|tag| tag.depth));
    moves.iter().map(row).collect()
}

#[test]
fn o0013_as_printed() {
    let text = "O0013;\nG50 X100 Z50 M3 S300;\nG04 X2;\nG00 X80 Z10;\nG76 P020560 Q1500 R0.1;\n\
                G76 X60.64 Z-62 P36800 Q18000 F6;\nG00 X100 Z50 ;\nM30;\n";
    let (moves, warnings) = expand_text(text);
    assert!(warnings.is_empty(), "{warnings:?}");
    let thread = of(&moves, Cycle::G76);
    assert_eq!(thread.len(), 30);
    // G50 puts work X100 Z50 where the machine stands, at machine X0 Z0.
    let ends: Vec<_> = thread
        .iter()
        .map(|m| (m.to.x + dia(100.0), m.to.z + mm(50.0)))
        .collect();
    let resolved = ThreadMoves::new(&o0013(), place(1)).unwrap();
    let wanted: Vec<_> = resolved.map(|m| (m.to.x, m.to.z)).collect();
    assert_eq!(ends, wanted);
    assert!(thread.iter().all(|m| m.span.line == 6));
}

#[test]
fn o0008_as_printed() {
    let text = "O0008;\nG00 X150 Z50 M3 S500;\nG0 X125 Z-24;\nG75 R0.5 F150;\n\
                G75 X40 Z-50 P60000 Q30000;\nG0 X150 Z50;\nM30;\n";
    let (moves, warnings) = expand_text(text);
    assert!(warnings.is_empty(), "{warnings:?}");
    let ends = |moves: &[Move]| {
        moves
            .iter()
            .map(|m| (m.to.x, m.to.z, m.kind))
            .collect::<Vec<_>>()
    };
    let resolved: Vec<_> = GrooveMoves::new(&o0008(), place(1)).unwrap().collect();
    assert_eq!(ends(&of(&moves, Cycle::G75)), ends(&resolved));
}

#[test]
fn g78_as_printed() {
    let text =
        "G00 X80 Z10\nG78 P020545 Q0.15 R0.5\nG78 X60 Z-60 P3 Q1.8 F300 J1.5 K2\nG00 X80 Z10\n";
    let (moves, warnings) = expand_text(text);
    // 05 as cut-in mode is none.
    assert_eq!(warnings.len(), 1);
    let thread = of(&moves, Cycle::G78);
    assert_eq!(thread.len(), 20);
    let x = |m: &Move| Diameter::of_radius(m.to.x).nm();
    let approach = thread
        .iter()
        .filter(|m| m.tag.unwrap().stage == Stage::Approach);
    assert_eq!(
        approach.map(x).collect::<Vec<_>>(),
        [62.4, 61.0, 60.0, 60.0].map(nm)
    );
}

/// Inches on a grid of 0.005, which is 0.127 mm: the same nanometres in both systems, and the same moves where no depth
/// is rounded to the input increment.
#[test]
fn millimetres_and_inches_make_the_same_moves() {
    leadscrew_seed::volume(25, |seed| {
        let mut r = Random(seed);
        let (mut same, mut refused) = (0, 0);
        for _ in 0..cycles() / 20 {
            let w = r.sign() * r.within(60, 900);
            let (s, k) = (r.sign(), r.within(4, 60));
            let i = if r.chance(50) {
                0
            } else {
                r.within(-w.abs() / 8, w.abs() / 8)
            };
            let x_a = r.within(-1500, 1500);
            let x_d = x_a - s * 2 * (k + i.abs() + r.within(-1, 150));
            let steps = [
                ("G0 X", x_a, true),
                (" Z", r.within(-800, 800), true),
                ("\nG78 Q", r.within(0, 3), true),
                (" R", r.within(0, k / 3), true),
                (
                    " D0 P",
                    10_000 + 100 * r.within(0, 4) + r.within(0, 99),
                    false,
                ),
                ("\nG78 X", x_d, true),
                (" W", w, true),
                (" R", i, true),
                (" P", k, true),
                (" Q", r.within(1, k), true),
                (" J", r.within(1, 60), true),
                (" K", r.within(1, 60), true),
                (" E", r.within(0, 60), true),
                (" F", r.within(4, 60), true),
                ("\nG75 R", r.within(0, 9), true),
                (" F", r.within(100, 900), true),
                // P and Q of G75 count increments of 0.0001 mm or 0.00001 inch.
                ("\nG75 X", x_d, true),
                (" W", r.within(-200, 200), true),
            ];
            let pecks = (r.within(1, 90), r.within(1, 90));
            let text = |inch: bool| {
                let mut text = String::from(if inch { "G20\n" } else { "G21\n" });
                for (letter, value, length) in steps {
                    text += letter;
                    text += &if length {
                        grid(value, inch)
                    } else {
                        format!("{value:06}")
                    };
                }
                let lsb = if inch { 500 } else { 1270 };
                text + &format!(" P{} Q{}\nM30\n", pecks.0 * lsb, pecks.1 * lsb)
            };
            match (try_text(&text(false)), try_text(&text(true))) {
                (Ok((metric, a)), Ok((inch, b))) => {
                    assert_eq!(a, b);
                    assert_eq!(shape(&metric), shape(&inch), "{}", text(false));
                    assert!(
                        !of(&metric, Cycle::G78).is_empty() && !of(&metric, Cycle::G75).is_empty()
                    );
                    same += 1;
                }
                (a, b) => {
                    assert_eq!(a.err(), b.err(), "{}", text(false));
                    refused += 1;
                }
            }
        }
        assert!(
            same > cycles() / 50 && refused > 0,
            "{same} alike, {refused} refused"
        );
    });
}

/// `steps` of 0.005 inch or 0.127 mm.
fn grid(steps: i64, inch: bool) -> String {
    let value = steps * if inch { 5 } else { 127 };
    let sign = if value < 0 { "-" } else { "" };
    format!("{sign}{}.{:03}", value.abs() / 1000, value.abs() % 1000)
}
