use super::*;

fn blocks(text: &str) -> Vec<&str> {
    let (mut found, mut from) = (Vec::new(), Some(0));
    while let Some(begin) = from {
        let piece = piece(text.as_bytes(), begin);
        found.push(text[begin..piece.end].trim());
        from = piece.next;
    }
    found
}

#[test]
fn a_block_ends_at_a_semicolon_outside_of_comments() {
    for (text, expected) in [
        ("G0 X1", &["G0 X1"][..]),
        ("G0 X1; G1 Z2", &["G0 X1", "G1 Z2"]),
        ("G0 (a; b) X1;M5;", &["G0 (a; b) X1", "M5"]),
        ("M3;（a；b） Z1", &["M3", "（a；b） Z1"]),
        ("#1=5;IF[#1EQ5]GOTO 3", &["#1=5", "IF[#1EQ5]GOTO 3"]),
        ("M3; while [1] do1", &["M3", "while [1] do1"]),
        // What is no word is a comment.
        ("G0 X1; rapid to the front", &["G0 X1"]),
        ("; goto the next part", &[""]),
        ("G0 X1;快速定位; G1 Z5", &["G0 X1"]),
        ("G0 X1; #next", &["G0 X1"]),
        ("G0 X1; end of the part", &["G0 X1"]),
        ("G0 X1; /M8", &["G0 X1", "/M8"]),
    ] {
        assert_eq!(blocks(text), expected, "{text}");
    }
}

#[test]
fn a_comment_without_an_end_is_told() {
    let open = |text: &str| piece(text.as_bytes(), 0).open;
    assert_eq!(open("G0 (a (b) c"), Some((3, 1)));
    assert_eq!(open("(a (b c"), Some((0, 2)));
    assert_eq!(open("(a (b) c)"), None);
    assert_eq!(comment_end(b"a) X1", 0, 1), Ok(2));
    assert_eq!(comment_end(b"a) X1", 0, 2), Err(1));
}

#[test]
fn a_look_tells_what_the_core_reads_alone() {
    let look = |text: &str| {
        let mut depth = 0;
        (glance(text.as_bytes(), &mut depth), depth)
    };
    for text in [
        "N10 G0 X1 Z-2.5 (o #1 [ goto)",
        "G1 X1; M30;",
        "/M8",
        "M09",
        "G78 R0.5 F150; (a)",
        "G60 M9 M980 G650",
        "X1E4 N5",
    ] {
        assert_eq!(look(text), (Glance::Plain(text.len()), 0), "{text}");
    }
    assert_eq!(look("%"), (Glance::Plain(1), 0));
    assert_eq!(look("(a"), (Glance::Plain(2), 1));
    assert_eq!(look("G0 X1 ; note"), (Glance::Plain(6), 0));
    for text in [
        "#1=1",
        "X[1]",
        "O5",
        "<O5>",
        ":5",
        "GOTO 5",
        "END1",
        "M98",
        "m099",
        "G065",
        "X 5",
        "X\t-5",
        "/2 M8",
        "WHILE[1]DO1",
    ] {
        assert_eq!(look(text).0, Glance::Special, "{text}");
    }
    let mut depth = 2;
    assert_eq!(glance(b"#1=5) a) M8", &mut depth), Glance::Plain(11));
    assert_eq!(depth, 0);
}

#[test]
fn a_line_of_comments_has_no_block() {
    for (text, depth, expected) in [
        ("%", 0, false),
        (" (a) ; (b)\r", 0, false),
        ("(a", 0, false),
        ("a) b) ;", 2, false),
        ("a) M8", 1, true),
        ("M8", 0, true),
        ("%O1", 0, true),
    ] {
        assert_eq!(has_blocks(text.as_bytes(), depth), expected, "{text}");
    }
}

#[test]
fn a_cursor_passes_over_spaces_and_comments() {
    let text = b"IF (a) [ #1";
    let mut cursor = Cursor::new(7, text, 0);
    assert!(cursor.take_word("if"));
    assert!(cursor.take(b'['));
    assert_eq!(
        cursor.here(),
        leadscrew_core::alarm::Span {
            line: 7,
            column: 10,
            end: 11
        }
    );
    assert!(!cursor.take(b'X') && !cursor.is_done());
}
