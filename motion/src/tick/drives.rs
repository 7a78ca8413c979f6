//! All drives of the board: enables them, supervises them and sends them their targets.
//!
//! Knows positions, scales and the masters of the drives; knows nothing of segments or of the reason for a position.

mod home;

pub(super) use home::Homing;
use home::Mark;

use heapless::Vec;

use super::backlash::Backlash;
use super::gear::Gears;
use super::lag::{Lag, Lags};
use super::nodes::DriveNodes;
use super::pitch::Pitch;
use super::spindles::{Spindle, Spindles};
use crate::alarm::Alarm;
use crate::bus::{
    DriveConfig, DriveFailure, DriveMaster, FollowingLimit, Frame, Increments, Mode, Periods,
    Scale, SyncProducer, Told,
};
use crate::bus::{Phase, Service, Setpoints, Step};
use crate::call::{Position, TapSpindle};
use crate::params::{Params, TakeUpShape};
use crate::units::{Angle, Axes, Axis, Length};

/// The most frames that a board sends in one period: SYNC, and a start, an RPDO1 and an RPDO2 for each of three axes and
/// two spindles.
pub const FRAMES: usize = 16;

/// The most drives of a board: three axes and four spindles.
const DRIVES: usize = 7;

/// A drive is silent after this many missing statuses in a row: one status that is lost on the wire stops nothing.
const MISSING: u32 = 3;

/// A drive is silent after this many periods at least, also where its status comes more often than at every fourth SYNC.
const SILENCE: u32 = 12;

/// A silent spindle in a tap is braked with its axis within this part of a turn from its last known angle. This covers its
/// turn in the periods of [`SILENCE`] at 1250 rpm and 1 ms, and limits a jump to a quarter of the lead [D124].
const SPINDLE_REACH: u32 = 4;

/// What the drives need of a parameter set, checked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Figures {
    axes: [DriveConfig; 3],
    /// Of the first spindle; the others are like it, with consecutive nodes.
    spindle: DriveConfig,
    /// Increments that the drives of the axes count in addition to the position, where they have homed.
    homed: [i32; 3],
    marks: [Mark; 3],
    /// Number of spindles, 1–4.
    spindles: u8,
    /// Increments of a spindle's drive in a turn.
    per_turn: u32,
    nodes: DriveNodes,
    /// All drives get their targets in one frame.
    together: bool,
    /// What is taken off the lag of the axes.
    lags: [Option<Lag>; 3],
    /// The backlash of X and Z.
    shapes: [TakeUpShape; 2],
    pitch: Pitch,
    spindle_lag: Option<Lag>,
}

impl Figures {
    /// `None` for a tick or a scale of zero.
    pub(super) fn of(params: &Params) -> Option<Self> {
        let tick_us = params.tick_us();
        let nodes = DriveNodes::of(params);
        let step = Periods::from_ms(params.drive_time_ms(), tick_us)?;
        let silence = silence(params);
        // The longest time for which a following error is tolerated.
        let patience = Periods::from_ms(params.following_error_ms(), tick_us)?;
        // The longest time from a setpoint of the spindle to its effect.
        let latency = Periods::from_ms(params.latency_us(Axis::Z).div_ceil(1000), tick_us)?;
        let per_turn = params.spindle_increments();
        let reach = Gears::of(params).most_per_turn(per_turn) / SPINDLE_REACH;
        let axis = |axis| axis_config(params, axis, &nodes, step, silence, patience);
        let axes = [axis(Axis::X)?, axis(Axis::Z)?, axis(Axis::C)?];
        let [.., c] = &axes;
        let spindle = DriveConfig {
            letter: b'S',
            node: nodes.spindle(TapSpindle::First),
            following: Some(FollowingLimit {
                increments: reach,
                // The spindle's statuses answer targets of some time ago.
                time: patience.plus(latency).plus(silence),
                standing: true,
            }),
            reach,
            homes: None,
            mode: Mode::Position,
            ..*c
        };
        let pitch = Pitch::of(params);
        let homed = |axis, config: &DriveConfig| home::offset(params, axis, &config.scale, &pitch);
        let [x, z, c] = &axes;
        let homed = [homed(Axis::X, x), homed(Axis::Z, z), homed(Axis::C, c)];
        Some(Self {
            axes,
            spindle,
            homed,
            marks: Axis::ALL.map(|axis| Mark::of(params, axis)),
            spindles: params.tap_spindles(),
            per_turn,
            nodes,
            together: params.setpoint_frame() == 1,
            lags: Axis::ALL.map(|axis| Lag::of_axis(params, axis)),
            shapes: [Axis::X, Axis::Z].map(|axis| TakeUpShape::of(params, axis)),
            pitch,
            spindle_lag: Lag::of_spindle(params),
        })
    }
}

