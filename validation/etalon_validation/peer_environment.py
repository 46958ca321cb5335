"""Where peers live: below the project's `target/`, made when first needed and used again after.

A stamp beside each says what it was made from, so that other pins make it
anew; a lock lets one process at a time make it. Downloads go through pip and
cargo as the machine has them set up. What cannot be made is one line.
"""

import contextlib
import fcntl
import os
import subprocess
import sys
from pathlib import Path

from .errors import InputError

REQUIREMENTS = Path(__file__).parents[1]
# Programs that a build runs for itself may compute much, and by default are not optimised; what is built stays the same.
BUILD_SCRIPTS = {"CARGO_PROFILE_RELEASE_BUILD_OVERRIDE_OPT_LEVEL": "3"}


def python_environment(target, folder, requirements):
    """The interpreter of the virtual environment `target/folder`, which has what the file `requirements` of `validation/` pins."""
    place, file = Path(target) / folder, REQUIREMENTS / requirements
    python = place / "bin" / "python"
    with making(place, file.read_text(encoding="utf-8"), "requirements.installed") as is_made:
        if not is_made:
            say(f"setting up Python in {place} (once)")
            finish([sys.executable, "-m", "venv", "--clear", place], place, "install Python with its venv module")
            finish([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", file], place, "check the network")
    return python


def cargo_program(target, folder, crate, version, words=()):
    """The program of a crate of this version, built from source below `target/folder` with these words for cargo."""
    place = Path(target) / folder
    program = place / "bin" / crate
    pinned = " ".join([crate, version, *words]) + "\n"
    with making(place, pinned, "program.installed") as is_made:
        if not is_made:
            say(f"building {crate} {version} in {place} (once, some minutes)")
            built = [os.environ.get("CARGO", "cargo"), "install", crate, "--version", version, "--locked", "--bin", crate, *words, "--root", place]
            finish(built, place, "install Rust, and check the network", BUILD_SCRIPTS)
    if not program.is_file():
        raise InputError(program, "is not there although it was built", f"remove {place} and run this again")
    return program


@contextlib.contextmanager
def making(place, pinned, stamp):
    """Whether `place` has been made from `pinned`, alone with it; at the end its stamp says that it has."""
    place.mkdir(parents=True, exist_ok=True)
    with open(place.with_name(f"{place.name}.lock"), "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        file = place / stamp
        is_made = file.is_file() and file.read_text(encoding="utf-8") == pinned
        yield is_made
        if not is_made:
            file.write_text(pinned, encoding="utf-8")


def finish(words, place, remedy, environment=None):
    """Runs a command to its end, with more in its environment; an `InputError` with its last words if it fails."""
    try:
        done = subprocess.run([str(word) for word in words], stdin=subprocess.DEVNULL, env=os.environ | (environment or {}), capture_output=True, text=True, check=False)
    except OSError as error:
        raise InputError(place, f"cannot be made ({os.path.basename(str(words[0]))}: {error.strerror})", remedy) from None
    if done.returncode:
        said = [line.strip() for line in done.stderr.splitlines() if line.strip()]
        raise InputError(place, f"cannot be made ({said[-1] if said else f'exit code {done.returncode}'})", remedy)


def say(words):
    """Tells what takes long, where no output of a command is expected."""
    print(words, file=sys.stderr)
