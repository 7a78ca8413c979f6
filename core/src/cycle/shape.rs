//! Where the points of a thread pass lie (cycles.md, sections 3 and 4): pure geometry of one depth.
//!
//! Every coordinate is one closed expression of the pass's depth, rounded once to the nearest nanometre on the radius.
//! Displacements are rounded, halves away from zero, so a mirrored program gives mirrored points wherever its zero is.
//! Knows nothing of the order of passes' moves.

use core::num::NonZero;

use super::Stage;
use super::check::{blame, thread_ranges};
use super::slope::{FINE_BITS, FINE_HALF, Fine, HalfAngle, after};
use super::taper::{Taper, flip, quotient, scaled};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::program::{CutIn, ThreadCall};
use crate::units::{Diameter, Length, product, signed_product};

/// A point in the X–Z plane; X is a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Point {
    pub(crate) x: Length,
    pub(crate) z: Length,
}

/// The corners of one pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Corners {
    /// Where the synchronous motion begins: B, or the run-in's start.
    pub(crate) begin: Point,
    /// Where the pass's line is met: the end of the run-in, else `begin`.
    pub(crate) line: Point,
    /// Where the line is left: the run-out's start, else `end`.
    pub(crate) leave: Point,
    /// Where the synchronous motion ends.
    pub(crate) end: Point,
}

/// How far a pass's start is shifted along Z, as the number `u` of nanometres of depth whose `u·tan(a/2)` is the shift:
/// `base + slope · depth`, with one rule for odd passes, one for even ones and a fixed value for finishing.
#[derive(Clone, Copy, Debug)]
struct Flanks {
    odd: (i64, i64),
    even: (i64, i64),
    finish: i64,
}

/// The constants of a thread cycle's geometry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// A.
    start: Point,
    /// D.
    end: Point,
    /// Sign of Z_D − Z_A.
    sigma: i64,
    /// +1 external, −1 internal.
    side: i64,
    /// |Z_D − Z_A|.
    travel: u64,
    /// k.
    height: u64,
    /// True where X is the long axis.
    pub(crate) long_x: bool,
    tangent: HalfAngle,
    flanks: Flanks,
    taper: Option<Taper>,
    /// E, zero for none.
    run_in: u64,
    run_out: Option<Leave>,
}

/// What a run-out needs.
#[derive(Clone, Copy, Debug)]
struct Leave {
    /// X of its start less X of the pass's own D.
    x: Length,
    /// Z of its start.
    z: Length,
    /// Its end on the short axis, J away from its start and rounded once. With Z long: X of it less X of the pass's own D,
    /// not clipped at A yet. With X long: Z of it, clipped, for all passes alike.
    end: Length,
    /// K.
    long: u64,
}

impl Shape {
    /// The geometry of a call, or the alarm that forbids it whatever the depths are.
    #[inline(never)]
    pub(crate) fn new(call: &ThreadCall, span: Span) -> Result<Self, Alarm> {
        thread_ranges(call, span)?;
        let start = Point {
            x: call.start.x,
            z: call.start.z,
        };
        let end = Point {
            x: call.end_x.value,
            z: call.end_z.value,
        };
        let stroke = end.z - start.z;
        let Some(travel) = NonZero::new(stroke.nm().unsigned_abs()) else {
            return Err(blame(
                Code::ThreadWithoutLength,
                span,
                &call.end_z.span,
                b'Z',
            ));
        };
        if start.x == end.x {
            return Err(blame(Code::ThreadWithoutSide, span, &call.end_x.span, b'X'));
        }
        let (sigma, side) = (stroke.signum(), (start.x - end.x).signum());
        let height = call.height.value;
        if call.allowance.value >= height {
            return Err(
                blame(Code::AllowanceTooLarge, span, &call.allowance.span, b'R')
                    .with([Arg::Length(call.allowance.value), Arg::Length(height)]),
            );
        }
        if call.min_step.value > height {
            return Err(
                blame(Code::MinStepAboveHeight, span, &call.min_step.span, b'Q')
                    .with([Arg::Length(call.min_step.value), Arg::Length(height)]),
            );
        }
        let Some(tangent) = HalfAngle::of(call.angle.value) else {
            return Err(blame(Code::ThreadAngleRange, span, &call.angle.span, b'P')
                .with([Arg::Int(i64::from(call.angle.value))]));
        };
        let slant = call.taper.value;
        let long_x = travel.get() <= slant.nm().unsigned_abs();
        if long_x && call.run_in.value != Length::ZERO {
            return Err(blame(Code::RunInWithLongX, span, &call.run_in.span, b'E'));
        }
        // Both ends of the crest line must lie between the work and A.
        let crest = end.x + height.times(side);
        for x in [crest, crest + slant] {
            if (start.x - x).times(side) < Length::ZERO {
                return Err(
                    blame(Code::StartInsideThread, span, &call.end_x.span, b'X').with([
                        Arg::Diameter(Diameter::of_radius(start.x)),
                        Arg::Diameter(Diameter::of_radius(x)),
                    ]),
                );
            }
        }
        let taper = Taper::new(slant, side, travel, tangent);
        let mut shape = Self {
            start,
            end,
            sigma,
            side,
            travel: travel.get(),
            height: height.nm().unsigned_abs(),
            long_x,
            tangent,
            flanks: Flanks::new(
                call.cut_in.value,
                sigma,
                height,
                height - call.allowance.value,
            ),
            taper,
            run_in: call.run_in.value.nm().unsigned_abs(),
            run_out: None,
        };
        shape.run_out = shape.leave(call, span, travel)?;
        Ok(shape)
    }

