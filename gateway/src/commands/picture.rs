//! What `plot` and `measure` write, and how: the ending of the file chooses. A format that there is none of, or that this
//! machine cannot make, is refused before anything is computed.

use std::path::Path;

use crate::cli::Global;
use crate::diagnostics;
use crate::failure::{Doing, Failure, Outcome};
use crate::pixels;
use crate::words::{self, both};

/// A format.
#[derive(Clone, Copy, Debug)]
pub(super) enum Format {
    Svg,
    Html,
    Png,
    /// Figures, of `measure` alone.
    Json,
}

impl Format {
    /// That of a picture.
    pub(super) fn of_picture(output: &Path) -> Outcome<Self> {
        match Self::by_ending(output)? {
            Some(Self::Json) | None => Err(Failure::Usage(both!(
                "`{output}`: the ending of the file chooses the format: `.svg`, `.png` or `.html`",
                "`{output}`：文件的扩展名决定格式：`.svg`、`.png` 或 `.html`",
                output = words::path(output)
            ))),
            Some(format) => Ok(format),
        }
    }

    /// That of a result: a picture or figures.
    pub(super) fn of_result(output: &Path) -> Outcome<Self> {
        Self::by_ending(output)?.ok_or_else(|| {
            Failure::Usage(both!(
                "`{output}`: the ending of the file chooses the format: `.svg`, `.png`, `.html` or `.json`",
                "`{output}`：文件的扩展名决定格式：`.svg`、`.png`、`.html` 或 `.json`",
                output = words::path(output)
            ))
        })
    }

    fn by_ending(output: &Path) -> Outcome<Option<Self>> {
        let ending = output.extension().and_then(|ending| ending.to_str());
        let ending = ending.unwrap_or_default().to_ascii_lowercase();
        Ok(match ending.as_str() {
            "svg" => Some(Self::Svg),
            "html" => Some(Self::Html),
            "png" => Some(Self::Png),
            "json" => Some(Self::Json),
            _ => None,
        })
    }
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
