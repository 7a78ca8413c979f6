//! Words for people in both languages, next to each other so that neither is forgotten.

use std::path::Path;

use leadscrew_core::alarm::Lang;

/// The same words in English and Chinese.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Both {
    /// English.
    pub en: String,
    /// Chinese.
    pub zh: String,
}

impl Both {
    /// The words in a language.
    #[must_use]
    pub fn get(&self, lang: Lang) -> &str {
        match lang {
            Lang::En => &self.en,
            Lang::Zh => &self.zh,
        }
    }

    /// The same text in both languages.
    pub fn same(text: impl Into<String>) -> Self {
        let en = text.into();
        Self { zh: en.clone(), en }
    }
}

/// True for a character that takes two places on a terminal: those of East Asia, of which our texts use none below U+2E80.
#[must_use]
pub const fn is_wide(c: char) -> bool {
    c >= '\u{2e80}'
}

/// True for a character that a terminal obeys instead of showing it: control characters, and those that change the
/// direction of writing.
#[must_use]
pub fn is_obeyed(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}')
}

/// The text with every such character written out (`\u{1b}`); line feeds and tabs stay.
#[must_use]
pub fn plain(text: String) -> String {
    let obeyed = |c: char| is_obeyed(c) && !matches!(c, '\n' | '\t');
    if text.contains(obeyed) {
        written_out(&text, obeyed)
    } else {
        text
    }
}

/// The same for a text that must stay on one line, such as a name.
#[must_use]
pub fn one_line(text: &str) -> String {
    written_out(text, is_obeyed)
}

/// The name of a file as a message shows it.
#[must_use]
pub fn path(path: &Path) -> String {
    one_line(&path.display().to_string())
}

fn written_out(text: &str, which: impl Fn(char) -> bool) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if which(c) {
            out.extend(c.escape_default());
        } else {
            out.push(c);
        }
    }
    out
}

/// One of two constants.
#[must_use]
pub const fn pick(lang: Lang, en: &'static str, zh: &'static str) -> &'static str {
    match lang {
        Lang::En => en,
        Lang::Zh => zh,
    }
}

/// Both texts from one set of figures: `both!("cannot read `{path}`", "无法读取 `{path}`")`. Named figures may follow; a
/// figure that is itself words can be given in each language.
#[macro_export]
macro_rules! both {
    ($en:literal, $zh:literal $(,)?) => {
        $crate::words::Both {
            en: $crate::words::plain(format!($en)),
            zh: $crate::words::plain(format!($zh)),
        }
    };
    ($en:literal, $zh:literal $(, $name:ident = $value:expr)+ $(,)?) => {
        // In a match, temporaries live until both texts are made.
        match ($(&$value,)+) {
            #[allow(unused_variables, reason = "a figure may be meant for one language")]
            ($($name,)+) => $crate::words::Both {
                en: $crate::words::plain(format!($en)),
                zh: $crate::words::plain(format!($zh)),
            },
        }
    };
}
pub use crate::both;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_go_into_both() {
        let n = 3;
        let words = both!("{n} moves of {what}", "{what} 的 {n} 段移动", what = "O1");
        assert_eq!(words.get(Lang::En), "3 moves of O1");
        assert_eq!(words.get(Lang::Zh), "O1 的 3 段移动");
        assert_eq!(pick(Lang::Zh, "a", "b"), "b");
    }

    #[test]
    fn what_a_terminal_would_obey_is_written_out() {
        let name = "a\u{1b}[31m\u{9b}\u{202e}\r\n\t车";
        let told = "a\\u{1b}[31m\\u{9b}\\u{202e}\\r";
        assert_eq!(both!("{name}", "{name}").en, format!("{told}\n\t车"));
        assert_eq!(both!("{n}", "{n}", n = name).zh, format!("{told}\n\t车"));
        assert_eq!(one_line(name), format!("{told}\\n\\t车"));
        assert_eq!(path(Path::new("a b/车.nc")), "a b/车.nc");
    }
}