    /// The run-out's constants.
    #[inline(never)]
    fn leave(
        &self,
        call: &ThreadCall,
        span: Span,
        travel: NonZero<u64>,
    ) -> Result<Option<Leave>, Alarm> {
        let Some(run_out) = call.run_out else {
            return Ok(None);
        };
        let (short, long) = (run_out.short.value, run_out.long.value);
        let length = long.nm().unsigned_abs();
        let slant = call.taper.value;
        let size = slant.nm().unsigned_abs();
        let j = run_out.short_rest.behind(short);
        let k = run_out.long_rest.behind(long);
        let (x, z, end) = if self.long_x {
            // |i| ≥ |W| > 0 here.
            let size = NonZero::new(size).unwrap_or(NonZero::<u64>::MIN);
            let slide = signed_product(travel.get() as i64, k);
            let back = slide.wrapping_add(signed_product(size.get() as i64, j));
            let end = self.end.z - quotient(back, size).times(self.sigma);
            (
                long.times(slant.signum()),
                self.end.z - quotient(slide, size).times(self.sigma),
                // Not beyond A.
                if (end - self.start.z).times(self.sigma) < Length::ZERO {
                    self.start.z
                } else {
                    end
                },
            )
        } else {
            let slide = signed_product(slant.nm(), k);
            let out = signed_product(travel.get() as i64, flip(j, self.side));
            (
                quotient(slide, travel),
                self.end.z - long.times(self.sigma),
                quotient(slide.wrapping_add(out), travel),
            )
        };
        // The line itself moves towards A by |i|·K/|W| when the thread grows from C to D: the tool must move faster.
        let grows = slant.signum() == self.side.wrapping_neg();
        let line = product(size, length);
        let tool = product(short.nm().unsigned_abs(), travel.get());
        if !self.long_x && grows && line >= tool {
            return Err(
                blame(Code::RunOutIntoThread, span, &run_out.short.span, b'J').with([
                    Arg::Length(short),
                    Arg::Length(long),
                    Arg::Length(scaled(size, length, travel)),
                ]),
            );
        }
        Ok(Some(Leave {
            x,
            z,
            end,
            long: length,
        }))
    }

    /// True where passes begin with a run-in.
    #[inline]
    pub(crate) const fn has_run_in(&self) -> bool {
        self.run_in != 0
    }

    /// True where passes end with a run-out. It always has a length: J and K have, and A is clear of the crests.
    #[inline]
    pub(crate) const fn has_run_out(&self) -> bool {
        self.run_out.is_some()
    }

