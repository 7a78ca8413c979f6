//! For each rule a fault in a sound wire.

use leadscrew_core::params::Entry;

use super::scene::{Scene, error, frame, is};
use crate::doctor::machine::Known;

/// An emergency of X that stays.
fn emergency(code: u16) -> Scene {
    let mut scene = Scene::new();
    let [low, high] = code.to_le_bytes();
    scene.frame(1500, 0x080 + 16, &[low, high, 1, 0, 0, 0, 0, 0]);
    scene
}

/// An object of X.
fn object(index: u16, sub: u16, value: u32) -> Scene {
    let mut scene = Scene::new();
    scene.object(1500, 16, [index, sub], value, false);
    scene
}

/// X has a following error at a ms while it moves so; `thread`: the board is on a helix.
pub fn following(ms: u64, thread: bool) -> Scene {
    let mut scene = Scene::moving(|target, k| target(k - 1));
    if thread {
        scene.frame(ms - 1, 0x181, &[2, 0x10, 0, 0, 0, 0, 0, 8]);
    }
    scene.frame(ms, 0x080 + 16, &[0x11, 0x86, 1, 0, 0, 0, 0, 0]);
    scene
}

/// A block of two bytes each, set up for the board but for one object.
pub fn block(but: [u16; 2], value: u32) -> Scene {
    let mut scene = Scene::with_block();
    let all = [
        ([0x6000, 0], 2),
        ([0x6200, 0], 2),
        ([0x1400, 1], 0x246),
        ([0x1800, 1], 0x4000_01C6),
        ([0x1600, 0], 2),
        ([0x1600, 1], 0x6200_0108),
        ([0x1600, 2], 0x6200_0208),
        ([0x1A00, 0], 2),
        ([0x1A00, 1], 0x6000_0108),
        ([0x1A00, 2], 0x6000_0208),
    ];
    for (ms, (object, right)) in (1500..).zip(all) {
        let value = if object == but { value } else { right };
        scene.object(ms, 70, object, value, false);
    }
    scene
}

/// A board that nobody has started sends no status.
fn no_status() -> Scene {
    Scene::new().keep(|_, packet| !is(packet, 0x181))
}

/// The board stands on an alarm for a while.
fn stands(alarm: u16) -> Scene {
    let [low, high] = alarm.to_le_bytes();
    let mut board = no_status();
    for n in 0..20 {
        board.frame(2000 + n * 10, 0x181, &[7, 0, low, high, 0, 0, 0, 8]);
    }
    board
}

/// Where an axis is behind a period of interpolation and a loop of this gain (1/s).
pub fn loops(target: &dyn Fn(i64) -> i32, k: i64, kv: i32) -> i32 {
    let mut at = 0.0;
    // What was further back is forgotten.
    for period in k - 2000..k {
        at += (f64::from(target(period)) - at) * f64::from(kv) / 1000.0;
    }
    at.round() as i32
}

/// A drive with a loop, whose profile says that it buffers nine targets; 9003 of it.
pub fn told_buffer(latency: i64) -> Scene {
    let mut scene = Scene::moving(|target, k| loops(target, k - 9, 30));
    let entry = Entry::find_text("9003.X").unwrap();
    scene.machine.params.set(entry, latency).unwrap();
    for drive in &mut scene.machine.drives {
        drive.known = Some(Known {
            window_us: None,
            buffer: Some(9),
        });
    }
    scene
}

