"""How long the programs of scenes take to build, cold and from the caches: from the plan of a scene to its
second tile, 32 x 32 pixels, one sample. Targets: 6 s and 0.2 s. Processor time: one thread compiles, and what
else the machine does hardly matters.

Run as `python benchmarks/builds.py [SCENE ...]`; without names over the whole library, slowest first.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def measure(names: list[str]) -> dict[str, float]:
    """Seconds by scene, in this process."""
    from thurston_cl import device as devices
    from thurston_cl.rendering import Tile, TileRenderer
    from thurston_cl.sampling import sample_shifts
    from thurston_cl.scene import load_scene
    from thurston_cl.scene.plan import make_plan

    device = devices.choose()
    seconds = {}
    for name in names:
        scene = load_scene(name)
        plan = make_plan(scene, device=device, size=(32, 32))
        before = time.process_time()
        renderer = TileRenderer(plan, device, device.info.lane_width("single"), scene.render.finish)
        # The first tile may choose the kernel of the others.
        for _ in range(2):
            renderer.run(Tile(0, 0, 32, 32), sample_shifts(1), ["beauty"])
        seconds[name] = time.process_time() - before
    return seconds


def main() -> None:
    if sys.argv[1:2] == ["--measure"]:
        print(json.dumps(measure(sys.argv[2:])))
        return
    from thurston_cl.scene.library import library_names

    names = sys.argv[1:] or library_names()
    with tempfile.TemporaryDirectory() as folder:
        fresh = {"XDG_CACHE_HOME": folder, "POCL_CACHE_DIR": str(Path(folder, "pocl"))}
        cold, cached = (
            json.loads(
                subprocess.run(
                    [sys.executable, __file__, "--measure", *names],
                    env=os.environ | fresh,
                    stdout=subprocess.PIPE,
                    text=True,
                    check=True,
                ).stdout
            )
            for _ in range(2)
        )
    print(f"{'scene':40} {'cold':>7} {'cached':>7}  seconds")
    for name in sorted(cold, key=cold.__getitem__, reverse=True):
        print(f"{name:40} {cold[name]:7.2f} {cached[name]:7.2f}")


if __name__ == "__main__":
    main()
