use super::{refused, run};

#[test]
fn a_loop_runs_while_its_condition_holds() {
    assert_eq!(
        run("#1=0;#2=0;WHILE[#1LT3]DO1;#1=#1+1;#2=#2+#1*10;G0 X[#2+20]Z-#1;END1"),
        "1:G0 X30 Z-1 | 1:G0 X50 Z-2 | 1:G0 X80 Z-3"
    );
    let nested =
        "#1=0\nWHILE[#1LT2]DO1\n#1=#1+1\n#2=0\nWHILE[#2LT2]DO2\n#2=#2+1\nX#1 Z#2\nEND2\nEND1\nM30";
    assert_eq!(
        run(nested),
        "7:X1 Z1 | 7:X1 Z2 | 7:X2 Z1 | 7:X2 Z2 | 10:M30"
    );
    assert_eq!(run("WHILE[0]DO1\nX1\nEND1\nX2"), "4:X2");
    assert_eq!(
        run("#1=0\nDO1\n#1=#1+1\nX#1\nIF[#1GE3]GOTO9\nEND1\nN9M30"),
        "4:X1 | 4:X2 | 4:X3 | 7:N9M30"
    );
}

#[test]
fn a_jump_looks_forward_first_and_then_from_the_front() {
    assert_eq!(
        run("GOTO 5\nX1\nN5 X2\nN5 X3\nM30"),
        "3:N5 X2 | 4:N5 X3 | 5:M30"
    );
    assert_eq!(
        run("N5 X1\n#1=#1+1\nIF[#1LT3]GOTO 5\nM30\nO2\nN6"),
        "1:N5 X1 | 1:N5 X1 | 1:N5 X1 | 4:M30"
    );
    assert_eq!(run("#1=4\nGOTO[#1+1]\nX1\nN0005 X2"), "4:N0005 X2");
    assert_eq!(
        run("#3=#0\nIF[#3EQ0]GOTO9\nIF[#3LT1]GOTO8\nN9 X9\nN8 X8"),
        "5:N8 X8"
    );
    // Out of both loops, and the outer one begins anew.
    assert_eq!(
        run(
            "#3=0\nN1 #1=0\nWHILE[#1LT9]DO1\n#1=#1+1\nDO2\nX#1\nGOTO 7\nEND2\nEND1\nN7 #3=#3+1\nIF[#3LT2]GOTO 1"
        ),
        "2:N1 | 6:X1 | 10:N7 | 2:N1 | 6:X1 | 10:N7"
    );
    // Inside of a loop that runs.
    assert_eq!(
        run("#1=0\nWHILE[#1LT2]DO1\nGOTO 5\nX9\nN5 #1=#1+1\nX#1\nEND1"),
        "5:N5 | 6:X1 | 5:N5 | 6:X2"
    );
}

#[test]
fn jumps_to_nowhere_are_refused() {
    for (text, expected) in [
        ("X1\nGOTO 5\nO2\nN5", (128, 2, 6, 7)),
        ("GOTO[1.5]", (128, 1, 5, 10)),
        ("GOTO #1", (128, 1, 6, 8)),
        ("GOTO", (125, 1, 5, 6)),
        ("GOTO -5", (128, 1, 6, 8)),
        ("GOTO 5\nWHILE[1]DO1\nN5 X1\nEND1", (128, 1, 6, 7)),
        ("WHILE[0]DO1\nN5 X1\nEND1\nGOTO 5", (128, 4, 6, 7)),
    ] {
        assert_eq!(refused(text), expected, "{text}");
    }
}

#[test]
fn loops_must_close_and_may_not_cross() {
    for (text, expected) in [
        ("WHILE[1]DO1\nX1", (124, 1, 11, 12)),
        ("X1\nEND1", (124, 2, 4, 5)),
        ("WHILE[1]DO1\nWHILE[1]DO2\nEND1\nEND2", (124, 3, 1, 2)),
        ("WHILE[1]DO1\nWHILE[1]DO1\nEND1\nEND1", (124, 2, 1, 2)),
        ("WHILE[1]DO4\nEND4", (126, 1, 11, 12)),
        ("WHILE[1]DO\nEND", (126, 1, 11, 12)),
        ("WHILE[1]D1", (114, 1, 9, 10)),
        ("WHILE 1 DO1", (114, 1, 7, 8)),
        ("DO1\nO2\nEND1", (124, 1, 3, 4)),
        ("WHILE[1]DO1 X5\nEND1", (127, 1, 13, 14)),
    ] {
        assert_eq!(refused(text), expected, "{text}");
    }
}

#[test]
fn a_loop_without_an_end_is_refused_at_its_line() {
    assert_eq!(refused("X1\nWHILE[1]DO1\n#1=#1+1\nEND1"), (4850, 2, 11, 12));
    assert_eq!(refused("X1\nN5 #1=#1+1\nGOTO 5"), (4850, 3, 6, 7));
    assert_eq!(
        refused("M98 P2 L9999\nM30\nO2\nM98 P3 L9999\nM99\nO3\nM99"),
        (4850, 4, 5, 7)
    );
    // A motion now and then is all that it takes, but not for ever.
    let text = "WHILE[#1LT5000]DO1\n#1=#1+1\nX1\nEND1";
    let rules = super::Rules {
        budget: 10,
        ..super::Rules::default()
    };
    let (machine, alarm) = super::run_with(text, rules);
    assert_eq!((machine.heard.len(), alarm), (5000, None));
    let rules = super::Rules {
        turns: 100,
        ..super::Rules::default()
    };
    let ended = |text: &str| {
        let alarm = super::run_with(text, rules).1.expect("an alarm");
        (alarm.number(), alarm.span.line, alarm.span.column)
    };
    assert_eq!(ended("X1\nN5 X2\nGOTO 5"), (4852, 3, 6));
    assert_eq!(ended("WHILE[1]DO1\nX2\nEND1"), (4852, 1, 11));
    assert_eq!(ended("M98 P2 L200\nM30\nO2 X1\nM99"), (4852, 1, 5));
    // Neither jumps forward nor calls are loops.
    let text = "GOTO 1\nN1 M98 P2\n".repeat(101) + "M30\nO2 X1\nM99";
    let text = (0..101).fold(text, |text, n| {
        let text = text.replacen("GOTO 1\n", &format!("GOTO {}\n", n + 2), 1);
        text.replacen("N1 M98", &format!("N{} M98", n + 2), 1)
    });
    let (machine, alarm) = super::run_with(&text, rules);
    assert_eq!((machine.heard.len(), alarm), (203, None));
}
