//! The options of the image: words of its command line, through semihosting.

use leadscrew_app::Failure;
use leadscrew_core::call::Position;
use leadscrew_core::units::Length;

/// The options.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// `traffic=all`: SYNC and the process data of the drives also go to the wire.
    pub traffic: bool,
    /// `time=real`: a tick at each of its times, as on a machine, instead of virtual time.
    pub real: bool,
    /// `x=-80`, `z=-150`: where the slides stand when the power comes, in whole millimetres of the machine, X a diameter.
    pub at: Position,
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
                "time=real" => options.real = true,
                _ if word.starts_with("x=") => options.at.x = millimetres(word, 2),
                _ if word.starts_with("z=") => options.at.z = millimetres(word, 1),
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

/// The place in `x=-80`, which is so many times that of the slide.
fn millimetres(word: &str, times: i64) -> Length {
    let place: i32 = word[2..].parse().expect("whole millimetres");
    Length::from_nm(i64::from(place) * 1_000_000 / times)
}
