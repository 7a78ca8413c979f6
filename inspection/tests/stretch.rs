//! What a stroke cuts after it has left its helix is no thread.
#![allow(clippy::float_arithmetic, missing_docs)]

use leadscrew_core::call::{CutIn, ThreadCycle};
use leadscrew_inspection::{Assumed, Cut, Cutting, Instant, Job};
use leadscrew_metrology::{Designation, Mm, Nose, Side, Stock, Tool, Turns};

/// Cuts M40x3 in one pass by this Z over the turns, from turn -2 to 12, and measures it.
fn cut(z: impl Fn(f64) -> f64) -> Cut {
    let thread = Designation::read("M40x3-6g", Side::External).unwrap();
    let mut cutting = Cutting::new(vec![Job {
        line: 1,
        cycle: ThreadCycle::G92,
        cut_in: CutIn::Centre,
        tool: Tool::vee(thread.angle, Nose::Round(thread.tip())),
        tool_number: 0,
        stock: Stock {
            side: Side::External,
            radius: thread.major * 0.5,
            taper: 0.0,
            from: Mm(-40.0),
            face: Mm(0.0),
        },
        origin: (Mm(0.0), Mm(0.0)),
        passes: vec![(1, 1, 1)],
        assumed: Assumed::default(),
        thread,
    }]);
    for n in 0..1418 {
        let turns = f64::from(n) / 101.3 - 2.0;
        cutting.take(&Instant {
            step: 1,
            angle: Turns(turns),
            x: Mm(18.09),
            z: Mm(z(turns)),
        });
    }
    cutting.finish();
    cutting.done().remove(0)
}

/// Lead error in µm, and the length of full grooves.
fn found(cut: &Cut) -> (f64, f64) {
    let (measured, _) = cut.found.as_ref().unwrap();
    (measured.lead.error.um(), measured.full.0)
}

#[test]
fn a_ring_in_the_work_ends_the_thread_towards_either_end() {
    // Eight turns, and two in which the tool stands.
    let (error, full) = found(&cut(|turns| -3.0 * turns.min(8.0)));
    assert!(error.abs() < 0.1, "{error}");
    assert!((19.0..22.0).contains(&full), "{full}");
    // From the left, out of an undercut that is as wide as it likes, to 6 mm before the face.
    let (error, full) = found(&cut(|turns| 3.0 * turns.min(8.0) - 30.0));
    assert!(error.abs() < 0.1, "{error}");
    assert!(full > 19.0, "{full}");
}

#[test]
fn what_comes_back_to_its_lead_is_thread() {
    // It loses a hundredth of a millimetre in the middle, while it stands for a three-hundredth of a turn: a bad thread.
    let late = |turns: f64| {
        if turns > 5.0 {
            (turns - 0.02).max(5.0)
        } else {
            turns
        }
    };
    let (error, full) = found(&cut(|turns| -3.0 * late(turns)));
    assert!(error.abs() > 1.0, "{error}");
    assert!(full > 24.0, "{full}");
    // So is one whose tool gets onto its lead in the work.
    let join = |turns: f64| {
        if turns < 3.0 {
            0.5 * turns + 1.5
        } else {
            turns
        }
    };
    let (error, _) = found(&cut(|turns| -3.0 * join(turns)));
    assert!(error.abs() > 1.0, "{error}");
}
