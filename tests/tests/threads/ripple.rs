//! The jerk of the axes outside the locked part, with a spindle that ripples [D205].

use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_tests::limits::first_excess_with;
use leadscrew_tests::machine::run;
use leadscrew_tests::params::with;

/// The first excess of a G76 at a speed and lead, with so many per cent of ripple at so many hertz, over `jerks` times the
/// jerk.
fn excess((rpm, lead): (u32, f64), (percent, hertz): (u32, u32), jerks: f64) -> Option<String> {
    let params = with(&[]);
    let plant = PlantOptions {
        ripple: Ripple::new(percent * 1000, hertz * 1000),
        ..PlantOptions::default()
    };
    let text = format!(
        "M3 S{rpm}\nG4 X2\nG0 X60 Z15\nG76 P021060 Q100 R0.1\nG76 X57 Z-40 P1500 Q600 F{lead}\nM30\n"
    );
    let ran = run(&text, &params, &plant, |_, _| {});
    assert_eq!(ran.alarm, None, "{text}");
    first_excess_with(&ran.rows, &params, jerks)
}

#[test]
fn slow_ripple_is_within_the_jerk() {
    for ripple in [(0, 5), (5, 5), (5, 10)] {
        assert_eq!(excess((1500, 1.5), ripple, 1.0), None, "{ripple:?}");
    }
    assert_eq!(excess((300, 6.0), (10, 5), 1.0), None);
}

/// As much as the decision says, and no more.
#[test]
fn quick_ripple_adds_to_the_braking() {
    for (thread, most) in [((1500, 1.5), 1.4), ((300, 6.0), 1.5), ((1000, 2.0), 1.4)] {
        assert_eq!(excess(thread, (5, 20), most), None, "{thread:?}");
        assert!(excess(thread, (5, 20), 1.2).is_some(), "{thread:?}");
    }
}
