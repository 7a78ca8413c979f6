//! A parameter set that is staged, looked at and committed while others on the bus write parameters too: 5010h:09 to :0B.

use core::ops::RangeInclusive;
use core::time::Duration;

use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_board_sim::{Sim, stored_params};
use leadscrew_core::board::Found;
use leadscrew_core::board::device::LOAD;
use leadscrew_core::bus::{
    BoardState, CobId, Frame, Object, SdoDownload, SdoError, SdoProtocol, Service,
};
use leadscrew_core::link::{ImageWriter, decode_changes, identity};
use leadscrew_core::params::{Entry, PASSWORD, PASSWORD_KEPT, Params};

use crate::gateway::{Gateway, NODE};
use crate::params;

const IMAGE: Object = Object::new(0x5010, 1);
const RECALL: Object = Object::new(0x5010, 5);
const PASSWORD_OBJECT: Object = Object::new(0x5010, 6);
const STAGED: Object = Object::new(0x5010, 9);
const CHANGES: Object = Object::new(0x5010, 10);
const COMMIT: Object = Object::new(0x5010, 11);
const BUILT_IN: Object = Object::new(0x1011, 1);

/// The tool offsets: many values of many digits.
const TOOLS: RangeInclusive<u16> = 9101..=9132;
/// Steps that are taken at most: each change starts the board anew.
const STEPS: usize = 64;
/// Ticks until a board that has begun anew is ready.
const READY: usize = 2_000;
/// Ticks after which the board breaks off a transfer.
const SILENCE: usize = 1_010;
/// 5010h:02: being stored.
const STORING: u64 = 1;

/// Records of three bytes: what somebody does, and with what. Two clients stage and
/// commit; the rest is whoever else there is.
///
/// # Panics
/// Where a commit that is taken brings another set into force than the one it names, its password included; where one that
/// is refused changes anything; where the set of a client whom nobody has disturbed is refused; where what a staged set
/// would change is told wrong, or what is in force is not stored, or cannot work.
pub fn staging(data: &[u8]) {
    let mut bus = Bus::start();
    for record in data.chunks_exact(3).take(STEPS) {
        if let &[what, choice, more] = record {
            bus.step(what, choice, more);
        }
    }
    bus.is_in_force();
}

fn entry(key: &str) -> &'static Entry {
    Entry::find_text(key).expect("a parameter")
}

/// One of some sets. Those of a kind differ in their password alone.
fn set(choice: u8) -> Params {
    let mut params = Params::slant_bed();
    // Nobody is watched for: who has the door open keeps it open.
    params::set(&mut params, "9024", 0);
    params::set(&mut params, "9007", i64::from(choice & 7) + 10);
    if choice & 0x08 != 0 {
        params::set(&mut params, "9026.0", 0);
    }
    if choice & 0x10 != 0 {
        // Too much for 5010h:0Ah.
        for entry in Entry::all()
            .iter()
            .filter(|entry| TOOLS.contains(&entry.no))
        {
            params.set(entry, entry.max()).expect("in its range");
        }
    }
    if choice & 0x20 != 0 {
        // In its range each, and no machine together.
        params::set(&mut params, "1320.X", -1_000_000_000);
        params::set(&mut params, "1321.X", 1_000_000_000);
    }
    let password = [0, PASSWORD_KEPT, 4711, 4712][usize::from(choice >> 6)];
    params::set(&mut params, "9028", password);
    params
}

fn password(params: &Params) -> i64 {
    Entry::find(PASSWORD, None).map_or(0, |entry| params.get(entry))
}

/// What `sent` becomes where `force` is in force.
fn taken(sent: &Params, force: &Params) -> Params {
    let mut params = sent.clone();
    if password(sent) == PASSWORD_KEPT {
        params::set(&mut params, "9028", password(force));
    }
    params
}

fn image(params: &Params) -> Vec<u8> {
    let mut bytes = vec![0; ImageWriter::BYTES as usize];
    ImageWriter::with_password(params).read(0, &mut bytes);
    bytes
}

/// A board and everybody on its bus.
struct Bus {
    sim: Sim,
    gateway: Gateway,
    /// What is in force, as far as anybody can know.
    force: Params,
    /// What was in force before.
    history: Vec<Params>,
    /// What the two clients have staged last.
    sent: [Option<Params>; 2],
    /// The last of them, where nobody has done anything since.
    undisturbed: Option<Params>,
    /// It has been committed: what is left is the repetition of that.
    committed: bool,
}

