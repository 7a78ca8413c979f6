//! How deep the stack of an image can get: a bound, read from the image itself.
//!
//! A function takes the sum of everything in its code that lowers the stack pointer. Its relocations show its calls
//! (the linker kept them in the image). A call through a pointer may reach every function whose address stands in a
//! table or is handed on by code. A function that sets the stack pointer anew ends its path. The functions that the
//! processor calls are known by name; no other function is a handler. So the bound holds whatever the program does, and
//! may be more than it ever uses.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind};

use crate::callgraph::{self, Node, Target};
use crate::held;

/// The bytes that the processor stores at an interrupt: with floating-point registers, and aligned.
const INTERRUPTED: u64 = 104 + 4;

/// The deepest path of calls from a function.
#[derive(Clone, Debug, Default)]
pub struct Deepest {
    /// Bytes.
    pub bytes: u64,
    /// The functions of the path, each with its own bytes.
    pub way: Vec<(String, u64)>,
}

/// The users of a stack: one thread, which starts with a function of its own, and interrupts. Each interrupt may
/// interrupt all users named before it.
pub struct Users {
    /// The main function of the thread.
    pub thread: &'static str,
    /// The function of the thread that runs while interrupts are masked.
    pub start: &'static str,
    /// The handlers of interrupts.
    pub interrupts: &'static [&'static str],
    /// Handlers that nothing masks.
    pub always: &'static [&'static str],
    /// Handlers that end the run: they begin with an empty stack, or do not use it.
    pub ends: &'static [&'static str],
}

/// The depth of an image's stack, and the depth of each user.
pub fn deepest(image: &Path, users: &Users) -> Result<(u64, Vec<Deepest>)> {
    let mut stacks = Stacks::read(image)?;
    let start = stacks.address(users.start)?;
    let thread = stacks.address(users.thread)?;
    stacks.known_handlers(users)?;
    let mut whole = stacks.from(thread, &mut Vec::new())?;
    stacks.known = HashMap::from([(start, Deepest::default())]);
    let mut parts = vec![stacks.from(thread, &mut Vec::new())?];
    let mut bytes: u64 = parts.iter().map(|part| part.bytes).sum();
    for name in users.interrupts.iter().chain(users.always) {
        let handler = stacks.address(name)?;
        let part = stacks.from(handler, &mut Vec::new())?;
        bytes += part.bytes + INTERRUPTED;
        if users.always.contains(name) {
            whole.bytes += part.bytes + INTERRUPTED;
            whole.way.push(((*name).into(), part.bytes + INTERRUPTED));
        }
        parts.push(part);
    }
    parts.push(whole.clone());
    Ok((bytes.max(whole.bytes), parts))
}

/// The ways by which the functions named may get into code from the address `bank` on: the calls of each, first to last.
pub fn ways_into(image: &Path, bank: u64, from: &[&str]) -> Result<Vec<Vec<String>>> {
    let stacks = Stacks::read(image)?;
    let mut called_by: HashMap<u64, Option<u64>> = HashMap::new();
    let mut queue = VecDeque::new();
    for name in from {
        let start = stacks.address(name)?;
        called_by.insert(start, None);
        queue.push_back(start);
    }
    let mut ways = Vec::new();
    while let Some(here) = queue.pop_front() {
        if here >= bank {
            ways.push(stacks.way(here, &called_by));
            continue;
        }
        for callee in stacks.called(here) {
            if let Entry::Vacant(vacant) = called_by.entry(callee) {
                vacant.insert(Some(here));
                queue.push_back(callee);
            }
        }
    }
    Ok(ways)
}

/// The effect of a function on the stack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Frame {
    bytes: u64,
    /// It calls through a register.
    indirect: bool,
    /// It empties the stack: its calls begin with an empty one.
    empties: bool,
}

/// The functions of an image, and their calls.
struct Stacks {
    nodes: BTreeMap<u64, Node>,
    frames: HashMap<u64, Frame>,
    calls: HashMap<u64, BTreeSet<u64>>,
    /// Functions whose address stands in a table or is handed on by code.
    listed: BTreeSet<u64>,
    /// Functions that the processor calls.
    handlers: BTreeSet<u64>,
    known: HashMap<u64, Deepest>,
}

