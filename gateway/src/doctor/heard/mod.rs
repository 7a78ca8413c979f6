//! What the wire says: frames with their times in, facts out. What a fact means is for [`rules`](super::rules).

pub mod beat;
pub mod drive;
pub mod errors;
pub mod load;
pub mod motion;
pub mod nodes;
pub mod period;
pub mod sdo;

use std::collections::BTreeMap;
use std::time::Duration;

use leadscrew_can::{Id, Packet, Stamp};
use leadscrew_core::alarm::Code;
use leadscrew_core::bus::{
    BoardBeat, BoardStatus, CobId, DriveCommand, DriveStatus, Emcy, Frame, NmtCommand, NmtState,
    NodeId, Service, Setpoints,
};

use self::beat::Sync;
use self::drive::Drive;
use self::errors::Errors;
use self::load::{Load, classical_bits, fd_bits};
use self::nodes::Node;
use self::period::Period;
use self::sdo::Transfers;
use super::hits::Hits;
use super::machine::{Clock, Machine};
use crate::params::drives::{self, DriveName};

/// Emergency 8611h: following error.
pub const FOLLOWING: u16 = 0x8611;

/// What the board says of itself.
#[derive(Clone, Debug, Default)]
pub struct Board {
    /// Its last status.
    pub status: Option<BoardStatus>,
    /// Alarms that it stands on, by number.
    pub alarms: BTreeMap<u16, Hits>,
    /// The one that it stands on now.
    pub standing: Option<u16>,
    /// Setpoints that it counts as late.
    pub late: Hits,
    /// How many those are.
    pub late_setpoints: u32,
    beat: Option<(Stamp, u16)>,
    /// Its time, and that of the stamps meanwhile.
    ticked: (Duration, Duration),
}

/// All that was heard.
#[derive(Clone, Debug)]
pub struct Heard {
    /// What should be there.
    pub machine: Machine,
    /// The first packet.
    pub began: Option<Stamp>,
    /// The last packet, or the end of listening.
    pub now: Stamp,
    /// Frames, error frames not counted.
    pub frames: u64,
    /// Error frames.
    pub errors: Errors,
    /// Nodes that were heard, or asked.
    pub nodes: BTreeMap<NodeId, Node>,
    /// SYNC.
    pub sync: Sync,
    /// What is told within a period.
    pub period: Period,
    /// The load of the wire.
    pub load: Load,
    /// Objects.
    pub objects: Transfers,
    /// Drives by node.
    pub drives: BTreeMap<NodeId, Drive>,
    /// The board.
    pub board: Board,
}

impl Heard {
    /// Nothing yet.
    #[must_use]
    pub fn new(machine: Machine) -> Self {
        let patience = Duration::from_millis(u64::from(machine.params.drive_time_ms()));
        let drive = |name: DriveName| {
            let streamed = drives::mode(name, &machine.params);
            Drive::new(name.is_spindle(), patience, streamed)
        };
        let drives = machine.drives.iter();
        let drives = drives.map(|expected| (expected.node, drive(expected.name)));
        Self {
            drives: drives.collect(),
            machine,
            began: None,
            now: Stamp::default(),
            frames: 0,
            errors: Errors::default(),
            nodes: BTreeMap::new(),
            sync: Sync::default(),
            period: Period::default(),
            load: Load::default(),
            objects: Transfers::default(),
            board: Board::default(),
        }
    }

    /// How long was listened.
    #[must_use]
    pub fn span(&self) -> Duration {
        self.began
            .map_or(Duration::ZERO, |began| self.now.since(began))
    }

    /// True where the stamps tell the time of the machine: not in virtual time, and not where nobody says so.
    #[must_use]
    pub fn is_in_real_time(&self) -> bool {
        let (board, stamps) = self.board.ticked;
        if stamps < Duration::from_secs(1) {
            return self.machine.clock == Clock::Kernel && self.board.beat.is_none();
        }
        board.abs_diff(stamps) * 200 <= stamps
    }

