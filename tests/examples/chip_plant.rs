//! The machine around a board that runs elsewhere, for the model of the chip (`tests/python/chip`): drives, spindle,
//! encoder. What is written on its standard input is answered on its standard output, until that ends.
//!
//! | request | answer |
//! |---|---|
//! | `a`: time goes by up to the next SYNC | count (i32), flags (1: an edge, 2: an index), age of the edge in ns (u32), count of the index (i32) |
//! | `x`, number, frames: of the board, in this order | number, frames: of the drives |
//! | `h`, number, frames: of somebody else | the same |
//! | `t`, a frame of CAN FD of the board: its identifier (u16), its length, so many bytes | nothing |
//! | `n`: everything is switched off and on again | nothing |
//!
//! A frame is its identifier (u16), its length, and eight bytes; numbers are little-endian. The arguments are parameters,
//! `9014=2`.

use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::process::ExitCode;

use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_common::params;
use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::{CobId, FdFrame, Frame};

fn main() -> ExitCode {
    match serve() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("chip_plant: {error}");
            ExitCode::FAILURE
        }
    }
}

fn serve() -> io::Result<()> {
    let options: Vec<String> = std::env::args().skip(1).collect();
    let wrong = |why: String| io::Error::new(ErrorKind::InvalidInput, why);
    let loaded = params::load(&[], &options, Lang::En)
        .map_err(|error| wrong(format!("the parameters: {error:?}")))?;
    if !loaded.is_good() {
        return Err(wrong(format!("the parameters: {options:?}")));
    }
    let make = || {
        let mut options = PlantOptions::default();
        options.drives.transmission = loaded.params.drive_status_syncs().try_into().unwrap_or(240);
        Plant::new(&loaded.params, &options)
            .map_err(|error| wrong(format!("the parameters make no machine: {error:?}")))
    };
    let mut plant = make()?;
    let mut input = BufReader::new(io::stdin());
    let mut output = io::stdout();
    let mut answer = Vec::new();
    while let Some(request) = byte(&mut input)? {
        answer.clear();
        match request {
            b'a' => {
                let sample = plant.advance();
                let flags =
                    u8::from(sample.edge_age_ns.is_some()) | u8::from(sample.index.is_some()) << 1;
                answer.extend(sample.count.to_le_bytes());
                answer.push(flags);
                answer.extend(sample.edge_age_ns.unwrap_or(0).to_le_bytes());
                answer.extend(sample.index.unwrap_or(0).to_le_bytes());
            }
            b'x' | b'h' => {
                let mut answers = Vec::new();
                for frame in frames(&mut input)? {
                    if request == b'x' {
                        plant.exchange(&[frame], |frame| answers.push(frame));
                    } else {
                        plant.hear(&frame, |frame| answers.push(frame));
                    }
                }
                put(&answers, &mut answer);
            }
            b't' => plant.tell_together(&together(&mut input)?),
            b'n' => plant = make()?,
            other => return Err(wrong(format!("request {other}"))),
        }
        output.write_all(&answer)?;
        output.flush()?;
    }
    Ok(())
}

fn byte(input: &mut impl Read) -> io::Result<Option<u8>> {
    let mut byte = [0];
    match input.read_exact(&mut byte) {
        Ok(()) => Ok(Some(byte[0])),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error),
    }
}

fn frames(input: &mut impl Read) -> io::Result<Vec<Frame>> {
    let count = byte(input)?.unwrap_or(0);
    let mut frames = Vec::new();
    for _ in 0..count {
        let mut bytes = [0; 11];
        input.read_exact(&mut bytes)?;
        let [low, high, length, data @ ..] = bytes;
        let frame = CobId::new(u16::from_le_bytes([low, high]))
            .zip(data.get(..length.into()))
            .and_then(|(id, data)| Frame::new(id, data));
        frames.push(frame.ok_or(ErrorKind::InvalidData)?);
    }
    Ok(frames)
}

fn together(input: &mut impl Read) -> io::Result<FdFrame> {
    let mut head = [0; 3];
    input.read_exact(&mut head)?;
    let [low, high, length] = head;
    let mut data = vec![0; length.into()];
    input.read_exact(&mut data)?;
    let id = CobId::new(u16::from_le_bytes([low, high]));
    let frame = id.and_then(|id| FdFrame::new(id, &data, true));
    frame.ok_or_else(|| ErrorKind::InvalidData.into())
}

fn put(frames: &[Frame], answer: &mut Vec<u8>) {
    answer.push(frames.len() as u8);
    for frame in frames {
        let payload = frame.payload();
        let mut data = [0; 8];
        data[..payload.len()].copy_from_slice(payload);
        answer.extend(frame.id().get().to_le_bytes());
        answer.push(payload.len() as u8);
        answer.extend(data);
    }
}
