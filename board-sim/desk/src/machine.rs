//! The simulated machine: the board with its plant and its flash, its pins, and its power.
//!
//! The board is a node on the bus: it hears what clients send and says what it says on any bus, setpoints and answers of
//! its drives included. The flash is in a file, which is replaced as soon as the board has written. Without power there is
//! no board: frames pass by, and the axes stay where they are.

use std::path::Path;
use std::time::Duration;

use leadscrew_board_sim::plant::{Flash, PlantOptions, Ripple};
use leadscrew_board_sim::{Around, Sim, SimError, TurretFault, fit_switches, places};
use leadscrew_common::diagnostics::alarm_words;
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::profiles::Chosen;
use leadscrew_common::state::{StateFile, stored_set};
use leadscrew_common::words::{Both, both};
use leadscrew_core::board::{Event, KeptSet, Mark, Region};
use leadscrew_core::bus::NodeId;
use leadscrew_core::call::Position;
use leadscrew_core::link::identity;
use leadscrew_core::params::{Contact, Params};
use leadscrew_slcan::SlcanFrame;
use leadscrew_store::{BUFFER, Store};

use crate::bus::Traffic;
use crate::control::{self, Door};
use crate::hand::Contacts;
use crate::spoilt::Spoilt;

/// How a machine is made.
#[derive(Debug)]
pub struct Recipe<'a> {
    /// The file of its flash.
    pub flash: &'a Path,
    /// The parameters that the user has named; `None` where the user has named none.
    pub params: Option<Params>,
    /// Begin with an empty flash.
    pub new: bool,
    /// The board's node.
    pub node: NodeId,
    /// The board's serial number.
    pub serial: u32,
    /// Where the axes stand.
    pub at: Position,
    /// The drives of X and Z.
    pub drives: Chosen,
    /// The spindle.
    pub spindle: Turning,
}

/// A spindle as it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turning {
    /// How its speed varies.
    pub ripple: Option<Ripple>,
    /// Time that it takes for each 1000 rpm, in ms, where it is not what 9004 says.
    pub ramp_ms: Option<u32>,
}

/// With power, or without.
enum Power {
    On(Box<Sim>),
    Off(Box<Flash>),
}

impl Power {
    const fn sim(&mut self) -> Option<&mut Sim> {
        match self {
            Self::On(sim) => Some(sim),
            Self::Off(_) => None,
        }
    }
}

/// A machine.
pub struct Machine {
    state: StateFile,
    node: NodeId,
    serial: u32,
    at: Position,
    drives: Chosen,
    spindle: Turning,
    contacts: Contacts,
    /// Inputs that somebody has set.
    around: Around,
    /// What somebody has spoilt.
    spoilt: Spoilt,
    power: Power,
    /// What the flash had seen when it was saved last.
    written: u32,
    /// The parameters that the plant was made with.
    made_with: Params,
    /// Its own words since they were read last.
    told: Vec<Both>,
}

impl Machine {
    /// A machine with its power on.
    ///
    /// # Errors
    /// A flash that is no image, or holds another machine than the one named; a board that does not start.
    pub fn new(recipe: &Recipe<'_>) -> Outcome<Self> {
        let state = StateFile::new(recipe.flash);
        let mut flash = if recipe.new {
            Flash::erased()
        } else {
            state.load_or_new()?
        };
        if let Some(params) = &recipe.params {
            flash = delivered(flash, params)?;
        }
        state.save(&flash)?;
        let mut machine = Self {
            state,
            node: recipe.node,
            serial: recipe.serial,
            at: recipe.at,
            drives: recipe.drives.clone(),
            spindle: recipe.spindle,
            contacts: Contacts::default(),
            around: Around::default(),
            spoilt: Spoilt::none(recipe.node),
            written: flash.written(),
            power: Power::Off(Box::new(flash)),
            made_with: Params::slant_bed(),
            told: Vec::new(),
        };
        machine.switch_on()?;
        Ok(machine)
    }

    /// The board's node.
    #[must_use]
    pub const fn node(&self) -> NodeId {
        self.node
    }

    /// The length of a tick.
    #[must_use]
    pub fn tick_length(&self) -> Duration {
        Duration::from_micros(self.made_with.tick_us().into())
    }

    /// Board and drives have power.
    #[must_use]
    pub const fn has_power(&self) -> bool {
        matches!(self.power, Power::On(_))
    }

    /// What is pressed or open.
    #[must_use]
    pub const fn contacts(&self) -> Contacts {
        self.contacts
    }

    /// The board has another parameter set than the one that drives and spindle were made with.
    #[must_use]
    pub fn is_outdated(&self) -> bool {
        match &self.power {
            Power::On(sim) => identity(sim.board().params()) != identity(&self.made_with),
            Power::Off(_) => false,
        }
    }

