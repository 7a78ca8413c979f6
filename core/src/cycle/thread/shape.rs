//! Where the points of a thread pass lie: pure geometry of one depth.
//!
//! Every coordinate is one closed expression of the pass's depth, rounded once to the nearest nanometre on the radius.
//! Displacements count from D and A in the thread's own directions, and their halves are rounded away from zero. So a
//! mirrored program gives mirrored points wherever its zero is. Knows nothing of the order of the moves in a pass.

use super::slope::{FINE_BITS, FINE_HALF, Fine, HalfAngle, after};
use super::taper::{Taper, flip, quotient};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{CutIn, RunOut, ThreadCall};
use crate::moves::Stage;
use crate::units::{Length, signed_product};

/// One pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    pub(crate) number: u32,
    pub(crate) depth: Length,
    /// Rough or finish.
    pub(crate) stroke: Stage,
}

/// A point of a thread in nanometres, in the thread's own directions. Mirrored threads have the same points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Point {
    /// From D's X towards A, on the radius; in a stroke along +X.
    pub(crate) out: i64,
    /// From A's Z towards D; in a stroke along +Z.
    pub(crate) along: i64,
}

/// A point in machine coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct MachinePoint {
    pub(crate) x: Length,
    pub(crate) z: Length,
}

/// The corners of one pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Corners {
    /// Where the synchronous motion begins: B, or the run-in's start.
    pub(crate) begin: Point,
    /// Where the tool reaches the pass's line: the end of the run-in, or `begin` without a run-in.
    pub(crate) line: Point,
    /// Where the tool leaves the line: the start of the run-out, or `end` without a run-out.
    pub(crate) leave: Point,
    /// Where the synchronous motion ends.
    pub(crate) end: Point,
}

/// The constants of a thread cycle's geometry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// X of D, Z of A.
    x: Length,
    z: Length,
    /// Sign of Z_D − Z_A; in a stroke 1.
    sigma: i64,
    /// +1 external, −1 internal; in a stroke 1.
    side: i64,
    /// |Z_D − Z_A|; in a stroke with its sign.
    travel: i64,
    /// |X_A − X_D|; in a stroke with its sign.
    room: i64,
    /// k.
    height: i64,
    /// k − d.
    limit: i64,
    /// True where X is the long axis.
    pub(crate) long_x: bool,
    /// One stroke from A to D, where the tool stays: G32.
    pub(crate) stays: bool,
    tangent: HalfAngle,
    cut_in: CutIn,
    taper: Option<Taper>,
    /// E, zero for none.
    run_in: u64,
    run_out: Option<Leave>,
}

/// The figures of a run-out.
#[derive(Clone, Copy, Debug)]
struct Leave {
    /// Its start: out from the pass's own D, and along.
    out: i64,
    along: i64,
    /// The run-out's end on the short axis, J away from its start and rounded once. With Z long: out from the pass's own
    /// D, not yet clipped at A. With X long: along, clipped, and the same for all passes.
    end: i64,
    /// K.
    long: i64,
}

impl Shape {
    /// The shape of a cycle that [`refuse_thread`](super::refuse::refuse_thread) has accepted.
    #[inline]
    pub(crate) fn of(call: &ThreadCall) -> Self {
        let (x, z) = (call.end_x.value, call.start.z);
        let stroke = call.end_z.value - z;
        let room = call.start.x - x;
        if call.cycle.is_stroke() {
            return Self::of_stroke(call, room.nm(), stroke.nm());
        }
        let (sigma, side) = (stroke.signum(), room.signum());
        let travel = stroke.nm().unsigned_abs();
        let lean = flip(call.taper.value.nm(), side);
        let tangent = HalfAngle::of(call.angle.value).unwrap_or_default();
        let long_x = is_long_x(call);
        Self {
            x,
            z,
            sigma,
            side,
            travel: travel as i64,
            room: room.abs().nm(),
            height: call.height.value.nm(),
            limit: (call.height.value - call.allowance.value).nm(),
            long_x,
            stays: false,
            tangent,
            cut_in: call.cut_in.value,
            taper: Taper::new(lean, travel, tangent),
            run_in: call.run_in.value.nm().unsigned_abs(),
            run_out: call
                .run_out
                .as_ref()
                .map(|run_out| Leave::new(run_out, lean, travel, long_x)),
        }
    }

