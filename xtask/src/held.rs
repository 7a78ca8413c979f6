//! Decides whether code only calls a function whose address it loads into a register, or also hands the address on.
//!
//! Where a function is called often in one place, the compiler loads its address once and calls through the register.
//! This module follows the register along every path through the code until it is written anew. Any use that it does
//! not understand counts as handing on.

use std::collections::{BTreeMap, BTreeSet};

use crate::stack::Code;

/// Registers that a call may change; among them those that pass arguments.
const LOST: u16 = 1 << 12 | 1 << 14 | TAKEN;
const TAKEN: u16 = 0b1111;

/// An instruction.
#[derive(Clone, Copy, Debug)]
struct Instruction {
    first: u16,
    /// 0 in a narrow instruction.
    second: u16,
    wide: bool,
    /// It may be skipped.
    conditional: bool,
}

/// Registers, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effect {
    /// Registers whose value it may use.
    pub reads: u16,
    /// Registers whose value it replaces.
    pub writes: u16,
}

/// True where the function from `start` to `end` loads the word at `literal` for calls only. `part` gives the end of a
/// part that several functions share. Such a part does not keep the rules of calls: it may use any register.
pub fn is_only_called(
    code: &Code<'_>,
    (start, end): (u64, u64),
    literal: u64,
    part: &dyn Fn(u64) -> Option<u64>,
) -> bool {
    if part(start).is_some() {
        return false;
    }
    let instructions = instructions(code, start, end);
    let mut loaded = false;
    for (at, instruction) in &instructions {
        match load(*at, *instruction) {
            Load::Word(address, register) if address == literal => {
                loaded = true;
                let behind = at + if instruction.wide { 4 } else { 2 };
                if instruction.conditional
                    || !is_held(code, &instructions, (behind, register), part)
                {
                    return false;
                }
            }
            // A load of eight bytes, or a pointer to the word.
            Load::Other(address) if literal.abs_diff(address) < 8 => return false,
            _ => {}
        }
    }
    loaded
}

fn instructions(code: &Code<'_>, start: u64, end: u64) -> BTreeMap<u64, Instruction> {
    let mut found = BTreeMap::new();
    let mut at = start;
    let mut conditional = 0_u32;
    while at < end {
        if code.is_data(at) {
            at += 2;
            continue;
        }
        let Some(first) = code.half(at) else { break };
        let wide = first >> 11 >= 0b11101;
        let second = if wide { code.half(at + 2) } else { Some(0) };
        let Some(second) = second else { break };
        let instruction = Instruction {
            first,
            second,
            wide,
            conditional: conditional > 0,
        };
        conditional = conditional.saturating_sub(1);
        // `it`: the lowest set bit ends the mask.
        if first & 0xFF00 == 0xBF00 && first & 0xF != 0 {
            conditional = 4 - (first & 0xF).trailing_zeros();
        }
        found.insert(at, instruction);
        at += if wide { 4 } else { 2 };
    }
    found
}

enum Load {
    /// Loads this word into this register.
    Word(u64, u16),
    /// Loads or points to something else at this address.
    Other(u64),
    No,
}

fn load(at: u64, instruction: Instruction) -> Load {
    let Instruction { first, second, .. } = instruction;
    let base = (at + 4) & !3;
    let (low, middle) = (u64::from(first & 0xFF), u64::from(second & 0xFFF));
    let eight = u64::from(second & 0xFF) * 4;
    match first {
        _ if !instruction.wide && first >> 11 == 0b01001 => {
            Load::Word(base + low * 4, first >> 8 & 7)
        }
        _ if !instruction.wide && first >> 11 == 0b10100 => Load::Other(base + low * 4),
        0xF8DF => Load::Word(base + middle, second >> 12),
        0xF85F => Load::Word(base.saturating_sub(middle), second >> 12),
        // ldrd, vldr
        0xE9DF | 0xED9F | 0xEDDF => Load::Other(base + eight),
        0xE95F | 0xED1F | 0xED5F => Load::Other(base.saturating_sub(eight)),
        // adr
        0xF20F | 0xF60F | 0xF2AF | 0xF6AF => {
            let top = u64::from(first >> 10 & 1) << 11;
            let offset = top | u64::from(second >> 12 & 7) << 8 | u64::from(second & 0xFF);
            if first & 0x00A0 == 0 {
                Load::Other(base + offset)
            } else {
                Load::Other(base.saturating_sub(offset))
            }
        }
        _ => Load::No,
    }
}