    /// What it has to tell, since it was asked last.
    pub fn told(&mut self) -> Vec<Both> {
        std::mem::take(&mut self.told)
    }

    /// Somebody presses or opens something.
    pub fn touch(&mut self, contacts: Contacts) {
        self.contacts = contacts;
        if let Power::On(sim) = &mut self.power {
            sim.set_pins(contacts.pins());
        }
        self.around.open_door(contacts.door == Door::Open);
        self.show_around();
    }

    /// What is wrong with the turret from now on.
    pub fn spoil_turret(&mut self, fault: TurretFault) {
        self.around.spoil_turret(fault);
        self.show_around();
    }

    /// Something happens to the block of inputs and outputs.
    pub fn spoil_block(&mut self, to: control::Block) {
        self.spoilt.block(to, self.power.sim());
    }

    /// Something happens to a drive.
    pub fn spoil_drive(&mut self, which: control::Drive, to: control::DriveFault) {
        let sim = self.power.sim().map(|sim| (sim, &self.made_with));
        self.spoilt.drive(which, to, sim);
    }

    /// The spindle turns at so many hundredths of what it is told.
    pub fn spoil_spindle(&mut self, percent: i16) {
        self.spoilt.spindle(percent, self.power.sim());
    }

    /// Something happens to the spindle's encoder.
    pub fn spoil_encoder(&mut self, to: control::Encoder) {
        self.spoilt.encoder(to, self.power.sim());
    }

    /// Something happens to the wire.
    pub fn spoil_bus(&mut self, to: control::Bus) {
        let sim = self.power.sim().map(|sim| (sim, &self.made_with));
        self.spoilt.bus(to, sim);
    }

    /// Something happens to the board's flash.
    pub fn spoil_flash(&mut self, to: control::Flash) {
        self.spoilt.flash(to, self.power.sim());
    }

    /// Somebody sets an input, or leaves it to the simulated devices.
    pub fn set_input(&mut self, input: Contact, on: Option<bool>) {
        self.around.set(input, on);
        self.show_around();
    }

    /// Somebody turns the handwheel at the board's own input. Without power nobody counts.
    pub fn turn_wheel(&mut self, counts: i32) {
        if let Power::On(sim) = &mut self.power {
            sim.turn_wheel(counts);
        }
    }

    fn show_around(&mut self) {
        if let Power::On(sim) = &mut self.power {
            sim.around().be_as(&self.around);
        }
    }

    /// The inputs and the outputs that are on; none without power.
    #[must_use]
    pub fn on(&self) -> [u32; 2] {
        match &self.power {
            Power::On(sim) => {
                let ticker = sim.board().ticker();
                [ticker.machine_inputs(), ticker.machine_outputs()]
            }
            Power::Off(_) => [0, 0],
        }
    }

    /// The board has an input for the door.
    #[must_use]
    pub fn has_door(&self) -> bool {
        match &self.power {
            Power::On(sim) => sim.board().params().door_input() != 0,
            Power::Off(_) => true,
        }
    }

    /// Board and drives come up with what the flash holds, where the axes stand. No time passes.
    ///
    /// # Errors
    /// The board does not start; the power stays off.
    pub fn switch_on(&mut self) -> Outcome {
        let Power::Off(flash) = &self.power else {
            return Ok(());
        };
        let params = stored_set(flash).unwrap_or_else(Params::slant_bed);
        let options = PlantOptions {
            at: self.at,
            ripple: self.spindle.ripple,
            ramp_ms: self.spindle.ramp_ms,
            servos: self.drives.servos(&params)?,
            board: Some(self.node),
            ..PlantOptions::default()
        };
        let flash = flash.as_ref().clone();
        let sim = Sim::switch_on(&Params::slant_bed(), &options, flash, self.serial);
        let mut sim = sim.map(Box::new).map_err(|error| not_started(&error))?;
        sim.join(self.node)
            .map_err(|alarm| not_started(&SimError::Board(alarm)))?;
        sim.set_pins(self.contacts.pins());
        *sim.around() = self.around;
        fit_switches(sim.plant(), &params);
        self.spoilt.begin(&mut sim, &params);
        self.made_with = params;
        self.power = Power::On(sim);
        self.keep()
    }

