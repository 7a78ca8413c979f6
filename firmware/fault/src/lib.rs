#![no_std]
//! The end of a board's firmware: a fault of the processor, a panic, or a stack that has left its memory.
//!
//! After such a failure no variable can be trusted. All interrupts stop, and with them SYNC and setpoints: the drives
//! stop by their own supervision. The handler writes a [`Failure`] to memory that a reset leaves as it is, and resets
//! the processor. The image reads this memory at the next start ([`left`]) and passes the failure to the board's
//! power-up, which stands on an alarm until somebody has reset it. The memory also counts failures in a row ([`begin`]).
//!
//! An image that links this crate has no other handler of `HardFault`. The image's stack lies below its data, so that a
//! stack that is too deep runs into missing memory, or into a [guard](guard_stack). The image's `memory.x` gives the
//! limits of the stack: `_stack_end` and `_stack_start`. The handler needs nothing of the old stack.

use core::arch::naked_asm;
use core::mem::MaybeUninit;
use core::ptr::{read_volatile, with_exposed_provenance, write_volatile};

use cortex_m::peripheral::{MPU, SCB};
use leadscrew_app::{Failure, FailureKind, Left, VERSION};

/// The memory that a reset leaves as it is.
#[repr(C)]
struct Memory {
    head: [u32; Left::HEAD],
    /// SYNC periods since the start.
    ticks: u32,
    record: [u32; Failure::WORDS],
}

// The start code neither loads nor clears this section.
#[unsafe(link_section = ".uninit.failure")]
static mut MEMORY: MaybeUninit<Memory> = MaybeUninit::uninit();

/// Reads one part of [`MEMORY`].
fn read<T>(part: *const T) -> T {
    // SAFETY: called with parts of `MEMORY` only; they are aligned, and any bits are words.
    unsafe { read_volatile(part) }
}

/// Writes one part of [`MEMORY`].
fn write<T>(part: *mut T, value: T) {
    // SAFETY: as for reading. Once the tick runs, it alone writes the ticks. The other parts are written before the
    // tick runs, by handlers, which do not return, and by a tick that resets the processor next.
    unsafe { write_volatile(part, value) }
}

fn memory() -> *mut Memory {
    (&raw mut MEMORY).cast()
}

/// The parts of [`MEMORY`]: head, ticks, record.
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

/// Counts a SYNC period: called in each tick.
pub fn tick() {
    let (_, ticks, _) = parts();
    // The count saturates after 49 days at 1 ms: still a good run.
    write(ticks, read(ticks).saturating_add(1));
}

/// What the last run has left in memory. The image decides what to do with it, and then calls [`begin`].
#[must_use]
pub fn left() -> Left {
    let (head, ticks, record) = parts();
    Left::decode(&read(head), read(ticks), &read(record))
}

/// Begins a run, after this failure if there was one. After too many failures in a row this function does not return.
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

/// Forgets everything, as the memory does where the power goes: for an emulated board whose power is cut. The caller, a
/// tick, resets the processor next.
pub fn forget() {
    let (head, _, _) = parts();
    write(head, [0; Left::HEAD]);
}

/// Forbids all access to the 4 KiB below `_stack_end`, for a chip that has memory there. `_stack_end` is a multiple of
/// 4 KiB.
pub fn guard_stack(mpu: &mut MPU) {
    const SIZE: u32 = 4096;
    /// On, 2^(11 + 1) bytes, no access, no execution.
    const GUARD: u32 = 1 << 28 | 11 << 1 | 1;
    /// On; without a region the default memory map holds; off in the handler of the fault.
    const ON: u32 = 1 << 2 | 1;
    let base = (&raw const _stack_end as u32).wrapping_sub(SIZE);
    // SAFETY: no program uses this memory; a stack that reaches it has run over.
    unsafe {
        mpu.rnr.write(0);
        mpu.rbar.write(base);
        mpu.rasr.write(GUARD);
        mpu.ctrl.write(ON);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// For the image's handler of panics. It ignores the panic's message and place, so the image holds neither texts nor
/// places of panics. The record takes two addresses from the stack: the call that panicked, and the call of the
/// function that made it.
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

/// Walks up the stack from a frame. Each frame begins with the address of the next frame and the return address.
extern "C" fn came_from(mut frame: u32) -> ! {
    /// From a return address (in Thumb state) back into the call.
    const INTO_CALL: u32 = 3;
    let mut call = || {
        let (above, back) = (on_stack(frame), on_stack(frame.saturating_add(4)));
        // The addresses always rise, so that the walk ends.
        frame = if above > frame { above } else { 0 };
        back.saturating_sub(INTO_CALL)
    };
    // Skips the library's own functions on the way to a panic.
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

/// Writes the record and resets the processor. It takes an empty stack, so that it adds nothing to the deepest one.
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

/// Begins with an empty stack: the old stack may have left its memory.
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

/// A word of the stack; 0 for an address outside the stack.
fn on_stack(at: u32) -> u32 {
    let (low, high) = (&raw const _stack_end as u32, &raw const _stack_start as u32);
    if (low..high).contains(&at) && at.is_multiple_of(4) {
        // SAFETY: within the stack, aligned, and any bits are a word.
        unsafe { read_volatile(with_exposed_provenance(at as usize)) }
    } else {
        0
    }
}

/// `stacked`: the stack pointer at the fault. The processor has put there r0–r3, r12, return address, address of the
/// instruction and flags of the code that failed.
extern "C" fn fault(stacked: u32) -> ! {
    if stacked < &raw const _stack_end as u32 {
        end(FailureKind::StackOverflow, 0, 0);
    }
    let word = |index: u32| on_stack(stacked.saturating_add(4 * index));
    end(FailureKind::Fault, word(6), word(5))
}
