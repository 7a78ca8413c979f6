//! Comma-separated: a header and one line a move, empty where a field does not apply. No field needs quoting.

use super::Row;
use crate::number::{decimal, integer};
use crate::place::SourceLine;

/// Appends the header.
pub(super) fn header(out: &mut Vec<u8>) {
    out.extend_from_slice(
        b"n,line,file,o,call,cycle,pass,start,peck,stage,kind,x,z,c,mx,mz,mc,depth,feed,feed_rev,lead,start_deg,rev,\
          rpm,mode,m,t,ms,i,k,dir,lead_change\n",
    );
}

/// Appends one line.
pub(super) fn row(out: &mut Vec<u8>, row: &Row) {
    integer(out, row.n);
    let line = SourceLine(row.line);
    count(out, Some(line.in_file()));
    // File, O-number and depth of a call belong to subprograms only.
    out.push(b',');
    if let Some(file) = line.file() {
        out.extend_from_slice(file.as_bytes());
    }
    out.extend_from_slice(b",,");
    text(out, row.cycle);
    count(out, row.pass);
    count(out, row.start);
    count(out, row.peck);
    text(out, row.stage);
    text(out, Some(row.kind));
    for value in row.work.into_iter().chain(row.machine) {
        scaled(out, Some(value));
    }
    scaled(out, row.depth);
    scaled(out, row.feed);
    scaled(out, row.feed_rev);
    scaled(out, row.lead);
    scaled(out, row.start_udeg.map(i64::from));
    scaled(out, row.rev);
    scaled(out, row.rpm);
    text(out, row.mode);
    count(out, row.m);
    count(out, row.t);
    count(out, row.ms);
    scaled(out, row.arc.map(|(i, _, _)| i));
    scaled(out, row.arc.map(|(_, k, _)| k));
    text(out, row.arc.map(|(_, _, direction)| direction));
    scaled(out, row.lead_change);
    out.push(b'\n');
}

fn text(out: &mut Vec<u8>, value: Option<&'static str>) {
    out.push(b',');
    out.extend_from_slice(value.unwrap_or_default().as_bytes());
}

fn count(out: &mut Vec<u8>, value: Option<impl Into<u64>>) {
    out.push(b',');
    if let Some(value) = value {
        integer(out, value.into());
    }
}

fn scaled(out: &mut Vec<u8>, value: Option<i64>) {
    out.push(b',');
    if let Some(value) = value {
        decimal::<6>(out, value);
    }
}
