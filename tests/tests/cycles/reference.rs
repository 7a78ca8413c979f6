//! A thread cycle once more, slowly and straight from the text: floating-point geometry as displacements from A and D,
//! depths by long integer roots. Shares no arithmetic with the core.

use leadscrew_core::call::*;
use leadscrew_core::moves::Stage;

/// One move as the text has it: X and Z as displacements from D's X and A's Z in nanometres, not rounded.
#[derive(Clone, Copy, Debug)]
pub struct Expected {
    pub stage: Stage,
    pub pass: u32,
    pub start: u8,
    pub depth: i64,
    pub x: f64,
    pub z: f64,
}

/// What forbids the cycle, with the pass where one is to blame; and how near the decision was, in nanometres.
#[derive(Clone, Copy, Debug)]
pub struct Refusal {
    pub number: u16,
    pub pass: u32,
    pub margin: f64,
}

/// Rough depths. `√n·Δd` with 30 fractional bits; a comparison closer than that would be noticed.
pub fn rough_depths(call: &ThreadCall) -> Vec<i64> {
    let nm = |at: &leadscrew_core::alarm::At<leadscrew_core::units::Length>| at.value.nm();
    let limit = nm(&call.height) - nm(&call.allowance);
    let (first, min, lsb) = (
        nm(&call.first_depth),
        nm(&call.min_step),
        call.increment.nm(),
    );
    let root = |n: u32| ((u128::from(n) * (first as u128) * (first as u128)) << 60).isqrt() as i128;
    let mut depths: Vec<i64> = Vec::new();
    let mut clamped = false;
    for n in 1u32.. {
        let previous = depths.last().copied().unwrap_or(0);
        let depth = match call.infeed {
            Infeed::Equal => i64::from(n) * first,
            Infeed::Decreasing if n == 1 => first,
            Infeed::Decreasing => {
                let step = root(n) - root(n - 1);
                let wanted = i128::from(min) << 30;
                if min != 0 {
                    assert!((step - wanted).abs() > 2, "too close to call");
                }
                clamped |= step < wanted;
                if clamped {
                    previous + min.max(lsb)
                } else {
                    let half = i128::from(lsb) << 29;
                    let whole = (root(n) + half) / (i128::from(lsb) << 30);
                    (whole as i64 * lsb).max(previous + lsb)
                }
            }
        };
        depths.push(depth.min(limit));
        if depth >= limit || n > 9999 {
            return depths;
        }
    }
    unreachable!()
}

