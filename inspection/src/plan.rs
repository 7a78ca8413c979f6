//! The threads of a program, and which of its moves cut them.

use leadscrew_core::call::{Aux, Call, CallKind, Position, ThreadCall, ThreadCycle};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::units::{LeadChange, Length, StartAngle};
use leadscrew_metrology::{Degrees, Designation, Limits, Mm, Nose, NotKnown, Side, Stock, Tool};

use crate::guess::{Traits, free, guess};
use crate::{Assumed, Edge, Job};

/// What a person says of the threads.
#[derive(Clone, Debug, Default)]
pub struct Wish {
    /// Names: one for all threads, or one for each.
    pub threads: Vec<String>,
    /// Edges of tools.
    pub tools: Vec<Edge>,
    /// Diameter of the surface before the cut.
    pub surface: Option<Mm>,
    /// Z of the face in work coordinates.
    pub face: Option<Mm>,
    /// What the program declares.
    pub stock: Option<Declared>,
}

/// A bar or a tube before the first cut, as a program declares it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Declared {
    /// Diameter outside.
    pub outside: Mm,
    /// Diameter of the hole that is there already; 0 where there is none.
    pub bore: Mm,
    /// Z of its face in work coordinates.
    pub face: Mm,
}

impl Declared {
    /// From nanometres: two radii, and a Z.
    #[must_use]
    pub fn new(outside: i64, bore: i64, face: i64) -> Self {
        let mm = |nm: i64| nm as f64 / 1e6;
        Self {
            outside: Mm(2.0 * mm(outside)),
            bore: Mm(2.0 * mm(bore)),
            face: Mm(mm(face)),
        }
    }
}

impl Wish {
    /// Z of the face, typed or declared.
    fn known_face(&self) -> Option<f64> {
        let declared = || self.stock.map(|stock| stock.face);
        self.face.or_else(declared).map(|face| face.0)
    }

    /// A diameter that nobody has said, where the stock has material.
    fn within_stock(&self, side: Side, diameter: Mm) -> Mm {
        match (self.stock, side) {
            (Some(stock), Side::External) => Mm(diameter.0.min(stock.outside.0)),
            (Some(stock), Side::Internal) => Mm(diameter.0.max(stock.bore.0)),
            (None, _) => diameter,
        }
    }
}

/// The threads of a program, each kind in order.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Those along Z.
    pub jobs: Vec<Job>,
    /// Those along X, which are not measured.
    pub along_x: Vec<Flat>,
}

/// A thread along X: a scroll on a face.
#[derive(Clone, Debug)]
pub struct Flat {
    /// The edge that cuts it.
    pub tool: Tool,
    /// Its number, 0 where the program has named none.
    pub tool_number: u32,
    /// Z of the face before the cut on the axis, and its change per millimetre of radius.
    pub surface: (Mm, f64),
    /// Its moves: first, last, pass.
    pub passes: Vec<(u64, u64, u32)>,
    /// What had to be assumed.
    pub assumed: Assumed,
}

/// A thread as the text has it.
#[derive(Clone, Debug)]
struct Found {
    line: u32,
    /// It goes along X.
    long_x: bool,
    call: ThreadCall,
    origin: Position,
    tool: u32,
    /// The last pass so far.
    pass: u32,
    passes: Vec<(u64, u64, u32)>,
    /// Radius of the deepest pass at D; along X its Z.
    deepest: Length,
    /// Radius of the first pass at D, and of the next one that is deeper.
    first: (Length, Option<Length>),
    /// Z where the last stroke of a chain ends.
    reach: Length,
    /// Where the helices of its calls lie against each other.
    helices: Helices,
}

/// Places of helices of one lead, in leads, 0 to 1.
#[derive(Clone, Debug, Default)]
struct Helices(Vec<f64>);

impl Helices {
    /// A call that begins a stroke: where its helix crosses an angle that all have.
    fn take(&mut self, call: &ThreadCall) {
        let way = if call.end_z.value < call.start.z {
            -1.0
        } else {
            1.0
        };
        let angle = f64::from(call.first_angle.mdeg()) / f64::from(StartAngle::FULL);
        let place = (mm(call.start.z) / lead(call) - way * angle).rem_euclid(1.0);
        if !self.0.iter().any(|known| is_same_helix(*known - place)) {
            self.0.push(place);
        }
    }

    /// Starts that were cut one after the other: all helices lie equal parts of the lead apart. Anything else is an infeed
    /// along a flank, which a program shifts by hand.
    fn starts(&self) -> u8 {
        let Some(first) = self.0.first() else {
            return 1;
        };
        let count = u8::try_from(self.0.len()).unwrap_or(1);
        let is_part = |place: &f64| {
            let parts = (place - first) * f64::from(count);
            is_same_helix(parts / f64::from(count) - parts.round() / f64::from(count))
        };
        if self.0.iter().all(is_part) { count } else { 1 }
    }
}

