//! A picture of ours as pixels: SVG in, PNG out, with fonts of its own, so it is the same on every machine, also where
//! there is no font. Those of the system come in only for a character that these have not. A picture is whole or refused:
//! text that no font can draw is never left out. Must not know what a picture shows.

use std::collections::BTreeSet;
use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Source};
use resvg::usvg::{Group, Node, Options, Tree};

use crate::failure::{Failure, Outcome};
use crate::words::{Both, both};

/// Pixels for each of the SVG: sharp on a dense screen, and 200 dpi on a page of A4 across.
pub const SCALE: u16 = 2;
/// The most pixels of a side: more is not opened everywhere.
const MOST: u32 = 32_767;
/// The most missing characters that are told.
const TOLD: usize = 12;
/// Fonts of our own: what they are, and their licences, stands beside them.
const OWN: [&[u8]; 3] = [
    include_bytes!("fonts/DejaVuSans.ttf"),
    include_bytes!("fonts/DejaVuSans-Bold.ttf"),
    include_bytes!("fonts/NotoSansSC.ttf"),
];

/// A PNG with its size in pixels.
#[derive(Clone, Debug)]
pub struct Image {
    /// The file.
    pub png: Vec<u8>,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl Image {
    /// Its size for a person.
    pub fn size(&self) -> String {
        format!("{} × {} px", self.width, self.height)
    }
}

/// The fonts of our own.
fn own() -> Database {
    let mut fonts = Database::new();
    for font in OWN {
        fonts.load_font_source(Source::Binary(Arc::new(font)));
    }
    chosen(&mut fonts);
    fonts
}

/// What stands for a family that is not there. Without one the text would be left out as if it were none.
fn chosen(fonts: &mut Database) {
    fonts.set_sans_serif_family("DejaVu Sans");
    fonts.set_serif_family("DejaVu Sans");
}

/// Those, and the fonts of the system.
fn with_system() -> Database {
    let mut fonts = own();
    fonts.load_system_fonts();
    // The system's choice may be a family that it has not.
    chosen(&mut fonts);
    // Glyphs of these are pictures, which a line drawing has no use for.
    let coloured = fonts.faces().filter(|face| {
        let mut names = face.families.iter();
        names.any(|(name, _)| name.contains("Emoji"))
    });
    let coloured: Vec<_> = coloured.map(|face| face.id).collect();
    for face in coloured {
        fonts.remove_face(face);
    }
    fonts
}

/// Reads an SVG with fonts; gives the characters too that none of them has.
fn read(svg: &str, fonts: Database) -> Outcome<(Tree, BTreeSet<char>)> {
    let options = Options {
        fontdb: Arc::new(fonts),
        font_family: "sans-serif".to_owned(),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|error| failed(&error.to_string()))?;
    let mut missing = BTreeSet::new();
    undrawn(tree.root(), &mut missing);
    Ok((tree, missing))
}

/// Draws an SVG.
///
/// # Errors
/// A character is in no font, or the picture is too large.
pub fn png(svg: &str) -> Outcome<Image> {
    let (mut tree, mut missing) = read(svg, own())?;
    if !missing.is_empty() {
        (tree, missing) = read(svg, with_system())?;
    }
    if !missing.is_empty() {
        let more = if missing.len() > TOLD { "…" } else { "" };
        let missing: String = missing.into_iter().take(TOLD).collect();
        return Err(Failure::Usage(both!(
            "no font has `{missing}{more}`, neither this program's nor one of this machine: install one that has (Debian: \
             `fonts-noto-cjk` or `fonts-noto-core`), or write `.svg`",
            "程序自带字体和本机字体都没有 `{missing}{more}`：请安装含有这些字符的字体（Debian：`fonts-noto-cjk` 或 \
             `fonts-noto-core`），或输出 `.svg`"
        )));
    }
    let scale = f32::from(SCALE);
    // A part of a pixel at the edge is one.
    let side = |length: f32| (length * scale).ceil() as u32;
    let (width, height) = (side(tree.size().width()), side(tree.size().height()));
    let fits = width <= MOST && height <= MOST;
    let pixmap = fits.then(|| Pixmap::new(width, height)).flatten();
    let Some(mut pixmap) = pixmap else {
        return Err(Failure::Usage(both!(
            "the picture is too large for a `.png` ({MOST} pixels a side at most): write `.svg` or `.html`",
            "图太大，无法输出 `.png`（每边最多 {MOST} 像素）：请输出 `.svg` 或 `.html`"
        )));
    };
    // Where a picture has no paper of its own, it is read on white.
    pixmap.fill(Color::WHITE);
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut pixmap.as_mut(),
    );
    let png = pixmap
        .encode_png()
        .map_err(|error| failed(&error.to_string()))?;
    Ok(Image { png, width, height })
}

