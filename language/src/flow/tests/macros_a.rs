use super::{refused, run};

#[test]
fn operations_have_their_results() {
    for (block, expected) in [
        ("G65 H01 P#1 Q12", "0.012"),
        ("G65 H02 P#1 Q12 R5", "0.017"),
        ("G65 H03 P#1 Q12 R5", "0.007"),
        ("G65 H04 P#1 Q12 R5", "0.06"),
        ("G65 H05 P#1 Q12 R5", "0.002"),
        ("G65 H11 P#1 Q12 R3", "0.015"),
        ("G65 H12 P#1 Q12 R10", "0.008"),
        ("G65 H13 P#1 Q12 R10", "0.006"),
        ("G65 H21 P#1 Q10", "0.003"),
        ("G65 H22 P#1 Q-12", "0.012"),
        ("G65 H23 P#1 Q12 R5", "0.002"),
        ("G65 H24 P#1 Q37", "0.025"),
        ("G65 H25 P#1 Q25", "0.037"),
        ("G65 H26 P#2 Q3 R5;#1=#2", "0.006"),
        ("G65 H27 P#1 Q3000 R4000", "5"),
        ("G65 H31 P#1 Q1000 R30000", "0.5"),
        ("G65 H32 P#1 Q1000 R60000", "0.5"),
        ("G65 H33 P#1 Q1000 R45000", "1"),
        ("G65 H34 P#1 Q1000 R1000", "45"),
        // With a point, or from macro B, there are no increments.
        ("G65 H05 P#1 Q12. R5", "2.4"),
        ("#3=12;G65 H02 P#1 Q#3 R1", "13"),
        ("G65 H31 P#1 Q10. R30.", "5"),
        ("G65 H01 P#2 Q5;G65 H02 P#1 Q#2 R1", "0.006"),
    ] {
        let text = format!("G65 H01 P#2 Q10\n{block}\nX#1");
        assert_eq!(run(&text), format!("3:X{expected}"), "{block}");
    }
    // A count of increments is a count where the word has none.
    assert_eq!(
        run("G65 H01 P#1 Q3\nM98 P#1\nM30\nO3\nX1\nM99"),
        "5:X1 | 3:M30"
    );
}

#[test]
fn jumps_depend_on_the_comparison() {
    for (code, taken) in [
        (81, [false, true, false]),
        (82, [true, false, true]),
        (83, [false, false, true]),
        (84, [true, false, false]),
        (85, [false, true, true]),
        (86, [true, true, false]),
    ] {
        for (value, taken) in [2, 3, 4].into_iter().zip(taken) {
            let text = format!("#1={value}\nG65 H{code} P5 Q#1 R3\nX1\nN5 Z1");
            let expected = if taken { "4:N5 Z1" } else { "3:X1 | 4:N5 Z1" };
            assert_eq!(run(&text), expected, "{code} {value}");
        }
    }
    assert_eq!(run("G65 H80 P5\nX1\nN5 Z1"), "3:N5 Z1");
}

#[test]
fn mistakes_are_told_at_their_columns() {
    for (text, expected) in [
        ("G65 H99 P12", (3000, 1, 5, 8)),
        ("G65 H07 P#1 Q1", (114, 1, 5, 8)),
        ("G65 H01 Q1", (114, 1, 5, 8)),
        ("G65 H01 P5 Q1", (114, 1, 9, 11)),
        ("G65 H02 P#1 Q1", (114, 1, 5, 8)),
        ("G65 H05 P#1 Q1 R0", (112, 1, 5, 8)),
        ("G65 H21 P#1 Q-1", (119, 1, 5, 8)),
        ("G65 H01 P#1 Q1 X5", (4028, 1, 16, 18)),
        ("G65 H01 P#1 Q1 Q5", (4013, 1, 16, 18)),
        ("G65 H01 P#34 Q1", (115, 1, 10, 13)),
        ("G65 H80 P5", (128, 1, 5, 8)),
    ] {
        assert_eq!(refused(text), expected, "{text}");
    }
}
