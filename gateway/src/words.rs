//! Words for people in both languages, side by side so that neither is forgotten.

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

    /// What is the same in both.
    pub fn same(text: impl Into<String>) -> Self {
        let en = text.into();
        Self { zh: en.clone(), en }
    }
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
macro_rules! both {
    ($en:literal, $zh:literal $(,)?) => {
        $crate::words::Both { en: format!($en), zh: format!($zh) }
    };
    ($en:literal, $zh:literal $(, $name:ident = $value:expr)+ $(,)?) => {
        // A match keeps temporaries alive until both texts are made.
        match ($(&$value,)+) {
            #[allow(unused_variables, reason = "a figure may be meant for one language")]
            ($($name,)+) => $crate::words::Both { en: format!($en), zh: format!($zh) },
        }
    };
}
pub(crate) use both;

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
}
