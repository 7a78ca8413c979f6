//! Which G and M codes there are, and which exclude each other in a block.

/// G codes of which a block may have one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Group {
    /// G00 G01 G02 G03 G32 G34 G90 G92 G94: how axis words move.
    Motion,
    /// G04 G10 G28 G30 G50 G53 G74 G75 G76 G78: for their own block only.
    OneShot,
    /// G17 G18 G19.
    Plane,
    /// G20 G21.
    Unit,
    /// G40.
    Compensation,
    /// G54 … G59.
    System,
    /// G61 G64.
    Path,
    /// G80 G84 G88.
    Canned,
    /// G96 G97.
    SpeedMode,
    /// G98 G99.
    FeedMode,
}

impl Group {
    /// Number of groups.
    pub(crate) const COUNT: usize = 10;

    /// Its bit in a set of groups.
    pub(crate) const fn bit(self) -> u16 {
        1 << self as u16
    }
}

/// M codes of which a block may have one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MGroup {
    /// M03 M04 M05.
    Spindle,
    /// M08 M09.
    Coolant,
    /// M00 M01 M02 M30.
    Flow,
    /// M24 M25 M26 M27: which spindle taps.
    TapSpindle,
    /// The code of 5210: rigid tapping.
    Rigid,
    /// Any code without a meaning of its own: clamps the C axis in a tapping block, is unknown elsewhere.
    Clamp,
}

impl MGroup {
    /// Number of groups.
    pub(crate) const COUNT: usize = 6;

    /// Its bit in a set of groups.
    pub(crate) const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// What is known of a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Known<T> {
    /// It works.
    Yes(T),
    /// It exists on the control and is not built yet.
    NotYet,
    /// G33: another thing on each control [D19].
    Tapping,
    /// No such code.
    No,
}

/// What `G<code>` is.
#[inline]
pub(crate) const fn g_code(code: i64) -> Known<Group> {
    Known::Yes(match code {
        0..=3 | 32 | 34 | 90 | 92 | 94 => Group::Motion,
        4 | 10 | 28 | 30 | 50 | 53 | 74..=76 | 78 => Group::OneShot,
        17..=19 => Group::Plane,
        20 | 21 => Group::Unit,
        40 => Group::Compensation,
        54..=59 => Group::System,
        61 | 64 => Group::Path,
        80 | 84 | 88 => Group::Canned,
        96 | 97 => Group::SpeedMode,
        98 | 99 => Group::FeedMode,
        33 => return Known::Tapping,
        41 | 42 | 65..=67 | 70..=73 => {
            return Known::NotYet;
        }
        _ => return Known::No,
    })
}

/// True for the M codes that lathes of the family have for their chuck, tailstock, turret, gears, conveyor, doors and air.
#[inline]
pub(crate) const fn is_machine_code(code: i64) -> bool {
    matches!(code, 6 | 7 | 10..=23 | 31..=33 | 36..=69 | 78 | 79 | 85 | 86 | 88 | 89)
}

/// What `M<code>` is where `rigid` is the code of rigid tapping. A code with a meaning of its own keeps it.
#[inline]
pub(crate) const fn m_code(code: i64, rigid: u8) -> Known<MGroup> {
    Known::Yes(match code {
        3..=5 => MGroup::Spindle,
        8 | 9 => MGroup::Coolant,
        0..=2 | 30 => MGroup::Flow,
        24..=27 => MGroup::TapSpindle,
        98 | 99 => return Known::NotYet,
        _ if code == rigid as i64 => MGroup::Rigid,
        _ => MGroup::Clamp,
    })
}
