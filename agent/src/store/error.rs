//! Why nothing could be kept or read.

use std::fmt;
use std::io;

use crate::reserve;

/// Why nothing could be kept or read.
#[derive(Debug)]
pub enum StoreError {
    /// Another process has the file.
    InUse,
    /// An earlier version kept it for its one machine, and it does not say for which of several.
    Nameless,
    /// The file is something else.
    Foreign,
    /// The file cannot be opened, read or written.
    File(Box<redb::Error>),
    /// What is kept cannot be understood.
    Content(serde_json::Error),
}

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InUse => f.write_str("another process has it open"),
            Self::Nameless => f.write_str("it was kept for one machine whose name is not in it"),
            Self::Foreign => f.write_str("it is no store of an agent"),
            Self::File(error) => error.fmt(f),
            Self::Content(error) => write!(f, "what is kept is not understood: {error}"),
        }
    }
}

impl std::error::Error for StoreError {}

impl StoreError {
    pub(super) fn is_full(&self) -> bool {
        let Self::File(error) = self else {
            return false;
        };
        matches!(error.as_ref(), redb::Error::Io(error) if reserve::is_full(error))
    }
}

impl<E: Into<redb::Error>> From<E> for StoreError {
    fn from(error: E) -> Self {
        match error.into() {
            redb::Error::DatabaseAlreadyOpen => Self::InUse,
            redb::Error::Io(error) if error.kind() == io::ErrorKind::InvalidData => Self::Foreign,
            error => Self::File(Box::new(error)),
        }
    }
}

pub(super) type StoreResult<T = ()> = Result<T, StoreError>;
