//! What the records of one machine are in figures: each with its name.

use std::sync::PoisonError;

use leadscrew_core::bus::BoardState;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;

use super::{Histograms, Labels, Metrics, UM, number};
use crate::record::{Body, Cut, Figure, Identity, State, Thread, What};

/// What there is an override of, and a speed of the spindle.
const OVERRIDES: [&str; 3] = ["feed", "rapid", "spindle"];
const SPEEDS: [&str; 2] = ["measured", "commanded"];

/// The figures of a machine.
pub struct Of<'a> {
    pub all: &'a Metrics,
    pub machine: &'a str,
}

impl Of<'_> {
    /// Takes what a record says.
    pub fn take(&self, body: &Body) {
        let all = self.all;
        match body {
            Body::Presence(presence) => {
                self.set(&all.up, presence.alive.into());
                if !presence.alive {
                    self.forget();
                }
            }
            Body::Identity(identity) => self.identity(identity),
            Body::State(state) => self.state(state),
            Body::Event(event) => match &event.what {
                What::Alarm(trouble) => self.count(&all.alarms, "number", trouble.number, 1),
                What::Warning(trouble) => self.count(&all.warnings, "number", trouble.number, 1),
                What::Refused(_) | What::Finished | What::Reset | What::Held | What::Ready => {}
            },
            Body::Thread(thread) => self.thread(thread),
            Body::Run(run) => {
                let end = if run.finished {
                    "finished"
                } else {
                    "cut_short"
                };
                self.count(&all.runs, "end", end, 1);
            }
            Body::Gap(gap) => {
                let many = u64::from(gap.last.saturating_sub(gap.first)) + 1;
                self.count(&all.missing, "of", gap.of.name(), many);
            }
            // It is in the figures of the store.
            Body::Loss(_) => {}
        }
    }

    fn labels(&self) -> Labels {
        vec![("machine", self.machine.to_owned())]
    }

    fn with(&self, label: &'static str, value: impl ToString) -> Labels {
        let mut labels = self.labels();
        labels.push((label, value.to_string()));
        labels
    }

    pub fn set(&self, family: &Family<Labels, Gauge>, value: i64) {
        family.get_or_create(&self.labels()).set(value);
    }

    fn count(
        &self,
        family: &Family<Labels, Counter>,
        label: &'static str,
        value: impl ToString,
        many: u64,
    ) {
        family.get_or_create(&self.with(label, value)).inc_by(many);
    }

    fn observe(&self, family: &Histograms, um: f64) {
        family.get_or_create(&self.labels()).observe(um * UM);
    }

    fn identity(&self, identity: &Identity) {
        let mut labels = self.labels();
        labels.extend([
            ("serial", format!("{:08x}", identity.start.serial)),
            ("start", identity.start.count.to_string()),
            ("firmware", identity.firmware.clone()),
            ("parameters", format!("{:08x}", identity.parameters)),
        ]);
        self.all.info.get_or_create(&labels).set(1);
        let known = self.all.known.lock();
        let mut known = known.unwrap_or_else(PoisonError::into_inner);
        let old = known.insert(self.machine.to_owned(), labels.clone());
        if let Some(old) = old.filter(|old| *old != labels) {
            self.all.info.remove(&old);
        }
    }

    fn state(&self, state: &State) {
        let all = self.all;
        for name in BoardState::ALL.map(BoardState::name) {
            let gauge = all.state.get_or_create(&self.with("state", name));
            gauge.set((name == state.state).into());
        }
        self.set(&all.alarm, state.alarm.into());
        self.set(&all.late, state.late.into());
        if let Some(percent) = state.load_percent {
            let load = all.load.get_or_create(&self.labels());
            load.set(f64::from(percent) / 100.0);
        }
        self.set(&all.errors, number(state.bus_errors));
        let percents = [
            state.feed_percent,
            state.rapid_percent,
            state.spindle_percent,
        ];
        for (of, percent) in OVERRIDES.into_iter().zip(percents) {
            let gauge = all.overrides.get_or_create(&self.with("of", of));
            gauge.set(percent.into());
        }
        for (of, rpm) in SPEEDS.into_iter().zip([state.rpm, state.rpm_commanded]) {
            let gauge = all.speed.get_or_create(&self.with("of", of));
            gauge.set(rpm.into());
        }
    }

    /// What a machine does is not known while its board is not heard.
    fn forget(&self) {
        let all = self.all;
        for name in BoardState::ALL.map(BoardState::name) {
            all.state.remove(&self.with("state", name));
        }
        for of in OVERRIDES {
            all.overrides.remove(&self.with("of", of));
        }
        for of in SPEEDS {
            all.speed.remove(&self.with("of", of));
        }
        all.alarm.remove(&self.labels());
        all.load.remove(&self.labels());
    }

    fn thread(&self, thread: &Thread) {
        let all = self.all;
        let mut labels = self.with("kind", &thread.kind);
        labels.push(("end", thread.end.clone()));
        all.threads.get_or_create(&labels).inc();
        if thread.errors.measured > 0 {
            self.observe(&all.largest, thread.errors.largest_um());
            self.observe(&all.rms, thread.errors.rms_um());
        }
        // A hole has no groove.
        if thread.cut == Cut::Hole {
            return;
        }
        self.count(&all.cuts, "known", thread.cut.known(), 1);
        if let Some(found) = thread.cut.measured() {
            let [error, doubt] = found.worst.um();
            self.observe(&all.cut, error);
            self.observe(&all.cut_doubt, doubt);
            if let Some([apart, _]) = found.apart.map(Figure::um) {
                self.observe(&all.cut_apart, apart);
            }
        }
    }
}
