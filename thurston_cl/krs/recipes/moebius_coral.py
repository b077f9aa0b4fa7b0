"""A coral of which no branch equals another: that of coral.py, bent (KRS paper, section 6)."""

from typing import Any

from .coral import coral
from .guard import guarded
from .moebius_of import moebius_of


@guarded()
def moebius_coral(*, strength: float = 0.18, seed: int = 0, **others: Any) -> dict[str, Any]:
    """The Moebius record of a coral with the parameters `others` of `coral`, bent with a strength of 0, the
    coral itself, to 0.6, wild (see `moebius_of`)."""
    return moebius_of(coral(seed=seed, **others), strength=strength, seed=seed)
