//! Tangent of half the thread angle, and the fixed point in which slopes are multiplied by depths.
//!
//! A cutting point is one closed expression of a depth, rounded once. So slopes carry far more bits than a nanometre
//! needs: the tangent 63 fractional bits, products with a taper 80. Knows nothing of passes or moves.

use crate::units::product;

/// `tan(a/2)` for one whole-degree thread angle, with 63 fractional bits (an error below 2⁻⁶⁴, that is 6·10⁻¹⁸ of the
/// smallest angle's tangent).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct HalfAngle(u64);

/// Fractional bits of taper products.
pub(crate) const FINE_BITS: u32 = 80;

/// A non-negative length in nanometres with [`FINE_BITS`] fractional bits, or a slope with as many. The products in this
/// module stay below 2¹²⁷ for inputs within [`Length::INPUT_LIMIT`](crate::units::Length::INPUT_LIMIT).
pub(crate) type Fine = u128;

/// The product of a slope and a distance.
pub(crate) const fn after(way: u64, slope: Fine) -> Fine {
    (way as Fine).wrapping_mul(slope)
}

/// Half a nanometre.
pub(crate) const FINE_HALF: Fine = 1 << (FINE_BITS - 1);

impl HalfAngle {
    /// The tangent of half of `degrees`; `None` above 99.
    pub(crate) fn of(degrees: u8) -> Option<Self> {
        TAN_HALF.get(degrees as usize).copied().map(Self)
    }

    /// `depth · tan(a/2)` to the nearest nanometre, halves up. `depth` < 2⁶³.
    #[inline]
    pub(crate) const fn shift(self, depth: u64) -> u64 {
        let wide = product(depth, self.0);
        (wide.wrapping_add(1 << 62) >> 63) as u64
    }

    /// The tangent as a fine slope.
    pub(crate) const fn fine(self) -> Fine {
        (self.0 as Fine) << (FINE_BITS - 63)
    }
}

