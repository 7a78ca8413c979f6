//! What is wrong with drives, spindle, encoder, wire and flash of a machine: it stays wrong until it is mended, over a loss
//! of power too. It must not know who asks for it.

use leadscrew_board_sim::line::{Faults, Intruder, Span};
use leadscrew_board_sim::plant::{
    BlockFault, Drive, Encoder as PlantEncoder, HomingOptions, IoBlock, Power, Trouble,
};
use leadscrew_board_sim::{Decay, Sim, decay, switch};
use leadscrew_core::bus::NodeId;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

use crate::control::{Block, Bus, Drive as Which, DriveFault, Encoder, Flash};

/// What is wrong.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spoilt {
    drives: [Trouble; 4],
    /// Axes whose homing never ends, and those where it ends with an error.
    no_mark: [bool; 3],
    homing_error: [bool; 3],
    /// Speed of the spindle in hundredths of what it is told.
    spindle: i16,
    no_index: bool,
    block: BlockFault,
    bus: Bus,
    /// The board's number on the bus.
    board: NodeId,
    worn: bool,
}

impl Spoilt {
    /// Nothing is wrong with a machine whose board has this number.
    pub(crate) const fn none(board: NodeId) -> Self {
        Self {
            drives: [Trouble::None; 4],
            no_mark: [false; 3],
            homing_error: [false; 3],
            spindle: 100,
            no_index: false,
            block: BlockFault::None,
            bus: Bus::Well,
            board,
            worn: false,
        }
    }

    /// All of it, for a machine that has just been switched on.
    pub(crate) fn begin(&self, sim: &mut Sim, params: &Params) {
        for which in Which::ALL {
            drive(sim, which).trouble(self.drives[which as usize]);
        }
        self.show_marks(sim, params);
        if let Some(block) = sim.plant().block() {
            block.spoil(self.block);
        }
        sim.plant().spindle().disturb(self.spindle);
        sim.plant().encoder().break_index(self.no_index);
        sim.flash_mut().set_broken(self.worn);
        if self.bus != Bus::Well {
            self.show_bus(sim, params);
        }
    }

    /// Something happens to the block of inputs and outputs.
    pub(crate) fn block(&mut self, to: Block, sim: Option<&mut Sim>) {
        let block = sim.and_then(|sim| sim.plant().block());
        self.block = match to {
            Block::Well => BlockFault::None,
            Block::Off => BlockFault::Off,
            Block::Silent => BlockFault::CutOff,
            Block::Mute => BlockFault::Mute,
            Block::Restart => return block.into_iter().for_each(IoBlock::restart),
            Block::Stopped => return block.into_iter().for_each(IoBlock::stop),
        };
        if let Some(block) = block {
            block.spoil(self.block);
        }
    }

    /// Something happens to a drive.
    pub(crate) fn drive(&mut self, which: Which, to: DriveFault, sim: Option<(&mut Sim, &Params)>) {
        let place = which as usize;
        if let Some(no_mark) = self.no_mark.get_mut(place) {
            *no_mark = to == DriveFault::NoMark;
        }
        if let Some(error) = self.homing_error.get_mut(place) {
            *error = to == DriveFault::HomingError;
        }
        self.drives[place] = match to {
            DriveFault::Well
            | DriveFault::Restart
            | DriveFault::NoMark
            | DriveFault::HomingError => Trouble::None,
            DriveFault::KeepsMode => Trouble::KeepsMode,
            DriveFault::Starting => Trouble::Held(Power::NotReady),
            DriveFault::QuickStop => Trouble::Held(Power::QuickStop),
            DriveFault::NoPower => Trouble::Held(Power::Ready),
            DriveFault::NotEnabled => Trouble::Held(Power::On),
            DriveFault::Silent => Trouble::Silent,
            DriveFault::Unplugged => Trouble::CutOff,
            DriveFault::Blocked => Trouble::Stuck,
            DriveFault::Fault => Trouble::HOT,
            DriveFault::TorqueOff => Trouble::TorqueOff,
        };
        if let Some((sim, params)) = sim {
            drive(sim, which).trouble(self.drives[place]);
            self.show_marks(sim, params);
            if to == DriveFault::Restart {
                drive(sim, which).restart();
            }
        }
    }

