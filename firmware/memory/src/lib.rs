#![no_std]
//! The functions that the compiler calls to copy, move, fill and compare memory, and to divide 64-bit numbers, in few
//! bytes. The compiler's own functions are made for speed and take 4.5 KiB; these take a small part of that. An image
//! links them with `use leadscrew_memory as _`.
//!
//! They are for ARMv7E-M, where a word may be read and written at any address. Aligned memory is copied sixteen bytes
//! at a time.

/// Functions in assembler. `entry` begins a function under each of its names; `ends` gives its size for each name.
macro_rules! functions {
    ($($line:literal,)*) => {
        core::arch::global_asm!(
            ".macro entry name",
            ".global \\name",
            ".type \\name, %function",
            ".thumb_func",
            "\\name:",
            ".endm",
            // A function reaches to the end of its section. Without a size no tool could tell how much stack it takes.
            ".macro ends names:vararg",
            ".irp name, \\names",
            ".size \\name, . - \\name",
            ".endr",
            ".endm",
            $($line,)*
            ".purgem entry",
            ".purgem ends",
            ".text",
        );
    };
}

mod division;

// The caller saves r0 to r3 and r12. A copy to a lower address may overlap its source: the copy runs forwards, so it
// has read each word before it writes over it.
functions!(
    // (to, from, bytes) -> to. Up to three bytes remain for the end.
    ".section .text.memcpy, \"ax\", %progbits",
    ".balign 2",
    "entry memmove",
    "entry __aeabi_memmove",
    "entry __aeabi_memmove4",
    "entry __aeabi_memmove8",
    "subs r3, r0, r1",
    "cmp r3, r2",
    "blo 5f",
    "entry memcpy",
    "entry __aeabi_memcpy",
    "entry __aeabi_memcpy4",
    "entry __aeabi_memcpy8",
    "mov r12, r0",
    // Sixteen at a time, where both addresses are aligned.
    "orr r3, r0, r1",
    "lsls r3, r3, #30",
    "bne 2f",
    "push {{r4, r5, r6}}",
    "subs r2, #16",
    "blo 1f",
    "0:",
    "ldmia r1!, {{r3, r4, r5, r6}}",
    "stmia r12!, {{r3, r4, r5, r6}}",
    "subs r2, #16",
    "bhs 0b",
    "1:",
    "adds r2, #16",
    "pop {{r4, r5, r6}}",
    // Words.
    "2:",
    "subs r2, #4",
    "blo 3f",
    "1:",
    "ldr r3, [r1], #4",
    "str r3, [r12], #4",
    "subs r2, #4",
    "bhs 1b",
    "3:",
    "adds r2, #4",
    "beq 4f",
    "1:",
    "ldrb r3, [r1], #1",
    "strb r3, [r12], #1",
    "subs r2, #1",
    "bne 1b",
    "4:",
    "bx lr",
    // The target lies above the source and overlaps it: copy from the end.
    "5:",
    "add r1, r2",
    "add r12, r0, r2",
    "subs r2, #4",
    "blo 2f",
    "1:",
    "ldr r3, [r1, #-4]!",
    "str r3, [r12, #-4]!",
    "subs r2, #4",
    "bhs 1b",
    "2:",
    "adds r2, #4",
    "beq 4b",
    "1:",
    "ldrb r3, [r1, #-1]!",
    "strb r3, [r12, #-1]!",
    "subs r2, #1",
    "bne 1b",
    "bx lr",
    "ends memmove, __aeabi_memmove, __aeabi_memmove4, __aeabi_memmove8",
    "ends memcpy, __aeabi_memcpy, __aeabi_memcpy4, __aeabi_memcpy8",
    // (to, bytes)
    ".section .text.memset, \"ax\", %progbits",
    ".balign 2",
    "entry __aeabi_memclr",
    "entry __aeabi_memclr4",
    "entry __aeabi_memclr8",
    "movs r2, #0",
    // (to, bytes, value)
    "entry __aeabi_memset",
    "entry __aeabi_memset4",
    "entry __aeabi_memset8",
    "mov r3, r1",
    "mov r1, r2",
    "mov r2, r3",
    // (to, value, bytes) -> to
    "entry memset",
    "mov r12, r0",
    "uxtb r1, r1",
    "orr r1, r1, r1, lsl #8",
    "orr r1, r1, r1, lsl #16",
    "subs r2, #4",
    "blo 2f",
    "1:",
    "str r1, [r12], #4",
    "subs r2, #4",
    "bhs 1b",
    "2:",
    "adds r2, #4",
    "beq 3f",
    "1:",
    "strb r1, [r12], #1",
    "subs r2, #1",
    "bne 1b",
    "3:",
    "bx lr",
    "ends __aeabi_memclr, __aeabi_memclr4, __aeabi_memclr8",
    "ends __aeabi_memset, __aeabi_memset4, __aeabi_memset8, memset",
    // (one, other, bytes) -> below, at or above zero, as the first byte that differs is
    ".section .text.memcmp, \"ax\", %progbits",
    ".balign 2",
    "entry memcmp",
    "mov r12, r0",
    "movs r0, #0",
    "1:",
    "subs r2, #1",
    "blo 2f",
    "ldrb r0, [r12], #1",
    "ldrb r3, [r1], #1",
    "subs r0, r0, r3",
    "beq 1b",
    "2:",
    "bx lr",
    "ends memcmp",
);
