//! How far the drive of an axis has to turn further after a reversal, until the slide follows again: backlash (1851).
//!
//! A drive's own encoder does not see it. Where an axis moves in the minus direction, its drive is told a place that is
//! less by the backlash; in the plus direction, and from the reference on, it is told the place itself. So what is put in
//! changes with the side of the axis' last motion and with nothing else.
//!
//! ```text
//! place ─► the side changes (more than 1 µm back) ─► ramp of r a tick ─► two lags of τ ticks ─► what is put in
//! ```
//!
//! r and τ are those of the [shape](TakeUpShape), which holds the limits. In the tick: additions and shifts.
//!
//! Must not know what an axis is moved for, or its drive's increments.

use crate::params::TakeUpShape;
use crate::units::Axis;

/// A motion back by more than this is a reversal, in nanometres: setpoints that follow a spindle may tremble.
const REVERSAL: i64 = 1_000;

/// One axis: the side of its last motion, and what is put in.
#[derive(Clone, Copy, Debug)]
struct TakeUp {
    shape: TakeUpShape,
    /// Its last motion was in the plus direction, or it is at its reference.
    plus: bool,
    /// The farthest place on this side.
    farthest: i64,
    /// What will have been put in.
    goal: i32,
    ramp: i32,
    first: i32,
    /// What has been put in.
    second: i32,
}

impl TakeUp {
    const fn new(shape: TakeUpShape) -> Self {
        Self {
            shape,
            plus: true,
            farthest: 0,
            goal: 0,
            ramp: 0,
            first: 0,
            second: 0,
        }
    }

    /// What has been put in, in nanometres.
    const fn put_in(&self) -> i64 {
        (self.second.wrapping_add(1 << (TakeUpShape::PLACES - 1)) >> TakeUpShape::PLACES) as i64
    }

    /// The drive does not follow: what has been put in stays.
    const fn rest(&mut self, place: i64) {
        self.farthest = place;
        (self.ramp, self.first) = (self.second, self.second);
    }

    /// What is put in for the next place.
    #[inline(always)]
    fn next(&mut self, place: i64) -> i64 {
        let back = if self.plus {
            self.farthest.wrapping_sub(place)
        } else {
            place.wrapping_sub(self.farthest)
        };
        if back < 0 {
            self.farthest = place;
        } else if back > REVERSAL {
            self.farthest = place;
            self.plus = !self.plus;
            self.goal = if self.plus {
                0
            } else {
                self.shape.way.wrapping_neg()
            };
        }
        let TakeUpShape { ramp, lag, .. } = self.shape;
        let missing = self.goal.wrapping_sub(self.ramp);
        self.ramp = self
            .ramp
            .wrapping_add(missing.max(ramp.wrapping_neg()).min(ramp));
        let behind = |ahead: i32, value: i32| {
            value.wrapping_add(ahead.wrapping_sub(value).wrapping_shr(lag))
        };
        self.first = behind(self.ramp, self.first);
        self.second = behind(self.first, self.second);
        self.put_in()
    }
}

/// X and Z, where one of them has backlash.
#[derive(Clone, Copy, Debug)]
pub(super) struct Backlash([TakeUp; 2]);

impl Backlash {
    /// With other parameters, or for the first time. What has been put in stays until the next reversal: parameters move
    /// nothing. `None` where nothing is and nothing will be put in.
    pub(super) fn of(shapes: [TakeUpShape; 2], before: Option<Self>) -> Option<Self> {
        let mut now = shapes.map(TakeUp::new);
        if let Some(Self(before)) = before {
            for (now, before) in now.iter_mut().zip(before) {
                let is_same = now.shape.way == before.shape.way;
                *now = TakeUp {
                    shape: now.shape,
                    goal: if is_same { before.goal } else { before.second },
                    ..before
                };
                now.rest(before.farthest);
            }
        }
        let any = now
            .iter()
            .any(|axis| axis.shape.way != 0 || axis.put_in() != 0);
        any.then_some(Self(now))
    }

    const fn axis(&mut self, axis: Axis) -> Option<&mut TakeUp> {
        let [x, z] = &mut self.0;
        match axis {
            Axis::X => Some(x),
            Axis::Z => Some(z),
            Axis::C => None,
        }
    }