    /// `u` of rough pass `n` at `depth`, or of the finishing passes.
    #[inline]
    pub(crate) fn flank(&self, n: u32, depth: Length, stroke: Stage) -> u64 {
        let flanks = &self.flanks;
        let (base, slope) = match (stroke, n & 1) {
            (Stage::Finish, _) => (flanks.finish, 0),
            (_, 1) => flanks.odd,
            (_, _) => flanks.even,
        };
        // Never negative: depths of rough passes end at k − d.
        base.wrapping_add(slope.wrapping_mul(depth.nm())) as u64
    }

    /// The corners of the pass at `depth` with the shift of `u`.
    #[inline]
    pub(crate) fn corners(&self, depth: Length, u: u64) -> Corners {
        let above = (self.height as i64).wrapping_sub(depth.nm());
        // X of the pass's own D.
        let x_end = moved(self.end.x, above, self.side);
        let shift = self.tangent.shift(u);
        let z = moved(self.start.z, shift as i64, self.sigma);
        let x = match &self.taper {
            None => x_end,
            Some(taper) => x_end + taper.left_after(after(u, taper.per_depth)),
        };
        let at_line = Point { x, z };
        let (begin, line) = if self.run_in == 0 {
            (at_line, at_line)
        } else {
            self.run_in(at_line, x_end, shift, u)
        };
        let (leave, end) = match &self.run_out {
            None => {
                let end = Point {
                    x: x_end,
                    z: self.end.z,
                };
                (end, end)
            }
            Some(out) => {
                let leave = Point {
                    x: moved(x_end, out.x.nm(), 1),
                    z: out.z,
                };
                let end = if self.long_x {
                    Point {
                        x: x_end,
                        z: out.end,
                    }
                } else {
                    let x = moved(x_end, out.end.nm(), 1);
                    let beyond = flip(x.nm().wrapping_sub(self.start.x.nm()), self.side) > 0;
                    Point {
                        x: if beyond { self.start.x } else { x },
                        z: self.end.z,
                    }
                };
                (leave, end)
            }
        };
        Corners {
            begin,
            line,
            leave,
            end,
        }
    }

    /// Begin and end of the run-in of E, clipped at the start level ([D9]: 45°).
    #[cold]
    fn run_in(&self, at_line: Point, x_end: Length, shift: u64, u: u64) -> (Point, Point) {
        // Room between the line's start and A on the radius: a whole number where there is no taper, and
        // `whole ± u·tan·|i|/|W|` where there is one.
        let to_end = flip((self.start.x - x_end).nm(), self.side);
        let along = |z: u64| self.start.z + Length::from_nm(flip(z as i64, self.sigma));
        let Some(taper) = &self.taper else {
            let length = (to_end.max(0) as u64).min(self.run_in);
            let begin = Point {
                x: at_line.x + Length::from_nm(flip(length as i64, self.side)),
                z: at_line.z,
            };
            let line = Point {
                x: at_line.x,
                z: along(shift.wrapping_add(length)),
            };
            return (begin, line);
        };
        let size = taper.size as i64;
        let (whole, room) = if taper.towards_start {
            let whole = to_end.wrapping_sub(size).max(0) as u64;
            (
                whole,
                (Fine::from(whole) << FINE_BITS).wrapping_add(after(u, taper.per_depth)),
            )
        } else {
            let whole = to_end.wrapping_add(size).max(0) as u64;
            (
                whole,
                (Fine::from(whole) << FINE_BITS).wrapping_sub(after(u, taper.per_depth)),
            )
        };
        if Fine::from(self.run_in) << FINE_BITS <= room {
            let lost = after(self.run_in, taper.per_travel).wrapping_add(after(u, taper.per_depth));
            let begin = Point {
                x: at_line.x + Length::from_nm(flip(self.run_in as i64, self.side)),
                z: at_line.z,
            };
            let line = Point {
                x: x_end + taper.left_after(lost),
                z: along(shift.wrapping_add(self.run_in)),
            };
            (begin, line)
        } else {
            let begin = Point {
                x: self.start.x,
                z: at_line.z,
            };
            // Along Z the line is met after u·tan plus the room, in one expression.
            let z = after(u, self.tangent.fine()).wrapping_add(room);
            let lost = after(whole, taper.per_travel).wrapping_add(after(u, taper.per_clipped));
            let line = Point {
                x: x_end + taper.left_after(lost),
                z: along((z.wrapping_add(FINE_HALF) >> FINE_BITS) as u64),
            };
            (begin, line)
        }
    }

