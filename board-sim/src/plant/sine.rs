//! Sine and cosine of a phase, in integers.

/// Binary places of the results of [`sin_cos`].
pub const PLACES: u32 = 48;

/// Binary places of the working values.
const WORK: u32 = 60;
/// One in working values.
const ONE: i64 = 1 << WORK;
/// 2π in working values.
const TAU: i64 = 7_244_019_458_077_122_842;

/// Sine and cosine of a phase in 2⁻⁶⁴ turns, in 2⁻⁴⁸; error below 2⁻⁴⁸.
pub fn sin_cos(phase: u64) -> (i64, i64) {
    // The nearest quarter turn, and the remainder: within ±1/8 turn.
    let quarter = phase.wrapping_add(1 << 61) >> 62;
    let rest = phase.wrapping_sub(quarter << 62) as i64;
    let x = ((rest as i128).wrapping_mul(TAU as i128) >> 64) as i64;
    let square = product(x, x);
    // Taylor series: the first omitted terms, x¹⁷/17! and x¹⁸/18!, are below 2⁻⁵³ for |x| ≤ π/4.
    let mut sine = ONE;
    for divisor in [210, 156, 110, 72, 42, 20, 6] {
        sine = ONE.wrapping_sub(divided(product(square, sine), divisor));
    }
    sine = product(x, sine);
    let mut cosine = ONE;
    for divisor in [240, 182, 132, 90, 56, 30, 12, 2] {
        cosine = ONE.wrapping_sub(divided(product(square, cosine), divisor));
    }
    let (sine, cosine) = match quarter {
        0 => (sine, cosine),
        1 => (cosine, sine.wrapping_neg()),
        2 => (sine.wrapping_neg(), cosine.wrapping_neg()),
        _ => (cosine.wrapping_neg(), sine),
    };
    (rounded(sine), rounded(cosine))
}

const fn product(a: i64, b: i64) -> i64 {
    ((a as i128).wrapping_mul(b as i128) >> WORK) as i64
}

const fn divided(value: i64, divisor: i64) -> i64 {
    match value.checked_div(divisor) {
        Some(quotient) => quotient,
        None => 0,
    }
}

const fn rounded(value: i64) -> i64 {
    const DROP: u32 = WORK.wrapping_sub(PLACES);
    value.wrapping_add(1 << DROP.wrapping_sub(1)) >> DROP
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn agrees_with_floating_point_all_round() {
        let one = (1u64 << PLACES) as f64;
        let mut phase = 0u64;
        for step in 0..20_000u64 {
            // The test includes the phases around every eighth of a turn.
            let p = match step {
                0..48 => ((step / 3) << 61).wrapping_add(step % 3).wrapping_sub(1),
                _ => phase,
            };
            let (sine, cosine) = sin_cos(p);
            let x = (p as i64) as f64 / 2f64.powi(64) * std::f64::consts::TAU;
            assert!((sine as f64 / one - x.sin()).abs() < 8e-15, "{p:016X}");
            assert!((cosine as f64 / one - x.cos()).abs() < 8e-15, "{p:016X}");
            phase = phase.wrapping_add(0x000D_3A5B_1234_5677);
        }
        assert_eq!(sin_cos(0), (0, 1 << PLACES));
        assert_eq!(sin_cos(1 << 62), (1 << PLACES, 0));
        assert_eq!(sin_cos(1 << 63), (0, -(1 << PLACES)));
    }
}
