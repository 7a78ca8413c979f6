//! `--set NO[.BIT|.AXIS]=VALUE`.

use leadscrew_core::params::{Entry, Writing};

use super::Loader;
use crate::diagnostics::Place;
use crate::failure::{Failure, Outcome};
use crate::words::both;

/// What stands in the place of a file's name.
pub const NAME: &str = "--set";

/// Takes one option. The unit may be left out: it is the one that `params docs` prints.
pub fn apply(loader: &mut Loader, text: &str) -> Outcome {
    let Some((name, value)) = text.split_once('=') else {
        return Err(Failure::Usage(both!(
            "`--set {text}`: expected NO[.BIT|.AXIS]=VALUE, for example `--set 182.7=1` or `--set 1420.X=12000`",
            "`--set {text}`：应写成 NO[.BIT|.AXIS]=VALUE，例如 `--set 182.7=1` 或 `--set 1420.X=12000`"
        )));
    };
    let equals = name.chars().count() + 1;
    let place = |column, end_column| Place {
        file: NAME.into(),
        line: 1,
        column,
        end_column,
        text: text.into(),
    };
    let at_key = place(1, equals);
    let at_value = place(equals + 1, text.chars().count() + 1);
    match Entry::find_text(name) {
        Ok(entry) => loader.set(
            entry,
            value.trim(),
            Writing::UnitOptional,
            &at_key,
            &at_value,
        ),
        Err(error) => loader.not_found(name.trim(), error, &at_key),
    }
    Ok(())
}
