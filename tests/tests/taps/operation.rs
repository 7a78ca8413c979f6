//! Feed hold, single block, override: the tables of the sheet.