/// The moves, or the reason why there are none. Zero-length moves are left out.
pub fn thread(call: &ThreadCall) -> Result<Vec<Expected>, Refusal> {
    let refuse = |number, margin: f64| Refusal {
        number,
        pass: 0,
        margin: margin.abs(),
    };
    let far = f64::INFINITY;
    let x_a = (call.start.x - call.end_x.value).nm() as f64;
    let w = (call.end_z.value - call.start.z).nm() as f64;
    let i = call.taper.value.nm() as f64;
    let k = call.height.value.nm() as f64;
    let d = call.allowance.value.nm() as f64;
    let e = call.run_in.value.nm() as f64;
    let t = (f64::from(call.angle.value) * std::f64::consts::PI / 360.0).tan();
    if w == 0.0 {
        return Err(refuse(4101, far));
    }
    if x_a == 0.0 {
        return Err(refuse(4102, far));
    }
    let (sigma, s) = (w.signum(), x_a.signum());
    if d >= k {
        return Err(refuse(4100, far));
    }
    if call.min_step.value.nm() as f64 > k {
        return Err(refuse(316, far));
    }
    let long_x = w.abs() <= i.abs();
    if long_x && e != 0.0 {
        return Err(refuse(4107, far));
    }
    for x in [s * k, i + s * k] {
        if s * (x_a - x) < 0.0 {
            return Err(refuse(4103, far));
        }
    }
    if let Some(out) = call.run_out {
        let (j, long) = (out.short.value.nm() as f64, out.long.value.nm() as f64);
        let towards_a = -s * i * long / w.abs();
        if !long_x && towards_a >= j {
            return Err(refuse(4106, towards_a - j));
        }
    }
    let rough = rough_depths(call);
    if rough.len() > 9999 {
        return Err(refuse(4108, far));
    }
    let finishing = usize::from(call.finish_passes.value.max(1));
    let depths = rough.iter().copied().map(|depth| (depth, false));
    let depths = depths.chain(std::iter::repeat_n((k as i64, true), finishing));
    let mut moves = Vec::new();
    for (index, (depth_nm, finish)) in depths.enumerate() {
        let pass = index as u32 + 1;
        let depth = depth_nm as f64;
        // Section 4's table, as shifts in the direction of travel.
        let right = |depth: f64| {
            if sigma < 0.0 {
                depth
            } else {
                2.0 * (k - d) - depth
            }
        };
        let left = |depth: f64| {
            if sigma > 0.0 {
                depth
            } else {
                2.0 * (k - d) - depth
            }
        };
        let odd = pass % 2 == 1;
        let shift = t * match call.cut_in.value {
            CutIn::Trailing => depth,
            CutIn::Centre => 0.0,
            _ if finish => k - d,
            CutIn::Left => left(depth),
            CutIn::Right => right(depth),
            CutIn::RightCentre if odd => right(depth),
            CutIn::RightCentre => k - d,
            CutIn::LeftRight if odd => left(depth),
            CutIn::LeftRight => right(depth),
        };
        let z_n = sigma * shift;
        let line = |z: f64| i * (w - z).abs() / w.abs() + s * (k - depth);
        let x_n = line(z_n);
        let x_d = s * (k - depth);
        if shift >= w.abs() - 0.5 {
            return Err(Refusal {
                number: 4105,
                pass,
                margin: shift - w.abs() + 0.5,
            });
        }
        let mut corners = Vec::new();
        let (mut entry, mut begin) = (0.0, (x_n, z_n));
        if e != 0.0 {
            entry = e.min((x_a - x_n).abs());
            begin = (x_n + s * entry, z_n);
            let z = z_n + sigma * entry;
            corners.push((Stage::RunIn, line(z), z));
        }
        let stroke = if finish { Stage::Finish } else { Stage::Rough };
        let mut exit = 0.0;
        let end = match call.run_out {
            None => (x_d, w),
            Some(out) => {
                let (j, long) = (out.short.value.nm() as f64, out.long.value.nm() as f64);
                exit = long;
                if long_x {
                    let z = w - sigma * long * w.abs() / i.abs();
                    corners.push((stroke, x_d + i.signum() * long, z));
                    (x_d, z - sigma * j.min(z.abs()))
                } else {
                    let x = line(w - sigma * long);
                    corners.push((stroke, x, w - sigma * long));
                    (x + s * j.min((x_a - x).abs()), w)
                }
            }
        };
        let last = if call.run_out.is_some() {
            Stage::RunOut
        } else {
            stroke
        };
        corners.push((last, end.0, end.1));
        let length = if long_x {
            i.abs() * (w.abs() - shift) / w.abs()
        } else {
            w.abs() - shift
        };
        // At 90° the shift is the depth: where both are equal to the nanometre, the last digit of a float must not decide.
        if length <= entry + exit + 1e-3 {
            return Err(Refusal {
                number: 4104,
                pass,
                margin: length - entry - exit,
            });
        }
        corners.insert(0, (Stage::Approach, begin.0, begin.1));
        corners.push((Stage::Retract, x_a, end.1));
        corners.push((Stage::Return, x_a, 0.0));
        for start in 1..=call.starts.value {
            let mut from = (x_a, 0.0);
            for &(stage, x, z) in &corners {
                if (x - from.0).abs() >= 0.5 || (z - from.1).abs() >= 0.5 {
                    moves.push(Expected {
                        stage,
                        pass,
                        start,
                        depth: depth_nm,
                        x,
                        z,
                    });
                }
                from = (x, z);
            }
        }
    }
    Ok(moves)
}

/// G75 by the loop of section 5, in integers: (stage, column, peck, x, z).
pub fn groove(call: &GrooveCall) -> Vec<(Stage, u32, u32, i64, i64)> {
    let (x_a, z_a) = (call.start.x.nm(), call.start.z.nm());
    let (x_d, z_d) = (call.end_x.value.nm(), call.end_z.value.nm());
    let di = call.peck.unwrap().value.nm();
    let dk = call.step.map_or(0, |step| step.value.nm());
    let (e, dd) = (call.retract.value.nm(), call.relief.value.nm());
    let down = (x_d - x_a).signum();
    let along = (z_d - z_a).signum();
    let aside = if along != 0 {
        -along
    } else if call.last_written {
        -1
    } else {
        1
    };
    let mut moves = Vec::new();
    let mut from = (x_a, z_a);
    let mut go = |stage, column, peck, x: i64, z: i64| {
        if (x, z) != from {
            moves.push((stage, column, peck, x, z));
            from = (x, z);
        }
    };
    let mut z = z_a;
    for column in 1.. {
        for n in 1.. {
            let depth = (n * di).min((x_d - x_a).abs());
            let x = x_a + down * depth;
            go(Stage::Peck, column, n as u32, x, z);
            if x == x_d {
                break;
            }
            go(Stage::Retract, column, 0, x - down * e.min(depth), z);
        }
        go(Stage::Relief, column, 0, x_d, z + aside * dd);
        go(Stage::Retract, column, 0, x_a, z + aside * dd);
        if z == z_d {
            go(Stage::Return, column, 0, x_a, z_a);
            return moves;
        }
        z = z_a + along * (i64::from(column) * dk).min((z_d - z_a).abs());
        go(Stage::Shift, column, 0, x_a, z);
    }
    unreachable!()
}
