"""Which LLVM library Mitsuba's compiled variant can use: found by trying.

Versions that Dr.Jit takes may still abort the process in the middle of a
kernel, so each candidate renders a small picture in a process of its own, the
newest first. Nothing is installed.
"""

import os
import re
import resource
import subprocess
import tempfile
from pathlib import Path

from .peer_mitsuba import LLVM

LIBRARY = "DRJIT_LIBLLVM_PATH"
# Dr.Jit refuses what is older.
OLDEST = 15
PLACES = (
    "/usr/lib/*-linux-gnu", "/usr/lib64", "/usr/lib", "/usr/lib/llvm-*/lib", "/usr/local/lib",
    "/opt/homebrew/opt/llvm*/lib", "/usr/local/opt/llvm*/lib",
)
NAMES = ("libLLVM*.so*", "libLLVM*.dylib")
VERSION = re.compile(r"libLLVM(?:-|\.so\.|\.)(\d+)")
LONGEST_TRIAL_S = 120


def candidates(places=PLACES):
    """Libraries that may do, the newest version first, each once."""
    found = {}
    for place in places:
        pattern = Path(place)
        for name in NAMES:
            for file in Path(pattern.anchor).glob(str(pattern.relative_to(pattern.anchor) / name)):
                version = VERSION.match(file.resolve().name) or VERSION.match(file.name)
                if version and int(version.group(1)) >= OLDEST:
                    found.setdefault(file.resolve(), int(version.group(1)))
    return sorted(found, key=lambda file: -found[file])


def usable(command, environment, libraries=None):
    """The first library with which `command(output, times)` ends well, or `None`; and why in words.

    `command` gives the words of a small run of the compiled variant, which needs `environment`.
    """
    given = os.environ.get(LIBRARY)
    libraries = libraries if libraries is not None else [Path(given)] if given else candidates()
    if not libraries:
        return None, f"no LLVM of version {OLDEST} or newer was found for {LLVM} (set {LIBRARY} to one)"
    reasons = []
    for library in libraries:
        reason = trial(command, environment, library)
        if reason is None:
            return library, f"{LLVM} with {library.name}"
        reasons.append(f"{library.name} {reason}")
    return None, f"{LLVM} is left out: {'; '.join(reasons)} (set {LIBRARY} to another, as of Debian's libllvm19)"


def trial(command, environment, library):
    """Why the small run fails with a library; `None` where it ends well."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "trial.exr"
        words = [str(word) for word in command(output, Path(folder) / "times.json")]
        try:
            done = subprocess.run(words, env=os.environ | environment | {LIBRARY: str(library)}, capture_output=True, timeout=LONGEST_TRIAL_S, preexec_fn=no_core, check=False)
        except subprocess.TimeoutExpired:
            return f"did not end within {LONGEST_TRIAL_S} s"
        if done.returncode < 0:
            return f"aborts the process (signal {-done.returncode})"
        return None if done.returncode == 0 and output.is_file() else "is refused"


def no_core():
    """A library that aborts should not leave a core file."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