    /// The spindle turns at so many hundredths of what it is told.
    pub(crate) fn spindle(&mut self, percent: i16, sim: Option<&mut Sim>) {
        self.spindle = percent;
        if let Some(sim) = sim {
            sim.plant().spindle().disturb(percent);
        }
    }

    /// Something happens to the encoder.
    pub(crate) fn encoder(&mut self, to: Encoder, sim: Option<&mut Sim>) {
        self.no_index = to == Encoder::NoIndex;
        if let Some(sim) = sim {
            let encoder = sim.plant().encoder();
            encoder.break_index(self.no_index);
            if to == Encoder::Slip {
                encoder.slip(PlantEncoder::SLIP);
            }
        }
    }

    /// Something happens to the wire.
    pub(crate) fn bus(&mut self, to: Bus, sim: Option<(&mut Sim, &Params)>) {
        self.bus = to;
        if let Some((sim, params)) = sim {
            self.show_bus(sim, params);
        }
    }

    /// Something happens to the flash.
    pub(crate) fn flash(&mut self, to: Flash, sim: Option<&mut Sim>) {
        self.worn = to == Flash::Worn;
        let Some(sim) = sim else { return };
        let what = match to {
            Flash::Well | Flash::Worn => None,
            Flash::BadJournal => Some(Decay::Journal),
            Flash::BadSet => Some(Decay::NewestSet),
            Flash::BadSets => Some(Decay::Sets),
            Flash::ForeignSet => Some(Decay::ForeignSet),
            Flash::BadTable => Some(Decay::NewestTable),
        };
        let flash = sim.flash_mut();
        flash.set_broken(false);
        if let Some(what) = what {
            // A flash without room for a few bytes is bad by itself.
            let _ = decay(flash, what);
        }
        flash.set_broken(self.worn);
    }

    fn show_bus(&self, sim: &mut Sim, params: &Params) {
        let always = Some(Span {
            from: sim.ticks(),
            to: u64::MAX,
        });
        let x = NodeId::new(params.drive_node(Axis::X)).unwrap_or(NodeId::DRIVE_X);
        let second = |what| always.map(|span| (what, span));
        let mut faults = Faults::NONE;
        match self.bus {
            // A wire that still tells how its controller is: well again.
            Bus::Well => faults.error_passive = Some(Span { from: 0, to: 0 }),
            Bus::Unplugged => faults.cable_out = always,
            Bus::Off => faults.bus_off = always,
            Bus::Passive => faults.error_passive = always,
            Bus::Late => faults.late = always,
            Bus::SecondSync => faults.intruder = second(Intruder::Sync),
            Bus::SecondMaster => faults.intruder = second(Intruder::Setpoint(x)),
            Bus::StopsDrive => faults.intruder = second(Intruder::Stop(x)),
            Bus::StopsBoard => faults.intruder = second(Intruder::Stop(self.board)),
            Bus::Namesake => faults.intruder = second(Intruder::Namesake(self.board)),
        }
        sim.spoil(faults);
    }

    fn show_marks(&self, sim: &mut Sim, params: &Params) {
        let of_axis = self.no_mark.into_iter().zip(self.homing_error);
        for (axis, (never, fails)) in Axis::ALL.into_iter().zip(of_axis) {
            if let Some(options) = switch(axis, params) {
                let options = HomingOptions {
                    never,
                    fails,
                    ..options
                };
                sim.plant().drive(axis).set_homing(options);
            }
        }
    }
}

const fn drive(sim: &mut Sim, which: Which) -> &mut Drive {
    let plant = sim.plant();
    match which {
        Which::X => plant.drive(Axis::X),
        Which::Z => plant.drive(Axis::Z),
        Which::C => plant.drive(Axis::C),
        Which::S => plant.spindle_drive(),
    }
}
