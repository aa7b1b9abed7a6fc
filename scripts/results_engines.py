"""The section of docs/results.md on engines: `control_view bench` on every scene, with tables and two plots.

Scenes: ../shared/scenes where that folder is there (the bundled one otherwise), generated cities of 2,000, 20,000 and
200,000 objects and crowds of 2,000 and 20,000.
"""

import os

from engine_bench import generated_scene, path_of, scenes_at_hand
from results_page import IMAGES, cell, ratio, shortened, table
from svg_plot import Chart, write_bars, write_svg

ENGINES = ("item_buffer_all", "item_buffer", "raster", "raycast")
CITIES = (2_000, 20_000, 200_000)
CROWDS = (2_000, 20_000)
FRAMES_OF_A_PATH = 3_600
LEAD_IN_S = 0.0333  # the camera moves on between two requests, 30 of them a second


class Measured:
    """One report of `control_view bench`."""

    def __init__(self, name, report):
        self.name = name
        self.report = report
        self.engines = {engine["engine"]: engine for engine in report["engines"]}

    def ms(self, engine, quantile="p50"):
        return self.engines[engine]["frame_ms"][quantile] if engine in self.engines else None

    @property
    def oracle_ms(self):
        return self.report["oracle"] and self.report["oracle"]["frame_ms"]["p50"]

    @property
    def visible(self):
        return self.engines["item_buffer_all"]["reported"]

    @property
    def command(self):
        return "control_view " + " ".join(map(shortened, self.report["command_line"]))