/// `None` for a scale of zero.
#[inline(never)]
fn axis_config(
    params: &Params,
    axis: Axis,
    nodes: &DriveNodes,
    step: Periods,
    silence: Periods,
    patience: Periods,
) -> Option<DriveConfig> {
    let scale = Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))?;
    let increments = scale.limit(params.following_error_limit(axis));
    Some(DriveConfig {
        letter: axis.letter(),
        node: nodes.axis(axis),
        scale,
        step,
        silence,
        following: Some(FollowingLimit {
            increments,
            time: patience,
            standing: false,
        }),
        reach: increments,
        homes: home::limits(params, axis, &scale),
        mode: Mode::of_setpoints(params.drive_mode(axis)),
    })
}

/// X, Z, C and the spindles.
#[derive(Debug)]
pub(super) struct Drives {
    axes: [DriveMaster; 3],
    /// Increments that a drive counts in addition to its axis' position: because zero of its count is the mark of its
    /// homing, or because its reference was lost and the position is known from elsewhere.
    offsets: [i32; 3],
    /// The same, where the drives' own positions count.
    homed: [i32; 3],
    marks: [Mark; 3],
    /// The last target of each axis.
    last: [Told; 3],
    /// What is put in at reversals, where an axis has backlash.
    backlash: Option<Backlash>,
    /// The errors of the screws' pitch.
    pitch: Pitch,
    /// What makes the axes follow their setpoints, where the lag of a drive is known.
    lags: Option<Lags>,
    spindles: Spindles,
    sync: SyncProducer,
    nodes: DriveNodes,
    /// True once all drives have come up since they were last asked to. From then on they get targets; until then each
    /// drive holds its position.
    are_up: bool,
    /// The targets of all drives in one frame, where the parameters ask for it; otherwise each drive has a frame of its
    /// own.
    together: Option<Setpoints>,
}

impl Drives {
    /// Drives that have received no frame yet.
    #[inline(never)]
    pub(super) fn new(figures: &Figures) -> Self {
        let [x, z, c] = figures.axes;
        Self {
            axes: figures.axes.each_ref().map(master),
            offsets: figures.homed,
            homed: figures.homed,
            marks: figures.marks,
            last: [x.scale.find(0), z.scale.find(0), c.scale.find(0)],
            backlash: Backlash::of(figures.shapes, None),
            pitch: figures.pitch,
            lags: Lags::of(figures.lags),
            spindles: Spindles::new(
                &figures.spindle,
                figures.spindles,
                figures.per_turn,
                figures.spindle_lag,
            ),
            sync: SyncProducer::new(),
            nodes: figures.nodes,
            are_up: false,
            together: figures
                .together
                .then(|| Setpoints::of(figures.spindles.saturating_add(3))),
        }
    }

    /// As [`new`](Self::new), with three exceptions: the positions of axes whose drives count as before stay, the error
    /// codes of the drives stay, and SYNC goes on counting. Gives the axes whose drives count otherwise.
    pub(super) fn begin_anew(&mut self, figures: &Figures) -> Axes {
        let changed = home::changed(self, figures);
        let lost = self.axes.each_ref().map(DriveMaster::has_lost);
        let (offsets, homed, sync) = (self.offsets, self.homed, self.sync);
        let backlash = Backlash::of(figures.shapes, self.backlash);
        // Error codes by node number.
        let mut told = [None; DRIVES];
        for (place, drive) in told.iter_mut().zip(self.all()) {
            *place = Some((drive.config().node, drive.error_code()));
        }
        *self = Self::new(figures);
        for (node, code) in told.into_iter().flatten() {
            if let Some(drive) = self.all().find(|drive| drive.config().node == node) {
                drive.set_error_code(code);
            }
        }
        for (drive, lost) in self.axes.iter_mut().zip(lost) {
            drive.set_lost(lost);
        }
        for axis in Axis::ALL
            .into_iter()
            .filter(|axis| !changed.contains(*axis))
        {
            home::copy(&mut self.offsets, &offsets, axis);
            home::copy(&mut self.homed, &homed, axis);
        }
        (self.sync, self.backlash) = (sync, backlash);
        changed
    }

    /// The drives' node numbers.
    pub(super) const fn nodes(&self) -> DriveNodes {
        self.nodes
    }

    fn all(&mut self) -> impl Iterator<Item = &mut DriveMaster> {
        self.axes.iter_mut().chain(self.spindles.drives_mut())
    }

