//! Arbitrary values. Each is made from volatile reads through the public constructors of the core, so that the
//! optimiser must expect every value that the type can have.

use core::hint::black_box;
use core::num::NonZeroU8;
use core::time::Duration;

use leadscrew_core::alarm::{At, Span};
use leadscrew_core::board::{BusTrouble, Command, Intrusion, StoreError, Victim};
use leadscrew_core::bus::{
    Abort, Beat, BlockSize, BoardBeat, BoardCommand, BoardFlags, BoardPlace, BoardSpindle,
    BoardState, BoardStatus, BusState, CobId, Controller, Controlword, DriveCommand, DriveConfig,
    DriveStatus, Emcy, ErrorCounts, FdFrame, FollowingLimit, Frame, HeartbeatWatch, HomeLimits,
    Increments, JogRequest, MilliRpm, Mode, NmtCommand, NmtState, NodeId, Object, Order, Periods,
    Scale, SdoProtocol, SpindleCommand, SpindleDemand, Statusword, StepRequest, SyncProducer,
    WheelRequest,
};
use leadscrew_core::call::{
    ArcCall, Aux, Call, CallKind, ChainPart, CutIn, Extraction, FeedRate, GrooveCall, Hand,
    HandChoice, Infeed, LengthUnit, Plane, Position, RunOut, Selection, SpindleCall, SpindleChoice,
    SpindleMode, SurfaceSpeed, TapAxis, TapCall, TapCycle, TapForm, TapMode, TapNotes, TapPeck,
    TapRepeat, TapReturn, TapSpindle, ThreadCall, ThreadCycle,
};
use leadscrew_core::journal::{TapHole, TapRecord};
use leadscrew_core::motion::{Limits, PathRate, Ramp, Rate, Travel};
use leadscrew_core::moves::{Move, MoveKind, TapMove, ThreadMove};
use leadscrew_core::offsets::Offsets;
use leadscrew_core::offsets::image::BYTES;
use leadscrew_core::operating::{Led, OperatingMode, PressState, Towards, WheelFactor};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::program::{Dialect, Options, Way};
use leadscrew_core::signals::Signals;
use leadscrew_core::spindle::EncoderSample;
use leadscrew_core::units::{
    Angle, Axes, CentiRpm, Feed, FeedPerTurn, Lead, LeadChange, Length, Millis, Remainder, Rpm,
    StartAngle, TurnRate, TurnRatio, Turns,
};

static SOURCE: u64 = 0;

/// A type that can give an arbitrary value.
pub trait Any: Sized {
    /// An arbitrary value of the type.
    fn any() -> Self;
}

/// An arbitrary value; the place of use tells the type.
pub fn any<T: Any>() -> T {
    T::any()
}

/// Uses a result up, so that the optimiser cannot drop its computation.
pub fn sink<T>(value: T) {
    black_box(value);
}

macro_rules! integers {
    ($($type:ty)*) => {$(
        impl Any for $type {
            fn any() -> Self {
                // SAFETY: a reference to a static is valid for a read.
                let bits = unsafe { core::ptr::read_volatile(&SOURCE) };
                bits as Self
            }
        }
    )*};
}
integers!(u8 u16 u32 u64 usize i8 i16 i32 i64);

impl Any for bool {
    fn any() -> Self {
        u8::any() & 1 == 1
    }
}

impl<T: Any> Any for Option<T> {
    fn any() -> Self {
        bool::any().then(T::any)
    }
}

impl<T: Any, const N: usize> Any for [T; N] {
    fn any() -> Self {
        core::array::from_fn(|_| T::any())
    }
}

impl<T: Any> Any for At<T> {
    fn any() -> Self {
        Self::new(any(), any())
    }
}

/// Types with one constructor from an integer.
macro_rules! wrapped {
    ($($type:ident::$new:ident)*) => {$(
        impl Any for $type {
            fn any() -> Self {
                Self::$new(any())
            }
        }
    )*};
}
wrapped!(CentiRpm::new LeadChange::from_pm Length::from_nm Angle::from_udeg Turns::from_raw StartAngle::from_mdeg
    Feed::from_nm_per_min FeedPerTurn::from_nm Rpm::new Millis::new Increments::new Periods::new MilliRpm::new Statusword::from_raw
    Controlword::from_raw PathRate::from_raw Rate::from_raw Travel::from_raw TurnRate::from_raw Remainder::from_raw);

