//! Figures for Prometheus: what machines do now, and counts since the agent began. Each figure of a machine has its name in
//! the label `machine`.
//!
//! ```text
//! machine   what the records of one machine are in figures
//! server    gives the text to who asks for /metrics
//! ```
//!
//! What is here says nothing of a single thread or event; that is what records are for.

mod machine;
mod server;

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::AtomicU64;

use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::Registry;

use crate::record::Numbered;
use crate::store::Figures;

use machine::Of;
pub use server::Server;

type Labels = Vec<(&'static str, String)>;
type Histograms = Family<Labels, Histogram, fn() -> Histogram>;
type Float = Gauge<f64, AtomicU64>;

/// Metres in a micrometre: figures are in units without a prefix.
const UM: f64 = 1e-6;
/// Bounds of the errors against the spindle, in metres: what a good thread has, to what no gauge takes.
const ERRORS: [f64; 10] = [1e-7, 2e-7, 5e-7, 1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4];

/// The same of the cut, which has the lag of a drive in it where that is not compensated.
const CUTS: [f64; 12] = [
    5e-7, 1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3,
];

/// What a board says of itself beside its state.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pulse {
    /// Ticks since power-up.
    pub ticks: u64,
    /// Free room of its queue of calls in bytes.
    pub credit: u16,
    /// Frames that were lost at this end of the bus.
    pub dropped: u64,
}

/// The figures.
#[derive(Debug)]
pub struct Metrics {
    registry: Registry,
    up: Family<Labels, Gauge>,
    info: Family<Labels, Gauge>,
    state: Family<Labels, Gauge>,
    alarm: Family<Labels, Gauge>,
    alarms: Family<Labels, Counter>,
    warnings: Family<Labels, Counter>,
    late: Family<Labels, Gauge>,
    load: Family<Labels, Float>,
    errors: Family<Labels, Gauge>,
    dropped: Family<Labels, Gauge>,
    ticks: Family<Labels, Gauge>,
    credit: Family<Labels, Gauge>,
    overrides: Family<Labels, Gauge>,
    speed: Family<Labels, Gauge>,
    threads: Family<Labels, Counter>,
    largest: Histograms,
    rms: Histograms,
    cuts: Family<Labels, Counter>,
    cut: Histograms,
    cut_doubt: Histograms,
    cut_apart: Histograms,
    runs: Family<Labels, Counter>,
    missing: Family<Labels, Counter>,
    broker: Gauge,
    kept: Gauge,
    kept_bytes: Gauge,
    given_up: Gauge,
    known: Mutex<BTreeMap<String, Labels>>,
}

