//! Orders: what the board does once, however often the frame comes. The beat by which an order shows its
//! age.
//!
//! Must not know who orders, or whether the machine may obey.

use crate::operating::OperatingMode;
use crate::units::Axes;

/// The time of the board in milliseconds since power-up. It wraps after 65.5 s.
///
/// Whoever orders motion sends back the newest beat that he has heard: the echo. So the board knows how old the order is,
/// without a second clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Beat(u16);

impl Beat {
    /// This many milliseconds, modulo 65 536.
    #[must_use]
    pub const fn new(ms: u16) -> Self {
        Self(ms)
    }

    /// Milliseconds, modulo 65 536.
    #[must_use]
    pub const fn ms(self) -> u16 {
        self.0
    }

    /// The age of `echo` in milliseconds; `None` for an echo of the future.
    #[must_use]
    pub const fn age_of(self, echo: Self) -> Option<u16> {
        let age = self.0.wrapping_sub(echo.0);
        if age > i16::MAX as u16 {
            None
        } else {
            Some(age)
        }
    }
}

/// An order of an operator; the board does it once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Order {
    /// Begin the program.
    Run,
    /// Feed hold.
    Hold,
    /// Continue after feed hold or single block.
    Resume,
    /// Stop, empty the queue, clear an alarm.
    Reset,
    /// Emergency stop.
    Stop,
    /// End what is moved by hand, or the search for a reference.
    Cancel,
    /// Change the mode.
    Mode(OperatingMode),
    /// Find the reference of these axes; where none is named, of all that can find one.
    Home(Axes),
}

impl Order {
    /// Number of the first mode.
    const MODES: u8 = 16;
    /// Number of a reference for all axes.
    const HOME: u8 = 32;
    /// The highest number of an order.
    pub const LAST: u8 = Self::HOME | Axes::ALL.bits();

    /// The number of the order in 5000h:02.
    #[must_use]
    pub const fn raw(self) -> u8 {
        match self {
            Self::Run => 1,
            Self::Hold => 2,
            Self::Resume => 3,
            Self::Reset => 4,
            Self::Stop => 5,
            Self::Cancel => 6,
            Self::Mode(mode) => Self::MODES | mode as u8,
            Self::Home(axes) => Self::HOME | axes.bits(),
        }
    }

    /// The order with this number.
    #[must_use]
    pub fn from_raw(raw: u8) -> Option<Self> {
        Some(match raw {
            1 => Self::Run,
            2 => Self::Hold,
            3 => Self::Resume,
            4 => Self::Reset,
            5 => Self::Stop,
            6 => Self::Cancel,
            Self::MODES..Self::HOME => {
                Self::Mode(OperatingMode::from_raw(raw.wrapping_sub(Self::MODES))?)
            }
            Self::HOME.. => Self::Home(Axes::from_bits(raw.wrapping_sub(Self::HOME))?),
            _ => return None,
        })
    }

    /// The order sets something in motion, or prepares that: it has to show that it is fresh.
    #[must_use]
    pub const fn needs_echo(self) -> bool {
        match self {
            Self::Run | Self::Resume | Self::Mode(_) | Self::Home(_) => true,
            Self::Hold | Self::Reset | Self::Stop | Self::Cancel => false,
        }
    }
}

/// Passes an order on once, however often its frame comes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OrderGate {
    last: Option<(u8, Order)>,
}

impl OrderGate {
    /// A gate before the first order: the gate takes the first order with any count.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: None }
    }

    /// The order is not the last one again.
    #[must_use]
    pub fn is_new(&self, count: u8, order: Order) -> bool {
        self.last != Some((count, order))
    }

    /// The order of a command, unless it repeats the last order.
    pub fn take(&mut self, count: u8, order: Option<Order>) -> Option<Order> {
        let order = order?;
        if !self.is_new(count, order) {
            return None;
        }
        self.last = Some((count, order));
        Some(order)
    }

    /// The count of the last order, for [`BoardStatus::count`](super::BoardStatus::count); 0 before the first.
    #[must_use]
    pub const fn count(&self) -> u8 {
        match self.last {
            Some((count, _)) => count,
            None => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_has_a_number_of_its_own() {
        let orders: [u8; 20] = [
            1, 2, 3, 4, 5, 6, 16, 17, 18, 19, 20, 21, 32, 33, 34, 35, 36, 37, 38, 39,
        ];
        for raw in 0..=u8::MAX {
            let order = Order::from_raw(raw);
            assert_eq!(order.is_some(), orders.contains(&raw), "{raw}");
            if let Some(order) = order {
                assert_eq!(order.raw(), raw);
            }
        }
        assert_eq!(
            Order::from_raw(21),
            Some(Order::Mode(OperatingMode::Automatic))
        );
        assert_eq!(Order::from_raw(32), Some(Order::Home(Axes::NONE)));
    }

    #[test]
    fn the_age_of_an_echo_wraps_and_the_future_has_none() {
        let now = Beat::new(5);
        assert_eq!(now.age_of(Beat::new(5)), Some(0));
        assert_eq!(now.age_of(Beat::new(65_530)), Some(11));
        assert_eq!(now.age_of(Beat::new(6)), None);
        assert_eq!(now.age_of(Beat::new(32_774)), Some(32_767));
        assert_eq!(now.age_of(Beat::new(32_773)), None);
    }

    #[test]
    fn an_order_is_taken_once_and_another_at_once() {
        let mut gate = OrderGate::new();
        assert_eq!(gate.count(), 0);
        assert_eq!(gate.take(0, Some(Order::Hold)), Some(Order::Hold));
        assert_eq!(gate.take(0, Some(Order::Hold)), None);
        // Settings alone are no order, and leave the count.
        assert_eq!(gate.take(9, None), None);
        assert_eq!(gate.count(), 0);
        assert_eq!(gate.take(1, Some(Order::Hold)), Some(Order::Hold));
        assert_eq!(gate.take(1, Some(Order::Stop)), Some(Order::Stop));
        assert_eq!(gate.take(1, Some(Order::Stop)), None);
        assert_eq!(gate.count(), 1);
    }
}