def measure(runs, scene, *arguments, name=None, label="", lead_in_s=LEAD_IN_S):
    stem = f"{scene.stem}{label}"
    views = runs.level.views
    report = runs.report_of(stem, [runs.bin_folder / "control_view", "bench", "--scene", scene, "--path", path_of(scene),
                                   "--step", max(1, FRAMES_OF_A_PATH // views), "--frames", views, "--lead-in", lead_in_s,
                                   *arguments], folder="engines")
    return Measured(name or scene.stem, report)


def measure_all(runs):
    """Every run, by what it is for."""
    cities, crowds = (CITIES[:2], CROWDS[:1]) if runs.level.name == "quick" else (CITIES, CROWDS)
    generated = {(kind, count): generated_scene(runs.bin_folder, kind, count, runs.out)
                 for kind, counts in (("city", cities), ("crowd", crowds)) for count in counts}
    measured = {"single": [], "growth": [], "cold": [], "wide": {}, "threads": {}}
    for (kind, count), scene in generated.items():
        one = measure(runs, scene, name=f"{kind}, {count:,} objects")
        measured["single"].append(one)
        if kind == "city":
            measured["growth"].append(one)
            measured["cold"].append(measure(runs, scene, name=one.name, label="_cold", lead_in_s=0))
    for scene in scenes_at_hand():
        measured["single"].append(measure(runs, scene))
    for count in cities[:2]:
        scene = generated["city", count]
        measured["wide"][count] = {
            kind: measure(runs, scene, "--views", kind, "--engine", ",".join(ENGINES[1:]), "--no-oracle", label=f"_{kind}")
            for kind in ("single", "stereo", "around", "region")}
    for threads in sorted({1, os.cpu_count() or 1}):
        measured["threads"][threads] = measure(runs, generated["city", 20_000], "--threads", threads, "--engine",
                                               "raster,raycast", "--no-oracle", label=f"_threads_{threads}")
    return measured


# Each of these gives lines of Markdown.


def single_table(runs):
    yield from table(
        ("scene", "visible", *ENGINES, "only the visible, OpenGL", "all / raster", "raycast / raster",
         "item_buffer / only the visible"),
        ((run.name, f"{run.visible:.0f}", *(cell(run.ms(engine)) for engine in ENGINES), cell(run.oracle_ms),
          ratio(run.ms("item_buffer_all"), run.ms("raster")), ratio(run.ms("raycast"), run.ms("raster")),
          ratio(run.ms("item_buffer"), run.oracle_ms)) for run in runs))


def tail_table(runs):
    yield from table(
        ("scene", *(f"{engine} p99" for engine in ENGINES), "missed: item_buffer, raster, raycast", "kept",
         "pixels that differ"),
        ((run.name, *(cell(run.ms(engine, "p99")) for engine in ENGINES),
          *(", ".join(f"{run.engines[engine][field]:.2g}" for engine in ENGINES[1:])
            for field in ("missed", "kept", "differing_pixels_share"))) for run in runs))


def growth_table(runs):
    first, last = runs[0], runs[-1]
    yield from table(
        ("city", "visible", *ENGINES),
        [*((f"{run.report['objects']:,} objects", f"{run.visible:.1f}", *(cell(run.ms(engine)) for engine in ENGINES))
           for run in runs),
         ("last / first", ratio(last.visible, first.visible),
          *(ratio(last.ms(engine), first.ms(engine)) for engine in ENGINES))])


def wide_table(wide):
    rows = []
    for count, kinds in wide.items():
        for kind, run in kinds.items():
            rows.append((f"{count:,}", kind, *(f"{cell(run.ms(engine))} ({ratio(run.ms(engine), kinds['single'].ms(engine))})"
                                               for engine in ENGINES[1:])))
    yield from table(("objects", "views", *ENGINES[1:]), rows)


def build_table(runs):
    yield from table(
        ("scene", "load, ms", *(f"{engine}, ms (MB)" for engine in ENGINES)),
        ((run.name, cell(run.report["load_ms"]),
          *(f"{cell(run.engines[engine]['build_ms'])} ({run.engines[engine]['build_mb']:.0f})" for engine in ENGINES))
         for run in runs))


def threads_table(threads):
    first = next(iter(threads.values()))
    yield from table(
        ("threads", "raster", "raycast"),
        ((count, *(f"{cell(run.ms(engine))} ({ratio(first.ms(engine), run.ms(engine))})"
                   for engine in ("raster", "raycast"))) for count, run in threads.items()))


def instructions_note(runs):
    counted = [run for run in runs if run.engines["raster"]["instructions"]]
    if not counted:
        yield "Instructions a frame: this machine does not let them be counted."
        yield ""
        return
    yield "Millions of instructions a frame, user mode, all threads:"
    yield ""
    yield from table(("scene", *ENGINES), ((run.name, *(
        cell(run.engines[engine]["instructions"] / 1e6) for engine in ENGINES)) for run in counted))


def section(runs):
    yield "512x384, every engine on each view in turn, milliseconds a frame, medians. Views are spread over the path; each follows"
    yield "an unmeasured one a thirtieth of a second earlier, as in service. The reports in `out/results` hold every command line;"
    yield f"the first was `{runs['single'][0].command}`."
    yield ""
    yield "![milliseconds a frame](images/engines.svg)"
    yield ""
    yield from single_table(runs["single"])
    yield "`all` is item_buffer_all, which draws everything in the view frustum and is the reference. \"Only the visible\" is"
    yield "OpenGL told the answer beforehand. The slowest frames, and objects a frame that were missed or kept in vain:"
    yield ""
    yield from tail_table(runs["single"])
    yield "### Growth"
    yield ""
    yield "![growth with the scene](images/growth.svg)"
    yield ""
    yield from growth_table(runs["growth"])
    yield "### Without the view before"
    yield ""
    yield "The same views, each as far from the last as the path is long over their number: nothing to start from, as after a jump."
    yield ""
    yield from single_table(runs["cold"])
    yield "### Wider views"
    yield ""
    yield "stereo: two eyes 64 mm apart. around: six faces of 384x384. region: five viewpoints within 0.1 m. In brackets: against"
    yield "single, from runs one after the other."
    yield ""
    yield from wide_table(runs["wide"])
    yield "### Threads, city of 20,000"
    yield ""
    yield from threads_table(runs["threads"])
    yield "### Loading: milliseconds until an engine is built, and what the process grew by"
    yield ""
    yield from build_table(runs["single"])
    yield from instructions_note(runs["single"])


def draw_plots(runs):
    growth = {engine: [(run.report["objects"], run.ms(engine)) for run in runs["growth"]] for engine in ENGINES}
    write_svg(IMAGES / "growth.svg", [Chart("growth with the scene", "objects in the city", "ms a frame, median", growth,
                                            log_x=True, log_y=True)])
    write_bars(IMAGES / "engines.svg", "milliseconds a frame", "ms a frame, median",
               {run.name: [run.ms(engine) for engine in ENGINES] for run in runs["single"]}, ENGINES)


def engines(runs):
    measured = measure_all(runs)
    draw_plots(measured)
    yield from section(measured)
