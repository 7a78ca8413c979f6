//! What is heard on a bus, kept: as a candump log, or as a table of setpoints and events.

mod table;

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use leadscrew_can::{LogWriter, Packet, Received};
use leadscrew_core::bus::NodeId;
use leadscrew_core::params::Params;

pub use table::Table;

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `candump -l`.
    Log,
    /// Setpoints and events.
    Csv,
}

impl Format {
    /// By the ending of the name.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "log" => Some(Self::Log),
            "csv" => Some(Self::Csv),
            _ => None,
        }
    }
}

/// A recording being written.
#[derive(Debug)]
pub enum Recording {
    /// A candump log.
    Log(LogWriter<BufWriter<File>>),
    /// A table.
    Csv(Box<Table<BufWriter<File>>>),
}

impl Recording {
    /// Begins a recording of the bus with this name, and these boards on it; the first has the number `board`.
    ///
    /// # Errors
    /// The file does not take it.
    pub fn new(
        format: Format,
        file: File,
        bus: &str,
        boards: &[Params],
        board: NodeId,
    ) -> io::Result<Self> {
        let file = BufWriter::with_capacity(1 << 16, file);
        Ok(match format {
            Format::Log => Self::Log(LogWriter::new(file, bus)),
            Format::Csv => Self::Csv(Box::new(Table::new(file, boards, board)?)),
        })
    }

    /// Appends what was heard.
    ///
    /// # Errors
    /// The file does not take it.
    pub fn push(&mut self, heard: &[Received]) -> io::Result<()> {
        for received in heard {
            match self {
                Self::Log(log) => log.push(received.time, &received.packet)?,
                Self::Csv(table) => table.push(received.time, &received.packet)?,
            }
        }
        Ok(())
    }

    /// Brings what there is so far to the file.
    ///
    /// # Errors
    /// The file does not take it.
    pub fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Log(log) => log.flush(),
            Self::Csv(table) => table.to.flush(),
        }
    }
}

/// A packet in a word, for people.
#[must_use]
pub fn kind(packet: &Packet) -> &'static str {
    match packet {
        Packet::Frame(_) => "frame",
        Packet::Extended(..) => "extended frame",
        Packet::Remote(..) => "remote request",
        Packet::Fd(_) => "FD frame",
        Packet::Error(_) => "error frame",
    }
}
