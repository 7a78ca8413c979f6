//! From parameter files and `--set` options to a set of parameters: first the built-in machine, over it the files in their
//! order, over them the options.
//!
//! A mistake never hides another: all mistakes are reported at once, each with place, cause and remedy. Nothing is ignored
//! and nothing is rounded.

pub mod difference;
pub mod drives;
pub mod edit;
mod file;
pub mod functions;
mod mistake;
mod option;
pub mod schema;
#[cfg(test)]
mod tests;
mod text;
pub mod whole;

use std::collections::BTreeMap;
use std::path::PathBuf;

use leadscrew_core::alarm::{Alarm, Arg, Code, Lang};
use leadscrew_core::bus::Cycle;
use leadscrew_core::params::{Entry, FindError, Params, Part, Writing};
use leadscrew_core::units::Axis;
use leadscrew_language::dialect::Control;
use leadscrew_language::heading::Allowed;
use leadscrew_wording::figure;

use crate::diagnostics::{self, Diagnostic, Place};
use crate::failure::Outcome;
use crate::json::Json;
use crate::words::{one_line, pick};

pub use file::read;
pub use mistake::unknown_key;
pub use text::{CHAPTERS, literal, meaning, name, value_text};

/// A set of parameters, the places of its values, and its mistakes.
#[derive(Debug)]
pub struct Loaded {
    /// The set. It is complete and usable only where [`Loaded::is_good`].
    pub params: Params,
    /// Alarms and warnings in the order in which they were found.
    pub diagnostics: Vec<Diagnostic>,
    /// The wanted objects of the drives in the order of the files.
    pub drives: Vec<drives::Setting>,
    /// The profiles of the drives, where their sections name one.
    pub profiles: Vec<drives::OfProfile>,
    /// The control that programs beside the file are written for.
    pub dialect: Option<Control>,
    /// Numbers of what is not told of programs beside the file.
    pub allow: Allowed,
    /// Names of inputs and outputs in the order of the files.
    pub names: Vec<functions::Named>,
    /// Tables of M codes in the order of the files.
    functions: Vec<functions::Table>,
    /// The values without a place are a board's; otherwise the built-in machine's.
    pub of_a_board: bool,
    sources: BTreeMap<Key, Source>,
}

/// Keys at the top of a file that are no parameters.
const OTHER_KEYS: [&str; 6] = [
    schema::KEY,
    drives::KEY,
    DIALECT,
    ALLOW,
    functions::IO,
    functions::M,
];

/// The key of the control that programs beside the file are written for.
pub(crate) const DIALECT: &str = "dialect";

/// The key of the numbers that are not told of programs beside the file.
pub(crate) const ALLOW: &str = "allow";

/// The number and part of an entry, for sorting.
type Key = (u16, u8);

/// The place of a value that differs from the built-in machine's.
#[derive(Debug)]
struct Source {
    /// Counts up: a larger number was written later.
    order: usize,
    /// The number of the file or option.
    layer: usize,
    place: Place,
}

/// A set that is being put together.
struct Loader {
    loaded: Loaded,
    lang: Lang,
    /// The file or option that is being read, from 1.
    layer: usize,
    /// Values read so far.
    count: usize,
}

/// Lays files and options over the built-in machine and checks the result as a whole.
///
/// # Errors
/// A file that cannot be read, or an option without `=`: the command line is wrong. Mistakes in the parameters are in
/// [`Loaded::diagnostics`].
pub fn load(files: &[PathBuf], options: &[String], lang: Lang) -> Outcome<Loaded> {
    load_over(None, files, options, lang)
}

/// The same over a board's set.
///
/// # Errors
/// As [`load`].
pub fn load_over(
    base: Option<Params>,
    files: &[PathBuf],
    options: &[String],
    lang: Lang,
) -> Outcome<Loaded> {
    let mut loader = Loader::new(base, lang);
    for path in files {
        let bytes = file::read_bytes(path)?;
        loader.file(&path.display().to_string(), &bytes);
    }
    for text in options {
        loader.layer += 1;
        option::apply(&mut loader, text)?;
    }
    Ok(loader.finish())
}

/// As [`load`], for the text of one file and no options.
#[must_use]
pub fn load_text(name: &str, text: &str, lang: Lang) -> Loaded {
    load_bytes(name, text.as_bytes(), lang)
}

/// The same for the bytes of a file.
#[must_use]
pub fn load_bytes(name: &str, bytes: &[u8], lang: Lang) -> Loaded {
    let mut loader = Loader::new(None, lang);
    loader.file(name, bytes);
    loader.finish()
}

impl Loader {
    fn new(base: Option<Params>, lang: Lang) -> Self {
        let loaded = match base {
            Some(params) => Loaded::of(params),
            None => Loaded {
                of_a_board: false,
                ..Loaded::of(Params::slant_bed())
            },
        };
        Self {
            loaded,
            lang,
            layer: 0,
            count: 0,
        }
    }