pub fn all() -> Vec<(u8, Scene)> {
    let mut all = Vec::new();
    let mut seed = |number: u8, scene: Scene| all.push((number, scene));

    let mut bit_rate = Scene::new();
    let mut foreign_rate = Scene::new().keep(|_, _| false);
    for n in 0..40 {
        bit_rate.packet(100_000 + n * 20_000 + 900, error(0x088, 0, 0));
        bit_rate.packet(100_000 + n * 20_000 + 950, frame(0x705, &[5]));
        foreign_rate.packet(n * 100_000, error(0x088, 0, 0));
    }
    seed(1, bit_rate);
    seed(1, foreign_rate);
    let mut termination = Scene::new();
    termination.ms = 13_000;
    for n in 0..120 {
        let counter = u8::try_from(n).unwrap();
        termination.packet(
            n * 100_000 + [45, 90][usize::from(n % 2 == 0)],
            error(0x088, counter, 0),
        );
    }
    seed(2, termination);
    let mut alone = Scene::new().keep(|_, _| false);
    for n in 0..30 {
        alone.packet(n * 100_000, error(0x2A8, 128, 0));
    }
    seed(3, alone);
    seed(4, emergency(0x8120));
    let mut load = Scene::new();
    for k in 0..4000 {
        for n in 0..5 {
            load.packet(
                k * 1000 + 600 + n * 20,
                frame(0x300 + 0x20, &[8, 0, 0, 0, 0]),
            );
        }
    }
    seed(5, load);
    let mut clash = Scene::new();
    for n in 0..5 {
        clash.frame(1000 + n * 10, 0x210, &[0x0F, 0, 1, 0, 0, 0]);
    }
    seed(6, clash);
    let mut twins = Scene::new();
    twins.frame(100, 0x705, &[0]);
    twins.frame(102, 0x705, &[0]);
    seed(6, twins);
    seed(7, Scene::new().keep(|_, packet| !is(packet, 0x190)));
    seed(
        7,
        Scene::new().keep(|at, packet| at < 1_500_000 || !is(packet, 0x190)),
    );
    let mut restarts = Scene::new();
    for n in 0..3 {
        restarts.frame(500 + n * 900, 0x710, &[0]);
    }
    seed(8, restarts);
    let (mut waits, mut stopped) = (Scene::new(), Scene::new());
    for n in 0..8 {
        waits.frame(100 + n * 450, 0x710, &[0x7F]);
        stopped.frame(100 + n * 450, 0x710, &[0x04]);
    }
    seed(9, waits);
    seed(10, stopped);
    seed(11, object(0x1017, 0, 0));
    let mut seldom = Scene::new();
    seldom.ms = 8000;
    for n in 0..5 {
        seldom.frame(100 + n * 1500, 0x77F, &[5]);
    }
    seed(12, seldom);
    seed(13, emergency(0x8130));
    let no_board = |at: u64, packet: &leadscrew_can::Packet| at < 2_000_000 || !is(packet, 0x080);
    seed(14, Scene::new().keep(no_board));
    let mut second = Scene::new();
    for n in 0..20 {
        second.packet(1_000_700 + n * 10_000, frame(0x080, &[]));
    }
    seed(15, second);
    // A drive that falls silent meanwhile is no cause.
    let deaf = |at: u64, packet: &leadscrew_can::Packet| {
        at < 1_500_000 || !is(packet, 0x190) && !is(packet, 0x181)
    };
    let mut second_heard = Scene::new().keep(deaf);
    second_heard.frame(1490, 0x081, &[0x00, 0xFF, 0x81, 0x15, 0x11, 0, 0, 0]);
    seed(15, second_heard);
    let lossy =
        |at: u64, packet: &leadscrew_can::Packet| at % 500_000 != 100_000 || !is(packet, 0x080);
    seed(16, Scene::new().keep(lossy));
    let mut period = Scene::new();
    period.object(1500, 16, [0x60C2, 1], 2, false);
    period.object(1501, 16, [0x60C2, 2], 0xFD, false);
    seed(17, period);
    let mut step = Scene::new();
    step.object(1500, 16, [0x60C2, 1], 15, true);
    step.object(1501, 16, [0x60C2, 2], 0xFC, true);
    step.object(1502, 16, [0x60C2, 1], 20, false);
    step.object(1503, 16, [0x60C2, 2], 0xFC, false);
    seed(18, step);
    let mut jitter = Scene::new().keep(|at, packet| at % 50_000 != 0 || !is(packet, 0x080));
    jitter.machine.drives[0].known = Some(Known {
        window_us: Some(30),
        buffer: None,
    });
    for n in 0..80 {
        let counter = u8::try_from(n * 50 % 240 + 1).unwrap();
        jitter.packet(n * 50_000 + 45, frame(0x080, &[counter]));
    }
    seed(19, jitter);
    seed(20, emergency(0x8240));
    seed(21, object(0x1006, 0, 2000));
    let mut late = Scene::new();
    for n in 0..5_u8 {
        let at = 1000 + u64::from(n) * 100;
        for further in 0..10 {
            late.frame(at + further * 10, 0x181, &[1, 0, 0, 0, 0, n + 1, 0, 8]);
        }
    }
    let keep = |_: u64, packet: &leadscrew_can::Packet| {
        packet
            .frame()
            .is_none_or(|frame| frame.id().get() != 0x181 || frame.payload()[5] > 0)
    };
    seed(22, late.keep(keep));
    seed(23, emergency(0x8210));
    seed(24, emergency(0x8220));
    let mut mapping = object(0x1600, 0, 1);
    mapping.object(1501, 16, [0x1600, 1], 0x6040_0010, false);
    seed(25, mapping);
    seed(26, object(0x1400, 2, 255));
    let mut cadence = Scene::new();
    cadence.every = 2;
    seed(27, cadence);
    let mut bunched = Scene::new();
    bunched.same_place = true;
    seed(28, bunched);
    seed(29, object(0x1400, 1, 0x8000_0210));
    let (mut mappable, mut state) = (Scene::new(), Scene::new());
    mappable.refused(1500, 16, [0x1600, 3], 0x0604_0041);
    state.refused(1500, 16, [0x60C2, 1], 0x0800_0022);
    seed(30, mappable);
    seed(31, state);
    let mut forgotten = Scene::new();
    forgotten.object(1000, 16, [0x6065, 0], 5000, true);
    forgotten.frame(2000, 0x710, &[0]);
    forgotten.object(3000, 16, [0x6065, 0], 100, false);
    seed(32, forgotten);

    let mut other = Scene::new();
    other.frame(500, 0x310, &[6]);
    for n in 0..10 {
        other.frame(1100 + n * 100, 0x290, &[8, 0, 0, 0, 0]);
    }
    seed(33, other);
    seed(34, Scene::new().word(|_| 0x0237));
    let mut seven = object(0x6061, 0, 7);
    seven.object(1400, 16, [0x6060, 0], 7, false);
    seed(35, seven);
    let mut eight = object(0x6061, 0, 8);
    eight.object(1400, 16, [0x6060, 0], 8, false);
    eight.streams_in(7);
    seed(35, eight);
    seed(36, Scene::new().word(|_| 0x0240).control(|_| 0x0006));
    seed(37, Scene::new().word(|_| 0x0231).control(|_| 0x0007));
    seed(
        38,
        Scene::new().word(|ms| if ms < 2000 { 0x1237 } else { 0x0250 }),
    );
    seed(38, stands(4358));
    seed(39, following(600, false));
    seed(40, following(803, true));
    seed(41, following(300, false));
    seed(42, Scene::moving(|target, k| target(k - 2) / 2));
    seed(
        42,
        Scene::moving(|target, k| loops(target, k, 30) * 20 / 21),
    );
    seed(43, Scene::moving(|target, k| -target(k - 2)));
    seed(44, Scene::moving(|target, k| target(k.min(800))));
    let jump = Scene::moving(|_, _| 5000);
    seed(45, jump.word(|_| 0x0233));
    seed(46, Scene::moving(|target, k| target(k - 9)));
    seed(46, told_buffer(9_000));
    seed(47, Scene::new().word(|_| 0x1A37));
    let mut homing = Scene::new().word(|_| 0x2637).control(|_| 0x001F);
    homing.frame(100, 0x310, &[6]);
    seed(48, homing);
    for alarm in [4526, 4532] {
        seed(48, stands(alarm));
    }
    // Its outputs for a second, or three questions.
    let mut silent = Scene::with_block();
    let mut asked = Scene::with_block();
    for n in 0..10 {
        silent.frame(1000 + n * 100, 0x200 + 70, &[1, 0]);
    }
    for n in 0..3 {
        asked.frame(3000 + n * 300, 0x600 + 70, &[0x40, 0, 0x60, 0, 0, 0, 0, 0]);
    }
    seed(49, silent);
    seed(49, asked);
    // The inputs the wrong way round; an identifier of somebody else; a mapping that is empty.
    for (object, value) in [
        ([0x1A00, 1], 0x6000_0208),
        ([0x1400, 1], 0x247),
        ([0x1600, 0], 0),
    ] {
        seed(50, block(object, value));
    }
    // A fault before anybody listened, and one with its code.
    seed(51, Scene::new().word(|_| 0x0238));
    seed(51, emergency(0x3210));
    // By its status; by an emergency, or its object, where nobody has started it.
    let [mut told, mut asked] = [no_status(), no_status()];
    told.frame(2000, 0x081, &[0x00, 0xFF, 0x81, 0x07, 0x11, 0, 0, 0]);
    asked.object(3900, 1, [0x5001, 4], 4359, false);
    seed(52, stands(4359));
    seed(52, told);
    seed(52, asked);
    all
}