    /// The power goes, whatever is under way.
    ///
    /// # Errors
    /// The flash cannot be saved.
    pub fn switch_off(&mut self) -> Outcome {
        let Power::On(sim) = &mut self.power else {
            return Ok(());
        };
        self.at = places(sim.plant(), &self.made_with).unwrap_or(self.at);
        sim.cut_power();
        let mut flash = Box::new(sim.flash().clone());
        // What is kept can be read while the board has no power.
        flash.power(true);
        self.state.save_soon(&flash)?;
        self.written = flash.written();
        self.power = Power::Off(flash);
        Ok(())
    }

    /// One tick. `to` gets every frame in the order of the bus.
    ///
    /// # Errors
    /// The flash cannot be saved.
    pub fn tick(&mut self, to: &mut dyn FnMut(&Traffic)) -> Outcome {
        let Power::On(sim) = &mut self.power else {
            return Ok(());
        };
        let _ = sim.step_on(&mut |_, frame| to(&Traffic::from(frame)));
        if let Some(together) = sim.together() {
            to(&Traffic::Fd(*together));
        }
        self.say(to);
        self.keep()
    }

    /// A frame of a client.
    ///
    /// # Errors
    /// The flash cannot be saved.
    pub fn hear(&mut self, traffic: &Traffic, to: &mut dyn FnMut(&Traffic)) -> Outcome {
        let Power::On(sim) = &mut self.power else {
            return Ok(());
        };
        match traffic {
            Traffic::Classical(SlcanFrame::Data(frame)) => sim.receive(frame),
            Traffic::Fd(frame) => sim.receive_fd(frame),
            // No CANopen node hears other kinds.
            Traffic::Classical(_) => return Ok(()),
        }
        sim.settle();
        self.say(to);
        self.keep()
    }

    /// Passes on what the board has to say.
    fn say(&mut self, to: &mut dyn FnMut(&Traffic)) {
        let Power::On(sim) = &mut self.power else {
            return;
        };
        while let Some(frame) = sim.transmit() {
            to(&Traffic::from(&frame));
        }
        while let Some(event) = sim.event() {
            let (kind, alarm) = match &event {
                Event::Alarm(alarm) => (both!("alarm", "报警"), alarm),
                Event::Warning(alarm) => (both!("warning", "警告"), alarm),
                Event::Refused(alarm) => (both!("refused", "已拒绝"), alarm),
                _ => continue,
            };
            let words = alarm_words(alarm);
            self.told.push(both!(
                "{en} {words_en}",
                "{zh} {words_zh}",
                en = kind.en,
                zh = kind.zh,
                words_en = words.en,
                words_zh = words.zh
            ));
        }
    }

    /// Saves a flash that has changed.
    fn keep(&mut self) -> Outcome {
        let Power::On(sim) = &self.power else {
            return Ok(());
        };
        let written = sim.flash().written();
        if written != self.written {
            self.state.save_soon(sim.flash())?;
            self.written = written;
        }
        Ok(())
    }
}

/// The flash of a board that is delivered with this set: an empty one gets it, as if it had been pushed. One that has
/// another set is refused, because its owner may need that [D279].
fn delivered(flash: Flash, params: &Params) -> Outcome<Flash> {
    match stored_set(&flash) {
        Some(stored) if identity(&stored) == identity(params) => return Ok(flash),
        Some(_) => {
            return Err(Failure::Usage(both!(
                "the board of this machine keeps other parameters than those named here: leave them out, push them once it \
                 runs (`leadscrew params push FILE`), or begin with an empty board (`--new`)",
                "这台机床的控制板保存着与此处不同的参数：请去掉这些选项，或在启动后写入（`leadscrew params push FILE`），或用 `--new` \
                 从空白控制板开始"
            )));
        }
        None => {}
    }
    let unwritable = |_| {
        Failure::WrongBecause(both!(
            "the simulated flash cannot be written",
            "模拟闪存无法写入"
        ))
    };
    let first = KeptSet { number: 1, params };
    let mut bytes = [0; BUFFER];
    let length = first.fill(&mut bytes);
    let mut store = Store::new(flash).map_err(unwritable)?;
    store.recover().map_err(unwritable)?;
    let set = bytes.get(..length).unwrap_or_default();
    store.write(Region::ParametersA, set).map_err(unwritable)?;
    let mark = Mark(first.number).encode();
    store
        .write(Region::ParametersMark, &mark)
        .map_err(unwritable)?;
    Ok(store.into_flash())
}

/// Why a simulated board does not start.
#[must_use]
pub fn not_started(error: &SimError) -> Failure {
    let reason = match error {
        SimError::Board(alarm) => alarm_words(alarm),
        SimError::Plant(error) => Both::same(format!("{error:?}")),
    };
    Failure::WrongBecause(both!(
        "the simulated board does not start: {en}",
        "模拟控制板无法启动：{zh}",
        en = reason.en,
        zh = reason.zh
    ))
}
