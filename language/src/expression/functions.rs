//! The functions of macro B on numbers. Angles are degrees.

use leadscrew_core::alarm::Code;

/// A function with its name in brackets after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sqrt,
    Abs,
    Bin,
    Bcd,
    Round,
    Fix,
    Fup,
    Ln,
    Exp,
    Pow,
}

const NAMES: [(&str, Function); 16] = [
    ("SIN", Function::Sin),
    ("COS", Function::Cos),
    ("TAN", Function::Tan),
    ("ASIN", Function::Asin),
    ("ACOS", Function::Acos),
    ("ATAN", Function::Atan),
    ("SQRT", Function::Sqrt),
    ("ABS", Function::Abs),
    ("BIN", Function::Bin),
    ("BCD", Function::Bcd),
    ("ROUND", Function::Round),
    ("FIX", Function::Fix),
    ("FUP", Function::Fup),
    ("LN", Function::Ln),
    ("EXP", Function::Exp),
    ("POW", Function::Pow),
];

/// The largest number that BCD writes: eight digits.
const BCD_MOST: f64 = 99_999_999.0;

impl Function {
    /// The function of this name, in capitals.
    pub fn named(name: &[u8]) -> Option<Self> {
        let found = NAMES.iter().find(|(known, _)| known.as_bytes() == name);
        found.map(|(_, function)| *function)
    }

    /// True where a second argument may stand after a comma.
    pub const fn takes_two(self) -> bool {
        matches!(self, Self::Atan | Self::Pow)
    }

    /// Its result; ROUND keeps so many decimals.
    pub fn apply(self, a: f64, second: Option<f64>, decimals: u8) -> Result<f64, Code> {
        Ok(match (self, second) {
            (Self::Sin, _) => sine(a),
            (Self::Cos, _) => cosine(a),
            (Self::Tan, _) => return tangent(a),
            (Self::Asin, _) if libm::fabs(a) <= 1.0 => libm::asin(a).to_degrees(),
            (Self::Acos, _) if libm::fabs(a) <= 1.0 => libm::acos(a).to_degrees(),
            (Self::Atan, None) => libm::atan(a).to_degrees(),
            (Self::Atan, Some(b)) if a != 0.0 || b != 0.0 => {
                let angle = libm::atan2(a, b).to_degrees();
                if angle < 0.0 { angle + 360.0 } else { angle }
            }
            (Self::Sqrt, _) if a >= 0.0 => libm::sqrt(a),
            (Self::Abs, _) => libm::fabs(a),
            (Self::Bin, _) => return from_bcd(a),
            (Self::Bcd, _) => return to_bcd(a),
            (Self::Round, _) => rounded(a, decimals),
            (Self::Fix, _) => libm::trunc(a),
            (Self::Fup, _) if a < 0.0 => libm::floor(a),
            (Self::Fup, _) => libm::ceil(a),
            (Self::Ln, _) if a > 0.0 => libm::log(a),
            (Self::Exp, _) => libm::exp(a),
            (Self::Pow, Some(b)) => {
                let power = libm::pow(a, b);
                if power.is_nan() {
                    return Err(Code::FunctionArgument);
                }
                power
            }
            (Self::Pow, None) => return Err(Code::Formula),
            _ => return Err(Code::FunctionArgument),
        })
    }
}

/// `a` with so many decimals, halves away from zero.
fn rounded(a: f64, decimals: u8) -> f64 {
    let steps = libm::pow(10.0, f64::from(decimals));
    let count = a * steps;
    if count.is_finite() {
        libm::round(count) / steps
    } else {
        a
    }
}

/// The quarter turn next to an angle (0 … 3), and the rest in degrees, 45 at most.
fn quarter(degrees: f64) -> (u8, f64) {
    let within = libm::fmod(degrees, 360.0);
    let quarters = libm::round(within / 90.0);
    // −4 … 4.
    let which = ((quarters as i8) & 3).cast_unsigned();
    (which, within - 90.0 * quarters)
}

/// The sine of −45° … 45°; that of 30° is exactly one half.
fn small_sine(degrees: f64) -> f64 {
    if libm::fabs(degrees) == 30.0 {
        return libm::copysign(0.5, degrees);
    }
    libm::sin(degrees.to_radians())
}

fn small_cosine(degrees: f64) -> f64 {
    libm::cos(degrees.to_radians())
}

/// The sine of an angle in degrees; exact where it is 0, ½ or 1.
pub fn sine(degrees: f64) -> f64 {
    match quarter(degrees) {
        (0, rest) => small_sine(rest),
        (1, rest) => small_cosine(rest),
        (2, rest) => -small_sine(rest),
        (_, rest) => -small_cosine(rest),
    }
}

/// The cosine of an angle in degrees; exact where it is 0, ½ or 1.
pub fn cosine(degrees: f64) -> f64 {
    match quarter(degrees) {
        (0, rest) => small_cosine(rest),
        (1, rest) => -small_sine(rest),
        (2, rest) => -small_cosine(rest),
        (_, rest) => small_sine(rest),
    }
}

/// The tangent of an angle in degrees; exact where it is 0 or 1.
fn tangent(degrees: f64) -> Result<f64, Code> {
    let (which, rest) = quarter(degrees);
    let small = if libm::fabs(rest) == 45.0 {
        libm::copysign(1.0, rest)
    } else {
        libm::tan(rest.to_radians())
    };
    match which {
        0 | 2 => Ok(small),
        _ if small == 0.0 => Err(Code::DivisionByZero),
        _ => Ok(-1.0 / small),
    }
}

/// MOD: both are rounded to whole numbers first; the sign is that of `a`.
pub fn remainder(a: f64, b: f64) -> Result<f64, Code> {
    let divisor = libm::round(b);
    if divisor == 0.0 {
        return Err(Code::DivisionByZero);
    }
    Ok(libm::fmod(libm::round(a), divisor))
}

/// An operation on the bits of two whole numbers.
pub fn bits(a: f64, b: f64, operation: fn(i32, i32) -> i32) -> Result<f64, Code> {
    let whole = |number: f64| {
        let whole = libm::round(number);
        let fits = whole >= f64::from(i32::MIN) && whole <= f64::from(i32::MAX);
        fits.then_some(whole as i32).ok_or(Code::FunctionArgument)
    };
    Ok(f64::from(operation(whole(a)?, whole(b)?)))
}

/// The number whose decimal digits are the hexadecimal digits of `a`.
pub fn from_bcd(a: f64) -> Result<f64, Code> {
    let whole = libm::round(a);
    if !(0.0..=f64::from(u32::MAX)).contains(&whole) {
        return Err(Code::FunctionArgument);
    }
    let mut number = 0;
    for shift in (0..8).rev() {
        let digit = (whole as u32) >> (4 * shift) & 0xF;
        if digit > 9 {
            return Err(Code::FunctionArgument);
        }
        number = number * 10 + digit;
    }
    Ok(f64::from(number))
}

/// The number whose hexadecimal digits are the decimal digits of `a`.
pub fn to_bcd(a: f64) -> Result<f64, Code> {
    let whole = libm::round(a);
    if !(0.0..=BCD_MOST).contains(&whole) {
        return Err(Code::FunctionArgument);
    }
    let (mut rest, mut number) = (whole as u32, 0);
    for place in 0..8 {
        number |= (rest % 10) << (4 * place);
        rest /= 10;
    }
    Ok(f64::from(number))
}