impl Stacks {
    fn read(image: &Path) -> Result<Self> {
        let data =
            std::fs::read(image).with_context(|| format!("cannot read {}", image.display()))?;
        let file = object::File::parse(data.as_slice())?;
        let nodes = callgraph::nodes(&file);
        let marks = marks(&file);
        let mut codes = Vec::new();
        for section in file.sections() {
            if section.kind() == SectionKind::Text {
                codes.push(Code::new(section.address(), section.data()?, &marks));
            }
        }
        let mut frames = HashMap::new();
        for code in &codes {
            for (start, node) in &nodes {
                if let Some(frame) = code.frame(*start, node.end)? {
                    frames.insert(*start, frame);
                }
            }
        }
        let mut stacks = Self {
            nodes,
            frames,
            calls: HashMap::new(),
            listed: BTreeSet::new(),
            handlers: BTreeSet::new(),
            known: HashMap::new(),
        };
        let targets = callgraph::targets(&file);
        if targets.is_empty() {
            bail!("{}: linked without its relocations", image.display());
        }
        for target in targets {
            stacks.refer(&target, &codes)?;
        }
        Ok(stacks)
    }

    /// Notes the call or the address that this reference is.
    fn refer(&mut self, target: &Target, codes: &[Code<'_>]) -> Result<()> {
        let Target { at, to, is_jump } = *target;
        if !self.frames.contains_key(&to) {
            let is_code = codes.iter().any(|code| code.half(to).is_some());
            if is_code {
                bail!("at {at:#x}: {to:#x} is no function whose size is known");
            }
            return Ok(());
        }
        let within = callgraph::within(&self.nodes, at);
        if let Some(from) = within.filter(|from| self.frames.contains_key(from)) {
            self.calls.entry(from).or_default().insert(to);
            let end = self.nodes.get(&from).map_or(from, |node| node.end);
            let is_called = |code: &Code<'_>| {
                let part = |at| self.part(at);
                code.half(from).is_some() && held::is_only_called(code, (from, end), at, &part)
            };
            if !is_jump && !codes.iter().any(is_called) {
                self.listed.insert(to);
            }
        } else if codes.iter().any(|code| code.half(at).is_some()) && is_jump {
            bail!("at {at:#x}: a call from where no function is whose size is known");
        } else if within
            .and_then(|table| self.nodes.get(&table))
            .is_some_and(|table| VECTORS.contains(&table.name.as_str()))
        {
            self.handlers.insert(to);
        } else {
            self.listed.insert(to);
        }
        Ok(())
    }

    /// Complains about a handler that is not among the users of the stack.
    fn known_handlers(&self, users: &Users) -> Result<()> {
        let named = [users.interrupts, users.always, users.ends].concat();
        for handler in &self.handlers {
            let name = self.nodes.get(handler).map_or("?", |node| &node.name);
            if !named.contains(&name) {
                bail!(
                    "the processor may call `{name}`, which is not among those that use the stack"
                );
            }
        }
        Ok(())
    }

    /// The end of a part that several functions share and the compiler has moved out of them.
    fn part(&self, at: u64) -> Option<u64> {
        let node = self.nodes.get(&at)?;
        let is_part = node.name.starts_with("OUTLINED_FUNCTION");
        is_part.then_some(node.end)
    }

    /// The address of the function with this name.
    fn address(&self, name: &str) -> Result<u64> {
        self.nodes
            .iter()
            .find(|(address, node)| self.frames.contains_key(address) && node.name == name)
            .map(|(address, _)| *address)
            .ok_or_else(|| anyhow!("no function is called `{name}`"))
    }

    /// The functions that a function may call.
    fn called(&self, function: u64) -> BTreeSet<u64> {
        let mut called = self.calls.get(&function).cloned().unwrap_or_default();
        if self
            .frames
            .get(&function)
            .is_some_and(|frame| frame.indirect)
        {
            called.extend(&self.listed);
        }
        called
    }

    /// The names on the way to a function.
    fn way(&self, to: u64, called_by: &HashMap<u64, Option<u64>>) -> Vec<String> {
        let mut way = Vec::new();
        let mut here = Some(to);
        while let Some(function) = here {
            let name = self.nodes.get(&function).map_or("?", |node| &node.name);
            way.insert(0, name.to_owned());
            here = called_by.get(&function).copied().flatten();
        }
        way
    }

