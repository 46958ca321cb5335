"""What is known of a case's calibration, and how well: `calibration.json` and the fit of its pose.

No photograph tells how well its lamp was measured. Such uncertainties are
declared per case with their source, or as assumed, so that a reader can dispute
a number instead of a conclusion. Each component has a pattern, which says what
it does to a picture and therefore which level of the ladder takes it up.
"""

from dataclasses import dataclass
from pathlib import Path

from .errors import InputError, meaning, read_json

# What a component multiplies or adds, and the level that removes it (None: none does).
PATTERNS = {
    "level": "L1", "channels": "L2", "mixture": "L3", "glare": "L4",
    "surfaces": None, "regions": None, "vignetting": None, "tone": None,
}
REMEDY = "see validation/README.md, Calibration"
# Standard uncertainty of where a region lies when no pose is at hand, pixels of the photograph.
UNKNOWN_PLACE_PX = 0.5


@dataclass(frozen=True)
class Component:
    """One calibration quantity and its relative standard uncertainty (standard deviation of its logarithm).

    `kind` is A or B as in JCGM 100 (by statistics, or by other means); `degrees_of_freedom` None means many.
    """

    name: str
    pattern: str
    u: float
    kind: str
    degrees_of_freedom: float | None
    source: str

    @property
    def removed_by(self):
        """The first level of the ladder that takes the component up; None where none does."""
        return PATTERNS[self.pattern]


@dataclass(frozen=True)
class Calibration:
    """All components of a case, and how well regions are placed (pixels per axis)."""

    components: tuple
    place_px: float
    place_freedom: float | None
    place_source: str
    declared: bool

    def find(self, pattern):
        """Root sum of squares of the components with a pattern."""
        return sum(component.u**2 for component in self.components if component.pattern == pattern) ** 0.5


def read_component(entry, path):
    """One component, or an `InputError` that names it."""
    with meaning(path, REMEDY):
        name = str(entry["name"])
    place = f'{path}: component "{name}"'
    with meaning(place, REMEDY):
        freedom = entry.get("degrees_of_freedom")
        component = Component(
            name, str(entry["pattern"]), float(entry["relative_standard_uncertainty"]), str(entry.get("kind", "B")),
            None if freedom is None else float(freedom), str(entry["source"]),
        )
    if component.pattern not in PATTERNS:
        raise InputError(place, f'unknown pattern "{component.pattern}"', "write one of " + ", ".join(PATTERNS))
    if component.kind not in ("A", "B"):
        raise InputError(place, f'unknown kind "{component.kind}"', "write A or B (JCGM 100)")
    if not 0 <= component.u < float("inf") or (freedom is not None and not component.degrees_of_freedom > 2):
        raise InputError(place, "its uncertainty is negative or its degrees of freedom are not above 2", "correct it")
    return component


def read_calibration(case):
    """The calibration of a case folder; without `calibration.json` nothing is declared, and the report says so."""
    case = Path(case)
    path = case / "calibration.json"
    place = placement(case / "pose.json")
    if not path.is_file():
        return Calibration((), *place, False)
    table = read_json(path, REMEDY)
    with meaning(path, REMEDY):
        entries = list(table["components"])
    components = tuple(read_component(entry, path) for entry in entries)
    names = [component.name for component in components]
    if len(set(names)) < len(names):
        raise InputError(path, "two components have one name", "rename one")
    return Calibration(components, *place, True)


def placement(path):
    """Standard uncertainty per axis of a projected point in pixels, its degrees of freedom, and where it is from.

    The fit's residuals scatter by s per coordinate; p parameters fitted to n points leave the projection of a
    point uncertain by s sqrt(p / 2n), the mean over the points (the trace of the hat matrix is p).
    """
    if not path.is_file():
        return UNKNOWN_PLACE_PX, None, f"assumed {UNKNOWN_PLACE_PX:g} px, no pose.json"
    pose = read_json(path, "run fit-pose")
    if "points" not in pose:
        return UNKNOWN_PLACE_PX, None, f"assumed {UNKNOWN_PLACE_PX:g} px, pose.json names no points"
    with meaning(path, "run fit-pose again"):
        coordinates, rms = 2 * int(pose["points"]), float(pose["rms_px"])
        fitted = [name for name in pose["models"][pose["chosen"]]["parameters"] if name != "horizontal_fov_deg"]
    freedom = coordinates - len(fitted)
    if freedom < 1:
        return rms, None, f"rms of {pose['points']} picked points"
    scatter = rms * (coordinates / 2 / freedom) ** 0.5
    return scatter * (len(fitted) / coordinates) ** 0.5, max(freedom, 3), f"pose fitted to {pose['points']} points with {rms:g} px rms"
