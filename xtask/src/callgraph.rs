//! The paths to a panic, read from an image that was linked with its relocations kept.
//!
//! Every call and every address taken is a relocation. So functions and their references form a graph, and no
//! instruction has to be decoded. The debug information gives file and line of each call.

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};
use std::path::Path;

use addr2line::gimli::{Dwarf, EndianSlice, LittleEndian, SectionId};
use anyhow::{Context, Result};
use object::{
    Object, ObjectSection, ObjectSymbol, RelocationFlags, RelocationTarget, SectionFlags,
    SymbolKind,
};

/// A function or a table.
pub struct Node {
    /// Its name.
    pub name: String,
    /// The address after its end.
    pub end: u64,
}

/// One reference from a function (or table) to another.
struct Reference {
    from: u64,
    to: u64,
    at: u64,
}

/// Gives one line for each place outside the standard library from which a panic can be reached, and the path to it.
pub fn ways_to_panic(image: &Path) -> Result<Vec<String>> {
    let data = std::fs::read(image).with_context(|| format!("cannot read {}", image.display()))?;
    let file = object::File::parse(data.as_slice())?;
    let nodes = nodes(&file);
    let references = references(&file, &nodes);

    let mut callers: HashMap<u64, Vec<&Reference>> = HashMap::new();
    for reference in &references {
        callers.entry(reference.to).or_default().push(reference);
    }
    let mut panics: VecDeque<u64> = nodes
        .iter()
        .filter(|(_, node)| is_panic(&node.name))
        .map(|(address, _)| *address)
        .collect();
    let mut seen: BTreeSet<u64> = panics.iter().copied().collect();
    let mut sites = BTreeMap::new();
    while let Some(panic) = panics.pop_front() {
        for reference in callers.get(&panic).into_iter().flatten() {
            let Some(caller) = nodes.get(&reference.from) else {
                continue;
            };
            // The library's own helpers are not the fault's origin: go on to their callers.
            if is_panic(&caller.name) || caller.name.starts_with("core::") {
                if seen.insert(reference.from) {
                    panics.push_back(reference.from);
                }
            } else {
                sites.insert(reference.at, (reference.from, panic));
            }
        }
    }

    let dwarf = Dwarf::load(|id: SectionId| {
        let section = file
            .section_by_name(id.name())
            .and_then(|section| section.data().ok())
            .unwrap_or(&[]);
        Ok::<_, addr2line::gimli::Error>(EndianSlice::new(section, LittleEndian))
    })?;
    let lines = addr2line::Context::from_dwarf(dwarf)?;
    let root = crate::run::root();
    let mut ways = BTreeSet::new();
    for (at, (function, panic)) in sites {
        let name = |address: &u64| nodes.get(address).map_or("?", |node| node.name.as_str());
        let mut places = Vec::new();
        let mut frames = lines.find_frames(at).skip_all_loads()?;
        while let Some(frame) = frames.next()? {
            let Some(location) = frame.location else {
                continue;
            };
            let (Some(file), Some(line)) = (location.file, location.line) else {
                continue;
            };
            if !file.contains("rustc/") && !file.contains("rustlib/") {
                let file = Path::new(file);
                let file = file.strip_prefix(&root).unwrap_or(file);
                places.push(format!("{}:{line}", file.display()));
            }
        }
        if places.is_empty() {
            places.push("(several places that the optimiser has made one)".into());
        }
        let way: Vec<&str> = way_from_entry(function, &callers, &nodes)
            .iter()
            .map(name)
            .collect();
        ways.insert(format!(
            "{}\n    {}\n    reached by {}",
            places.join(" in "),
            name(&panic),
            way.join(" > ")
        ));
    }
    Ok(ways.into_iter().collect())
}

fn is_panic(name: &str) -> bool {
    name.contains("rust_begin_unwind") || name.starts_with("core::panicking::")
}

