//! The board's drives together: brought up, watched, told where to be.
//!
//! Knows positions, scales and the masters of the drives; knows nothing of segments or of why a position is demanded.

use heapless::Vec;

use super::nodes::DriveNodes;
use super::spindles::{Spindle, Spindles};
use crate::alarm::Alarm;
use crate::bus::{
    DriveConfig, DriveFailure, DriveMaster, FollowingLimit, Frame, Increments, Periods, Scale,
    SyncProducer, Told,
};
use crate::bus::{Phase, Service, Setpoints, Step};
use crate::params::Params;
use crate::program::{Position, TapSpindle};
use crate::units::{Angle, Axis, Length};

/// Frames a board sends in one period at most: SYNC, for each of three axes a start and an RPDO1, and for each of two
/// spindles those and an RPDO2.
pub const FRAMES: usize = 16;

/// Drives that a board has at most: of three axes and four spindles.
const DRIVES: usize = 7;

/// Silence is so many statuses missing, one after the other: one that is lost on the wire stops nothing.
const MISSING: u32 = 3;

/// And so many periods at least, where a status comes more often than at every fourth SYNC.
const SILENCE: u32 = 12;

/// A silent spindle in a tap is braked with its axis within this part of a turn from where it was last heard: what it turns
/// in the periods of [`SILENCE`] at 1250 rpm and 1 ms, and a jump of a quarter of the lead at most [D124].
const SPINDLE_REACH: u32 = 4;

/// What the parameters say of the axes' drives, once it is known to be possible.
pub(super) struct Figures {
    /// Of X, Z and C.
    scales: [Scale; 3],
    step: Periods,
    /// After so many without a status a drive is silent.
    silence: Periods,
    /// For how long a following error is tolerated.
    patience: Periods,
    /// From a setpoint of the spindle to its effect at most.
    latency: Periods,
}

impl Figures {
    /// `None` for a tick or a scale of nothing.
    pub(super) fn of(params: &Params) -> Option<Self> {
        let tick_us = params.tick_us();
        let scale = |axis| Scale::new(params.drive_numerator(axis), params.drive_denominator(axis));
        Some(Self {
            scales: [scale(Axis::X)?, scale(Axis::Z)?, scale(Axis::C)?],
            step: Periods::from_ms(params.drive_time_ms(), tick_us)?,
            silence: silence(params),
            patience: Periods::from_ms(params.following_error_ms(), tick_us)?,
            latency: Periods::from_ms(params.latency_us(Axis::Z).div_ceil(1000), tick_us)?,
        })
    }

    #[inline(never)]
    fn axis(&self, params: &Params, axis: Axis, nodes: &DriveNodes, scale: Scale) -> DriveMaster {
        let increments = scale.limit(params.following_error_limit(axis));
        DriveMaster::new(DriveConfig {
            letter: axis.letter(),
            node: nodes.axis(axis),
            scale,
            step: self.step,
            silence: self.silence,
            following: Some(FollowingLimit {
                increments,
                time: self.patience,
                standing: false,
            }),
            reach: increments,
        })
    }
}

/// X, Z, C and the spindles.
#[derive(Debug)]
pub(super) struct Drives {
    axes: [DriveMaster; 3],
    /// What a drive counts more than its axis' position says, in increments: an axis whose reference was lost, and whose
    /// place is known from elsewhere.
    offsets: [i32; 3],
    /// Where each axis was told to be last.
    last: [Told; 3],
    spindles: Spindles,
    sync: SyncProducer,
    nodes: DriveNodes,
    /// All have come up since they were last asked to, and are told where to be. Until then each holds where it is.
    are_up: bool,
    /// What all of them are told in one frame, where the parameters say so; otherwise each has one of its own.
    together: Option<Setpoints>,
}

