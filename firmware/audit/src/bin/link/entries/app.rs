//! The part that all images share: the two contexts, and the memory of a failure.

use core::mem::MaybeUninit;

use audit::any::{any, sink};
use leadscrew_app::{
    Failure, Left, Machine, Memory, PowerUp, ResetCause, ResetFlags, TickMachine, serial_of, step,
    tick,
};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{self, Event, Held, Inputs, Region, StoreError, StoreRequest};
use leadscrew_core::bus::{CobId, Controller, DataRates, Frame, Setpoints};
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
            machine: any(),
            trouble: None,
            unanswered: any::<bool>().then_some(Code::ClampOpen),
        }
    }

    fn receive(&mut self) -> Option<Frame> {
        any()
    }

    fn send(&mut self, frames: &[Frame], together: Option<&Setpoints>) -> bool {
        sink(frames);
        sink(together.map(|setpoints| setpoints.frame(any())));
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

    fn receive_fd(&mut self) -> Option<CobId> {
        any()
    }

    fn handwheel(&mut self) -> u16 {
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

    fn erases(&mut self) -> Option<u32> {
        any::<bool>().then(any)
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
        data_rates: DataRates::of(|_| any()),
        failure: Failure::decode(&any()),
        cause: cause(),
    };
    // As in the images: no memory before it is dropped.
    let memory = place::<MaybeUninit<Memory>>().write(Memory::new());
    let Ok(mut sides) = memory.power_up(&up) else {
        return;
    };
    while any() {
        tick(&mut sides.tick, sides.output, &mut Anything);
        sink(step(&mut sides.background, &mut Anything));
        sink(sides.background.offer(&any()));
        sink((
            sides.background.state().awaits_program(),
            sides.background.is_busy(),
        ));
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
