//! The frames of a bus as a table: a row for every SYNC with the setpoints the drives latch at it and the positions they
//! told last, and a row for every event.
//!
//! | column | meaning |
//! |---|---|
//! | `t_us` | when it was received, from the first packet |
//! | `sync` | the counter of the SYNC; empty in an event |
//! | `x_nm z_nm c_udeg` | what the axis drives latch: machine coordinates, X on the radius |
//! | `s1_urev` | the angle that spindle 1 is to have, while it is in position mode |
//! | `s1_rpm` | the speed that it is to have, in speed mode |
//! | `x_actual_nm z_actual_nm c_actual_udeg s1_actual_urev` | what each drive told last |
//! | `s2_urev s2_rpm s2_actual_urev`, the same of `s3` and `s4` | as of spindle 1; empty where there is no such spindle |
//! | `b2_x_nm` and so on | the same of a further board's drives, where its set is known; then `b3_…` |
//! | `event` | what happened, in words |
//!
//! A value that no frame has told yet is empty.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write};

use leadscrew_can::{FdFrame, Id, Packet, Stamp};
use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{
    CobId, DriveCommand, DriveStatus, Emcy, Frame, Increments, Mode, NmtCommand, NmtState, NodeId,
    Scale, Service, Setpoints, SpindleCommand, State, is_sync,
};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

use crate::number;
use crate::params::drives::DriveName;

/// The columns of one board's drives.
const COLUMNS: [&str; 18] = [
    "x_nm",
    "z_nm",
    "c_udeg",
    "s1_urev",
    "s1_rpm",
    "x_actual_nm",
    "z_actual_nm",
    "c_actual_udeg",
    "s1_actual_urev",
    "s2_urev",
    "s2_rpm",
    "s2_actual_urev",
    "s3_urev",
    "s3_rpm",
    "s3_actual_urev",
    "s4_urev",
    "s4_rpm",
    "s4_actual_urev",
];

/// What is known of a drive.
#[derive(Clone, Copy, Debug, Default)]
struct Drive {
    /// From increments to nanometres or millionths of a degree; a spindle has none.
    scale: Option<Scale>,
    target: Option<Increments>,
    actual: Option<Increments>,
    state: Option<State>,
    /// What a spindle is to do; an axis has none.
    spindle: Option<SpindleCommand>,
}

impl Drive {
    /// The angle a spindle in position mode is to have.
    fn angle(&self) -> Option<Increments> {
        let positioned = self.spindle?.mode == Mode::Position;
        self.target.filter(|_| positioned)
    }

    /// The speed a spindle in speed mode is to have, in thousandths of a turn per minute.
    fn speed(&self) -> Option<i64> {
        let command = self.spindle?;
        (command.mode == Mode::Velocity).then(|| i64::from(command.velocity.get()))
    }
}

/// The frame of CAN FD with all setpoints of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Together {
    /// Its drives get a frame each.
    None,
    /// It has this identifier.
    Of(CobId),
    /// The number of the board is not known.
    Unknown,
}

/// The drives of one board.
#[derive(Debug)]
struct Machine {
    /// In the order of the columns, as their nodes are.
    drives: [Drive; 7],
    nodes: [NodeId; 7],
    /// Whose the frame of CAN FD with all setpoints is, where there is one.
    together: Together,
    /// Increments of a spindle's drive to a turn.
    per_turn: i64,
}

impl Machine {
    fn new(params: &Params) -> Self {
        let axis = |axis| Drive {
            scale: Scale::new(params.drive_numerator(axis), params.drive_denominator(axis)),
            ..Drive::default()
        };
        let nodes = DriveNodes::of(params);
        Self {
            nodes: DriveName::ALL.map(|name| name.among(&nodes).node),
            drives: [
                axis(Axis::X),
                axis(Axis::Z),
                axis(Axis::C),
                Drive::default(),
                Drive::default(),
                Drive::default(),
                Drive::default(),
            ],
            together: match params.setpoint_frame() {
                0 => Together::None,
                _ => Together::Unknown,
            },
            per_turn: i64::from(params.spindle_increments().max(1)),
        }
    }

