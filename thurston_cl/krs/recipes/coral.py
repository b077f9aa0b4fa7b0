"""A coral"""
import math
import numpy as np
from .branches import UP, Habit, Record, best_walk, record, rosette, walk, unit

def coral(*, branches=10, spread=math.radians(34), widen=0.0, lean=math.radians(12), turn=math.radians(100), trunk=.35, limb=.6, ratio=.86, thickness=.3, taper=.86, up=.3, upright=.5, loose=.5, polyps=2, tip=1.12, seed=0) -> Record:
    rng = np.random.default_rng(seed)
    habit = Habit(branches, spread, widen, lean, turn, trunk+thickness, limb, ratio, .5*thickness, taper, up, upright, loose)
    route = best_walk(lambda: walk(rng, np.array([0,0,-thickness]), UP, habit))
    radius = route.kernels[-1]["r"]
    end = route.forks[-1]
    def grown(level, outwards):
        if level == polyps:
            return {"type": "sphere", "c": end.tolist(), "r": tip*radius, "mat": 1}
        c = end - route.along*radius*1.3*(polyps-level) + outwards*radius*.9
        return {"type": "sphere", "c": c.tolist(), "r": .45*radius, "mat": 0}
    m, k = rosette(rng, route, polyps+1, grown)
    return record([*route.mirrors, *m], [*route.kernels, *k])
