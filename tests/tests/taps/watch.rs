//! What every tick of a tap is judged by.

use leadscrew_board_sim::plant::{FineTurns, PlantOptions};
use leadscrew_board_sim::{Row, SpindleAngle};
use leadscrew_core::call::{Call, Hand, TapCall, TapSpindle};
use leadscrew_core::params::Params;
use leadscrew_core::signals::Signals;
use leadscrew_core::units::Turns;
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::{Ran, run_calls};

use super::hole::program;

pub fn run(calls: Vec<Call>, params: &Params) -> Ran {
    run_calls(calls, params, &PlantOptions::default(), |_, _| {})
}

/// One hole, undisturbed, judged.
pub fn tap(hole: &TapCall, params: &Params) -> Ran {
    let ran = run(program(&[*hole]), params);
    assert_eq!(ran.alarm, None);
    judge(&ran, hole, params);
    let depths = locked(&ran).map(|row| depth(row, hole));
    assert_eq!(
        depths.max(),
        Some(inward(hole) * (hole.bottom.value - hole.level.value).nm()),
        "the bottom"
    );
    let last = locked(&ran).last().expect("a tap");
    assert_eq!(depth(last, hole), 0, "out of the hole");
    ran
}

pub fn locked(ran: &Ran) -> impl Iterator<Item = &Row> {
    ran.rows.iter().filter(|row| row.error.is_some())
}

fn inward(hole: &TapCall) -> i64 {
    (hole.bottom.value - hole.level.value).nm().signum()
}

/// Depth below R in nanometres.
pub fn depth(row: &Row, hole: &TapCall) -> i64 {
    (hole.axis.of(row.position) - hole.level.value).nm() * inward(hole)
}

/// Commanded angle of the spindle in position mode.
pub fn set(row: &Row) -> Turns {
    turning(row).set.expect("position mode")
}

/// The spindle in position mode; spindle 1 where none is.
pub fn turning(row: &Row) -> SpindleAngle {
    TapSpindle::ALL
        .map(|spindle| row.angle(spindle))
        .into_iter()
        .find(|angle| angle.set.is_some())
        .unwrap_or(row.angle(TapSpindle::First))
}

/// Every locked row is on the line through `(R, origin)`; nothing is beyond the bottom; the true spindle is where it is
/// told to be; the axes keep their limits, and the spindle its own.
pub fn judge(ran: &Ran, hole: &TapCall, params: &Params) {
    let Some(first) = locked(ran).next() else {
        return;
    };
    // The spindle stood here before the tap began, with the tap at R.
    let origin = ran
        .rows
        .iter()
        .rev()
        .find(|row| row.tick < first.tick && row.is_rigid())
        .map_or(set(first), set);
    let total = inward(hole) * (hole.bottom.value - hole.level.value).nm();
    let half_increment = (1_i128 << 63) / i128::from(params.spindle_increments()) + (1 << 32);
    for row in ran.rows.iter().filter(|row| row.is_rigid()) {
        let told = FineTurns::from_turns(set(row)).raw();
        let off = (turning(row).truth.raw() - told).abs();
        assert!(
            off <= half_increment,
            "true angle at tick {}: {off}",
            row.tick
        );
    }
    for row in locked(ran) {
        on_line(row, hole, origin);
        assert!(depth(row, hole) <= total, "beyond at tick {}", row.tick);
        // An increment of the spindle is less than a nanometre of the axis.
        assert!(row.error.expect("locked").nm().abs() <= 1, "{row:?}");
    }
    assert_eq!(first_excess(&ran.rows, params), None);
    assert_eq!(spindle_excess(ran, hole, params), None);
}

/// θ = θ_R ± depth / lead, to the last unit of 2⁻³² turns.
pub fn on_line(row: &Row, hole: &TapCall, origin: Turns) {
    let sign = match Signals::default().hand(hole.hand) {
        Hand::Right => 1,
        Hand::Left => -1,
    };
    let lead = hole.lead.value;
    let turned = i128::from((set(row) - origin).raw()) * sign;
    let exact = (i128::from(depth(row, hole)) * i128::from(lead.denominator())) << 32;
    let off = turned * i128::from(lead.numerator()) - exact;
    assert!(
        off.abs() <= i128::from(lead.numerator()),
        "off the line at tick {}: {off}",
        row.tick
    );
}

/// The first tick in which the spindle is accelerated more than 5261 (out: 5271) allows. Rounding of the axis to nanometres
/// is in it.
fn spindle_excess(ran: &Ran, hole: &TapCall, params: &Params) -> Option<String> {
    let ms = params
        .tap_ramp_ms()
        .min(if params.tap_retract_ramp_differs() {
            params.tap_retract_ramp_ms()
        } else {
            u32::MAX
        });
    if ms == 0 {
        return None;
    }
    let tick = f64::from(params.tick_us()) * 1e-6;
    let lead = hole.lead.value.numerator() as f64 / hole.lead.value.denominator() as f64;
    let limit = 1000.0 / 60.0 / (f64::from(ms) * 1e-3) * tick * tick;
    let turns = |row: &Row| set(row).raw() as f64 / 2f64.powi(32);
    ran.rows.windows(3).find_map(|rows| {
        if rows.iter().any(|row| !row.is_rigid()) {
            return None;
        }
        let [a, b, c] = [0, 1, 2].map(|i| turns(&rows[i]));
        let second = (c - 2.0 * b + a).abs();
        (second > limit + 2.0 / lead + 1e-8)
            .then(|| format!("tick {}: {second} turns, limit {limit}", rows[2].tick))
    })
}
