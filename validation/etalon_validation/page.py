"""What the pages share: one template engine, one style, one script, pictures inside the page."""

import datetime
import io
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib import pyplot

from .overlay import spoken


def fixed(value, digits):
    """A number with `digits` decimals, a dash where there is none."""
    return "–" if value is None else f"{value:.{digits}f}"


def signed(value, digits):
    """A number with its sign, a dash where there is none."""
    return "–" if value is None else f"{value:+.{digits}f}".replace("-", "−")


def duration(seconds):
    """Seconds as people read them: 6 h 01 min 20 s, 3 min 15 s, 4.2 s."""
    if seconds is None:
        return "–"
    if seconds < 60:
        return f"{seconds:.1f} s"
    hours, rest = divmod(round(seconds), 3600)
    minutes, rest = divmod(rest, 60)
    return f"{hours} h {minutes:02d} min {rest:02d} s" if hours else f"{minutes} min {rest:02d} s"


def engine():
    """Templates of this folder; a name that is not given is an error."""
    made = Environment(loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    made.filters |= {"fixed": fixed, "signed": signed, "duration": duration, "spoken": spoken}
    return made


def write_page(path, template, **values):
    """Fills a template and writes the page."""
    Path(path).write_text(engine().get_template(template).render(**values), encoding="utf-8")


def svg(figure):
    """A figure as SVG to stand inside a page, without its date, so that pages compare; the figure is closed."""
    buffer = io.StringIO()
    with pyplot.rc_context({"svg.hashsalt": "etalon", "svg.fonttype": "path"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    text = buffer.getvalue()
    return text[text.index("<svg"):]


def today():
    """Date and time in UTC, to the minute."""
    return datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