    fn from(&mut self, start: u64, above: &mut Vec<u64>) -> Result<Deepest> {
        if let Some(known) = self.known.get(&start) {
            return Ok(known.clone());
        }
        let name = self
            .nodes
            .get(&start)
            .map_or_else(String::new, |node| node.name.clone());
        if above.contains(&start) {
            bail!("`{name}` may call itself: its stack has no bound");
        }
        above.push(start);
        let frame = self.frames.get(&start).copied().unwrap_or_default();
        let called = if frame.empties {
            BTreeSet::new()
        } else {
            self.called(start)
        };
        let mut deepest = Deepest::default();
        for callee in called {
            let way = self.from(callee, above)?;
            if way.bytes > deepest.bytes {
                deepest = way;
            }
        }
        above.pop();
        deepest.bytes += frame.bytes;
        deepest.way.insert(0, (name, frame.bytes));
        self.known.insert(start, deepest.clone());
        Ok(deepest)
    }
}

/// Tables of handlers: only the processor calls their entries.
const VECTORS: [&str; 3] = ["__EXCEPTIONS", "__INTERRUPTS", "__RESET_VECTOR"];

/// The addresses where instructions (false) and data between them (true) begin.
fn marks(file: &object::File) -> Vec<(u64, bool)> {
    let mut marks: Vec<(u64, bool)> = file
        .symbols()
        .filter_map(|symbol| {
            let name = symbol.name().ok()?;
            let is = |mark: &str| name == mark || name.starts_with(&format!("{mark}."));
            (is("$t") || is("$d")).then(|| (symbol.address(), is("$d")))
        })
        .collect();
    marks.sort_unstable();
    marks
}

/// A section of code.
pub struct Code<'a> {
    base: u64,
    bytes: &'a [u8],
    /// The [`marks`] of the image.
    marks: &'a [(u64, bool)],
}

impl<'a> Code<'a> {
    /// A section from the address `base` on, with the [`marks`] of the image.
    pub const fn new(base: u64, bytes: &'a [u8], marks: &'a [(u64, bool)]) -> Self {
        Self { base, bytes, marks }
    }

    /// True for data between instructions.
    pub fn is_data(&self, address: u64) -> bool {
        let next = self.marks.partition_point(|(at, _)| *at <= address);
        next.checked_sub(1)
            .and_then(|at| self.marks.get(at))
            .is_some_and(|(_, data)| *data)
    }

    /// Two bytes of the section.
    pub fn half(&self, address: u64) -> Option<u16> {
        let at = usize::try_from(address.checked_sub(self.base)?).ok()?;
        let pair = self.bytes.get(at..at.checked_add(2)?)?;
        Some(u16::from_le_bytes(pair.try_into().ok()?))
    }

    /// The frame of a function; `None` for a function of another section.
    fn frame(&self, start: u64, end: u64) -> Result<Option<Frame>> {
        if self.half(start).is_none() {
            return Ok(None);
        }
        let mut frame = Frame::default();
        let mut at = start;
        while at < end {
            if self.is_data(at) {
                at += 2;
                continue;
            }
            let first = self
                .half(at)
                .context("a function ends behind its section")?;
            let wide = first >> 11 >= 0b11101;
            let second = if wide {
                self.half(at + 2).context("half an instruction")?
            } else {
                0
            };
            let lowered = if wide {
                wide_lowers(first, second)
            } else {
                narrow_lowers(first)
            };
            let Some(lowered) = lowered else {
                bail!("at {at:#x} the stack is lowered by what a register says");
            };
            frame.bytes += lowered;
            frame.indirect |= !wide && is_indirect(first);
            frame.empties |= wide && is_new_stack(first, second);
            at += if wide { 4 } else { 2 };
        }
        Ok(Some(frame))
    }
}

/// `blx` through a register, or `bx` through any register other than the return address.
const fn is_indirect(code: u16) -> bool {
    code & 0xFF87 == 0x4780 || code & 0xFF87 == 0x4700 && code != 0x4770
}

/// `msr msp`: the stack pointer is set anew.
const fn is_new_stack(first: u16, second: u16) -> bool {
    first & 0xFFF0 == 0xF380 && second == 0x8808
}

/// The number of bytes by which an instruction lowers the stack pointer; `None` where a register decides.
fn narrow_lowers(code: u16) -> Option<u64> {
    if code & 0xFE00 == 0xB400 {
        // push
        return Some(4 * u64::from((code & 0x1FF).count_ones()));
    }
    if code & 0xFF80 == 0xB080 {
        // sub sp, #
        return Some(4 * u64::from(code & 0x7F));
    }
    if code & 0xFF87 == 0x4685 || code & 0xFF87 == 0x4485 {
        // mov sp, register; add sp, register
        return None;
    }
    Some(0)
}

