//! The part of CANopen that a cyclic master of drives needs, which is a node itself: CiA 301 frames and services, CiA
//! 402 drives.
//!
//! Terms. A *node* is a device with a number. A *PDO* is process data in one frame. Its name takes the drive's view: a
//! drive receives an RPDO and sends a TPDO. *SYNC* is the periodic frame on which drives latch the last RPDO and sample
//! the values of their answer.
//!
//! ```text
//! SYNC(k) ─► drives latch RPDO(k−1), sample, answer ─► the board computes and sends RPDO(k) ─► SYNC(k+1)
//! ```
//!
//! Everything here is sans-IO: frames and ticks go in, frames and events come out. This module must not know the
//! purpose of the positions: no motion, no program text.

mod board_pdo;
mod cia402;
mod controller;
mod drive;
mod emcy;
mod emcy_producer;
mod failure;
mod fd;
mod frame;
mod heartbeat;
mod increments;
mod load;
mod mapping;
mod nmt;
mod nmt_slave;
mod object;
mod pdo;
mod periods;
mod setpoints;
mod spindle;
mod sync;

pub use board_pdo::{
    Beat, BoardBeat, BoardCommand, BoardFlags, BoardPlace, BoardSpindle, BoardState, BoardStatus,
    JogRequest, Order, OrderGate, StepRequest, WheelRequest,
};
pub use cia402::{Controlword, HomingState, State, Statusword};
pub use controller::{BusState, Controller, ErrorCounts};
pub use drive::{
    DriveConfig, DriveMaster, DriveOutput, FollowingLimit, HomeEnd, HomeLimits, HomeStep, Inputs,
    Phase, Step,
};
pub use emcy::Emcy;
pub use emcy_producer::EmcyProducer;
pub use failure::DriveFailure;
pub use fd::{DataRates, FdBits, FdFrame};
pub use frame::{CobId, Frame, NodeId, Service};
pub use heartbeat::{HeartbeatConsumer, HeartbeatEvent, HeartbeatProducer, HeartbeatWatch};
pub use increments::{Increments, Scale, Told};
pub use load::{Cycle, frame_bits};
pub use mapping::{Mapped, PdoCommunication};
pub use nmt::{NmtCommand, NmtState};
pub use nmt_slave::{NmtEvent, NmtSlave};
pub use object::{Abort, Object, Objects};
pub use pdo::{AxisMode, AxisReport, DriveCommand, DriveStatus, MilliRpm, Mode, SpindleCommand};
pub use periods::Periods;
pub use setpoints::Setpoints;
pub use spindle::{SpindleDemand, SpindleMaster};
pub use sync::{SyncProducer, is_sync};
