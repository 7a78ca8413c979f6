#![no_std]
//! The end of a board's firmware: a fault of the processor, a panic, or a stack that has left its memory.
//!
//! Nothing that is known still holds then. All interrupts stop, and with them SYNC and setpoints: the drives stop by
//! their own supervision. What happened is written to memory that a reset leaves as it is ([`Failure`]), and the
//! processor starts anew; the image hands what it finds ([`left`]) to the board's power-up, which stands on an alarm
//! until somebody has taken note. Failures in a row are counted there, too ([`begin`]).
//!
//! An image that links this has no other handler of `HardFault`. Its stack lies below its data, so that it runs into
//! memory that is not there, or into a [guard](guard_stack); its `memory.x` says where: `_stack_end` and
//! `_stack_start`. The handler needs nothing of the old stack.

use core::arch::naked_asm;
use core::mem::MaybeUninit;
use core::ptr::{read_volatile, with_exposed_provenance, write_volatile};

use cortex_m::peripheral::{MPU, SCB};
use leadscrew_app::{Failure, FailureKind, Left, VERSION};

/// What a reset leaves as it is.
#[repr(C)]
struct Memory {
    head: [u32; Left::HEAD],
    /// SYNC periods since the start.
    ticks: u32,
    record: [u32; Failure::WORDS],
}

// Neither loaded nor cleared at start.
#[unsafe(link_section = ".uninit.failure")]
static mut MEMORY: MaybeUninit<Memory> = MaybeUninit::uninit();

/// Reads one part of it.
fn read<T>(part: *const T) -> T {
    // SAFETY: called with parts of `MEMORY` only; they are aligned, and any bits are words.
    unsafe { read_volatile(part) }
}

/// Writes one part of it.
fn write<T>(part: *mut T, value: T) {
    // SAFETY: as for reading. Ticks belong to the tick alone once that runs; the rest is written before it runs, and by
    // handlers, which do not return.
    unsafe { write_volatile(part, value) }
}

fn memory() -> *mut Memory {
    (&raw mut MEMORY).cast()
}

/// The parts of it: head, ticks, record.
fn parts() -> (*mut [u32; Left::HEAD], *mut u32, *mut [u32; Failure::WORDS]) {
    let memory = memory();
    // SAFETY: within `MEMORY`; nothing is read.
    unsafe {
        (
            &raw mut (*memory).head,
            &raw mut (*memory).ticks,
            &raw mut (*memory).record,
        )
    }
}

/// A SYNC period has begun: called in each tick.
pub fn tick() {
    let (_, ticks, _) = parts();
    // More than 49 days of 1 ms: still a good run.
    write(ticks, read(ticks).saturating_add(1));
}

/// What the run before this start has left: the image decides by it, and [begins](begin).
#[must_use]
pub fn left() -> Left {
    let (head, ticks, record) = parts();
    Left::decode(&read(head), read(ticks), &read(record))
}

/// A run begins, behind this failure, if it was one. Where there have been too many in a row, it does not.
pub fn begin(failure: Option<&Failure>) {
    let in_a_row = failure.map_or(0, |failure| failure.in_a_row);
    let (head, ticks, record) = parts();
    write(head, Left::head(in_a_row));
    write(ticks, 0);
    write(record, [0; Failure::WORDS]);
    if in_a_row >= Failure::LAST {
        cortex_m::interrupt::disable();
        loop {
            cortex_m::asm::wfi();
        }
    }
}

/// Lets nothing touch the 4 KiB below `_stack_end`, for memory that does not end
/// there by itself. They begin at a multiple of their size.
pub fn guard_stack(mpu: &mut MPU) {
    const SIZE: u32 = 4096;
    /// On, 2^(11 + 1) bytes, no access, no execution.
    const GUARD: u32 = 1 << 28 | 11 << 1 | 1;
    /// On, with the memory as it is without regions for everything else; off in the handler of the fault.
    const ON: u32 = 1 << 2 | 1;
    let base = (&raw const _stack_end as u32).wrapping_sub(SIZE);
    // SAFETY: no program uses what lies there; a stack that does has run over.
    unsafe {
        mpu.rnr.write(0);
        mpu.rbar.write(base);
        mpu.rasr.write(GUARD);
        mpu.ctrl.write(ON);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// For the image's handler of panics, which looks at nothing of what it is handed:
/// so neither texts nor places of panics are in the image. What is recorded is what
/// the stack says: the call that panicked, and that of the function it is in.
#[unsafe(naked)]
pub extern "C" fn panicked() -> ! {
    naked_asm!(
        "cpsid i",
        // The frame of the handler.
        "mov r0, r7",
        "b {came_from}",
        came_from = sym came_from,
    )
}

/// Up the stack from a frame. Each begins with where the one above it is, and the address that its function returns to.
extern "C" fn came_from(mut frame: u32) -> ! {
    /// From where a call returns to, in Thumb state, back into the call.
    const INTO_CALL: u32 = 3;
    let mut call = || {
        let (above, back) = (on_stack(frame), on_stack(frame.saturating_add(4)));
        // Always upwards, so that it ends.
        frame = if above > frame { above } else { 0 };
        back.saturating_sub(INTO_CALL)
    };
    // The library's own ways to a panic.
    let (start, end_of) = (
        &raw const __panicking_start as u32,
        &raw const __panicking_end as u32,
    );
    let mut place = call();
    while (start..end_of).contains(&place) {
        place = call();
    }
    end(FailureKind::Panic, place, call())
}

/// Writes down what is known, and starts the processor anew. With a stack that is empty: so it adds nothing to the deepest.
#[unsafe(naked)]
extern "C" fn end(kind: FailureKind, place: u32, within: u32) -> ! {
    naked_asm!(
        "cpsid i",
        "ldr r3, =_stack_start",
        "msr msp, r3",
        "b {write_down}",
        write_down = sym write_down,
    )
}

extern "C" fn write_down(kind: FailureKind, place: u32, within: u32) -> ! {
    let (_, ticks, record) = parts();
    let failure = Failure {
        kind,
        place,
        within,
        ticks: read(ticks),
        version: VERSION,
        in_a_row: left().next(),
    };
    write(record, failure.encode());
    SCB::sys_reset()
}

/// Begins with a stack that is good: the old one may have ended.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() -> ! {
    naked_asm!(
        "cpsid i",
        "mrs r0, msp",
        "ldr r1, =_stack_start",
        "msr msp, r1",
        "b {fault}",
        fault = sym fault,
    )
}

unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
    static __panicking_start: u32;
    static __panicking_end: u32;
}

/// A word of the stack; 0 where that is not.
fn on_stack(at: u32) -> u32 {
    let (low, high) = (&raw const _stack_end as u32, &raw const _stack_start as u32);
    if (low..high).contains(&at) && at.is_multiple_of(4) {
        // SAFETY: within the stack, aligned, and any bits are a word.
        unsafe { read_volatile(with_exposed_provenance(at as usize)) }
    } else {
        0
    }
}

/// `stacked`: where the stack was. There the processor has put r0–r3, r12, return
/// address, address of the instruction, flags of the code that failed.
extern "C" fn fault(stacked: u32) -> ! {
    if stacked < &raw const _stack_end as u32 {
        end(FailureKind::StackOverflow, 0, 0);
    }
    let word = |index: u32| on_stack(stacked.saturating_add(4 * index));
    end(FailureKind::Fault, word(6), word(5))
}
