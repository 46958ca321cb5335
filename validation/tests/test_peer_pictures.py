"""Peers' pictures: luminance by channels and primaries, units, and a peer of known variance in the study."""

import subprocess
import sys
import tempfile
import unittest
from importlib import metadata
from pathlib import Path

import numpy as np
from scipy import stats

from etalon_validation.converge_analysis import analyse
from etalon_validation.converge_reference import FileReference, divisor_of
from etalon_validation.errors import InputError
from etalon_validation.peer_picture import SRGB, luminance_weights, read_picture
from etalon_validation.peer_series import PeerOption, load_peer, settle_peer

from .peer_files import SIZE, truth, write_exr, write_peer

# ITU-R BT.2020: red, green, blue, white as x, y; shares of luminance of its table 4.
WIDE = (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290)
WIDE_SHARES = (0.2627, 0.6780, 0.0593)
# Shares of ITU-R BT.709, item 3.2.
SRGB_SHARES = (0.2126, 0.7152, 0.0722)
# Chance that a test against a known variance fails though nothing is wrong.
ALPHA = 1e-3
VALIDATION = Path(__file__).parents[1]


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def picture(self, channels, scale=None, **attributes):
        write_exr(self.folder / "x.exr", channels, **attributes)
        return read_picture(self.folder / "x.exr", "here", scale)


class Pictures(Case):
    def test_published_shares_of_luminance_follow_from_primaries(self):
        for primaries, shares in ((SRGB, SRGB_SHARES), (WIDE, WIDE_SHARES)):
            np.testing.assert_allclose(luminance_weights(primaries), shares, atol=5e-5)

    def test_a_coloured_pixel_has_the_luminance_of_its_primaries(self):
        rgb = {name: np.full(SIZE, value) for name, value in zip("RGB", (3.0, 2.0, 5.0))}
        for attributes, shares in (({}, SRGB_SHARES), ({"chromaticities": WIDE}, WIDE_SHARES)):
            found = self.picture(rgb, **attributes)
            np.testing.assert_allclose(found.luminance, np.dot(shares, (3, 2, 5)), rtol=2e-4)

    def test_y_goes_before_rgb_and_carries_its_standard_error(self):
        found = self.picture({"R": truth(), "G": truth(), "B": truth(), "X": truth(), "Y": 2 * truth(), "Z": truth(), "stderr.Y": truth()})
        np.testing.assert_allclose(found.luminance, 2 * truth(), rtol=1e-6)
        np.testing.assert_allclose(found.variance, truth() ** 2, rtol=1e-6)
        luminance, variance = found.scaled(3.0)
        np.testing.assert_allclose(variance / luminance**2, 0.25, rtol=1e-6)

    def test_the_unit_is_the_users_before_the_files(self):
        y = {"Y": truth()}
        self.assertEqual(self.picture(y, 3.0, whiteLuminance=100.0).factor, 3.0)
        self.assertEqual(self.picture(y, whiteLuminance=100.0).factor, 100.0)
        self.assertEqual(self.picture(y, whiteLuminance=100.0, etalon="{}").factor, 1.0)
        self.assertIsNone(self.picture(y).factor)
        self.assertIsNone(self.picture(y, whiteLuminance=0.0).factor)

    def test_pictures_that_cannot_be_judged_are_refused(self):
        holes = truth()
        holes[3, 4:6] = np.nan, np.inf
        for channels, attributes, saying in (
            ({"Y": holes}, {}, "2 pixels that are not finite"), ({"R": truth(), "G": truth()}, {}, "has the channels R, G"),
            ({name: truth() for name in "RGB"}, {"chromaticities": (0.3,) * 8}, "are no primaries"),
        ):
            with self.subTest(saying), self.assertRaises(InputError) as caught:
                self.picture(channels, **attributes)
            self.assertTrue(str(caught.exception).startswith("here: "))
            self.assertIn(saying, str(caught.exception))


