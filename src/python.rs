//! The Python side: a virtual environment below `target/`, made when first needed from
//! pinned requirements and used again after.

use crate::error::{Error, Result};
use std::ffi::OsStr;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A set of pinned requirements and the folder name of its environment.
#[derive(Clone, Copy, Debug)]
pub struct Requirements {
    /// File below the project's root.
    pub file: &'static str,
    /// Folder below `target/`.
    pub folder: &'static str,
}

/// What reports and plots need.
pub const VALIDATION: Requirements =
    Requirements { file: "validation/requirements.txt", folder: "python-validation" };

/// What the comparison with other renderers needs.
pub const PEERS: Requirements =
    Requirements { file: "validation/requirements-peers.txt", folder: "python-peers" };

/// What opens the reports in a browser.
pub const BROWSER: Requirements =
    Requirements { file: "validation/requirements-browser.txt", folder: "python-browser" };

/// The folder with `validation/` and `reference/`: the one that cargo runs in, or the one
/// that the program was built from.
pub fn project_root() -> Result<PathBuf> {
    let built_from = env!("CARGO_MANIFEST_DIR");
    let root =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(built_from), PathBuf::from);
    if root.join("validation").is_dir() && root.join("reference").is_dir() {
        return Ok(root);
    }
    Err(Error::new("the project's folder with validation/ and reference/ is not there")
        .hint("run this from a clone, as in: cargo run --release -- validate cornell")
        .in_file(&root))
}

/// A virtual environment that is ready to run.
#[derive(Clone, Debug)]
pub struct Environment {
    python: PathBuf,
    root: PathBuf,
}

impl Environment {
    /// The environment for a set of requirements; made now if it is not there or if the
    /// requirements have changed.
    pub fn prepare(requirements: &Requirements) -> Result<Self> {
        let root = project_root()?;
        let file = root.join(requirements.file);
        let pinned =
            std::fs::read_to_string(&file).map_err(|e| Error::io(&file, "read the requirements", &e))?;
        let folder = root.join("target").join(requirements.folder);
        let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
        let stamp = folder.join("requirements.installed");
        let environment = Self { python, root };
        std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, "make the folder", &e))?;
        // One process at a time: tests and commands may want the environment together.
        let lock_path = folder.with_extension("lock");
        let lock =
            std::fs::File::create(&lock_path).map_err(|e| Error::io(&lock_path, "make the lock", &e))?;
        lock.lock().map_err(|e| Error::io(&lock_path, "take the lock", &e))?;
        if std::fs::read_to_string(&stamp).is_ok_and(|installed| installed == pinned) {
            return Ok(environment);
        }
        environment.install(&folder, &file)?;
        std::fs::write(&stamp, pinned).map_err(|e| Error::io(&stamp, "write the stamp", &e))?;
        Ok(environment)
    }

    fn install(&self, folder: &Path, requirements: &Path) -> Result<()> {
        eprintln!("setting up Python in {} (once)", folder.display());
        let python = ["python3.11", "python3", "python"]
            .into_iter()
            .find(|name| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success()))
            .ok_or_else(|| {
                Error::new("Python was not found").hint("install Python 3.11 or newer with its venv module")
            })?;
        finish(
            Command::new(python).args(["-m", "venv", "--clear"]).arg(folder),
            "make the virtual environment",
        )?;
        let mut pip = Command::new(&self.python);
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"]).arg(requirements);
        finish(&mut pip, "install the Python requirements")
    }

    /// Runs a command of the harness, its output going to ours; `input` goes to its standard
    /// input.
    ///
    /// # Errors
    /// Where it exits with anything but 0; with 2, the user's fault, the last line that it wrote
    /// on standard error becomes the error.
    pub fn run_module<W: AsRef<OsStr>>(
        &self,
        command: &str,
        words: &[W],
        input: Option<&str>,
    ) -> anyhow::Result<()> {
        must_succeed(command, self.talk(command, words, input, Stdio::inherit())?).map(drop)
    }

    /// Runs a command of the harness that comes to a verdict: whether it exits with 0; with 1, it
    /// has said on standard error what it found.
    ///
    /// # Errors
    /// Those of [`Environment::run_module`] for other exit codes.
    pub fn judge_module<W: AsRef<OsStr>>(&self, command: &str, words: &[W]) -> anyhow::Result<bool> {
        match self.talk(command, words, None, Stdio::inherit())? {
            (Some(1), _) => Ok(false),
            ended => must_succeed(command, ended).map(|_| true),
        }
    }

    /// What a command of the harness writes on standard output.
    ///
    /// # Errors
    /// Those of [`Environment::run_module`].
    pub fn ask_module<W: AsRef<OsStr>>(&self, command: &str, words: &[W]) -> anyhow::Result<String> {
        must_succeed(command, self.talk(command, words, None, Stdio::piped())?)
    }

    /// The exit code of a command, and what it wrote on standard output if that is piped.
    fn talk<W: AsRef<OsStr>>(
        &self,
        command: &str,
        words: &[W],
        input: Option<&str>,
        stdout: Stdio,
    ) -> anyhow::Result<(Option<i32>, String)> {
        let mut python = self.harness();
        python.arg("-m").arg("etalon_validation").arg(command).args(words);
        python.stdout(stdout).stderr(Stdio::piped());
        python.stdin(if input.is_some() { Stdio::piped() } else { Stdio::null() });
        let mut child = python.spawn()?;
        // A harness that has already refused its arguments no longer listens.
        if let (Some(text), Some(mut stdin)) = (input, child.stdin.take()) {
            let _ = stdin.write_all(text.as_bytes());
        }
        let output = child.wait_with_output()?;
        let said = String::from_utf8_lossy(&output.stderr);
        let (before, last) = said.trim_end().rsplit_once('\n').unwrap_or(("", said.trim_end()));
        let refused = output.status.code() == Some(2);
        for line in before.lines().chain((!refused).then_some(last).filter(|line| !line.is_empty())) {
            eprintln!("{line}");
        }
        match output.status.code() {
            Some(2) => Err(Error::new(last.strip_prefix("error: ").unwrap_or(last)).into()),
            code => Ok((code, String::from_utf8_lossy(&output.stdout).into_owned())),
        }
    }

    /// The interpreter with the harness on its path.
    pub fn harness(&self) -> Command {
        let mut python = Command::new(&self.python);
        python.env("PYTHONPATH", self.root.join("validation")).env("PYTHONDONTWRITEBYTECODE", "1");
        python
    }
}

/// What a command wrote, where it ended well.
fn must_succeed(command: &str, (code, written): (Option<i32>, String)) -> anyhow::Result<String> {
    if code == Some(0) {
        return Ok(written);
    }
    anyhow::bail!("the harness failed at \"{command}\" (exit code {code:?})")
}

fn finish(command: &mut Command, what: &str) -> Result<()> {
    let output = command.stdin(Stdio::null()).output();
    let output = output.map_err(|e| Error::new(format!("cannot {what}: {e}")))?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let last = said.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no message");
    Err(Error::new(format!("cannot {what}: {last}"))
        .hint("check the network, and that Python has pip and venv"))
}
