//! Who else is there, and who is asked.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use leadscrew_board_sim::plant::Flash;
use leadscrew_can::{Can, CanError, Filter, Packet, Received, Stamp};
use leadscrew_core::bus::{
    BoardFlags, BoardState, BoardStatus, CobId, FdFrame, Frame, NmtState, NodeId, Service,
};
use leadscrew_core::params::{Entry, Params};

use super::super::bench::machine_of;
use super::super::{Inside, Link};

/// Between two frames of the others.
const PACE: Duration = Duration::from_millis(1);
/// Frames of somebody else's transfer.
const TRANSFER: usize = 250;

fn node(number: u8) -> NodeId {
    NodeId::new(number).unwrap()
}

/// Frames to other nodes, as they were on the wire.
type Talk = Arc<Mutex<Vec<Frame>>>;

/// What others say, one frame after the other.
type Others = Box<dyn Iterator<Item = Frame> + Send>;

/// A board's wire on which others are, too, and some are boards. Whoever has not
/// listened for a while hears all at once what was said meanwhile.
struct Wire {
    inside: Inside,
    filters: Vec<Filter>,
    others: Others,
    next: Instant,
    answers: VecDeque<Frame>,
    boards: Vec<NodeId>,
    talk: Talk,
}

impl Can for Wire {
    fn name(&self) -> &str {
        "wire"
    }

    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError> {
        self.inside.send(frames)?;
        for frame in frames {
            let Some((Service::SdoRequest, to)) = frame.id().service() else {
                continue;
            };
            if to == NodeId::BOARD {
                continue;
            }
            self.talk.lock().unwrap().push(*frame);
            if self.boards.contains(&to) && frame.payload().starts_with(&[0x40, 0x18, 0x10, 2]) {
                let answer = [0x43, 0x18, 0x10, 2, b'W', b'C', b'S', b'L'];
                let id = CobId::of(Service::SdoReply, to);
                self.answers.push_back(Frame::new(id, &answer).unwrap());
            }
        }
        Ok(())
    }

    fn use_fd(&mut self, data_kbit: u32) -> Result<(), CanError> {
        self.inside.use_fd(data_kbit)
    }

    fn send_fd(&mut self, frames: &[FdFrame]) -> Result<(), CanError> {
        self.inside.send_fd(frames)
    }

    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError> {
        let (before, end) = (into.len(), Instant::now() + patience);
        loop {
            let now = Instant::now();
            self.take(now, into);
            let left = end.saturating_duration_since(now);
            let patience = match into.len() - before {
                0 => left.min(PACE),
                _ => Duration::ZERO,
            };
            self.inside.receive(into, patience)?;
            let count = into.len() - before;
            if count > 0 || left.is_zero() {
                return Ok(count);
            }
        }
    }

    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError> {
        self.filters = filters.to_vec();
        self.inside.listen_for(filters)
    }

    fn dropped(&self) -> Result<u64, CanError> {
        Ok(0)
    }
}

impl Wire {
    /// What has been said until now.
    fn take(&mut self, now: Instant, into: &mut Vec<Received>) {
        let mut said: Vec<Frame> = self.answers.drain(..).collect();
        while now >= self.next {
            self.next += PACE;
            said.extend(self.others.next());
        }
        for frame in said {
            if matches!(frame.id().service(), Some((Service::SdoRequest, _))) {
                self.talk.lock().unwrap().push(frame);
            }
            let packet = Packet::Frame(frame);
            if Filter::any_passes(&self.filters, &packet) {
                let time = Stamp::now();
                into.push(Received { time, packet });
            }
        }
    }
}

/// A link to a board that beats every 10 ms, so that others are not listened for any longer; its drives have numbers that
/// are not the usual ones.
fn beside(others: impl Iterator<Item = Frame> + Send + 'static, boards: &[NodeId]) -> (Link, Talk) {
    let mut params = Params::sheets();
    for (key, raw) in [("9023", 10), ("9015.X", 40), ("9016", 50)] {
        params.set(Entry::find_text(key).unwrap(), raw).unwrap();
    }
    let talk = Talk::default();
    let wire = Wire {
        inside: machine_of(&params, Flash::erased()),
        filters: Vec::new(),
        others: Box::new(others),
        next: Instant::now(),
        answers: VecDeque::new(),
        boards: boards.to_vec(),
        talk: talk.clone(),
    };
    (Link::on(Box::new(wire), NodeId::BOARD), talk)
}

fn status(number: u8) -> Frame {
    let status = BoardStatus {
        state: BoardState::Idle,
        flags: BoardFlags::default(),
        alarm: None,
        count: 0,
        late: 0,
        credit: 0,
    };
    status.frame(node(number))
}

#[test]
fn a_board_at_work_and_a_drive_are_not_asked() {
    let beat = |number| NmtState::Operational.frame(node(number));
    let drive = CobId::of(Service::Tpdo1, node(70));
    let said = [
        status(2),
        beat(2),
        beat(3),
        // Drives of this board: X, and the third spindle.
        beat(40),
        beat(52),
        // A drive of another one.
        Frame::new(drive, &[0x37, 2, 0, 0, 0, 0]).unwrap(),
        beat(70),
        // No board.
        beat(90),
    ];
    // Whenever it is listened for.
    let said = said.into_iter().cycle();
    let (mut link, talk) = beside(said, &[2, 3, 40, 52, 70].map(node));
    assert_eq!(link.other_boards().unwrap(), [2, 3].map(node));
    let asked: std::collections::BTreeSet<u8> = talk
        .lock()
        .unwrap()
        .iter()
        .filter_map(|frame| frame.id().service())
        .map(|(_, node)| node.get())
        .collect();
    assert_eq!(asked.into_iter().collect::<Vec<_>>(), [3, 90]);
}

/// [D171]
#[test]
fn nobody_is_asked_in_the_middle_of_somebody_else_s_transfer() {
    let beat = NmtState::Operational.frame(node(3));
    let request = CobId::of(Service::SdoRequest, node(3));
    let block = move |n: usize| {
        let segment = (n % 127 + 1) as u8;
        Frame::new(request, &[segment, 0, 0, 0, 0, 0, 0, 0]).unwrap()
    };
    let transfer = (0..TRANSFER).flat_map(move |n| {
        let beat = (n % 8 == 0).then_some(beat);
        beat.into_iter().chain([block(n)])
    });
    let said = transfer.chain(std::iter::repeat(beat));
    let (mut link, talk) = beside(said, &[node(3)]);
    assert_eq!(link.other_boards().unwrap(), [node(3)]);
    let talk = talk.lock().unwrap();
    let question = |frame: &Frame| frame.payload().starts_with(&[0x40, 0x18, 0x10, 2]);
    let before = talk.iter().take_while(|frame| !question(frame)).count();
    assert_eq!(before, TRANSFER);
}