/// True where only calls use the register from here on, until it is written anew.
fn is_held(
    code: &Code<'_>,
    instructions: &BTreeMap<u64, Instruction>,
    (from, register): (u64, u16),
    part: &dyn Fn(u64) -> Option<u64>,
) -> bool {
    let mask = 1_u16 << register;
    let mut seen = BTreeSet::new();
    let mut open = vec![from];
    while let Some(at) = open.pop() {
        if !seen.insert(at) {
            continue;
        }
        let Some(instruction) = instructions.get(&at) else {
            // The path leaves the function, and the register still holds the address.
            return false;
        };
        let behind = at + if instruction.wide { 4 } else { 2 };
        let passed = instruction.conditional;
        match flow(code, at, *instruction) {
            Flow::Call(function) => {
                if mask & TAKEN != 0 || function.is_some_and(|at| part_uses(code, at, mask, part)) {
                    return false;
                }
                if mask & LOST == 0 || passed {
                    open.push(behind);
                }
            }
            Flow::Returns => {
                // The register is a result here, or an argument of the next function.
                if mask & TAKEN != 0 {
                    return false;
                }
                if passed {
                    open.push(behind);
                }
            }
            Flow::Unknown => return false,
            Flow::To(places) => {
                if instruction.effect().reads & mask != 0 {
                    return false;
                }
                open.extend(places);
                if passed {
                    open.push(behind);
                }
            }
            Flow::On => {
                let effect = instruction.effect();
                if effect.reads & mask != 0 {
                    return false;
                }
                if effect.writes & mask == 0 || passed {
                    open.push(behind);
                }
            }
        }
    }
    true
}

/// True where a shared part begins here that may use a register.
fn part_uses(code: &Code<'_>, start: u64, mask: u16, part: &dyn Fn(u64) -> Option<u64>) -> bool {
    let Some(end) = part(start) else {
        return false;
    };
    let is_part = |at: u64| part(at).is_some();
    instructions(code, start, end)
        .iter()
        .any(|(at, instruction)| {
            let goes_on = match flow(code, *at, *instruction) {
                Flow::Call(function) => function.is_some_and(is_part),
                Flow::To(places) => places.into_iter().any(is_part),
                Flow::On | Flow::Returns | Flow::Unknown => false,
            };
            goes_on || instruction.effect().reads & mask != 0
        })
}

enum Flow {
    /// To the next instruction.
    On,
    /// To these addresses.
    To(Vec<u64>),
    /// To a function and back; `None`: through a register.
    Call(Option<u64>),
    /// Back to the caller, or the path ends here.
    Returns,
    Unknown,
}

