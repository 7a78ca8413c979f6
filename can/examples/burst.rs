//! Sends numbered frames: `burst IFACE COUNT [BURST [PAUSE_US]]`, BURST at a time (2000), with a pause between them (0).

use std::time::Duration;

use leadscrew_can::{Can as _, SocketCan};
use leadscrew_core::bus::{CobId, Frame};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [interface, count, more @ ..] = args.as_slice() else {
        return Err("usage: burst IFACE COUNT [BURST [PAUSE_US]]".into());
    };
    let number = |place: usize, default: &str| -> Result<u32, std::num::ParseIntError> {
        more.get(place).map_or(default, String::as_str).parse()
    };
    let (count, burst, pause): (u32, u32, u32) =
        (count.parse()?, number(0, "2000")?, number(1, "0")?);
    let mut can = SocketCan::open(interface)?;
    let id = CobId::new(0x100).ok_or("no identifier")?;
    for first in (0..count).step_by(burst.max(1) as usize) {
        let frames: Vec<Frame> = (first..count.min(first + burst.max(1)))
            .filter_map(|n| Frame::new(id, &u64::from(n).to_le_bytes()))
            .collect();
        can.send(&frames)?;
        if pause > 0 {
            std::thread::sleep(Duration::from_micros(pause.into()));
        }
    }
    Ok(())
}
