//! What `plot`, `measure` and `tune` write, and how: the ending of the file chooses. A format that there is none of, or
//! that this machine cannot make, is refused before anything is computed.

use std::path::Path;

use crate::cli::Global;
use crate::diagnostics;
use crate::failure::{Doing, Failure, Outcome};
use crate::pixels;
use crate::words::{self, both};

/// A format of pictures.
#[derive(Clone, Copy, Debug)]
pub(super) enum PictureFormat {
    Svg,
    Html,
    Png,
}

/// A format of results: a picture, or figures.
#[derive(Clone, Copy, Debug)]
pub(super) enum Format {
    Picture(PictureFormat),
    Json,
}

impl PictureFormat {
    /// The one that the ending of a file chooses.
    pub(super) fn of(output: &Path) -> Outcome<Self> {
        Self::by_ending(&ending(output)).ok_or_else(|| {
            Failure::Usage(both!(
                "`{output}`: the ending of the file chooses the format: `.svg`, `.png` or `.html`",
                "`{output}`：文件的扩展名决定格式：`.svg`、`.png` 或 `.html`",
                output = words::path(output)
            ))
        })
    }

    fn by_ending(ending: &str) -> Option<Self> {
        match ending {
            "svg" => Some(Self::Svg),
            "html" => Some(Self::Html),
            "png" => Some(Self::Png),
            _ => None,
        }
    }
}

impl Format {
    /// The one that the ending of a file chooses.
    pub(super) fn of(output: &Path) -> Outcome<Self> {
        let ending = ending(output);
        if ending == "json" {
            return Ok(Self::Json);
        }
        let picture = PictureFormat::by_ending(&ending).map(Self::Picture);
        picture.ok_or_else(|| {
            Failure::Usage(both!(
                "`{output}`: the ending of the file chooses the format: `.svg`, `.png`, `.html` or `.json`",
                "`{output}`：文件的扩展名决定格式：`.svg`、`.png`、`.html` 或 `.json`",
                output = words::path(output)
            ))
        })
    }
}

/// The ending of a file, in small letters.
fn ending(output: &Path) -> String {
    let ending = output.extension().and_then(|ending| ending.to_str());
    ending.unwrap_or_default().to_ascii_lowercase()
}

/// Writes a file.
pub(super) fn write(output: &Path, content: impl AsRef<[u8]>) -> Outcome {
    std::fs::write(output, content)
        .map_err(|error| Failure::file(Doing::Write, output.display(), &error))
}

/// Writes an SVG as pixels.
pub(super) fn write_png(global: &Global, output: &Path, svg: &str) -> Outcome {
    let image = pixels::png(svg)?;
    write(output, &image.png)?;
    if !global.json {
        let (file, size) = (words::path(output), image.size());
        diagnostics::say(both!("{file}: {size}\n", "{file}：{size}\n").get(global.lang()));
    }
    Ok(())
}