/// The characters of texts that no font has.
fn undrawn(group: &Group, missing: &mut BTreeSet<char>) {
    for node in group.children() {
        match node {
            Node::Group(group) => undrawn(group, missing),
            Node::Text(text) => {
                let spans = text.layouted().iter();
                let glyphs = spans.flat_map(|span| &span.positioned_glyphs);
                let none = glyphs.filter(|glyph| glyph.id.0 == 0);
                missing.extend(none.flat_map(|glyph| glyph.text.chars()));
            }
            Node::Path(_) | Node::Image(_) => {}
        }
    }
}

fn failed(why: &str) -> Failure {
    Failure::Usage(Both {
        en: format!("cannot draw the picture as `.png`: {why}; write `.svg`"),
        zh: format!("无法输出 `.png` 图片：{why}；请输出 `.svg`"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels of a picture.
    fn pixels(svg: &str) -> Pixmap {
        let image = png(svg).unwrap();
        let pixels = Pixmap::decode_png(&image.png).unwrap();
        assert_eq!(
            (pixels.width(), pixels.height()),
            (image.width, image.height)
        );
        pixels
    }

    fn drawn(words: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"120\" height=\"40.4\"><style>{}</style>\
             <rect class=\"paper\" width=\"120\" height=\"40.4\"/><text x=\"60\" y=\"30\" class=\"below\">{words}</text></svg>",
            include_str!("../plot/style.css")
        )
    }

    /// The columns with a pixel that is not paper.
    fn columns(pixels: &Pixmap) -> Vec<u32> {
        let (width, height) = (pixels.width(), pixels.height());
        let has_ink = |x: &u32| (0..height).any(|y| pixels.pixel(*x, y).unwrap().green() < 200);
        (0..width).filter(has_ink).collect()
    }

    #[test]
    fn a_picture_is_the_svg_twice_as_large_with_its_text_where_its_style_has_it() {
        let pixels = pixels(&drawn("1.75"));
        assert_eq!((pixels.width(), pixels.height()), (240, 81));
        // Light, whatever the screen prefers.
        assert_eq!(pixels.pixel(0, 0).unwrap().red(), 255);
        let inked = columns(&pixels);
        let (first, last) = (inked[0], *inked.last().unwrap());
        // Whatever the font, its middle is at the anchor, but for the bearings, and its size that of the style.
        assert!((first + last).abs_diff(240) < 10, "{first} {last}");
        assert!((30..90).contains(&(last - first)), "{first} {last}");
        let without = self::pixels(&drawn(" "));
        assert!(columns(&without).is_empty());
    }

    /// The texts of the program, of which any may stand in a picture.
    fn texts(folder: &std::path::Path, all: &mut BTreeSet<char>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let ending = path.extension().and_then(|ending| ending.to_str());
            if path.is_dir() {
                texts(&path, all);
            } else if matches!(ending, Some("rs" | "toml")) {
                all.extend(std::fs::read_to_string(&path).unwrap().chars());
            }
        }
    }

    #[test]
    fn the_fonts_of_our_own_have_every_character_of_our_texts() {
        let mut all = BTreeSet::new();
        for folder in ["src", "../common/src", "../core/src", "../params"] {
            texts(
                &std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(folder),
                &mut all,
            );
        }
        let is_special = |c: &char| c.is_control() || "<>&\u{feff}".contains(*c);
        let words: String = all.into_iter().filter(|c| !is_special(c)).collect();
        assert!(words.contains('螺') && words.contains('⌀') && words.contains('⚠'));
        for class in ["below", "name"] {
            let svg = drawn(&words).replace("below", class);
            let (_, missing) = read(&svg, own()).unwrap();
            assert!(
                missing.is_empty(),
                "{missing:?}: see gateway/src/pixels/fonts"
            );
        }
    }

    #[test]
    fn a_text_of_a_family_that_is_not_there_is_drawn() {
        let svg = drawn("1.75").replace("sans-serif", "Nowhere Grotesk");
        for fonts in [own(), with_system()] {
            let (tree, missing) = read(&svg, fonts).unwrap();
            assert!(missing.is_empty(), "{missing:?}");
            // Paper and text.
            assert!(tree.root().children().len() == 2);
        }
    }

    #[test]
    fn with_a_character_of_no_font_there_is_no_picture() {
        // A character that is none, and will never be.
        let Failure::Usage(why) = png(&drawn("1\u{fdd0}")).unwrap_err() else {
            panic!("another failure");
        };
        assert!(why.en.contains("has `\u{fdd0}`,"), "{}", why.en);
    }

    #[test]
    fn a_picture_that_is_not_opened_everywhere_is_refused() {
        let tall = drawn("1").replace("40.4", "20000");
        let image = png(&tall);
        assert!(matches!(image, Err(Failure::Usage(why)) if why.en.contains("32767 pixels")));
    }
}
