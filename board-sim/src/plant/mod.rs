//! The plant around the board: the spindle with its encoder, and the drives on the bus.
//!
//! Time goes by in SYNC periods. Each period has two calls. [`Plant::advance`] lets the time up to a SYNC pass and
//! samples the board's encoder inputs; the first sample is time 0. [`Plant::exchange`] then takes the frames that the
//! board sends. At the SYNC among them the drives latch the RPDOs before it, move and answer; an RPDO after it waits
//! for the next SYNC. So a setpoint computed from the sample of one SYNC takes effect at the next SYNC, whether the
//! board sends it before that SYNC or right after its own:
//!
//! ```text
//! advance: time of SYNC(k), sample(k) ─► the board ─► exchange: SYNC(k) latches RPDO(k−1), answers; RPDO(k) waits
//! ```
//!
//! The spindle turns as its drive (RPDO2) commands. Its encoder is wired to the board, not to the bus. In position mode
//! the drive moves evenly during the time up to a SYNC, and reaches the target latched there. Its increments are zero
//! at the index, and its latency is that of Z's drive. Spindles 2 to 4 only tap ([`Tapper`]); parameter 9014 gives
//! their number. The truth is for tests that judge the board; the board itself must not see it.

#![deny(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_arithmetic
)]
#![cfg_attr(test, allow(clippy::arithmetic_side_effects, clippy::float_arithmetic))]

mod block;
mod dictionary;
mod drive;
mod encoder;
mod flash;
mod follower;
mod homing;
mod numbers;
mod power;
mod servo;
mod sine;
mod spindle;
mod tapper;
#[cfg(test)]
mod tests;

pub use block::{BlockFault, BlockOptions, IoBlock};
pub use drive::{Drive, DriveOptions, Trouble};
pub use encoder::Encoder;
pub use flash::{Flash, FlashError, ImageError, Order, Tear};
pub use follower::Follower;
pub use homing::HomingOptions;
pub use power::Power;
pub use servo::{Following, Interpolation, Late, ScrewErrors, Servo, ServoOptions};
pub use spindle::{FineTurns, Piece, Ripple, Spindle};
pub use tapper::Tapper;

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{
    CobId, FdFrame, Frame, Increments, MilliRpm, Mode, NmtCommand, NodeId, Scale, Service, is_sync,
};
use leadscrew_core::call::{Position, TapSpindle};
use leadscrew_core::params::{BY_DRIVE, Gear, Params};
use leadscrew_core::spindle::EncoderSample;
use leadscrew_core::units::{Axis, Length, Turns};

/// The start and the behaviour of the plant, in addition to the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlantOptions {
    /// The positions of the axes at power-up, in machine coordinates.
    pub at: Position,
    /// The spindle's angle at power-up, measured from its index.
    pub angle: Turns,
    /// The encoder's counter at angle 0.
    pub counter: i32,
    /// Ripple of the spindle's speed.
    pub ripple: Option<Ripple>,
    /// Time that the spindle takes for each 1000 rpm, in ms, where it is not what 9004 says.
    pub ramp_ms: Option<u32>,
    /// The options of all drives.
    pub drives: DriveOptions,
    /// The drives of X and Z as they are; `None` for ideal ones, which are where they are told.
    pub servos: [Option<ServoOptions>; 2],
    /// Axes whose drives are elsewhere on the bus, in the order of [`Axis::ALL`]: this plant does not answer for them.
    pub away: [bool; 3],
    /// The block of inputs and outputs.
    pub block: BlockOptions,
    /// The board's node number, where it is not [`NodeId::BOARD`].
    pub board: Option<NodeId>,
}

/// Why a plant is impossible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlantError {
    /// The drive increments of an axis are not a possible ratio.
    Scale(Axis),
    /// An axis would stand outside the range of its drive.
    Position(Axis),
    /// The latency of an axis is more than 126 ticks, or the tick is 0.
    Latency(Axis),
    /// A figure of an axis' drive is out of its range.
    Servo(Axis),
    /// The encoder has no counts.
    Encoder,
    /// The spindle's ramp is 0 or slower than a minute per 1000 rpm.
    Ramp,
}

