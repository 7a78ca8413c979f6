//! J and K of a thread after the rules for what is left out ([G76 sheet] notes 1–4).

use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::RunOut;
use crate::units::{Lead, Length, Remainder};

/// J and K in force, shared by G32, G78 and G92: kept as words, because what they leave out follows each thread's own lead.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptRunOut {
    /// J: with its sign from G32, without a sign from the others.
    short: Option<At<Length>>,
    long: Option<At<Length>>,
    /// J was written in a stroke of G32: its sign says where the tool goes.
    directed: bool,
}

impl KeptRunOut {
    pub(super) const NONE: Self = Self {
        short: None,
        long: None,
        directed: false,
    };

    /// The words of a G78 or G92. Both take the place of what is in force, also where one of them is missing.
    pub(super) const fn write(&mut self, short: Option<At<Length>>, long: Option<At<Length>>) {
        if short.is_some() || long.is_some() {
            *self = Self {
                short,
                long,
                directed: false,
            };
        }
    }

    /// The words of a G32. J alone ends a K in force, for K is then as long as J; K alone leaves J in force [D260].
    pub(super) const fn write_directed(
        &mut self,
        short: Option<At<Length>>,
        long: Option<At<Length>>,
    ) {
        if short.is_some() {
            *self = Self {
                short,
                long,
                directed: true,
            };
        } else if long.is_some() {
            self.long = long;
        }
    }

    /// J as a magnitude, and K, for a cycle that knows where A is.
    pub(super) fn sizes(&self) -> (Option<At<Length>>, Option<At<Length>>) {
        let size = |j: At<Length>| At::new(j.value.abs(), j.span);
        (self.short.map(size), self.long)
    }

    /// The run-out of a stroke at `span`: none without J. K is as long as J where it is zero or missing.
    ///
    /// # Errors
    /// J is that of a G78 or G92, whose sign a stroke cannot know.
    pub(super) fn of_stroke(&self, span: Span) -> Result<Option<RunOut>, Alarm> {
        let Some(short) = self.short.filter(|j| j.value != Length::ZERO) else {
            return Ok(None);
        };
        if !self.directed {
            let figure = [Arg::Length(short.value)];
            return Err(Alarm::new(Code::RunOutWithoutSide, span).with(figure));
        }
        let long = self.long.filter(|k| k.value != Length::ZERO);
        let long = long.unwrap_or(At::new(short.value.abs(), short.span));
        Ok(Some(exact(short, long)))
    }
}

/// The source of a run-out that its words leave open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chamfer {
    /// Length in tenths of the lead: P(r), 019, 5130.
    pub(super) tenths: At<u8>,
    /// Angle in degrees, 1…89 (45: as long as high).
    pub(super) degrees: u8,
}

impl Chamfer {
    /// The run-out for the words J and K: `None` for a thread without one.
    pub(super) fn resolve(
        &self,
        j: Option<At<Length>>,
        k: Option<At<Length>>,
        lead: Lead,
    ) -> Option<RunOut> {
        let short = match j {
            Some(j) if j.value == Length::ZERO => return None,
            j => j,
        };
        let long = k.filter(|k| k.value != Length::ZERO);
        if let (Some(short), Some(long)) = (short, long) {
            return Some(exact(short, long));
        }
        if let Some(j) = short {
            return Some(exact(j, j));
        }
        if self.tenths.value == 0 {
            return None;
        }
        let span = self.tenths.span;
        let (j, short_rest) = self.length(lead, tangent(self.degrees));
        let short = At::new(j, span);
        Some(match long {
            Some(long) => RunOut {
                short_rest,
                ..exact(short, long)
            },
            None => {
                let (k, long_rest) = self.length(lead, ONE);
                RunOut {
                    short,
                    long: At::new(k, span),
                    short_rest,
                    long_rest,
                }
            }
        })
    }

    /// `tenths · 0.1 · lead · tangent`, to the nearest nanometre, and the remainder of this rounding.
    fn length(&self, lead: Lead, tangent: i64) -> (Length, Remainder) {
        // Far below 2¹²⁷: 2⁷ tenths, a lead of 2⁶³, a tangent of 2⁴⁶.
        let above = i128::from(self.tenths.value)
            .wrapping_mul(i128::from(lead.numerator()))
            .wrapping_mul(i128::from(tangent));
        let below = i128::from(lead.denominator()).wrapping_mul(10);
        let fine = above
            .checked_div(below)
            .map(|fine| fine >> (ONE.trailing_zeros().wrapping_sub(Remainder::BITS)));
        let Some(fine) = fine.filter(|fine| *fine < 1 << 80) else {
            return (Length::from_nm(i64::MAX), Remainder::ZERO);
        };
        let nm = fine.wrapping_add(1 << (Remainder::BITS - 1)) >> Remainder::BITS;
        let rest = fine.wrapping_sub(nm << Remainder::BITS);
        (Length::from_nm(nm as i64), Remainder::from_raw(rest as i16))
    }
}

