//! `params set`: single values, to a board in one transaction, or into a machine file where they stand.

use leadscrew_can::Address;

use super::push::{self, Wish};
use crate::cli::{Global, Write};
use crate::failure::{Doing, Failure, Outcome};
use crate::output;
use crate::params::difference::{self, changes};
use crate::params::{self, edit};
use crate::replace::replace;
use crate::setup::told_good;
use crate::words::{both, pick};

/// Writes them.
pub fn run(global: &Global, args: &Write) -> Outcome {
    let set: Vec<String> = global.set.iter().chain(&args.values).cloned().collect();
    if global.bus != Address::Sim || global.state.is_some() {
        let wish = Wish {
            files: &global.params,
            set: &set,
            built_in: false,
            password: args.password,
        };
        return push::transact(global, &wish);
    }
    into_file(global, &set)
}

/// The one file of `--params` takes them over.
fn into_file(global: &Global, set: &[String]) -> Outcome {
    let lang = global.lang();
    let [path] = &global.params[..] else {
        return Err(Failure::Usage(both!(
            "`params set` needs a place for the values: a board (`--bus can0`), the flash of a simulated one (`--state \
             FILE`), or one machine file (`--params FILE`)",
            "`params set` 需要写入的位置：控制板（`--bus can0`）、模拟控制板的闪存（`--state FILE`），或一个机床参数文件（`--params FILE`）"
        )));
    };
    let before = told_good(global, params::load(&global.params, &[], lang)?)?;
    let after = told_good(global, params::load(&global.params, set, lang)?)?;
    let text = params::read(path, lang)?;
    let new = edit::with_values(&text, &after.by_options());
    if new != text && !global.dry_run {
        replace(path, new.as_bytes())
            .map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
    }
    let changes = changes(&before.params, &after.params);
    if global.json {
        return output::json(|o| {
            o.flag("ok", true);
            difference::fields(o, &changes, &[]);
        });
    }
    if changes.is_empty() {
        return output::write(pick(lang, "no difference\n", "没有差别\n").as_bytes());
    }
    output::write(difference::text(&changes, &[], lang).as_bytes())
}