    /// Takes a frame from the bus.
    pub(super) fn hear(&mut self, frame: &Frame) {
        // Seven bits tell which drive it may concern; the drive's master looks closer.
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

    /// Asks every drive for operation enabled. True once all are enabled. A failure stays latched;
    /// [`failure`](Self::failure) returns it.
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

    /// The drives cannot be reached any more. When they can be reached again, no frame may move them.
    #[cold]
    #[inline(never)]
    pub(super) fn cut_off(&mut self) {
        for drive in self.all() {
            drive.disable();
        }
    }

    /// Acts while the machine stops on an alarm, or stands on it (`at_rest`). A failed drive is braked with the others and
    /// loses its torque once all axes stand [D62]. If more than one drive is silent, the wire is broken: silent drives do
    /// not hear how the others brake, and must not be pulled there when the wire is whole again [D124].
    #[cold]
    #[inline(never)]
    pub(super) fn let_go(&mut self, at_rest: bool) {
        if !self.all().any(|drive| drive.has_failed()) {
            return;
        }
        // The drive was silent first, or became silent after another failure.
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

    /// Clears failures and resets faults. The drives must be enabled again.
    pub(super) fn reset(&mut self) {
        self.are_up = false;
        for drive in self.all() {
            drive.reset();
        }
    }

    /// What has been put in at reversals, in nanometres, for X, Z and C.
    fn put_in(&self) -> [i64; 3] {
        self.backlash.as_ref().map_or([0; 3], Backlash::put_in)
    }

    /// The machine's position: `remembered` to the nanometre if the drives agree with it to their increment, otherwise the
    /// drives' position.
    pub(super) fn position(&self, remembered: Option<Position>) -> Position {
        let demands = remembered.map(|remembered| self.demands(figures(remembered)));
        if let (Some(remembered), Some(demands)) = (remembered, &demands) {
            let mut drives = self.axes.iter().zip(demands);
            if drives.all(|(drive, demand)| *demand == Some(drive.target())) {
                return remembered;
            }
        }
        let mut read = [0; 3];
        for (axis, read) in Axis::ALL.into_iter().zip(&mut read) {
            *read = self.read_place(axis);
        }
        match (remembered, demands) {
            // For increments finer than a nanometre.
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

    /// The target of each axis' drive for a position ([`figures`]).
    // Places of the slides: their drives are told what the backlash and the errors of the pitch make of them.
    #[inline(never)]
    fn demands(&self, places: [i64; 3]) -> [Option<Increments>; 3] {
        let mut demands = [None; 3];
        let drives = self.axes.iter().zip(self.offsets);
        let errors = self.pitch.errors(places);
        let places = places.into_iter().zip(errors).zip(self.put_in());
        for ((drive, offset), (demand, ((place, error), put_in))) in
            drives.zip(demands.iter_mut().zip(places))
        {
            let place = place.wrapping_add(put_in).wrapping_sub(error);
            *demand = told(drive.config().scale.increments(place), offset);
        }
        demands
    }

    /// The position of the drive of X or Z, without what it counts in addition, if a status came for this tick; and how
    /// much of it is not the slide's, for backlash and errors of the pitch, in nanometres. Call this after
    /// [`send`](Self::send).
    pub(super) fn has_told(&self, on_x: bool) -> Option<(Increments, i64)> {
        let [x, z, _] = &self.axes;
        let [off_x, off_z, _] = self.offsets;
        let [last_x, last_z, _] = &self.last;
        let (drive, offset, last, axis) = if on_x {
            (x, off_x, last_x, Axis::X)
        } else {
            (z, off_z, last_z, Axis::Z)
        };
        let actual = drive.fresh()?;
        let actual = Increments::new(actual.get().wrapping_sub(offset));
        let [in_x, in_z, _] = self.put_in();
        let put_in = if on_x { in_x } else { in_z };
        let Some(curve) = self.pitch.curve(axis) else {
            return Some((actual, put_in));
        };
        let drive = drive.config().scale.near(last, actual);
        let at = drive.wrapping_sub(put_in);
        Some((actual, drive.wrapping_sub(curve.place(at))))
    }

    /// The spindles.
    pub(super) const fn spindles(&mut self) -> &mut Spindles {
        &mut self.spindles
    }

    /// Declares that the machine stands at `to`, although its drives say `from`: the references of the axes that differ
    /// were lost. Returns false and changes nothing where a drive cannot count that far. Whoever calls this says
    /// where the axes [rest](Self::rest_at).
    pub(super) fn place(&mut self, from: Position, to: Position) -> bool {
        self.place_at(self.demands(figures(from)), to)
    }

    /// As [`place`](Self::place); `there`: what the drives count where the machine stands.
    fn place_at(&mut self, there: [Option<Increments>; 3], to: Position) -> bool {
        let mut offsets = self.offsets;
        let here = self.demands(figures(to));
        for (offset, (from, to)) in offsets.iter_mut().zip(there.iter().zip(&here)) {
            let (Some(there), Some(here)) = (from, to) else {
                return false;
            };
            *offset = offset.wrapping_add(there.get().wrapping_sub(here.get()));
        }
        self.offsets = offsets;
        true
    }

    /// The axes rest here, whatever they were told before: what is made up for begins anew.
    pub(super) fn rest_at(&mut self, position: Position) {
        for (axis, place) in Axis::ALL.into_iter().zip(figures(position)) {
            self.rest_axis(axis, place);
        }
    }

    /// The same of one axis.
    fn rest_axis(&mut self, axis: Axis, place: i64) {
        let backlash = self.backlash.as_mut();
        let put_in = backlash.map_or(0, |backlash| backlash.rest(axis, place));
        if let Some(lags) = &mut self.lags {
            let error = self.pitch.error(axis, place);
            lags.rest(axis, place.wrapping_add(put_in).wrapping_sub(error));
        }
    }

    /// The drives' own positions count again. True where they did not count before.
    pub(super) fn forget_places(&mut self) -> bool {
        core::mem::replace(&mut self.offsets, self.homed) != self.homed
    }

    /// Makes the frames of a period: SYNC, then the target of each drive. Returns an axis whose position its drive cannot
    /// count; this drive holds its position. Until all drives have come up, every drive holds its position: a drive that is
    /// enabled before the others gets no demand yet.
    pub(super) fn send(
        &mut self,
        position: Position,
        spindle: Spindle,
        frames: &mut Vec<Frame, FRAMES>,
    ) -> Option<Axis> {
        // FRAMES is one SYNC and three frames for each of three axes and two spindles, so there is room.
        let mut put = |frame: Frame| {
            let _ = frames.push(frame);
        };
        put(self.sync.next());
        let mut beyond = None;
        if self.are_up {
            let [x, z, c] = &mut self.axes;
            let [off_x, off_z, off_c] = self.offsets;
            let [last_x, last_z, last_c] = &mut self.last;
            let mut targets = figures(position);
            let has_pitch = !self.pitch.is_empty();
            if self.backlash.is_some() || self.lags.is_some() || has_pitch {
                let follow = [&*x, &*z, &*c].map(DriveMaster::is_following);
                let places = targets;
                if let Some(backlash) = &mut self.backlash {
                    targets = backlash.places(targets, follow);
                }
                if has_pitch {
                    let errors = self.pitch.errors(places);
                    for (target, error) in targets.iter_mut().zip(errors) {
                        *target = target.wrapping_sub(error);
                    }
                }
                if let Some(lags) = &mut self.lags {
                    targets = lags.targets(targets, follow);
                }
            }
            let [to_x, to_z, to_c] = targets;
            // Three calls in a row: a loop over these four lists costs as much as the calls themselves.
            if !send_to(x, off_x, last_x, to_x, &mut put) {
                beyond = Some(Axis::X);
            }
            if !send_to(z, off_z, last_z, to_z, &mut put) {
                beyond = Some(Axis::Z);
            }
            if !send_to(c, off_c, last_c, to_c, &mut put) {
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
    /// The targets of all drives in this period, where they travel in one frame.
    pub(super) const fn together(&self) -> Option<&Setpoints> {
        self.together.as_ref()
    }

    /// As [`enable`](Self::enable), but one drive after the other. In a common frame, a drive finds its setpoint by its
    /// place, while its answers are known by its node. A drive that listens at the place of another drive shows this by its
    /// answers only while no other drive is being enabled. Two drives that are enabled at the same time would each follow
    /// the steps of the other, and then its positions.
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

    /// Moves the commands from the frames of a period into the common frame. All other frames stay as they are. A spindle
    /// that gets no command in this period gets its last one again.
    // A step after the sending, not a variant of it: the compiler would make two copies of the sending, and the usual copy
    // would be slower.
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

/// Sends the target of one axis. False where its drive cannot count that far.
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

/// A drive is silent after so many periods without a status; it sends a status at every n-th SYNC (9021) [D180].
fn silence(params: &Params) -> Periods {
    let missing = params.drive_status_syncs().saturating_mul(MISSING);
    Periods::new(missing.max(SILENCE))
}

/// A position in the units of its drives, in the order X, Z, C: nanometres, and for C millionths of a degree.
const fn figures(position: Position) -> [i64; 3] {
    [position.x.nm(), position.z.nm(), position.c.udeg()]
}

/// A position with another place of one axis, in the unit of its drive.
const fn with(axis: Axis, at: Position, place: i64) -> Position {
    match axis {
        Axis::X => Position {
            x: Length::from_nm(place),
            ..at
        },
        Axis::Z => Position {
            z: Length::from_nm(place),
            ..at
        },
        Axis::C => Position {
            c: Angle::from_udeg(place),
            ..at
        },
    }
}

/// A master that has sent nothing to its drive yet.
#[inline(never)]
fn master(config: &DriveConfig) -> DriveMaster {
    DriveMaster::new(*config)
}

/// The target of a drive for increments of its axis.
fn told(own: Option<Increments>, offset: i32) -> Option<Increments> {
    own?.get().checked_add(offset).map(Increments::new)
}
