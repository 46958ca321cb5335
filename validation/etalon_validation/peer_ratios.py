"""How many times as efficient Etalon is as each peer: what the tables of a session are made of.

Efficiency is 1 / (relMSE x CPU seconds), so a ratio is that of CPU seconds at
equal error. Where a series' error is that of a few pixels (flag "heavy tail")
the ratio that counts is the trimmed one: the plain one is then a matter of
luck. The best of several series is picked by the figures themselves, on both
sides alike.
"""

from dataclasses import dataclass, replace

from .converge_data import Estimate
from .peer_agreement import DIFFERS
from .peer_study import ratio_between

PLAIN, TRIMMED = "relmse", "relmse_trimmed"


@dataclass(frozen=True)
class Ratio:
    """Efficiency of a series of Etalon over that of a peer's: with the seconds of rendering alone and of the whole process.

    `counts` is `rendering` or `rendering_trimmed`, by `is_trimmed`.
    """

    scene: str
    ours: str
    peer: str
    verdict: str
    rendering: Estimate | None
    rendering_trimmed: Estimate | None
    process: Estimate | None
    process_trimmed: Estimate | None
    is_trimmed: bool

    @property
    def counts(self):
        """The ratio that the headline is made of."""
        return self.rendering_trimmed if self.is_trimmed else self.rendering


def is_heavy(report):
    """Whether a series' error is that of a few pixels or of one repeat."""
    return any(flag.name == "heavy tail" for flag in report.flags)


def ratios(result):
    """A `Ratio` for each pair of a series of Etalon and one of a peer."""
    rendering, whole = ({report.name: report for report in reports} for reports in (result.rendering, result.whole))
    found = []
    for peer in result.peers:
        for ours in result.ours:
            pairs = {"rendering": (rendering[ours], rendering[peer]), "process": (whole[ours], whole[peer])}
            values = {key + suffix: ratio_between(*pair, kind) for key, pair in pairs.items() for suffix, kind in (("", PLAIN), ("_trimmed", TRIMMED))}
            found.append(Ratio(result.name, ours, peer, result.agreements[peer].verdict, **values, is_trimmed=any(map(is_heavy, pairs["rendering"]))))
    return found


def headline(result):
    """For each peer the `Ratio` of Etalon's best series over the peer's best that renders the scene correctly.

    A peer that renders another picture with all its series has its best one here all the same, with the verdict.
    """
    found, every = [], ratios(result)
    for name in dict.fromkeys(row.peer.split()[0] for row in every):
        rows = [row for row in every if row.peer.split()[0] == name and row.counts is not None]
        rows = [row for row in rows if row.verdict != DIFFERS] or rows
        if not rows:
            continue
        # All by one measure, so that picking is fair.
        is_trimmed = any(row.is_trimmed for row in rows)
        # What has no value by that measure cannot be picked; a row that is trimmed of itself has one.
        rows = [replace(row, is_trimmed=is_trimmed) for row in rows]
        rows = [row for row in rows if row.counts is not None]
        ours = max({row.ours for row in rows}, key=lambda name: max(row.counts.value for row in rows if row.ours == name))
        found.append(min((row for row in rows if row.ours == ours), key=lambda row: row.counts.value))
    return found
