//! Checkpoints: a run written down between two blocks, to be gone on with by another process.
//!
//! A file is, in this order and with the least significant byte first,
//!
//! | bytes | |
//! |---|---|
//! | 8 | `etalonCP` |
//! | 4 | version of the format, [`VERSION`] |
//! | N | [`Checkpoint`] in the wire format of [postcard](https://postcard.jamesmunns.com/wire-format) |
//! | 8 | N |
//! | 4 | CRC-32 (IEEE 802.3) of all bytes before it |
//!
//! The checksum finds what disks and networks do to a file, not what is done to it on purpose:
//! so the content is checked as well, against itself and against the run that is to go on. No
//! more is allocated than a small multiple of the file's size.

use super::safely::write_whole;
use crate::camera::Crop;
use crate::error::{Error, Result};
use crate::integrator::{Budget, Integrator, State};
use crate::pilot::Selection;
use crate::scene::{Plan, Scene, View};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::io::{BufWriter, Read as _, Write};
use std::path::Path;

/// Version of the format that is written and read.
pub const VERSION: u32 = 2;

const MAGIC: [u8; 8] = *b"etalonCP";
const HEADER_BYTES: usize = MAGIC.len() + size_of::<u32>();
const TRAILER_BYTES: usize = size_of::<u64>() + size_of::<u32>();

const ANEW: &str = "remove it to begin anew, or name another file";

/// A run on its way.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Checkpoint<'a> {
    /// Which run it is of.
    pub identity: Identity,
    /// How far that run has come.
    pub state: Cow<'a, State>,
}

/// All that decides the bits of a picture: runs of the same identity are one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program, and a hash of what it was built from.
    pub program: String,
    /// Name of the scene.
    pub scene: String,
    /// Hash of the scene's text, camera included, and of every file that it names.
    pub scene_hash: String,
    /// Algorithm, and its groups of strategies where not all are used.
    pub integrator: String,
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// Of which picture that is a part.
    pub crop: Option<Crop>,
    /// Bounces after which paths are cut off, where somebody asked for it.
    pub max_bounces: Option<u32>,
    /// What the plan left out, in the words of [`crate::scene::Leaving`].
    pub plan: String,
    /// Channels of the film.
    pub channels: Vec<String>,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Samples per pixel at most; `None` without a limit.
    pub samples_per_pixel: Option<u64>,
    /// Relative error at which the run ends.
    pub error: Option<f64>,
    /// Seconds after which it ends.
    pub time_s: Option<f64>,
}

impl Identity {
    /// That of a run of this program.
    pub fn of(scene: &Scene, view: &View, plan: &Plan, selection: Selection, budget: &Budget) -> Self {
        Self {
            program: format!("{} ({})", env!("CARGO_PKG_VERSION"), env!("ETALON_SOURCES")),
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            integrator: selection.to_string(),
            resolution: view.camera.resolution(),
            crop: view.camera.crop(),
            max_bounces: plan.most_bounces,
            plan: plan.leaving.to_string(),
            channels: view.sensor.channels.iter().map(|channel| channel.name.clone()).collect(),
            seed: budget.seed,
            samples_per_pixel: Some(budget.samples_per_pixel).filter(|most| *most < u64::MAX),
            error: budget.error,
            time_s: budget.time.map(|time| time.as_secs_f64()),
        }
    }

    /// What is not the same in another run, in words; empty where nothing is.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let facts = |run: &Self| {
            let [width, height] = run.resolution;
            let or_none = |value: Option<String>| value.unwrap_or_else(|| "none".to_owned());
            [
                ("program", run.program.clone()),
                ("scene", format!("\"{}\" ({})", run.scene, run.scene_hash)),
                ("integrator", run.integrator.clone()),
                ("resolution", format!("{width}x{height}")),
                ("corner of --crop", or_none(run.crop.map(|Crop { corner: [x, y], .. }| format!("{x},{y}")))),
                ("bounces at most", or_none(run.max_bounces.map(|most| most.to_string()))),
                ("plan", run.plan.clone()),
                ("channels", run.channels.join(" ")),
                ("seed", run.seed.to_string()),
                ("samples per pixel", or_none(run.samples_per_pixel.map(|most| most.to_string()))),
                ("error to be reached", or_none(run.error.map(|error| error.to_string()))),
                ("time in seconds", or_none(run.time_s.map(|time| time.to_string()))),
            ]
        };
        let pairs = facts(self).into_iter().zip(facts(other));
        pairs
            .filter(|((_, own), (_, others))| own != others)
            .map(|((what, own), (_, others))| match what {
                "channels" => format!("{what} {} and {}", self.channels.len(), other.channels.len()),
                _ => format!("{what} {own} and {others}"),
            })
            .collect()
    }
}

impl Checkpoint<'_> {
    /// The state, if it is of a run of this identity and fits it.
    ///
    /// # Errors
    /// Names everything that differs.
    pub fn state_of(self, identity: &Identity, budget: &Budget) -> Result<State> {
        let differences = self.identity.differences(identity);
        if !differences.is_empty() {
            let what = format!("it is of another run (there and here: {})", differences.join("; "));
            return Err(Error::new(what).hint(ANEW));
        }
        let Identity { resolution, channels, integrator, .. } = identity;
        let has_chains = integrator == Integrator::Mlt.name();
        let checked = self.state.check(*resolution, channels.len(), has_chains, budget);
        checked.map_err(|what| Error::new(format!("it cannot be gone on from: {what}")).hint(ANEW))?;
        Ok(self.state.into_owned())
    }
}

