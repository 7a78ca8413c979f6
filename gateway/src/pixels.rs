//! A picture of ours as pixels: SVG in, PNG out, with the fonts of the system. A picture is whole or refused: text that
//! no font can draw is never left out. Must not know what a picture shows.

use std::collections::BTreeSet;
use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Family, Query};
use resvg::usvg::{Group, Node, Options, Tree};

use crate::failure::{Failure, Outcome};
use crate::words::{Both, both};

/// Pixels for each of the SVG: sharp on a dense screen, and 200 dpi on a page of A4 across.
pub const SCALE: u16 = 2;
/// The most pixels of a side: more is not opened everywhere.
const MOST: u32 = 32_767;
/// The most missing characters that are told.
const TOLD: usize = 12;
/// What stands for `sans-serif` where the system's choice is not there.
const FAMILIES: [&str; 6] = [
    "Noto Sans",
    "DejaVu Sans",
    "Liberation Sans",
    "Arial",
    "Helvetica",
    "FreeSans",
];

/// The fonts that texts are drawn with.
#[derive(Clone, Debug)]
pub struct Fonts(Arc<Database>);

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

impl Fonts {
    /// Those of the system.
    ///
    /// # Errors
    /// There are none.
    pub fn of_system() -> Outcome<Self> {
        let mut fonts = Database::new();
        fonts.load_system_fonts();
        Self::of(fonts)
    }

    fn of(mut fonts: Database) -> Outcome<Self> {
        // Glyphs of these are pictures, which a line drawing has no use for.
        let coloured = fonts.faces().filter(|face| {
            let mut names = face.families.iter();
            names.any(|(name, _)| name.contains("Emoji"))
        });
        let coloured: Vec<_> = coloured.map(|face| face.id).collect();
        for face in coloured {
            fonts.remove_face(face);
        }
        let Some(first) = fonts.faces().next() else {
            return Err(Failure::Usage(both!(
                "this machine has no font to draw text with: install one (Debian: `fonts-dejavu-core`, for Chinese \
                 `fonts-noto-cjk`), or write `.svg`",
                "本机没有可用字体：请安装字体（Debian：`fonts-dejavu-core`，中文用 `fonts-noto-cjk`），或输出 `.svg`"
            )));
        };
        let is_there = |family: Family| {
            let families = &[family];
            fonts
                .query(&Query {
                    families,
                    ..Query::default()
                })
                .is_some()
        };
        if !is_there(Family::SansSerif) {
            let mut known = FAMILIES.into_iter();
            let known = known.find(|name| is_there(Family::Name(name)));
            let any = || first.families.first().map_or("", |family| &family.0);
            let name = known.unwrap_or_else(any).to_owned();
            fonts.set_sans_serif_family(name);
        }
        Ok(Self(Arc::new(fonts)))
    }
}

/// Draws an SVG.
///
/// # Errors
/// A character is in no font, or the picture is too large.
pub fn png(svg: &str, fonts: &Fonts) -> Outcome<Image> {
    let options = Options {
        fontdb: Arc::clone(&fonts.0),
        font_family: "sans-serif".to_owned(),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|error| failed(&error.to_string()))?;
    let mut missing = BTreeSet::new();
    undrawn(tree.root(), &mut missing);
    if !missing.is_empty() {
        let more = if missing.len() > TOLD { "…" } else { "" };
        let missing: String = missing.into_iter().take(TOLD).collect();
        return Err(Failure::Usage(both!(
            "no font of this machine has `{missing}{more}`: install one that has (Debian: `fonts-dejavu-core`, for Chinese \
             `fonts-noto-cjk`), or write `.svg`",
            "本机字体缺少 `{missing}{more}`：请安装含有这些字符的字体（Debian：`fonts-dejavu-core`，中文用 `fonts-noto-cjk`），\
             或输出 `.svg`"
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
        let image = png(svg, &Fonts::of_system().unwrap()).unwrap();
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
            include_str!("plot/style.css")
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

    #[test]
    fn without_a_font_or_with_a_character_of_none_there_is_no_picture() {
        let Failure::Usage(why) = Fonts::of(Database::new()).unwrap_err() else {
            panic!("another failure");
        };
        assert!(why.en.contains("no font") && why.en.contains("`fonts-dejavu-core`"));
        // A character that is none, and will never be.
        let image = png(&drawn("1\u{fdd0}"), &Fonts::of_system().unwrap());
        let Failure::Usage(why) = image.unwrap_err() else {
            panic!("another failure");
        };
        assert!(why.en.contains("has `\u{fdd0}`"), "{}", why.en);
    }

    #[test]
    fn a_picture_that_is_not_opened_everywhere_is_refused() {
        let tall = drawn("1").replace("40.4", "20000");
        let image = png(&tall, &Fonts::of_system().unwrap());
        assert!(matches!(image, Err(Failure::Usage(why)) if why.en.contains("32767 pixels")));
    }
}