/// Types made from their public fields.
macro_rules! records {
    ($($type:ident { $($field:ident)* })*) => {$(
        impl Any for $type {
            fn any() -> Self {
                Self { $($field: any(),)* }
            }
        }
    )*};
}
records! {
    Span { line column end }
    Position { x z c }
    Signals { g61_2 rgtap sws rgtsp }
    Call { span origin kind }
    ArcCall { end i k clockwise feed }
    SpindleCall { rpm mode }
    SurfaceSpeed { speed centre least most }
    RunOut { short long short_rest long_rest }
    ThreadCall {
        cycle start end_x end_z taper height first_depth min_step allowance finish_passes angle infeed cut_in starts
        run_in run_out lead change first_angle part increment rpm
    }
    GrooveCall { axis start end_x end_z last_written peck step relief retract feed }
    TapPeck { infeed back }
    TapCall {
        cycle mode axis start hole step level bottom form dwell lead hand speed extract spindle repeat clamp continues
        notes
    }
    TapMove { mode axis spindle lead hand level bottom turns speed outward opens closes }
    TapNotes { unit plane extraction }
    TapReturn { speed highest beyond unit }
    TapHole { axis level bottom lead hand spindle speed notes }
    TapRecord { sequence in_hole hole position angle }
    ThreadMove { lead change pass_angle angle_udeg long_x part last rpm }
    EncoderSample { count edge_age_ns index }
    Options { dialect skip optional_stop dry_run per_turn limits_every_speed passes_machine_codes position offsets gear }
    DriveCommand { control target }
    DriveStatus { status actual }
    SpindleCommand { mode velocity }
    Controller { state errors }
    ErrorCounts { sending receiving }
    Emcy { code register detail }
    FollowingLimit { increments time standing }
    Object { index sub }
    HeartbeatWatch { node ms }
    BoardCommand { count order single_block dry_run feed rapid spindle echo }
    BoardBeat { beat mode session press state refused }
    JogRequest { session press x z spindle rapid speed echo }
    StepRequest { session count on_z way echo }
    WheelRequest { session leads factor claim count echo }
    BoardFlags { hold single_block dry_run program locked }
    BoardStatus { state flags alarm count late credit }
    BoardPlace { line number }
    BoardSpindle { angle speed sync_error }
    DriveConfig { letter node scale step silence following reach homes mode }
    HomeLimits { time travel stale }
}

impl Any for Extraction {
    fn any() -> Self {
        Self::new(any(), any()).unwrap_or_default()
    }
}

/// Types with a choice of variants.
macro_rules! choices {
    ($($type:ident { $($choice:expr),* $(,)? } or $last:expr;)*) => {$(
        impl Any for $type {
            fn any() -> Self {
                $(if bool::any() { return $choice; })*
                $last
            }
        }
    )*};
}
choices! {
    StoreError { StoreError::Device, StoreError::Full } or StoreError::Damaged;
    Mode { Mode::Position, Mode::Interpolated, Mode::Homing } or Mode::Velocity;
    SpindleDemand { SpindleDemand::Speed(any()) } or SpindleDemand::Position(any());
    NmtCommand {
        NmtCommand::Start, NmtCommand::Stop, NmtCommand::PreOperational, NmtCommand::ResetNode,
    } or NmtCommand::ResetCommunication;
    SdoProtocol { SdoProtocol::Short, SdoProtocol::Segmented } or SdoProtocol::Block;
    Order {
        Order::Run, Order::Hold, Order::Resume, Order::Reset, Order::Stop, Order::Cancel, Order::Mode(any()),
    } or Order::Home(any());
    OperatingMode {
        OperatingMode::Manual, OperatingMode::Step, OperatingMode::Wheel, OperatingMode::Reference, OperatingMode::Mdi,
    } or OperatingMode::Automatic;
    Towards { Towards::Plus } or Towards::Minus;
    Led { Led::X, Led::Z } or Led::Path;
    WheelFactor { WheelFactor::One, WheelFactor::Ten } or WheelFactor::Hundred;
    PressState { PressState::None, PressState::Runs, PressState::Ended, PressState::Limit } or PressState::Refused;
    NmtState { NmtState::BootUp, NmtState::Stopped, NmtState::Operational } or NmtState::PreOperational;
    FeedRate { FeedRate::PerMinute(any()) } or FeedRate::PerTurn(any(), any());
    Aux { Aux::M(any()) } or Aux::T(any());
    ThreadCycle { ThreadCycle::G76, ThreadCycle::G78, ThreadCycle::G92, ThreadCycle::G32 } or ThreadCycle::G34;
    ChainPart { ChainPart::Whole, ChainPart::First, ChainPart::Middle } or ChainPart::Last;
    CutIn { CutIn::Centre, CutIn::Left, CutIn::Right, CutIn::RightCentre, CutIn::LeftRight } or CutIn::Trailing;
    Infeed { Infeed::Equal } or Infeed::Decreasing;
    TapMode { TapMode::Rigid } or TapMode::Floating;
    SpindleMode { SpindleMode::Speed, SpindleMode::Rigid(any()), SpindleMode::Orient(any()) } or SpindleMode::Surface(any());
    Way { Way::Rapid, Way::Line } or Way::Arc { i: any(), k: any(), clockwise: any() };
    HandChoice { HandChoice::Signal } or HandChoice::Written(any());
    Selection { Selection::Sws } or Selection::Rgtsp;
    SpindleChoice { SpindleChoice::Written(any()) } or SpindleChoice::Signals { by: any(), otherwise: any() };
    TapCycle { TapCycle::G84 } or TapCycle::G88;
    LengthUnit { LengthUnit::Metric } or LengthUnit::Inch;
    Plane { Plane::G17, Plane::G18 } or Plane::G19;
    TapAxis { TapAxis::X } or TapAxis::Z;
    TapSpindle { TapSpindle::First, TapSpindle::Second, TapSpindle::Third } or TapSpindle::Fourth;
    Hand { Hand::Right } or Hand::Left;
    TapForm { TapForm::Standard, TapForm::HighSpeed(any()) } or TapForm::Deep(any());
    TapRepeat { TapRepeat::Holes(NonZeroU8::MIN.saturating_add(any())) } or TapRepeat::Stay;
    Dialect { Dialect::Gsk980td } or Dialect::Gsk988;
    BusState {
        BusState::Active, BusState::Passive, BusState::Off,
    } or BusState::Restricted;
    BusTrouble {
        BusTrouble::Off(any()), BusTrouble::Restricted, BusTrouble::Passive(any()), BusTrouble::Late { count: any(), limit: any() },
    } or BusTrouble::Intruder(any());
    Intrusion {
        Intrusion::Sync, Intrusion::Setpoint(Victim { letter: any(), node: any() }),
    } or Intrusion::Network(Victim { letter: any(), node: any() });
    Command {
        Command::Hold, Command::Resume, Command::Reset, Command::Stop, Command::SingleBlock(any()),
        Command::FeedOverride(any()), Command::RapidOverride(any()), Command::Trouble(any()), Command::Release,
        Command::ByWheel(any()), Command::Turned(any()),
    } or Command::SpindleOverride(any());
    MoveKind {
        MoveKind::Rapid, MoveKind::Feed(any()),
        MoveKind::Arc { i: any(), k: any(), clockwise: any(), feed: any() },
        MoveKind::Thread(any()), MoveKind::Tap(any()), MoveKind::Dwell(any()), MoveKind::Spindle(any()),
    } or MoveKind::Aux(any());
    CallKind {
        CallKind::Rapid(any()), CallKind::Line(any(), any()), CallKind::Arc(any()), CallKind::Dwell(any()),
        CallKind::Spindle(any()), CallKind::Aux(any()), CallKind::Thread(any()), CallKind::Groove(any()),
        CallKind::Tap(any()), CallKind::TapReturn(any()), CallKind::Over, CallKind::ExactStop(any()), CallKind::LineOver,
    } or CallKind::End(any());
}