/// Writes a checkpoint; the one that was there before stays until it is whole.
///
/// # Errors
/// Where the file cannot be written.
pub fn write(path: &Path, identity: &Identity, state: &State) -> Result<()> {
    let checkpoint = Checkpoint { identity: identity.clone(), state: Cow::Borrowed(state) };
    write_whole(path, "checkpoint", |to| {
        let mut counted = Counted { to, sum: crc32fast::Hasher::new(), bytes: 0, failed: None };
        let written = write_parts(&mut counted, &checkpoint);
        // The reason of the system, where there is one, says more than that of the format.
        written.map_err(|format| counted.failed.map_or(format, |e| e.to_string()))
    })
}

fn write_parts<W: Write>(
    counted: &mut Counted<W>,
    checkpoint: &Checkpoint<'_>,
) -> std::result::Result<(), String> {
    let io = |e: std::io::Error| e.to_string();
    counted.write_all(&MAGIC).and_then(|()| counted.write_all(&VERSION.to_le_bytes())).map_err(io)?;
    let buffered = postcard::to_io(checkpoint, BufWriter::new(&mut *counted)).map_err(|e| e.to_string())?;
    buffered.into_inner().map_err(|e| e.to_string())?;
    let content = counted.bytes - HEADER_BYTES as u64;
    counted.write_all(&content.to_le_bytes()).map_err(io)?;
    let sum = counted.sum.clone().finalize();
    counted.write_all(&sum.to_le_bytes()).map_err(io)
}

/// Passes bytes on, counts and sums them, and keeps what went wrong.
struct Counted<W> {
    to: W,
    sum: crc32fast::Hasher,
    bytes: u64,
    failed: Option<std::io::Error>,
}

impl<W: Write> Write for Counted<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.to.write(bytes).inspect_err(|e| {
            self.failed.get_or_insert(std::io::Error::new(e.kind(), e.to_string()));
        })?;
        self.sum.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.to.flush()
    }
}

/// Reads a checkpoint from a file of at most `most_bytes`; `None` where there is no file.
///
/// # Errors
/// Those of [`read`], and where the file cannot be read.
pub fn read_file(path: &Path, most_bytes: u64) -> Result<Option<Checkpoint<'static>>> {
    let failed = |e: &std::io::Error| Error::io(path, "read the checkpoint", e);
    let file = match std::fs::File::open(path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        file => file.map_err(|e| failed(&e))?,
    };
    let metadata = file.metadata().map_err(|e| failed(&e))?;
    if !metadata.is_file() {
        return Err(Error::new("a checkpoint is a file").hint("name another one").in_file(path));
    }
    let mut bytes = Vec::new();
    // What is no checkpoint is not read farther than its head.
    (&file).take(HEADER_BYTES as u64).read_to_end(&mut bytes).map_err(|e| failed(&e))?;
    check_header(&bytes).map_err(|e| e.in_file(path))?;
    if metadata.len() > most_bytes {
        let what = format!("it has {} bytes, more than this run can have gathered", metadata.len());
        return Err(Error::new(what).hint(ANEW).in_file(path));
    }
    (&file).take(metadata.len()).read_to_end(&mut bytes).map_err(|e| failed(&e))?;
    read(&bytes).map(Some).map_err(|e| e.in_file(path))
}

/// Reads a checkpoint from all bytes of its file.
///
/// # Errors
/// Where the bytes are no checkpoint, are of another version of the format, are cut short, or
/// have changed since they were written.
pub fn read(bytes: &[u8]) -> Result<Checkpoint<'static>> {
    check_header(bytes)?;
    let short = || Error::new("the checkpoint is cut short").hint(ANEW);
    let rest = bytes.get(HEADER_BYTES..).ok_or_else(short)?;
    let (content, trailer) =
        rest.split_at_checked(rest.len().saturating_sub(TRAILER_BYTES)).ok_or_else(short)?;
    let (length, sum) = trailer.split_first_chunk::<8>().ok_or_else(short)?;
    let sum: [u8; 4] = sum.try_into().map_err(|_| short())?;
    if u64::from_le_bytes(*length) != content.len() as u64 {
        return Err(Error::new("the checkpoint is cut short, or its end has changed").hint(ANEW));
    }
    if crc32fast::hash(&bytes[..bytes.len() - sum.len()]) != u32::from_le_bytes(sum) {
        return Err(
            Error::new("the checkpoint has changed since it was written (its checksum is wrong)").hint(ANEW)
        );
    }
    decode(content)
}

/// Reads the content of a checkpoint, without what stands before and after it in the file.
///
/// # Errors
/// Where it is none.
pub fn decode(content: &[u8]) -> Result<Checkpoint<'static>> {
    let wrong = |what: String| Error::new(format!("the checkpoint cannot be decoded ({what})")).hint(ANEW);
    match postcard::take_from_bytes(content) {
        Ok((checkpoint, [])) => Ok(checkpoint),
        Ok((_, left)) => Err(wrong(format!("{} bytes are left over", left.len()))),
        Err(e) => Err(wrong(e.to_string().to_lowercase())),
    }
}

fn check_header(bytes: &[u8]) -> Result<()> {
    let Some(rest) = bytes.strip_prefix(&MAGIC) else {
        return Err(Error::new("it is no checkpoint").hint("name another file"));
    };
    match rest.first_chunk::<4>().map(|version| u32::from_le_bytes(*version)) {
        Some(VERSION) => Ok(()),
        Some(other) => {
            let what = format!("its format is version {other}, and this program reads version {VERSION}");
            Err(Error::new(what).hint("go on with the program that wrote it, or begin anew"))
        }
        None => Err(Error::new("the checkpoint is cut short").hint(ANEW)),
    }
}
