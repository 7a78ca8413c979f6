//! Random whole programs under a random operator: text, cycles, motion, drives.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::board::{Command, State};
use leadscrew_core::params::Params;
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::run;
use leadscrew_tests::random::Random;

/// A program of a dozen blocks outside a bar of 60 mm; ends at X`x` Z`z` (mm).
fn program(random: &mut Random) -> (String, i64, i64) {
    let mut text = format!("M3 S{}\nG0 X100 Z20\n", random.within(100, 600));
    for _ in 0..random.within(3, 9) {
        match random.within(0, 5) {
            0 => text += &format!("G0 X{} Z{}\n", random.within(62, 160), random.within(1, 40)),
            1 => {
                text += &format!(
                    "G98 G1 X{}.{:03} Z{}.{} F{}\n",
                    random.within(62, 120),
                    random.within(0, 999),
                    random.within(1, 30),
                    random.within(0, 9),
                    random.within(50, 3000)
                )
            }
            2 => {
                // A quarter circle and the way back, so that nothing drifts off.
                let radius = random.within(1, 12);
                text += &format!(
                    "G0 X80 Z20\nG98 G{} X{} Z{} R{radius} F{}\n",
                    random.within(2, 3),
                    80 + 2 * radius,
                    20 - radius,
                    random.within(100, 4000)
                );
            }
            3 => {
                text += &format!(
                    "G0 X66 Z-5\nG99 G75 R0.5\nG75 X{} Z-{} P{}0000 Q30000 F0.{}\nG0 Z20\n",
                    random.within(50, 62),
                    random.within(6, 14),
                    random.within(1, 8),
                    random.within(1, 4)
                )
            }
            4 => {
                let lead = random.within(1, 3);
                text += &format!(
                    "G0 X70 Z{}\nG76 P0{}0{}60 Q{} R0.05\nG76 X{} Z-{} R{} P{} Q{} F{lead}\n",
                    random.within(6, 12),
                    random.within(0, 2),
                    random.within(0, 9),
                    random.within(500, 1500),
                    random.within(52, 58),
                    random.within(15, 40),
                    ["0", "-0.5", "0.2"][random.within(0, 2) as usize],
                    random.within(4000, 14000),
                    random.within(2000, 4000),
                );
            }
            _ => text += &format!("G4 P{}\n", random.within(1, 300)),
        }
    }
    let (x, z) = (random.within(70, 160), random.within(5, 60));
    text += &format!("G0 X{x} Z{z}\nM30\n");
    (text, x, z)
}

#[test]
fn random_programs_under_a_random_operator() {
    leadscrew_seed::volume(0, |first| {
        let params = Params::sheets();
        let programs = leadscrew_seed::amount(12, 40);
        let mut ticks_in_all = 0;
        for seed in (0..programs).map(|program| first.wrapping_add(program)) {
            let mut random = Random(seed);
            let (text, x, z) = program(&mut random);
            let calm = run(&text, &params, &PlantOptions::default(), |_, _| {});
            assert_eq!(calm.alarm, None, "seed {seed}\n{text}");
            let again = run(&text, &params, &PlantOptions::default(), |_, _| {});
            assert_eq!(calm.rows, again.rows, "seed {seed}: not the same twice");
            let operated = run(&text, &params, &PlantOptions::default(), |sim, _| {
                let held = sim.board().ticker().state() == State::Held;
                match random.within(0, if held { 120 } else { 900 }) {
                    0 => sim.command(Command::Hold),
                    1 | 2 => sim.command(Command::Resume),
                    3 => sim.command(Command::FeedOverride(random.within(10, 150) as u8)),
                    4 => sim.command(Command::RapidOverride(random.within(10, 100) as u8)),
                    5 => sim.command(Command::SingleBlock(random.within(0, 3) == 0)),
                    _ => {}
                }
            });
            assert_eq!(operated.alarm, None, "seed {seed}\n{text}");
            for ran in [&calm, &operated] {
                assert_eq!(
                    first_excess(&ran.rows, &params),
                    None,
                    "seed {seed}\n{text}"
                );
                let last = ran.rows.last().expect("rows").position;
                let end = (last.x.nm(), last.z.nm());
                assert_eq!(end, (x * 500_000, z * 1_000_000), "seed {seed}\n{text}");
                ticks_in_all += ran.rows.len();
            }
        }
        println!("{programs} programs, {ticks_in_all} ticks");
    });
}
