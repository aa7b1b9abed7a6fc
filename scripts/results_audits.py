"""Sections of docs/results.md that the audit measures: wrong pixels, conservativity, price."""

from engine_bench import ROOT, Failed, scenes_at_hand
from results_page import IMAGES, cell, image, ratio, share, table
from results_runs import Audit
from svg_plot import Chart, write_svg

PRESETS = ("avango", "default")
LATENCIES_MS = (50, 100, 200)
ACCEPTED = ("rotterdam", "denhaag01", "clinic", "walker_assembly")
TRACES = ROOT.parent / "shared" / "traces"
# Where each path is busy: the streets of rotterdam, the doors of the clinic.
SWEPT = {"rotterdam": 20, "clinic": 40, "clinic_ground": 40}
TURN_FRAMES = 300  # a head stands still for two seconds before its first turn
SWEEPS = {
    "latency": ("latency, ms", {f"{ms}": {"latency_ms": ms} for ms in (0, 25, 50, 100, 150, 200, 250)}),
    "rate": ("answers a second", {f"{hz}": {"control_rate_hz": hz} for hz in (5, 10, 20, 30, 60)}),
    "resolution": ("control image", {size: {"control_size": size}
                                     for size in ("128x96", "256x192", "512x384", "1024x768")}),
    "filter": ("answers averaged", {f"{n}": {"filter": n} for n in (1, 2, 4, 8, 16)}),
    "turn": ("head turn, degrees a second", {"0": {}} | {speed: {"turn": speed} for speed in ("60", "180", "300", "inf")}),
}


def scenes_named(names):
    """Those of `names` that are here; the bundled scene where none is."""
    scenes = {scene.stem: scene for scene in scenes_at_hand()}
    return [scenes[name] for name in names if name in scenes] or list(scenes.values())[:1]


def quality_head(*first):
    return (*first, "frames", "wrong frames", "wrong pixels: mean", "p99", "max", "conservativity", "its p99", "fallback frames",
            "changes a frame, drawn / true")


def quality_cells(report):
    quality = report["quality"]
    return (quality["frames"], quality["frames_with_wrong_pixels"], share(quality["wrong_pixels_mean"]),
            share(quality["wrong_pixels_p99"]), share(quality["wrong_pixels_max"]), cell(quality["conservativity_mean"]),
            cell(quality["conservativity_p99"]), quality["fallback_frames"],
            f"{quality['state_changes_drawn_mean']:.2f} / {quality['state_changes_true_mean']:.2f}")


def settings_line(report):
    """The settings of both sides, as a report gives them."""
    settings = report["settings"]
    client = ("predictor", "predictor_order", "predictor_window", "min_guard_deg", "max_guard_deg", "max_staleness_s",
              "unite_all_later_sets", "draw_untested")
    daemon = ("engine", "filter", "threshold", "refine", "counter")

    def said(names):
        return ", ".join(f"{name} {settings[name]:g}" if isinstance(settings[name], float) else f"{name} {settings[name]}"
                         for name in names if settings.get(name) not in (None, ""))

    return f"`{settings['preset']}`: client {said(client)}; daemon {said(daemon)}."


def exact(runs):
    """No latency, equal resolution, no filter."""
    audits = [Audit(f"exact_{preset}_{scene.stem}", scene, preset, latency_ms=0, control_size="1024x768", filter=1,
                    control_rate_hz=None, rate_hz=runs.level.exact_rate_hz)
              for scene in scenes_named((*ACCEPTED, "clinic_ground")) for preset in PRESETS]
    reports = runs.audits(audits)
    yield f"`main_view audit --spawn --latency 0 --control-size 1024x768 --filter 1 --rate {runs.level.exact_rate_hz:g}`, main"
    yield "image 1024x768, whole path."
    yield ""
    yield from table(quality_head("scene", "preset"),
                     ((audit.scene.stem, audit.preset, *quality_cells(reports[audit.name])) for audit in audits))


def acceptance(runs):
    audits = [Audit(f"{preset}_{scene.stem}_{latency}ms", scene, preset, latency, lead_in_s=1, frames=runs.level.acceptance_frames)
              for scene in scenes_named(ACCEPTED) for latency in LATENCIES_MS for preset in PRESETS]
    reports = runs.audits(audits)
    frames = runs.level.acceptance_frames
    yield "`main_view audit --spawn --rate 60 --control-rate 30 --control-size 512x384 --latency MS --preset NAME`, main image"
    yield f"1024x768, {f'the first {frames} frames of each path' if frames else 'every frame of each path'}. Shares are of a frame's pixels."
    yield "The camera first waits for a second where the path begins (`--lead-in 1`); without that, the frames until the first answer,"
    yield "3, 6 and 12 of them, are drawn with view-frustum culling alone."
    yield ""
    yield from table(quality_head("scene", "latency, ms", "preset"),
                     ((audit.scene.stem, audit.latency_ms, audit.preset, *quality_cells(reports[audit.name]))
                      for audit in audits))
    yield "The settings in force on both sides:"
    yield ""
    for preset in PRESETS:
        yield f"- {settings_line(next(reports[audit.name] for audit in audits if audit.preset == preset))}"
    yield ""


