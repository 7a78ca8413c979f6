//! The references of the axes at their drives: homing, and what a drive's count means.
//!
//! An axis stands at what its drive counts, less an offset. For an axis whose drive homes, zero of that count is the mark,
//! so the offset is known beforehand: `machine = position of the mark + 6064h` [D296].

use super::{Drives, Pitch};
use crate::bus::{DriveMaster, HomeEnd, HomeLimits, Increments, Inputs, Periods, Scale};
use crate::call::Position;
use crate::params::{BY_DRIVE, Params};
use crate::units::{Axes, Axis, Length};

/// Time for which the result of an earlier homing may stand in a drive's statusword, in milliseconds.
const STALE_MS: u32 = 100;

/// What a homing of an axis has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::tick) enum Homing {
    /// Not under way.
    None,
    /// Under way, or on the way back; the result, as soon as it is known.
    UnderWay(Option<HomeEnd>),
    /// Found, and the drive is back in position mode.
    Found,
    /// Ended otherwise, and the drive is back in position mode, or has failed.
    Failed(HomeEnd),
}

/// What the drive of an axis is allowed in homing; `None` where it does not home by itself, or for a tick of zero.
pub(super) fn limits(params: &Params, axis: Axis, scale: &Scale) -> Option<HomeLimits> {
    if params.home_method(axis) != BY_DRIVE {
        return None;
    }
    let tick_us = params.tick_us();
    Some(HomeLimits {
        time: Periods::from_ms(params.home_time_ms(axis), tick_us)?,
        travel: scale.limit(params.home_travel(axis)),
        stale: Periods::from_ms(STALE_MS, tick_us)?,
    })
}

/// How the count of an axis' drive becomes the axis' place: 9050, and the place of the mark (9058).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mark {
    method: u8,
    place: i64,
}

impl Mark {
    pub(super) fn of(params: &Params, axis: Axis) -> Self {
        Self {
            method: params.home_method(axis),
            place: params.home_position(axis),
        }
    }
}

/// The increments that the drive of an axis counts in addition to its position after homing. A position of the mark that
/// the drive cannot count is refused by the checks of a parameter set.
pub(super) fn offset(params: &Params, axis: Axis, scale: &Scale, pitch: &Pitch) -> i32 {
    if params.home_method(axis) != BY_DRIVE {
        return 0;
    }
    let mark = params.home_position(axis);
    let mark = scale.increments(mark.wrapping_sub(pitch.error(axis, mark)));
    mark.map_or(0, |mark| mark.get().wrapping_neg())
}

impl Drives {
    const fn axis(&self, axis: Axis) -> &DriveMaster {
        of(&self.axes, axis)
    }

    const fn axis_mut(&mut self, axis: Axis) -> &mut DriveMaster {
        of_mut(&mut self.axes, axis)
    }

    /// Begins to home an axis that stands. False where its drive cannot.
    pub(in crate::tick) const fn begin_homing(&mut self, axis: Axis) -> bool {
        self.axis_mut(axis).begin_homing()
    }

    /// Ends homing as soon as the drive stands.
    pub(in crate::tick) fn abandon_homing(&mut self, axis: Axis) {
        self.axis_mut(axis).abandon_homing();
    }

    /// Feed hold in homing, or its end.
    pub(in crate::tick) fn halt_homing(&mut self, axis: Axis, halted: bool) {
        self.axis_mut(axis).halt_homing(halted);
    }

    /// What the homing of an axis has come to.
    pub(in crate::tick) const fn homing(&self, axis: Axis) -> Homing {
        let drive = self.axis(axis);
        match (drive.is_homing(), drive.home_end()) {
            (true, end) => Homing::UnderWay(end),
            (false, None) => Homing::None,
            (false, Some(HomeEnd::Found)) if drive.is_enabled() => Homing::Found,
            (false, Some(end)) => Homing::Failed(end),
        }
    }

    /// The count of an axis' drive says from now on where the axis is. Gives the machine's position with that.
    pub(in crate::tick) fn refer(&mut self, axis: Axis, at: Position) -> Position {
        *of_mut(&mut self.offsets, axis) = *of(&self.homed, axis);
        if let Some(backlash) = &mut self.backlash {
            backlash.refer(axis);
        }
        self.read(axis, at)
    }

    /// The machine's position where the drive of this axis says where the axis is.
    pub(in crate::tick) fn read(&self, axis: Axis, at: Position) -> Position {
        super::with(axis, at, self.read_place(axis))
    }

