"""Another renderer as a series of the convergence study: its table, its pictures, its unit.

Renderers differ in definition (pixel filter, observer, the constant that Y is
divided by), and each converges to its own picture. A peer is therefore judged
against a converged picture of its own where it has one, which asks how fast it
gets there, and in any case against the common reference, which asks where it
goes. Relative errors against its own do not depend on its unit.
"""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from .converge_analysis import report_on
from .converge_data import Run, Series
from .converge_reference import FileReference, file_reference
from .errors import InputError
from .peer_picture import Picture, fitted_factor, read_picture
from .peer_table import PeerTable, read_table

LEVEL_FITTED = " (level fitted)"
LONGEST_NAME = 40


@dataclass(frozen=True)
class PeerOption:
    """What the command line says of one peer: `--peer`, `--peer-scale`, `--peer-reference`."""

    name: str
    file: Path
    scale: float | None = None
    reference: Path | None = None


@dataclass(frozen=True)
class Peer:
    """A peer's runs in cd/m2, its own reference or `None`, and what reports say of unit and reference."""

    series: Series
    own: FileReference | None
    facts: dict

    @property
    def sentence(self):
        """Unit and reference in words, for the terminal and below the plot."""
        facts = self.facts
        level = f"one factor {facts['factor']:.6g} fitted on {facts['fitted_on']}: its level is not tested" if facts["is_fitted"] else f"level by {facts['unit']}"
        return f"{facts['name']}: luminance from {facts['luminance_from']}, {level}; judged against {facts['judged_against']}"


def peer_options(peers, scales, references):
    """Peers by the words `NAME=VALUE` of the three options; an `InputError` names the one that is wrong."""
    found = {}
    for name, value in pairs("--peer", peers, "NAME=FILE.csv"):
        found[name] = {"name": name, "file": Path(value)}
    for option, key, words, form in (("--peer-scale", "scale", scales, "NAME=K"), ("--peer-reference", "reference", references, "NAME=REF.exr")):
        for name, value in pairs(option, words, form):
            if name not in found:
                raise InputError(f"{option} {name}={value}", f'there is no peer "{name}"', f"add --peer {name}=FILE.csv")
            found[name][key] = Path(value) if key == "reference" else positive(option, name, value)
    return tuple(PeerOption(**peer) for peer in found.values())


def pairs(option, words, form):
    """Name and value of each word; every name once."""
    found = {}
    for word in words or ():
        name, equals, value = word.partition("=")
        name = name.strip()
        if not (equals and name and value) or len(name) > LONGEST_NAME or not name.isprintable():
            raise InputError(f"{option} {word}", f"is not {form}", f"give a name of up to {LONGEST_NAME} letters, an equals sign and the value")
        if name in found:
            raise InputError(f"{option} {word}", f'"{name}" is given twice', "give every peer a name of its own")
        found[name] = value
    return found.items()


def positive(option, name, value):
    """cd/m2 per unit of a peer's files."""
    try:
        number = float(value)
    except ValueError:
        number = np.nan
    if not (number > 0 and np.isfinite(number)):
        raise InputError(f"{option} {name}={value}", f'"{value}" is no positive number', "give cd/m2 per unit of the files")
    return number


@dataclass(frozen=True)
class Loaded:
    """A peer's table and pictures, before their unit is settled; its own picture and where that is named, or `None`."""

    option: PeerOption
    table: PeerTable
    pictures: tuple
    own: Picture | None
    own_place: str | None


def load_peer(option, size, taken=()):
    """Reads all that a peer names; `size` is (width, height) of the study's pictures, `taken` its other series."""
    if option.name in taken:
        raise InputError(f"--peer {option.name}={option.file}", f'"{option.name}" is an integrator of this study', "give the peer another name")
    table = read_table(option.name, option.file)
    pictures = tuple(sized(read_picture(row.file, row.place, option.scale or row.scale), row.place, size) for row in table.rows)
    own, own_place = own_picture(option, table, size)
    loaded = Loaded(option, table, pictures, own, own_place)
    check_units(loaded)
    return loaded


