//! The way out of every `tune`: a file where one was named, the terminal, and the parameters where that was asked.
//!
//! It must not know what was tuned.

use std::path::Path;

use leadscrew_core::alarm::Lang;
use svg::node::element::Text;

use crate::cli::{Global, Tune};
use crate::commands::params::{Wish, transact};
use crate::commands::picture::{self, Format, PictureFormat};
use crate::failure::Outcome;
use crate::json::Json;
use crate::output;
use crate::page;
use crate::words::Both;

/// What a `tune` has found.
pub trait Tells {
    /// Title of its page.
    fn title(&self) -> String;
    /// For people.
    fn words(&self) -> Both;
    /// For programs.
    fn fields(&self, json: &mut Json);
    /// As SVG.
    fn picture(&self, lang: Lang) -> String;
    /// The parameters that follow from it, as `--set` takes them.
    fn values(&self) -> Vec<String>;
}

/// The file that was named, before anything moves.
///
/// # Errors
/// A format that is none.
pub fn file(args: &Tune) -> Outcome<Option<(&Path, Format)>> {
    let path = args.output.as_deref();
    let format = path.map(Format::of).transpose()?;
    Ok(path.zip(format))
}

/// Tells it, and writes the parameters where that was asked.
///
/// # Errors
/// The file cannot be written, or the board does not take the parameters.
pub fn finish(
    global: &Global,
    args: &Tune,
    file: Option<(&Path, Format)>,
    told: &impl Tells,
) -> Outcome {
    if let Some((path, format)) = file {
        write(global, path, &format, told)?;
    }
    // With `--write` and `--json` the one result is that of the transaction.
    if !(global.json && args.write) {
        match global.json {
            true => output::json(|json| told.fields(json))?,
            false => output::write(told.words().get(global.lang()).as_bytes())?,
        }
    }
    if !args.write {
        return Ok(());
    }
    transact(
        global,
        &Wish {
            files: &[],
            set: &told.values(),
            built_in: false,
            password: None,
        },
    )
}

fn write(global: &Global, path: &Path, format: &Format, told: &impl Tells) -> Outcome {
    let lang = global.lang();
    match format {
        Format::Json => {
            let mut json = Json::new();
            json.object(|json| told.fields(json));
            picture::write(path, json.into_bytes())
        }
        Format::Picture(PictureFormat::Html) => {
            let words = told.words();
            let page = page::sheet(&told.title(), &told.picture(lang), words.get(lang), lang);
            picture::write(path, page)
        }
        Format::Picture(PictureFormat::Svg) => picture::write(path, told.picture(lang)),
        Format::Picture(PictureFormat::Png) => {
            picture::write_png(global, path, &told.picture(lang))
        }
    }
}

/// A text in a picture.
pub fn label(x: f64, y: f64, text: String) -> Text {
    Text::new(text)
        .set("x", x)
        .set("y", y)
        .set("font-family", "sans-serif")
        .set("font-size", 14)
}
