//! Exact decimals as bytes: integers scaled by a power of ten, without exponent and without trailing zeros. Written by
//! hand because a move list is mostly numbers, and made of integers so that no digit is ever invented.

/// Appends `value` · 10^−`D`.
pub fn decimal<const D: u32>(out: &mut Vec<u8>, value: i64) {
    if value < 0 {
        out.push(b'-');
    }
    let magnitude = value.unsigned_abs();
    let scale = const { 10u64.pow(D) };
    integer(out, magnitude / scale);
    let mut fraction = magnitude % scale;
    if fraction == 0 {
        return;
    }
    out.push(b'.');
    let mut weight = scale / 10;
    while fraction != 0 {
        // A fraction below the scale has one digit at each weight.
        out.push(b'0' + (fraction / weight) as u8);
        fraction %= weight;
        weight /= 10;
    }
}

/// Appends a whole number.
pub fn integer(out: &mut Vec<u8>, mut value: u64) {
    let mut digits = [0u8; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[at..]);
}

/// Appends a signed whole number.
pub fn signed(out: &mut Vec<u8>, value: i64) {
    if value < 0 {
        out.push(b'-');
    }
    integer(out, value.unsigned_abs());
}

/// `value` · 10^−`D` as text.
pub fn text<const D: u32>(value: i64) -> String {
    let mut out = Vec::new();
    decimal::<D>(&mut out, value);
    out.into_iter().map(char::from).collect()
}

/// A measured value to at most four decimals (half away from zero), for people: a length in millimetres to 0.1 µm.
pub fn measured(value: f64) -> String {
    text::<4>((value * 1e4).round() as i64)
}

/// `value` · 10^−`D` as text, rounded to `keep` decimals (half away from zero), for people.
pub fn rounded<const D: u32>(value: i64, keep: u32) -> String {
    let step = 10i64.pow(D.saturating_sub(keep));
    let half = if value < 0 { -(step / 2) } else { step / 2 };
    text::<D>(value.saturating_add(half) / step * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_trailing_zeros_and_no_exponent() {
        let cases = [
            (0, "0"),
            (1, "0.000001"),
            (-1, "-0.000001"),
            (60_640_000, "60.64"),
            (-62_000_000, "-62"),
            (8_960_770, "8.96077"),
            (i64::MAX, "9223372036854.775807"),
            (i64::MIN, "-9223372036854.775808"),
        ];
        for (value, expected) in cases {
            assert_eq!(text::<6>(value), expected);
        }
        assert_eq!(text::<0>(-17), "-17");
    }

    #[test]
    fn rounding_is_half_away_from_zero() {
        assert_eq!(rounded::<6>(1_234_500, 3), "1.235");
        assert_eq!(rounded::<6>(-1_234_500, 3), "-1.235");
        assert_eq!(rounded::<6>(1_000_400, 3), "1");
    }
}