/// The true state of the plant: the spindle at the time of the last SYNC, and the drives after the last SYNC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Truth {
    /// Spindle angle.
    pub angle: FineTurns,
    /// Spindle speed, ripple included.
    pub speed: MilliRpm,
    /// The positions of the drives, in the order of [`Axis::ALL`].
    pub positions: [Increments; 3],
    /// Where the tool is on X and Z at the time of the last SYNC, as their drives have moved it; `None` where a drive is
    /// an ideal one.
    pub loads: [Option<Length>; 2],
    /// Angles of spindles 2 to 4.
    pub tappers: [FineTurns; 3],
}

/// The whole plant around the board.
#[derive(Clone, Copy, Debug)]
pub struct Plant {
    tick_ns: u64,
    started: bool,
    spindle: Spindle,
    encoder: Encoder,
    x: Drive,
    z: Drive,
    c: Drive,
    away: [bool; 3],
    spindle_drive: Drive,
    /// Increments of the spindle's drive in a turn.
    per_turn: u32,
    /// The same where the motor turns as the spindle.
    direct_per_turn: u32,
    gear: Option<Gear>,
    /// The position of the spindle in position mode.
    position: Follower,
    /// Spindles 2 to 4, and how many of them exist.
    tappers: [Tapper; 3],
    present: usize,
    positioning: bool,
    block: Option<IoBlock>,
}

impl Plant {
    /// A plant for a parameter set, just switched on.
    pub fn new(params: &Params, options: &PlantOptions) -> Result<Self, PlantError> {
        let ramp_ms = options.ramp_ms.unwrap_or(params.spindle_ramp_ms());
        let spindle =
            Spindle::new(ramp_ms, options.ripple, options.angle).ok_or(PlantError::Ramp)?;
        let encoder = Encoder::new(
            params.encoder_counts(),
            params.encoder_edge_time(),
            spindle.angle(),
            options.counter,
        )
        .ok_or(PlantError::Encoder)?;
        let zero = Increments::new(0);
        // A spindle's drive reports its encoder; this follower never moves.
        let still = Follower::new(zero, 0, 1, 0).ok_or(PlantError::Encoder)?;
        let position = spindle_follower(params, options)?;
        let nodes = DriveNodes::of(params);
        let first = nodes.spindle(TapSpindle::First);
        Ok(Self {
            tappers: [
                tapper(params, options, TapSpindle::Second)?,
                tapper(params, options, TapSpindle::Third)?,
                tapper(params, options, TapSpindle::Fourth)?,
            ],
            present: usize::from(params.tap_spindles()).saturating_sub(1),
            tick_ns: u64::from(params.tick_us()).wrapping_mul(1000),
            started: false,
            spindle,
            encoder,
            x: axis_drive(params, options, Axis::X)?,
            z: axis_drive(params, options, Axis::Z)?,
            c: axis_drive(params, options, Axis::C)?,
            away: options.away,
            spindle_drive: set_up(
                Drive::new(first, staggered(options, 3), still),
                params,
                options,
                3,
            )
            .for_spindle(),
            per_turn: params.spindle_increments(),
            direct_per_turn: params.spindle_increments(),
            gear: None,
            position,
            positioning: false,
            block: IoBlock::new(
                params,
                &options.block,
                options.board.unwrap_or(NodeId::BOARD),
            ),
        })
    }

