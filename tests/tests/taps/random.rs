//! Rigid holes at random, through the whole machine: limits of axis and spindle, the bottom exact,
//! nothing beyond it, axis and spindle on one line in every tick.

use leadscrew_core::call::{
    Hand, HandChoice, SpindleChoice, TapAxis, TapCall, TapCycle, TapSpindle,
};
use leadscrew_core::units::{CentiRpm, Lead, Millis};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::hole::{bottom, deep, high_speed, nm, sheet};
use super::watch::tap;

fn holes() -> u32 {
    leadscrew_seed::amount(60, 400)
}

fn random_hole(r: &mut Random) -> TapCall {
    let rpm = r.within(20, 2500);
    // At most 6 m/min with the fastest way out.
    let lead_um = r.within(100, (4_000_000 / rpm).clamp(101, 4000));
    let depth = r.within(lead_um / 2 + 1, lead_um * 14) * r.sign();
    let axis = r.of(&[TapAxis::Z, TapAxis::Z, TapAxis::X]);
    let plain = TapCall {
        cycle: match axis {
            TapAxis::X => TapCycle::G88,
            TapAxis::Z => TapCycle::G84,
        },
        axis,
        dwell: Millis::new(r.of(&[0, 0, 35])),
        // Thirds and sevenths: leads that no number of nanometres is.
        lead: leadscrew_core::alarm::At::new(
            Lead::new(lead_um * 1000 * r.within(1, 7), 7).unwrap_or(sheet().lead.value),
            leadscrew_core::alarm::Span::default(),
        ),
        hand: if r.chance(50) {
            HandChoice::Signal
        } else {
            HandChoice::Written(Hand::Left)
        },
        speed: CentiRpm::new((rpm * 100) as i32),
        extract: CentiRpm::new((rpm * r.within(50, 150)) as i32),
        spindle: SpindleChoice::Written(r.of(&TapSpindle::ALL)),
        ..bottom(sheet(), depth)
    };
    let infeed = (depth.abs() / r.within(1, 6)).max(20);
    let back = infeed * r.within(0, 100) / 100;
    let call = match r.within(0, 2) {
        0 => plain,
        1 => high_speed(plain, infeed, back),
        _ => deep(plain, infeed, back),
    };
    // The tool above the hole, or at R.
    let initial = nm(-depth.signum() * r.of(&[0, 0, 2_500_000]));
    TapCall {
        hole: call.axis.with(call.hole, initial),
        ..call
    }
}

#[test]
fn holes_at_random_keep_every_promise() {
    leadscrew_seed::volume(0x7A9, |seed| {
        let mut r = Random(seed);
        for _ in 0..holes() {
            let hole = random_hole(&mut r);
            let latency = r.of(&[0, 0, 1000, 3000]);
            let params = with(&[
                ("5261", r.within(0, 1500)),
                ("5271", r.within(0, 1500)),
                ("5201.2", r.within(0, 1)),
                ("9003.X", latency),
                ("9003.Z", latency),
            ]);
            tap(&hole, &params);
        }
    });
}
