//! What every command starts from: the machine's parameters, the language, and whether colour is welcome.

use std::io::IsTerminal as _;

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::Params;

use crate::cli::{Global, LangName};
use crate::failure::{Failure, Outcome};

/// The start of a command.
#[derive(Debug)]
pub struct Session<'a> {
    /// Options as typed.
    pub global: &'a Global,
    /// The machine.
    pub params: Params,
    /// Language of messages.
    pub lang: Lang,
    /// Standard error is a terminal and nobody minds colour.
    pub colour: bool,
}

impl<'a> Session<'a> {
    /// Loads what the options name.
    pub fn new(global: &'a Global) -> Outcome<Self> {
        if !global.params.is_empty() || !global.set.is_empty() {
            return Err(Failure::Usage(
                "`--params` and `--set` are not available yet".into(),
            ));
        }
        Ok(Self {
            global,
            params: Params::slant_bed(),
            lang: match global.lang {
                LangName::En => Lang::En,
                LangName::Zh => Lang::Zh,
            },
            colour: colour(),
        })
    }
}

/// <https://no-color.org>: any non-empty `NO_COLOR` switches colour off.
fn colour() -> bool {
    std::io::stderr().is_terminal()
        && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