fn flow(code: &Code<'_>, at: u64, instruction: Instruction) -> Flow {
    let Instruction { first, second, .. } = instruction;
    let ahead = |offset: i64| (at + 4).wrapping_add_signed(offset);
    if !instruction.wide {
        return match first >> 12 {
            _ if first & 0xFF87 == 0x4780 => Flow::Call(None),
            _ if first == 0x4770 || first & 0xFF00 == 0xBD00 || first & 0xFF00 == 0xDE00 => {
                Flow::Returns
            }
            // bx, and every other write to the program counter.
            _ if first & 0xFF80 == 0x4700 || first & 0xFD87 == 0x4487 => Flow::Unknown,
            0xD if first & 0xFF00 == 0xDF00 => Flow::Unknown,
            0xD => Flow::To(vec![at + 2, ahead(signed(first & 0xFF, 8) * 2)]),
            0xE => Flow::To(vec![ahead(signed(first & 0x7FF, 11) * 2)]),
            0xB if first & 0xF500 == 0xB100 => {
                let offset = (first >> 9 & 1) << 6 | (first >> 3 & 0x1F) << 1;
                Flow::To(vec![at + 2, ahead(offset.into())])
            }
            _ => Flow::On,
        };
    }
    if first == 0xE8DF && second & 0xFFE0 == 0xF000 {
        return Flow::To(table(code, at + 4, second & 0x10 != 0));
    }
    if first >> 11 == 0b11110 && second & 0x8000 != 0 {
        return match second & 0xD000 {
            0xD000 => Flow::Call(Some(ahead(far(first, second)))),
            // A jump that the linker fills in may leave the function; then it leads to no instruction of it.
            0x9000 => Flow::To(vec![ahead(far(first, second))]),
            0x8000 if first >> 6 & 0xF < 14 => {
                let bits = (first >> 10 & 1, second >> 11 & 1, second >> 13 & 1);
                let offset = i64::from(first & 0x3F) << 12 | i64::from(second & 0x7FF) << 1;
                let offset = offset | i64::from(bits.2) << 18 | i64::from(bits.1) << 19;
                Flow::To(vec![at + 4, ahead(offset - (i64::from(bits.0) << 20))])
            }
            // msr, mrs, barriers
            _ => Flow::On,
        };
    }
    let is_load = first & 0xFE50 == 0xE810 || first & 0xFE50 == 0xE850;
    let popped = first == 0xE8BD && second & 0x8000 != 0;
    if popped || first == 0xF85D && second >> 12 == 15 {
        return Flow::Returns;
    }
    // Loads of the program counter from other memory, and tables in other memory.
    if is_load && first & 0x40 == 0 && second & 0x8000 != 0
        || first & 0xFFF0 == 0xE8D0 && second & 0xFFE0 == 0xF000
        || first & 0xFF70 == 0xF850 && second >> 12 == 15
    {
        return Flow::Unknown;
    }
    Flow::On
}

fn signed(bits: u16, width: u32) -> i64 {
    let value = i64::from(bits);
    value - ((value >> (width - 1) & 1) << width)
}

/// The distance of a wide jump.
fn far(first: u16, second: u16) -> i64 {
    let sign = first >> 10 & 1;
    let (one, two) = (1 ^ (second >> 13 & 1) ^ sign, 1 ^ (second >> 11 & 1) ^ sign);
    let low = i64::from(first & 0x3FF) << 12 | i64::from(second & 0x7FF) << 1;
    let offset = i64::from(one) << 23 | i64::from(two) << 22 | low;
    offset - (i64::from(sign) << 24)
}

/// The targets of a jump by the table that follows it.
fn table(code: &Code<'_>, base: u64, halves: bool) -> Vec<u64> {
    let mut places = Vec::new();
    let mut at = base;
    while code.is_data(at)
        && let Some(half) = code.half(at)
    {
        if halves {
            places.push(base + u64::from(half) * 2);
        } else {
            places.push(base + u64::from(half & 0xFF) * 2);
            places.push(base + u64::from(half >> 8) * 2);
        }
        at += 2;
    }
    // The padding of the table leads into the table.
    places.retain(|place| !code.is_data(*place));
    places
}

impl Instruction {
    fn effect(self) -> Effect {
        if self.wide {
            wide_effect(self.first, self.second)
        } else {
            narrow_effect(self.first)
        }
    }
}

const fn bit(register: u16) -> u16 {
    1 << (register & 0xF)
}

/// The registers of a narrow instruction, without the implied stack pointer.
fn narrow_effect(code: u16) -> Effect {
    let (zero, three, six, eight) = (
        bit(code & 7),
        bit(code >> 3 & 7),
        bit(code >> 6 & 7),
        bit(code >> 8 & 7),
    );
    let effect = |reads, writes| Effect { reads, writes };
    match code >> 11 {
        0..=2 => effect(three, zero),
        3 if code & 0x0400 == 0 => effect(three | six, zero),
        3 => effect(three, zero),
        0b00100 => effect(0, eight),
        0b00101 => effect(eight, 0),
        0b00110 | 0b00111 => effect(eight, eight),
        0b01000 if code & 0x0400 == 0 => effect(zero | three, zero),
        0b01000 => {
            let (to, from) = (bit(code & 7 | code >> 4 & 8), bit(code >> 3 & 0xF));
            match code >> 8 & 3 {
                0b10 => effect(from, to),
                _ => effect(from | to, to),
            }
        }
        0b01001 => effect(0, eight),
        0b01010 | 0b01011 if code >> 9 & 7 < 3 => effect(zero | three | six, 0),
        0b01010 | 0b01011 => effect(three | six, zero),
        0b01100..=0b10001 if code & 0x0800 == 0 => effect(zero | three, 0),
        0b01100..=0b10001 => effect(three, zero),
        0b10010 => effect(eight, 0),
        0b10011..=0b10101 => effect(0, eight),
        0b10110 | 0b10111 => match code & 0xFF00 {
            0xB400 | 0xB500 => effect(code & 0xFF, 0),
            0xBC00 | 0xBD00 => effect(0, code & 0xFF),
            0xB200 | 0xBA00 => effect(three, zero),
            0xB000 | 0xBE00 | 0xBF00 | 0xB600 => effect(0, 0),
            // cbz, cbnz
            _ => effect(zero, 0),
        },
        0b11000 => effect(eight | code & 0xFF, 0),
        0b11001 => effect(eight, code & 0xFF),
        _ => effect(0, 0),
    }
}

