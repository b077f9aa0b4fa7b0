"""Guesses at what somebody meant: synonyms from other programs first, then near spellings."""

import difflib
from collections.abc import Iterable

# word as people write it elsewhere -> our keys, the most likely first; spelled as `_plain` leaves it.
SYNONYMS: dict[str, tuple[str, ...]] = {
    "albedo": ("color",),
    "aa": ("samples",),
    "amount": ("density", "intensity"),
    "and": ("intersection",),
    "antialiasing": ("samples",),
    "aovs": ("channels",),
    "axis": ("along",),
    "bank": ("roll",),
    "brightness": ("intensity",),
    "center": ("at",),
    "centre": ("at",),
    "chequer": ("checker",),
    "checkerboard": ("checker",),
    "colour": ("color",),
    "colours": ("colors",),
    "copies": ("translates",),
    "dimensions": ("size",),
    "dir": ("along", "normal", "towards"),
    "direction": ("along", "normal", "towards", "look"),
    "energy": ("intensity",),
    "eps": ("threshold",),
    "epsilon": ("threshold",),
    "ev": ("exposure",),
    "exp": ("exponential",),
    "exponent": ("shininess",),
    "eye": ("at",),
    "fading": ("falloff",),
    "falls": ("falloff",),
    "fieldofview": ("fov",),
    "filename": ("file",),
    "floor": ("half-space",),
    "fundamentaldomain": ("domain",),
    "gloss": ("shininess",),
    "glossiness": ("shininess",),
    "ground": ("half-space",),
    "group": ("manifold",),
    "haze": ("fog",),
    "heatmap": ("shows",),
    "heading": ("yaw",),
    "height": ("offset", "size"),
    "horizon": ("far",),
    "id": ("name",),
    "images": ("translates",),
    "intersect": ("intersection",),
    "inverse": ("complement",),
    "invert": ("complement",),
    "iterations": ("steps",),
    "join": ("union",),
    "ka": ("ambient",),
    "kd": ("diffuse",),
    "ks": ("specular",),
    "label": ("name",),
    "lattice": ("manifold",),
    "layer": ("slab",),
    "layers": ("channels",),
    "lens": ("projection",),
    "location": ("at",),
    "lookat": ("look",),
    "matrices": ("generators",),
    "maxdistance": ("far",),
    "maxsteps": ("steps",),
    "merge": ("union",),
    "minus": ("difference",),
    "mist": ("fog",),
    "moves": ("move",),
    "negate": ("complement",),
    "not": ("complement",),
    "or": ("union",),
    "orbifold": ("manifold",),
    "origin": ("at",),
    "pan": ("yaw",),
    "parameters": ("params",),
    "passes": ("channels",),
    "ou": ("top-bottom",),
    "overunder": ("top-bottom",),
    "path": ("file", "move"),
    "pipe": ("cylinder",),
    "pixels": ("size",),
    "plate": ("slab",),
    "plane": ("half-space",),
    "pos": ("at",),
    "position": ("at",),
    "power": ("intensity",),
    "quotient": ("manifold",),
    "r": ("radius",),
    "redblue": ("anaglyph",),
    "redcyan": ("anaglyph",),
    "resolution": ("size",),
    "rod": ("cylinder",),
    "rotation": ("rotate",),
    "roughness": ("shininess",),
    "sbs": ("side-by-side",),
    "scale": ("count",),
    "sdf": ("distance",),
    "shapes": ("objects",),
    "sky": ("background",),
    "space": ("geometry",),
    "sphere": ("ball",),
    "spin": ("rotate",),
    "stripes": ("strips", "bands"),
    "spp": ("samples",),
    "squares": ("count",),
    "strength": ("intensity",),
    "substract": ("difference",),
    "subtract": ("difference",),
    "target": ("look", "to"),
    "thickness": ("width",),
    "tb": ("top-bottom",),
    "tilt": ("pitch",),
    "tolerance": ("threshold",),
    "tonemap": ("view",),
    "tonemapping": ("view",),
    "toward": ("towards", "to"),
    "tube": ("cylinder",),
    "turn": ("rotate",),
    "variables": ("params",),
    "vars": ("params",),
    "walls": ("domain",),
    "width": ("size", "thickness"),
}

# Below this ratio of common letters a guess is more likely to mislead than to help (difflib's own default).
_CUTOFF = 0.6
# A word that is only near to a synonym must be nearer to it, for there are many of them.
_SYNONYM_CUTOFF = 0.8


def nearest(word: str, candidates: Iterable[str]) -> str | None:
    """The candidate that `word` most likely means, if any: same letters, synonyms, then near spellings."""
    by_plain = {_plain(candidate): candidate for candidate in candidates}
    known = set(by_plain.values())
    plain = _plain(word)
    if plain in by_plain:
        return by_plain[plain]
    # A near spelling of a synonym counts too: 'postion' means 'position', hence 'at', and not 'projection'.
    synonyms = {
        synonym: next(target for target in targets if target in known)
        for synonym, targets in SYNONYMS.items()
        if not known.isdisjoint(targets)
    }
    meanings = {**synonyms, **by_plain}
    if plain in synonyms:
        return synonyms[plain]
    close = difflib.get_close_matches(plain, meanings, n=len(meanings) or 1, cutoff=_CUTOFF)
    for spelling in close:
        if spelling in by_plain or difflib.SequenceMatcher(None, spelling, plain).ratio() >= _SYNONYM_CUTOFF:
            return meanings[spelling]
    return None


def did_you_mean(word: str, candidates: Iterable[str], otherwise: str | None = None) -> str | None:
    """A help line for an unknown `word`: the likely candidate, else `otherwise`."""
    guess = nearest(word, candidates)
    return f"did you mean '{guess}'?" if guess else otherwise


def blank_after_colon(text: str, keys: Iterable[str]) -> str | None:
    """A help line for a text such as 'radius:1', which YAML does not read as a key and its value."""
    key, colon, value = text.partition(":")
    if not colon or not value or key not in set(keys):
        return None
    return f"a blank is missing after the colon: write '{key}: {value}'"


def listing(words: Iterable[str], limit: int = 12) -> str:
    """Words for a message, cut short where there are many."""
    words = list(words)
    return ", ".join(words[:limit]) + (", ..." if len(words) > limit else "")


def _plain(word: str) -> str:
    return "".join(character for character in word.lower() if character.isalnum())
