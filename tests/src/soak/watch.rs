//! The conditions that must hold in every tick, whatever happens to the machine.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row, Sim};
use leadscrew_core::board::State;
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Length};

use super::drives::{self, Tool};
use super::encoder::{self, Class};
use super::programs::Groove;

/// The largest distance of the spindle in position mode from its command, in nanometres of the tap axis: half an increment
/// of its drive, plus the way between two SYNCs where the drives' latency is not a whole number of ticks.
const TAP_NM: i64 = 500;

/// The most ticks by which rows come late.
const LATE: usize = 256;

/// The most grooves of a program: two passes of three strokes in each of its three pieces.
const GROOVES: usize = 18;

/// The used part of the limits in a shift, and the number of judged values.
#[derive(Clone, Copy, Debug, Default)]
pub struct Judged {
    /// Setpoints.
    pub rows: u64,
    /// Setpoints with an axis held to the helix of a thread, by class of encoder.
    pub threads: [u64; Class::ALL.len()],
    /// The largest distance from the helix, in nanometres.
    pub thread_nm: [i64; Class::ALL.len()],
    /// Of the tool in a thread behind drives that lag, once it has settled, by class of encoder.
    pub tools: [u64; Class::ALL.len()],
    /// Its largest distance from the helix, in nanometres.
    pub tool_nm: [i64; Class::ALL.len()],
    /// Setpoints in a groove that the program's text asks for.
    pub grooves: u64,
    /// Setpoints with an axis held to the line of a rigid tap.
    pub taps: u64,
    /// The largest distance from this line, in nanometres.
    pub tap_nm: i64,
    /// Setpoints with an axis held to the line of an ordinary tap.
    pub floats: u64,
    /// The largest distance from this line, in nanometres: the travel of the holder.
    pub float_nm: i64,
    /// The largest shares of speed, acceleration and jerk in motion driven by time.
    pub used: [f64; 3],
}

impl Judged {
    /// Adds the values of another watch.
    pub fn add(&mut self, other: &Self) {
        self.rows += other.rows;
        for class in Class::ALL.map(|class| class as usize) {
            self.threads[class] += other.threads[class];
            self.thread_nm[class] = self.thread_nm[class].max(other.thread_nm[class]);
            self.tools[class] += other.tools[class];
            self.tool_nm[class] = self.tool_nm[class].max(other.tool_nm[class]);
        }
        self.grooves += other.grooves;
        self.taps += other.taps;
        self.floats += other.floats;
        self.tap_nm = self.tap_nm.max(other.tap_nm);
        self.float_nm = self.float_nm.max(other.float_nm);
        for (most, used) in self.used.iter_mut().zip(other.used) {
            *most = most.max(used);
        }
    }
}

/// Limits of one axis, in nanometres per tick, tick² and tick³.
#[derive(Clone, Copy)]
struct Bounds {
    speed: f64,
    acceleration: f64,
    jerk: f64,
    /// What whole counts of the spindle's encoder add to the acceleration of an axis that it leads.
    noise: f64,
}

/// The watch.
pub struct Watch {
    bounds: [Bounds; 3],
    /// The class of the spindle's encoder, and how far a thread may be beside its helix, in nanometres.
    class: Class,
    beside: i64,
    /// Counts of the spindle's encoder in a turn.
    counts: i64,
    /// Its part by the way ahead that setpoints are calculated for.
    foreseen: i64,
    /// How often the spindle swings, in thousandths of a hertz.
    swing_mhz: u32,
    /// What the tool does behind drives that lag, and since when it can settle.
    tool: Option<Tool>,
    settling: Settling,
    last: heapless::Deque<Row, 4>,
    /// For each of the last ticks: a spindle out of control drove an axis. Rows come late.
    led: [bool; LATE],
    /// For each of the last ticks: the drives came up. The axes stand where their drives say, which differs if they were
    /// moved.
    came_up: [bool; LATE],
    /// Ticks since the machine was switched on.
    ticks: usize,
    /// Position and state after the tick before.
    before: Option<(Position, State)>,
    grooves: heapless::Vec<Groove, GROOVES>,
    /// Until this row's tick the true angle of the spindle and the board's count may differ, because counts have slipped.
    slipped: bool,
    /// An emergency stop in the rounded corner of a run-out adds its jerk to that of the corner [D53], until the axes
    /// stand.
    stopping: bool,
    /// The drives follow with a lag.
    lags: bool,
    /// Until this tick the drives do not follow their commands, because something is broken.
    broken_until: usize,
    /// Until this tick the spindle may turn in any way, or its encoder tell something else.
    spindle_broken_until: usize,
    /// The axes may be declared to stand elsewhere.
    replaces: bool,
    /// The drives count from a place that is taken for theirs, so where the tool truly is says nothing.
    assumed: bool,
    /// The judged values.
    pub judged: Judged,
}

