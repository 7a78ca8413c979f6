//! What each record says of the metrics of a machine, and what they are by the last that said it.

use std::collections::BTreeMap;

use super::payload::{Metric, Properties, Value};
use super::table::*;
use crate::record::{Body, Cut, Errors, Figure, Moment, Numbered};

pub use super::table::{Row, TABLE};

/// Nanometres in a millimetre.
const NM_IN_MM: f64 = 1e6;

/// What a record says: values that are known, and those that it makes unknown.
type Said = Vec<(Place, Option<Value>)>;

fn text(text: &str) -> Option<Value> {
    Some(Value::String(text.to_owned()))
}

fn int(number: impl Into<u32>) -> Option<Value> {
    Some(Value::Int(number.into()))
}

const fn signed(number: i32) -> Option<Value> {
    Some(Value::Int(number.cast_unsigned()))
}

const fn long(number: u64) -> Option<Value> {
    Some(Value::Long(number))
}

const fn flag(yes: bool) -> Option<Value> {
    Some(Value::Boolean(yes))
}

/// What a record says.
fn said(body: &Body) -> Said {
    match body {
        Body::Presence(presence) => vec![
            (BOARD_ALIVE, flag(presence.alive)),
            (BOARD_WHY, text(&presence.why)),
        ],
        Body::Identity(identity) => vec![
            (
                BOARD_SERIAL,
                text(&format!("{:08x}", identity.start.serial)),
            ),
            (BOARD_START, int(identity.start.count)),
            (
                BOARD_PARAMETERS,
                text(&format!("{:08x}", identity.parameters)),
            ),
            (BOARD_FIRMWARE, text(&identity.firmware)),
        ],
        Body::State(state) => vec![
            (MACHINE_STATE, text(&state.state)),
            (MACHINE_MODE, text(&state.mode)),
            (MACHINE_ALARM, int(state.alarm)),
            (MACHINE_HOLD, flag(state.hold)),
            (MACHINE_SINGLE, flag(state.single_block)),
            (PROGRAM_NUMBER, int(state.program)),
            (PROGRAM_LINE, int(state.line)),
            (PROGRAM_MOVE, int(state.number)),
            (OVERRIDE_FEED, int(state.feed_percent)),
            (OVERRIDE_RAPID, int(state.rapid_percent)),
            (OVERRIDE_SPINDLE, int(state.spindle_percent)),
            (SPINDLE_SPEED, signed(state.rpm)),
            (SPINDLE_COMMANDED, signed(state.rpm_commanded)),
            (SETPOINTS_LATE, int(state.late)),
            (BUS_LOAD, state.load_percent.and_then(int)),
            (BUS_ERRORS, long(state.bus_errors)),
        ],
        Body::Event(event) => {
            let trouble = event.what.trouble();
            vec![
                (EVENT_KEY, text(&event.start.key(event.number))),
                (EVENT_KIND, text(event.what.name())),
                (EVENT_TICK, long(event.tick)),
                (EVENT_ALARM, trouble.and_then(|trouble| int(trouble.number))),
                (EVENT_LINE, trouble.and_then(|trouble| int(trouble.line))),
                (
                    EVENT_CAUSE,
                    trouble.and_then(|trouble| text(&trouble.cause)),
                ),
                (
                    EVENT_REMEDY,
                    trouble.and_then(|trouble| text(&trouble.remedy)),
                ),
            ]
        }
        Body::Thread(thread) => {
            let mut said = vec![
                (THREAD_KEY, text(&thread.start.key(thread.number))),
                (THREAD_PROGRAM, int(thread.program)),
                (THREAD_LINE, int(thread.line)),
                (THREAD_KIND, text(&thread.kind)),
                (THREAD_END, text(&thread.end)),
                (THREAD_PASSES, int(thread.passes)),
                (THREAD_LATE, int(thread.late)),
            ];
            let places = [THREAD_MEASURED, THREAD_LARGEST, THREAD_RMS];
            said.extend(errors(places, &thread.errors));
            said.extend(cut(&thread.cut));
            said
        }
        Body::Run(run) => {
            let hash = run.setpoint_hash.map(|hash| format!("{hash:016x}"));
            let mut said = vec![
                (RUN_KEY, text(&run.start.key(run.program))),
                (RUN_FINISHED, flag(run.finished)),
                (RUN_TICKS, long(run.ticks)),
                (RUN_HASH, hash.and_then(|hash| text(&hash))),
                (RUN_LATE, int(run.late)),
            ];
            said.extend(errors([RUN_MEASURED, RUN_LARGEST, RUN_RMS], &run.errors));
            said
        }
        Body::Gap(gap) => vec![
            (GAP_KEY, text(&gap.start.key(gap.first))),
            (GAP_OF, text(gap.of.name())),
            (GAP_FIRST, int(gap.first)),
            (GAP_LAST, int(gap.last)),
        ],
        Body::Loss(loss) => vec![
            (LOSS_RECORDS, long(loss.records)),
            (LOSS_FIRST, long(loss.first)),
            (LOSS_LAST, long(loss.last)),
        ],
    }
}