    /// Where the drive of an axis says that the axis is, in its unit.
    pub(super) fn read_place(&self, axis: Axis) -> i64 {
        let drive = self.axis(axis);
        let offset = *of(&self.offsets, axis);
        let own = drive.target().get().wrapping_sub(offset);
        let place = drive.config().scale.position(Increments::new(own));
        let drive = place.wrapping_sub(*of(&self.put_in(), axis));
        self.pitch.place(axis, drive)
    }

    /// The mark of an axis was passed at `seen`, by what counted before; the machine stands at `at`. Gives its position by
    /// the mark's own place. `None` where the drive cannot count that far.
    pub(in crate::tick) fn refer_to_mark(
        &mut self,
        axis: Axis,
        at: Position,
        seen: Length,
    ) -> Option<Position> {
        let [x, z, _] = super::figures(at);
        let here = if axis == Axis::X { x } else { z };
        let mark = of(&self.marks, axis).place;
        // The way beyond the mark is one of the drive: the errors of the pitch were those of another place before.
        let drive = |place: i64| place.wrapping_sub(self.pitch.error(axis, place));
        let way = drive(here).wrapping_sub(drive(seen.nm()));
        let place = self.pitch.place(axis, drive(mark).wrapping_add(way));
        let to = super::with(axis, at, place);
        let (there, before) = (self.demands(super::figures(at)), self.backlash);
        if let Some(backlash) = &mut self.backlash {
            backlash.refer(axis);
        }
        if !self.place_at(there, to) {
            self.backlash = before;
            return None;
        }
        *of_mut(&mut self.homed, axis) = *of(&self.offsets, axis);
        self.rest_axis(axis, place);
        Some(to)
    }

    /// Nothing counts that the drive of an axis has told of its inputs before.
    pub(in crate::tick) const fn forget_inputs(&mut self, axis: Axis) {
        self.axis_mut(axis).forget_inputs();
    }

    /// What the drive of an axis says of its inputs; once in every tick.
    pub(in crate::tick) const fn look_at_inputs(&mut self, axis: Axis) -> Inputs {
        self.axis_mut(axis).look_at_inputs()
    }

    /// What the drive of an axis has told of its inputs last.
    pub(in crate::tick) const fn inputs_told(&self, axis: Axis) -> Inputs {
        self.axis(axis).inputs_told()
    }

    /// Where X or Z is, by a status of its drive that came for the last tick.
    pub(in crate::tick) fn place_told(&self, axis: Axis) -> Option<Length> {
        let (actual, put_in) = self.has_told(axis == Axis::X)?;
        let scale = self.axis(axis).config().scale;
        Some(Length::from_nm(scale.position(actual).wrapping_sub(put_in)))
    }

    /// The axes whose drives have lost their count since the last call: they have been switched on, or their encoder has
    /// failed.
    #[cold]
    #[inline(never)]
    pub(in crate::tick) fn take_lost(&mut self) -> Axes {
        let mut lost = Axes::NONE;
        for (axis, drive) in Axis::ALL.into_iter().zip(&mut self.axes) {
            if drive.takes_lost() {
                lost = lost.with(axis);
            }
        }
        lost
    }
}

/// What belongs to an axis, of X, Z and C.
const fn of<T>([x, z, c]: &[T; 3], axis: Axis) -> &T {
    match axis {
        Axis::X => x,
        Axis::Z => z,
        Axis::C => c,
    }
}

/// As [`of`].
const fn of_mut<T>([x, z, c]: &mut [T; 3], axis: Axis) -> &mut T {
    match axis {
        Axis::X => x,
        Axis::Z => z,
        Axis::C => c,
    }
}

/// Takes over what belongs to an axis.
pub(super) const fn copy(to: &mut [i32; 3], from: &[i32; 3], axis: Axis) {
    *of_mut(to, axis) = *of(from, axis);
}

/// The axes whose drives count otherwise, by units, mark or errors of the pitch, with the second set of figures than
/// with the first.
pub(super) fn changed(before: &Drives, after: &super::Figures) -> Axes {
    let mut changed = Axes::NONE;
    let drives = before.axes.iter().zip(&after.axes);
    let marks = before.marks.iter().zip(&after.marks);
    let curves = Axis::ALL.map(|axis| before.pitch.curve(axis) == after.pitch.curve(axis));
    for ((axis, as_before), ((drive, config), (old, new))) in
        Axis::ALL.into_iter().zip(curves).zip(drives.zip(marks))
    {
        let own = drive.config();
        let same = own.scale == config.scale && own.node == config.node && old == new && as_before;
        if !same {
            changed = changed.with(axis);
        }
    }
    changed
}