    /// Lets the time up to the next SYNC pass (the first call: none). Gives the encoder inputs at this SYNC.
    pub fn advance(&mut self) -> EncoderSample {
        if self.started {
            match self.spindle_target() {
                Some(angle) => {
                    let encoder = &mut self.encoder;
                    self.spindle
                        .turn_to(angle, self.tick_ns, |piece| encoder.turn(piece));
                }
                None => {
                    let encoder = &mut self.encoder;
                    self.spindle
                        .advance(self.tick_ns, |piece| encoder.turn(piece));
                }
            }
        }
        for tapper in self.tappers.iter_mut().take(self.present) {
            tapper.advance();
        }
        if self.started {
            for drive in self.axes_here() {
                drive.elapse();
            }
        }
        self.started = true;
        self.encoder.sample()
    }

    /// In position mode: the spindle's angle at the coming SYNC.
    fn spindle_target(&mut self) -> Option<FineTurns> {
        let entered = !self.positioning;
        self.positioning = self.spindle_drive.is_positioning();
        if !self.positioning {
            return None;
        }
        let target = self.spindle_drive.coming_target()?;
        let here = self.spindle.angle().increments(self.per_turn);
        if entered {
            self.position.stand_at(here);
        }
        // The drive counts in 32 bits, but the spindle turns on. So this takes the nearest of all angles with this target.
        let newest = self.position.newest();
        let way = target.get().wrapping_sub(newest as i32);
        self.position
            .follow_count(newest.wrapping_add(i64::from(way)));
        Some(FineTurns::of_fine_increments(
            self.position.fine(),
            self.per_turn,
        ))
    }

    /// Takes the frames that the board sends in this period, one SYNC among them, in their order on the bus. Gives the
    /// drives' answers to `to_board`.
    pub fn exchange(&mut self, from_board: &[Frame], mut to_board: impl FnMut(Frame)) {
        for frame in from_board {
            self.deliver(frame, &mut to_board);
        }
    }

    /// Takes the frame for all drives. It comes after the other frames of its period.
    pub fn tell_together(&mut self, frame: &FdFrame) {
        for drive in self.axes_here() {
            drive.receive_fd(frame);
        }
        self.spindle_drive.receive_fd(frame);
        for tapper in self.tappers.iter_mut().take(self.present) {
            tapper.drive().receive_fd(frame);
        }
    }

    fn deliver(&mut self, frame: &Frame, to_board: &mut impl FnMut(Frame)) {
        if is_sync(frame) {
            let angle = self.spindle.angle().increments(self.per_turn);
            let measured = Increments::new(angle as i32);
            self.spindle_drive.turns(!self.spindle.stands());
            for drive in self.axes_here() {
                drive.sync(None, &mut *to_board);
            }
            self.spindle_drive.sync(Some(measured), &mut *to_board);
            self.tell_spindle();
            for tapper in self.tappers.iter_mut().take(self.present) {
                tapper.sync(&mut *to_board);
            }
        } else {
            for drive in self.axes_here() {
                drive.receive(frame);
            }
            self.spindle_drive.receive(frame);
            for tapper in self.tappers.iter_mut().take(self.present) {
                tapper.drive().receive(frame);
            }
            if frame.id() == CobId::NMT {
                self.tell_spindle();
            }
        }
    }

    /// From now on the spindle follows the command of its drive, through the gear that is in.
    fn tell_spindle(&mut self) {
        let motor = self.spindle_drive.velocity();
        self.spindle.command(match self.gear {
            None => motor,
            Some(gear) => {
                let turned = i64::from(motor.get()).wrapping_mul(gear.spindle.into());
                let speed = turned.checked_div(gear.motor.into()).unwrap_or(0);
                MilliRpm::new(speed as i32)
            }
        });
    }

    /// The gear that is in from now on; the spindle stands. Without one the motor turns as the spindle.
    pub fn shift(&mut self, gear: Option<Gear>) {
        if gear != self.gear {
            self.gear = gear;
            let direct = self.direct_per_turn;
            let geared = gear.and_then(|gear| gear.increments(direct));
            self.per_turn = geared.unwrap_or(direct);
        }
    }