    /// The setpoints of all drives; behind those there are is nothing but what fills the frame up.
    fn setpoints(&mut self, payload: &[u8]) {
        for (place, drive) in self.drives.iter_mut().enumerate() {
            drive.target = Setpoints::command(payload, place).map(|command| command.target);
        }
    }

    fn drive(&mut self, node: NodeId) -> Option<&mut Drive> {
        let place = self.nodes.iter().position(|drive| *drive == node)?;
        self.drives.get_mut(place)
    }

    /// Its part of a row.
    fn row(&self, line: &mut Vec<u8>) {
        let [x, z, c, first, further @ ..] = self.drives;
        let per_turn = i128::from(self.per_turn);
        let position = |drive: Drive, at: Option<Increments>| Some(drive.scale?.position(at?));
        let turns = |at: Option<Increments>| {
            i64::try_from(i128::from(at?.get()) * 1_000_000 / per_turn).ok()
        };
        for drive in [x, z, c] {
            field(line, position(drive, drive.target));
        }
        commanded(line, turns(first.angle()), first.speed());
        for drive in [x, z, c] {
            field(line, position(drive, drive.actual));
        }
        field(line, turns(first.actual));
        for spindle in further {
            commanded(line, turns(spindle.angle()), spindle.speed());
            field(line, turns(spindle.actual));
        }
    }
}

/// A table being written.
#[derive(Debug)]
pub struct Table<W: Write> {
    pub(super) to: W,
    /// In the order of the columns.
    machines: Vec<Machine>,
    /// What every node's last heartbeat said.
    states: BTreeMap<NodeId, NmtState>,
    first: Option<Stamp>,
    line: Vec<u8>,
}

impl<W: Write> Table<W> {
    /// A table with its header, of the drives of these boards; the first has the number `board`.
    ///
    /// # Errors
    /// What it is written to does not take it.
    pub fn new(mut to: W, boards: &[Params], board: NodeId) -> io::Result<Self> {
        write!(to, "t_us,sync")?;
        for number in 1..=boards.len() {
            for column in COLUMNS {
                match number {
                    1 => write!(to, ",{column}")?,
                    _ => write!(to, ",b{number}_{column}")?,
                }
            }
        }
        writeln!(to, ",event")?;
        let mut machines: Vec<Machine> = boards.iter().map(Machine::new).collect();
        if let Some(first) = machines
            .first_mut()
            .filter(|first| first.together == Together::Unknown)
        {
            first.together = Together::Of(Setpoints::cob_id(board));
        }
        Ok(Self {
            to,
            machines,
            states: BTreeMap::new(),
            first: None,
            line: Vec::new(),
        })
    }

    /// Takes a packet.
    ///
    /// # Errors
    /// What it is written to does not take it.
    pub fn push(&mut self, time: Stamp, packet: &Packet) -> io::Result<()> {
        let first = *self.first.get_or_insert(time);
        let us = u64::try_from(time.since(first).as_micros()).unwrap_or(u64::MAX);
        match packet {
            Packet::Frame(frame) => self.frame(us, frame),
            Packet::Error(error) => self.event(us, &format!("bus: {error}")),
            Packet::Fd(frame) if self.setpoints(frame) => Ok(()),
            Packet::Fd(_) | Packet::Extended(..) | Packet::Remote(..) => {
                self.event(us, &format!("{}: not decoded", super::kind(packet)))
            }
        }
    }

