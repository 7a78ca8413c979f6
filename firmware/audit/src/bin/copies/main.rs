#![no_std]
#![no_main]
//! Tests the functions of `leadscrew-memory`, which the images of boards use, on the emulated Cortex-M4F: copies,
//! moves, fills and comparisons of every length and alignment, each against the same work done byte by byte; and divisions.

mod division;

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use leadscrew_console::print;
use leadscrew_memory as _;

type Copy = unsafe extern "C" fn(*mut u8, *const u8, usize) -> *mut u8;

unsafe extern "C" {
    fn memcpy(to: *mut u8, from: *const u8, bytes: usize) -> *mut u8;
    fn memmove(to: *mut u8, from: *const u8, bytes: usize) -> *mut u8;
    fn memset(to: *mut u8, value: i32, bytes: usize) -> *mut u8;
    fn memcmp(one: *const u8, other: *const u8, bytes: usize) -> i32;
    fn __aeabi_memcpy(to: *mut u8, from: *const u8, bytes: usize) -> *mut u8;
    fn __aeabi_memmove(to: *mut u8, from: *const u8, bytes: usize) -> *mut u8;
    fn __aeabi_memset(to: *mut u8, bytes: usize, value: i32);
    fn __aeabi_memclr(to: *mut u8, bytes: usize);
}

/// Bytes of the memory under test.
const ROOM: usize = 160;
/// More than two passes of the longest step.
const LONGEST: usize = 40;
/// The places where data begins: all alignments, and far enough from the beginning for overlapping data.
const PLACES: core::ops::Range<usize> = 48..56;

/// The largest alignment that any data needs.
#[repr(align(8))]
#[derive(Clone, Copy)]
struct Room([u8; ROOM]);

#[entry]
fn main() -> ! {
    let mut checks = 0_u32;
    for bytes in 0..=LONGEST {
        for to in PLACES {
            checks += fills(to, bytes);
            for from in PLACES {
                checks += compare(to, from, bytes);
                checks += copy(memcpy, to + 56, from, bytes);
                checks += copy(__aeabi_memcpy, to + 56, from, bytes);
            }
            // Moves within the memory, from all places around, the same place included.
            for from in to - LONGEST..=to + LONGEST {
                checks += copy(memmove, to, from, bytes);
                checks += copy(__aeabi_memmove, to, from, bytes);
            }
        }
    }
    print(format_args!(
        "{checks} copies, fills and comparisons, each byte in its place\n"
    ));
    let checks = division::checks();
    print(format_args!(
        "{checks} divisions, each with its quotient and its rest\n"
    ));
    leadscrew_console::done()
}

/// Memory with a different value in every byte.
fn filled() -> Room {
    let mut room = Room([0; ROOM]);
    for (value, byte) in (1..).zip(&mut room.0) {
        // The optimiser must not know the values that the test compares with.
        *black_box(byte) = value;
    }
    room
}

fn copy(function: Copy, to: usize, from: usize, bytes: usize) -> u32 {
    let before = filled();
    let mut room = filled();
    let place = room.0.as_mut_ptr();
    // SAFETY: both ranges lie in the memory, by the constants above.
    let returned = unsafe {
        let (to, from) = (place.add(to), place.add(from));
        black_box(function)(black_box(to), black_box(from), black_box(bytes))
    };
    assert_eq!(returned, place.wrapping_add(to));
    for (at, byte) in black_box(&room).0.iter().enumerate() {
        let expected = match at.checked_sub(to) {
            Some(offset) if offset < bytes => before.0[from + offset],
            _ => before.0[at],
        };
        assert_eq!(
            *byte, expected,
            "{bytes} bytes from {from} to {to}: at {at}"
        );
    }
    1
}

/// Compares equal memories, and memories that differ in one byte, less or more, at every place. The next byte then
/// differs the other way.
fn compare(one: usize, other: usize, bytes: usize) -> u32 {
    let (a, mut b) = (Room([0x80; ROOM]), Room([0x80; ROOM]));
    let ask = |b: &Room| {
        let (a, b) = (a.0.as_ptr(), b.0.as_ptr());
        // SAFETY: within both memories, by the constants above.
        unsafe { memcmp(a.add(one), black_box(b.add(other)), black_box(bytes)) }
    };
    assert_eq!(ask(&b), 0, "{bytes} bytes at {one}");
    for at in 0..bytes {
        for (value, behind, sign) in [(0x7F_u8, 0xFF_u8, 1), (0xFF, 0, -1)] {
            b.0[other + at] = value;
            b.0[other + at + 1] = behind;
            assert_eq!(ask(&b).signum(), sign, "{bytes} bytes, other at {at}");
        }
        b.0[other + at..=other + at + 1].fill(0x80);
    }
    1
}

fn fills(to: usize, bytes: usize) -> u32 {
    // Only the lowest byte of the value counts.
    const VALUE: i32 = 0x1234_56A5;
    fill(to, bytes, 0xA5, |place| {
        // SAFETY: within the memory, by the constants above.
        let returned = unsafe { memset(place, black_box(VALUE), black_box(bytes)) };
        assert_eq!(returned, place);
    });
    // SAFETY: as above.
    fill(to, bytes, 0xA5, |place| unsafe {
        __aeabi_memset(place, black_box(bytes), black_box(VALUE));
    });
    // SAFETY: as above.
    fill(to, bytes, 0, |place| unsafe {
        __aeabi_memclr(place, black_box(bytes));
    });
    3
}

fn fill(to: usize, bytes: usize, value: u8, work: impl FnOnce(*mut u8)) {
    let before = filled();
    let mut room = filled();
    work(black_box(room.0.as_mut_ptr().wrapping_add(to)));
    for (at, byte) in black_box(&room).0.iter().enumerate() {
        let inside = at.checked_sub(to).is_some_and(|offset| offset < bytes);
        let expected = if inside { value } else { before.0[at] };
        assert_eq!(*byte, expected, "{bytes} bytes at {to}: at {at}");
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    leadscrew_console::panicked(info)
}