    fn file(&mut self, name: &str, bytes: &[u8]) {
        self.layer += 1;
        file::apply(self, name, bytes);
    }

    fn finish(mut self) -> Loaded {
        // An incomplete set would only give wrong reasons.
        if self.loaded.is_good() {
            drives::fill(&mut self);
        }
        if self.loaded.is_good() {
            self.loaded.cross_check(self.lang);
        }
        self.loaded
    }
}

impl Loaded {
    /// The set of a board.
    #[must_use]
    pub const fn of(params: Params) -> Self {
        Self {
            params,
            diagnostics: Vec::new(),
            drives: Vec::new(),
            profiles: Vec::new(),
            dialect: None,
            allow: Allowed::NONE,
            names: Vec::new(),
            functions: Vec::new(),
            of_a_board: true,
            sources: BTreeMap::new(),
        }
    }

    /// Reports all findings to a person.
    pub fn tell(&self, colour: bool) {
        for diagnostic in &self.diagnostics {
            diagnostics::print(diagnostic, colour);
        }
    }

    /// `"alarms"` and `"warnings"`: the findings in the machine format.
    pub fn report_fields(&self, json: &mut Json) {
        for (key, warning) in [("alarms", false), ("warnings", true)] {
            json.array_at(key, |list| {
                for diagnostic in self.diagnostics.iter().filter(|d| d.warning == warning) {
                    list.object(|o| diagnostic.fields(o, true));
                }
            });
        }
    }

    /// The values that options have set, in the order of the table.
    pub fn by_options(&self) -> Vec<(&'static Entry, i64)> {
        let by_option = |entry: &&Entry| {
            let source = self.sources.get(&key(entry));
            source.is_some_and(|source| source.place.file == option::NAME)
        };
        let all = Entry::all().iter().filter(by_option);
        all.map(|entry| (entry, self.params.get(entry))).collect()
    }

    /// True where there are only warnings.
    pub fn is_good(&self) -> bool {
        self.diagnostics.iter().all(|d| d.warning)
    }

    /// True where every value of the table was written somewhere, so that the set below does not matter.
    pub fn names_all(&self) -> bool {
        let named = |entry| self.sources.contains_key(&key(entry));
        Entry::all().iter().all(named)
    }

    /// The place of a value: `FILE:LINE`, or the option; `None` for a value of the set below.
    pub fn source(&self, entry: &Entry) -> Option<String> {
        let place = &self.sources.get(&key(entry))?.place;
        Some(if place.file == option::NAME {
            format!("{} {}", option::NAME, place.text)
        } else {
            format!("{}:{}", one_line(&place.file), place.line)
        })
    }

    fn cross_check(&mut self, lang: Lang) {
        let mut found = Vec::new();
        self.params.check(|alarm| found.push(alarm));
        if found.is_empty() {
            // No board joins a bus on which its cycle leaves no room.
            found.extend(Cycle::of(&self.params).check().err());
        }
        for alarm in found {
            let figures = alarm.args.map(|arg| figure(arg, lang, false));
            let place = self.blame(&alarm, lang);
            let diagnostic = Diagnostic::of_option(alarm.code, &figures, &place, lang);
            self.diagnostics.push(diagnostic);
        }
        for conflict in drives::conflicts(&self.drives, &self.params) {
            let (code, figures) = (conflict.code, &conflict.figures);
            let diagnostic = Diagnostic::of_option(code, figures, &conflict.place, lang);
            self.diagnostics.push(diagnostic);
        }
    }

    /// The place of the last value among those that make a condition.
    fn blame(&self, alarm: &Alarm, lang: Lang) -> Place {
        let axis = match alarm.args[0] {
            Arg::Letter(letter) => Axis::ALL.into_iter().find(|axis| axis.letter() == letter),
            _ => None,
        };
        // The drives of two axes, or of an axis and a spindle.
        let among = |letter| alarm.args.contains(&Arg::Letter(letter));
        let is_axis = |entry: &Entry| match (alarm.code, entry.part) {
            (Code::DriveNodeTwice, Part::Axis(of)) => among(of.letter()),
            (Code::DriveNodeTwice, _) => among(b'S'),
            (_, Part::Axis(of)) => axis.is_none_or(|axis| axis == of),
            (_, Part::Whole | Part::Bit(_)) => true,
        };
        // A ramp depends on several axes. The named axis counts first.
        let source = Entry::all()
            .iter()
            .filter(|entry| numbers(alarm.code).contains(&entry.no))
            .filter_map(|entry| Some((is_axis(entry), self.sources.get(&key(entry))?)))
            .filter(|(is_axis, _)| *is_axis || alarm.code == Code::RampTooLong)
            .max_by_key(|(is_axis, source)| (*is_axis, source.order))
            .map(|(_, source)| source);
        source.map_or_else(
            || Place {
                file: if self.of_a_board {
                    pick(lang, "the board's parameters", "控制板的参数").into()
                } else {
                    pick(lang, "the built-in machine", "内置机床").into()
                },
                ..Place::default()
            },
            |source| source.place.clone(),
        )
    }
}

