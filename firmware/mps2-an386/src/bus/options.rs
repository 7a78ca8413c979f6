//! The options of the image: words of its command line, through semihosting.

use leadscrew_app::Failure;

/// The options.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// `traffic=all`: SYNC and the process data of the drives also go to the wire.
    pub traffic: bool,
    /// `provoke=panic@300`: the image fails in this way, if it has not failed before; with `*3` at the end, three times
    /// in a row.
    #[cfg(feature = "provoke")]
    pub provoke: Option<crate::provoke::Provoke>,
}

impl Options {
    /// Reads the options. An unknown word stops the image, because the image would not do what was asked.
    ///
    /// # Panics
    /// At an unknown word.
    pub fn read(failure: Option<&Failure>) -> Self {
        let mut options = Self::default();
        #[cfg(not(feature = "provoke"))]
        let _ = failure;
        for word in leadscrew_console::words(&mut [0; leadscrew_console::LONGEST]) {
            match word {
                "traffic=all" => options.traffic = true,
                #[cfg(feature = "provoke")]
                _ if word.starts_with("provoke=") => {
                    let how = word.trim_start_matches("provoke=");
                    let provoke = crate::provoke::Provoke::read(how).expect("a way to fail");
                    let failed = failure.map_or(0, |failure| failure.in_a_row);
                    options.provoke = Some(provoke).filter(|provoke| failed < provoke.times);
                }
                _ => panic!("`{word}` is no option of this image"),
            }
        }
        options
    }
}