def check_units(loaded):
    """Refuses a table in which some pictures say their unit and others do not."""
    stated = [picture.factor is not None for picture in loaded.pictures]
    remedy = f"give --peer-scale {loaded.option.name}=K, or a column scale"
    if any(stated) and not all(stated):
        row, other = loaded.table.rows[stated.index(False)], loaded.table.rows[stated.index(True)]
        raise InputError(row.place, f"{row.file} does not say its unit, {other.file} does", remedy)
    if loaded.own is not None and all(stated) and loaded.own.factor is None:
        raise InputError(loaded.own_place, f"{loaded.own.file} does not say its unit, the pictures do", remedy)


def settle_peer(loaded, common):
    """The `Peer` in cd/m2, by the common reference's luminance (height, width) where a factor must be fitted."""
    option, table, pictures, own = loaded.option, loaded.table, loaded.pictures, loaded.own
    factors, fitted_on = settle(table, pictures, own, common)
    name = option.name + (LEVEL_FITTED if fitted_on else "")
    images = np.stack([picture.scaled(factor)[0] for picture, factor in zip(pictures, factors)]).astype(np.float32)
    reference = file_reference(own, own.factor or factors[0], loaded.own_place) if own else None
    units = list(dict.fromkeys(picture.unit for picture in pictures))
    facts = {
        "name": option.name, "table": str(option.file), "runs": len(pictures), "points": len(table.points),
        "luminance_from": pictures[0].weights, "unit": "; ".join(units), "is_fitted": bool(fitted_on), "fitted_on": fitted_on,
        "factor": factors[0] if len(set(factors)) == 1 else None,
        "judged_against": f"its own reference {own.file.name}" if own else "the common reference",
        "own_reference": reference and reference.facts(),
    }
    return Peer(Series(name, runs_of(name, table), images, is_foreign=True), reference, facts)


def peers_in_report(peers, reference):
    """What converge.json says of peers; of those with a reference of their own also how far they are from the common one."""
    found = {}
    for peer in peers:
        bias = report_on(peer.series, reference).bias if peer.own else None
        found[peer.series.name] = peer.facts | {"sentence": peer.sentence, "against_common_reference": bias and asdict(bias)}
    return found


def sized(picture, place, size):
    """The picture, if it has the size (width, height) of the study."""
    if picture.size != tuple(size):
        found, wanted = (f"{width}x{height}" for width, height in (picture.size, size))
        raise InputError(place, f"{picture.file} is {found} pixels, the reference {wanted}", "render the peer at the size of the reference")
    return picture


def own_picture(option, table, size):
    """The peer's own converged picture and where it is named; the command line goes before the table."""
    if option.reference:
        place = f"--peer-reference {option.name}={option.reference}"
        return sized(read_picture(option.reference, place, option.scale), place, size), place
    if table.reference:
        place = table.reference_place
        return sized(read_picture(table.reference, place, option.scale or table.reference_scale), place, size), place
    return None, None


def settle(table, pictures, own, common):
    """cd/m2 per unit of each picture, and what a factor was fitted on, `None` where none was.

    One factor for all: by the peer's own reference if that is without unit too,
    else by the mean of the repeats of its last point.
    """
    if pictures[0].factor is not None:
        return [picture.factor for picture in pictures], None
    if own and own.factor is None:
        factor, fitted_on = fitted_factor(own.luminance, own.file, common), f"its own reference {own.file.name}"
    else:
        last = [picture.luminance for picture in pictures[-len(table.points[-1]):]]
        factor, fitted_on = fitted_factor(np.mean(last, axis=0), table.rows[-1].file, common), f"the mean of the {len(last)} pictures of its last point"
    return [factor] * len(pictures), fitted_on


def runs_of(name, table):
    """The rows as runs, in the order of the table's points."""
    return tuple(
        Run(
            series=name, point=index, repeat=repeat, cpu_s=row.cpu_s, wall_s=row.wall_s, spp=row.spp,
            load_cpu_s=row.load_cpu_s, load_wall_s=row.load_wall_s,
            render_cpu_s=None if row.load_cpu_s is None else row.cpu_s - row.load_cpu_s,
            render_wall_s=None if row.load_wall_s is None else row.wall_s - row.load_wall_s,
            file=str(row.file),
        )
        for index, point in enumerate(table.points) for repeat, row in enumerate(point)
    )
