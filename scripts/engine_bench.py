"""What scripts/bench and scripts/results share: the scenes engines are measured on, and one run over one of them."""

import json
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Failed(Exception):
    """One benchmark could not run; the others still do."""


def run(command, log):
    """Runs to its end with its output in `log`; raises Failed naming both."""
    try:
        with open(log, "w") as sink:
            done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=sink, stderr=subprocess.STDOUT)
    except OSError as error:
        raise Failed(f"{command[0]} does not start: {error.strerror}") from error
    if done.returncode:
        lines = pathlib.Path(log).read_text(errors="replace").splitlines()
        raise Failed(f"{pathlib.Path(command[0]).name} ended with {done.returncode}: {lines[-1] if lines else 'no output'}")


def read_json(path):
    try:
        return json.loads(pathlib.Path(path).read_text())
    except (OSError, ValueError) as error:
        raise Failed(f"no readable {path}: {error}") from error


def path_of(scene):
    """The camera path beside a scene; clinic.path.csv leads through clinic_ground.glb too."""
    stems = (scene.stem, scene.stem.rsplit("_", 1)[0])
    return next((path for path in (scene.with_name(f"{stem}.path.csv") for stem in stems) if path.is_file()), None)


def scenes_at_hand():
    """Those of ../shared/scenes where that folder is there, and the bundled one otherwise."""
    shared = sorted((ROOT.parent / "shared" / "scenes").glob("*.glb"))
    return shared or sorted((ROOT / "scenes").glob("*.glb"))


def generated_scene(bin_folder, kind, objects, folder):
    """A city or crowd of so many objects, made once a folder; the same on every machine."""
    scene = folder / f"{kind}_{objects}.glb"
    if not scene.is_file() or not path_of(scene):
        folder.mkdir(parents=True, exist_ok=True)
        run([str(bin_folder / "main_view"), "generate", kind, "--objects", str(objects), "--seed", "1",
             "--out", str(scene), "--path-out", str(scene.with_suffix(".path.csv"))], scene.with_suffix(".log"))
    return scene


def bench_engines(bin_folder, scene, report, *arguments, before=()):
    """`control_view bench` on a scene and the path beside it; gives the report, which stays in `report`."""
    run([*before, str(bin_folder / "control_view"), "bench", "--scene", str(scene), "--path", str(path_of(scene)),
         "--json", str(report), *map(str, arguments)], report.with_suffix(".log"))
    return read_json(report)
