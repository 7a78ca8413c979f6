use std::num::NonZeroU32;

use super::{Rules, refused, run, run_with};
use crate::dialect::Control;
use crate::flow::Passes;

#[test]
fn a_subprogram_runs_as_often_as_it_is_called() {
    assert_eq!(
        run("M98 P30010\nM30\nO10\nX1\nM99"),
        "4:X1 | 4:X1 | 4:X1 | 2:M30"
    );
    assert_eq!(
        run("X0 M98 P10 L2\nM30\nO10 X1\nM99"),
        "1:X0 | 3:X1 | 3:X1 | 2:M30"
    );
    assert_eq!(
        run("#1=10;M98 P#1;X2\nM30\n<O10>\nX1\nM99"),
        "4:X1 | 1:X2 | 2:M30"
    );
    assert_eq!(
        run("O1\nN7 M098 P0010\nM30\n:10\nX1\nZ2 M99"),
        "1:O1 | 2:N7 | 5:X1 | 6:Z2 | 3:M30"
    );
    assert_eq!(
        run("M98 P2\nM30\nO2\nM98 P3\nX2\nM99\nO3\nX3\nM99"),
        "8:X3 | 5:X2 | 2:M30"
    );
    // A local part of the program.
    assert_eq!(
        run("M97 P100 L2\nX1\nM30\nN100 Z1\nM99"),
        "4:N100 Z1 | 4:N100 Z1 | 2:X1 | 3:M30"
    );
}

/// Its programs have numbers of five digits, and L alone counts.
#[test]
fn a_haas_has_no_passes_in_front_of_a_number() {
    let haas = |text: &str| {
        let rules = Rules {
            control: Control::Haas,
            ..Rules::default()
        };
        let (machine, alarm) = run_with(text, rules);
        (machine.heard.join(" | "), alarm.map(|alarm| alarm.number()))
    };
    let behind = "M30\nO2345\nX1\nM99\nO12345\nX2\nM99";
    let done = |text: &str| (text.to_owned(), None);
    assert_eq!(haas(&format!("M98 P12345\n{behind}")), done("7:X2 | 2:M30"));
    assert_eq!(
        haas(&format!("M98 P12345 L2\n{behind}")),
        done("7:X2 | 7:X2 | 2:M30")
    );
    assert_eq!(haas("M98 P12345\nM30\nO2345\nX1\nM99").1, Some(4853));
    assert_eq!(run(&format!("M98 P12345\n{behind}")), "4:X1 | 2:M30");
    // The main program is told by the call, too.
    let second = |first: &str| format!("{first}\nX1\nM99\nO7\nM98 P12345\nM30");
    assert_eq!(haas(&second("O12345")).0, "4:O7 | 2:X1 | 6:M30");
    assert_eq!(haas(&second("O2345")).0, "1:O2345 | 2:X1");
    assert_eq!(run(&second("O2345")), "4:O7 | 2:X1 | 6:M30");
}

#[test]
fn a_return_may_go_to_another_block() {
    assert_eq!(
        run("M98 P2\nX1\nN8 X2\nM30\nO2\nM99 P8\nN8 X3"),
        "3:N8 X2 | 4:M30"
    );
    // The block that is called leads back once all passes are done.
    assert_eq!(
        run("M98 P2 L2\nX1\nN8 M30\nO2\nZ1\nM99 P8"),
        "5:Z1 | 5:Z1 | 3:N8 M30"
    );
}

#[test]
fn a_program_may_begin_behind_its_percent_sign() {
    // Searches from the front and a second pass begin behind it, and the `%` after that ends the text.
    assert_eq!(
        run("%O1\nN5 X1\n#1=#1+1\nIF[#1LT2]GOTO5\nM30\n%\nX9"),
        "1:O1 | 2:N5 X1 | 2:N5 X1 | 5:M30"
    );
    assert_eq!(
        run("%N5 X1\n#1=#1+1\nIF[#1LT2]GOTO5\nM30"),
        "1:N5 X1 | 1:N5 X1 | 4:M30"
    );
    let twice = Rules {
        passes: Passes::Number(NonZeroU32::MIN.saturating_add(1)),
        ..Rules::default()
    };
    let (machine, alarm) = run_with("%O1\nX1\nM99\n%", twice);
    assert_eq!(alarm, None);
    assert_eq!(machine.heard, ["1:O1", "2:X1", "2:X1"]);
    let called = run("%O1\nM98 P2\nM30\nO2\nX2\nM99");
    assert_eq!(called, "1:O1 | 5:X2 | 3:M30");
}

