//! The board knows where the machine stands after every restart of the application.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::bus::{Object, Order, SdoProtocol};
use leadscrew_core::params::Params;
use leadscrew_tests::gateway::{Gateway, Upload};
use leadscrew_tests::machine::{calls, machine};

/// Two parameters are written one after the other: the second restart comes while the drives of the first are still coming
/// up.
#[test]
fn a_restart_during_a_restart_keeps_the_position_to_the_nanometre() {
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    // Half an increment of the drive away from one of its positions.
    let program = calls("G0 X20.0001 Z-3\nM30\n", &params);
    Upload::new(1, &program).feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    for _ in 0..2_000 {
        sim.step();
    }
    let stood = sim.board().ticker().executor().position();
    assert_eq!((stood.x.nm(), stood.z.nm()), (10_000_050, -3_000_000));
    let tolerance = Object::new(0x2000 + 9007, 0);
    for (value, between) in [(10_u8, 1), (11, 0), (12, 3)] {
        gateway
            .write(&mut sim, tolerance, &[value], SdoProtocol::Short)
            .expect("written");
        for _ in 0..between {
            sim.step();
            // Nor does the board report another position meanwhile.
            assert_eq!(sim.board().ticker().executor().position(), stood);
        }
    }
    for _ in 0..200 {
        sim.step();
        assert_eq!(sim.board().ticker().executor().position(), stood);
    }
}
