"""Kernel-reflection sequences: trees, corals, rocks and fields of them from a few kernels and mirrors.

model = tc.krs.Model.from_dict(tc.krs.tree(seed=3)); model.distance(points), model.normal(points), ...
"""

from thurston_cl.krs.model import Model

__all__ = ["Model"]
