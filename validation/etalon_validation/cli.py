"""The command line: arguments to work, and every failure to one line on stderr."""

import argparse
import json
import sys
from pathlib import Path

from .converge_cli import add_converge
from .errors import InputError
from .growth_cli import add_growth
from .pages_cli import add_commands
from .peer_cli import add_peer_commands

# Samples per pixel of the peer.
PEER_SPP = 4096
# Exit code when an input file or an argument is wrong.
WRONG_INPUT = 2


def parser():
    """All subcommands and their arguments."""
    top = argparse.ArgumentParser(prog="etalon_validation", description="Compares an Etalon render with measured references.")
    commands = top.add_subparsers(dest="command", required=True)

    score = commands.add_parser("score", help="score a render against a photograph or its region table")
    score.add_argument("--case", type=Path, required=True, help="case folder with regions.json")
    score.add_argument("--render", type=Path, required=True, help="EXR written by etalon")
    score.add_argument("--photo", type=Path, help="the photograph; without it the region table stands in")
    score.add_argument("--flat-field", type=Path, help="picture of an even field by the photograph's lens; goes before the render's vignetting")
    score.add_argument("--force-registration", action="store_true", help="score a photograph whose registration failed, and mark every figure")
    score.add_argument("-o", "--output", type=Path, required=True, help="folder for report.json and report.html")
    score.set_defaults(run=run_score)

    measure = commands.add_parser("measure-regions", help="measure the region table on a photograph")
    measure.add_argument("--case", type=Path, required=True, help="case folder with layout.json")
    measure.add_argument("--photo", type=Path, required=True)
    measure.add_argument("--overlay", type=Path, help="also draw the regions over the photograph, to be looked at")
    measure.set_defaults(run=run_measure)

    pose = commands.add_parser("fit-pose", help="fit the photograph's camera to points.csv and write pose.json")
    pose.add_argument("--case", type=Path, required=True, help="case folder with points.csv and layout.json")
    pose.set_defaults(run=run_pose)

    register = commands.add_parser("register", help="lay the edges of the render over the photograph: verdict and refined pose")
    register.add_argument("--case", type=Path, required=True, help="case folder with scene.json, layout.json and pose.json")
    register.add_argument("--render", type=Path, required=True, help="EXR written by etalon")
    register.add_argument("--photo", type=Path, required=True)
    register.add_argument("--flat-field", type=Path, help="picture of an even field by the photograph's lens")
    register.add_argument("-o", "--output", type=Path, help="JSON file to write")
    register.set_defaults(run=run_register)

    selftest = commands.add_parser("self-test", help="take a synthetic photograph with a known answer apart")
    selftest.add_argument("--program", type=Path, default=Path("target/release/etalon"), help="the program etalon")
    selftest.add_argument("--case", type=Path, default=Path("reference/cornell-photo"), help="case folder to make the photograph from")
    selftest.add_argument("--spp", type=positive, default=128, help="samples per pixel of both renders")
    selftest.add_argument("--seeds", type=positive, default=8, help="seeds of picking and sensor noise")
    selftest.add_argument("-o", "--output", type=Path, required=True, help="folder for self-test.json and the renders")
    selftest.set_defaults(run=run_self_test)

    peers = commands.add_parser("peers", help="compare an all-diffuse render with Mitsuba 3 in absolute XYZ")
    peers.add_argument("--case", type=Path, default=Path("reference/cornell"), help="case folder with scene.json")
    peers.add_argument("--spectra", type=Path, default=Path("spectra"), help="folder of spectral tables")
    peers.add_argument("--render", type=Path, required=True)
    peers.add_argument("-o", "--output", type=Path, required=True)
    peers.add_argument("--spp", type=int, default=PEER_SPP, help="samples per pixel of the peer")
    peers.add_argument("--threads", type=positive, help="threads of the peer; all processors if left out")
    peers.set_defaults(run=run_peers)

    add_converge(commands)
    add_growth(commands)

    savings = commands.add_parser("plan-savings", help="measure what plans leave out, and write validation/plan.md")
    savings.add_argument("--program", type=Path, default=Path("target/release/etalon"), help="the program etalon")
    savings.set_defaults(run=run_plan_savings)

    plot = commands.add_parser("plot-spectrum", help="draw the spectral table described on standard input")
    plot.add_argument("file", type=Path, help="SVG or PNG to write")
    plot.set_defaults(run=run_plot)
    add_commands(commands)
    add_peer_commands(commands)
    return top


