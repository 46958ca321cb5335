"""What is varied, what a run tells, and what a point of an axis comes to."""

from dataclasses import asdict, dataclass

# Relative error of the luminance picture that times are told for; every report has it.
TARGET_ERROR = 0.05


@dataclass(frozen=True)
class Axis:
    """A quantity that is varied, all else kept."""

    name: str
    # What the plot says below the axis.
    label: str
    values: tuple
    integrators: tuple


@dataclass(frozen=True)
class Setting:
    """What is rendered at a point of an axis."""

    axis: str
    integrator: str
    # The value as the axis lists it, and as it is counted: a mesh has about as many triangles as asked for.
    value: int
    counted: int
    scene: str
    # Width and height in pixels.
    size: tuple
    threads: int
    # Further options of the program.
    options: tuple = ()

    @property
    def pixels(self):
        return self.size[0] * self.size[1]


@dataclass(frozen=True)
class Run:
    """One render, as its report tells; seconds are of processors unless named otherwise."""

    spp: int
    seed: int
    load_cpu_s: float
    render_cpu_s: float
    render_wall_s: float
    # Relative mean squared error of the luminance picture.
    relmse: float
    # CPU seconds from the start to the relative error `TARGET_ERROR`.
    to_error_cpu_s: float
    # None where the system does not tell.
    peak_bytes: int | None

    @property
    def total_cpu_s(self):
        return self.load_cpu_s + self.render_cpu_s


@dataclass(frozen=True)
class Estimate:
    """A figure with its 95 % interval; `low` and `high` are None where nothing is known of its error."""

    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Point:
    """Means over the runs of a setting: geometric ones, since all are compared as ratios."""

    value: int
    runs: int
    spp: int
    # CPU seconds of a sample of a pixel.
    cpu_s_per_sample: Estimate
    wall_s_per_sample: Estimate
    load_cpu_s: Estimate
    relmse_per_sample: Estimate
    to_error_cpu_s: Estimate
    peak_bytes: Estimate | None

    def as_json(self):
        return asdict(self)


# What is fitted and drawn, with the words of the plot.
QUANTITIES = {
    "to_error_cpu_s": f"CPU s to {100 * TARGET_ERROR:g} % error",
    "cpu_s_per_sample": "CPU s per sample",
    "load_cpu_s": "CPU s to load",
    "peak_bytes": "peak memory, bytes",
}


@dataclass(frozen=True)
class Series:
    """The points of an integrator on an axis, by value; and what was left out, with the reason."""

    axis: Axis
    integrator: str
    points: tuple
    left_out: dict
    # Exponent of each quantity; None below three points.
    exponents: dict
