//! Lets user-mode Linux 6.1 run on processors with larger registers than it knows.
//!
//! That kernel runs its processes under `ptrace` and sets their floating-point registers from a buffer of a fixed size.
//! The host takes a whole set or none; on a processor with matrix registers (Intel AMX) a whole set is larger than the
//! buffer, so the first process of the kernel ends with `put_fp_registers`. This library, loaded ahead of the C library,
//! fills up what such a call leaves out with what the registers hold. Every other call passes unchanged.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

use std::mem::transmute;
use std::sync::OnceLock;

use libc::{RTLD_NEXT, c_int, c_long, c_void, dlsym, iovec};

/// `PTRACE_GETREGSET`, `PTRACE_SETREGSET` and `NT_X86_XSTATE` of the kernel's headers.
const GET_REGISTERS: c_long = 0x4204;
const SET_REGISTERS: c_long = 0x4205;
const EXTENDED_STATE: usize = 0x202;
/// More than the registers of any processor take.
const ROOM: usize = 64 * 1024;

type Ptrace = unsafe extern "C" fn(c_long, c_int, *mut c_void, *mut c_void) -> c_long;

/// The C library's.
fn real() -> Ptrace {
    static REAL: OnceLock<usize> = OnceLock::new();
    let address = *REAL.get_or_init(|| {
        // SAFETY: the name ends with a zero; the C library that this program is linked to has the function.
        unsafe { dlsym(RTLD_NEXT, c"ptrace".as_ptr()) as usize }
    });
    // SAFETY: the function takes these four, whatever the request, and gives that.
    unsafe { transmute::<usize, Ptrace>(address) }
}

/// As the C library's `ptrace`; a set of extended registers that is too short is filled up.
///
/// # Safety
/// As for the C library's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ptrace(
    request: c_long,
    process: c_int,
    address: *mut c_void,
    data: *mut c_void,
) -> c_long {
    let real = real();
    if request == SET_REGISTERS && address as usize == EXTENDED_STATE && !data.is_null() {
        // SAFETY: this request is handed an `iovec`, by its own contract.
        let given = unsafe { data.cast::<iovec>().read() };
        let mut whole = vec![0_u64; ROOM / 8];
        let mut all = iovec {
            iov_base: whole.as_mut_ptr().cast(),
            iov_len: ROOM,
        };
        let into: *mut c_void = (&raw mut all).cast();
        // SAFETY: the vector has the room that the `iovec` says.
        let got = unsafe { real(GET_REGISTERS, process, address, into) };
        if got == 0 && given.iov_len < all.iov_len {
            // SAFETY: the caller's buffer holds what its `iovec` says, which is less than the vector has.
            unsafe {
                std::ptr::copy_nonoverlapping(
                    given.iov_base.cast::<u8>(),
                    whole.as_mut_ptr().cast::<u8>(),
                    given.iov_len,
                );
            }
            // SAFETY: as above.
            return unsafe { real(request, process, address, into) };
        }
    }
    // SAFETY: what the caller has handed over, unchanged.
    unsafe { real(request, process, address, data) }
}