    /// Refuses the pass where it starts at or beyond D, or has no stroke between run-in and run-out.
    pub(crate) fn check_pass(&self, pass: u32, corners: &Corners, span: Span) -> Result<(), Alarm> {
        let pass_number = Arg::Int(i64::from(pass));
        if (self.end.z - corners.begin.z).times(self.sigma) <= Length::ZERO {
            return Err(Alarm::new(Code::PassStartsBeyondEnd, span).with([
                pass_number,
                Arg::Length((corners.begin.z - self.start.z).abs()),
                Arg::Length(Length::from_nm(self.travel as i64)),
            ]));
        }
        // Compared on the long axis, in the direction of travel.
        let (cut, entry) = match &self.taper {
            Some(taper) if self.long_x => (
                (corners.line.x - corners.leave.x).times(taper.sign),
                Length::ZERO,
            ),
            _ => (
                (corners.leave.z - corners.line.z).times(self.sigma),
                (corners.line.z - corners.begin.z).abs(),
            ),
        };
        if cut <= Length::ZERO {
            let out = self.run_out.map_or(0, |out| out.long);
            return Err(Alarm::new(Code::StrokeTooShort, span).with([
                pass_number,
                Arg::Length(self.stroke(corners)),
                Arg::Length(entry),
                Arg::Length(Length::from_nm(out as i64)),
            ]));
        }
        Ok(())
    }

    /// Way on the long axis from the pass's start to D.
    pub(crate) fn stroke(&self, corners: &Corners) -> Length {
        if self.long_x {
            let x_end = corners.leave.x - self.run_out.map_or(Length::ZERO, |out| out.x);
            (x_end - corners.begin.x).abs()
        } else {
            (self.end.z - corners.begin.z).abs()
        }
    }

    /// True where no pass can fail [`Shape::check_pass`], judged by the largest shift any pass could have, a nanometre to
    /// spare for rounding. False decides nothing.
    pub(crate) fn is_surely_long_enough(&self) -> bool {
        let flanks = &self.flanks;
        let most = |(base, slope): (i64, i64)| {
            let deepest = if slope > 0 { self.height as i64 } else { 0 };
            base.wrapping_add(deepest)
        };
        let u = most(flanks.odd)
            .max(most(flanks.even))
            .max(flanks.finish)
            .unsigned_abs();
        let out = self.run_out.map_or(0, |out| out.long);
        let shift = self.tangent.shift(u);
        let taken = shift.saturating_add(self.run_in).saturating_add(2);
        if self.long_x {
            let Some(taper) = &self.taper else {
                return false;
            };
            if self.travel <= taken {
                return false;
            }
            let lost = (after(u, taper.per_depth) >> FINE_BITS) as u64;
            taper.size > lost.saturating_add(out).saturating_add(2)
        } else {
            self.travel > taken.saturating_add(out)
        }
    }
}

impl Flanks {
    /// The rules of a cut-in mode ([G78 sheet], P(r); [D6]) for a thread cut towards `sigma`.
    fn new(cut_in: CutIn, sigma: i64, height: Length, limit: Length) -> Self {
        let limit = limit.nm();
        let trailing = (0, 1);
        let leading = (limit.wrapping_mul(2), -1);
        let (left, right) = if sigma < 0 {
            (leading, trailing)
        } else {
            (trailing, leading)
        };
        let middle = (limit, 0);
        let (odd, even, finish) = match cut_in {
            CutIn::Centre => ((0, 0), (0, 0), 0),
            CutIn::Left => (left, left, limit),
            CutIn::Right => (right, right, limit),
            CutIn::RightCentre => (right, middle, limit),
            CutIn::LeftRight => (left, right, limit),
            CutIn::Trailing => (trailing, trailing, height.nm()),
        };
        Self { odd, even, finish }
    }
}

/// `from` plus `by` in the direction of `sign` (±1). Saturates nowhere: coordinates are far inside the integer's range, and
/// this is the innermost arithmetic of the cycles.
#[inline]
const fn moved(from: Length, by: i64, sign: i64) -> Length {
    Length::from_nm(from.nm().wrapping_add(flip(by, sign)))
}