    /// The axis has just got its reference: from here on nothing is put in. Its place comes by [`rest`](Self::rest), or
    /// with the next one while its drive does not follow.
    pub(super) const fn refer(&mut self, axis: Axis) {
        if let Some(axis) = self.axis(axis) {
            *axis = TakeUp {
                farthest: axis.farthest,
                ..TakeUp::new(axis.shape)
            };
        }
    }

    /// The axis rests here, whatever it was told before. Gives what has been put in, in nanometres.
    pub(super) const fn rest(&mut self, axis: Axis, place: i64) -> i64 {
        let Some(axis) = self.axis(axis) else {
            return 0;
        };
        axis.rest(place);
        axis.put_in()
    }

    /// What has been put in, in nanometres, for X, Z and C.
    pub(super) const fn put_in(&self) -> [i64; 3] {
        let [x, z] = &self.0;
        [x.put_in(), z.put_in(), 0]
    }

    /// The places that the drives are told for these places of the axes, in nanometres. A drive that does not follow yet is
    /// told where it is.
    #[inline(never)]
    pub(super) fn places(&mut self, mut places: [i64; 3], follow: [bool; 3]) -> [i64; 3] {
        for ((axis, place), follows) in self.0.iter_mut().zip(&mut places).zip(follow) {
            let put_in = if follows {
                axis.next(*place)
            } else {
                axis.rest(*place);
                axis.put_in()
            };
            *place = place.wrapping_add(put_in);
        }
        places
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::params::{Entry, Params};
    use leadscrew_seed::{amount, volume};

    /// 1 mm = 10⁶ nm.
    const MM: i64 = 1_000_000;

    fn params(values: &[(&str, i64)]) -> Params {
        let mut params = Params::sheets();
        for (key, raw) in values {
            let entry = Entry::find_text(key).unwrap();
            params.set(entry, *raw).unwrap();
        }
        params
    }

    fn x_alone(params: &Params) -> TakeUp {
        TakeUp::new(TakeUpShape::of(params, Axis::X))
    }

    /// All that is put in until nothing changes any more.
    fn settle(axis: &mut TakeUp, place: i64) -> Vec<i64> {
        let mut all = vec![axis.put_in()];
        let mut same = 0;
        while same < 200 {
            let before = axis.put_in();
            let now = axis.next(place);
            same = if now == before { same + 1 } else { 0 };
            all.push(now);
        }
        all
    }

    /// Speed, acceleration and jerk of a list of places, at their largest, per tick.
    fn figures(places: &[i64]) -> [i64; 3] {
        let differences = |list: &[i64]| list.windows(2).map(|two| two[1] - two[0]).collect();
        let mut list: Vec<i64> = places.to_vec();
        [(); 3].map(|()| {
            list = differences(&list);
            list.iter().map(|value| value.abs()).max().unwrap_or(0)
        })
    }

    #[test]
    fn it_is_put_in_once_after_a_reversal_and_to_the_nanometre() {
        let params = params(&[("1851.X", 20_000)]);
        let mut axis = x_alone(&params);
        for place in 0..100 {
            assert_eq!(axis.next(place * 1_000), 0);
        }
        let back = 99_000 - REVERSAL;
        assert_eq!(
            settle(&mut axis, back).last(),
            Some(&0),
            "it has only trembled"
        );
        assert_eq!(settle(&mut axis, back - 1).last(), Some(&-20_000));
        assert_eq!(settle(&mut axis, -5 * MM).last(), Some(&-20_000));
        assert_eq!(settle(&mut axis, -5 * MM + REVERSAL).last(), Some(&-20_000));
        assert_eq!(settle(&mut axis, -5 * MM + REVERSAL + 1).last(), Some(&0));
    }

    /// With the parameters of the built-in machine: within 150 ms.
    #[test]
    fn it_is_put_in_soon() {
        let params = params(&[("1851.X", 20_000)]);
        let mut axis = x_alone(&params);
        axis.next(0);
        let all = settle(&mut axis, -MM);
        let ticks = all.iter().position(|value| *value <= -19_900).unwrap();
        assert!(ticks < 150, "{ticks}");
        // Until 25 nm are left.
        assert_eq!(params.take_up_us(Axis::X), 156_000);
        assert_eq!(params.take_up_us(Axis::Z), 0, "it has none");
    }

    /// Whatever the axis does, and whatever its limits are: what is put in uses no more than its part of them.
    #[test]
    fn what_is_put_in_keeps_its_part_of_the_limits() {
        volume(0x1851, |seed| {
            let mut state = seed;
            let mut draw = |most: u64| {
                state = state
                    .wrapping_mul(0x5851_F42D_4C95_7F2D)
                    .wrapping_add(0x1405_7B7E_F767_814F);
                (state >> 33) % most
            };
            for _ in 0..amount(40, 4_000) {
                let tick_us = [250, 500, 1_000, 2_000, 4_000][draw(5) as usize];
                let acceleration = 10_000_000 * (1 + draw(2_000)) as i64;
                let jerk = 1_000_000_000 * (1 + draw(20_000)) as i64;
                let mut params = params(&[
                    ("1851.X", 1 + draw(1_000_000) as i64),
                    ("1620.X", acceleration),
                    ("1622.X", jerk),
                ]);
                let tick = Entry::find_text("9000").unwrap();
                if params.set(tick, tick_us).is_err() {
                    continue;
                }
                let mut axis = x_alone(&params);
                let mut place = 0;
                let mut all = vec![0; 3];
                for _ in 0..20 {
                    let way = draw(100_000) as i64 - 50_000;
                    for _ in 0..=draw(300) {
                        place += way;
                        all.push(axis.next(place));
                    }
                }
                let seconds = tick_us as f64 / 1e6;
                let [_, a, j] = figures(&all);
                let part = crate::params::TAKE_UP_PART as f64;
                // Three and four roundings to a nanometre.
                let most = acceleration as f64 * seconds.powi(2) / part + 2.0;
                assert!(a as f64 <= most, "{a} above {most}: {params:?}");
                let most = jerk as f64 * seconds.powi(3) / part + 4.0;
                assert!(j as f64 <= most, "{j} above {most}: {params:?}");
            }
        });
    }

    #[test]
    fn other_parameters_move_nothing_until_the_next_reversal() {
        let with =
            |way| [Axis::X, Axis::Z].map(|axis| TakeUpShape::of(&params(&[("1851.X", way)]), axis));
        let mut now = Backlash::of(with(20_000), None).unwrap();
        let all = [true; 3];
        for place in [0, -MM] {
            for _ in 0..500 {
                now.places([place, 0, 0], all);
            }
        }
        assert_eq!(now.put_in(), [-20_000, 0, 0]);
        let mut now = Backlash::of(with(0), Some(now)).unwrap();
        for _ in 0..500 {
            assert_eq!(now.places([-MM, 5, 7], all), [-MM - 20_000, 5, 7]);
        }
        for _ in 0..500 {
            now.places([0, 5, 7], all);
        }
        assert_eq!(now.put_in(), [0; 3]);
        assert!(
            Backlash::of(with(0), Some(now)).is_none(),
            "nothing is left of it"
        );
    }

    #[test]
    fn what_has_been_put_in_stays_while_the_drive_does_not_follow() {
        let plays =
            [Axis::X, Axis::Z].map(|axis| TakeUpShape::of(&params(&[("1851.Z", 20_000)]), axis));
        let mut now = Backlash::of(plays, None).unwrap();
        now.places([0; 3], [true; 3]);
        for _ in 0..60 {
            now.places([0, -MM, 0], [true; 3]);
        }
        let [_, half, _] = now.put_in();
        assert!((-19_000..-1_000).contains(&half), "{half}");
        assert_eq!(
            now.places([0, 3 * MM, 0], [false; 3]),
            [0, 3 * MM + half, 0]
        );
        // A place on the other side while it did not follow is no reversal: it goes on towards the same side, from rest.
        let next = now.places([0, 3 * MM, 0], [true; 3])[1] - 3 * MM;
        assert!((half - 10..=half).contains(&next), "{half} {next}");
    }
}