    /// A stroke: a line from A to D, and the run-out beside it. Its points count along the axes.
    fn of_stroke(call: &ThreadCall, room: i64, travel: i64) -> Self {
        let long_x = is_long_x(call);
        Self {
            x: call.end_x.value,
            z: call.start.z,
            sigma: 1,
            side: 1,
            travel,
            room,
            height: 0,
            limit: 0,
            long_x,
            stays: true,
            tangent: HalfAngle::default(),
            cut_in: CutIn::Centre,
            taper: None,
            run_in: 0,
            run_out: call
                .run_out
                .as_ref()
                .map(|run_out| Leave::of_stroke(run_out, room, travel, long_x)),
        }
    }

    /// A point in machine coordinates.
    #[inline]
    pub(crate) fn place(&self, at: &Point) -> MachinePoint {
        // Needs no saturation: coordinates are far inside the integer's range, and this is the innermost arithmetic of
        // the cycles.
        let x = self.x.nm().wrapping_add(flip(at.out, self.side));
        let z = self.z.nm().wrapping_add(flip(at.along, self.sigma));
        MachinePoint {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
        }
    }

    /// A.
    #[inline]
    pub(crate) const fn home(&self) -> Point {
        Point {
            out: self.room,
            along: 0,
        }
    }

    /// D.
    const fn bottom(&self) -> Point {
        Point {
            out: 0,
            along: self.travel,
        }
    }

    /// True where passes begin with a run-in.
    #[inline]
    pub(crate) const fn has_run_in(&self) -> bool {
        self.run_in != 0
    }

    /// True where passes end with a run-out.
    #[inline]
    pub(crate) const fn has_run_out(&self) -> bool {
        self.run_out.is_some()
    }

