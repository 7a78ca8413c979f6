//! For each rule what looks like its fault and is none.

use super::scene::{Scene, error, frame, is};
use super::seeds::{block, following, loops, told_buffer};
use crate::doctor::machine::{Clock, Known};

/// An emergency of X that is over at once.
fn brief(code: u16) -> Scene {
    let mut scene = Scene::new();
    let [low, high] = code.to_le_bytes();
    scene.frame(1500, 0x080 + 16, &[low, high, 1, 0, 0, 0, 0, 0]);
    scene.frame(1600, 0x080 + 16, &[0; 8]);
    scene
}

/// An object of X.
fn object(index: u16, sub: u16, value: u32) -> Scene {
    let mut scene = Scene::new();
    scene.object(1500, 16, [index, sub], value, false);
    scene
}

pub fn all() -> Vec<(u8, Scene)> {
    let mut all = Vec::new();
    let mut guard = |number: u8, scene: Scene| all.push((number, scene));

    // Seven errors; or many, with frames of all.
    let (mut few, mut many) = (Scene::new(), Scene::new());
    for n in 0..7 {
        few.packet(100_000 + n * 20_000 + 900, error(0x088, 0, 0));
        few.packet(100_000 + n * 20_000 + 950, frame(0x705, &[5]));
    }
    for n in 0..40 {
        many.packet(
            n * 100_000 + [45, 90][usize::from(n % 2 == 0)],
            error(0x088, 0, 0),
        );
    }
    guard(1, few);
    guard(1, many);
    let mut short = Scene::new();
    for n in 0..40_u8 {
        short.packet(
            u64::from(n) * 100_000 + [45, 90][usize::from(n % 2)],
            error(0x088, n, 0),
        );
    }
    guard(2, short);
    let mut plugged = Scene::new().keep(|at, _| at > 2_000_000);
    for n in 0..15 {
        plugged.packet(n * 100_000, error(0x2A8, 128, 0));
    }
    guard(3, plugged);
    guard(4, brief(0x8120));
    // Transfers fill the wire, and process data do not.
    let mut transfer = Scene::new();
    for k in 0..4000 {
        for n in 0..6 {
            transfer.packet(k * 1000 + 600 + n * 20, frame(0x581, &[0; 8]));
        }
    }
    guard(5, transfer);
    // The same frame twice; two boot-ups that an NMT reset asked for.
    let (mut doubled, mut reset) = (Scene::new(), Scene::new());
    for n in 0..5 {
        doubled.frame(1000 + n * 10, 0x210, &[0x0F, 0, 0, 0, 0, 0]);
    }
    reset.frame(90, 0x705, &[5]);
    reset.frame(95, 0x000, &[0x81, 5]);
    reset.frame(100, 0x705, &[0]);
    reset.frame(102, 0x705, &[0]);
    guard(6, doubled);
    guard(6, reset);
    guard(
        7,
        Scene::new().keep(|at, packet| at < 3_200_000 || !is(packet, 0x190)),
    );
    let mut asked = Scene::new();
    asked.frame(400, 0x710, &[5]);
    for n in 0..3 {
        asked.frame(500 + n * 900, 0x000, &[0x81, 0]);
        asked.frame(510 + n * 900, 0x710, &[0]);
    }
    guard(8, asked);
    // A board that nobody operates yet; a drive that is started in time.
    let (mut idle, mut started) = (Scene::new(), Scene::new());
    for n in 0..8 {
        idle.frame(100 + n * 450, 0x701, &[0x7F]);
        started.frame(100 + n * 450, 0x710, &[if n < 4 { 0x7F } else { 0x05 }]);
    }
    guard(9, idle);
    guard(9, started);
    let mut once = Scene::new();
    once.frame(100, 0x710, &[4]);
    once.frame(600, 0x710, &[5]);
    guard(10, once);
    let mut beats = object(0x1017, 0, 0);
    beats.frame(100, 0x710, &[5]);
    guard(11, beats);
    // Commands typed now and then.
    let mut typed = Scene::new();
    typed.ms = 12_000;
    for ms in [100, 200, 1500, 5000, 5100, 11_000] {
        typed.frame(ms, 0x77F, &[5]);
    }
    guard(12, typed);
    guard(13, brief(0x8130));
    guard(
        14,
        Scene::new().keep(|at, packet| at < 3_200_000 || !is(packet, 0x080)),
    );
    let mut twice = Scene::new();
    for n in 0..20_u64 {
        let k = 1000 + n * 10;
        let counter = u8::try_from(k % 240 + 1).unwrap();
        twice.packet(k * 1000 + 1, frame(0x080, &[counter]));
    }
    guard(15, twice);
    guard(16, Scene::new().keep(|at, _| at % 500_000 > 20_000));
    let mut fits = Scene::new();
    fits.object(1500, 16, [0x60C2, 1], 1, false);
    fits.object(1501, 16, [0x60C2, 2], 0xFD, false);
    guard(17, fits);
    let mut later = Scene::new();
    later.object(1500, 16, [0x60C2, 1], 15, true);
    later.frame(1501, 0x710, &[0]);
    later.object(1502, 16, [0x60C2, 1], 20, false);
    guard(18, later);
    let jitter = |clock, window| {
        let mut scene = Scene::new().keep(|at, packet| at % 50_000 != 0 || !is(packet, 0x080));
        scene.machine.clock = clock;
        scene.machine.drives[0].known = Some(Known {
            window_us: window,
            buffer: None,
        });
        for n in 0..80 {
            let counter = u8::try_from(n * 50 % 240 + 1).unwrap();
            scene.packet(n * 50_000 + 45, frame(0x080, &[counter]));
        }
        scene
    };
    guard(19, jitter(Clock::Program, Some(30)));
    guard(19, jitter(Clock::Kernel, Some(70)));
    guard(19, jitter(Clock::Kernel, None));
    guard(20, brief(0x8240));
    guard(21, object(0x1006, 0, 0));
    guard(21, object(0x1006, 0, 1000));
    let mut two_late = Scene::new();
    two_late.frame(3990, 0x181, &[1, 0, 0, 0, 0, 2, 0, 8]);
    guard(22, two_late);
    guard(23, brief(0x8210));
    guard(24, brief(0x8220));
    let mut mapping = object(0x1600, 0, 2);
    mapping.object(1501, 16, [0x1600, 1], 0x6040_0010, false);
    mapping.object(1502, 16, [0x1600, 2], 0x607A_0020, false);
    guard(25, mapping);
    guard(26, object(0x1400, 2, 1));
    // Answers that are lost now and then.
    guard(
        27,
        Scene::new().keep(|at, packet| at % 100_000 > 4000 || !is(packet, 0x190)),
    );
    let mut two = Scene::new();
    two.same_place = true;
    two.machine.drives.truncate(2);
    guard(28, two);
    guard(29, object(0x1400, 1, 0x0000_0210));
    let (mut mapped, mut written, mut board) = (Scene::new(), Scene::new(), Scene::new());
    mapped.refused(1500, 16, [0x1600, 1], 0x0604_0041);
    mapped.object(1600, 16, [0x1600, 1], 0x6040_0010, true);
    written.refused(1500, 16, [0x60C2, 1], 0x0800_0022);
    written.object(1600, 16, [0x60C2, 1], 1, true);
    board.refused(1500, 1, [0x5000, 2], 0x0800_0022);
    guard(30, mapped);
    guard(31, written);
    guard(31, board);
    let mut kept = Scene::new();
    kept.object(1000, 16, [0x6065, 0], 5000, true);
    kept.frame(2000, 0x710, &[0]);
    kept.object(3000, 16, [0x6065, 0], 5000, false);
    guard(32, kept);

    let mut soon = Scene::new();
    soon.frame(500, 0x310, &[6]);
    for n in 0..4 {
        soon.frame(600 + n * 100, 0x290, &[8, 0, 0, 0, 0]);
    }
    soon.frame(1010, 0x290, &[6, 0, 0, 0, 0]);
    guard(33, soon);
    let mut homes = Scene::new().word(|_| 0x0637);
    homes.frame(0, 0x310, &[6]);
    guard(34, homes);
    guard(35, object(0x6061, 0, 8));
    // All three switches are on: no mode.
    let mut inputs = Scene::new();
    inputs.frame(600, 0x290, &[7, 0, 0, 0]);
    inputs.frame(1000, 0x290, &[7, 0, 0, 0]);
    guard(35, inputs);
    let mut seven = object(0x6061, 0, 7);
    seven.object(1400, 16, [0x6060, 0], 7, false);
    seven.streams_in(7);
    guard(35, seven);
    let mains = Scene::new().control(|ms| if ms < 2000 { 0x0006 } else { 0x000F });
    guard(36, mains.word(|ms| if ms < 1000 { 0x0240 } else { 0x1237 }));
    guard(36, Scene::new().word(|_| 0x0240).control(|_| 0x0000));
    let slow = Scene::new().control(|_| 0x000F);
    guard(37, slow.word(|ms| if ms < 1000 { 0x0231 } else { 0x1237 }));
    // With a fault of its own; and as it was told.
    let mut fault = Scene::new().word(|ms| if ms < 2000 { 0x1237 } else { 0x0250 });
    fault.frame(1990, 0x080 + 16, &[0x10, 0x31, 1, 0, 0, 0, 0, 0]);
    guard(38, fault);
    let told = Scene::new().word(|ms| if ms < 2010 { 0x1237 } else { 0x0250 });
    guard(
        38,
        told.control(|ms| if ms < 2000 { 0x000F } else { 0x0000 }),
    );
    guard(39, following(803, true));
    guard(39, following(300, false));
    guard(40, following(600, false));
    guard(41, following(600, false));
    // Lag alone, as a loop has it: half of the way to the target in each of a few periods.
    guard(
        42,
        Scene::moving(|target, k| (target(k - 5) + target(k - 25)) / 2),
    );
    guard(42, Scene::moving(|target, k| -target(k - 2)));
    // A loop of low gain, from rest to rest and heard from ramp to ramp.
    for kv in [15, 30] {
        guard(42, Scene::moving(move |target, k| loops(target, k, kv)));
        let part = Scene::moving(move |target, k| loops(target, k, kv));
        let mut part = part.keep(|us, _| us > 620_000);
        part.ms = 1050;
        guard(42, part);
    }
    guard(43, Scene::moving(|target, k| target(k - 2) / 2));
    guard(44, Scene::moving(|target, k| target(k - 30)));
    // Sixteen periods of a buffer, and a target that is off by a thousand counts in fewer.
    let mut sudden = Scene::moving(|target, k| target(k - 16));
    sudden.steep = true;
    guard(44, sudden);
    let follows = Scene::moving(|target, k| target(k - 1));
    guard(
        45,
        follows.word(|ms| if ms < 200 { 0x0233 } else { 0x1237 }),
    );
    guard(
        46,
        Scene::moving(|target, k| (target(k - 5) + target(k - 25)) / 2),
    );
    guard(46, Scene::moving(|target, k| target(k - 1)));
    // What its profile says, and a period of interpolation.
    guard(46, told_buffer(10_000));
    guard(
        47,
        Scene::new().word(|ms| {
            if (1000..1002).contains(&ms) {
                0x1A37
            } else {
                0x1237
            }
        }),
    );
    let mut done = Scene::new().word(|_| 0x1637).control(|_| 0x001F);
    for n in 0..4 {
        done.frame(100 + n * 800, 0x310, &[6]);
        done.frame(500 + n * 800, 0x310, &[8]);
    }
    guard(48, done);
    // It tells its inputs every 100 ms.
    let mut there = Scene::with_block();
    for n in 0..10 {
        there.frame(1000 + n * 100, 0x200 + 70, &[1, 0]);
        there.frame(1050 + n * 100, 0x180 + 70, &[0, 0]);
    }
    guard(49, there);
    // Its heartbeat is no PDO, and remote requests are its own affair.
    guard(50, block([0x1017, 0], 0));
    guard(50, block([0x1800, 1], 0x1C6));
    // Over at once; and a following error, which has rules of its own.
    guard(51, brief(0x3210));
    guard(
        51,
        following(600, false).word(|ms| if ms < 600 { 0x1237 } else { 0x0238 }),
    );
    // Reset meanwhile.
    let mut reset = Scene::new();
    for n in 0..20 {
        reset.packet(
            2_000_000 + n * 10_000 + 450,
            frame(0x181, &[7, 0, 0x07, 0x11, 0, 0, 0, 8]),
        );
    }
    guard(52, reset);
    all
}
