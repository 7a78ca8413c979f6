//! The one list of alarms and warnings: number, cause and remedy in English and Chinese.

/// Defines [`Code`]. A template may use `{0}`…`{3}` for the figures and `{w}` for the word's letter.
macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $number:literal, $cause:literal, $help:literal, $zh:literal, $zh_help:literal;)*) => {
        /// Every alarm and warning. Numbers up to 999 are those GSK and FANUC users know; 4000–4899 are alarms of our
        /// own, 4900–4999 warnings.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u16)]
        #[non_exhaustive]
        pub enum Code {
            $($(#[$doc])* $name = $number,)*
        }

        impl Code {
            /// All of them, in the order of the table.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// The number shown to the user.
            #[must_use]
            pub const fn number(self) -> u16 {
                self as u16
            }

            /// Cause, as a template.
            #[must_use]
            pub const fn cause(self, lang: Lang) -> &'static str {
                match (self, lang) {
                    $((Self::$name, Lang::En) => $cause, (Self::$name, Lang::Zh) => $zh,)*
                }
            }

            /// What to change, as a template.
            #[must_use]
            pub const fn help(self, lang: Lang) -> &'static str {
                match (self, lang) {
                    $((Self::$name, Lang::En) => $help, (Self::$name, Lang::Zh) => $zh_help,)*
                }
            }
        }
    };
}

/// Language of the texts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lang {
    /// English.
    #[default]
    En,
    /// Chinese.
    Zh,
}

impl Code {
    /// True for a condition that is reported and does not stop anything.
    #[must_use]
    pub const fn is_warning(self) -> bool {
        self.number() >= 4900
    }
}

codes! {

    // -- 02xx–03xx: the trade's own numbers -------------------------------------------------------------------------
    /// F or I of a thread missing, zero, negative or out of range.
    LeadMissing = 313, "the thread has no lead", "write F (lead per turn) or I (turns per inch) in a thread block",
        "螺纹没有导程", "请在螺纹程序段中写 F（每转导程）或 I（每英寸牙数）";

    // -- 4001–4099 text and words: program/ -------------------------------------------------------------------------
    /// A character that starts no word, comment or block.
    UnknownCharacter = 4001, "this character has no meaning here", "write a word: a letter and a number",
        "此处的字符没有意义", "请写一个字：字母加数字";

    // -- 4100–4199 geometry of cycles: cycle/ -----------------------------------------------------------------------

    // -- 4200–4299 physics: feasible/, motion/, spindle/ -------------------------------------------------------------

    // -- 4300–4399 machine: board/, bus/ -----------------------------------------------------------------------------

    // -- 4400–4499 parameters: params/ -------------------------------------------------------------------------------

    // -- 4900–4919 warnings: program/ --------------------------------------------------------------------------------

    // -- 4920–4939 warnings: cycle/ ----------------------------------------------------------------------------------

    // -- 4940–4959 warnings: feasible/, motion/, spindle/ --------------------------------------------------------------

    // -- 4960–4979 warnings: params/, board/ ---------------------------------------------------------------------------
}