impl Drives {
    /// Drives that have not been spoken to yet.
    #[inline(never)]
    pub(super) fn new(params: &Params, figures: &Figures) -> Self {
        let [x, z, c] = figures.scales;
        let per_turn = params.spindle_increments();
        let nodes = DriveNodes::of(params);
        let spindle = DriveConfig {
            letter: b'S',
            node: nodes.spindle(TapSpindle::First),
            scale: c,
            step: figures.step,
            silence: figures.silence,
            following: Some(FollowingLimit {
                increments: per_turn / SPINDLE_REACH,
                // Its statuses tell of what it was told some time ago.
                time: figures.patience.plus(figures.latency).plus(figures.silence),
                standing: true,
            }),
            reach: per_turn / SPINDLE_REACH,
        };
        Self {
            axes: [
                figures.axis(params, Axis::X, &nodes, x),
                figures.axis(params, Axis::Z, &nodes, z),
                figures.axis(params, Axis::C, &nodes, c),
            ],
            offsets: [0; 3],
            last: [x.find(0), z.find(0), c.find(0)],
            spindles: Spindles::new(&spindle, params.tap_spindles(), per_turn),
            sync: SyncProducer::new(),
            nodes,
            are_up: false,
            together: (params.setpoint_frame() == 1)
                .then(|| Setpoints::of(params.tap_spindles().saturating_add(3))),
        }
    }

    /// As [`new`](Self::new), but that the places of axes whose reference was lost stay, and the error codes that drives
    /// have told, and that SYNC goes on counting.
    pub(super) fn begin_anew(&mut self, params: &Params, figures: &Figures) {
        let (offsets, sync) = (self.offsets, self.sync);
        // Of each drive, by its node.
        let mut told = [None; DRIVES];
        for (place, drive) in told.iter_mut().zip(self.all()) {
            *place = Some((drive.config().node, drive.error_code()));
        }
        *self = Self::new(params, figures);
        for (node, code) in told.into_iter().flatten() {
            if let Some(drive) = self.all().find(|drive| drive.config().node == node) {
                drive.set_error_code(code);
            }
        }
        self.offsets = offsets;
        self.sync = sync;
    }

    /// The SYNC that the board gives.
    pub(super) const fn sync(&mut self) -> &mut SyncProducer {
        &mut self.sync
    }

    /// Where they are on the bus.
    pub(super) const fn nodes(&self) -> DriveNodes {
        self.nodes
    }

    fn all(&mut self) -> impl Iterator<Item = &mut DriveMaster> {
        self.axes.iter_mut().chain(self.spindles.drives_mut())
    }

    /// A frame from the bus.
    pub(super) fn hear(&mut self, frame: &Frame) {
        // Whose it could be shows in seven bits; the drive itself looks closer.
        let node = (frame.id().get() & 0x7F) as u8;
        let [x, z, c] = &mut self.axes;
        let drive = if node == x.config().node.get() {
            x
        } else if node == z.config().node.get() {
            z
        } else if node == c.config().node.get() {
            c
        } else if let Some(spindle) = self.spindles.of_node(node) {
            spindle
        } else {
            return;
        };
        drive.receive(frame);
    }

    /// Asks every drive for operation enabled; true once all are. A failure stays latched and is told by
    /// [`failure`](Self::failure).
    pub(super) fn enable(&mut self) -> bool {
        self.are_up = if self.together.is_some() {
            self.enable_in_turn()
        } else {
            let mut enabled = true;
            for drive in self.all() {
                enabled &= drive.enable().is_ok() && drive.is_enabled();
            }
            enabled
        };
        self.are_up
    }

    /// The first latched failure.
    pub(super) fn failure(&self) -> Option<Alarm> {
        let failed = self.axes.iter().find(|drive| drive.has_failed());
        match failed {
            Some(drive) => drive.alarm(),
            None => self.spindles.failure(),
        }
    }

    /// Nothing reaches the drives any more: whatever they hear when they can be reached again, it moves none of them.
    #[cold]
    #[inline(never)]
    pub(super) fn cut_off(&mut self) {
        for drive in self.all() {
            drive.disable();
        }
    }