/// The registers of a wide instruction; in doubt a register counts as read.
pub fn wide_effect(first: u16, second: u16) -> Effect {
    let (base, twelve, eight, zero) =
        (bit(first), bit(second >> 12), bit(second >> 8), bit(second));
    let is_load = first & 0x10 != 0;
    let effect = |reads, writes| Effect { reads, writes };
    match first >> 9 {
        // ldm, stm
        0b111_0100 if first & 0x40 == 0 && is_load => effect(base, second),
        0b111_0100 if first & 0x40 == 0 => effect(base | second, 0),
        // ldrd; strd, tables, exclusive loads and stores
        0b111_0100 if first & 0x0120 != 0 && is_load => effect(base, twelve | eight),
        0b111_0100 => effect(base | twelve | eight | zero, 0),
        0b111_0101 => effect(base | zero, eight),
        // Jumps and calls: the bits of registers hold the distance.
        0b111_1000..=0b111_1011 if is_branch(first, second) => effect(0, 0),
        // Immediate operands; bfi and movt change a part of a register.
        0b111_1000..=0b111_1011 if second & 0x8000 == 0 => match first & 0xFBF0 {
            0xF240 => effect(0, eight),
            0xF360 | 0xF2C0 => effect(base | eight, 0),
            _ => effect(base, eight),
        },
        0b111_1100 => {
            let offset = if first & 0x80 == 0 && second & 0x0800 == 0 {
                zero
            } else {
                0
            };
            if is_load {
                effect(base | offset, twelve)
            } else {
                effect(base | offset | twelve, 0)
            }
        }
        0b111_1101 if first & 0x0180 == 0x0180 && first & 0x40 == 0 => {
            effect(base | zero, twelve | eight)
        }
        0b111_1101 if first & 0x0180 == 0x0180 => effect(base | zero | twelve | eight, 0),
        0b111_1101 if first & 0x0100 != 0 => effect(base | zero | twelve, eight),
        0b111_1101 => effect(base | zero, eight),
        _ => effect(base | twelve | eight | zero, 0),
    }
}

