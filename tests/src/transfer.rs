//! SDO transfers of both directions under one name.

use core::time::Duration;

use leadscrew_core::bus::{Frame, SdoDownload, SdoError, SdoSink, SdoUpload};

/// A transfer, either way.
pub(crate) trait Transfer {
    fn poll(&mut self, now: Duration) -> Option<Frame>;
    fn receive(&mut self, frame: &Frame, now: Duration);
    fn outcome(&self) -> Option<Result<(), SdoError>>;
}

impl Transfer for SdoDownload<'_> {
    fn poll(&mut self, now: Duration) -> Option<Frame> {
        SdoDownload::poll(self, now)
    }

    fn receive(&mut self, frame: &Frame, now: Duration) {
        SdoDownload::receive(self, frame, now);
    }

    fn outcome(&self) -> Option<Result<(), SdoError>> {
        SdoDownload::outcome(self)
    }
}

impl<S: SdoSink + ?Sized> Transfer for SdoUpload<'_, S> {
    fn poll(&mut self, now: Duration) -> Option<Frame> {
        SdoUpload::poll(self, now)
    }

    fn receive(&mut self, frame: &Frame, now: Duration) {
        SdoUpload::receive(self, frame, now);
    }

    fn outcome(&self) -> Option<Result<(), SdoError>> {
        SdoUpload::outcome(self)
    }
}
