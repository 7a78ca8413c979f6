//! The table of a machine's metrics: names, kinds, units.
//!
//! It must not know records. The aliases of a machine's metrics follow one another as these rows do: one connection's
//! births tell them anew, so rows may move.

use super::payload::Kind;

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Its name.
    pub name: &'static str,
    /// The kind of its values.
    pub kind: Kind,
    /// Their unit; empty where they have none.
    pub unit: &'static str,
}

/// A metric: its place in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place(pub(super) usize);

macro_rules! metrics {
    ($($place:ident = $name:literal, $kind:ident, $unit:literal;)*) => {
        #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
        enum Order { $($place),* }
        $(pub(super) const $place: Place = Place(Order::$place as usize);)*

        /// Every metric of a machine.
        pub const TABLE: &[Row] = &[
            $(Row { name: $name, kind: Kind::$kind, unit: $unit }),*
        ];
    };
}

metrics! {
    RECORD_NUMBER = "Record/Number", UInt64, "";
    RECORD_KIND = "Record/Kind", String, "";
    BOARD_ALIVE = "Board/Alive", Boolean, "";
    BOARD_WHY = "Board/Why", String, "";
    BOARD_SERIAL = "Board/Serial", String, "";
    BOARD_START = "Board/Start", UInt32, "";
    BOARD_PARAMETERS = "Board/Parameters", String, "";
    BOARD_FIRMWARE = "Board/Firmware", String, "";
    MACHINE_STATE = "Machine/State", String, "";
    MACHINE_MODE = "Machine/Mode", String, "";
    MACHINE_ALARM = "Machine/Alarm", UInt16, "";
    MACHINE_HOLD = "Machine/Hold", Boolean, "";
    MACHINE_SINGLE = "Machine/Single Block", Boolean, "";
    PROGRAM_NUMBER = "Program/Number", UInt32, "";
    PROGRAM_LINE = "Program/Line", UInt32, "";
    PROGRAM_MOVE = "Program/Move", UInt32, "";
    OVERRIDE_FEED = "Override/Feed", UInt8, "%";
    OVERRIDE_RAPID = "Override/Rapid", UInt8, "%";
    OVERRIDE_SPINDLE = "Override/Spindle", UInt8, "%";
    SPINDLE_SPEED = "Spindle/Speed", Int32, "1/min";
    SPINDLE_COMMANDED = "Spindle/Commanded", Int32, "1/min";
    SETPOINTS_LATE = "Setpoints/Late", UInt32, "";
    BUS_LOAD = "Bus/Load", UInt8, "%";
    BUS_ERRORS = "Bus/Errors", UInt64, "";
    EVENT_KEY = "Event/Key", String, "";
    EVENT_KIND = "Event/Kind", String, "";
    EVENT_TICK = "Event/Tick", UInt64, "";
    EVENT_ALARM = "Event/Alarm", UInt16, "";
    EVENT_LINE = "Event/Line", UInt32, "";
    EVENT_CAUSE = "Event/Cause", String, "";
    EVENT_REMEDY = "Event/Remedy", String, "";
    THREAD_KEY = "Thread/Key", String, "";
    THREAD_PROGRAM = "Thread/Program", UInt32, "";
    THREAD_LINE = "Thread/Line", UInt32, "";
    THREAD_KIND = "Thread/Kind", String, "";
    THREAD_END = "Thread/End", String, "";
    THREAD_PASSES = "Thread/Passes", UInt16, "";
    THREAD_LATE = "Thread/Late", UInt16, "";
    THREAD_MEASURED = "Thread/Measured", UInt64, "ticks";
    THREAD_LARGEST = "Thread/Largest Error", Double, "µm";
    THREAD_RMS = "Thread/RMS Error", Double, "µm";
    CUT_KNOWN = "Cut/Known", String, "";
    CUT_WHY = "Cut/Why", String, "";
    CUT_AXIS = "Cut/Axis", String, "";
    CUT_AGE = "Cut/Age Known", Boolean, "";
    CUT_POSITIONS = "Cut/Positions", UInt16, "";
    CUT_PASSES = "Cut/Passes", UInt8, "";
    CUT_LEAD = "Cut/Lead", Double, "mm";
    CUT_LEAST = "Cut/Least Groove", Double, "µm";
    CUT_LEAST_U = "Cut/Least Groove U", Double, "µm";
    CUT_MOST = "Cut/Most Groove", Double, "µm";
    CUT_MOST_U = "Cut/Most Groove U", Double, "µm";
    CUT_APART = "Cut/Pass to Pass", Double, "µm";
    CUT_APART_U = "Cut/Pass to Pass U", Double, "µm";
    CUT_SLOPE = "Cut/Lead Error", Double, "µm";
    CUT_SLOPE_U = "Cut/Lead Error U", Double, "µm";
    CUT_WORST = "Cut/Worst", Double, "µm";
    CUT_WORST_U = "Cut/Worst U", Double, "µm";
    RUN_KEY = "Run/Key", String, "";
    RUN_FINISHED = "Run/Finished", Boolean, "";
    RUN_TICKS = "Run/Ticks", UInt64, "ticks";
    RUN_HASH = "Run/Setpoint Hash", String, "";
    RUN_LATE = "Run/Late", UInt32, "";
    RUN_MEASURED = "Run/Measured", UInt64, "ticks";
    RUN_LARGEST = "Run/Largest Error", Double, "µm";
    RUN_RMS = "Run/RMS Error", Double, "µm";
    GAP_KEY = "Gap/Key", String, "";
    GAP_OF = "Gap/Of", String, "";
    GAP_FIRST = "Gap/First", UInt32, "";
    GAP_LAST = "Gap/Last", UInt32, "";
    LOSS_RECORDS = "Loss/Records", UInt64, "";
    LOSS_FIRST = "Loss/First", UInt64, "";
    LOSS_LAST = "Loss/Last", UInt64, "";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_is_given_twice() {
        let mut names: Vec<&str> = TABLE.iter().map(|row| row.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), TABLE.len());
    }
}
