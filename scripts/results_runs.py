"""Runs of the two executables for scripts/results: what to run, several at a time, and their reports."""

import concurrent.futures
import dataclasses
import os
import pathlib
import sys
import time

from engine_bench import Failed, path_of, read_json, run


@dataclasses.dataclass(frozen=True)
class Level:
    """How much is measured."""

    name: str
    acceptance_frames: int | None  # of each path; None for the whole
    exact_rate_hz: float
    sweep_frames: int
    sweep_scenes: int
    trace_frames: int
    price_frames: int
    play_frames: int
    views: int

    def with_views(self, views):
        return dataclasses.replace(self, views=views)


LEVELS = {level.name: level for level in (
    Level("quick", 90, 0.1, 60, 1, 60, 60, 12, 4),
    Level("normal", None, 3.0, 360, 2, 450, 300, 40, 24),
    Level("whole", None, 6.0, 3600, 2, 3600, 1200, 240, 60),
)}


@dataclasses.dataclass(frozen=True)
class Audit:
    """One run of `main_view audit --spawn`."""

    name: str  # of its report
    scene: pathlib.Path
    preset: str = "default"
    latency_ms: float = 50
    control_rate_hz: float | None = 30
    control_size: str = "512x384"
    rate_hz: float = 60
    start_s: float = 0
    frames: int | None = None
    lead_in_s: float = 0
    filter: int | None = None
    rotations: pathlib.Path | None = None
    turn: str = "0"

    def arguments(self):
        words = ["--preset", self.preset, "--latency", self.latency_ms, "--control-size", self.control_size,
                 "--rate", self.rate_hz, "--start", self.start_s,
                 "--lead-in", self.lead_in_s]
        for option, value in (("--control-rate", self.control_rate_hz), ("--frames", self.frames),
                              ("--filter", self.filter), ("--rotations", self.rotations)):
            if value is not None:
                words += [option, value]
        return [str(word) for word in (*words, "--turn", self.turn)]

    @property
    def views(self):
        """Names the views that this audit looks at: those of one name share one file of what is visible."""
        motion = self.rotations.stem if self.rotations else ""
        return "_".join(filter(None, (self.scene.stem, motion, f"turn{self.turn}" if self.turn != "0" else "",
                                      f"{self.rate_hz:g}hz" if self.rate_hz != 60 else "")))


class Runs:
    """Where executables and reports are. With `reuse`, a report that is there is not measured again."""

    def __init__(self, bin_folder, out, level, jobs, engine="auto", reuse=False):
        self.bin_folder, self.out, self.level, self.jobs = bin_folder, out, level, jobs
        self.engine, self.reuse = engine, reuse
        self.reports = self.out / level.name if out else None  # the reports of another level are no use

    def tell(self, what):
        print(f"results: {what}", flush=True)

    def report_of(self, name, command, folder=""):
        """Runs `command` unless its report is there and may be used again; gives the report."""
        report = self.reports / folder / f"{name}.json"
        report.parent.mkdir(parents=True, exist_ok=True)
        if not (self.reuse and report.is_file()):
            begin = time.monotonic()
            report.unlink(missing_ok=True)
            run([str(word) for word in (*command, "--json", report)], report.with_suffix(".log"))
            self.tell(f"{name}: {time.monotonic() - begin:.0f} s")
        return read_json(report)

    def main_view(self, name, *arguments, before=(), folder=""):
        return self.report_of(name, [*before, self.bin_folder / "main_view", *arguments], folder)

    def audit(self, audit):
        truth = self.out / "truth" / f"{audit.views}.truth"
        truth.parent.mkdir(parents=True, exist_ok=True)
        return self.main_view(audit.name, "audit", "--spawn", "--engine", self.engine, "--scene", audit.scene,
                              "--path", path_of(audit.scene), "--truth", truth, *audit.arguments(), folder="audits")

    def audits(self, audits):
        """Reports by name, as many at a time as there are jobs. The first of each set of views goes ahead: it finds out
        what is visible, and the others need not."""
        names = [audit.name for audit in audits]
        if len(set(names)) != len(names):
            raise Failed("two audits would write one report: " + ", ".join(sorted(n for n in names if names.count(n) > 1)))
        first = {}
        for audit in sorted(audits, key=lambda audit: -(audit.frames or sys.maxsize)):
            first.setdefault(audit.views, audit)
        ahead = list(first.values())
        rest = [audit for audit in audits if audit not in ahead]
        reports = {}
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            for batch in (ahead, rest):
                reports |= dict(zip((audit.name for audit in batch), pool.map(self.audit, batch)))
        return reports


def use_one_thread_each(jobs):
    """Several software renderers at a time shall not share each core among them all."""
    if jobs > 1:
        os.environ["LP_NUM_THREADS"] = str(max(1, (os.cpu_count() or 1) // jobs))