    /// Takes a frame of another node: NMT commands and SDO requests reach the drives, whose answers go to `to_bus`.
    pub fn hear(&mut self, frame: &Frame, mut to_bus: impl FnMut(Frame)) {
        if let Some(block) = &mut self.block {
            block.hear(frame, &mut to_bus);
        }
        let managed = NmtCommand::decode(frame).is_some();
        let asked = matches!(frame.id().service(), Some((Service::SdoRequest, _)));
        if !managed && !asked {
            return;
        }
        let present = self.present;
        let [second, third, fourth] = &mut self.tappers;
        let tappers = [second, third, fourth].into_iter().take(present);
        let axes = [&mut self.x, &mut self.z, &mut self.c];
        let here = axes
            .into_iter()
            .zip(self.away)
            .filter_map(|(drive, away)| (!away).then_some(drive));
        let drives = here
            .chain([&mut self.spindle_drive])
            .chain(tappers.map(Tapper::drive));
        for drive in drives {
            if managed {
                drive.receive(frame);
            } else {
                drive.serve(frame, &mut to_bus);
            }
        }
        self.tell_spindle();
    }

    /// A frame of the board as a node: the block hears it.
    pub fn hear_board(&mut self, frame: &Frame, mut to_bus: impl FnMut(Frame)) {
        if let Some(block) = &mut self.block {
            block.hear(frame, &mut to_bus);
        }
    }

    /// A SYNC period of the block; its frames go to `to_bus`.
    pub fn elapse_block(&mut self, mut to_bus: impl FnMut(Frame)) {
        if let Some(block) = &mut self.block {
            block.elapse(&mut to_bus);
        }
    }

    /// The block of inputs and outputs, where it is here.
    pub const fn block(&mut self) -> Option<&mut IoBlock> {
        self.block.as_mut()
    }

    fn axes_here(&mut self) -> impl Iterator<Item = &mut Drive> {
        let drives = [&mut self.x, &mut self.z, &mut self.c];
        let away = self.away;
        drives
            .into_iter()
            .zip(away)
            .filter_map(|(drive, away)| (!away).then_some(drive))
    }

    /// The true state now.
    #[must_use]
    pub fn truth(&self) -> Truth {
        Truth {
            angle: self.spindle.angle(),
            speed: self.spindle.speed(),
            positions: [self.x.actual(), self.z.actual(), self.c.actual()],
            loads: [self.x.load(), self.z.load()],
            tappers: self.tappers.map(|tapper| tapper.angle()),
        }
    }

    /// The spindle, to disturb it.
    pub const fn spindle(&mut self) -> &mut Spindle {
        &mut self.spindle
    }

    /// The spindle's encoder, to give it faults.
    pub const fn encoder(&mut self) -> &mut Encoder {
        &mut self.encoder
    }

    /// The existing spindles of 2 to 4, to give them faults.
    pub fn tappers(&mut self) -> impl Iterator<Item = &mut Tapper> {
        self.tappers.iter_mut().take(self.present)
    }

    /// The drive of an axis, to give it faults.
    pub const fn drive(&mut self, axis: Axis) -> &mut Drive {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
            Axis::C => &mut self.c,
        }
    }

    /// Where an axis is, in nanometres (C: millionths of a degree), whatever its drive counts. `None` beyond what a drive
    /// of these parameters can count.
    #[must_use]
    pub fn place(&self, params: &Params, axis: Axis) -> Option<i64> {
        let scale = Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))?;
        let drive = match axis {
            Axis::X => &self.x,
            Axis::Z => &self.z,
            Axis::C => &self.c,
        };
        let place = i32::try_from(drive.place()).ok()?;
        Some(scale.position(Increments::new(place)))
    }

    /// The spindle's drive, to give it faults.
    pub const fn spindle_drive(&mut self) -> &mut Drive {
        &mut self.spindle_drive
    }
}

/// The options of the drive at this place in the order of answers. With four drives one answers each SYNC; with up to
/// eight, two.
fn staggered(options: &PlantOptions, place: u8) -> DriveOptions {
    DriveOptions {
        start: options.drives.start.wrapping_add(place),
        ..options.drives
    }
}