    /// While the machine stops on an alarm, or stands on one (`at_rest`): drives that have
    /// failed lose their torque once all axes stand; until then they are braked with the
    /// others [D62]. Where more than one has fallen silent, the wire is broken: these do not
    /// hear how the others brake, and must not be pulled there when it is whole again [D124].
    #[cold]
    #[inline(never)]
    pub(super) fn let_go(&mut self, at_rest: bool) {
        if !self.all().any(|drive| drive.has_failed()) {
            return;
        }
        // Silent from the first, or since something else failed.
        let silent = |drive: &DriveMaster| {
            drive.failure() == Some(DriveFailure::Silent) || drive.has_failed() && drive.is_silent()
        };
        let many = self.all().filter(|drive| silent(drive)).count() > 1;
        for drive in self.all() {
            if drive.has_failed() && (at_rest || many && silent(drive)) {
                drive.disable();
            }
        }
    }

    /// Forgets failures and resets faults; the drives have to be enabled again.
    pub(super) fn reset(&mut self) {
        self.are_up = false;
        for drive in self.all() {
            drive.reset();
        }
    }

    /// Where the machine is: `remembered` to the nanometre if the drives agree with it to their increment, else what
    /// they say.
    pub(super) fn position(&self, remembered: Option<Position>) -> Position {
        let demands = remembered.map(|remembered| self.demands(figures(remembered)));
        if let (Some(remembered), Some(demands)) = (remembered, &demands) {
            let mut drives = self.axes.iter().zip(demands);
            if drives.all(|(drive, demand)| *demand == Some(drive.target())) {
                return remembered;
            }
        }
        let mut read = [0; 3];
        for ((drive, offset), read) in self.axes.iter().zip(self.offsets).zip(&mut read) {
            let own = drive.target().get().wrapping_sub(offset);
            *read = drive.config().scale.position(Increments::new(own));
        }
        match (remembered, demands) {
            // Where increments are finer than nanometres.
            (Some(remembered), Some(demands)) if demands == self.demands(read) => remembered,
            _ => {
                let [x, z, c] = read;
                Position {
                    x: Length::from_nm(x),
                    z: Length::from_nm(z),
                    c: Angle::from_udeg(c),
                }
            }
        }
    }

    /// What each axis' drive would be told for a place ([`figures`]).
    #[inline(never)]
    fn demands(&self, places: [i64; 3]) -> [Option<Increments>; 3] {
        let mut demands = [None; 3];
        let drives = self.axes.iter().zip(self.offsets);
        for ((drive, offset), (demand, place)) in drives.zip(demands.iter_mut().zip(places)) {
            *demand = told(drive.config().scale.increments(place), offset);
        }
        demands
    }

    /// The spindles.
    pub(super) const fn spindles(&mut self) -> &mut Spindles {
        &mut self.spindles
    }

    /// From now on the machine stands at `to`, and not at `from` as its drives say: the references of the axes that differ
    /// were lost. False, and nothing changes, where a drive cannot count that far.
    pub(super) fn place(&mut self, from: Position, to: Position) -> bool {
        let mut offsets = self.offsets;
        let demands = (self.demands(figures(from)), self.demands(figures(to)));
        for (offset, (from, to)) in offsets.iter_mut().zip(demands.0.iter().zip(&demands.1)) {
            let (Some(there), Some(here)) = (from, to) else {
                return false;
            };
            *offset = offset.wrapping_add(there.get().wrapping_sub(here.get()));
        }
        self.offsets = offsets;
        true
    }

    /// The drives' own positions count again. True where they did not.
    pub(super) fn forget_places(&mut self) -> bool {
        core::mem::take(&mut self.offsets) != [0; 3]
    }

