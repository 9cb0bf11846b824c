"""Stretches of the route during which something is present."""

from typing import NamedTuple, Tuple

from omnitag.yaml_file import Mapping


class Stretches(NamedTuple):
    """Stretches of a route; if there are none, the whole route."""

    bounds: Tuple[Tuple[int, int], ...] = ()
    """First and last moment of each stretch, both included: nanoseconds on the route's clock."""

    def cover(self, moment: int) -> bool:
        """Whether `moment`, in nanoseconds on the route's clock, is within a stretch."""
        return not self.bounds or any(first <= moment <= last for first, last in self.bounds)


ALWAYS = Stretches()


def read_during(entry: Mapping) -> Stretches:
    """Read the optional key `during: [[from, until], ...]` of an entry, in seconds."""
    if "during" not in entry:
        return ALWAYS
    bounds = []
    for item in entry["during"].items("a list of [from, until]"):
        first, last = item.reals(2)
        if first > last:
            raise item.error("the earlier stamp first", f"[{first:g}, {last:g}]")
        bounds.append((round(first * 1e9), round(last * 1e9)))
    if not bounds:
        raise entry["during"].error("at least one [from, until]", "an empty list")
    return Stretches(tuple(bounds))
