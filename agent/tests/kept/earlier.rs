//! Records of earlier versions: what they kept is read, and nothing of it is lost.

use leadscrew_agent::record::{Cut, Figure, Measured};
use leadscrew_agent::{Body, Record};

/// The certificate of a thread as version 0.1.0 kept it, before cuts were read.
const THREAD: &str = r#"{"at":1764150000123,"body":{"Thread":{"start":{"serial":41003,"count":12},"number":345,"program":7,"line":12,"kind":"thread","end":"finished","passes":6,"late":0,"errors":{"measured":4200,"largest_nm":-812,"squares":1234567}}}}"#;

fn thread() -> Record {
    serde_json::from_str(THREAD).unwrap()
}

#[test]
fn a_certificate_that_was_kept_before_cuts_were_read_is_read() {
    let record = thread();
    let Body::Thread(told) = &record.body else {
        panic!("{record:?}");
    };
    assert_eq!(told.start.key(told.number), "0000a02b/12/345");
    assert_eq!((told.errors.largest_nm, told.passes), (-812, 6));
    assert_eq!((&told.cut, told.cut.known()), (&Cut::NotRead, "not_read"));
}

#[test]
fn a_certificate_with_its_cut_stays_small() {
    let mut record = thread();
    let Body::Thread(told) = &mut record.body else {
        panic!("{record:?}");
    };
    let most = Figure(-2_147_483_648, 4_294_967_295);
    told.cut = Cut::Measured(Measured {
        axis: 'Z',
        age_known: false,
        positions: u16::MAX,
        passes: u8::MAX,
        lead_nm: 4_294_967_295,
        grooves: Some([most; 2]),
        apart: Some(most),
        slope: Some(most),
        worst: most,
        complete: false,
        why: "groove known of 2 passes of 3 alone".to_owned(),
    });
    let text = serde_json::to_string(&record).unwrap();
    assert!(text.len() < 800, "{} bytes: {text}", text.len());
    assert_eq!(serde_json::from_str::<Record>(&text).unwrap(), record);
}