fn wide_lowers(first: u16, second: u16) -> Option<u64> {
    let byte = u64::from(second & 0xFF);
    match (first, second) {
        // stmdb sp!
        (0xE92D, list) => Some(4 * u64::from(list.count_ones())),
        // str, strd: the stack pointer is lowered before the store
        (0xF84D, how) if how & 0x0F00 == 0x0D00 => Some(byte),
        (0xE96D, _) => Some(4 * byte),
        // vpush
        (0xED2D | 0xED6D, how) if how & 0x0E00 == 0x0A00 => Some(4 * byte),
        // sub.w sp, sp, #
        (0xF1AD | 0xF5AD | 0xF1BD | 0xF5BD, how) if how & 0x8F00 == 0x0D00 => {
            Some(expand(immediate(first, second)))
        }
        // subw sp, sp, #
        (0xF2AD | 0xF6AD, how) if how & 0x8F00 == 0x0D00 => {
            Some(u64::from(immediate(first, second)))
        }
        // sub sp, sp, register
        (0xEBAD | 0xEBBD, how) if how & 0x0F00 == 0x0D00 => None,
        // add.w sp, sp, #; addw sp, sp, #
        (0xF10D | 0xF50D | 0xF20D | 0xF60D, how) if how & 0x8F00 == 0x0D00 => Some(0),
        _ if is_from_elsewhere(first, second) => None,
        _ => Some(0),
    }
}

/// True where the stack pointer gets a value from another register or from memory.
fn is_from_elsewhere(first: u16, second: u16) -> bool {
    held::wide_effect(first, second).writes & 1 << 13 != 0
}

/// The twelve bits of an immediate, which are in three places.
fn immediate(first: u16, second: u16) -> u32 {
    let (top, middle, low) = (first >> 10 & 1, second >> 12 & 7, second & 0xFF);
    u32::from(top) << 11 | u32::from(middle) << 8 | u32::from(low)
}

