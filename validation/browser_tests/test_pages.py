"""Every page of a `validate all` in Chromium, and every check on a page broken on purpose.

The folder is named by ETALON_PAGES, the browser by ETALON_CHROMIUM. The index
and all reports of one folder are opened; one of them has a photograph and one
has bands, so that there are sliders and maps.
"""

import json
import os
import re
import unittest
from pathlib import Path

from playwright.sync_api import sync_playwright

from .checks import Listener, picture_faults, print_faults, slider_faults, tab_faults, width_faults

PAGES = Path(os.environ["ETALON_PAGES"])
INDEX = PAGES / "index.html"
# The case that has a photograph, and the script and style that the broken pages lose.
WITH_PHOTO = "cornell"
# A picture of one pixel, in place of all pictures of a page that is broken on purpose: they are not what is looked at.
DOT = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
DESKTOP = {"width": 1280, "height": 900}


def reports():
    """The report of every case that has one, by case."""
    rows = json.loads((PAGES / "index.json").read_text())["cases"]
    return {row["case"]: PAGES / row["report"] for row in rows if row["status"] == "done"}


class Browser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.playwright = sync_playwright().start()
        cls.addClassCleanup(cls.playwright.stop)
        # A container's root has no user namespaces for Chromium's sandbox; the pages are our own.
        cls.browser = cls.playwright.chromium.launch(executable_path=os.environ["ETALON_CHROMIUM"], args=["--no-sandbox"])
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.page = self.browser.new_page(viewport=DESKTOP)
        self.addCleanup(self.page.close)

    def open(self, path, *more):
        """Opens a page from the disk with a listener; `more` are pages that may be gone to as well."""
        listener = Listener(self.page, {file.resolve().as_uri() for file in (path, *more)})
        self.page.goto(path.resolve().as_uri())
        return listener


class Pages(Browser):
    def test_every_page_works(self):
        self.assertIn(WITH_PHOTO, reports())
        pages = [INDEX, *sorted(PAGES.glob("*/report.html"))]
        self.assertGreater(len(pages), len(reports()) + 1, "the report of the bands is no case of the index")
        for path in pages:
            with self.subTest(path.parent.name):
                listener = self.open(path)
                faults = picture_faults(self.page) + tab_faults(self.page) + slider_faults(self.page)
                url = path.resolve().as_uri()
                faults += width_faults(self.page, url) + print_faults(self.page, url)
                self.assertEqual(faults + listener.faults, [])
                self.page.close()
                self.page = self.browser.new_page(viewport=DESKTOP)

    def test_a_report_with_a_photograph_has_a_slider_and_maps_at_its_levels(self):
        self.open(reports()[WITH_PHOTO])
        self.assertGreaterEqual(self.page.locator("[data-tab]").count(), 4)
        self.assertGreaterEqual(self.page.locator(".slider").count(), 4)
        for tab in self.page.locator("[data-tab]").all()[1:]:
            tab.click()
            for kind in ("luminance ratio", "chromaticity distance"):
                self.assertTrue(self.page.locator(f'img[alt="{kind}"]:visible').count(), f"{tab.inner_text()}: {kind}")

    def test_maps_of_two_levels_differ(self):
        self.open(reports()[WITH_PHOTO])
        seen = []
        for tab in self.page.locator("[data-tab]").all()[1:3]:
            tab.click()
            seen.append(self.page.locator('img[alt="luminance ratio"]:visible').screenshot())
        self.assertNotEqual(seen[0], seen[1])

    def test_the_index_leads_to_every_report_and_names_what_is_left_out(self):
        rows = json.loads((PAGES / "index.json").read_text())["cases"]
        self.open(INDEX, *reports().values())
        self.assertEqual(self.page.locator("tr[data-case]").count(), len(rows))
        for row in rows:
            here = self.page.locator(f'tr[data-case="{row["case"]}"]')
            if row["status"] == "done":
                here.locator("a").first.click()
                self.assertEqual(self.page.url, reports()[row["case"]].resolve().as_uri())
                self.page.go_back()
            else:
                self.assertIn(row["reason"], here.inner_text())

    def test_outlines_are_drawn_when_asked_for(self):
        self.open(reports()[WITH_PHOTO])
        outline = self.page.locator(".outlines:visible")
        self.assertEqual(outline.count(), 0)
        self.page.locator("#outline").check()
        self.assertGreater(outline.count(), 0)


class Broken(Browser):
    """A check that lets a broken page pass is no check."""

    def broken(self, *changes):
        """Opens the report with parts replaced; each part must be there."""
        text = re.sub(r"data:image/png;base64,[\w+/=]+", DOT, reports()[WITH_PHOTO].read_text(encoding="utf-8"))
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        path = PAGES / "broken.html"
        path.write_text(text, encoding="utf-8")
        self.addCleanup(path.unlink)
        return self.open(path), path.resolve().as_uri()

    def test_a_slider_without_its_handler_is_noticed(self):
        self.broken(("s.onpointerdown=", "s.onnothing="), ("s.onpointermove=", "s.onnothing="))
        self.assertIn("dragging leaves", " ".join(slider_faults(self.page)))

    def test_a_slider_whose_picture_is_dragged_away_is_noticed(self):
        self.broken(("s.ondragstart=()=>false;", ""))
        self.assertIn("dragging to", " ".join(slider_faults(self.page)))

    def test_a_slider_that_does_not_cut_is_noticed(self):
        self.broken(("clip-path:inset(0 0 0 var(--cut,50%))", "clip-path:inset(0 0 0 50%)"))
        self.assertTrue(slider_faults(self.page))

    def test_tabs_that_do_nothing_are_noticed(self):
        self.broken(("b.onclick=", "b.onnothing="))
        self.assertTrue(tab_faults(self.page))

    def test_a_page_that_is_too_wide_is_noticed(self):
        _, url = self.broken(("<h2>Score by level</h2>", '<div style="width:700px">wide</div>'))
        self.assertIn("the page is", " ".join(width_faults(self.page, url)))

    def test_a_table_outside_any_box_is_noticed(self):
        _, url = self.broken(("</main>", '<table style="display:table;width:700px"><tr><td>wide</td></tr></table></main>'))
        self.assertIn("a table reaches", " ".join(width_faults(self.page, url)))

    def test_small_print_is_noticed(self):
        _, url = self.broken(("figcaption{font-size:12px", "figcaption{font-size:6px"))
        self.assertIn("tall", " ".join(width_faults(self.page, url)))

    def test_levels_that_are_not_printed_are_noticed(self):
        _, url = self.broken(("section[data-level][hidden],", ""))
        self.assertIn("is not printed", " ".join(print_faults(self.page, url)))

    def test_a_picture_cut_in_print_is_noticed(self):
        _, url = self.broken(("height:auto;clip-path:none", "height:auto"))
        self.assertIn("cut off", " ".join(print_faults(self.page, url)))

    def test_errors_and_requests_are_noticed(self):
        listener, _ = self.broken(("</main>", '</main><img alt="far" src="http://192.0.2.1/far.png"><img alt="gone" src="gone.png"><script>undefinedName()</script>'))
        said = " ".join(listener.faults)
        for fault in ("asks for http://192.0.2.1/far.png", "gone.png", "undefinedName"):
            self.assertIn(fault, said)
        self.assertIn("gone", " ".join(picture_faults(self.page)))


if __name__ == "__main__":
    unittest.main()
