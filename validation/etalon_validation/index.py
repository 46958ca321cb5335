"""The index page over the reports of many cases: index.html and index.json.

Each case has a row, with its scores at every level of the fit ladder where it
has a report, with the reason where it failed or was left out. Links are
relative: the folder can be moved, and opens from a disk.
"""

import base64
import json
from pathlib import Path

from . import __version__
from .errors import InputError, meaning, read_json
from .page import today, write_page
from .report import environment

STATUSES = ("done", "failed", "skipped")
FIGURES = ("mean_duv", "rms_stops", "mean_delta_e_2000", "nrmse", "count")


def write_index(folder, text):
    """Writes both files from a request in JSON: version, command, and a row per case."""
    folder = Path(folder)
    with meaning("standard input", "send version, command and cases as JSON"):
        request = json.loads(text)
        rows = [row(folder, str(entry["case"]), str(entry["status"]), entry.get("reason")) for entry in request["cases"]]
        head = {"version": str(request["version"]), "command": str(request["command"])}
    done = [entry for entry in rows if entry["status"] == "done"]
    index = head | {
        "made": today(), "harness_version": __version__, "environment": environment(), "cases": rows,
        "seconds": sum(entry["seconds"] or 0 for entry in done), "cpu_seconds": sum(entry["cpu_seconds"] or 0 for entry in done),
        "counts": {status: sum(entry["status"] == status for entry in rows) for status in STATUSES},
    }
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "index.json").write_text(json.dumps(index, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    levels = list(dict.fromkeys(name for entry in rows for name in entry.get("levels", {})))
    titles = {name: entry["levels"][name]["title"] for entry in rows for name in entry.get("levels", {})}
    thumbnails = {entry["case"]: {kind: thumbnail(folder / entry["case"] / f"thumbnail-{kind}.png") for kind in ("render", "photo")} for entry in done}
    write_page(folder / "index.html", "index.html.jinja", index=index, levels=levels, titles=titles, thumbnails=thumbnails)
    return index


def row(folder, case, status, reason):
    """What the index says of a case, read from its report."""
    if status not in STATUSES:
        raise ValueError(f'unknown status "{status}"')
    if status != "done":
        return {"case": case, "status": status, "reason": reason}
    path = folder / case / "report.json"
    report = read_json(path, "run the case again")
    with meaning(path, "run the case again"):
        return {
            "case": case, "status": status, "reason": None, "report": f"{case}/report.html", "kind": report.get("kind", "photograph"),
            "scene": report["scene"], "against": against(report), "samples_per_pixel": report["samples_per_pixel"],
            "integrator": report.get("integrator"), "seconds": report["seconds"], "cpu_seconds": report["cpu_seconds"],
            "warnings": list(report.get("reference", {}).get("warnings", [])), "headline": headline(report),
            "levels": {name: {"title": level["title"]} | {key: level["overall"].get(key) for key in FIGURES} for name, level in report.get("levels", {}).items()},
            "exposure_stops": report.get("levels", {}).get("L1", {}).get("fitted", {}).get("exposure_stops"),
        }


def against(report):
    """In words, what the render was held against."""
    if report.get("kind") == "exposure":
        return "no photograph: exposure alone"
    if report.get("kind") == "cross":
        return f"{report['scored']} of {report['predicted']['file']}, fitted on {report['fitted_on']['file']}"
    reference = report.get("reference", {})
    kinds = {"photograph": "photograph", "region_table": "region table measured on", "bands": "band images"}
    return f"{kinds.get(reference.get('kind'), '')} {reference.get('file', '')}".strip()


def headline(report):
    """One sentence for a case that has no place on the common ladder, or None."""
    if report.get("kind") == "cross":
        return report["statements"][0]
    if report.get("kind") != "exposure":
        return None
    exposure = report["exposure"]
    noise = (exposure.get("noise") or {}).get("p50")
    said = f"{'well exposed' if exposure['well_exposed'] else 'not well exposed'}: {exposure['meter']['subject_stops']:+.2f} stops from the meter, {100 * exposure['shares']['subject']['clipped']:.2f} % clipped, {100 * exposure['shares']['subject']['black']:.2f} % black"
    return said + ("" if noise is None else f"; median noise {100 * noise:.1f} %")


def thumbnail(path):
    """The picture as a data URI, or None where there is none."""
    if not path.is_file():
        return None
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def find_photographs(folder, cases):
    """The photograph of each case (name to folder in `reference/`) below a folder: that of its SHA-256, else that of its name."""
    from .photograph import SUFFIXES, sha256_of

    folder = Path(folder)
    if not folder.is_dir():
        raise InputError(folder, "no such folder of photographs", "check the path")
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.suffix.lower() in SUFFIXES)
    known = {}
    for name, case in cases.items():
        table = read_json(Path(case) / "regions.json", "measure its regions first")
        with meaning(Path(case) / "regions.json", "measure its regions again"):
            known.setdefault(table["photo"]["sha256"], name)
    published = {path: known.get(sha256_of(path)) for path in files}
    found = {}
    for path, name in published.items():
        if name:
            found.setdefault(name, str(path))
    for path in (path for path, name in published.items() if name is None and path.stem in cases):
        found.setdefault(path.stem, str(path))
    if not found:
        raise InputError(folder, "holds the photograph of no case", "name each as its case, as in cornell.png")
    return found
