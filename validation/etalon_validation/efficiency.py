"""Error against processor time: one integrator against another on one scene, by a reference."""

import resource
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError
from .render import read_render

# Share of the mean luminance whose square keeps black pixels from counting without bound.
FLOOR_SHARE = 0.01
# Share of the pixels, those with the largest terms, that the trimmed error leaves out.
TRIMMED_SHARE = 0.001
# Seed of the first repeat; the next ones follow. The reference is rendered with another.
FIRST_SEED = 1
# Samples per pixel that an integrator gets however slow it is.
FEWEST_SAMPLES = 4


@dataclass(frozen=True)
class Run:
    """Processor seconds of a render, and its relative mean squared errors."""

    cpu_s: float
    plain: float
    trimmed: float


def relative_mse(image, reference):
    """Mean of (I - R)^2 / (R^2 + (1 % of the mean)^2), and the same without its largest terms."""
    return plain_and_trimmed((image - reference) ** 2 / (reference**2 + floor_of(reference)))


def floor_of(reference):
    """What is added to the square of a pixel's luminance before errors are divided by it."""
    return (FLOOR_SHARE * reference.mean()) ** 2


def plain_and_trimmed(terms):
    """Mean of the pixels' terms, and the same without the largest."""
    terms = np.sort(terms.ravel())
    kept = terms.size - max(1, round(TRIMMED_SHARE * terms.size))
    return float(terms.mean()), float(terms[:kept].mean())


def timed_render(program, scene, integrator, spp, seed, resolution, folder):
    """Luminance of a render, and the processor seconds that it took, load included.

    Without a resolution the scene's own is used.
    """
    output = Path(folder) / "run.exr"
    command = [program, "render", scene, "-o", output, "--integrator", integrator, "--spp", spp, "--seed", seed]
    if resolution:
        command += ["--resolution", resolution]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise InputError(scene, done.stderr.strip() or "cannot be rendered", "render it by hand to see why")
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return read_render(output).xyz[..., 1], cpu_s


def samples_at_equal_time(render, integrators, spp):
    """Samples per pixel that take as long as `spp` of the first integrator, by a first run of each."""
    first = render(integrators[0], spp, FIRST_SEED)[1]
    samples = {integrators[0]: spp}
    for integrator in integrators[1:]:
        samples[integrator] = max(FEWEST_SAMPLES, round(spp * first / render(integrator, spp, FIRST_SEED)[1]))
    return samples


def compare(program, scene, reference_file, integrators, spp, repeats):
    """Runs of each integrator at equal processor time, in turns, so that the machine's moods cancel.

    The first integrator takes `spp` samples per pixel; the others as many as fit the same time.
    """
    reference = read_render(reference_file)
    luminance = reference.xyz[..., 1]
    resolution = "{}x{}".format(*reference.size)
    runs = {integrator: [] for integrator in integrators}
    with tempfile.TemporaryDirectory() as folder:

        def render(integrator, count, seed):
            return timed_render(program, scene, integrator, count, seed, resolution, folder)

        samples = samples_at_equal_time(render, integrators, spp)
        for repeat in range(repeats):
            for integrator in integrators:
                image, cpu_s = render(integrator, samples[integrator], FIRST_SEED + repeat)
                runs[integrator].append(Run(cpu_s, *relative_mse(image, luminance)))
    return samples, runs


def describe(samples, runs):
    """A line per integrator, and by how much the error at equal time is below that of the first."""
    lines = []
    mean = {
        name: [np.mean([getattr(run, field) for run in found]) for field in ("cpu_s", "plain", "trimmed")]
        for name, found in runs.items()
    }
    base = next(iter(mean.values()))
    for name, (cpu_s, plain, trimmed) in mean.items():
        ratios = [base[0] * base[index] / (cpu_s * value) for index, value in ((1, plain), (2, trimmed))]
        lines.append(
            f"{name}: {samples[name]} spp, {cpu_s:.2f} CPU s, relMSE {plain:.5f}, trimmed {trimmed:.5f}; "
            f"{ratios[1]:.2f} times lower at equal time (plain {ratios[0]:.2f})"
        )
    return "\n".join(lines)