#[test]
fn what_stands_before_the_first_percent_sign_is_a_leader() {
    let program = "O1\nN5 X1\nM98 P2\nM30\nO2\nX2\nM99\n%";
    let bare = run(&format!("%\n{program}"));
    assert_eq!(bare, "1:% | 2:O1 | 3:N5 X1 | 7:X2 | 5:M30");
    let moved = bare
        .replace("7:", "10:")
        .replace("5:", "8:")
        .replace("3:", "6:")
        .replace("2:O", "5:O")
        .replace("1:%", "4:%");
    assert_eq!(
        run(&format!("\u{8f74} 30\n\nFlange, first side\n%\n{program}")),
        moved
    );
    // The codes of a tape punch, as a serial line hands them on.
    for front in ["\u{12}", "\0\0\0\u{12}\u{14} ", "\u{7f}\t"] {
        let told = run(&format!("{front}%\n{program}"));
        assert_eq!(told, bare[6..], "{front:?}");
    }
    assert_eq!(
        run(&format!("\0\0\n\u{12}\n\n\n%\n{program}")),
        run(&format!("\n\n\n\n%\n{program}"))
    );
    // Without `%`, and with what could be a block or a comment in front of it, nothing is passed over.
    for text in [
        "\u{8f74} 30\nX1\nM30",
        "\u{8f74} 30\nX1\n%",
        "X1\nFlange\n%\nM30",
        "(a)\nFlange\n%\nM30",
    ] {
        let (machine, _) = run_with(text, Rules::default());
        assert_eq!(machine.heard[0][..2], *"1:", "{text}");
    }
}

#[test]
fn the_main_program_is_read_once_or_again() {
    let text = "%\nO1\nX1\nM99\n%";
    let (machine, alarm) = run_with(text, Rules::default());
    assert_eq!(machine.heard, ["1:%", "2:O1", "3:X1"]);
    assert_eq!(
        (machine.notes, machine.finished, alarm),
        (vec![4992], true, None)
    );
    assert_eq!(run("X1\nM99 P5\nX2\nN5 X3\nM30"), "1:X1 | 4:N5 X3 | 5:M30");
    let (machine, alarm) = run_with("N5 X1\nM99 P5", Rules::default());
    assert_eq!(
        (machine.heard.len(), machine.notes, alarm),
        (1, vec![4992], None)
    );
    let again = Rules {
        passes: Passes::UntilStopped,
        ..Rules::default()
    };
    let text = "%\nO1\n#1=#1+1\nX#1\nIF[#1GE3]GOTO9\nM99\nN9M30\n%";
    let (machine, alarm) = run_with(text, again);
    assert_eq!(alarm, None);
    assert_eq!(
        machine.heard,
        ["1:%", "2:O1", "4:X1", "4:X2", "4:X3", "7:N9M30"]
    );
    // A number of passes; a way back to a block is one more, and loops of one pass do not count in the next.
    let twice = Rules {
        passes: Passes::Number(NonZeroU32::MIN.saturating_add(1)),
        turns: 3,
        ..Rules::default()
    };
    for (text, heard) in [
        ("X1\nM99", "X1 X1"),
        ("X1\nN5 X2\nM99 P5", "X1 N5 X2 N5 X2"),
        ("X1\nM99 P5\nX2\nN5 X3\nM99", "X1 N5 X3 X1 N5 X3"),
        (
            "#1=0\nWHILE[#1LT3]DO1\n#1=#1+1\nX1\nEND1\nM99",
            "X1 X1 X1 X1 X1 X1",
        ),
    ] {
        let (machine, alarm) = run_with(text, twice);
        let blocks = machine
            .heard
            .iter()
            .map(|block| block.split_once(':').unwrap().1);
        assert_eq!(blocks.collect::<Vec<_>>().join(" "), heard, "{text}");
        assert_eq!((machine.notes, alarm), (vec![4992], None), "{text}");
    }
}