fn of(position: Position) -> [i64; 3] {
    [position.x.nm(), position.z.nm(), position.c.udeg()]
}

/// The speed of a broken spindle, relative to its command, at most.
const TOO_FAST: f64 = 1.3;

impl Watch {
    /// A watch for a machine with these parameters and this plant.
    pub fn new(params: &Params, options: &PlantOptions) -> Self {
        let swing_mhz = encoder::swing_mhz(options);
        let foreseen = drives::foreseen(params, options);
        Self {
            bounds: bounds(params),
            class: Class::of(params),
            beside: encoder::beside(params, swing_mhz) + foreseen,
            counts: params.resolution().counts.into(),
            assumed: false,
            foreseen,
            swing_mhz,
            tool: Tool::of(params, options),
            settling: Settling::default(),
            last: heapless::Deque::new(),
            led: [false; LATE],
            came_up: [false; LATE],
            ticks: 0,
            before: None,
            grooves: heapless::Vec::new(),
            slipped: false,
            stopping: false,
            lags: options.drives.lag != 0,
            broken_until: 0,
            spindle_broken_until: 0,
            replaces: false,
            judged: Judged::default(),
        }
    }

    /// Other parameters come into force; the machine stands.
    pub fn set_params(&mut self, params: &Params) {
        self.bounds = bounds(params);
        self.class = Class::of(params);
        self.beside = encoder::beside(params, self.swing_mhz) + self.foreseen;
        self.counts = params.resolution().counts.into();
        self.last.clear();
    }

    /// The setpoints begin again: the power was away, or the drives were moved.
    pub fn forget(&mut self) {
        self.last.clear();
        self.before = None;
    }

    /// The threads of the next program.
    pub fn expect(&mut self, grooves: &[Groove]) {
        self.grooves = heapless::Vec::from_slice(grooves).expect("a program has few threads");
    }

    /// `true`: counts of the encoder are lost or doubled from now on. `false`: the board has noticed it and the effects are
    /// over.
    pub fn set_slipped(&mut self, slipped: bool) {
        self.slipped = slipped;
    }

    /// The machine was switched on; its tick 0 is over.
    pub fn power_up(&mut self) {
        self.forget();
        self.ticks = 1;
        self.led[0] = false;
        self.came_up[0] = false;
        self.broken_until = 0;
        self.spindle_broken_until = 0;
    }

    /// The next tick of the machine.
    pub fn tick_to_come(&self) -> u64 {
        self.ticks as u64
    }

    /// Whether the axes may be declared to stand elsewhere, because an entry of the tap journal is being dropped.
    pub fn set_replaces(&mut self, replaces: bool) {
        self.replaces = replaces;
    }

    /// Whether a drive counts from a place that is taken for its own.
    pub fn set_assumed(&mut self, assumed: bool) {
        self.assumed = assumed;
    }

    /// A tick is over. `well`: nothing is broken; `spindle_well`: nothing that turns the spindle or tells of it.
    pub fn tick(&mut self, sim: &Sim, well: bool, spindle_well: bool) {
        let ticker = sim.board().ticker();
        let executor = ticker.executor();
        let place = self.ticks % LATE;
        self.led[place] = executor.thread().is_some() || executor.is_floating();
        let started = matches!(self.before, Some((_, State::Starting)));
        self.came_up[place] = self.replaces || started && ticker.state() != State::Starting;
        self.ticks += 1;
        if !well {
            self.broken_until = self.ticks + LATE;
        }
        if !spindle_well {
            self.spindle_broken_until = self.ticks + LATE;
        }
    }

    /// Judges one row.
    pub fn row(&mut self, row: &Row) {
        self.judged.rows += 1;
        if self.last.is_full() {
            self.last.pop_front();
        }
        assert!(self.last.push_back(*row).is_ok(), "there is room");
        self.stopping |= row.doing == Doing::Alarm;
        self.limits();
        self.spindle(row);
        if self.stopping && row.doing != Doing::Alarm {
            self.stopping = false;
        }
    }