impl Any for Lead {
    fn any() -> Self {
        loop {
            if let Some(lead) = Self::new(any(), any()) {
                return lead;
            }
        }
    }
}

impl Any for TurnRatio {
    fn any() -> Self {
        Self::of_travel(any(), any())
    }
}

impl Any for Axes {
    fn any() -> Self {
        Self::from_bits(any()).unwrap_or_default()
    }
}

impl Any for Beat {
    fn any() -> Self {
        Self::new(any())
    }
}

impl Any for NodeId {
    fn any() -> Self {
        Self::new(any()).unwrap_or(Self::BOARD)
    }
}

impl Any for BlockSize {
    fn any() -> Self {
        Self::new(any()).unwrap_or(Self::MAX)
    }
}

impl Any for Abort {
    fn any() -> Self {
        Self::from_code(any()).unwrap_or(Self::General)
    }
}

impl Any for BoardState {
    fn any() -> Self {
        Self::ALL.get(usize::any()).copied().unwrap_or_default()
    }
}

impl Any for Duration {
    fn any() -> Self {
        Self::from_nanos(any())
    }
}

impl Any for () {
    fn any() -> Self {}
}

impl<T: Any, E: Any> Any for Result<T, E> {
    fn any() -> Self {
        if bool::any() { Ok(any()) } else { Err(any()) }
    }
}

impl Any for CobId {
    fn any() -> Self {
        Self::new(any()).unwrap_or(Self::SYNC)
    }
}

impl Any for FdFrame {
    fn any() -> Self {
        Self::from(&Frame::any())
    }
}

impl Any for Frame {
    fn any() -> Self {
        let payload: [u8; 8] = any();
        let length = usize::any();
        payload
            .get(..length)
            .and_then(|payload| Self::new(any(), payload))
            .unwrap_or_else(|| SyncProducer::new().next())
    }
}

impl Any for Scale {
    fn any() -> Self {
        loop {
            if let Some(scale) = Self::new(any(), any()) {
                return scale;
            }
        }
    }
}

impl Any for Ramp {
    fn any() -> Self {
        loop {
            if let Some(ramp) = Self::new(any(), any(), any()) {
                return ramp;
            }
        }
    }
}

impl Any for Limits {
    fn any() -> Self {
        Self::from_params(&any())
    }
}

impl Any for Move {
    /// An arbitrary move, without its place in a cycle: no code on a board reads that.
    fn any() -> Self {
        Self {
            span: any(),
            to: any(),
            kind: any(),
            tag: None,
        }
    }
}

impl Any for Offsets {
    fn any() -> Self {
        let bytes: [u8; BYTES] = any();
        Self::decode(&bytes).unwrap_or_default()
    }
}

impl Any for Params {
    /// Any set that can be made entry by entry, sensible or not.
    fn any() -> Self {
        let mut params = Self::slant_bed();
        for entry in Entry::all() {
            // A value out of range is refused, and the old value stays.
            let _ = params.set(entry, any());
        }
        params
    }
}
