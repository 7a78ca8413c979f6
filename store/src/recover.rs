//! What a loss of power leaves half done, and how it is ended at power-up.
//!
//! The pages are a ring: closed pages, the page in use, an erased page. When the page in use is full, the map closes it and
//! marks the erased page as the page in use. It then copies to that page (the *target*) what is still valid on the page
//! after it (the *source*, which is the oldest), and erases the source. A value on the target is therefore a copy, and
//! the source is erased only after everything valid on it has been copied.
//!
//! An erase that was cut leaves anything on its page: old words, erased words, words that cannot be read, also where the
//! marks of the page are. The map's own repair trusts the marks: it erases the target although the source may be half
//! erased, and gives up where all pages look closed. So nothing half done is left to it:
//!
//! - a page whose marks no whole page has is erased again, and so is the later one of two pages in use;
//! - a move is ended by erasing the source, or, where the target lacks something, the target;
//! - where all pages look closed, one of them is a target that was being erased. It has nothing but copies.
//!
//! Erased pages lie behind each other in the ring, and behind the page in use. Where they do not, the pages were once a
//! ring of fewer: what was kept in that one would not be found, or an older value of it. That is told as damage; from then
//! on nothing is read and nothing is changed, so that the image for that ring still finds everything. (An erase that was
//! cut has been ended by then.)

use embedded_storage::nor_flash::NorFlash;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

use super::patient::{Patient, View};
use super::wait::block_on;
use super::{BUFFER, Store, StoreError, WORD, reason};

/// What a page looks like.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Page {
    /// Nothing is on it.
    Erased,
    /// It is full.
    Closed,
    /// It is being filled.
    Writing,
    /// An erase of it was cut.
    Cut,
}

/// Which page is in use, where every cut erase has been ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    /// The one that begins here.
    Page(u32),
    /// None.
    None,
    /// None, and all of them look closed.
    AllClosed,
    /// Two that are not neighbours.
    Apart,
}

/// A map for one look at some of the pages. It remembers no place: the next look is at others.
type Look<'f, F> = MapStorage<u8, &'f mut Patient<F>, Cache<Uncached, Uncached, Uncached, u8>>;

/// Which keys have a value on a page.
type Keys = [bool; 1 << u8::BITS];

impl<F: NorFlash> Store<F> {
    /// Ends what a loss of power has left half done. Call it once after power-up, before anything else.
    ///
    /// # Errors
    /// [`StoreError::Device`]; [`StoreError::Damaged`] for pages that were written as a ring of fewer.
    pub fn recover(&mut self) -> Result<(), StoreError> {
        self.end_all()?;
        self.count_erases();
        Ok(())
    }

    #[inline(never)]
    fn end_all(&mut self) -> Result<(), StoreError> {
        let used = self.end_erases()?;
        if !self.is_one_ring(used)? {
            self.is_foreign = true;
            return Err(StoreError::Damaged);
        }
        match used {
            Use::Page(target) => {
                let source = self.after(target);
                if self.state(source)? == Page::Closed {
                    self.end_move(source, target)?;
                }
                Ok(())
            }
            Use::AllClosed => self.open_a_target(),
            Use::None | Use::Apart => Ok(()),
        }
    }

    /// Erases again each page that a cut erase has left. Gives which page is in use then.
    fn end_erases(&mut self) -> Result<Use, StoreError> {
        let mut found = Use::AllClosed;
        for page in self.pages() {
            match (self.state(page)?, found) {
                (Page::Closed, _) => continue,
                (Page::Cut, _) => self.erase(page)?,
                // Of two pages in use, the later one was being erased: its values are on the one before.
                (Page::Writing, Use::Page(first)) if self.after(page) == first => {
                    self.erase(first)?;
                    found = Use::Page(page);
                }
                (Page::Writing, Use::Page(first)) if self.after(first) == page => {
                    self.erase(page)?
                }
                (Page::Writing, Use::Page(_)) => return Ok(Use::Apart),
                (Page::Writing, _) => found = Use::Page(page),
                (Page::Erased, _) => {}
            }
            if found == Use::AllClosed {
                found = Use::None;
            }
        }
        Ok(found)
    }

    /// True where the erased pages lie behind each other, right behind the page in use. Only in a move that is half done is
    /// the page behind it not erased, and then none is. Two pages in use are the target and the source of a move, which are
    /// neighbours.
    fn is_one_ring(&mut self, used: Use) -> Result<bool, StoreError> {
        let end = self.map.flash_range().end;
        let first = self.is_marked(0)?;
        let last = self.is_marked(end.saturating_sub(F::ERASE_SIZE as u32))?;
        let (mut before, mut gaps, mut erased) = (last, 0_u32, 0_u32);
        for page in self.pages() {
            let marked = self.is_marked(page)?;
            gaps = gaps.saturating_add(u32::from(before && !marked));
            erased = erased.saturating_add(u32::from(!marked));
            before = marked;
        }
        let follow = match used {
            Use::Page(page) => erased == 0 || !self.is_marked(self.after(page))?,
            // A ring that has gone round has one erased page, one that has not begins at the first page, and an empty one
            // has no gap.
            Use::None => erased <= 1 || first || gaps == 0,
            Use::AllClosed => true,
            Use::Apart => false,
        };
        Ok(gaps <= 1 && follow)
    }

