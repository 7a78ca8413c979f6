//! A program of any length that is never in memory as a whole: it is made while it is read.
//!
//! Most long programs in a workshop come from a CAM system: a numbered line for every short move, and a remark. This
//! program is the same, with a thread from time to time. The shares of words, remarks and blanks are counted.

use std::io::{self, Read};

/// Blocks between two threads.
const BETWEEN_THREADS: u64 = 5_000;

/// The parts of the text so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// All bytes.
    pub bytes: u64,
    /// Bytes of words with a meaning for a machine.
    pub code: u64,
    /// Bytes of remarks, parentheses included.
    pub remarks: u64,
    /// Lines.
    pub lines: u64,
    /// Short moves, each a block.
    pub moves: u64,
    /// Threads of several passes.
    pub threads: u64,
}

/// The text, from its front.
#[derive(Debug)]
pub struct LongProgram {
    /// It ends with the first block after so many bytes.
    at_least: u64,
    share: Share,
    /// The block being read, and the place in it.
    block: Vec<u8>,
    read: usize,
    ended: bool,
}

impl LongProgram {
    /// A program of so many bytes, and at most a block more.
    #[must_use]
    pub fn new(at_least: u64) -> Self {
        let mut program = Self {
            at_least,
            share: Share::default(),
            block: Vec::new(),
            read: 0,
            ended: false,
        };
        program.line("O0100", "made to be long");
        program.line("G98 M03 S600", "");
        program.line("G04 P500", "");
        program.line("G00 X40. Z0", "");
        program
    }

    /// The parts made so far.
    #[must_use]
    pub const fn share(&self) -> Share {
        self.share
    }

    fn line(&mut self, code: &str, remark: &str) {
        let text = if remark.is_empty() {
            format!("{code}\n")
        } else {
            format!("{code}   ({remark})\n")
        };
        self.block.extend_from_slice(text.as_bytes());
        self.share.bytes += text.len() as u64;
        let blanks = code.matches(' ').count();
        self.share.code += (code.len() - blanks) as u64;
        if !remark.is_empty() {
            self.share.remarks += remark.len() as u64 + 2;
        }
        self.share.lines += 1;
    }

    fn next_block(&mut self) {
        self.block.clear();
        self.read = 0;
        if self.ended {
            return;
        }
        if self.share.bytes >= self.at_least {
            self.ended = true;
            self.line("G00 X100. Z50.", "");
            self.line("M30", "");
            return;
        }
        self.share.moves += 1;
        let number = self.share.moves;
        let (x, z) = (5 * (number % 7), 5 * (number % 11));
        let code = format!("N{number:07} G01 X40.{x:03} Z-0.{z:03} F6000");
        let insert = number / 100;
        self.line(&code, &format!("wear of insert {insert:06} allowed for"));
        if number.is_multiple_of(BETWEEN_THREADS) {
            self.share.threads += 1;
            self.line("G00 X44. Z4.", "");
            self.line("G76 P010060 Q1500 R0.05", "");
            self.line("G76 X39.5 Z-6. P2500 Q1500 F1.", "M40x1, two depths");
            self.line("G01 X40.", "");
        }
    }
}

impl Read for LongProgram {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.read == self.block.len() {
            self.next_block();
        }
        let left = self.block.get(self.read..).unwrap_or_default();
        let count = left.len().min(buffer.len());
        buffer[..count].copy_from_slice(&left[..count]);
        self.read += count;
        Ok(count)
    }
}
