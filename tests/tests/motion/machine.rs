//! A random machine, and the watch over its limits.

use crate::random::Random;
use leadscrew_core::call::Position;
use leadscrew_core::motion::Pace;
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::units::Axis;

const MM: f64 = 1e6;

/// A parameter set that passes its own checks.
pub fn random(random: &mut Random) -> Params {
    loop {
        let mut params = Params::default();
        let mut set = |key: &str, raw: i64| {
            let entry = Entry::find_text(key).expect("the parameter exists");
            params.set(entry, raw).expect("within its range");
        };
        for axis in ["X", "Z", "C"] {
            // C: degrees for millimetres.
            let scale = if axis == "C" { 20.0 * MM } else { MM };
            let rapid = random.decades(500.0 * scale, 60_000.0 * scale);
            set(&format!("1420.{axis}"), rapid);
            set(&format!("1430.{axis}"), rapid / (1 + random.below(4)));
            set(
                &format!("1620.{axis}"),
                random.decades(200.0 * scale, 20_000.0 * scale),
            );
            set(
                &format!("1622.{axis}"),
                random.decades(3e3 * scale, 3e6 * scale),
            );
        }
        set(
            "9000",
            [250, 500, 1_000, 1_000, 2_000, 4_000, 10_000][random.below(7) as usize],
        );
        // The spindle's parameters ask for a short tick; the time-driven half does not.
        set("3772", 100);
        set("9005", 5);
        if params.validate().is_ok() {
            return params;
        }
    }
}

/// The last setpoints, and how much of each limit has been used.
pub struct Watch {
    limits: [[i128; 3]; 3],
    cutting: [i128; 3],
    tick_us: i128,
    last: [[i128; 3]; 3],
    /// Largest use of speed, acceleration and jerk, rounding taken off.
    pub used: [f64; 3],
}

impl Watch {
    /// Standing at `at`.
    pub fn new(params: &Params, at: Position) -> Self {
        let axis = |axis| {
            [
                i128::from(params.rapid(axis).nm_per_min()),
                i128::from(params.acceleration(axis).nm_per_s2()),
                i128::from(params.jerk(axis).nm_per_s3()),
            ]
        };
        Self {
            limits: Axis::ALL.map(axis),
            cutting: Axis::ALL.map(|axis| i128::from(params.max_feed(axis).nm_per_min())),
            tick_us: i128::from(params.tick_us()),
            last: [coordinates(at); 3],
            used: [0.0; 3],
        }
    }

    /// The next setpoint: no difference of it may be above its limit by more than its rounding, 2ⁿ · ½ nm.
    pub fn setpoint(&mut self, position: Position, pace: Pace) -> Result<(), String> {
        let now = coordinates(position);
        let [a, b, c] = self.last;
        for axis in 0..3 {
            let (p0, p1, p2, p3) = (now[axis], a[axis], b[axis], c[axis]);
            let differences = [p0 - p1, p0 - 2 * p1 + p2, p0 - 3 * p1 + 3 * p2 - p3];
            let mut limits = self.limits[axis];
            if pace == Pace::Cutting {
                limits[0] = self.cutting[axis];
            }
            // nm/min · µs, nm/s² · µs², nm/s³ · µs³ in units of a nanometre.
            let tick = self.tick_us;
            let scales = [60_000_000, 10_i128.pow(12), 10_i128.pow(18)];
            let times = [tick, tick * tick, tick * tick * tick];
            for n in 0..3 {
                let allowed = limits[n] * times[n];
                let size = differences[n].abs() * scales[n];
                if size > allowed + (1 << n) * scales[n] {
                    let what = ["speed", "acceleration", "jerk"][n];
                    return Err(format!(
                        "{:?} {what}: {} nm per tick, limit {} + {}",
                        Axis::ALL[axis],
                        differences[n],
                        allowed as f64 / scales[n] as f64,
                        1 << n
                    ));
                }
                // Where the limit is large against the rounding, how near it comes.
                if allowed > 1_000 * scales[n] {
                    let size = size - (1 << n) * scales[n];
                    self.used[n] = self.used[n].max(size as f64 / allowed as f64);
                }
            }
        }
        self.last = [now, a, b];
        Ok(())
    }
}

fn coordinates(position: Position) -> [i128; 3] {
    [position.x.nm(), position.z.nm(), position.c.udeg()].map(i128::from)
}