/// Closer than a thousandth of the lead, whole turns left out.
fn is_same_helix(apart: f64) -> bool {
    (apart - apart.round()).abs() < 1e-3
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// There are more names than one, and not as many as threads.
    Names {
        /// Names.
        names: usize,
        /// Threads of the program.
        threads: usize,
    },
    /// A name says nothing.
    Name {
        /// The name.
        name: String,
        /// What is wrong with it.
        reason: NotKnown,
    },
    /// The program cuts another pitch than the name has.
    Pitch {
        /// Name of the thread.
        name: String,
        /// Source line.
        line: u32,
        /// Pitch of the name.
        named: Mm,
        /// Pitch of the program.
        cut: Mm,
    },
    /// The program cuts another number of starts than the name has.
    Starts {
        /// Name of the thread.
        name: String,
        /// Source line.
        line: u32,
        /// Starts and lead of the name.
        named: (u8, Mm),
        /// Starts and lead of the program.
        cut: (u8, Mm),
    },
}

/// Finds the threads among the calls of a program, and their moves.
#[derive(Clone, Debug, Default)]
pub struct Finder {
    threads: Vec<Found>,
    tool: u32,
    /// Moves so far, and how many there were before this call.
    step: u64,
    before: u64,
    /// Of this call: its passes.
    cuts: Vec<(u64, u64, u32)>,
    is_long_x: bool,
}

impl Finder {
    /// Takes the next move of a call.
    pub fn step(&mut self, each: &Move) {
        self.step += 1;
        match each.kind {
            MoveKind::Aux(Aux::T(code)) => self.tool = tool_of(u32::from(code)),
            MoveKind::Thread(thread) => self.is_long_x |= thread.long_x,
            _ => {}
        }
        note(&mut self.cuts, self.step, each);
    }

    /// Takes the call after its moves.
    pub fn call(&mut self, call: &Call) {
        let first = self.before + 1;
        self.before = self.step;
        let cuts = std::mem::take(&mut self.cuts);
        let long_x = std::mem::take(&mut self.is_long_x);
        let CallKind::Thread(thread) = &call.kind else {
            return;
        };
        let own = Found {
            line: call.span.line,
            long_x,
            call: *thread,
            origin: call.origin,
            tool: self.tool,
            pass: 0,
            passes: Vec::new(),
            deepest: if long_x {
                thread.end_z.value
            } else {
                thread.end_x.value
            },
            first: (thread.end_x.value, None),
            reach: thread.end_z.value,
            helices: Helices::default(),
        };
        let threads = &mut self.threads;
        if !threads
            .last()
            .is_some_and(|before| goes_on(before, &own, call))
        {
            threads.push(own);
        }
        if let Some(last) = threads.last_mut() {
            last.take(thread, &cuts, first, self.step);
        }
    }

    /// The threads of the program.
    ///
    /// # Errors
    /// A name says nothing or does not fit, or there are not as many names as threads.
    pub fn plan(self, wish: &Wish) -> Result<Plan, Refusal> {
        let (along_x, found): (Vec<_>, Vec<_>) =
            self.threads.into_iter().partition(|found| found.long_x);
        let names = wish.threads.len();
        if names > 1 && names != found.len() {
            return Err(Refusal::Names {
                names,
                threads: found.len(),
            });
        }
        let jobs = found.iter().enumerate().map(|(n, found)| {
            let name = wish.threads.get(n).or(wish.threads.first());
            job(found, name.map(String::as_str), wish)
        });
        Ok(Plan {
            jobs: jobs.collect::<Result<_, _>>()?,
            along_x: along_x.iter().map(|found| flat(found, wish)).collect(),
        })
    }
}

/// `T0303` is tool 3, `T3` too.
#[must_use]
pub const fn tool_of(code: u32) -> u32 {
    if code > 99 { code / 100 } else { code }
}

/// Adds a move to the passes of its call.
fn note(cuts: &mut Vec<(u64, u64, u32)>, step: u64, each: &Move) {
    let pass = each.tag.map_or(1, |tag| tag.pass.max(1));
    match cuts.last_mut() {
        Some((_, last, number)) if *number == pass => *last = step,
        _ => cuts.push((step, step, pass)),
    }
}