impl Default for Metrics {
    fn default() -> Self {
        let mut registry = Registry::with_prefix("leadscrew");
        macro_rules! figure {
            ($metric:expr, $name:literal, $help:literal) => {{
                let metric = $metric;
                registry.register($name, $help, metric.clone());
                metric
            }};
        }
        Self {
            up: figure!(Family::default(), "board_up", "The board answers"),
            info: figure!(
                Family::default(),
                "board",
                "Serial number, start, firmware and parameters of the board"
            ),
            state: figure!(
                Family::default(),
                "machine_state",
                "What the machine does: one state is 1"
            ),
            alarm: figure!(
                Family::default(),
                "machine_alarm",
                "Number of the present alarm, 0 for none"
            ),
            alarms: figure!(
                Family::default(),
                "alarms",
                "Alarms by number since the agent began"
            ),
            warnings: figure!(
                Family::default(),
                "warnings",
                "Warnings by number since the agent began"
            ),
            late: figure!(
                Family::default(),
                "late_setpoints",
                "Setpoints that came late for their SYNC since power-up of the board"
            ),
            load: figure!(
                Family::default(),
                "bus_load_ratio",
                "Load of the bus, with the worst stuffing"
            ),
            errors: figure!(
                Family::default(),
                "bus_error_frames",
                "Error frames since the agent met the board"
            ),
            dropped: figure!(
                Family::default(),
                "bus_dropped_frames",
                "Frames that this computer did not read in time"
            ),
            ticks: figure!(
                Family::default(),
                "board_ticks",
                "Ticks since power-up of the board"
            ),
            credit: figure!(
                Family::default(),
                "queue_free_bytes",
                "Free room of the board's queue of calls"
            ),
            overrides: figure!(
                Family::default(),
                "override_percent",
                "Overrides in per cent"
            ),
            speed: figure!(
                Family::default(),
                "spindle_speed_rpm",
                "Speed of the spindle"
            ),
            threads: figure!(
                Family::default(),
                "threads",
                "Threads and holes by kind and end since the agent began"
            ),
            largest: figure!(
                Histograms::new_with_constructor(|| Histogram::new(ERRORS)),
                "thread_largest_error_metres",
                "Largest error of each thread against the spindle"
            ),
            rms: figure!(
                Histograms::new_with_constructor(|| Histogram::new(ERRORS)),
                "thread_rms_error_metres",
                "RMS error of each thread against the spindle"
            ),
            cuts: figure!(
                Family::default(),
                "thread_cuts",
                "Threads by how much is known of their cut since the agent began"
            ),
            cut: figure!(
                Histograms::new_with_constructor(|| Histogram::new(CUTS)),
                "thread_cut_error_metres",
                "Largest error of the cut of each thread, by the positions of the drive"
            ),
            cut_doubt: figure!(
                Histograms::new_with_constructor(|| Histogram::new(CUTS)),
                "thread_cut_uncertainty_metres",
                "Uncertainty of that error, plus or minus"
            ),
            cut_apart: figure!(
                Histograms::new_with_constructor(|| Histogram::new(CUTS)),
                "thread_cut_pass_to_pass_metres",
                "Distance between the grooves of the passes of each thread"
            ),
            runs: figure!(
                Family::default(),
                "runs",
                "Programs that have ended since the agent began"
            ),
            missing: figure!(
                Family::default(),
                "missing",
                "What the board forgot before it was read, since the agent began"
            ),
            broker: figure!(
                Gauge::default(),
                "agent_broker_up",
                "A broker takes what is kept"
            ),
            kept: figure!(
                Gauge::default(),
                "agent_kept_records",
                "Records that no broker has yet"
            ),
            kept_bytes: figure!(
                Gauge::default(),
                "agent_kept_bytes",
                "Bytes of these records"
            ),
            given_up: figure!(
                Gauge::default(),
                "agent_lost_records",
                "Records that were given up for want of room, in all"
            ),
            known: Mutex::default(),
            registry,
        }
    }
}

fn number(value: impl TryInto<i64>) -> i64 {
    value.try_into().unwrap_or(i64::MAX)
}

impl Metrics {
    /// Takes what records say.
    pub fn take(&self, records: &[Numbered]) {
        for record in records {
            self.of(&record.record.machine).take(&record.record.body);
        }
    }

    /// A machine that may never be met: its board does not answer.
    pub fn expect(&self, machine: &str) {
        self.of(machine).set(&self.up, 0);
    }

    /// Takes what a board says of itself.
    pub fn pulse(&self, machine: &str, pulse: Pulse) {
        let of = self.of(machine);
        of.set(&self.ticks, number(pulse.ticks));
        of.set(&self.credit, pulse.credit.into());
        of.set(&self.dropped, number(pulse.dropped));
    }

    /// Takes how it stands with what is kept.
    pub fn kept(&self, figures: &Figures, connected: bool) {
        self.broker.set(connected.into());
        self.kept.set(number(figures.records));
        self.kept_bytes.set(number(figures.bytes));
        self.given_up.set(number(figures.lost));
    }

    const fn of<'a>(&'a self, machine: &'a str) -> Of<'a> {
        Of { all: self, machine }
    }

    /// All of it in the text format of OpenMetrics.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        // Text is written to memory.
        let _ = encode(&mut text, &self.registry);
        text
    }
}
