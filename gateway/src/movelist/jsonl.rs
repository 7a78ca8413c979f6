//! One JSON object a line, fields in the order of the contract, those that do not apply left out.

use super::Row;
use crate::number::{decimal, integer};
use crate::place::SourceLine;

/// Appends one line.
#[inline]
pub(super) fn row(out: &mut Vec<u8>, row: &Row) {
    out.extend_from_slice(b"{\"n\":");
    integer(out, row.n);
    out.extend_from_slice(b",\"line\":");
    let line = SourceLine(row.line);
    integer(out, u64::from(line.in_file()));
    if let Some(file) = line.file() {
        out.extend_from_slice(b",\"file\":\"");
        out.extend_from_slice(file.as_bytes());
        out.push(b'"');
    }
    text(out, b",\"cycle\":\"", row.cycle);
    count(out, b",\"pass\":", row.pass);
    count(out, b",\"start\":", row.start);
    count(out, b",\"peck\":", row.peck);
    text(out, b",\"stage\":\"", row.stage);
    text(out, b",\"kind\":\"", Some(row.kind));
    for (keys, point) in [
        ([b",\"x\":".as_slice(), b",\"z\":", b",\"c\":"], row.work),
        ([b",\"mx\":", b",\"mz\":", b",\"mc\":"], row.machine),
    ] {
        for (key, value) in keys.into_iter().zip(point) {
            out.extend_from_slice(key);
            decimal::<6>(out, value);
        }
    }
    scaled(out, b",\"depth\":", row.depth);
    scaled(out, b",\"feed\":", row.feed);
    scaled(out, b",\"feed_rev\":", row.feed_rev);
    scaled(out, b",\"lead\":", row.lead);
    scaled(out, b",\"lead_change\":", row.lead_change);
    scaled(out, b",\"start_deg\":", row.start_udeg.map(i64::from));
    scaled(out, b",\"rev\":", row.rev);
    scaled(out, b",\"rpm\":", row.rpm);
    text(out, b",\"mode\":\"", row.mode);
    count(out, b",\"m\":", row.m);
    count(out, b",\"t\":", row.t);
    count(out, b",\"ms\":", row.ms);
    if let Some((i, k, direction)) = row.arc {
        scaled(out, b",\"i\":", Some(i));
        scaled(out, b",\"k\":", Some(k));
        text(out, b",\"dir\":\"", Some(direction));
    }
    out.extend_from_slice(b"}\n");
}

#[inline]
fn text(out: &mut Vec<u8>, key: &[u8], value: Option<&'static str>) {
    if let Some(value) = value {
        out.extend_from_slice(key);
        out.extend_from_slice(value.as_bytes());
        out.push(b'"');
    }
}

#[inline]
fn count(out: &mut Vec<u8>, key: &[u8], value: Option<impl Into<u64>>) {
    if let Some(value) = value {
        out.extend_from_slice(key);
        integer(out, value.into());
    }
}

#[inline]
fn scaled(out: &mut Vec<u8>, key: &[u8], value: Option<i64>) {
    if let Some(value) = value {
        out.extend_from_slice(key);
        decimal::<6>(out, value);
    }
}