/// The run-out of two written lengths.
const fn exact(short: At<Length>, long: At<Length>) -> RunOut {
    RunOut {
        short,
        long,
        short_rest: Remainder::ZERO,
        long_rest: Remainder::ZERO,
    }
}

/// 1 in the units of [`TANGENTS`].
const ONE: i64 = 1 << 40;

fn tangent(degrees: u8) -> i64 {
    TANGENTS.get(usize::from(degrees)).copied().unwrap_or(ONE)
}

/// tan 0°…89° · 2⁴⁰, rounded to the nearest.
const TANGENTS: [i64; 90] = [
    0,
    19_192_046_852,
    38_395_792_107,
    57_622_962_708,
    76_885_342_825,
    96_194_802_845,
    115_563_328_803,
    135_003_052_424,
    154_526_281_933,
    174_145_533_796,
    193_873_565_580,
    213_723_410_108,
    233_708_411_116,
    253_842_260_626,
    274_139_038_256,
    294_613_252_731,
    315_279_885_853,
    336_154_439_232,
    357_252_984_102,
    378_592_214_576,
    400_189_504_740,
    422_062_970_006,
    444_231_533_232,
    466_714_996_121,
    489_534_116_516,
    512_710_692_262,
    536_267_652_373,
    560_229_156_367,
    584_620_702_710,
    609_469_247_454,
    634_803_334_274,
    660_653_237_293,
    687_051_118_265,
    714_031_199_887,
    741_629_957_302,
    769_886_330_118,
    798_841_957_616,
    828_541_440_246,
    859_032_630_958,
    890_366_960_485,
    922_599_801_342,
    955_790_876_100,
    990_004_716_402,
    1_025_311_180_285,
    1_061_786_036_713,
    1_099_511_627_776,
    1_138_577_620_927,
    1_179_081_865_935,
    1_221_131_374_008,
    1_264_843_439_966,
    1_310_346_932_501,
    1_357_783_782_718,
    1_407_310_707_471,
    1_459_101_211_952,
    1_513_347_925_819,
    1_570_265_339_598,
    1_630_093_023_767,
    1_693_099_432_919,
    1_759_586_423_012,
    1_829_894_642_713,
    1_904_410_002_821,
    1_983_571_483_984,
    2_067_880_617_314,
    2_157_913_071_598,
    2_254_332_914_290,
    2_357_910_294_946,
    2_469_543_549_320,
    2_590_287_069_547,
    2_721_386_775_087,
    2_864_325_718_023,
    3_020_883_369_742,
    3_193_213_629_518,
    3_383_948_835_739,
    3_596_340_486_765,
    3_834_452_731_877,
    4_103_433_258_373,
    4_409_900_272_885,
    4_762_508_089_207,
    5_172_795_509_757,
    5_656_496_960_281,
    6_235_640_305_064,
    6_942_043_205_274,
    7_823_431_745_687,
    8_954_803_598_194,
    10_461_154_348_316,
    12_567_475_412_974,
    15_723_748_834_199,
    20_979_931_659_340,
    31_485_893_460_504,
    62_990_978_967_861,
];

#[cfg(test)]
#[allow(clippy::float_arithmetic, clippy::arithmetic_side_effects)]
mod tests {
    extern crate std;
    use super::*;
    use crate::alarm::Span;

    #[test]
    fn tangents_are_those_of_the_library() {
        for (degrees, value) in TANGENTS.iter().enumerate() {
            let exact = (degrees as f64).to_radians().tan() * ONE as f64;
            assert!(
                (*value as f64 - exact).abs() <= 0.5 + exact * 1e-15,
                "{degrees}"
            );
        }
    }

    #[test]
    fn what_is_left_out_follows_the_notes() {
        let lead = Lead::new(6_000_000, 1).expect("positive");
        let chamfer = |tenths, degrees| Chamfer {
            tenths: At::new(tenths, Span::default()),
            degrees,
        };
        let mm = |tenths: i64| Some(At::new(Length::from_nm(tenths * 100_000), Span::default()));
        let pair = |run: Option<RunOut>| {
            run.map(|run| (run.short.value.nm() / 1000, run.long.value.nm() / 1000))
        };
        let of = |tenths, j, k| pair(chamfer(tenths, 45).resolve(j, k, lead));
        assert_eq!(of(5, None, None), Some((3000, 3000)));
        assert_eq!(of(5, None, mm(0)), Some((3000, 3000)));
        assert_eq!(of(5, None, mm(20)), Some((3000, 2000)));
        assert_eq!(of(5, mm(15), None), Some((1500, 1500)));
        assert_eq!(of(5, mm(15), mm(0)), Some((1500, 1500)));
        assert_eq!(of(5, mm(15), mm(20)), Some((1500, 2000)));
        assert_eq!(of(5, mm(0), mm(20)), None);
        assert_eq!(of(5, mm(0), None), None);
        assert_eq!(of(0, None, None), None);
        assert_eq!(of(0, None, mm(20)), None);
        assert_eq!(of(0, mm(15), None), Some((1500, 1500)));
        assert_eq!(
            pair(chamfer(5, 30).resolve(None, None, lead)),
            Some((1732, 3000))
        );
    }
}