#[test]
fn a_program_ends_where_another_begins() {
    let (machine, alarm) = run_with("O1\nX1\nO2\nX2\nM99", Rules::default());
    assert_eq!(
        (machine.heard, alarm),
        (vec!["1:O1".into(), "2:X1".into()], None)
    );
    assert!(machine.finished);
}

#[test]
fn a_macro_has_its_arguments() {
    assert_eq!(
        run("#1=7\nG65 P9 A1 B2 I-3 I4 D5\nX#1\nM30\nO9\nX#1 Z#2\nX#4 Z#7\nM99"),
        "6:X1 Z2 | 7:X-3 Z5 | 3:X7 | 4:M30"
    );
    // Each pass begins with them.
    assert_eq!(
        run("G65 P9 L2 A1\nM30\nO9\n#1=#1+1\nX#1\nM99"),
        "5:X2 | 5:X2 | 2:M30"
    );
    // M98 keeps the variables of its caller.
    assert_eq!(
        run("#1=3\nM98 P9\nX#1\nM30\nO9\n#1=#1+1\nM99"),
        "3:X4 | 4:M30"
    );
    // Sixteen levels have variables of their own.
    let deep = |levels: u32| {
        format!("G65 P9 A{levels}\nM30\nO9\nIF[#1LE1]GOTO 5\nG65 P9 A[#1-1]\nN5 X#1\nM99")
    };
    let said: Vec<String> = (1..=16).map(|level| format!("6:N5 X{level}")).collect();
    assert_eq!(run(&deep(16)), format!("{} | 2:M30", said.join(" | ")));
    assert_eq!(refused(&deep(17)), (77, 5, 5, 7));
}

#[test]
fn a_modal_macro_comes_after_each_motion() {
    assert_eq!(
        run("G66 P9 A5\nX1\nM8\nX2; Z3\nG67\nX4\nM30\nO9\nU#1\nM99"),
        "2:X1 | 9:U5 | 3:M8 | 4:X2 | 9:U5 | 4:Z3 | 9:U5 | 6:X4 | 7:M30"
    );
    // A motion in the later one calls the earlier one.
    assert_eq!(
        run("G66 P8\nG66 P9\nX1\nG67\nX2\nG67\nX3\nM30\nO8\nM8\nM99\nO9\nZ9\nM99"),
        "3:X1 | 13:Z9 | 10:M8 | 5:X2 | 10:M8 | 7:X3 | 8:M30"
    );
    assert_eq!(refused("G66P1\nG66P1\nG66P1\nG66P1\nG66P1"), (122, 5, 1, 4));
}

#[test]
fn wrong_calls_are_told_at_their_columns() {
    for (text, expected) in [
        ("M98", (76, 1, 1, 4)),
        ("M98 L2", (76, 1, 1, 4)),
        ("G65 A1", (76, 1, 1, 4)),
        ("M98 P5", (78, 1, 5, 7)),
        ("M98 P1.5", (4023, 1, 5, 9)),
        ("M98 P5 L0", (4025, 1, 8, 10)),
        ("M98 P5 P6", (4013, 1, 8, 10)),
        ("M97 P5", (128, 1, 5, 7)),
        ("G65 P9 G1", (129, 1, 8, 10)),
        ("X5 G65 P9", (129, 1, 1, 3)),
        ("M98 P1 M99", (114, 1, 8, 11)),
        ("X1\nM98 P2\nM30\nO2\nX1", (4851, 2, 5, 7)),
        ("X1\nM98 P2\nM30\nO2\nX1\nO3\nM99", (4851, 6, 1, 3)),
        ("M98 P2\nM30\nO2\nM98 P2\nM99", (77, 4, 5, 7)),
        ("M98 P2\nM30\nO2\nM99 P7", (128, 4, 5, 7)),
    ] {
        assert_eq!(refused(text), expected, "{text}");
    }
}