    fn frame(&mut self, us: u64, frame: &Frame) -> io::Result<()> {
        if is_sync(frame) {
            let counter = frame.payload().first().copied();
            return self.row(us, counter);
        }
        if let Some((command, node)) = NmtCommand::decode(frame) {
            let whom = node.map_or("all nodes".into(), |node| format!("node {}", node.get()));
            return self.event(us, &format!("NMT to {whom}: {command:?}"));
        }
        if let Some((node, command)) = DriveCommand::decode(frame)
            && let Some(drive) = self.drive(node)
        {
            drive.target = Some(command.target);
        } else if let Some((node, command)) = SpindleCommand::decode(frame)
            && let Some(drive) = self.drive(node)
        {
            drive.spindle = Some(command);
        } else if let Some((node, status)) = DriveStatus::decode(frame)
            && let Some(drive) = self.drive(node)
        {
            drive.actual = Some(status.actual);
            let state = status.status.state();
            if state != drive.state {
                drive.state = state;
                let word = status.status.raw();
                let name = state.map_or("no state of CiA 402", State::name);
                return self.event(
                    us,
                    &format!("node {}: {name} (statusword {word:04X}h)", node.get()),
                );
            }
        } else if let Some((node, emergency)) = Emcy::decode(frame) {
            let detail: String = emergency.detail.iter().fold(String::new(), |mut text, b| {
                // Writing to a string cannot fail.
                let _ = write!(text, " {b:02X}");
                text
            });
            return self.event(
                us,
                &format!(
                    "node {}: emergency {:04X}h; error register {:02X}h; detail{detail}",
                    node.get(),
                    emergency.code,
                    emergency.register
                ),
            );
        } else if let Some((node, state)) = NmtState::decode(frame) {
            // A heartbeat that says what the last one said is no event.
            if self.states.insert(node, state) != Some(state) {
                return self.event(us, &format!("node {}: {state:?}", node.get()));
            }
        }
        Ok(())
    }

    /// True for the frame with all setpoints of one of the machines. Which number a further board has is not known
    /// beforehand: where there is one such, another frame of this kind is its.
    fn setpoints(&mut self, frame: &FdFrame) -> bool {
        let Id::Standard(id) = frame.id else {
            return false;
        };
        let of = |known| move |machine: &&mut Machine| machine.together == known;
        let mut known = self.machines.iter_mut().filter(of(Together::Of(id)));
        if let Some(machine) = known.next() {
            machine.setpoints(frame.data.bytes());
            return true;
        }
        let mut unknown = self.machines.iter_mut().filter(of(Together::Unknown));
        match (id.service(), unknown.next(), unknown.next()) {
            (Some((Service::Tpdo4, _)), Some(machine), None) => {
                machine.together = Together::Of(id);
                machine.setpoints(frame.data.bytes());
                true
            }
            _ => false,
        }
    }

    fn drive(&mut self, node: NodeId) -> Option<&mut Drive> {
        self.machines
            .iter_mut()
            .find_map(|machine| machine.drive(node))
    }

    /// A row with nothing but an event in it.
    fn event(&mut self, us: u64, text: &str) -> io::Result<()> {
        // A comma or a quotation mark would end the field.
        let text = text.replace('"', "'").replace(',', ";");
        let none = ",".repeat(1 + self.machines.len() * COLUMNS.len());
        writeln!(self.to, "{us},{none}{text}")
    }

    /// A row of a SYNC with this counter, which it need not have.
    fn row(&mut self, us: u64, counter: Option<u8>) -> io::Result<()> {
        let line = &mut self.line;
        line.clear();
        number::integer(line, us);
        line.push(b',');
        number::integer(line, u64::from(counter.unwrap_or(0)));
        for machine in &self.machines {
            machine.row(line);
        }
        line.extend_from_slice(b",\n");
        self.to.write_all(line)
    }
}

/// What a spindle is to do: its angle, or its speed.
fn commanded(line: &mut Vec<u8>, angle: Option<i64>, speed: Option<i64>) {
    field(line, angle);
    line.push(b',');
    if let Some(speed) = speed {
        number::decimal::<3>(line, speed);
    }
}