/// The call cuts on in the thread before: another pass of G92, a spring pass, another stroke of a chain. A chain is one
/// thread also where one of its strokes is so steep that it goes along X: out of the work, or up a shoulder.
fn goes_on(before: &Found, now: &Found, call: &Call) -> bool {
    let (a, b) = (&before.call, &now.call);
    let is_same = before.tool == now.tool
        && before.origin == call.origin
        && a.lead.value == b.lead.value
        && side(a) == side(b);
    if b.part.is_joined() {
        return is_same;
    }
    let same_end = if now.long_x {
        a.end_x.value == b.end_x.value
    } else {
        a.end_z.value == b.end_z.value
    };
    // No pass is deeper than the one before by a lead: what is, cuts at another diameter.
    let apart = (before.deepest - now.deepest).nm().unsigned_abs();
    is_same
        && before.long_x == now.long_x
        && same_end
        && a.taper.value == b.taper.value
        && mm_of(apart) <= lead(a)
}

/// Cycles come back to where the tool stood: away from the work. A stroke does not say.
fn side(call: &ThreadCall) -> Side {
    if call.cycle.is_stroke() || call.start.x > call.end_x.value {
        Side::External
    } else {
        Side::Internal
    }
}

impl Found {
    fn take(&mut self, call: &ThreadCall, cuts: &[(u64, u64, u32)], first: u64, last: u64) {
        // All strokes of a chain are one pass.
        let before = if call.part.is_joined() {
            self.pass.saturating_sub(1)
        } else {
            self.pass
        };
        if !call.part.is_joined() && !self.long_x {
            self.helices.take(call);
        }
        for (from, to, pass) in cuts {
            // What belongs to no pass is that of the one before it.
            self.pass = before + pass;
            self.passes
                .push((*from.max(&first), *to.min(&last), self.pass));
        }
        let (at, is_lower) = if self.long_x {
            (call.end_z.value, true)
        } else {
            (call.end_x.value, side(call) == Side::External)
        };
        let deeper = |than: Length| if is_lower { at < than } else { at > than };
        if deeper(self.deepest) {
            self.deepest = at;
        }
        if call.part.is_joined() {
            self.reach = call.end_z.value;
        } else if !self.long_x && self.first.1.is_none() && deeper(self.first.0) {
            self.first.1 = Some(at);
        }
    }
}

fn mm(length: Length) -> f64 {
    length.nm() as f64 / 1e6
}

fn mm_of(nm: u64) -> f64 {
    nm as f64 / 1e6
}

/// Travel per turn in millimetres.
fn lead(call: &ThreadCall) -> f64 {
    call.lead.value.numerator() as f64 / call.lead.value.denominator() as f64 / 1e6
}

/// The height of a cycle that knows it: then the surface is known. Others leave it open.
fn height(call: &ThreadCall) -> Option<f64> {
    match call.cycle {
        ThreadCycle::G76 | ThreadCycle::G78 => Some(mm(call.height.value)),
        ThreadCycle::G92 | ThreadCycle::G32 | ThreadCycle::G34 => None,
    }
}

/// The angle between the flanks that a cycle names, else 60°.
fn angle(call: &ThreadCall) -> Degrees {
    let written = f64::from(call.angle.value);
    Degrees(if written > 0.0 { written } else { 60.0 })
}

/// The edge that was typed for a tool.
fn edge(wish: &Wish, tool: u32) -> Option<&Edge> {
    let own = wish.tools.iter().find(|edge| edge.tool == Some(tool));
    own.or(wish.tools.iter().find(|edge| edge.tool.is_none()))
}

fn flat(found: &Found, wish: &Wish) -> Flat {
    let call = &found.call;
    let starts = call.starts.value.max(1);
    let pitch = Mm(lead(call) / f64::from(starts));
    // No norm has a thread on a face: its shape is that of a bolt.
    let shape = Designation::free(Side::External, Mm(1.0), pitch, starts, angle(call), 0.0);
    let edge = edge(wish, found.tool);
    let of_work = |x: Length, z: Length| (mm(x - found.origin.x), mm(z - found.origin.z));
    let (begin, end) = (
        of_work(call.start.x, call.start.z),
        of_work(call.end_x.value, call.end_z.value),
    );
    // The radius changes by this on the way from D back to A; a cycle comes from elsewhere.
    let rise = if call.cycle.is_stroke() {
        begin.0 - end.0
    } else {
        mm(call.taper.value)
    };
    let slope = (begin.1 - end.1) / rise;
    // A height is one on the radius.
    let way = if side(call) == Side::External {
        1.0
    } else {
        -1.0
    };
    let known = height(call).map(|height| end.1 - slope * (end.0 + way * height));
    let face = wish.known_face();
    let at_rim = face.unwrap_or(end.1.max(0.0));
    Flat {
        tool: edge.map_or_else(
            || Tool::vee(shape.angle, Nose::Round(shape.tip())),
            |edge| edge.shape,
        ),
        tool_number: found.tool,
        surface: (Mm(known.unwrap_or(at_rim - slope * begin.0)), slope),
        passes: found.passes.clone(),
        assumed: Assumed {
            tool: edge.is_none(),
            face: known.is_none() && face.is_none(),
            ..Assumed::default()
        },
    }
}