    /// Listening has begun, or gone on until now, without a packet.
    pub fn until(&mut self, at: Stamp) {
        self.began.get_or_insert(at);
        self.now = self.now.max(at);
    }

    /// A packet.
    pub fn push(&mut self, at: Stamp, packet: &Packet) {
        self.until(at);
        match packet {
            Packet::Error(error) => self.errors.note(at, error, packet),
            Packet::Frame(frame) => {
                self.frames += 1;
                let payload = frame.payload();
                let is_transfer = matches!(
                    frame.id().service(),
                    Some((Service::SdoRequest | Service::SdoReply, _))
                );
                if !is_transfer {
                    self.load
                        .note(at, classical_bits(frame.id().get(), payload));
                }
                self.frame(at, frame, packet);
            }
            Packet::Fd(frame) => {
                self.frames += 1;
                let params = &self.machine.params;
                let (kbit, data) = (params.bus_kbit(), params.fd_kbit());
                self.load
                    .note(at, fd_bits(frame.data.bytes().len(), kbit, data));
                if let Id::Standard(id) = frame.id {
                    let from = self.sender(id);
                    self.sent(at, from);
                    if let Some(node) = from {
                        let node = self.nodes.entry(node).or_default();
                        if frame.sender_passive {
                            node.passive.go_on(at, packet);
                        } else {
                            node.passive.end(at);
                        }
                    }
                    if id == Setpoints::cob_id(self.machine.board) {
                        self.together(at, id, frame.data.bytes(), packet);
                    }
                }
            }
            Packet::Extended(..) | Packet::Remote(..) => self.frames += 1,
        }
    }

    /// Whose frame it is, by its identifier.
    fn sender(&self, id: CobId) -> Option<NodeId> {
        if id == CobId::SYNC || id == BoardBeat::id(self.machine.board) {
            return Some(self.machine.board);
        }
        let (service, node) = id.service()?;
        match service {
            Service::Emcy
            | Service::Tpdo1
            | Service::Tpdo2
            | Service::Tpdo3
            | Service::Tpdo4
            | Service::SdoReply
            | Service::Heartbeat => Some(node),
            Service::Rpdo1 | Service::Rpdo2 | Service::Rpdo3 | Service::Rpdo4
                if node != self.machine.board =>
            {
                Some(self.machine.board)
            }
            _ => None,
        }
    }

    fn sent(&mut self, at: Stamp, from: Option<NodeId>) {
        self.errors.good(at, from);
        if let Some(node) = from {
            self.nodes.entry(node).or_default().sent(at);
        }
    }

    fn frame(&mut self, at: Stamp, frame: &Frame, packet: &Packet) {
        let from = self.sender(frame.id());
        self.sent(at, from);
        if frame.id() == CobId::SYNC {
            self.beat(at, frame, packet);
            return;
        }
        if let Some((command, node)) = NmtCommand::decode(frame) {
            for (number, heard) in &mut self.nodes {
                if node.is_none_or(|node| node == *number) {
                    heard.told(at, command);
                }
            }
            return;
        }
        if let Some(beat) = BoardBeat::decode(frame, self.machine.board) {
            self.tick(at, beat.beat.ms());
            return;
        }
        let Some((service, node)) = frame.id().service() else {
            return;
        };
        match service {
            Service::Heartbeat => {
                let Some((_, state)) = NmtState::decode(frame) else {
                    return;
                };
                let is_board = node == self.machine.board;
                let counts = !is_board && node != NodeId::GATEWAY;
                let heard = self.nodes.entry(node).or_default();
                heard.beat(at, state, packet, counts);
                if state == NmtState::BootUp {
                    if let Some(drive) = self.drives.get_mut(&node) {
                        drive.has_reason(at);
                    }
                    if is_board {
                        self.sync.restart();
                        self.board.beat = None;
                        self.board.status = None;
                    }
                }
            }
            Service::Emcy => {
                if let Some((_, emergency)) = Emcy::decode(frame) {
                    self.emergency(at, node, &emergency, packet);
                }
            }
            Service::SdoRequest => {
                self.objects.request(node, frame.payload());
                self.nodes.entry(node).or_default().asked.hit(at, packet);
            }
            Service::SdoReply => {
                self.objects.reply(at, node, frame.payload(), packet);
                if node == self.machine.board {
                    self.told_alarm(at, packet);
                }
            }
            Service::Rpdo1 if Some(node) == self.machine.block => {
                self.nodes.entry(node).or_default().asked.hit(at, packet);
            }
            _ if node == self.machine.board => self.of_board(at, service, frame, packet),
            _ => self.of_drive(at, service, node, frame, packet),
        }
    }

