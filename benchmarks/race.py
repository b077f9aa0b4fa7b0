"""Ways to render a scene that run in turn, again and again, so that their times can be compared."""

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from thurston_cl.device import Device
from thurston_cl.method import Method
from thurston_cl.rendering import TileRenderer, tiles
from thurston_cl.sampling import sample_shifts
from thurston_cl.scene import load_scene
from thurston_cl.scene.plan import make_plan

SCENES = Path(__file__).parent / "scenes"


@dataclass
class Contender:
    """One way to render a scene, with the core-seconds of its runs."""

    name: str
    renderer: TileRenderer
    size: tuple[int, int]
    seconds: list[float] = field(default_factory=list)
    work: dict[str, float] = field(default_factory=dict)

    @property
    def steps(self) -> float:
        """Steps of all rays in a run."""
        return sum(self.work[name] for name in ("steps", "shadow_steps", "reflection_steps"))

    def run(self) -> None:
        """Render once; keep the processor time and the work that is counted."""
        before = time.process_time()
        self.work = {}
        whole = list(tiles((0, 0, *self.size), self.renderer.side))
        # The middle first, as in a picture: it says how to go on.
        whole.insert(0, whole.pop(len(whole) // 2))
        for tile in whole:
            _, counts = self.renderer.run(tile, sample_shifts(1), ["beauty"])
            self.work = {name: self.work.get(name, 0.0) + count for name, count in counts.items()}
        self.seconds.append(time.process_time() - before)

    @property
    def median(self) -> float:
        """Core-seconds of a run."""
        return statistics.median(self.seconds[1:])


def contender(
    device: Device,
    scene_file: str,
    name: str,
    precision: str,
    lanes: int,
    finish: str,
    *,
    sets: Sequence[str] = (),
    switch: bool | None = None,
) -> Contender:
    """Build the program of one contender; `sets` change the scene, `switch` is that of `make_plan`."""
    scene = load_scene(SCENES / scene_file, sets=sets)
    plan = make_plan(scene, device=device, method=Method.of(scene, precision=precision), switch=switch)
    return Contender(name, TileRenderer(plan, device, lanes, finish), scene.render.size)


def race(title: str, contenders: list[Contender], repeat: int) -> None:
    """Run the contenders in turn, again and again, and print the medians relative to the first."""
    for _ in range(repeat + 1):
        for each in contenders:
            each.run()
    print(f"\n{title}")
    print(f"  {'':50} {'core-ms':>9} {'ratio':>7} {'min':>6} {'max':>6} {'Msteps/s':>9}")
    first = contenders[0]
    for each in contenders:
        ratios = [a / b for a, b in zip(each.seconds[1:], first.seconds[1:], strict=True)]
        print(
            f"  {each.name:50} {1e3 * each.median:9.1f} {statistics.median(ratios):7.2f} {min(ratios):6.2f}"
            f" {max(ratios):6.2f} {1e-6 * each.steps / each.median:9.1f}"
        )
