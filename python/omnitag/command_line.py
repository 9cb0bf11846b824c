"""What all command line tools share: one-line errors and a progress bar."""

import os
import sys
import time
from typing import Callable, Iterable, Optional, TextIO


class InputError(Exception):
    """Something that the user gave is wrong: a file, a line, a key or an argument.

    The message names the place, what was expected and what was found.
    """


def run(main: Callable[[], Optional[int]]) -> int:
    """Call `main` and return its exit status, or 1 after an error of one line on standard error.

    argparse ends the program itself, with status 2, when the arguments are wrong.
    """
    try:
        status = main() or 0
        sys.stdout.flush()
        return status
    except InputError as error:
        message = str(error)
    except BrokenPipeError:
        # The reader (`| head`) has ended. The interpreter would complain when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        message = ": ".join(str(part) for part in (error.filename, error.strerror) if part)
    except KeyboardInterrupt:
        print(file=sys.stderr)
        return 130
    print("{}: error: {}".format(os.path.basename(sys.argv[0]), " ".join(message.split())),
          file=sys.stderr)
    return 1


def refuse_overwriting(output: str, inputs: Iterable[str], what: str = "an input") -> None:
    """Raise InputError if `output` is the file of one of the inputs; those need not exist."""
    if os.path.exists(output) and any(os.path.samefile(path, output)
                                      for path in inputs if os.path.exists(path)):
        raise InputError("{}: is {} and would be overwritten".format(output, what))


class Progress:
    """A progress bar on standard error; only its final line if that is not a terminal.

    Use as a context manager and call `advance` once per step.
    """

    BAR_WIDTH = 30
    REDRAW_SECONDS = 0.1

    def __init__(self, title: str, total: int, stream: Optional[TextIO] = None) -> None:
        self._title = title
        self._total = total
        self._stream = stream if stream is not None else sys.stderr
        self._done = 0
        self._start = time.monotonic()
        self._last_drawn = float("-inf")

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, exception_type: Optional[type], *_: object) -> None:
        if self._stream.isatty():
            self._stream.write("\r\033[K")
        # An error must be the only line.
        if exception_type is None:
            self._stream.write("{}: {} of {} in {:.1f} s\n".format(
                self._title, self._done, self._total, time.monotonic() - self._start))
        self._stream.flush()

    def advance(self, steps: int = 1) -> None:
        """Count `steps` more as done; redraw at most every REDRAW_SECONDS."""
        self._done += steps
        now = time.monotonic()
        if not self._stream.isatty() or now - self._last_drawn < self.REDRAW_SECONDS:
            return
        self._last_drawn = now
        share = self._done / self._total if self._total else 1.0
        filled = min(self.BAR_WIDTH, int(share * self.BAR_WIDTH))
        self._stream.write("\r{} [{}{}] {}/{}".format(
            self._title, "#" * filled, "." * (self.BAR_WIDTH - filled), self._done, self._total))
        self._stream.flush()