/// `round(2⁶³ · tan(a/2))`, a = 0…99 degrees.
const TAN_HALF: [u64; 100] = [
    0x0000_0000_0000_0000,
    0x011D_F645_E100_66F0,
    0x023B_F7B2_8214_8443,
    0x035A_0F6E_60AC_FA4B,
    0x0478_48A5_7587_F083,
    0x0596_AE88_F3C9_5B60,
    0x06B5_4C51_09CF_9C88,
    0x07D4_2D3E_A45A_227E,
    0x08F3_5C9D_3499_01FC,
    0x0A12_E5C4_79BE_2D51,
    0x0B32_D41A_4EAA_F070,
    0x0C53_3314_7C56_B526,
    0x0D74_0E3A_918E_CBB1,
    0x0E95_7127_C0B2_0B7D,
    0x0FB7_678C_C40E_98B5,
    0x10D9_FD31_C98B_F8B7,
    0x11FD_3DF8_664F_E4BF,
    0x1321_35DD_9310_FB4A,
    0x1445_F0FB_B1CF_91B5,
    0x156B_7B8C_9DB2_7D79,
    0x1691_E1EB_C5CB_BBEE,
    0x17B9_3098_538F_6E96,
    0x18E1_7437_5DCE_B646,
    0x1A0A_B996_290F_983D,
    0x1B35_0DAC_7623_4BF8,
    0x1C60_7D9E_DFE5_1FAF,
    0x1D8D_16C1_4915_93DA,
    0x1EBA_E699_5B4F_6D6B,
    0x1FE9_FAE1_181F_543E,
    0x211A_6189_7D52_2A50,
    0x224C_28BD_3D9A_AC62,
    0x237F_5EE3_8EBC_29AE,
    0x24B4_12A3_0E76_448E,
    0x25EA_52E4_BF7C_C70F,
    0x2722_2ED7_1FD6_B4B5,
    0x285B_B5F1_5A10_F6DE,
    0x2996_F7F6_92C3_5D78,
    0x2AD4_04F9_53FA_461B,
    0x2C12_ED5F_182C_250A,
    0x2D53_C1E3_F678_7D5D,
    0x2E96_939E_7205_A8B7,
    0x2FDB_7403_6E6C_3DBB,
    0x3122_74EA_4B3A_0CCD,
    0x326B_A891_28B3_AB41,
    0x33B7_21A1_581A_80A3,
    0x3504_F333_F9DE_6484,
    0x3655_30D6_CC45_3D88,
    0x37A7_EE91_2D38_E732,
    0x38FD_40E9_5214_1A5C,
    0x3A55_3CE9_B872_5EC3,
    0x3BAF_F826_D335_6258,
    0x3D0D_88C4_F723_B03F,
    0x3E6E_057E_8AB9_E789,
    0x3FD1_85AA_7D00_867C,
    0x4138_2143_0775_7090,
    0x42A1_F0EC_BF59_D5ED,
    0x440F_0DFD_FAFB_6F2E,
    0x457F_9286_8FDB_7A39,
    0x46F3_9957_EEE6_F98B,
    0x486B_3E0D_A44A_DCDF,
    0x49E6_9D16_40CC_7135,
    0x4B65_D3BC_B2F3_4C21,
    0x4CE9_0032_16BE_7525,
    0x4E70_4198_0313_800A,
    0x4FFB_B80B_5C94_55A6,
    0x518B_84AF_B610_5750,
    0x531F_C9BB_4758_3A4D,
    0x54B8_AA83_83DA_5F93,
    0x5656_4B8A_5B18_940C,
    0x57F8_D28C_2DC1_3497,
    0x59A0_668E_82FD_EA6C,
    0x5B4D_2FEF_8A62_FBDA,
    0x5CFF_5876_77D5_0B85,
    0x5EB7_0B64_C7B9_C4F8,
    0x6074_7588_7ADC_3EB6,
    0x6237_C54F_5A99_D6E9,
    0x6401_2ADB_5732_47DB,
    0x65D0_D818_1378_29D6,
    0x67A7_00D1_B2A0_DC71,
    0x6983_DACC_FE96_FA27,
    0x6B67_9DE0_FEFC_771C,
    0x6D52_8412_1AFD_3130,
    0x6F44_C9AE_E234_4399,
    0x713E_AD6E_9B3A_9ECB,
    0x7340_7091_B901_7C68,
    0x754A_5704_5AE5_28A4,
    0x775C_A782_FE72_D9E6,
    0x7977_ABC1_8D36_45E1,
    0x7B9B_B094_F491_8BFD,
    0x7DC9_061F_79AD_20D9,
    0x8000_0000_0000_0000,
    0x8240_F584_7DD6_295F,
    0x848C_41DF_DFA1_6D04,
    0x86E2_4463_A0D5_7EF2,
    0x8943_60BD_67A4_DDDF,
    0x8BAF_FF38_F83B_0984,
    0x8E28_8D06_DC1F_13C9,
    0x90AD_7C88_2357_D036,
    0x933F_459F_AED4_0D16,
    0x95DE_6609_7E9C_549B,
];

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn the_table_is_the_tangent() {
        for (a, &t) in TAN_HALF.iter().enumerate() {
            let want = (a as f64 / 2.0).to_radians().tan();
            let got = t as f64 / (1u64 << 63) as f64;
            assert!((got - want).abs() <= 4e-16 * want, "{a}: {got} {want}");
        }
    }

    /// The addition theorem ties every entry to the first, and tan 45° = 1 ties the first: no entry can be off by more
    /// than a few units of the 63rd bit.
    #[test]
    fn the_table_obeys_the_addition_theorem() {
        let one = 1u128 << 63;
        assert_eq!(TAN_HALF[0], 0);
        assert_eq!(u128::from(TAN_HALF[90]), one);
        let first = u128::from(TAN_HALF[1]);
        for pair in TAN_HALF.windows(2) {
            let (t, next) = (u128::from(pair[0]), u128::from(pair[1]));
            // (t + t₁) / (1 − t·t₁), both sides with 63 bits.
            let below = one - ((t * first) >> 63);
            let sum = ((t + first) << 63) / below;
            assert!(sum.abs_diff(next) <= 4, "{sum} {next}");
        }
        // Entries of complementary angles are reciprocals.
        for a in 81..=99usize {
            let product = u128::from(TAN_HALF[a]) * u128::from(TAN_HALF[180 - a]);
            assert!(product.abs_diff(one * one) <= one * 2, "{a}");
        }
    }

    #[test]
    fn a_shift_is_rounded_once() {
        let sixty = HalfAngle::of(60).unwrap();
        assert_eq!(sixty.shift(1_800_000), 1_039_230);
        assert_eq!(sixty.shift(3_680_000), 2_124_649);
        assert_eq!(HalfAngle::of(0).unwrap().shift(1 << 43), 0);
        assert_eq!(HalfAngle::of(90).unwrap().shift(1 << 43), 1 << 43);
        assert_eq!(HalfAngle::of(100), None);
    }
}
