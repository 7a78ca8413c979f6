//! What the image is told when it is started: words of its command line, through semihosting.

use cortex_m_semihosting::syscall1;
use leadscrew_app::Failure;

/// The options.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// `traffic=all`: SYNC and the process data of the drives are on the wire, too.
    pub traffic: bool,
    /// `provoke=panic@300`: the image fails like that, if it has not failed before;
    /// with `*3` behind it so many times in a row.
    #[cfg(feature = "provoke")]
    pub provoke: Option<crate::provoke::Provoke>,
}

/// The longest command line.
const LONGEST: usize = 256;

#[repr(C)]
struct Line {
    text: *mut u8,
    length: usize,
}

impl Options {
    /// Reads them. A word that is none stops the image: it would not do what it was asked.
    ///
    /// # Panics
    /// Then.
    pub fn read(failure: Option<&Failure>) -> Self {
        let mut buffer = [0_u8; LONGEST];
        let mut line = Line {
            text: buffer.as_mut_ptr(),
            length: buffer.len(),
        };
        // SAFETY: the host writes at most `length` bytes to `text`, both of which it finds in `line`.
        let failed = unsafe { syscall1!(GET_CMDLINE, &raw mut line) };
        let mut options = Self::default();
        #[cfg(not(feature = "provoke"))]
        let _ = failure;
        if failed != 0 {
            return options;
        }
        let bytes = buffer.split(|byte| *byte == 0).next().unwrap_or_default();
        let text = core::str::from_utf8(bytes).expect("a command line is text");
        // The first word is the image.
        for word in text.split_ascii_whitespace().skip(1) {
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
