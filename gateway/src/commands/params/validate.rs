//! `params validate`: whether the set that `--params` and `--set` make can work.

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::Entry;

use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::{diagnostics, params};

/// Tells everything that is wrong; exit 1 where an alarm is among it.
pub fn run(global: &Global) -> Outcome {
    let lang = global.lang();
    let loaded = params::load(&global.params, &global.set, lang)?;
    if global.json {
        output::write(&loaded.report())?;
    } else {
        loaded.tell(diagnostics::colour());
        if loaded.is_good() {
            let set = Entry::all().iter().filter(|e| loaded.source(e).is_some());
            let (all, set) = (Entry::all().len(), set.count());
            let line = match lang {
                Lang::En => format!(
                    "good: {all} values, {set} of them set here, the others the built-in machine's\n"
                ),
                Lang::Zh => {
                    format!("正确：共 {all} 个值，其中 {set} 个在此设定，其余为内置机床的值\n")
                }
            };
            output::write(line.as_bytes())?;
        }
    }
    if loaded.is_good() {
        Ok(())
    } else {
        Err(Failure::Wrong)
    }
}