/// Functions and tables by address. The symbol of a Thumb function has bit 0 set; this bit is not part of the address.
pub fn nodes(file: &object::File) -> BTreeMap<u64, Node> {
    file.symbols()
        .filter(|symbol| {
            matches!(symbol.kind(), SymbolKind::Text | SymbolKind::Data) && symbol.size() > 0
        })
        .map(|symbol| {
            let address = symbol.address() & !1;
            let name = format!(
                "{:#}",
                rustc_demangle::demangle(symbol.name().unwrap_or("?"))
            );
            (
                address,
                Node {
                    name,
                    end: address.saturating_add(symbol.size()),
                },
            )
        })
        .collect()
}

fn references(file: &object::File, nodes: &BTreeMap<u64, Node>) -> Vec<Reference> {
    let within = |Target { at, to, .. }| {
        let (from, to) = (within(nodes, at)?, within(nodes, to)?);
        Some(Reference { from, to, at })
    };
    targets(file).into_iter().filter_map(within).collect()
}

/// Symbols of the linker's script for the limits of a section: no code goes there.
const BOUNDS: [&str; 2] = ["__panicking_start", "__panicking_end"];

/// A reference from code or data of the image to an address.
pub struct Target {
    /// The address of the reference.
    pub at: u64,
    /// The address that it refers to.
    pub to: u64,
    /// True for an instruction that jumps there; false for a value.
    pub is_jump: bool,
}

/// All references of an image.
pub fn targets(file: &object::File) -> Vec<Target> {
    let mut found = Vec::new();
    for section in file.sections() {
        let is_loaded = matches!(section.flags(), SectionFlags::Elf { sh_flags, .. }
            if sh_flags.0 & object::elf::SHF_ALLOC.0 != 0);
        if !is_loaded {
            continue;
        }
        for (at, relocation) in section.relocations() {
            let RelocationTarget::Symbol(index) = relocation.target() else {
                continue;
            };
            if let Ok(symbol) = file.symbol_by_index(index)
                && !symbol.name().is_ok_and(|name| BOUNDS.contains(&name))
            {
                found.push(Target {
                    at,
                    to: symbol.address() & !1,
                    is_jump: is_jump(&relocation),
                });
            }
        }
    }
    found
}

/// True for an instruction that jumps to its target: `bl`, `b`.
fn is_jump(relocation: &object::Relocation) -> bool {
    use object::elf::{
        R_ARM_THM_JUMP6, R_ARM_THM_JUMP19, R_ARM_THM_JUMP24, R_ARM_THM_PC8, R_ARM_THM_PC11,
        R_ARM_THM_PC22,
    };
    let RelocationFlags::Elf { r_type } = relocation.flags() else {
        return false;
    };
    [
        R_ARM_THM_PC22,
        R_ARM_THM_JUMP24,
        R_ARM_THM_JUMP19,
        R_ARM_THM_JUMP6,
        R_ARM_THM_PC11,
        R_ARM_THM_PC8,
    ]
    .contains(&r_type)
}

/// The node that contains `address`.
pub fn within(nodes: &BTreeMap<u64, Node>, address: u64) -> Option<u64> {
    let (start, node) = nodes.range(..=address).next_back()?;
    (address < node.end).then_some(*start)
}

/// The shortest chain from an entry of the image to `function`.
fn way_from_entry(
    function: u64,
    callers: &HashMap<u64, Vec<&Reference>>,
    nodes: &BTreeMap<u64, Node>,
) -> Vec<u64> {
    let mut next: HashMap<u64, Option<u64>> = HashMap::from([(function, None)]);
    let mut queue = VecDeque::from([function]);
    while let Some(here) = queue.pop_front() {
        if nodes
            .get(&here)
            .is_some_and(|node| node.name.contains("entries::"))
        {
            let mut way = vec![here];
            while let Some(Some(step)) = way.last().and_then(|last| next.get(last)) {
                way.push(*step);
            }
            return way;
        }
        for reference in callers.get(&here).into_iter().flatten() {
            if let std::collections::hash_map::Entry::Vacant(vacant) = next.entry(reference.from) {
                vacant.insert(Some(here));
                queue.push_back(reference.from);
            }
        }
    }
    vec![function]
}