class Peers(Case):
    def peer(self, option=None, **made):
        table = write_peer(self.folder, **made)
        return settle_peer(load_peer(PeerOption("other", table, option), SIZE[::-1]), truth())

    def reference(self):
        return FileReference(truth(), np.zeros(SIZE), "truth", "")

    def known(self, report, relative):
        """Each point's mean relMSE over the known one is chi-squared over its degrees; bounds for all points together."""
        for index, point in enumerate(report.points):
            weights = relative**2 / 2**index * truth() ** 2 / divisor_of(truth())
            # Terms have nearly one weight each; their squared sum over the sum of squares is the number that counts.
            degrees = point.repeats * weights.sum() ** 2 / (weights**2).sum()
            low, high = stats.chi2.ppf([ALPHA / 2 / len(report.points), 1 - ALPHA / 2 / len(report.points)], degrees) / degrees
            ratio = point.relmse_mean / weights.mean()
            self.assertTrue(low < ratio < high, f"point {index}: {ratio} is not within {low} and {high}")

    def test_a_peer_of_known_variance_lands_at_its_known_error(self):
        peer = self.peer(whiteLuminance=1.0)
        self.assertFalse(peer.facts["is_fitted"])
        (report,) = analyse([peer.series], self.reference())
        self.known(report, 0.3)
        self.assertEqual([round(point.cpu_s, 2) for point in report.points], [1.04, 2.08, 4.16, 8.32])

    def test_units_of_every_kind_land_at_the_same_error(self):
        expected = [score.relmse for score in analyse([self.peer(whiteLuminance=1.0).series], self.reference())[0].scores]
        for made in ({"option": 4.0}, {"whiteLuminance": 4.0}):
            peer = self.peer(scale=0.25, **made)
            found = [score.relmse for score in analyse([peer.series], self.reference())[0].scores]
            np.testing.assert_allclose(found, expected, rtol=1e-4)

    def test_a_wrong_level_is_a_bias_unless_it_is_fitted_and_then_it_is_said(self):
        (stated,) = analyse([self.peer(points=6, relative=0.1, whiteLuminance=1.1).series], self.reference())
        self.assertTrue(stated.bias.is_significant)
        peer = self.peer(points=6, relative=0.1)
        self.assertEqual(peer.series.name, "other (level fitted)")
        self.assertIn("level is not tested", peer.sentence)
        # Fitted on the mean of five pictures of SIZE pixels with 0.1 / 2^2.5 of relative noise.
        error = 0.1 / 2**2.5 * np.sqrt((truth() ** 2).sum()) / truth().sum() / np.sqrt(5)
        self.assertLess(abs(peer.facts["factor"] - 1), stats.norm.isf(ALPHA / 2) * error)
        last = np.mean([read_picture(self.folder / f"5-{repeat}.exr").luminance for repeat in range(5)])
        self.assertAlmostEqual(peer.facts["factor"], truth().mean() / last)
        self.assertIn("the 5 pictures of its last point", peer.sentence)
        (fitted,) = analyse([peer.series], self.reference())
        self.assertFalse(fitted.bias.is_significant)

    def test_a_peer_that_converges_elsewhere_is_judged_by_its_own_reference(self):
        # Another pixel filter: its picture is the truth turned upside down.
        table = write_peer(self.folder, reference=truth(), whiteLuminance=1.0)
        common = FileReference(truth()[::-1].copy(), np.zeros(SIZE), "ours", "")
        peer = settle_peer(load_peer(PeerOption("other", table), SIZE[::-1]), common.luminance)
        (own,) = analyse([peer.series], common, {peer.series.name: peer.own})
        self.known(own, 0.3)
        (against,) = analyse([peer.series], common)
        self.assertTrue(against.bias.is_significant)
        self.assertGreater(against.points[-1].relmse_mean, 10 * own.points[-1].relmse_mean)

    def test_sizes_names_and_mixed_units_are_refused_at_their_line(self):
        table = write_peer(self.folder, points=2, repeats=1)
        with self.assertRaisesRegex(InputError, r"peer\.csv:2:1: .*32x24 pixels, the reference 64x64"):
            load_peer(PeerOption("other", table), (64, 64))
        with self.assertRaisesRegex(InputError, "is an integrator"):
            load_peer(PeerOption("path", table), SIZE[::-1], ("path", "bdpt"))
        write_exr(self.folder / "0-0.exr", {"Y": truth()}, whiteLuminance=1.0)
        with self.assertRaisesRegex(InputError, r"peer\.csv:3:1: .*does not say its unit"):
            load_peer(PeerOption("other", table), SIZE[::-1])
        black = write_peer(self.folder, scale=0.0, points=1, repeats=1)
        with self.assertRaisesRegex(InputError, "no light in it"):
            settle_peer(load_peer(PeerOption("other", black), SIZE[::-1]), truth())


class Imports(unittest.TestCase):
    def test_what_runs_beside_mitsuba_needs_nothing_that_its_environment_lacks(self):
        def names(file):
            lines = (VALIDATION / file).read_text(encoding="utf-8").splitlines()
            return {line.partition("==")[0].lower() for line in lines if "==" in line}

        lacking = names("requirements.txt") - names("requirements-peers.txt")
        blocked = sorted(module for module, owners in metadata.packages_distributions().items() if {owner.lower() for owner in owners} & lacking)
        self.assertIn("rawpy", blocked)
        code = "\n".join((
            "import sys", f"sys.modules.update(dict.fromkeys({blocked!r}))",
            "import etalon_validation.cli, etalon_validation.peers, etalon_validation.peer_mitsuba",
        ))
        done = subprocess.run([sys.executable, "-c", code], cwd=VALIDATION, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
