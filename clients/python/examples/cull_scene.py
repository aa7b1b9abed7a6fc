#!/usr/bin/env python3
"""Culls a scene for another renderer: walks a camera path through a GLB file and writes which objects to draw in each
frame.

    control_view &                    # the scene is uploaded where the daemon does not have it
    cull_scene.py building.glb walk.csv --out sets.csv

The file has a line a frame, `frame,ids`: the frame's number and the ids with spaces between them, or * where the
daemon had no answer and everything has to be drawn. An id is an object's place in the order of `read_glb`; --names
writes which node of the file each is. `main_view judge` counts what an image drawn from it would have wrong.
"""

import argparse
import math
import sys
import time

import sightline

MOST_UNANSWERED = 3  # frames in a row; then the daemon is gone, and the rest would wait in vain


def main():
    options = parse()
    try:
        return run(options)
    except (sightline.SightlineError, ValueError, OSError) as error:
        print(f"cull_scene: {error}", file=sys.stderr)
        return 2


def run(options):
    scene, names = sightline.read_glb(options.scene)
    data = scene.data()
    path = sightline.CameraPath(options.path)
    aspect = options.size[0] / options.size[1]
    lens = sightline.perspective(math.radians(options.fov), aspect, options.near, options.far)
    if options.names:
        with open(options.names, "w", encoding="utf-8") as out:
            out.writelines(f"{i} {name}\n" for i, name in enumerate(names))

    known = {"digest": options.digest, "object_count": data.object_count} if options.digest else {"scene": data}
    with sightline.Culler(options.connect, **known) as culler, open(options.out, "w", encoding="ascii") as out:
        began = time.monotonic()
        culler.wait_until_open(options.timeout)
        upload = culler.session.upload
        print(f"ready after {time.monotonic() - began:.2f} s, "
              f"{upload.chunks_sent if upload else 0} of {len(data.offer.chunk_digests) // 16} chunks sent")
        out.write("frame,ids\n")
        frames = range(0, math.floor(path.duration_s * options.rate + 1e-6) + 1, options.every)
        objects = triangles = unanswered = unanswered_in_a_row = 0
        began = time.monotonic()
        for frame in frames:
            visible = culler.ask(path.at(frame / options.rate), lens, options.size, timeout_s=options.timeout,
                                 control_size=options.control_size)
            if visible is None:
                unanswered += 1
                unanswered_in_a_row += 1
                out.write(f"{frame},*\n")
                out.flush()
                print(f"frame {frame}: no answer from {options.connect} within {options.timeout:g} s", file=sys.stderr)
                if unanswered_in_a_row == MOST_UNANSWERED:
                    raise sightline.SightlineError(f"{options.connect} has stopped answering; frames from {frame} on are missing")
                continue
            unanswered_in_a_row = 0
            out.write(f"{frame},{' '.join(map(str, visible.ids))}\n")
            objects += len(visible)
            triangles += int(data.triangles[visible.ids].sum())
        answered = len(frames) - unanswered
        print(f"{len(frames)} frames in {time.monotonic() - began:.2f} s, {unanswered} without an answer")
        if answered:
            print(f"to draw, mean of a frame: {objects / answered:.1f} of {data.object_count} objects, "
                  f"{triangles / answered:.0f} of {data.triangle_count} triangles "
                  f"({100.0 * (1.0 - triangles / answered / max(1, data.triangle_count)):.2f} % left out)")
    return 0 if unanswered == 0 else 1


def image_size(text):
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit()):
        raise argparse.ArgumentTypeError(f"must be WxH pixels, not '{text}'")
    return int(width), int(height)


def whole_image_size(text):
    size = image_size(text)
    if 0 in size:
        raise argparse.ArgumentTypeError(f"must have sides from 1, not '{text}'")
    return size


def from_one(text):
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a number from 1, not '{text}'")
    return int(text)


def parse():
    parser = argparse.ArgumentParser(description="Write which objects of a GLB each frame of a camera path shows.")
    parser.add_argument("scene", help="binary glTF file")
    parser.add_argument("path", help="CSV t,px,py,pz,qw,qx,qy,qz: seconds, metres, camera to world")
    parser.add_argument("--out", required=True, help="the sets, a line a frame")
    parser.add_argument("--names", help="file for the name of each id")
    parser.add_argument("--connect", default="tcp://127.0.0.1:5571", help="endpoint of control_view [%(default)s]")
    parser.add_argument("--digest", help="of the scene as main_view info prints it: the daemon has the same file")
    parser.add_argument("--size", type=whole_image_size, default=(1024, 768), help="image, WxH pixels [1024x768]")
    parser.add_argument("--control-size", type=image_size, help="image the daemon looks at, 0x0 for its own [--size]")
    parser.add_argument("--fov", type=float, default=60.0, help="vertical field of view, degrees [60]")
    parser.add_argument("--near", type=float, default=0.1, help="near plane, metres [0.1]")
    parser.add_argument("--far", type=float, default=10000.0, help="far plane, metres, or inf [10000]")
    parser.add_argument("--rate", type=float, default=60.0, help="frames a second of the path [60]")
    parser.add_argument("--every", type=from_one, default=1, help="every N-th frame only [1]")
    parser.add_argument("--timeout", type=float, default=30.0, help="seconds to wait for the daemon [30]")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