/// b.w, bl, and b.w with a condition.
const fn is_branch(first: u16, second: u16) -> bool {
    second & 0x9000 == 0x9000 || second & 0xD000 == 0x8000 && first >> 6 & 0xF < 14
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The address of a shared part: mov r0, r4; bx lr.
    const PART: u64 = 20;

    /// Code from address 0 to the literal, with data at the marked addresses.
    fn only_called(code: &[u16], marks: &[(u64, bool)]) -> bool {
        let bytes: Vec<u8> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
        let literal = bytes.len() as u64;
        let marks = [marks, &[(literal, true)]].concat();
        let bytes = [bytes.as_slice(), &[0; 4]].concat();
        let code = Code::new(0, &bytes, &marks);
        is_only_called(&code, (0, literal + 4), literal, &|at| {
            (at == PART).then_some(PART + 4)
        })
    }

    #[test]
    fn an_address_is_followed_until_its_register_is_written_anew() {
        let start = [(0, false)];
        // ldr r4, =f; blx r4; blx r4; pop {r4, pc}
        assert!(only_called(
            &[0x4C02, 0x47A0, 0x47A0, 0xBD10, 0xBF00, 0xBF00],
            &start
        ));
        // mov r0, r4; str r4, [r0]; push {r4}
        for handed_on in [0x4620, 0x6004, 0xB410] {
            let code = [0x4C02, 0x47A0, handed_on, 0xBD10, 0xBF00, 0xBF00];
            assert!(!only_called(&code, &start));
        }
        // mov r8, r4; str.w r4, [r8, #356]; mov.w r0, r4
        for (first, second) in [(0xBF00, 0x46A0), (0xF8C8, 0x4164), (0xEA4F, 0x0004)] {
            let code = [0x4C02, 0x47A0, first, second, 0xBD10, 0xBF00];
            assert!(!only_called(&code, &start));
        }
        // movs r4, #0 before mov r0, r4; the same where it may be skipped
        let anew = [0x4C02, 0x47A0, 0x2400, 0x4620, 0xBD10, 0xBF00];
        assert!(only_called(&anew, &start));
        let perhaps = [0x4C02, 0xBF08, 0x2400, 0x4620, 0xBD10, 0xBF00];
        assert!(!only_called(&perhaps, &start));
        // No instruction loads the literal.
        assert!(!only_called(&[0xBF00, 0xBD10], &start));
        // adr r0 to the literal
        assert!(!only_called(&[0x4C01, 0xA001, 0x47A0, 0xBD10], &start));
    }

    #[test]
    fn arguments_and_results_are_handed_on() {
        let start = [(0, false)];
        // ldr r0, =f; then blx r4, pop {pc}, or blx r0, which also passes r0 as an argument
        assert!(!only_called(&[0x4801, 0x47A0, 0xBD00, 0xBF00], &start));
        assert!(!only_called(&[0x4801, 0xBD00, 0xBF00, 0xBF00], &start));
        assert!(!only_called(&[0x4801, 0x4780, 0xBD00, 0xBF00], &start));
        // ldr r4, =f; nop; bl to 24, or to a shared part at 20, which uses r4 or r5; pop {r4, pc}
        let call = |second, used| {
            let end = [used, 0x4770, 0xBF00, 0xBF00];
            let code = [0x4C06, 0xBF00, 0xF000, second, 0xBD10, 0xBF00];
            [&code[..], &[0xBF00; 4], &end].concat()
        };
        assert!(only_called(&call(0xF808, 0x4620), &start));
        assert!(!only_called(&call(0xF806, 0x4620), &start));
        assert!(only_called(&call(0xF806, 0x4628), &start));
    }

    #[test]
    fn every_way_is_followed() {
        let start = [(0, false)];
        // ldr r4, =f; b 8; 4: mov r0, r4 or blx r4; pop {r4, pc}; 8: b 4
        assert!(!only_called(
            &[0x4C02, 0xE001, 0x4620, 0xBD10, 0xE7FC, 0xBF00],
            &start
        ));
        assert!(only_called(
            &[0x4C02, 0xE001, 0x47A0, 0xBD10, 0xE7FC, 0xBF00],
            &start
        ));
        // ldr r4, =f; tbb [pc, r0] to 8 and 10; 8: pop {r4, pc}; 10: mov r0, r4 or blx r4; pop {r4, pc}
        let marks = [(0, false), (6, true), (8, false)];
        let by_table = |last| [0x4C03, 0xE8DF, 0xF000, 0x0201, 0xBD10, last, 0xBD10, 0xBF00];
        assert!(!only_called(&by_table(0x4620), &marks));
        assert!(only_called(&by_table(0x47A0), &marks));
        // Out of the function: a b.w with a far target
        assert!(!only_called(&[0x4C01, 0xBF00, 0xF001, 0xB800], &start));
    }

    #[test]
    fn a_jump_uses_no_register() {
        // b.w back, bl, beq.w; msr msp, r4
        for (first, second) in [(0xF7F4, 0xBB26), (0xF004, 0xF804), (0xF004, 0x8004)] {
            assert_eq!(wide_effect(first, second), Effect::default());
        }
        assert!(wide_effect(0xF384, 0x8808).reads & 1 << 4 != 0);
    }

    #[test]
    fn jumps_go_where_they_say() {
        // b.w -8; b.w 4096
        assert_eq!(far(0xF7FF, 0xBFFC), -8);
        assert_eq!(far(0xF001, 0xB800), 4096);
        assert_eq!(signed(0x7FC, 11), -4);
    }
}