fn field(line: &mut Vec<u8>, value: Option<i64>) {
    line.push(b',');
    if let Some(value) = value {
        number::signed(line, value);
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_can::ErrorFrame;
    use leadscrew_core::bus::{self, Controlword, MilliRpm, Statusword, SyncProducer};
    use leadscrew_core::params::Entry;

    use super::*;

    const HEADER: &str = "t_us,sync,x_nm,z_nm,c_udeg,s1_urev,s1_rpm,\
                          x_actual_nm,z_actual_nm,c_actual_udeg,s1_actual_urev,\
                          s2_urev,s2_rpm,s2_actual_urev,s3_urev,s3_rpm,s3_actual_urev,\
                          s4_urev,s4_rpm,s4_actual_urev,event";

    #[test]
    fn the_drives_of_two_boards_stand_side_by_side() {
        let mut second = Params::sheets();
        for (key, raw) in [
            ("9015.X", 48),
            ("9015.Z", 49),
            ("9015.C", 50),
            ("9016", 64),
            // Two increments to a micrometre.
            ("9001.X", 1),
            ("9002.X", 500),
        ] {
            second.set(Entry::find_text(key).unwrap(), raw).unwrap();
        }
        let mut table = Table::new(Vec::new(), &[Params::sheets(), second], NodeId::BOARD).unwrap();
        let mut sync = SyncProducer::new();
        let target = |target, node| {
            let command = DriveCommand {
                control: Controlword::ENABLE_OPERATION,
                target: Increments::new(target),
            };
            command.frame(NodeId::new(node).unwrap())
        };
        let speed = SpindleCommand {
            mode: Mode::Velocity,
            velocity: MilliRpm::new(500_000),
        };
        for frame in [
            target(10, 16),
            target(20, 48),
            speed.frame(NodeId::new(65).unwrap()),
            sync.next(),
            NmtState::BootUp.frame(NodeId::new(49).unwrap()),
            NmtState::Operational.frame(NodeId::GATEWAY),
            NmtState::Operational.frame(NodeId::GATEWAY),
        ] {
            let at = Stamp::from_micros(0);
            table.push(at, &Packet::Frame(frame)).unwrap();
        }
        let text = String::from_utf8(table.to).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let [header, row, event, gateway] = lines[..] else {
            panic!("{text}");
        };
        let fields = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let header = fields(header);
        assert_eq!(header.len(), 39);
        assert_eq!(header[..20], fields(HEADER)[..20]);
        assert_eq!(header[20], "b2_x_nm");
        assert_eq!(header[37..], ["b2_s4_actual_urev", "event"]);
        let told: Vec<(String, String)> = header
            .into_iter()
            .zip(fields(row))
            .filter(|(_, value)| !value.is_empty())
            .collect();
        let expected = [
            ("t_us", "0"),
            ("sync", "1"),
            ("x_nm", "1000"),
            ("b2_x_nm", "10000"),
            ("b2_s2_rpm", "500"),
        ];
        let expected = expected.map(|(column, value)| (column.to_owned(), value.to_owned()));
        assert_eq!(told, expected);
        assert_eq!(fields(event).len(), 39);
        assert!(event.ends_with(",node 49: BootUp"), "{event}");
        assert!(gateway.ends_with(",node 127: Operational"), "{gateway}");
    }

    #[test]
    fn columns_are_those_of_the_drives_wherever_they_are() {
        let mut params = Params::sheets();
        // X is where Z is on the built-in machine, and there is one spindle only.
        for (key, node) in [("9015.X", 17), ("9015.Z", 33), ("9014", 1)] {
            let entry = Entry::find_text(key).unwrap();
            params.set(entry, node).unwrap();
        }
        let mut table = Table::new(Vec::new(), &[params], NodeId::BOARD).unwrap();
        let target = |target, node| {
            let command = DriveCommand {
                control: Controlword::ENABLE_OPERATION,
                target: Increments::new(target),
            };
            command.frame(NodeId::new(node).unwrap())
        };
        let frames = [target(10, 17), target(20, 33), target(30, 16)];
        for frame in frames.into_iter().chain([SyncProducer::new().next()]) {
            table
                .push(Stamp::from_micros(0), &Packet::Frame(frame))
                .unwrap();
        }
        let text = String::from_utf8(table.to).unwrap();
        assert_eq!(text, format!("{HEADER}\n0,1,1000,2000,,,,,,,,,,,,,,,,,\n"));
    }

    #[test]
    fn setpoints_in_one_frame_stand_where_those_of_many_would() {
        let mut params = Params::sheets();
        params.set(Entry::find_text("9031").unwrap(), 1).unwrap();
        let mut table = Table::new(Vec::new(), &[params], NodeId::new(3).unwrap()).unwrap();
        let content: Vec<u8> = [10_i32, -20, 30, 900_000]
            .into_iter()
            .flat_map(|target| [0x0F, 0].into_iter().chain(target.to_le_bytes()))
            .collect();
        let mut push = |packet| table.push(Stamp::from_micros(0), &packet).unwrap();
        for (id, content) in [(0x483, &content[..]), (0x481, &[0; 24])] {
            let frame = bus::FdFrame::new(CobId::new(id).unwrap(), content, true).unwrap();
            push(Packet::Fd((&frame).into()));
        }
        let rigid = SpindleCommand {
            mode: Mode::Position,
            velocity: MilliRpm::STOPPED,
        };
        push(Packet::Frame(rigid.frame(NodeId::SPINDLE_1)));
        push(Packet::Frame(SyncProducer::new().next()));
        let text = String::from_utf8(table.to).unwrap();
        // Another board's is no setpoint of these drives.
        let other = "0,,,,,,,,,,,,,,,,,,,,FD frame: not decoded";
        let row = "0,1,1000,-2000,3000,250000,,,,,,,,,,,,,,,";
        assert_eq!(text, format!("{HEADER}\n{other}\n{row}\n"));
    }

    #[test]
    fn setpoints_stand_at_the_sync_that_latches_them_and_events_where_they_happen() {
        let params = Params::sheets();
        let mut table = Table::new(Vec::new(), &[params], NodeId::BOARD).unwrap();
        let mut sync = SyncProducer::new();
        let mut us = 5_000_000;
        let mut push = |packet: Packet| {
            table.push(Stamp::from_micros(us), &packet).unwrap();
            us += 10;
        };
        let status = |raw, actual| DriveStatus {
            status: Statusword::from_raw(raw),
            actual: Increments::new(actual),
        };
        let target = |target| DriveCommand {
            control: Controlword::ENABLE_OPERATION,
            target: Increments::new(target),
        };
        for frame in [
            NmtState::BootUp.frame(NodeId::DRIVE_X),
            NmtCommand::Start.frame(Some(NodeId::DRIVE_X)),
            sync.next(),
            target(-12_345).frame(NodeId::DRIVE_X),
            SpindleCommand {
                mode: Mode::Velocity,
                velocity: MilliRpm::new(-300_500),
            }
            .frame(NodeId::SPINDLE_1),
            SpindleCommand {
                mode: Mode::Velocity,
                velocity: MilliRpm::new(200_000),
            }
            .frame(NodeId::SPINDLE_3),
            sync.next(),
            status(0x0237, 1_000).frame(NodeId::DRIVE_Z),
            status(0x0237, 1_001).frame(NodeId::DRIVE_Z),
            sync.next(),
            Emcy {
                code: 0x8611,
                register: 0x21,
                detail: [1, 0, 0, 0, 255],
            }
            .frame(NodeId::DRIVE_X),
        ] {
            push(Packet::Frame(frame));
        }
        push(Packet::Error(ErrorFrame {
            class: 0x40,
            data: [0; 8],
        }));
        // Drive increments of the built-in machine are 100 nm.
        let expected = [
            HEADER,
            "0,,,,,,,,,,,,,,,,,,,,node 16: BootUp",
            "10,,,,,,,,,,,,,,,,,,,,NMT to node 16: Start",
            "20,1,,,,,,,,,,,,,,,,,,,",
            "60,2,-1234500,,,,-300.5,,,,,,,,,200,,,,,",
            "70,,,,,,,,,,,,,,,,,,,,node 17: operation enabled (statusword 0237h)",
            "90,3,-1234500,,,,-300.5,,100100,,,,,,,200,,,,,",
            "100,,,,,,,,,,,,,,,,,,,,node 16: emergency 8611h; error register 21h; detail 01 00 00 00 FF",
            "110,,,,,,,,,,,,,,,,,,,,bus: bus-off",
            "",
        ];
        let text = String::from_utf8(table.to).unwrap();
        assert_eq!(text, expected.join("\n"));
        for line in text.lines() {
            assert_eq!(line.split(',').count(), 21, "{line}");
        }
    }
}
