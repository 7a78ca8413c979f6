//! A bus in this process: a simulated board with its drives, in real time.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use leadscrew_board_sim::Sim;
use leadscrew_can::{Can, CanError, Filter, Packet, Received, Stamp};
use leadscrew_core::bus::{self, Frame};

/// Time between two looks for frames of the board.
const LOOK: Duration = Duration::from_micros(200);
/// The most ticks in one go: after a long pause of this process the lost time is not made up.
const BURST: u64 = 100;

/// The machine, shared with the owner of its flash.
#[derive(Clone)]
pub struct Inside {
    sim: Arc<Mutex<Box<Sim>>>,
    filters: Vec<Filter>,
    tick_us: u64,
    began: Instant,
    ticks: u64,
}

impl std::fmt::Debug for Inside {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Inside({} ticks)", self.ticks)
    }
}

impl Inside {
    /// A machine that has joined its bus.
    #[must_use]
    pub fn new(sim: Box<Sim>, tick_us: u32) -> Self {
        Self {
            sim: Arc::new(Mutex::new(sim)),
            filters: Vec::new(),
            tick_us: u64::from(tick_us).max(1),
            began: Instant::now(),
            ticks: 0,
        }
    }

    /// The machine.
    pub fn sim(&self) -> MutexGuard<'_, Box<Sim>> {
        // No thread panics while it holds the lock. After a panic the machine would still be whole.
        self.sim.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs the machine up to the present time.
    fn catch_up(&mut self) {
        let now = u64::try_from(self.began.elapsed().as_micros()).unwrap_or(u64::MAX);
        let due = now / self.tick_us;
        self.ticks = self.ticks.max(due.saturating_sub(BURST));
        let ticks = due.saturating_sub(self.ticks);
        self.ticks = due;
        let mut sim = self.sim();
        for _ in 0..ticks {
            let _ = sim.step();
            while sim.event().is_some() {}
        }
    }
}

impl Can for Inside {
    fn name(&self) -> &str {
        "sim"
    }

    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError> {
        self.catch_up();
        let mut sim = self.sim();
        for frame in frames {
            sim.receive(frame);
            sim.settle();
        }
        Ok(())
    }

    fn use_fd(&mut self, _data_kbit: u32) -> Result<(), CanError> {
        Ok(())
    }

    /// No node on this bus listens for them.
    fn send_fd(&mut self, _frames: &[bus::FdFrame]) -> Result<(), CanError> {
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError> {
        let end = Instant::now() + patience;
        loop {
            self.catch_up();
            let before = into.len();
            let mut sim = self.sim();
            while let Some(frame) = sim.transmit() {
                let packet = Packet::Frame(frame);
                if Filter::any_passes(&self.filters, &packet) {
                    let time = Stamp::now();
                    into.push(Received { time, packet });
                }
            }
            drop(sim);
            let count = into.len() - before;
            let now = Instant::now();
            if count > 0 || now >= end {
                return Ok(count);
            }
            std::thread::sleep(LOOK.min(end - now));
        }
    }

    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError> {
        self.filters = filters.to_vec();
        Ok(())
    }

    fn dropped(&self) -> Result<u64, CanError> {
        Ok(0)
    }
}