/// The value of a modified immediate constant.
fn expand(bits: u32) -> u64 {
    let byte = bits & 0xFF;
    u64::from(match bits >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | bits & 0x7F).rotate_right(bits >> 7),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_lower_the_stack_by_what_they_say() {
        // push {r4, r5, r6, r7, lr}; sub sp, #16; add sp, #16; pop {r7, pc}
        assert_eq!(narrow_lowers(0xB5F0), Some(20));
        assert_eq!(narrow_lowers(0xB084), Some(16));
        assert_eq!(narrow_lowers(0xB004), Some(0));
        assert_eq!(narrow_lowers(0xBD80), Some(0));
        // mov sp, r4; add sp, r4; mov r5, sp
        assert_eq!(narrow_lowers(0x46A5), None);
        assert_eq!(narrow_lowers(0x44A5), None);
        assert_eq!(narrow_lowers(0x466D), Some(0));
        // push.w {r8, r9, r10, r11}; str r11, [sp, #-4]!; strd r6, r7, [sp, #-16]!; vpush {d8, d9}
        assert_eq!(wide_lowers(0xE92D, 0x0F00), Some(16));
        assert_eq!(wide_lowers(0xF84D, 0xBD04), Some(4));
        assert_eq!(wide_lowers(0xE96D, 0x6704), Some(16));
        assert_eq!(wide_lowers(0xED2D, 0x8B04), Some(16));
        // sub.w sp, sp, #4096; subw sp, sp, #1028; sub.w sp, sp, #592; sub.w sp, sp, r3
        assert_eq!(wide_lowers(0xF5AD, 0x5D80), Some(4096));
        assert_eq!(wide_lowers(0xF2AD, 0x4D04), Some(1028));
        assert_eq!(wide_lowers(0xF5AD, 0x7D14), Some(592));
        assert_eq!(wide_lowers(0xEBAD, 0x0D03), None);
        // mov.w sp, r4; add.w sp, r7, #8; ldr.w sp, [r0]; add.w sp, sp, #592
        assert_eq!(wide_lowers(0xEA4F, 0x0D04), None);
        assert_eq!(wide_lowers(0xF107, 0x0D08), None);
        assert_eq!(wide_lowers(0xF8D0, 0xD000), None);
        assert_eq!(wide_lowers(0xF50D, 0x7D14), Some(0));
    }

    /// Functions 0 to 3 with their calls. They take 8, 16, 32 and 64 bytes.
    fn stacks(calls: &[(u64, u64)]) -> Stacks {
        let numbers = 0..4_u64;
        let node = |number: u64| Node {
            name: number.to_string(),
            end: number + 1,
        };
        let frame = |number: u64| Frame {
            bytes: 8 << number,
            ..Frame::default()
        };
        let mut called: HashMap<u64, BTreeSet<u64>> = HashMap::new();
        for (from, to) in calls {
            called.entry(*from).or_default().insert(*to);
        }
        Stacks {
            nodes: numbers.clone().map(|n| (n, node(n))).collect(),
            frames: numbers.map(|n| (n, frame(n))).collect(),
            calls: called,
            listed: BTreeSet::new(),
            handlers: BTreeSet::new(),
            known: HashMap::new(),
        }
    }

    fn depth(mut stacks: Stacks) -> Result<u64> {
        Ok(stacks.from(0, &mut Vec::new())?.bytes)
    }

    #[test]
    fn the_deepest_way_counts() {
        assert_eq!(depth(stacks(&[])).unwrap(), 8);
        let two_ways = [(0, 1), (1, 2), (0, 2), (0, 3)];
        assert_eq!(depth(stacks(&two_ways)).unwrap(), 8 + 64);
        let mut by_pointer = stacks(&[(0, 1)]);
        by_pointer.listed.insert(2);
        by_pointer.frames.get_mut(&1).unwrap().indirect = true;
        assert_eq!(depth(by_pointer).unwrap(), 8 + 16 + 32);
        let mut anew = stacks(&[(0, 1), (1, 3)]);
        anew.frames.get_mut(&1).unwrap().empties = true;
        assert_eq!(depth(anew).unwrap(), 8 + 16);
    }

    #[test]
    fn an_address_that_is_handed_on_may_be_called_by_anybody() {
        let target = |at, to, is_jump| Target { at, to, is_jump };
        let mut stacks = stacks(&[(0, 1)]);
        stacks.refer(&target(0, 2, true), &[]).unwrap();
        assert!(stacks.listed.is_empty());
        stacks.refer(&target(0, 2, false), &[]).unwrap();
        stacks.refer(&target(9, 3, false), &[]).unwrap();
        assert_eq!(stacks.listed, BTreeSet::from([2, 3]));
        assert_eq!(stacks.calls[&0], BTreeSet::from([1, 2]));
        // 0 hands 2 to 1, which calls through a pointer: the stack holds all three, or 3 in place of 2.
        stacks.frames.get_mut(&1).unwrap().indirect = true;
        assert_eq!(depth(stacks).unwrap(), 8 + 16 + 64);
    }

    #[test]
    fn code_of_unknown_size_is_complained_of() {
        let code = [Code::new(0, &[0; 8], &[])];
        for is_jump in [true, false] {
            let into = |at, to| stacks(&[]).refer(&Target { at, to, is_jump }, &code);
            assert!(into(0, 6).is_err());
            assert!(into(0, 8).is_ok(), "not code");
            assert_eq!(into(6, 0).is_err(), is_jump);
        }
    }

    #[test]
    fn the_processor_calls_nobody_unknown() {
        let mut users = Users {
            thread: "0",
            start: "1",
            interrupts: &["2"],
            always: &[],
            ends: &[],
        };
        let mut stacks = stacks(&[]);
        stacks.handlers = BTreeSet::from([2, 3]);
        let complaint = stacks.known_handlers(&users).unwrap_err().to_string();
        assert!(complaint.contains("`3`"));
        users.ends = &["3"];
        assert!(stacks.known_handlers(&users).is_ok());
    }

    #[test]
    fn what_may_call_itself_has_no_bound() {
        let around = depth(stacks(&[(0, 1), (1, 2), (2, 1)]));
        assert!(around.unwrap_err().to_string().contains("`1`"));
    }

    #[test]
    fn calls_through_a_pointer_are_told_from_returns() {
        // blx r3; bx r12; bx lr
        assert!(is_indirect(0x4798) && is_indirect(0x4760));
        assert!(!is_indirect(0x4770));
        // msr msp, r1; msr psp, r1
        assert!(is_new_stack(0xF381, 0x8808) && !is_new_stack(0xF381, 0x8809));
    }
}
