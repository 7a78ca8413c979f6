//! The part that all images share: the two contexts, the queues between them, and the memory of a failure.

use audit::any::{any, sink};
use leadscrew_app::{
    BackgroundPlace, Failure, Inputs, Left, Machine, PowerUp, Queues, ResetCause, ResetFlags,
    TickMachine, TickPlace, TickerPlace, serial_of,
};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{self, Event, Held, Region, StoreError, StoreRequest};
use leadscrew_core::bus::{Controller, Frame, Setpoints};
use leadscrew_core::params::Params;
use leadscrew_core::spindle::EncoderSample;

/// Calls all entries of this module.
pub fn all() {
    board();
    left();
    sink(serial_of(any()));
}

/// Hardware that gives arbitrary values.
struct Anything;

impl TickMachine for Anything {
    fn sample(&mut self) -> EncoderSample {
        any()
    }

    fn inputs(&mut self) -> Inputs {
        Inputs {
            stop: any(),
            hold: any(),
            signals: any(),
            trouble: None,
            unanswered: any::<bool>().then_some(Code::ClampOpen),
        }
    }

    fn receive(&mut self) -> Option<Frame> {
        any()
    }

    fn send(&mut self, frames: &[Frame]) -> bool {
        sink(frames);
        any()
    }

    fn send_together(&mut self, setpoints: &Setpoints) -> bool {
        sink(setpoints.frame(any()));
        any()
    }

    fn feed_watchdog(&mut self) {
        sink(());
    }
}

impl Machine for Anything {
    fn receive(&mut self) -> Option<Frame> {
        any()
    }

    fn has_room(&self) -> bool {
        any()
    }

    fn send(&mut self, frame: &Frame) {
        sink(*frame);
    }

    fn store(&mut self, request: &StoreRequest<'_>) {
        sink(request);
    }

    fn stored(&mut self) -> Option<Result<(), StoreError>> {
        any::<bool>().then(|| if any() { Ok(()) } else { Err(any()) })
    }

    fn load(&mut self, region: Region, then: &mut dyn FnMut(Held<'_>)) {
        sink(region);
        let bytes: [u8; Region::LONGEST] = any();
        then(if any() {
            Ok(bytes.get(..any()))
        } else {
            Err(any())
        });
    }

    fn event(&mut self, event: &Event) {
        sink(event);
    }

    fn controller(&mut self) -> Controller {
        any()
    }

    fn rejoin(&mut self) {
        sink(());
    }

    fn begin_anew(&mut self, params: &Params) {
        sink(params);
    }
}

fn cause() -> ResetCause {
    let flags = ResetFlags {
        brown_out: any(),
        watchdog: any(),
        window_watchdog: any(),
        software: any(),
        pin: any(),
    };
    ResetCause::of(flags, any())
}

/// A place that lives for ever.
fn place<T>() -> &'static mut T {
    let address: usize = any();
    // SAFETY: this image is never run.
    unsafe { &mut *(address as *mut T) }
}

#[inline(never)]
fn board() {
    let set = board::PowerUp::given(&any());
    let up = PowerUp {
        set: &set,
        remembered: any(),
        tap: any(),
        node: any(),
        serial: any(),
        fd: any(),
        failure: Failure::decode(&any()),
        cause: cause(),
    };
    let queues = place::<Queues>();
    *queues = Queues::new();
    let sides = queues.power_up(
        place::<TickPlace>(),
        place::<TickerPlace>(),
        place::<BackgroundPlace>(),
        &up,
    );
    let Ok((tick, background)) = sides else {
        return;
    };
    while any() {
        tick.tick(&mut Anything);
        sink(background.step(&mut Anything));
        sink(background.offer(&any()));
        sink((background.awaits_program(), background.is_busy()));
    }
}

#[inline(never)]
fn left() {
    let left = Left::decode(&any(), any(), &any());
    sink(left.next());
    if let Some(failure) = left.failure(cause()) {
        sink(failure.alarm());
        sink(failure.encode());
    }
    sink(Left::head(any()));
    sink(cause().warning());
}
