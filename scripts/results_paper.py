"""Sections of docs/results.md that repeat the tables and figures of the paper.

Klimenko, Nikitina, Nikitin, "Parallel Visibility Test and Occlusion Culling in Avango Virtual Environment Framework",
Eurographics 2003, short presentations, doi 10.2312/egs.20031036. Of its figures only those of the abstract could be
verified; none of the others is given here from memory.
"""

import csv
import math
import shutil
import statistics

from engine_bench import path_of
from results_audits import ACCEPTED, TRACES, scenes_named
from results_page import IMAGES, cell, image, table
from svg_plot import Chart, write_svg

COUNTERS = {"software histogram": "histogram", "compute shader": "compute", "occlusion queries": "queries"}
SIZES = ("1024x768", "512x384")
PREDICTORS = ("default", "avango", "constant_velocity", "hold")
HORIZONS = (1, 2, 5, 10, 20)
PLAY_SIZE = "640x480"
FRAMES_OF_A_PATH = 3600


def table1(runs):
    """What it takes to count the pixels of every object, by counter and size."""
    step = max(1, FRAMES_OF_A_PATH // runs.level.views)
    rows = []
    for scene in scenes_named(("rotterdam", "clinic")):
        for size in SIZES:
            report = runs.report_of(
                f"table1_{scene.stem}_{size}",
                [runs.bin_folder / "control_view", "bench", "--scene", scene, "--path", path_of(scene), "--size", size,
                 "--engine", ",".join(f"item_buffer_all:{counter}" for counter in COUNTERS.values()), "--no-oracle",
                 "--step", step, "--frames", runs.level.views])
            by_counter = {engine["counter"]: engine for engine in report["engines"]}
            for name, counter in COUNTERS.items():
                engine = by_counter[counter]
                stages = engine["stages_ms"]
                rows.append((scene.stem, size, name, cell(stages["draw"]), cell(stages["count"]), cell(engine["frame_ms"]["p50"])))
    yield "Every object in the view frustum drawn in its own colour (`item_buffer_all`), then counted three ways, milliseconds a"
    yield "view. Queries draw every object once more, each between the two ends of its query. The paper counted in software and"
    yield "with OpenGL's histogram, which our compute shader stands for; the cells of its Table 1 could not be verified."
    yield ""
    yield from table(("scene", "image", "counter", "draw, mean", "count, mean", "all, median"), rows)


def play(runs, scene, name, *arguments, frames, size=PLAY_SIZE):
    folder = runs.reports / "play" / name
    report = runs.main_view(name, "play", "--spawn", "--engine", runs.engine, "--headless", "--scene", scene, "--path",
                            path_of(scene), "--culling", "service", "--size", size, "--frames", frames, "--out", folder,
                            *arguments, folder="play")
    return report, folder


def table2(runs):
    rows = []
    for scene in scenes_named(ACCEPTED):
        for setup, arguments in (("one eye", ()), ("stereo", ("--stereo",))):
            frames = max(4, runs.level.play_frames // (2 if arguments else 1))
            report, _ = play(runs, scene, f"table2_{scene.stem}_{setup.replace(' ', '_')}", "--compare", "frustum,oracle",
                             "--start", 20, "--rate", 30, *arguments, frames=frames)
            timing = report["timing"]
            gained = [timing["acceleration"][mode] for mode in ("frustum", "oracle")]
            by_mode = {one["culling"]: one for one in timing["runs"]}
            rows.append((scene.stem, setup, frames, *(cell(by_mode[mode]["frame_ms"]["mean"])
                                                     for mode in ("frustum", "service", "oracle")),
                         *(cell(gained[0][field]) for field in ("min", "mean", "max", "of_means")),
                         cell(gained[1]["of_means"]), by_mode["service"]["fallback_frames"]))
    yield f"`main_view play --culling service --compare frustum,oracle --size {PLAY_SIZE}`, from 20 s, both processes and OpenGL in"
    yield "software on the same cores, so the renderer also pays for the daemon. Milliseconds a frame; acceleration against"
    yield "view-frustum culling, frame by frame (min, mean, max) and of the mean times. `oracle` draws exactly what shows."
    yield ""
    yield from table(("scene", "set-up", "frames", "frustum, ms", "service, ms", "oracle, ms", "acceleration: min", "mean", "max",
                      "of means", "against oracle", "fallback frames"), rows)
    yield "The paper's abstract: from 8 to 32 stereo images a second, 4x, on an architectural model of 260,000 textured triangles"
    yield "(hardware of 2003, drawing and visibility test on different computers). The cells of its Table 2 could not be verified."
    yield ""


def fig6(runs):
    """Frame time along the whole path."""
    scene = scenes_named(("rotterdam",))[0]
    rate_hz = {"quick": 8, "normal": 8, "whole": 30}[runs.level.name]
    _, folder = play(runs, scene, f"fig6_{scene.stem}", "--compare", "frustum", "--rate", rate_hz,
                     frames=24 if runs.level.name == "quick" else int(60 * rate_hz))
    with open(folder / "frames.csv", newline="") as file:
        frames = list(csv.DictReader(file))
    lines = {mode: [(int(row["frame"]) / rate_hz, float(row[f"{mode}_ms"])) for row in frames]
             for mode in ("frustum", "service")}
    triangles = {mode: [(int(row["frame"]) / rate_hz, float(row[f"{mode}_triangles"])) for row in frames] for mode in lines}
    write_svg(IMAGES / "fig6.svg", [
        Chart(f"{scene.stem}: frame time", "path time, s", "ms", lines, markers=False),
        Chart(f"{scene.stem}: triangles drawn", "path time, s", "triangles", triangles, log_y=True, markers=False)])
    yield f"{scene.stem}, {rate_hz:g} frames of each second of the path, {PLAY_SIZE}, software OpenGL."
    yield ""
    yield from image("fig6.svg", "frame time along the path")
    yield from table(("culling", "median ms", "slowest ms", "triangles, mean"),
                     ((mode, cell(statistics.median(y for _, y in line)), cell(max(y for _, y in line)),
                       f"{statistics.mean(y for _, y in triangles[mode]):,.0f}") for mode, line in lines.items()))


def fig5(runs):
    """Layers in a pixel, before and after."""
    scene = scenes_named(("clinic",))[0]
    report, folder = play(runs, scene, f"fig5_{scene.stem}", "--rate", 30, "--start", 40, frames=4, size="1024x768")
    for which in ("frustum", "drawn"):
        shutil.copyfile(folder / f"depth_complexity_{which}.png", IMAGES / f"depth_complexity_{which}.png")
    images = report["images"]
    yield f"{scene.stem}, 40 s into the path: at most {images['depth_complexity_frustum_max']} layers in a pixel in the view frustum, "
    yield f"{images['depth_complexity_drawn_max']} with culling. The paper's colours: blue for one layer, red for most."
    yield ""
    yield from image("depth_complexity_frustum.png", "layers in the view frustum")
    yield from image("depth_complexity_drawn.png", "layers with culling")


def geometric_mean(values):
    logarithms = [math.log(value) for value in values if value and value > 1e-9]
    return math.exp(statistics.mean(logarithms)) if logarithms else None


def predicted(rows, predictor, horizon, field):
    return [row[field] for row in rows if row["predictor"] == predictor and row["horizon"] == horizon]


def predict(runs, name, traces):
    report = runs.main_view(name, "predict", "--trace", *traces, "--rate", 60, "--horizons", ",".join(map(str, HORIZONS)))
    return report["rows"]


def fig2(runs):
    motions = {"the walkthroughs": ("paths", [path_of(scene) for scene in scenes_named(ACCEPTED)]),
               "recorded heads": ("heads", sorted(TRACES.glob("*.csv")))}
    rows_of = {title: (stem, predict(runs, f"predict_{stem}", files)) for title, (stem, files) in motions.items() if files}
    yield "`main_view predict`, 60 Hz, frames ahead; means over a motion, geometric means over the motions."
    yield ""
    for title, (stem, rows) in rows_of.items():
        motions_here = sorted({row["trace"] for row in rows})
        charts = []
        for what, field in (("position, mm", "position_mm_mean"), ("rotation, degrees", "rotation_deg_mean")):
            charts.append(Chart(f"{title}: {what}", "frames ahead at 60 Hz", what,
                                {name: [(k, geometric_mean(predicted(rows, name, k, field))) for k in HORIZONS]
                                 for name in PREDICTORS}, log_x=False, log_y=True))
        write_svg(IMAGES / f"fig2_{stem}.svg", charts)
        yield f"### {title[0].upper()}{title[1:]}, {len(motions_here)}"
        yield ""
        yield from image(f"fig2_{stem}.svg", f"prediction error on {title}")
        for what, unit in (("position", "mm"), ("rotation", "deg")):
            yield from table(
                (f"{what}, {unit}: mean (p99)", *(f"k = {k}" for k in HORIZONS)),
                ((name, *(f"{cell(geometric_mean(predicted(rows, name, k, f'{what}_{unit}_mean')))} "
                          f"({cell(geometric_mean(predicted(rows, name, k, f'{what}_{unit}_p99')))})" for k in HORIZONS))
                 for name in PREDICTORS))
        yield from table(
            ("the announced region of `default`", *(f"k = {k}" for k in HORIZONS)),
            [("held the pose: mean over motions", *(percent(statistics.mean(predicted(rows, "default", k, "coverage")))
                                                   for k in HORIZONS)),
             ("held the pose: least of a motion", *(percent(min(predicted(rows, "default", k, "coverage"))) for k in HORIZONS)),
             ("radius, mm", *(cell(geometric_mean(predicted(rows, "default", k, "region_mm_mean"))) for k in HORIZONS)),
             ("radius, degrees", *(cell(geometric_mean(predicted(rows, "default", k, "region_deg_mean"))) for k in HORIZONS))])
    yield "The curves of the paper's Fig. 2 could not be verified; its choice, order 2 over 20 poses, is `avango` here."
    yield ""


def percent(value):
    return f"{100.0 * value:.2f} %"
