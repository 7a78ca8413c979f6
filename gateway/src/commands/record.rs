//! `record`: what is on a bus, into a file, until Ctrl-C.

use std::fs::File;
use std::io::{self, Write as _};
use std::time::Duration;

use leadscrew_can::{CanError, Health, Received, Suspicion};
use leadscrew_core::alarm::Lang;
use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::NodeId;
use leadscrew_core::params::Params;

use crate::cli::Record;
use crate::failure::{Doing, Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::output;
use crate::params;
use crate::recording::{Format, Recording};
use crate::setup::{Setup, told_good};
use crate::words::{self, both};

/// How long to listen before the file is brought up to date.
const PATIENCE: Duration = Duration::from_millis(200);

/// Records until the user ends it, the wanted number has come, or the bus is gone.
pub fn run(setup: &Setup, args: &Record) -> Outcome {
    let path = &args.output;
    let format = Format::of(path).ok_or_else(|| {
        Failure::Usage(both!(
            "`{path}`: the ending says what is written: `.log` a candump log, `.csv` a table of setpoints and events",
            "`{path}`：扩展名决定格式：`.log` 为 candump 记录，`.csv` 为设定点与事件表",
            path = words::path(path)
        ))
    })?;
    let boards = boards(setup, args)?;
    let mut bus =
        leadscrew_can::open(&setup.global.bus, setup.global.bit_rate()?).map_err(Failure::bus)?;
    if setup.params.setpoint_frame() == 1 {
        bus.use_fd(setup.params.fd_kbit()).map_err(Failure::bus)?;
    }
    let unwritable = |error: &io::Error| Failure::file(Doing::Write, path.display(), error);
    let file = File::create(path).map_err(|error| unwritable(&error))?;
    let mut recording = Recording::new(format, file, bus.name(), &boards, setup.global.node())
        .map_err(|error| unwritable(&error))?;

    interrupt::defer(UnderWay::Computed);
    let mut watch = Watch {
        // Where setpoints are expected in them, they are read.
        fd_told: boards.iter().any(|board| board.setpoint_frame() == 1),
        ..Watch::default()
    };
    let mut heard: Vec<Received> = Vec::new();
    let mut left = args.count.unwrap_or(u64::MAX);
    let mut end = Ok(());
    while left > 0 && !interrupt::requested() {
        heard.clear();
        let count = match bus.receive(&mut heard, PATIENCE) {
            Ok(count) => count,
            Err(error) => {
                end = Err(error);
                break;
            }
        };
        // What the kernel hands over at once may be more than was asked for.
        heard.truncate(usize::try_from(left).unwrap_or(usize::MAX));
        left -= heard.len() as u64;
        recording.push(&heard).map_err(|error| unwritable(&error))?;
        for received in &heard {
            watch.health.note(&received.packet);
        }
        watch.tell(setup.lang);
        if count == 0 {
            recording.flush().map_err(|error| unwritable(&error))?;
        }
    }
    recording.flush().map_err(|error| unwritable(&error))?;
    let dropped = bus.dropped().unwrap_or(0);
    watch.conclude(setup, &words::path(path), dropped)?;
    end.map_err(|error: CanError| Failure::bus(error))
}

/// The sets of all boards: the one of the options, and the further ones. No two of their drives have one number.
fn boards(setup: &Setup, args: &Record) -> Outcome<Vec<Params>> {
    let mut boards = vec![setup.params.clone()];
    for path in &args.further {
        let loaded = params::load(std::slice::from_ref(path), &[], setup.lang)?;
        boards.push(told_good(setup.global, loaded)?.params);
    }
    let drives: Vec<DriveNodes> = boards.iter().map(DriveNodes::of).collect();
    for (place, path) in args.further.iter().enumerate() {
        let Some((own, before)) = drives.get(..place + 2).and_then(<[_]>::split_last) else {
            break;
        };
        let shared = |node: &NodeId| before.iter().any(|drives| drives.letter(*node).is_some());
        let nodes = (1..=127).filter_map(NodeId::new);
        let mut nodes = nodes.filter(|node| own.letter(*node).is_some());
        if let Some(node) = nodes.find(shared) {
            return Err(Failure::WrongBecause(both!(
                "`{path}`: node {node} is a drive of another board, too: two boards on one bus have drives of their own \
                 (parameters 9015 and 9016)",
                "`{path}`：节点 {node} 也是另一块控制板的驱动器：同一总线上的两块控制板各有自己的驱动器（参数 9015 和 9016）",
                path = words::path(path),
                node = node.get()
            )));
        }
    }
    Ok(boards)
}

/// What was heard so far, and what of it has been told.
#[derive(Default)]
struct Watch {
    health: Health,
    told: Option<Suspicion>,
    fd_told: bool,
}

impl Watch {
    /// Says at once what is wrong with the bus, and once.
    fn tell(&mut self, lang: Lang) {
        let suspicion = self.health.suspicion();
        let same = match (suspicion, self.told) {
            // The counters alone are no news.
            (Some(Suspicion::Passive(_)), Some(Suspicion::Passive(_))) => true,
            (new, old) => new == old,
        };
        self.told = suspicion;
        if let Some(suspicion) = suspicion
            && !same
        {
            // A closed standard error leaves nobody to tell.
            let told = both!(
                "warning: {suspicion}",
                "警告：{zh}",
                zh = suspicion.chinese()
            );
            let _ = writeln!(io::stderr(), "{}", told.get(lang));
        }
        if self.health.fd_frames > 0 && !self.fd_told {
            self.fd_told = true;
            let told = both!(
                "warning: there are CAN FD frames on this bus; they are recorded, and nothing here reads them",
                "警告：总线上有 CAN FD 报文；它们会被记录，但不会被解读"
            );
            let _ = writeln!(io::stderr(), "{}", told.get(lang));
        }
    }

    fn conclude(&self, setup: &Setup, path: &str, dropped: u64) -> Outcome {
        let health = &self.health;
        if setup.global.json {
            return output::json(|o| {
                o.flag("ok", dropped == 0);
                for (key, count) in [
                    ("packets", health.frames),
                    ("fd_frames", health.fd_frames),
                    ("error_frames", health.errors),
                    ("dropped", dropped),
                ] {
                    o.integer(key, i64::try_from(count).unwrap_or(i64::MAX));
                }
            });
        }
        let lost = if dropped > 0 {
            both!(
                ", {dropped} lost because the receive buffer was full",
                "，{dropped} 帧因接收缓冲区已满而丢失"
            )
        } else {
            both!(", none lost", "，没有丢失")
        };
        let text = both!(
            "{path}: {frames} frames, {errors} error frames{en}\n",
            "{path}：{frames} 帧，错误帧 {errors}{zh}\n",
            frames = health.frames,
            errors = health.errors,
            en = lost.en,
            zh = lost.zh
        );
        // Words for people; the data is in the file.
        let _ = io::stderr().write_all(text.get(setup.lang).as_bytes());
        Ok(())
    }
}