    fn tick(&mut self, at: Stamp, ms: u16) {
        if let Some((last, before)) = self.board.beat.replace((at, ms)) {
            let (board, stamps) = &mut self.board.ticked;
            *board += Duration::from_millis(u64::from(ms.wrapping_sub(before)));
            *stamps += at.since(last);
        }
    }

    fn beat(&mut self, at: Stamp, frame: &Frame, packet: &Packet) {
        let setpoints = self.period.most(is_setpoint);
        let follows = self.sync.note(at, frame.payload(), packet, setpoints);
        let one_for_all = Setpoints::cob_id(self.machine.board);
        let drives = &self.machine.drives;
        let answers_always = self.machine.params.drive_status_syncs() == 1;
        self.period.next(follows, |id| match id.service() {
            _ if id == one_for_all => true,
            Some((Service::Rpdo1, node)) => drives
                .iter()
                // A further spindle only taps, and is told in every fourth period until it does.
                .any(|drive| drive.node == node && drive.name <= DriveName::S1),
            Some((Service::Tpdo1, _)) => answers_always,
            _ => false,
        });
    }

    fn emergency(&mut self, at: Stamp, node: NodeId, emergency: &Emcy, packet: &Packet) {
        let heard = self.nodes.entry(node).or_default();
        heard.emergency(at, emergency, packet);
        let thread = self.board.status.is_some_and(|status| status.flags.locked);
        if let Some(drive) = self.drives.get_mut(&node) {
            match emergency.code {
                0 => drive.follows_again(at),
                FOLLOWING => drive.cannot_follow(at, thread, packet),
                _ => drive.has_reason(at),
            }
        }
        if node != self.machine.board {
            return;
        }
        // The board has a limit of its own, and tells the number of its alarm in the detail.
        let [low, high, ..] = emergency.detail;
        let alarm = u16::from_le_bytes([low, high]);
        if emergency.code == 0 {
            self.stands_on(at, None, packet);
        } else if Code::from_number(alarm).is_some_and(|code| !code.is_warning()) {
            self.stands_on(at, Some(alarm), packet);
        }
        if emergency.code == 0xFF00 && alarm == Code::FollowingError.number() {
            let off = |drive: &Drive| match (drive.command, drive.status) {
                (Some((_, command)), Some((_, status))) => command.target.distance(status.actual),
                _ => 0,
            };
            if let Some(drive) = self.drives.values_mut().max_by_key(|drive| off(drive)) {
                drive.cannot_follow(at, thread, packet);
            }
        }
        if emergency.code == 0xFF00 && alarm == Code::HomeCancelled.number() {
            self.drives.values_mut().for_each(Drive::cancelled);
        }
    }

    fn of_board(&mut self, at: Stamp, service: Service, frame: &Frame, packet: &Packet) {
        if service == Service::Rpdo1 {
            let node = self.nodes.entry(self.machine.board).or_default();
            node.wanted(at, packet);
        }
        let Some((_, status)) = BoardStatus::decode(frame) else {
            return;
        };
        if let Some(before) = self.board.status.replace(status)
            && status.late > before.late
        {
            self.board.late.hit(at, packet);
            self.board.late_setpoints += status.late - before.late;
        }
        self.stands_on(at, status.alarm, packet);
    }

