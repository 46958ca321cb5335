//! The files that a scene names: read once each, never more than a stated amount.

use crate::error::{Error, Result};
use crate::input;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// What a scene expects in a file; it decides how large the file may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A table of numbers as text.
    Table,
    /// A mesh.
    Mesh,
    /// A picture.
    Picture,
}

impl Kind {
    /// Larger files are refused before they are read. A table of a hundred thousand rows has
    /// a few MiB; meshes and pictures count anew whenever a scene names them, since each
    /// object holds its own triangles.
    const fn most_bytes(self) -> u64 {
        match self {
            Self::Table => 16 << 20,
            Self::Mesh | Self::Picture => 4 << 30,
        }
    }
}

/// Where the files that a scene names lie, and those read so far.
#[derive(Debug)]
pub struct Files<'a> {
    place: Place<'a>,
    read: RefCell<BTreeMap<String, Rc<Vec<u8>>>>,
    /// Bytes of meshes and pictures, as often as the scene names them.
    counted: Cell<u64>,
}

#[derive(Debug)]
enum Place<'a> {
    Folder(&'a Path),
    Held(&'a BTreeMap<String, Vec<u8>>),
}

impl<'a> Files<'a> {
    /// Files in a folder; absolute paths lead out of it.
    pub const fn in_folder(folder: &'a Path) -> Self {
        Self::at(Place::Folder(folder))
    }

    /// Files that are held in memory by name; there are no others.
    pub const fn held(files: &'a BTreeMap<String, Vec<u8>>) -> Self {
        Self::at(Place::Held(files))
    }

    const fn at(place: Place<'a>) -> Self {
        Self { place, read: RefCell::new(BTreeMap::new()), counted: Cell::new(0) }
    }

    /// Where a file lies that the scene names.
    pub fn path_of(&self, name: &str) -> PathBuf {
        match self.place {
            Place::Folder(folder) => folder.join(name),
            Place::Held(_) => PathBuf::from(name),
        }
    }

    /// The bytes of a file that the scene names. The error is one of the scene's entry.
    pub fn read(&self, name: &str, kind: Kind) -> Result<Rc<Vec<u8>>> {
        let known = self.read.borrow().get(name).cloned();
        let bytes = match known {
            Some(bytes) => bytes,
            None => self.fetch(name, kind).map_err(|e| Error::named_file(name, &e))?,
        };
        if kind != Kind::Table {
            let counted = self.counted.get().saturating_add(bytes.len() as u64);
            if counted > kind.most_bytes() {
                let most = kind.most_bytes() >> 30;
                return Err(Error::new(format!("the meshes that the scene names have more than {most} GiB"))
                    .hint("name fewer or smaller ones; a mesh counts as often as it is named"));
            }
            self.counted.set(counted);
        }
        Ok(bytes)
    }

    fn fetch(&self, name: &str, kind: Kind) -> std::io::Result<Rc<Vec<u8>>> {
        let bytes = match self.place {
            Place::Folder(folder) => input::read_bytes(&folder.join(name), kind.most_bytes())?,
            Place::Held(files) => files.get(name).cloned().ok_or(std::io::ErrorKind::NotFound)?,
        };
        let bytes = Rc::new(bytes);
        self.read.borrow_mut().insert(name.to_owned(), Rc::clone(&bytes));
        Ok(bytes)
    }
}