impl Bus {
    fn start() -> Self {
        let built_in = Params::slant_bed();
        let sim = Sim::with_flash(&built_in, &PlantOptions::default(), Flash::erased());
        let mut sim = sim.expect("it starts");
        let gateway = Gateway::connect(&mut sim);
        let mut bus = Self {
            sim,
            gateway,
            force: built_in,
            history: Vec::new(),
            sent: [None, None],
            undisturbed: None,
            committed: false,
        };
        bus.ready();
        let first = set(0);
        bus.write(IMAGE, &image(&first)).expect("it can work");
        bus.changed(&[first]);
        bus
    }

    fn write(&mut self, object: Object, bytes: &[u8]) -> Result<(), SdoError> {
        let protocol = if bytes.len() > 4 {
            SdoProtocol::Block
        } else {
            SdoProtocol::Short
        };
        self.gateway.write(&mut self.sim, object, bytes, protocol)
    }

    fn tick(&mut self) {
        self.sim.step();
        while self.sim.event().is_some() {}
        self.gateway.listen(&mut self.sim);
    }

    fn number(&mut self, object: Object) -> u64 {
        self.gateway
            .number(&mut self.sim, object.index, object.sub)
            .expect("a number")
    }

    /// The board has stored what it was given, and its machine is up.
    fn ready(&mut self) {
        for _ in 0..READY {
            self.tick();
            let stores = self.number(Object::new(0x5010, 2)) == STORING;
            if !stores && self.number(Object::new(0x5001, 2)) == BoardState::Idle as u64 {
                return;
            }
        }
        panic!("the board does not come up again");
    }

    /// Something was taken: what is stored and in force now is one of these.
    fn changed(&mut self, possible: &[Params]) {
        self.ready();
        let mut flash = self.sim.flash().clone();
        let up = stored_params(&mut flash, &Params::slant_bed()).expect("a flash");
        assert_eq!(up.found, Found::Newest);
        assert!(possible.contains(&up.params), "another set than was meant");
        self.history
            .push(core::mem::replace(&mut self.force, up.params));
        self.is_in_force();
    }

    fn is_in_force(&mut self) {
        let told = self.number(Object::new(0x1020, 1));
        assert_eq!(told, u64::from(identity(&self.force)));
        assert!(self.force.validate().is_ok(), "a set that cannot work");
    }

    /// What is possible where it was taken; nothing has changed where it was refused.
    fn outcome(&mut self, taken: Result<(), SdoError>, possible: &[Params]) {
        assert_ne!(taken, Err(SdoError::TimedOut), "no answer");
        match taken {
            Ok(()) => self.changed(possible),
            Err(_) => self.is_in_force(),
        }
    }

    fn stage(&mut self, client: usize, choice: u8) {
        let wanted = set(choice);
        let staged = self.write(STAGED, &image(&wanted));
        self.is_in_force();
        self.undisturbed = staged.is_ok().then(|| wanted.clone());
        self.committed = false;
        self.sent[client] = Some(wanted);
    }

    fn commit(&mut self, wanted: &Params) {
        let checksum = ImageWriter::with_password(wanted).checksum();
        let committed = self.write(COMMIT, &checksum.to_le_bytes());
        if self.undisturbed.as_ref() == Some(wanted) {
            assert_eq!(committed, Ok(()), "nobody has disturbed it");
            self.committed = true;
        }
        // What repeats the last one takes nothing from whoever has staged since.
        let changes = taken(wanted, &self.force) != self.force;
        if changes || committed.is_err() {
            self.undisturbed = None;
        }
        self.outcome(committed, &[taken(wanted, &self.force)]);
    }