    /// Erases the source where all of it that counts is on other pages, else the target. The source of a target that
    /// lacks something is whole, and the map moves everything anew.
    fn end_move(&mut self, source: u32, target: u32) -> Result<(), StoreError> {
        for key in present(&self.keys_on(source)?) {
            let mut buffer = [0; BUFFER];
            if self
                .seen(View::Without(source), key, &mut buffer)?
                .is_none()
            {
                return self.erase(target);
            }
        }
        self.erase(source)
    }

    /// Erases the target of a move, where all pages look closed: the page that has nothing but copies of what is on the
    /// page after it. It was being erased when the power went. Where there is none, a read tells of the damage.
    fn open_a_target(&mut self) -> Result<(), StoreError> {
        for page in self.pages() {
            if self.has_only_copies(page)? {
                return self.erase(page);
            }
        }
        Ok(())
    }

    fn has_only_copies(&mut self, page: u32) -> Result<bool, StoreError> {
        let source = self.after(page);
        for key in present(&self.keys_on(page)?) {
            let (mut here, mut there) = ([0; BUFFER], [0; BUFFER]);
            let here = self.seen(View::Only(page), key, &mut here)?;
            if here != self.seen(View::Only(source), key, &mut there)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The newest value of a key on the pages of a view.
    fn seen<'b>(
        &mut self,
        view: View,
        key: u8,
        buffer: &'b mut [u8; BUFFER],
    ) -> Result<Option<&'b [u8]>, StoreError> {
        let value = match self.look(view) {
            Ok(mut map) => {
                let fetched = block_on(map.fetch_item::<&[u8]>(buffer, &key));
                fetched.map_err(|error| reason(&error))
            }
            Err(error) => Err(error),
        };
        self.map.flash().look(View::All);
        value
    }

    fn look(&mut self, view: View) -> Result<Look<'_, F>, StoreError> {
        let config = MapConfig::try_new(self.map.flash_range()).map_err(|_| StoreError::Device)?;
        let flash = self.map.flash();
        flash.look(view);
        Ok(MapStorage::new(flash, config, Cache::new_uncached()))
    }

    fn keys_on(&mut self, page: u32) -> Result<Keys, StoreError> {
        let keys = self.look(View::Only(page)).and_then(keys);
        self.map.flash().look(View::All);
        keys
    }

    /// Where each page begins.
    fn pages(&self) -> impl Iterator<Item = u32> + use<F> {
        (0..self.map.flash_range().end).step_by(F::ERASE_SIZE.max(1))
    }

    /// Where the page after this one in the ring begins.
    fn after(&self, page: u32) -> u32 {
        let next = page.saturating_add(F::ERASE_SIZE as u32);
        if next < self.map.flash_range().end {
            next
        } else {
            0
        }
    }

    /// What a page looks like from its first and last word, and, where these are erased, from all of them.
    fn state(&mut self, start: u32) -> Result<Page, StoreError> {
        let word = F::WRITE_SIZE as u32;
        let page = F::ERASE_SIZE as u32;
        let last = start.saturating_add(page.saturating_sub(word));
        let begun = self.is_marked(start)?;
        let closed = self.is_marked(last)?;
        Ok(match (begun, closed) {
            (true, true) => Page::Closed,
            (true, false) => Page::Writing,
            (false, true) => Page::Cut,
            (false, false) if self.is_erased(start, page)? => Page::Erased,
            (false, false) => Page::Cut,
        })
    }

    /// True where a word is a mark of its page.
    fn is_marked(&mut self, address: u32) -> Result<bool, StoreError> {
        let marked = self.map.flash().is_marked(address);
        marked.map_err(|_| StoreError::Device)
    }

    /// True where so many bytes from an address on are erased.
    fn is_erased(&mut self, from: u32, length: u32) -> Result<bool, StoreError> {
        let mut word = [0; WORD];
        let word = word.get_mut(..F::WRITE_SIZE).ok_or(StoreError::Device)?;
        let (mut address, end) = (from, from.saturating_add(length));
        while address < end {
            let read = self.map.flash().read_words(address, word);
            read.map_err(|_| StoreError::Device)?;
            if word.iter().any(|byte| *byte != 0xFF) {
                return Ok(false);
            }
            address = address.saturating_add(F::WRITE_SIZE.max(1) as u32);
        }
        Ok(true)
    }

    fn erase(&mut self, start: u32) -> Result<(), StoreError> {
        let end = start.saturating_add(F::ERASE_SIZE as u32);
        let done = self.map.flash().erase_pages(start, end);
        done.map_err(|_| StoreError::Device)
    }
}

fn keys<F: NorFlash>(mut map: Look<'_, F>) -> Result<Keys, StoreError> {
    let mut keys = [false; _];
    let mut buffer = [0; BUFFER];
    let values = block_on(map.fetch_all_items(&mut buffer));
    let mut values = values.map_err(|error| reason(&error))?;
    loop {
        let value = block_on(values.next::<&[u8]>(&mut buffer));
        let Some((key, _)) = value.map_err(|error| reason(&error))? else {
            return Ok(keys);
        };
        if let Some(known) = keys.get_mut(usize::from(key)) {
            *known = true;
        }
    }
}

fn present(keys: &Keys) -> impl Iterator<Item = u8> {
    (0..=u8::MAX)
        .zip(keys)
        .filter_map(|(key, present)| present.then_some(key))
}
