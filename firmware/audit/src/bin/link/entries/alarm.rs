//! Alarms as data.

use audit::any::{any, sink};
use leadscrew_core::alarm::{Alarm, Code};

/// Calls all entries of this module.
pub fn all() {
    alarm();
}

#[inline(never)]
fn alarm() {
    for code in Code::ALL {
        let alarm = Alarm::new(*code, any()).word(any());
        sink((alarm.number(), alarm.code.is_warning()));
    }
}