    fn limits(&mut self) {
        let rows: heapless::Vec<Row, 4> = self.last.iter().copied().collect();
        let Ok([a, b, c, d]) = rows.into_array::<4>() else {
            return;
        };
        let window = [a, b, c, d];
        for pair in window.windows(2) {
            assert_eq!(pair[0].tick + 1, pair[1].tick, "a setpoint is missing");
        }
        let came_up = |row: &Row| self.came_up[row.tick as usize % LATE];
        if window[1..].iter().any(came_up) {
            return;
        }
        let led = window.map(|row| self.led[row.tick as usize % LATE]);
        let led = led.contains(&true);
        let broken = (d.tick as usize) < self.broken_until;
        // Behind a helix its noise shows; that noise is judged as a distance.
        let locked = window
            .iter()
            .any(|row| row.error.is_some() && !row.is_rigid());
        let jerks = if self.stopping { 2.0 } else { 1.0 };
        let positions = window.map(|row| of(row.position));
        for (axis, bounds) in self.bounds.iter().enumerate() {
            let [a, b, c, d] = positions.map(|position| position[axis]);
            let all = [
                ((d - c).abs(), bounds.speed, 1.0),
                ((d - 2 * c + b).abs(), bounds.acceleration, 2.0),
                ((d - 3 * c + 3 * b - a).abs(), bounds.jerk * jerks, 4.0),
            ];
            for (n, (size, limit, rounding)) in all.into_iter().enumerate() {
                if n > 0 && (locked || led && self.slipped) || n > 1 && led {
                    continue;
                }
                let what = ["speed", "acceleration", "jerk"][n];
                let axis = Axis::ALL[axis];
                let noise = if led && n == 1 { bounds.noise } else { 0.0 };
                let limit = match (led, broken) {
                    (false, _) => limit,
                    // The unevenness of a spindle adds to the values for which a pass is planned.
                    (true, false) => 1.1 * limit,
                    // A spindle that turns too fast takes its axis with it.
                    (true, true) => 1.1 * limit * TOO_FAST.powi(n as i32 + 1),
                };
                assert!(
                    size as f64 <= limit + noise + rounding,
                    "{axis:?}: {what} {size} nm, limit {limit:.1}:\n{}",
                    window.map(told).join("\n")
                );
                let share = (size as f64 - rounding) / limit;
                if !led && limit > 100.0 * rounding && share > self.judged.used[n] && jerks < 2.0 {
                    self.judged.used[n] = share;
                }
            }
        }
    }

    /// How far an axis may be beside its helix while the spindle does not do what it is told, in nanometres.
    fn beside_broken(&self, row: &Row) -> i64 {
        let of_cut = row.cut.map(|cut| cut.lead.nm().abs());
        let groove = || self.grooves.iter().find(|groove| groove.line == row.line);
        let lead = of_cut.or_else(|| groove().map(|groove| groove.lead.abs()));
        let lead = lead.unwrap_or(0);
        match self.class {
            // Where within a count a spindle comes to rest that nobody has stopped, no edge tells.
            Class::Fine => self.beside + lead / self.counts,
            // Few counts learn it no better than one whose swing nobody has told. One that is jammed is lost a sixteenth
            // of a turn and two counts later, and two ticks pass until the axis knows.
            Class::FewTimed | Class::Few => {
                let lost = lead / 16 + 2 * lead / self.counts;
                let ticks = self.bounds.iter().map(|bounds| 2.0 * bounds.speed);
                let ticks = ticks.fold(0.0, f64::max) as i64;
                self.beside.max(encoder::UNKNOWN_NM).max(lost + ticks)
            }
        }
    }

    /// Judges threads and taps on their lines.
    fn spindle(&mut self, row: &Row) {
        let Some(error) = row.error else {
            self.settling = Settling::default();
            return;
        };
        let nm = error.nm().abs();
        match row.tap {
            Some(point) if row.is_rigid() => {
                self.judged.taps += 1;
                let skew = point.skew.nm().abs();
                self.judged.tap_nm = self.judged.tap_nm.max(skew);
                assert!(
                    skew <= 1,
                    "axis and spindle of a tap are told apart: {row:?}"
                );
                let trusted = !self.lags && row.tick as usize >= self.broken_until;
                assert!(!trusted || nm <= TAP_NM, "a tap off its line: {row:?}");
            }
            Some(_) => {
                self.judged.floats += 1;
                if !self.slipped {
                    self.judged.float_nm = self.judged.float_nm.max(nm);
                }
            }
            None => {
                let class = self.class as usize;
                self.judged.threads[class] += 1;
                if self.slipped {
                    return;
                }
                // After an alarm the rest of a run-out is not led by the spindle any more.
                if row.doing == Doing::Alarm {
                    return;
                }
                let worst = &mut self.judged.thread_nm[class];
                *worst = (*worst).max(nm);
                let broken = (row.tick as usize) < self.spindle_broken_until;
                let most = if broken {
                    self.beside_broken(row)
                } else {
                    self.beside
                };
                assert!(
                    nm <= most,
                    "{nm} nm off the helix, {:?}: {row:?}",
                    self.class
                );
                self.behind_drives(row);
                if let Some(groove) = self.grooves.iter().find(|groove| groove.line == row.line) {
                    self.judged.grooves += 1;
                    in_groove(row, groove, most);
                }
            }
        }
    }