    /// The frames of a period: SYNC, then what each drive is told. An axis whose
    /// position its drive cannot count comes back; its drive is held where it is. So are all until they have come
    /// up: a drive that is enabled before the others stands where it stands, and nobody demands anything of it yet.
    pub(super) fn send(
        &mut self,
        position: Position,
        spindle: Spindle,
        frames: &mut Vec<Frame, FRAMES>,
    ) -> Option<Axis> {
        // FRAMES is more than one SYNC, two frames for each of three axes and three
        // for each of two spindles: there is room.
        let mut put = |frame: Frame| {
            let _ = frames.push(frame);
        };
        put(self.sync.next());
        let mut beyond = None;
        if self.are_up {
            let [x, z, c] = &mut self.axes;
            let [off_x, off_z, off_c] = self.offsets;
            let [last_x, last_z, last_c] = &mut self.last;
            // One after another: a loop over so much side by side costs as much as what it does.
            if !send_to(x, off_x, last_x, position.x.nm(), &mut put) {
                beyond = Some(Axis::X);
            }
            if !send_to(z, off_z, last_z, position.z.nm(), &mut put) {
                beyond = Some(Axis::Z);
            }
            if !send_to(c, off_c, last_c, position.c.udeg(), &mut put) {
                beyond = Some(Axis::C);
            }
        } else {
            for drive in &mut self.axes {
                drive.tick_slowly(None).each(&mut put);
            }
        }
        self.spindles.tick(spindle, &mut put);
        if self.together.is_some() {
            self.put_together(frames);
        }
        beyond
    }
}

impl Drives {
    /// What all drives are told in this period, where that is one frame.
    pub(super) const fn together(&self) -> Option<&Setpoints> {
        self.together.as_ref()
    }

    /// As [`enable`](Self::enable), one behind the other. In a frame for all a drive finds its
    /// setpoint by its place, and what it says is known by its node: one that listens at
    /// another's place shows by what it says only while nobody else is on the way. Two on the
    /// way at once would each take the other's steps for its own, and then go where that one is.
    fn enable_in_turn(&mut self) -> bool {
        let mut drives = self.axes.iter_mut().chain(self.spindles.drives_mut());
        let Some(first) = drives.find(|drive| !drive.is_enabled()) else {
            return true;
        };
        // A failure stays latched.
        let _ = first.enable();
        let goes = first.phase() == Phase::Step(Step::EnableOperation);
        let mut alone = true;
        for waiting in drives {
            alone &= waiting.wait(goes);
        }
        if !alone {
            first.disable();
        }
        false
    }

    /// Takes the commands out of the frames of a period and puts them together; everything else stays a frame of its own. A
    /// spindle whose turn it is not in this period is told what it was told last.
    // Behind the sending of the frames, and not another way of it: the compiler
    // would have each of them twice, and the usual one would be the slower for it.
    #[inline(never)]
    fn put_together(&mut self, frames: &mut Vec<Frame, FRAMES>) {
        let Some(together) = &mut self.together else {
            return;
        };
        frames.retain(|frame| {
            let Some((Service::Rpdo1, node)) = frame.id().service() else {
                return true;
            };
            if let Some(place) = self.nodes.place(node) {
                together.tell(place, frame);
            }
            false
        });
        let all = self.axes.iter().chain(self.spindles.drives());
        for (place, drive) in all.enumerate() {
            if drive.is_told_nothing() {
                together.withdraw(place);
            }
        }
    }
}

/// What one axis is told; false where its drive cannot count so far.
// Three calls would cost each tick 36 instructions.
#[inline(always)]
fn send_to(
    drive: &mut DriveMaster,
    offset: i32,
    last: &mut Told,
    position: i64,
    put: &mut impl FnMut(Frame),
) -> bool {
    let demand = told(drive.config().scale.follow(last, position), offset);
    match drive.follow_on(demand) {
        Some(command) => put(command),
        None => drive.tick_slowly(demand).each(put),
    }
    demand.is_some()
}

/// After so many periods without a status a drive is silent, where it sends one at every so many SYNCs (9021) [D180].
fn silence(params: &Params) -> Periods {
    let missing = params.drive_status_syncs().saturating_mul(MISSING);
    Periods::new(missing.max(SILENCE))
}

/// A position as its drives count it, in the order X, Z, C: nanometres, and for C millionths of a degree.
const fn figures(position: Position) -> [i64; 3] {
    [position.x.nm(), position.z.nm(), position.c.udeg()]
}

/// What a drive is told for increments of its own axis.
fn told(own: Option<Increments>, offset: i32) -> Option<Increments> {
    own?.get().checked_add(offset).map(Increments::new)
}
