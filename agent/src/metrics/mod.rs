//! Figures for Prometheus: what a machine does now, and counts since the agent began.
//!
//! ```text
//! server   gives the text to who asks for /metrics
//! ```
//!
//! What is here says nothing of a single thread or event; that is what records are for.

mod server;

use std::sync::atomic::AtomicU64;
use std::sync::{Mutex, PoisonError};

use leadscrew_core::bus::BoardState;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::Registry;

use crate::record::{Body, Cut, Figure, Identity, Loss, Numbered, State, Thread, What};
use crate::store::Figures;

pub use server::Server;

type Labels = Vec<(&'static str, String)>;
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
    up: Gauge,
    info: Family<Labels, Gauge>,
    state: Family<Labels, Gauge>,
    alarm: Gauge,
    alarms: Family<Labels, Counter>,
    warnings: Family<Labels, Counter>,
    late: Gauge,
    load: Float,
    errors: Gauge,
    dropped: Gauge,
    ticks: Gauge,
    credit: Gauge,
    overrides: Family<Labels, Gauge>,
    speed: Family<Labels, Gauge>,
    threads: Family<Labels, Counter>,
    largest: Histogram,
    rms: Histogram,
    cuts: Family<Labels, Counter>,
    cut: Histogram,
    cut_doubt: Histogram,
    cut_apart: Histogram,
    runs: Family<Labels, Counter>,
    missing: Family<Labels, Counter>,
    broker: Gauge,
    kept: Gauge,
    kept_bytes: Gauge,
    given_up: Gauge,
    known: Mutex<Option<Labels>>,
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
            up: figure!(Gauge::default(), "board_up", "The board answers"),
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
                Gauge::default(),
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
                Gauge::default(),
                "late_setpoints",
                "Setpoints that came late for their SYNC since power-up of the board"
            ),
            load: figure!(
                Float::default(),
                "bus_load_ratio",
                "Load of the bus, with the worst stuffing"
            ),
            errors: figure!(
                Gauge::default(),
                "bus_error_frames",
                "Error frames since the agent met the board"
            ),
            dropped: figure!(
                Gauge::default(),
                "bus_dropped_frames",
                "Frames that this computer did not read in time"
            ),
            ticks: figure!(
                Gauge::default(),
                "board_ticks",
                "Ticks since power-up of the board"
            ),
            credit: figure!(
                Gauge::default(),
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
                Histogram::new(ERRORS),
                "thread_largest_error_metres",
                "Largest error of each thread against the spindle"
            ),
            rms: figure!(
                Histogram::new(ERRORS),
                "thread_rms_error_metres",
                "RMS error of each thread against the spindle"
            ),
            cuts: figure!(
                Family::default(),
                "thread_cuts",
                "Threads by how much is known of their cut since the agent began"
            ),
            cut: figure!(
                Histogram::new(CUTS),
                "thread_cut_error_metres",
                "Largest error of the cut of each thread, by the positions of the drive"
            ),
            cut_doubt: figure!(
                Histogram::new(CUTS),
                "thread_cut_uncertainty_metres",
                "Uncertainty of that error, plus or minus"
            ),
            cut_apart: figure!(
                Histogram::new(CUTS),
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
            match &record.record.body {
                Body::Presence(presence) => {
                    self.up.set(presence.alive.into());
                    if !presence.alive {
                        self.state.clear();
                    }
                }
                Body::Identity(identity) => self.identity(identity),
                Body::State(state) => self.state(state),
                Body::Event(event) => match &event.what {
                    What::Alarm(trouble) => count(&self.alarms, "number", trouble.number),
                    What::Warning(trouble) => count(&self.warnings, "number", trouble.number),
                    What::Finished | What::Reset | What::Held | What::Ready => {}
                },
                Body::Thread(thread) => self.thread(thread),
                Body::Run(run) => {
                    let end = if run.finished {
                        "finished"
                    } else {
                        "cut_short"
                    };
                    count(&self.runs, "end", end);
                }
                Body::Gap(gap) => {
                    let labels = vec![("of", gap.of.name().to_owned())];
                    let many = u64::from(gap.last.saturating_sub(gap.first)) + 1;
                    self.missing.get_or_create(&labels).inc_by(many);
                }
                Body::Loss(Loss { .. }) => {}
            }
        }
    }

    /// Takes what a board says of itself.
    pub fn pulse(&self, pulse: Pulse) {
        self.ticks.set(number(pulse.ticks));
        self.credit.set(pulse.credit.into());
        self.dropped.set(number(pulse.dropped));
    }

    /// Takes how it stands with what is kept.
    pub fn kept(&self, figures: &Figures, connected: bool) {
        self.broker.set(connected.into());
        self.kept.set(number(figures.records));
        self.kept_bytes.set(number(figures.bytes));
        self.given_up.set(number(figures.lost));
    }

    fn identity(&self, identity: &Identity) {
        let labels = vec![
            ("serial", format!("{:08x}", identity.start.serial)),
            ("start", identity.start.count.to_string()),
            ("firmware", identity.firmware.clone()),
            ("parameters", format!("{:08x}", identity.parameters)),
        ];
        self.info.get_or_create(&labels).set(1);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(old) = known.replace(labels.clone()).filter(|old| *old != labels) {
            self.info.remove(&old);
        }
    }

    fn state(&self, state: &State) {
        for name in BoardState::ALL.map(BoardState::name) {
            let gauge = self.state.get_or_create(&vec![("state", name.to_owned())]);
            gauge.set((name == state.state).into());
        }
        self.alarm.set(state.alarm.into());
        self.late.set(state.late.into());
        if let Some(percent) = state.load_percent {
            self.load.set(f64::from(percent) / 100.0);
        }
        self.errors.set(number(state.bus_errors));
        for (of, percent) in [
            ("feed", state.feed_percent),
            ("rapid", state.rapid_percent),
            ("spindle", state.spindle_percent),
        ] {
            let gauge = self.overrides.get_or_create(&vec![("of", of.to_owned())]);
            gauge.set(percent.into());
        }
        for (of, rpm) in [("measured", state.rpm), ("commanded", state.rpm_commanded)] {
            let gauge = self.speed.get_or_create(&vec![("of", of.to_owned())]);
            gauge.set(rpm.into());
        }
    }

    fn thread(&self, thread: &Thread) {
        let labels = vec![("kind", thread.kind.clone()), ("end", thread.end.clone())];
        self.threads.get_or_create(&labels).inc();
        if thread.errors.measured > 0 {
            self.largest.observe(thread.errors.largest_um() * UM);
            self.rms.observe(thread.errors.rms_um() * UM);
        }
        // A hole has no groove.
        if thread.cut == Cut::Hole {
            return;
        }
        count(&self.cuts, "known", thread.cut.known());
        if let Some(found) = thread.cut.measured() {
            let [error, doubt] = found.worst.um();
            self.cut.observe(error * UM);
            self.cut_doubt.observe(doubt * UM);
            if let Some([apart, _]) = found.apart.map(Figure::um) {
                self.cut_apart.observe(apart * UM);
            }
        }
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

fn count(family: &Family<Labels, Counter>, label: &'static str, value: impl ToString) {
    family
        .get_or_create(&vec![(label, value.to_string())])
        .inc();
}