    /// Judges what the tool cuts behind drives that lag, where it has had time to settle.
    fn behind_drives(&mut self, row: &Row) {
        let (Some(tool), Some(cut)) = (self.tool, row.cut) else {
            return;
        };
        self.settling.take(row, tool.even);
        let broken = (row.tick as usize) < self.broken_until;
        if self.settling.ticks < tool.settles || broken || self.assumed {
            return;
        }
        let nm = cut.error.nm().abs();
        let class = self.class as usize;
        self.judged.tools[class] += 1;
        self.judged.tool_nm[class] = self.judged.tool_nm[class].max(nm);
        assert!(
            nm <= self.beside + tool.beside,
            "the tool is {nm} nm off the helix, {:?}: {row:?}",
            self.class
        );
    }

    /// Judges the state between two ticks.
    pub fn between(&mut self, sim: &Sim) {
        let ticker = sim.board().ticker();
        let (at, state) = (ticker.executor().position(), ticker.state());
        if let Some((before, was)) = self.before.replace((at, state)) {
            let stands = match (was, state) {
                (State::Idle, State::Idle) => true,
                // An ordinary tap follows the spindle, also while a stopped spindle still creeps.
                (State::Held, State::Held) => !ticker.executor().is_floating(),
                (State::Alarm(_), State::Alarm(_) | State::Starting) => true,
                (State::Starting, State::Starting) => true,
                _ => false,
            };
            assert!(
                !stands || self.replaces || before == at,
                "it moves from {before:?} to {at:?} and is {was:?}, then {state:?}"
            );
        }
        if matches!(state, State::Alarm(_)) {
            let rpm = sim.spindle_command().get();
            assert_eq!(rpm, 0, "the spindle is to turn in {state:?}");
        }
        // A tap below R must be known to be in its hole.
        if let Some(line) = sim.board().tap_line() {
            let record = sim.board().tap_record();
            let below = line.gear.depth(at) > Length::ZERO;
            assert!(
                !below || record.is_some_and(|record| record.in_hole),
                "a tap below R, and the journal says {record:?}"
            );
        }
    }
}

/// How long the spindle has led an axis evenly.
#[derive(Clone, Copy, Default)]
struct Settling {
    ticks: u64,
    /// The spindle's angle at the last tick, and its way in a tick at the beginning, in turns.
    angle: Option<f64>,
    step: f64,
}

impl Settling {
    fn take(&mut self, row: &Row, even: f64) {
        // Differences of some thousand turns.
        let angle = row.spindle.raw() as f64 / 2f64.powi(64);
        let step = self.angle.map_or(0.0, |before| angle - before);
        self.angle = Some(angle);
        if (step - self.step).abs() > even * self.step.abs() {
            (self.ticks, self.step) = (0, step);
        } else {
            self.ticks += 1;
        }
    }
}

/// A row in one line.
fn told(row: Row) -> String {
    let [x, z, c] = of(row.position);
    format!(
        "tick {} X {x} Z {z} C {c} line {} move {} {} error {:?}",
        row.tick,
        row.line,
        row.number,
        row.doing.name(),
        row.error.map(Length::nm)
    )
}

/// Checks that the setpoint lies in the groove of the program's text, at the true angle of the spindle.
fn in_groove(row: &Row, groove: &Groove, beside: i64) {
    let lead = groove.lead as f64;
    // Farther than half a lead no place is from a groove.
    let beside = beside as f64;
    if beside >= lead / 2.0 {
        return;
    }
    // Of a large number of turns only the fraction counts.
    let turns = (row.spindle.raw() & ((1_i128 << 64) - 1)) as f64 / 2f64.powi(64);
    let at = match groove.on_x {
        true => row.position.x,
        false => row.position.z,
    };
    let way = (at.nm() - groove.start) as f64 - groove.sign as f64 * turns * lead;
    let off = (way + lead / 2.0).rem_euclid(lead) - lead / 2.0;
    assert!(
        off.abs() <= beside,
        "{off} nm beside the groove of {groove:?}: {row:?}"
    );
}

fn bounds(params: &Params) -> [Bounds; 3] {
    let tick = f64::from(params.tick_us()) * 1e-6;
    Axis::ALL.map(|axis| Bounds {
        speed: params.rapid(axis).nm_per_min() as f64 / 60.0 * tick,
        acceleration: params.acceleration(axis).nm_per_s2() as f64 * tick * tick,
        jerk: params.jerk(axis).nm_per_s3() as f64 * tick * tick * tick,
        noise: encoder::noise(params, axis) * tick * tick,
    })
}
