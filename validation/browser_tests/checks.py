"""Checks of one open page; each returns what is wrong in words, and nothing where all is well.

They know no single page: a check of the slider looks at every slider there is.
"""

import re

# Width of a small phone, CSS pixels.
PHONE_PX = 390
# A slider that is dragged to this share of its width should show the cut there, to within a percent.
DRAGGED_TO = 0.25
# Text below this size is not readable on a phone.
LEAST_FONT_PX = 10

WIDER_THAN_PAGE = """() => {
  const page = document.documentElement.clientWidth, said = [];
  if (document.documentElement.scrollWidth > page) said.push(`the page is ${document.documentElement.scrollWidth} px wide in a window of ${page}`);
  const scrolls = e => { for (let p = e.parentElement; p; p = p.parentElement) if (/auto|scroll|hidden/.test(getComputedStyle(p).overflowX)) return true; return false };
  for (const table of document.querySelectorAll("table")) {
    if (!table.offsetWidth) continue;
    const own = /auto|scroll/.test(getComputedStyle(table).overflowX), right = table.getBoundingClientRect().right;
    if (!own && !scrolls(table) && right > page + 1) said.push(`a table reaches ${right} px`);
  }
  return said;
}"""
SMALL_TEXT = """least => [...document.querySelectorAll("p, td, th, li, figcaption, h1, h2, button")]
  .filter(e => e.offsetWidth && e.textContent.trim() && parseFloat(getComputedStyle(e).fontSize) < least)
  .map(e => `"${e.textContent.trim().slice(0, 30)}" is ${getComputedStyle(e).fontSize} tall`).slice(0, 3)"""
VISIBLE_LEVELS = """() => [...document.querySelectorAll("section[data-level]")].filter(s => s.offsetHeight > 0).map(s => s.dataset.level)"""
PRINTED_FAULTS = """() => {
  const said = [];
  for (const section of document.querySelectorAll("section[data-level]")) if (!section.offsetHeight) said.push(`${section.dataset.level} is not printed`);
  const page = document.documentElement.clientWidth;
  for (const e of document.querySelectorAll("table, img, figure")) if (e.offsetWidth && e.getBoundingClientRect().right > page + 1) said.push(`${e.tagName} reaches ${e.getBoundingClientRect().right} of ${page} px on paper`);
  for (const slider of document.querySelectorAll(".slider")) {
    const over = slider.querySelector(".over");
    if (getComputedStyle(over).clipPath !== "none") said.push("a slider is printed with one side cut off");
  }
  return said.slice(0, 4);
}"""
PAPER_PX = (703, 1000)


def slider_faults(page):
    """Drags every visible slider with the mouse and looks whether the cut through the picture follows."""
    faults = []
    for slider in (found for found in page.locator(".slider").all() if found.is_visible()):
        slider.scroll_into_view_if_needed()
        area = slider.bounding_box()
        over = slider.locator(".over")
        clip = "e => getComputedStyle(e).clipPath"
        before = over.evaluate(clip)
        across, down = area["x"] + DRAGGED_TO * area["width"], area["y"] + area["height"] / 2
        page.mouse.move(area["x"] + area["width"] / 2, down)
        page.mouse.down()
        page.mouse.move(across, down, steps=3)
        page.mouse.up()
        after = over.evaluate(clip)
        cut = re.search(r"([\d.]+)%\)$", after)
        if after == before:
            faults.append(f"dragging leaves the picture as it was ({after})")
        elif not cut or abs(float(cut[1]) - 100 * DRAGGED_TO) > 1:
            faults.append(f"dragging to {100 * DRAGGED_TO:.0f} % cuts at {after}")
        handle = slider.locator(".handle").bounding_box()
        if handle and abs(handle["x"] + handle["width"] / 2 - across) > 3:
            faults.append("the handle is not where it was dragged to")
        slider.press("ArrowRight")
        if over.evaluate(clip) == after:
            faults.append("the arrow keys do not move the slider")
    return faults


def tab_faults(page):
    """Presses every tab and looks whether its section, with its pictures and maps, is the one that shows."""
    faults = []
    for tab in page.locator("[data-tab]").all():
        name = tab.get_attribute("data-tab")
        tab.click()
        shown = page.evaluate(VISIBLE_LEVELS)
        if shown != [name]:
            faults.append(f"tab {name} shows {shown}")
        if tab.get_attribute("aria-selected") != "true":
            faults.append(f"tab {name} is not marked as chosen")
    return faults


def width_faults(page, url):
    """Opens a page as wide as a phone: nothing but boxes of their own may scroll sideways, and text is readable."""
    page.set_viewport_size({"width": PHONE_PX, "height": 800})
    page.goto(url)
    return page.evaluate(WIDER_THAN_PAGE) + page.evaluate(SMALL_TEXT, LEAST_FONT_PX)


def print_faults(page, url):
    """Prints a page to PDF: it has pages, and every level of the report is on them."""
    page.set_viewport_size({"width": PAPER_PX[0], "height": PAPER_PX[1]})
    page.goto(url)
    page.emulate_media(media="print")
    faults = page.evaluate(PRINTED_FAULTS)
    sections = page.locator("section[data-level]").count()
    pdf = page.pdf(prefer_css_page_size=True)
    page.emulate_media(media="screen")
    pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
    # Every level after the first begins on a new page.
    if not pdf.startswith(b"%PDF") or pages < max(1, sections):
        faults.append(f"{pages} pages for {sections} sections")
    return faults


def picture_faults(page):
    """Pictures that have not loaded."""
    broken = page.evaluate('() => [...document.querySelectorAll("img")].filter(i => !(i.complete && i.naturalWidth)).map(i => i.alt)')
    return [f'the picture "{alt}" is not there' for alt in broken]


class Listener:
    """What a page says on its console, and what it asks of anyone."""

    def __init__(self, page, own):
        self.faults, self.own = [], own
        page.on("console", self.said)
        page.on("pageerror", lambda error: self.faults.append(f"error: {error}"))
        page.on("request", self.asked)

    def said(self, message):
        if message.type in ("error", "warning"):
            self.faults.append(f"console: {message.text}")

    def asked(self, request):
        if not (request.url.startswith("data:") or request.url.split("#")[0] in self.own):
            self.faults.append(f"asks for {request.url}")