def traces(runs):
    """Every trace over the cheap scenes, two over the dear ones."""
    heads = sorted(TRACES.glob("*.csv"))
    if not heads:
        raise Failed(f"no traces in {TRACES}: this section stays as it is")
    if runs.level.name == "quick":
        heads = heads[:2]
    light = scenes_named(("rotterdam", "denhaag01"))
    some = [head for head in heads if head.stem in ("hmd_questpro_treehill_u113", "game_quake_librehades")]
    heavy = [scene for scene in scenes_named(("clinic", "walker_assembly")) if scene not in light]
    pairs = [(scene, head) for scene in light for head in heads] + [(scene, head) for scene in heavy for head in some]
    audits = [Audit(f"head_{preset}_{scene.stem}_{head.stem}", scene, preset, rotations=head, start_s=SWEPT.get(scene.stem, 5), lead_in_s=1,
                    frames=runs.level.trace_frames)
              for scene, head in pairs for preset in PRESETS]
    reports = runs.audits(audits)
    yield "The rotation of a recorded head laid over the path's (`audit --rotations`), 50 ms, 30 answers a second, 512x384, "
    yield f"{runs.level.trace_frames} frames from where each path is busy, after a second that is not judged."
    yield ""
    yield from table(quality_head("scene", "head", "preset"),
                     ((audit.scene.stem, audit.rotations.stem, audit.preset, *quality_cells(reports[audit.name]))
                      for audit in audits))


def swept_audits(scene, frames):
    """{(sweep, value, preset): Audit}; a point that two sweeps share is measured once."""
    audits, by_settings = {}, {}
    for sweep, (_, values) in SWEEPS.items():
        for value, settings in values.items():
            for preset in PRESETS:
                # What Audit has by itself is a point of most sweeps. How many answers a preset averages is its own affair.
                full = {"latency_ms": 50, "control_rate_hz": 30, "control_size": "512x384", "filter": None, "turn": "0"} | settings
                audit = Audit(f"sweep_{preset}_{scene.stem}_{sweep}_{value}", scene, preset, start_s=SWEPT.get(scene.stem, 0),
                              lead_in_s=1, frames=max(frames, TURN_FRAMES) if "turn" in settings else frames, **settings)
                key = (preset, *full.items())
                by_settings.setdefault(key, audit)
                audits[sweep, value, preset] = by_settings[key]
    return audits


def sweep_charts(sweep, reports):
    label, values = SWEEPS[sweep]
    fields = (("wrong pixels, share of a frame", "wrong_pixels_mean", True, 1.0),
              ("frames with a wrong pixel, %", "frames_with_wrong_pixels", False, 100.0),
              ("conservativity", "conservativity_mean", False, 1.0))
    for title, field, log_y, factor in fields:
        lines = {}
        for preset in PRESETS:
            lines[preset] = []
            for place, value in enumerate(values):
                quality = reports[sweep, value, preset]["quality"]
                frames = quality["frames"] if field == "frames_with_wrong_pixels" else 1
                lines[preset].append((place, factor * quality[field] / frames))
        yield Chart(title, label, "", lines, log_y=log_y, names=tuple(values))


def sweeps(runs):
    scenes = scenes_named([name for name in SWEPT if name != "clinic_ground"])[:runs.level.sweep_scenes]
    planned = {scene: swept_audits(scene, runs.level.sweep_frames) for scene in scenes}
    done = runs.audits(list({audit.name: audit for audits in planned.values() for audit in audits.values()}.values()))
    yield "One setting at a time is changed from 50 ms, 30 answers a second, 512x384 against 1024x768, the preset's own filter, no head turn;"
    yield f"{runs.level.sweep_frames} frames of each path from where it is busy. A head turn is half a circle, again and again, with two"
    yield "seconds between; `inf` takes no time. A second before is not judged."
    yield ""
    for scene, audits in planned.items():
        reports = {key: done[audit.name] for key, audit in audits.items()}
        yield f"### {scene.stem}"
        yield ""
        for sweep, (label, values) in SWEEPS.items():
            name = f"sweep_{sweep}_{scene.stem}.svg"
            write_svg(IMAGES / name, list(sweep_charts(sweep, reports)), columns=3)
            yield from image(name, f"{scene.stem}: {label}")
            yield from table(
                (label, *(f"{preset}: {what}" for preset in PRESETS
                          for what in ("wrong frames", "wrong pixels, mean", "max", "conservativity", "fallback"))),
                ((value, *(text for preset in PRESETS for text in sweep_cells(reports[sweep, value, preset])))
                 for value in values))


def sweep_cells(report):
    quality = report["quality"]
    return (f"{quality['frames_with_wrong_pixels']} of {quality['frames']}", share(quality["wrong_pixels_mean"]),
            share(quality["wrong_pixels_max"]), cell(quality["conservativity_mean"]), quality["fallback_frames"])


def price(runs):
    """One audit at a time: times shall not be those of two."""
    scenes = scenes_named(ACCEPTED)
    rows = []
    for scene in scenes:
        timing = {}
        for preset in PRESETS:
            timing[preset] = runs.audit(Audit(f"price_{preset}_{scene.stem}", scene, preset,
                                              start_s=SWEPT.get(scene.stem, 5), frames=runs.level.price_frames))["timing"]
        both = [timing[preset] for preset in PRESETS]
        row = [scene.stem]
        for field in ("control_ms_mean", "control_ms_p50", "control_ms_p99", "request_bytes_mean", "answer_bytes_mean"):
            avango, ours = (value[field] for value in both)
            row.append(f"{cell(avango)} / {cell(ours)} ({ratio(ours, avango)})")
        rows.append(row)
    yield "`avango` / `default` (how many times as much), same engine, 50 ms, 30 answers a second, 512x384,"
    yield f"{runs.level.price_frames} frames. Control-view time is cull, draw, count and filter of one answer."
    yield ""
    yield from table(("scene", "control view, ms: mean", "p50", "p99", "bytes a request", "bytes an answer"), rows)