def positive(text):
    """A whole number above zero, as argparse wants it."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not above zero")
    return number


def main(arguments=None):
    """Runs one subcommand and returns the exit code."""
    chosen = parser().parse_args(arguments)
    try:
        return chosen.run(chosen) or 0
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return WRONG_INPUT
    except BrokenPipeError:
        return 0
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}; check the path and its permissions", file=sys.stderr)
        return WRONG_INPUT


def run_score(chosen):
    """report.json, report.html and one printed line per level."""
    from .calibration import read_calibration
    from .perceptual import inside_box
    from .linearity import in_words as in_words_of, noise_exponent
    from .photograph import LINEAR, read_photograph
    from .regions import read_table
    from .reference import choose_reference
    from .registration import mark_failed, refuse_unless_registered, register, regions_in_render, registration, registration_warning
    from .render import check_scene, read_render
    from .report import write_report
    from .score import score
    from .maps import resized
    from .thumbnails import write_pair

    table = read_table(chosen.case / "regions.json")
    render = read_render(chosen.render)
    check_scene(render, chosen.case)
    photograph, found, failed = None, None, None
    if chosen.photo:
        photograph = without_lens(chosen, read_photograph(chosen.photo), render)
        found = register(chosen.case, photograph, render)
        failed = refuse_unless_registered(found, photograph, chosen.force_registration)
    regions, reference = choose_reference(table, photograph)
    inside = inside_box(chosen.case, table.size)
    reference["noise"] = None
    if photograph is not None and photograph.encoding == LINEAR and inside is not None:
        reference["noise"] = noise_exponent(photograph.rgb, inside)
    if reference["noise"]:
        sentence, against = in_words_of(photograph.file, reference["noise"])
        reference["warnings"] += [sentence] * against
    if photograph is None:
        regions, reference["corrections"] = regions_without_lens(chosen, regions, table, render)
    reference["registration"] = registration(chosen.case)
    if reference["registration"] is not None:
        regions = regions_in_render(chosen.case, regions, render)
        reference["registration"]["photograph"] = found
    reference["warnings"] += filter(None, [registration_warning(reference["registration"]), failed])
    for warning in reference["warnings"]:
        print(f"warning: {warning}", file=sys.stderr)
    report, both, levels = score(table, regions, render, reference, read_calibration(chosen.case), photograph, inside)
    if failed:
        mark_failed(report)
    chosen.output.mkdir(parents=True, exist_ok=True)
    write_report(chosen.output, report, table, regions, render, photograph, both, levels)
    write_pair(chosen.output, levels[1].apply(resized(both.channels, table.size)), None if photograph is None else photograph.rgb)
    for name, level in report["levels"].items():
        figures = level["overall"]
        print(f"{name} du'v' {show(figures['mean_duv'], 4)}  rms {show(figures['rms_stops'], 3)} stops  dE2000 {show(figures['mean_delta_e_2000'], 2)}  regions: {in_words(level['verdict'])}")
    error = report["calibration_error"]
    print(f"calibration error (exposure fitted at L1): {error['exposure_stops']:+.2f} stops, 95 %: {error['exposure_stops_95'][0]:+.2f} to {error['exposure_stops_95'][1]:+.2f}")


def in_words(verdict):
    """How many regions differ, agree, or leave it open."""
    return f"{verdict['differ']} differ, {verdict['agree']} agree, {verdict['unsettled']} unsettled"


def without_lens(chosen, photograph, render):
    """The photograph with the lens taken out, where the case has a pose to say where its axis is."""
    from .lens import corrected
    from .layout import Layout

    if not (chosen.case / "layout.json").is_file() or not (chosen.case / "pose.json").is_file():
        if chosen.flat_field:
            raise InputError(chosen.case, "has no layout.json and pose.json", "fit the pose before a flat field is applied")
        return photograph
    camera = Layout(chosen.case / "layout.json").camera
    if photograph.size != camera.size:
        return photograph
    return corrected(photograph, camera, render.record, chosen.flat_field, chosen.render)


def regions_without_lens(chosen, regions, table, render):
    """Regions of the table with the recorded fall-off of the lens taken out, where the case has a pose; and what was done."""
    from .layout import Layout
    from .lens import corrected_regions

    if not (chosen.case / "layout.json").is_file() or not (chosen.case / "pose.json").is_file():
        return regions, []
    camera = Layout(chosen.case / "layout.json").camera.undistorted
    return corrected_regions(regions, camera, render.record, chosen.render) if camera.size == table.size else (regions, [])


def show(value, digits):
    """A number for the terminal; a dash where there is none."""
    return "-" if value is None else f"{value:.{digits}f}"


def run_measure(chosen):
    """regions.json beside the layout."""
    from .layout import Layout
    from .lens import undistorted
    from .photograph import read_photograph
    from .regions import measure_layout, write_table

    layout = Layout(chosen.case / "layout.json")
    photograph = read_photograph(chosen.photo)
    photograph = undistorted(photograph, layout.camera)
    layout = layout.seen_by(layout.camera.undistorted)
    regions = measure_layout(layout, photograph)
    write_table(chosen.case / "regions.json", layout, photograph, regions)
    if chosen.overlay:
        from .overlay import write_overlay

        write_overlay(chosen.overlay, photograph, regions)
    print(f"{chosen.case / 'regions.json'}: {len(regions)} regions, {sum(region.dark for region in regions)} at the black level")


def run_pose(chosen):
    """pose.json beside the points, and the fit in words."""
    from .pose import describe_fit, fit_case

    from .errors import read_json
    from .layout import Layout
    from .pose import corner_spread, read_frame

    result = fit_case(chosen.case)
    layout_file = chosen.case / "layout.json"
    if read_json(layout_file, "correct it").get("patches"):
        (chosen.case / "pose.json").write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
        layout = Layout(layout_file)
        result["region_corners"] = corner_spread(result, layout, read_frame(layout_file, layout.length_unit))
    (chosen.case / "pose.json").write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    print(describe_fit(result))


def run_register(chosen):
    """The verdict and the refined pose; exit code 1 where the registration failed."""
    from .photograph import read_photograph
    from .registration import describe_registration, register
    from .render import read_render

    render = read_render(chosen.render)
    photograph = without_lens(chosen, read_photograph(chosen.photo), render)
    found = register(chosen.case, photograph, render)
    if found is None:
        raise InputError(chosen.case, "has no scene.json with a camera, layout.json and pose.json", "write them first")
    if chosen.output:
        chosen.output.parent.mkdir(parents=True, exist_ok=True)
        chosen.output.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    print(describe_registration(found))
    return 0 if found["verdict"] == "accepted" else 1


def run_self_test(chosen):
    """self-test.json and a table; exit code 1 where a quantity is off or a planted fault is not noticed."""
    from .selftest import describe, examine, prepare

    report = examine(prepare(chosen.program, chosen.output, chosen.spp, chosen.case), chosen.seeds)
    report |= {"case": chosen.case.name, "samples_per_pixel": chosen.spp}
    (chosen.output / "self-test.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    print(describe(report))
    return 0 if report["pass"] else 1


def run_peers(chosen):
    """peers.json and a verdict; exit code 1 unless it is a pass."""
    from .peers import compare_with_mitsuba

    verdict = compare_with_mitsuba(chosen.case, chosen.spectra, chosen.render, chosen.output, chosen.spp, chosen.threads)
    print(verdict)
    return 0 if verdict.startswith("pass") else 1


def run_plan_savings(chosen):
    """Writes the table and the page of what plans save."""
    from .plan_savings import run

    return run(chosen.program)


def run_plot(chosen):
    """The SVG or PNG of one spectrum."""
    from .spectrum_plot import plot_spectrum

    plot_spectrum(sys.stdin.read(), chosen.file)
