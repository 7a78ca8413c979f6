//! The simulated turret: it turns while its output is on, tells its station as a binary number, and clamps at once.
//! Must not know what T is.

use leadscrew_core::params::{Contact, Params};

/// Ticks from one station to the next.
const STEP: u16 = 200;

/// What is wrong with a turret.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TurretFault {
    /// Nothing.
    #[default]
    None,
    /// It does not turn.
    Stuck,
    /// It goes on to the next station before it is clamped.
    Slips,
    /// It never says that it is clamped.
    Loose,
}

/// A turret.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Turret {
    /// Its station, from 0.
    station: u8,
    /// Ticks since it has left the station before.
    ticks: u16,
    /// It was turned in the tick before.
    turned: bool,
    fault: TurretFault,
}

impl Turret {
    /// What is wrong from now on.
    pub const fn spoil(&mut self, fault: TurretFault) {
        self.fault = fault;
    }

    /// What is wrong.
    pub const fn fault(&self) -> TurretFault {
        self.fault
    }

    /// A tick: the inputs that it has on while these outputs are.
    pub fn inputs(&mut self, params: &Params, outputs: u32) -> u32 {
        let stations = params.turret_stations();
        if params.tool_changer() != 2 || stations == 0 {
            return 0;
        }
        let is_on = |number| outputs & Contact::bit_of(number) != 0;
        let turns = is_on(params.turret_index_output());
        let open = turns || is_on(params.turret_unclamp_output());
        let mut goes_on = false;
        if turns && self.fault != TurretFault::Stuck {
            self.ticks = self.ticks.wrapping_add(1);
            goes_on = self.ticks.is_multiple_of(STEP);
        }
        goes_on |= self.turned && !turns && self.fault == TurretFault::Slips;
        self.turned = turns;
        if goes_on {
            self.station = self
                .station
                .wrapping_add(1)
                .checked_rem(stations)
                .unwrap_or(0);
        }
        let code = u32::from(self.station).wrapping_add(1);
        let shift = u32::from(params.turret_code_input().wrapping_sub(1));
        let locked = match open || self.fault == TurretFault::Loose {
            true => 0,
            false => Contact::bit_of(params.turret_locked_input()),
        };
        code.wrapping_shl(shift) | locked
    }
}