/// The parameters that a cross-check compares.
fn numbers(code: Code) -> &'static [u16] {
    match code {
        Code::RampTooLong => &[1420, 1620, 1622, 9000],
        Code::SoftLimitsInverted => &[1320, 1321],
        Code::FeedAboveRapid => &[1420, 1430],
        Code::ObserverTooFast | Code::ObserverNoisy => &[9000, 9005],
        Code::EncoderCoarse => &[3720, 9006],
        Code::IncrementTooFine => &[9001, 9002],
        Code::TapCodeTaken => &[5210],
        Code::RapidBeyondTick => &[1420, 9000],
        Code::SpindleTooFastForTick => &[3772, 9000],
        Code::TravelBeyondDrive => &[1320, 1321, 9001, 9002, 9058],
        Code::IncrementAboveLimit => &[1828, 9001, 9002],
        Code::ToleranceAboveVariation => &[9007, 9010],
        Code::GainTooLow => &[9070, 9073],
        Code::TargetsTooSlow => &[9077, 9078, 9070, 9071, 1420, 1430, 1620, 1622],
        Code::PitchErrorSteep | Code::PitchErrorBent => &[
            1862, 1871, 1872, 1873, 1874, 1875, 1876, 1877, 1878, 1879, 1880, 1881, 1882, 1883,
            1884, 1885, 1886, 1420,
        ],
        Code::HomeSwitchNone => &[9051, 9050],
        Code::ZoneHalf => &[9092, 9093, 9094, 9095],
        Code::LimitSwitchShared => &[9064, 9065],
        Code::TapSpeedAboveSpindle => &[3772, 5241],
        Code::NoPeckReturn => &[5213],
        Code::ExtractionOverrideOff => &[5200, 5201],
        Code::FunctionUnusable => &[
            9401, 9402, 9403, 9404, 9405, 9406, 9407, 9408, 9409, 9410, 9411, 9412, 9413, 9414,
            9415, 9416,
        ],
        Code::TurretUnusable => &[9451, 9452, 9454, 9455, 9456],
        Code::GearUnusable => &[
            3772, 9013, 9431, 9432, 9433, 9434, 9436, 9437, 9438, 9439, 9441, 9442, 9443, 9444,
        ],
        Code::BlockNodeTaken => &[9461, 9014, 9015, 9016],
        Code::BlockMissing => &[9461],
        Code::DriveNodeTwice => &[9014, 9015, 9016],
        Code::BusOverload => &[9000, 9014, 9020, 9021, 9022, 9031, 9032],
        _ => &[],
    }
}

fn key(entry: &Entry) -> Key {
    let part = match entry.part {
        Part::Whole => 0,
        Part::Bit(bit) => bit,
        Part::Axis(axis) => axis.letter(),
    };
    (entry.no, part)
}

impl Loader {
    fn report(&mut self, code: Code, figures: &[String], place: &Place) {
        let diagnostic = Diagnostic::of_option(code, figures, place, self.lang);
        self.loaded.diagnostics.push(diagnostic);
    }

    fn not_found(&mut self, name: &str, error: FindError, place: &Place) {
        let (code, figures) = mistake::not_found(name, error);
        self.report(code, &figures, place);
    }

    /// Takes a raw value that a file says in its own words; false where this file has set it already.
    fn put(&mut self, entry: &'static Entry, raw: i64, at: &Place) -> bool {
        if let Some(first) = self.loaded.sources.get(&key(entry))
            && first.layer == self.layer
        {
            let line = first.place.line.to_string();
            self.report(Code::ParamTwice, &[mistake::label(entry), line], at);
            return false;
        }
        // What makes it keeps within the range.
        let _ = self.loaded.params.set(entry, raw);
        self.came_from(entry, at);
        true
    }

    fn came_from(&mut self, entry: &'static Entry, at: &Place) {
        self.count += 1;
        let source = Source {
            order: self.count,
            layer: self.layer,
            place: at.clone(),
        };
        self.loaded.sources.insert(key(entry), source);
    }

    /// Takes one value. `at_key` and `at_value` are the places for a mistake in either.
    fn set(
        &mut self,
        entry: &'static Entry,
        text: &str,
        writing: Writing,
        at_key: &Place,
        at_value: &Place,
    ) {
        if let Some(first) = self.loaded.sources.get(&key(entry))
            && first.layer == self.layer
        {
            let line = first.place.line.to_string();
            return self.report(Code::ParamTwice, &[mistake::label(entry), line], at_key);
        }
        let set = entry
            .parse(text, writing)
            .and_then(|raw| self.loaded.params.set(entry, raw));
        if let Err(error) = set {
            let (code, figures) = mistake::not_taken(entry, text, writing, error);
            self.report(code, &figures, at_value);
        }
        // Counted also where it was refused, so that a second mistake about the same value is reported as such.
        self.came_from(entry, at_value);
    }
}
