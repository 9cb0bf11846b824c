"""Tag patterns, as the installed AprilTag library draws them."""

import ctypes
import functools
from dataclasses import dataclass

import numpy as np

from omnitag.command_line import InputError

FAMILIES = ("tag16h5", "tag25h9", "tag36h10", "tag36h11", "tagCircle21h7", "tagCircle49h12",
            "tagCustom48h12", "tagStandard41h12", "tagStandard52h13")


class _FamilyStruct(ctypes.Structure):
    """The fields of `apriltag_family_t` (apriltag.h)."""

    _fields_ = [("ncodes", ctypes.c_uint32), ("codes", ctypes.POINTER(ctypes.c_uint64)),
                ("width_at_border", ctypes.c_int), ("total_width", ctypes.c_int),
                ("reversed_border", ctypes.c_bool), ("nbits", ctypes.c_uint32),
                ("bit_x", ctypes.POINTER(ctypes.c_uint32)),
                ("bit_y", ctypes.POINTER(ctypes.c_uint32)), ("h", ctypes.c_uint32),
                ("name", ctypes.c_char_p), ("impl", ctypes.c_void_p)]


class _ImageStruct(ctypes.Structure):
    """The fields of `image_u8_t` (common/image_types.h)."""

    _fields_ = [("width", ctypes.c_int32), ("height", ctypes.c_int32), ("stride", ctypes.c_int32),
                ("buf", ctypes.POINTER(ctypes.c_uint8))]


@dataclass(frozen=True)
class TagFamily:
    """What the library says of a family; widths in modules."""

    name: str
    number_of_ids: int
    width_at_border: int  # between the corners that the detector reports: the marker's size
    total_width: int  # of the drawn pattern


@dataclass(frozen=True)
class TagBitmap:
    """The pattern of one tag."""

    family: TagFamily
    id: int
    modules: np.ndarray  # (total_width, total_width) bool, True is white, row 0 is the upper edge


@functools.lru_cache(maxsize=None)
def _library() -> ctypes.CDLL:
    try:
        library = ctypes.CDLL("libapriltag.so.3")
    except OSError:
        raise InputError("libapriltag.so.3: expected the AprilTag library, found none installed")
    library.apriltag_to_image.restype = ctypes.POINTER(_ImageStruct)
    library.apriltag_to_image.argtypes = [ctypes.POINTER(_FamilyStruct), ctypes.c_uint32]
    return library


@functools.lru_cache(maxsize=None)
def _family_pointer(name: str):
    # Families are never destroyed: there are nine, and they serve until the program ends.
    if name not in FAMILIES:
        raise InputError("family: expected one of {}, found {!r}".format(", ".join(FAMILIES), name))
    create = getattr(_library(), name + "_create", None)
    if create is None:
        raise InputError("family: the installed AprilTag library has no {}".format(name))
    create.restype = ctypes.POINTER(_FamilyStruct)
    create.argtypes = []
    return create()


@functools.lru_cache(maxsize=None)
def tag_family(name: str) -> TagFamily:
    """The family of that name; raises InputError where the library has none."""
    family = _family_pointer(name).contents
    return TagFamily(name, int(family.ncodes), int(family.width_at_border),
                     int(family.total_width))


def tag_bitmap(family_name: str, tag_id: int) -> TagBitmap:
    """The pattern of one tag, upright; raises InputError for an unknown family or id."""
    family = tag_family(family_name)
    if not 0 <= tag_id < family.number_of_ids:
        raise InputError("id: expected 0 to {} in {}, found {}".format(
            family.number_of_ids - 1, family_name, tag_id))
    pointer = _library().apriltag_to_image(_family_pointer(family_name), tag_id)
    image = pointer.contents
    pixels = np.ctypeslib.as_array(image.buf, shape=(image.height, image.stride))
    modules = pixels[:, :image.width] > 127
    # The library does not export image_u8_destroy; both blocks come from the C allocator.
    libc = ctypes.CDLL(None)
    libc.free.argtypes = [ctypes.c_void_p]
    libc.free(image.buf)
    libc.free(pointer)
    return TagBitmap(family, tag_id, modules)