    fn step(&mut self, what: u8, choice: u8, more: u8) {
        let what = what % 16;
        if !matches!(what, 0 | 1 | 4..=7 | 12 | 15) {
            self.undisturbed = None;
        }
        match what {
            0 | 1 => self.stage(usize::from(what), choice),
            2 => {
                let mut bytes = image(&set(choice));
                let at = usize::from(more) * 5 % bytes.len();
                bytes[at] ^= choice | 1;
                let refused = self.write(STAGED, &bytes);
                assert!(refused.is_err(), "a damaged image");
                self.is_in_force();
            }
            3 => self.part(&image(&set(choice)), more),
            4 | 5 => {
                if let Some(wanted) = self.sent[usize::from(what - 4)].clone() {
                    self.commit(&wanted);
                }
            }
            6 => self.commit(&set(choice)),
            7 => {
                // The set in force is there; anything else is nobody's.
                let number = identity(&self.force) ^ u32::from(choice & 1) << (more & 31);
                let outcome = self.write(COMMIT, &number.to_le_bytes());
                assert!(outcome.is_err() || choice & 1 == 0);
                // Without its password a staged set has another number: who commits it by that one takes it from whoever
                // staged it.
                let is_taken = self.undisturbed.as_ref().is_some_and(|set| {
                    identity(set) == number && ImageWriter::with_password(set).checksum() != number
                });
                // The board knows the last commit again, and no other.
                if outcome.is_err() || self.committed || is_taken {
                    self.undisturbed = None;
                }
                let same = self.force.clone();
                self.outcome(outcome, &[same]);
            }
            8 => {
                let taken = self.write(Object::new(0x2000 + 9007, 0), &[choice]);
                let mut wanted = self.force.clone();
                // Beyond its range it is refused.
                let _ = wanted.set(entry("9007"), i64::from(choice));
                self.outcome(taken, &[wanted]);
            }
            9 => {
                let wanted = set(choice);
                let outcome = self.write(IMAGE, &image(&wanted));
                self.outcome(outcome, &[taken(&wanted, &self.force)]);
            }
            10 => {
                let outcome = self.write(RECALL, &[1]);
                self.outcome(outcome, &self.history.clone());
            }
            11 => {
                let outcome = self.write(BUILT_IN, &LOAD.to_le_bytes());
                let mut wanted = Params::slant_bed();
                params::set(&mut wanted, "9028", password(&self.force));
                self.outcome(outcome, &[wanted]);
            }
            12 => self.look(),
            13 => {
                let word = [4711, 4712, u32::from(more)][usize::from(choice % 3)];
                let outcome = self.write(PASSWORD_OBJECT, &word.to_le_bytes());
                assert_ne!(outcome, Err(SdoError::TimedOut), "no answer");
            }
            14 => {
                let outcome = self.write(Object::new(0x2000 + 9026, 0), &[choice & 1]);
                let mut wanted = self.force.clone();
                params::set(&mut wanted, "9026.0", i64::from(choice & 1));
                self.outcome(outcome, &[wanted]);
            }
            _ => (0..choice).for_each(|_| self.tick()),
        }
    }

    /// What a staged set would change is what is in force.
    fn look(&mut self) {
        let read = self
            .gateway
            .read(&mut self.sim, CHANGES, SdoProtocol::Block);
        let (Some(wanted), Ok(bytes)) = (&self.undisturbed, read) else {
            return;
        };
        // Of the password nothing is told but that there is one.
        let told = decode_changes(&bytes, &taken(wanted, &self.force)).map(|set| identity(&set));
        assert_eq!(told, Ok(identity(&self.force)));
    }

    /// The beginning of an image, from somebody who goes away then.
    fn part(&mut self, bytes: &[u8], frames: u8) {
        let (patience, now) = (Duration::from_secs(1), Duration::ZERO);
        let mut transfer = SdoDownload::new(NODE, STAGED, bytes, SdoProtocol::Block, patience, now);
        for _ in 0..frames {
            let Some(frame) = transfer.poll(now) else {
                break;
            };
            self.sim.receive(&frame);
            self.sim.settle();
            while let Some(frame) = self.sim.transmit() {
                transfer.receive(&frame, now);
            }
        }
        if transfer.outcome().is_none() {
            // Somebody else may break it off, or the board does when it has waited for long enough.
            if frames & 1 == 0 {
                let abort = [0x80, 0x10, 0x50, 9, 0, 0, 4, 5];
                let frame = Frame::new(CobId::of(Service::SdoRequest, NODE), &abort);
                self.sim.receive(&frame.expect("eight bytes"));
                self.sim.settle();
            } else {
                (0..SILENCE).for_each(|_| self.tick());
            }
            self.gateway.listen(&mut self.sim);
        }
        self.is_in_force();
    }
}