fn job(found: &Found, name: Option<&str>, wish: &Wish) -> Result<Job, Refusal> {
    let call = &found.call;
    let mut assumed = Assumed {
        side: call.cycle.is_stroke() && name.is_none(),
        thread: name.is_none(),
        ..Assumed::default()
    };
    let (start, end) = (
        mm(call.start.z - found.origin.z),
        mm(call.end_z.value - found.origin.z),
    );
    let taper = if start == end {
        0.0
    } else {
        mm(call.taper.value) / (start - end)
    };
    // Those of a cycle, or of calls that each cut one.
    let starts = match call.starts.value.max(1) {
        1 => found.helices.starts(),
        starts => starts,
    };
    let (low, high) = (start.min(end), start.max(end));
    let face = wish.known_face().unwrap_or_else(|| {
        assumed.face = true;
        if low < 0.0 && high > 0.0 { 0.0 } else { high }
    });
    // The cycle's radii are those at D.
    let to_face = Mm(2.0 * taper * (face - end));
    let mut traits = Traits {
        side: side(call),
        pitch: Mm(lead(call) / f64::from(starts)),
        starts,
        angle: angle(call),
        taper,
        is_constant: call.change.value == LeadChange::NONE,
        crest: wish.surface,
        root: Mm(2.0 * mm(found.deepest - found.origin.x)) + to_face,
    };
    let way = if traits.side == Side::External {
        2.0
    } else {
        -2.0
    };
    traits.crest = traits
        .crest
        .or(height(call).map(|height| traits.root + Mm(way * height)));
    let mut thread = match name {
        None => guess(&traits),
        Some(name) => named(name, call, &mut traits)?,
    };
    if (thread.pitch.0 / traits.pitch.0 - 1.0).abs() > 1e-3 {
        return Err(Refusal::Pitch {
            name: thread.text,
            line: found.line,
            named: thread.pitch,
            cut: traits.pitch,
        });
    }
    if thread.starts != traits.starts {
        return Err(Refusal::Starts {
            name: thread.text,
            line: found.line,
            named: (thread.starts, thread.pitch * f64::from(thread.starts)),
            cut: (traits.starts, Mm(lead(call))),
        });
    }
    let crest = traits.crest.unwrap_or_else(|| {
        assumed.surface = true;
        let first = before_first(found).map(|d| Mm(d) + to_face);
        // Where there is a norm, it knows better than the passes.
        let first = first.filter(|_| thread.text.is_empty());
        wish.within_stock(traits.side, first.unwrap_or_else(|| middle(&thread)))
    });
    if assumed.surface && thread.text.is_empty() {
        traits.crest = Some(crest);
        thread = free(&traits);
    }
    let low = low.min(mm(found.reach - found.origin.z));
    let room = (2.0 * thread.lead().0).max(call.run_out.map_or(0.0, |out| mm(out.long.value)));
    let edge = edge(wish, found.tool);
    assumed.tool = edge.is_none();
    let tool = edge.map_or_else(
        || Tool::vee(thread.angle, Nose::Round(thread.tip())),
        |edge| edge.shape,
    );
    Ok(Job {
        line: found.line,
        cycle: call.cycle,
        cut_in: call.cut_in.value,
        tool,
        tool_number: found.tool,
        stock: Stock {
            side: traits.side,
            radius: crest * 0.5,
            taper,
            from: Mm(low - room),
            face: Mm(face),
        },
        origin: (Mm(mm(found.origin.x)), Mm(mm(found.origin.z))),
        passes: found.passes.clone(),
        assumed,
        thread,
    })
}

/// Diameter of the surface at D if the first pass takes as much as the second one.
fn before_first(found: &Found) -> Option<f64> {
    let (first, next) = (found.first.0, found.first.1?);
    Some(2.0 * mm(first + (first - next) - found.origin.x))
}

/// Reads a name. A stroke is on the side that its class says.
fn named(name: &str, call: &ThreadCall, traits: &mut Traits) -> Result<Designation, Refusal> {
    let read = match Designation::read(name, traits.side) {
        Err(NotKnown::Side) if call.cycle.is_stroke() => {
            traits.side = Side::Internal;
            Designation::read(name, Side::Internal)
        }
        read => read,
    };
    read.map_err(|reason| Refusal::Name {
        name: name.to_owned(),
        reason,
    })
}

/// The middle of the limits of the crest, else its basic value.
fn middle(thread: &Designation) -> Mm {
    let limits = Limits::of(thread);
    let (band, basic) = match thread.side {
        Side::External => (limits.major, thread.major),
        Side::Internal => (limits.minor, thread.minor()),
    };
    band.low
        .zip(band.high)
        .map_or(basic, |(low, high)| (low + high) * 0.5)
}
