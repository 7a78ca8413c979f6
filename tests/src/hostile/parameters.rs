//! A parameter file of any text.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Sim, SimError};
use leadscrew_common::output::line;
use leadscrew_common::params::load_bytes;
use leadscrew_core::alarm::Lang;

/// The first byte chooses the language. The rest is the file in any encoding.
///
/// # Panics
/// Where a file is neither accepted nor refused with a place in it, or where an accepted set gives no machine.
pub fn parameters(data: &[u8]) {
    let Some((choice, text)) = data.split_first() else {
        return;
    };
    let lang = if choice & 1 == 0 { Lang::En } else { Lang::Zh };
    let loaded = load_bytes("fuzz.toml", text, lang);
    assert!(!line(|told| loaded.report_fields(told)).is_empty());
    let lines = text
        .iter()
        .filter(|byte| matches!(byte, b'\n' | b'\r'))
        .count() as u32
        + 1;
    for told in &loaded.diagnostics {
        assert!(told.line <= lines, "{told:?} of {lines} lines");
        assert!(told.line == 0 || told.column < told.end_column, "{told:?}");
        assert!(!told.render(false).is_empty());
    }
    if !loaded.is_good() {
        return;
    }
    // An accepted set is good for a board. A plant has bounds of its own and reports them.
    match Sim::new(&loaded.params, &PlantOptions::default()) {
        Ok(mut sim) => {
            for _ in 0..50 {
                sim.step();
            }
        }
        Err(SimError::Plant(_)) => {}
        Err(SimError::Board(alarm)) => panic!("{alarm:?}"),
    }
}
