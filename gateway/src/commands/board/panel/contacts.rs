//! Inputs and outputs for the page: the list of `io list`, told anew where it has changed. It must not know how it is
//! shown.

use leadscrew_core::params::Params;

use super::super::io;
use super::object;
use crate::cli::Global;
use crate::link::MachineContacts;
use crate::params::functions::Named;
use crate::words::Both;

/// Inputs and outputs of a board, and their names.
pub struct Contacts {
    names: Vec<Named>,
    /// Why they have no names.
    nameless: Option<Both>,
    last: String,
}

impl Contacts {
    /// With the names of the machine file. One that is wrong does not keep the page from being given out.
    pub fn new(global: &Global) -> Self {
        let (names, nameless) = match io::names(global) {
            Ok(names) => (names, None),
            Err(failure) => (Vec::new(), failure.words()),
        };
        Self {
            names,
            nameless,
            last: String::new(),
        }
    }

    /// The list, where it is another one than before.
    pub fn news(&mut self, contacts: &MachineContacts, params: &Params) -> Option<String> {
        let rows = io::rows(contacts, &self.names, params);
        let text = object(|json| {
            io::fields(&rows, json);
            json.array_at("note", |json| {
                if let Some(words) = &self.nameless {
                    json.text_item(&words.en);
                    json.text_item(&words.zh);
                }
            });
        });
        (text != self.last).then(|| {
            self.last.clone_from(&text);
            text
        })
    }
}