/// The drive of an axis, just switched on.
///
/// # Errors
/// The parameters or the position do not make a drive.
pub fn axis_drive(
    params: &Params,
    options: &PlantOptions,
    axis: Axis,
) -> Result<Drive, PlantError> {
    let node = DriveNodes::of(params).axis(axis);
    let position = match axis {
        Axis::X => options.at.x.nm(),
        Axis::Z => options.at.z.nm(),
        Axis::C => options.at.c.udeg(),
    };
    let scale = Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))
        .ok_or(PlantError::Scale(axis))?;
    // The drive of an axis that homes counts from its mark.
    let mark = match params.home_method(axis) {
        BY_DRIVE => params.home_position(axis),
        _ => 0,
    };
    let place_of = scale
        .increments(position)
        .ok_or(PlantError::Position(axis))?;
    let mark = scale.increments(mark).ok_or(PlantError::Position(axis))?;
    let at = Increments::new(place_of.get().wrapping_sub(mark.get()));
    let follower = Follower::new(
        at,
        params.latency_us(axis),
        params.tick_us(),
        options.drives.lag,
    )
    .ok_or(PlantError::Latency(axis))?;
    let place = axis as u8;
    let drive = Drive::new(node, staggered(options, place), follower).at(place_of);
    let drive = set_up(drive, params, options, usize::from(place));
    let drive = match Mode::of_setpoints(params.drive_mode(axis)) {
        Mode::Interpolated => drive.interpolated(),
        _ => drive,
    };
    let drive = match options.servos.get(usize::from(place)).copied().flatten() {
        None => drive,
        Some(servo) => {
            let ratio = (params.drive_numerator(axis), params.drive_denominator(axis));
            let servo = Servo::new(&servo, ratio, params.tick_us(), at)
                .zip(servo.following(ratio))
                .ok_or(PlantError::Servo(axis))?;
            drive.with_servo(servo.0, servo.1)
        }
    };
    Ok(match params.home_method(axis) {
        BY_DRIVE => drive.with_reference(),
        _ if params.drive_tells_inputs(axis) => drive.with_inputs(),
        _ => drive,
    })
}

/// The drive of a spindle that turns in position mode only, and the spindle itself, just switched on. In a whole plant
/// spindle 1 can do more; this function can stand in for it, for a board elsewhere.
///
/// # Errors
/// The parameters do not make a drive.
pub fn tapper(
    params: &Params,
    options: &PlantOptions,
    spindle: TapSpindle,
) -> Result<Tapper, PlantError> {
    let node = DriveNodes::of(params).spindle(spindle);
    let place = (spindle as u8).wrapping_add(3);
    let position = spindle_follower(params, options)?;
    let still = Follower::new(Increments::new(0), 0, 1, 0).ok_or(PlantError::Encoder)?;
    let drive = staggered(options, place);
    let mut tapper = Tapper::new(node, drive, position, still, params.spindle_increments());
    let drive = set_up(*tapper.drive(), params, options, usize::from(place));
    *tapper.drive() = drive.for_spindle();
    Ok(tapper)
}

/// The follower of a spindle in position mode: it is as late as Z's drive.
fn spindle_follower(params: &Params, options: &PlantOptions) -> Result<Follower, PlantError> {
    Follower::new(
        Increments::new(0),
        params.latency_us(Axis::Z),
        params.tick_us(),
        options.drives.lag,
    )
    .ok_or(PlantError::Latency(Axis::Z))
}

/// Sets a drive up for its machine. `place` is that of its setpoints, where these come in one frame.
fn set_up(drive: Drive, params: &Params, options: &PlantOptions, place: usize) -> Drive {
    let drive = drive.with_tick(params.tick_us());
    match params.setpoint_frame() {
        0 => drive,
        _ => drive.with_setpoints_of(options.board.unwrap_or(NodeId::BOARD), place),
    }
}
