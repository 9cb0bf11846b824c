"""Numbers of camera and world files within their bounds; each function raises InputError otherwise."""

from omnitag.yaml_file import Value

LARGEST_SEED = 2**32 - 1


def positive(value: Value) -> float:
    """A number above 0."""
    number = value.real()
    if number <= 0.0:
        raise value.error("a positive number")
    return number


def positive_integer(value: Value) -> int:
    """A whole number above 0."""
    number = value.integer()
    if number <= 0:
        raise value.error("a positive integer")
    return number


def not_negative(value: Value) -> float:
    """A number of at least 0."""
    number = value.real()
    if number < 0.0:
        raise value.error("a number of at least 0")
    return number


def seed(value: Value) -> int:
    """The seed of random numbers."""
    number = value.integer()
    if not 0 <= number <= LARGEST_SEED:
        raise value.error(f"an integer from 0 to {LARGEST_SEED}")
    return number


def share(value: Value) -> float:
    """A number from 0 to 1."""
    number = value.real()
    if not 0.0 <= number <= 1.0:
        raise value.error("a number from 0 to 1")
    return number