/// Largest and RMS are unknown where nothing was measured.
fn errors(places: [Place; 3], errors: &Errors) -> Said {
    let known = |value| (errors.measured > 0).then_some(Value::Double(value));
    let [measured, largest, rms] = places;
    vec![
        (measured, long(errors.measured)),
        (largest, known(errors.largest_um())),
        (rms, known(errors.rms_um())),
    ]
}

/// All of it is told of each thread: what is not known is told as that.
fn cut(cut: &Cut) -> Said {
    let found = cut.measured();
    let grooves = found.and_then(|found| found.grooves);
    let mut said = vec![
        (CUT_KNOWN, text(cut.known())),
        (CUT_WHY, cut.why().and_then(text)),
        (
            CUT_AXIS,
            found.and_then(|found| text(&found.axis.to_string())),
        ),
        (CUT_AGE, found.and_then(|found| flag(found.age_known))),
        (CUT_POSITIONS, found.and_then(|found| int(found.positions))),
        (CUT_PASSES, found.and_then(|found| int(found.passes))),
        (
            CUT_LEAD,
            found.map(|found| Value::Double(found.lead_nm as f64 / NM_IN_MM)),
        ),
    ];
    for (places, figure) in [
        ([CUT_LEAST, CUT_LEAST_U], grooves.map(|[least, _]| least)),
        ([CUT_MOST, CUT_MOST_U], grooves.map(|[_, most]| most)),
        (
            [CUT_APART, CUT_APART_U],
            found.and_then(|found| found.apart),
        ),
        (
            [CUT_SLOPE, CUT_SLOPE_U],
            found.and_then(|found| found.slope),
        ),
        ([CUT_WORST, CUT_WORST_U], found.map(|found| found.worst)),
    ] {
        let values = figure.map(Figure::um);
        let [place, place_u] = places;
        said.push((place, values.map(|[value, _]| Value::Double(value))));
        said.push((place_u, values.map(|[_, u]| Value::Double(u))));
    }
    said
}

/// What a record says, its number and kind first.
fn all(record: &Numbered) -> impl Iterator<Item = (Place, Option<Value>)> {
    let body = &record.record.body;
    let first = [
        (RECORD_NUMBER, long(record.number)),
        (RECORD_KIND, text(body.kind())),
    ];
    first.into_iter().chain(said(body))
}

/// A record as metrics with aliases, those of its machine from `first` on. `historical`: it is older than the birth.
#[must_use]
pub fn of_record(record: &Numbered, first: u64, historical: bool) -> Vec<Metric> {
    let at = record.record.at;
    all(record)
        .map(|(Place(place), value)| Metric {
            alias: Some(first + place as u64),
            timestamp: Some(at.0),
            is_historical: historical.then_some(true),
            is_null: value.is_none().then_some(true),
            value,
            ..Metric::default()
        })
        .collect()
}

/// What each metric is by the last record that says it.
#[derive(Clone, Debug)]
pub struct Values {
    known: Vec<Option<(Moment, Value)>>,
    alive: bool,
}

impl Default for Values {
    fn default() -> Self {
        Self {
            known: vec![None; TABLE.len()],
            alive: false,
        }
    }
}

impl Values {
    /// Takes what a record says.
    pub fn take(&mut self, record: &Numbered) {
        let at = record.record.at;
        for (Place(place), value) in all(record) {
            if let Some(known) = self.known.get_mut(place) {
                *known = value.map(|value| (at, value));
            }
        }
        if let Body::Presence(presence) = &record.record.body {
            self.alive = presence.alive;
        }
    }

    /// The board answers.
    #[must_use]
    pub const fn is_alive(&self) -> bool {
        self.alive
    }

    /// Every metric with its name, kind and unit, and its alias, from `first` on.
    #[must_use]
    pub fn birth(&self, at: Moment, first: u64) -> Vec<Metric> {
        let rows = TABLE.iter().zip(&self.known).enumerate();
        rows.map(|(place, (row, known))| Metric {
            name: Some(row.name.to_owned()),
            alias: Some(first + place as u64),
            timestamp: Some(known.as_ref().map_or(at, |(at, _)| *at).0),
            datatype: Some(row.kind as u32),
            is_null: known.is_none().then_some(true),
            properties: (!row.unit.is_empty()).then(|| Properties::unit(row.unit)),
            value: known.as_ref().map(|(_, value)| value.clone()),
            ..Metric::default()
        })
        .collect()
    }
}

/// The same of each machine, by its name.
#[derive(Clone, Debug, Default)]
pub struct Machines(BTreeMap<String, Values>);

impl Machines {
    /// Takes what a record says of its machine.
    pub fn take(&mut self, record: &Numbered) {
        let machine = &record.record.machine;
        match self.0.get_mut(machine) {
            Some(values) => values.take(record),
            None => self.0.entry(machine.clone()).or_default().take(record),
        }
    }

    /// What is known of a machine, where it has said anything.
    #[must_use]
    pub fn get(&self, machine: &str) -> Option<&Values> {
        self.0.get(machine)
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Values)> {
        self.0
            .iter()
            .map(|(machine, values)| (machine.as_str(), values))
    }
}