    /// The board says on which alarm it stands: by its status, or by an emergency where nobody has started it.
    fn stands_on(&mut self, at: Stamp, alarm: Option<u16>, packet: &Packet) {
        self.board.standing = alarm;
        for (number, hits) in &mut self.board.alarms {
            if alarm != Some(*number) {
                hits.end(at);
            }
        }
        if let Some(number) = alarm {
            let hits = self.board.alarms.entry(number).or_default();
            hits.go_on(at, packet);
            return;
        }
        // A fault that only the board has told is over with its alarm.
        for (node, drive) in &mut self.drives {
            let faulty = self.nodes.get(node).is_some_and(|node| {
                let own = node.emergencies.get(&FOLLOWING);
                own.is_some_and(Hits::lasts)
            });
            if !faulty {
                drive.follows_again(at);
            }
        }
    }

    /// What an object of the board says of its alarm.
    fn told_alarm(&mut self, at: Stamp, packet: &Packet) {
        let told = self.objects.value(self.machine.board, 0x5001, 4);
        let Some((when, value)) = told.filter(|(when, _)| *when == at) else {
            return;
        };
        let alarm = u16::try_from(value).ok().filter(|number| *number > 0);
        self.stands_on(at, alarm, packet);
        if let Some(hits) = alarm.and_then(|number| self.board.alarms.get_mut(&number)) {
            *hits = Hits::standing(when).with(hits);
        }
    }

    fn of_drive(
        &mut self,
        at: Stamp,
        service: Service,
        node: NodeId,
        frame: &Frame,
        packet: &Packet,
    ) {
        let Some(drive) = self.drives.get_mut(&node) else {
            return;
        };
        match service {
            Service::Rpdo1 => {
                self.period.note(at, frame.id(), frame.payload(), packet);
                if let Some((_, command)) = DriveCommand::decode(frame) {
                    drive.told(at, command, packet);
                    self.nodes.entry(node).or_default().asked.hit(at, packet);
                }
            }
            Service::Rpdo2 => {
                if let Some(mode) = frame.payload().first() {
                    drive.told_mode(at, *mode, packet);
                }
            }
            Service::Tpdo1 => {
                self.period.note(at, frame.id(), frame.payload(), packet);
                if let Some((_, status)) = DriveStatus::decode(frame) {
                    let every = u64::from(self.machine.params.drive_status_syncs());
                    let sync = (self.sync.periods, self.sync.counter);
                    drive.answers(at, status, sync, every, packet);
                }
            }
            Service::Tpdo2 => {
                // The inputs alone are four bytes.
                if let [mode, _, _, _, _, ..] = frame.payload() {
                    drive.tells_mode(at, *mode, packet);
                }
            }
            _ => {}
        }
    }

    /// The frame with the setpoints of all drives.
    fn together(&mut self, at: Stamp, id: CobId, payload: &[u8], packet: &Packet) {
        self.period.note(at, id, payload, packet);
        for (place, expected) in self.machine.drives.iter().enumerate() {
            if let Some(command) = Setpoints::command(payload, place)
                && let Some(drive) = self.drives.get_mut(&expected.node)
            {
                drive.told(at, command, packet);
                let node = self.nodes.entry(expected.node).or_default();
                node.asked.hit(at, packet);
            }
        }
    }

    /// Nothing comes any more.
    pub fn close(&mut self) {
        let at = self.now;
        self.errors.close(at);
        for node in self.nodes.values_mut() {
            node.close(at);
            node.passive.end(at);
        }
        for drive in self.drives.values_mut() {
            drive.close(at);
        }
        for hits in self.board.alarms.values_mut() {
            hits.end(at);
        }
    }
}

/// A frame with setpoints: of one drive, or of all.
fn is_setpoint(id: CobId) -> bool {
    matches!(id.service(), Some((Service::Rpdo1 | Service::Tpdo4, _)))
}