    /// The corners of a pass.
    #[inline]
    pub(crate) fn corners(&self, pass: &Pass) -> Corners {
        if self.stays {
            return self.line();
        }
        let depth = pass.depth.nm();
        let u = self.shifted(pass);
        // The pass's own D.
        let above = self.height.wrapping_sub(depth);
        let at_line = Point {
            out: match &self.taper {
                None => above,
                Some(taper) => above.wrapping_add(taper.left_after(after(u, taper.per_depth))),
            },
            along: self.tangent.shift(u) as i64,
        };
        let (begin, line) = if self.run_in == 0 {
            (at_line, at_line)
        } else {
            self.run_in(at_line, above, u)
        };
        let end = Point {
            out: above,
            along: self.travel,
        };
        let (leave, end) = match &self.run_out {
            None => (end, end),
            Some(out) => {
                let leave = Point {
                    out: above.wrapping_add(out.out),
                    along: out.along,
                };
                let end = if self.long_x {
                    Point {
                        along: out.end,
                        ..end
                    }
                } else {
                    Point {
                        out: above.wrapping_add(out.end).min(self.room),
                        ..end
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

    /// Where a stroke ends.
    pub(crate) fn stroke_end(&self) -> Point {
        self.line().end
    }

    /// The corners of a stroke.
    pub(super) fn line(&self) -> Corners {
        let (begin, bottom) = (self.home(), self.bottom());
        let (leave, end) = match &self.run_out {
            None => (bottom, bottom),
            Some(out) => {
                let leave = Point {
                    out: out.out,
                    along: out.along,
                };
                let end = if self.long_x {
                    Point {
                        along: out.end,
                        ..bottom
                    }
                } else {
                    Point {
                        out: out.end,
                        ..bottom
                    }
                };
                (leave, end)
            }
        };
        Corners {
            begin,
            line: begin,
            leave,
            end,
        }
    }

    /// The shift of a pass's start along Z, as a depth of `u` nanometres: the shift is `u·tan(a/2)`
    /// ([G78 sheet], P(r); [D6]). Never negative: depths of rough passes end at k − d.
    #[inline]
    fn shifted(&self, pass: &Pass) -> u64 {
        let depth = pass.depth.nm();
        // Infeed along one flank: most threads are cut this way.
        if self.cut_in == CutIn::Trailing {
            return depth as u64;
        }
        let odd = pass.number & 1 == 1;
        let forwards = self.sigma > 0;
        // Along the trailing flank the shift grows with the depth, along the leading one it shrinks.
        let trailing = match self.cut_in {
            CutIn::Centre => return 0,
            _ if pass.stroke == Stage::Finish => return self.limit as u64,
            CutIn::RightCentre if !odd => return self.limit as u64,
            CutIn::Left => forwards,
            CutIn::Right | CutIn::RightCentre => !forwards,
            CutIn::LeftRight => forwards == odd,
            // Returned above.
            CutIn::Trailing => true,
        };
        if trailing {
            depth as u64
        } else {
            self.limit.wrapping_mul(2).wrapping_sub(depth) as u64
        }
    }

    /// Start and end of the run-in to a line that begins at the given point. The run-in starts E out from this point, or
    /// at A where A is nearer, and goes to the line at 45°.
    #[cold]
    fn run_in(&self, at_line: Point, above: i64, u: u64) -> (Point, Point) {
        let (mut begin, mut line) = (at_line, at_line);
        // Room between the line's start and A on the radius: a whole number where there is no taper, and
        // `whole ± u·tan·|i|/|W|` where there is one.
        let to_end = self.room.wrapping_sub(above);
        let Some(taper) = &self.taper else {
            let length = (to_end.max(0) as u64).min(self.run_in) as i64;
            begin.out = begin.out.wrapping_add(length);
            line.along = line.along.wrapping_add(length);
            return (begin, line);
        };
        let whole = to_end.wrapping_sub(flip(taper.size as i64, taper.sign));
        let whole = whole.max(0) as u64;
        let taken = after(u, taper.per_depth);
        let room = if taper.sign > 0 {
            (Fine::from(whole) << FINE_BITS).wrapping_add(taken)
        } else {
            (Fine::from(whole) << FINE_BITS).wrapping_sub(taken)
        };
        let lost = if Fine::from(self.run_in) << FINE_BITS <= room {
            begin.out = begin.out.wrapping_add(self.run_in as i64);
            line.along = line.along.wrapping_add(self.run_in as i64);
            after(self.run_in, taper.per_travel).wrapping_add(taken)
        } else {
            begin.out = self.room;
            // Along Z the line is met after u·tan plus the room, in one expression.
            let z = after(u, self.tangent.fine()).wrapping_add(room);
            line.along = (z.wrapping_add(FINE_HALF) >> FINE_BITS) as i64;
            after(whole, taper.per_travel).wrapping_add(after(u, taper.per_clipped))
        };
        line.out = above.wrapping_add(taper.left_after(lost));
        (begin, line)
    }

    /// Refuses the pass where it starts at or beyond D, or has no stroke between run-in and run-out.
    pub(crate) fn check_pass(&self, pass: u32, corners: &Corners, span: Span) -> Result<(), Alarm> {
        let pass_number = Arg::Int(i64::from(pass));
        let length = |nm| Arg::Length(Length::from_nm(nm));
        let Corners {
            begin, line, leave, ..
        } = corners;
        if begin.along >= self.travel {
            return Err(Alarm::new(Code::PassStartsBeyondEnd, span).with([
                pass_number,
                length(begin.along),
                length(self.travel),
            ]));
        }
        // Compared on the long axis, in the direction of travel.
        let (cut, entry) = match &self.taper {
            Some(taper) if self.long_x => (flip(line.out.wrapping_sub(leave.out), taper.sign), 0),
            _ => (
                leave.along.wrapping_sub(line.along),
                line.along.wrapping_sub(begin.along),
            ),
        };
        if cut <= 0 {
            return Err(Alarm::new(Code::StrokeTooShort, span).with([
                pass_number,
                Arg::Length(self.stroke(corners)),
                length(entry),
                length(self.run_out.as_ref().map_or(0, |out| out.long)),
            ]));
        }
        Ok(())
    }

    /// True where no pass can fail [`Shape::check_pass`]. The test uses the largest shift that any pass could have, with
    /// two nanometres to spare for rounding. False decides nothing.
    pub(crate) fn is_surely_long_enough(&self) -> bool {
        let most = match self.cut_in {
            CutIn::Centre => 0,
            CutIn::Trailing => self.height,
            _ => self.limit.saturating_mul(2),
        };
        let u = most.unsigned_abs();
        let out = self
            .run_out
            .as_ref()
            .map_or(0, |out| out.long.unsigned_abs());
        let shift = self.tangent.shift(u);
        let taken = shift.saturating_add(self.run_in).saturating_add(2);
        let travel = self.travel.unsigned_abs();
        if !self.long_x {
            return travel > taken.saturating_add(out);
        }
        let Some(taper) = &self.taper else {
            return false;
        };
        let lost = (after(u, taper.per_depth) >> FINE_BITS) as u64;
        travel > taken && taper.size > lost.saturating_add(out).saturating_add(2)
    }

    /// Distance on the long axis from the pass's start to D.
    pub(crate) fn stroke(&self, corners: &Corners) -> Length {
        let way = if self.long_x {
            let out = self.run_out.as_ref().map_or(0, |out| out.out);
            let end = corners.leave.out.wrapping_sub(out);
            end.wrapping_sub(corners.begin.out)
        } else {
            self.travel.wrapping_sub(corners.begin.along)
        };
        Length::from_nm(way).abs()
    }
}

/// The way of a stroke along its long axis.
pub(crate) fn long_way(call: &ThreadCall) -> Length {
    if is_long_x(call) {
        call.end_x.value - call.start.x
    } else {
        call.end_z.value - call.start.z
    }
}

/// True where X is the long axis.
pub(crate) fn is_long_x(call: &ThreadCall) -> bool {
    if call.cycle.is_stroke() {
        let (x, z) = (
            call.end_x.value - call.start.x,
            call.end_z.value - call.start.z,
        );
        return x.abs() > z.abs();
    }
    (call.end_z.value - call.start.z).abs() <= call.taper.value.abs()
}

impl Leave {
    /// The run-out's figures, for a thread that leans `lean` towards A over its travel.
    fn new(run_out: &RunOut, lean: i64, travel: u64, long_x: bool) -> Self {
        let (short, long) = (run_out.short.value, run_out.long.value);
        let j = run_out.short_rest.behind(short);
        let k = run_out.long_rest.behind(long);
        let width = travel as i64;
        if long_x {
            // |i| ≥ |W| > 0 here.
            let size = lean.unsigned_abs();
            let slide = signed_product(width, k);
            let back = slide.wrapping_add(signed_product(size as i64, j));
            Self {
                out: flip(long.nm(), lean.signum()),
                along: width.wrapping_sub(quotient(slide, size)),
                // Not beyond A.
                end: width.wrapping_sub(quotient(back, size)).max(0),
                long: long.nm(),
            }
        } else {
            let slide = signed_product(lean, k);
            let back = slide.wrapping_add(signed_product(width, j));
            Self {
                out: quotient(slide, travel),
                along: width.wrapping_sub(long.nm()),
                end: quotient(back, travel),
                long: long.nm(),
            }
        }
    }

    /// The figures of a stroke's run-out: it begins K before D on the line, and displaces the short axis from there by J.
    fn of_stroke(run_out: &RunOut, room: i64, travel: i64, long_x: bool) -> Self {
        let long = run_out.long.value.nm();
        let j = run_out.short_rest.behind(run_out.short.value);
        let k = run_out.long_rest.behind(run_out.long.value);
        // From D back to A: `slide` on the short axis over K of the long one.
        let (long_way, short_way) = if long_x {
            (room, travel.wrapping_neg())
        } else {
            (travel.wrapping_neg(), room)
        };
        let size = long_way.unsigned_abs();
        let slide = signed_product(short_way, k);
        let end = slide.wrapping_add(signed_product(size as i64, j));
        let (back, slide, end) = (
            flip(long, long_way.signum()),
            quotient(slide, size),
            quotient(end, size),
        );
        if long_x {
            Self {
                out: back,
                along: travel.wrapping_add(slide),
                end: travel.wrapping_add(end),
                long,
            }
        } else {
            Self {
                out: slide,
                along: travel.wrapping_add(back),
                end,
                long,
            }
        }
    }
}
