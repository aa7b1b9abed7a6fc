"""The parts of scripts/results that need no executable: marked sections, axes, plots, and which audits are planned."""

import pathlib
import sys
import tempfile
import unittest
import xml.etree.ElementTree

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import results_page  # noqa: E402
import svg_plot  # noqa: E402
from engine_bench import Failed  # noqa: E402
from results_audits import PRESETS, SWEEPS, swept_audits  # noqa: E402
from results_runs import LEVELS, Audit, Runs  # noqa: E402

PAGE = f"""# Results
by hand
{results_page.begin_of("one")}

old

{results_page.end_of("one")}
between
{results_page.begin_of("two")}
{results_page.end_of("two")}
after
"""


class Page(unittest.TestCase):
    def test_rewrites_what_stands_between_the_markers_and_nothing_else(self):
        page = results_page.replaced(PAGE, "one", ["new", "lines", ""])
        self.assertIn("new\nlines", page)
        self.assertNotIn("old", page)
        for kept in ("by hand", "between", "after", results_page.begin_of("two")):
            self.assertIn(kept, page)

    def test_comes_to_rest(self):
        once = results_page.replaced(PAGE, "two", ["text"])
        self.assertEqual(once, results_page.replaced(once, "two", ["text"]))

    def test_refuses_a_page_without_its_markers(self):
        begin, end = results_page.begin_of("one"), results_page.end_of("one")
        for broken in (PAGE.replace(begin, ""), PAGE.replace(end, ""), PAGE + begin, f"{end}\n{begin}\n"):
            with self.assertRaises(Failed):
                results_page.replaced(broken, "one", [])

    def test_the_projects_own_page_has_every_section_once(self):
        text = results_page.PAGE.read_text()
        script = (ROOT / "scripts" / "results").read_text()
        names = script.split("SECTIONS = {")[1].split("}")[0].split('"')[1::2]
        self.assertGreater(len(names), 5)
        for name in names:
            results_page.replaced(text, name, [])

    def test_says_zero_only_of_zero(self):
        self.assertEqual(results_page.share(0), "0")
        self.assertEqual(results_page.share(1.4e-9), "1.4e-9")
        self.assertEqual(results_page.share(None), "-")


class Axes(unittest.TestCase):
    def test_ticks_hold_every_value(self):
        for low, high in ((0, 1), (0, 0), (0.3, 7.7), (-5, 1e6), (1e-9, 2e-9)):
            ticks = svg_plot.linear_ticks(low, high)
            self.assertLessEqual(ticks[0], low)
            self.assertGreaterEqual(ticks[-1], high)
            self.assertTrue(2 <= len(ticks) <= 9, ticks)

    def test_logarithmic_ticks_hold_every_value(self):
        for low, high in ((1, 1), (0.2, 900), (1e-9, 1e4), (3, 4)):
            ticks = svg_plot.log_ticks(low, high)
            self.assertLessEqual(ticks[0], low * 1.0000001)
            self.assertGreaterEqual(ticks[-1], high * 0.9999999)
            self.assertEqual(ticks, sorted(set(ticks)))

    def test_a_zero_has_its_place_on_a_logarithmic_axis(self):
        axis = svg_plot.Axis([0, 1e-6, 1e-3], True, 0, 100)
        self.assertLess(axis.at(0), axis.at(1e-6))
        self.assertEqual(axis.at(0), 0)
        self.assertGreater(axis.at(1e-6), 10)

    def test_the_outer_ticks_are_the_ends_of_the_axis(self):
        for log in (False, True):
            axis = svg_plot.Axis([1.5e-5, 7e-5], log, 226, 30)
            self.assertAlmostEqual(axis.at(axis.ticks[0]), 226)
            self.assertAlmostEqual(axis.at(axis.ticks[-1]), 30)

    def test_nothing_but_zeros_is_no_trouble(self):
        axis = svg_plot.Axis([0, 0], True, 0, 100)
        self.assertEqual(axis.at(0), 0)


class Plots(unittest.TestCase):
    def drawn(self, write):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "plot.svg"
            write(file)
            text = file.read_text()
        xml.etree.ElementTree.fromstring(text)
        return text

    def test_are_well_formed_and_leave_out_what_is_missing(self):
        chart = svg_plot.Chart("a < b & c", "x", "y", {"<one>": [(0, 1), (1, None), (2, 3)], "none": [(0, None)]},
                               names=("a", "b", "c"))
        text = self.drawn(lambda file: svg_plot.write_svg(file, [chart, chart, chart], columns=2))
        self.assertEqual(text.count("<circle"), 3 * 2)
        self.assertIn("a &lt; b &amp; c", text)

    def test_bars_leave_out_what_is_missing(self):
        text = self.drawn(lambda file: svg_plot.write_bars(file, "t", "x", {"g": [1.0, None], "h": [10.0, 2.0]}, ("a", "b")))
        self.assertEqual(text.count('height="8"'), 3)


class Planning(unittest.TestCase):
    def test_every_point_of_a_sweep_is_measured_and_shared_ones_once(self):
        audits = swept_audits(pathlib.Path("rotterdam.glb"), 60)
        self.assertEqual(len(audits), len(PRESETS) * sum(len(values) for _, values in SWEEPS.values()))
        names = {audit.name for audit in audits.values()}
        self.assertEqual(len(names), len({audit for audit in audits.values()}))
        shared = {audits[sweep, value, "avango"].name
                  for sweep, value in (("latency", "50"), ("rate", "30"), ("resolution", "512x384"), ("turn", "0"))}
        self.assertEqual(len(shared), 1)

    def test_an_audit_says_all_that_it_was_asked(self):
        words = Audit("a", pathlib.Path("s.glb"), "avango", 100, None, filter=4, rotations=pathlib.Path("head.csv"),
                      turn="inf").arguments()
        for option, value in (("--preset", "avango"), ("--latency", "100"), ("--filter", "4"), ("--rotations", "head.csv"),
                              ("--turn", "inf")):
            self.assertEqual(words[words.index(option) + 1], value)
        self.assertNotIn("--control-rate", words)

    def test_audits_share_what_is_visible_only_where_they_look_alike(self):
        scene = pathlib.Path("s.glb")
        plain = Audit("a", scene)
        self.assertEqual(plain.views, Audit("b", scene, "avango", 200, 5, filter=1).views)
        for other in (Audit("c", scene, turn="60"), Audit("d", scene, rate_hz=3), Audit("e", pathlib.Path("t.glb")),
                      Audit("f", scene, rotations=pathlib.Path("head.csv"))):
            self.assertNotEqual(plain.views, other.views)

    def test_the_first_of_each_set_of_views_goes_ahead(self):
        done = []

        class Recorded(Runs):
            def audit(self, audit):
                done.append(audit.name)
                return audit.name.upper()

        scene = pathlib.Path("s.glb")
        runs = Recorded(None, None, LEVELS["quick"], 1)
        reports = runs.audits([Audit("short", scene, frames=10), Audit("long", scene, frames=90), Audit("turn", scene, turn="60")])
        self.assertEqual(set(done[:2]), {"long", "turn"})
        self.assertEqual(reports, {"short": "SHORT", "long": "LONG", "turn": "TURN"})

    def test_two_audits_do_not_write_one_report(self):
        with self.assertRaises(Failed):
            Runs(None, None, LEVELS["quick"], 1).audits([Audit("same", pathlib.Path("a.glb")), Audit("same", pathlib.Path("b.glb"))])


if __name__ == "__main__":
    unittest.main()
