"""Tag patterns: AprilTags from the installed AprilTag library, ArUco markers from OpenCV.

The family `aprilgrid` is Kalibr's AprilGrid tags: the codes of tag36h11 within a black border of two
modules instead of one, as kalibr_create_target_pdf draws them by default.
"""

import ctypes
import functools
from dataclasses import dataclass

import cv2
import numpy as np

from omnitag.command_line import InputError

_ARUCO = tuple("DICT_{0}X{0}_{1}".format(side, count)
               for side in (4, 5, 6, 7) for count in (50, 100, 250, 1000)) + (
    "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10",
    "DICT_APRILTAG_36h11", "DICT_ARUCO_MIP_36h12")
APRILGRID = "aprilgrid"
_APRILGRID_CODES = "tag36h11"
FAMILIES = ("tag16h5", "tag25h9", "tag36h10", "tag36h11", "tagCircle21h7", "tagCircle49h12",
            "tagCustom48h12", "tagStandard41h12", "tagStandard52h13", APRILGRID) + _ARUCO


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
    """A family of the library; widths in modules."""

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
    # Families are never destroyed: there are few, and they are used until the program ends.
    create = getattr(_library(), name + "_create", None)
    if create is None:
        raise InputError("family: the installed AprilTag library has no {}".format(name))
    create.restype = ctypes.POINTER(_FamilyStruct)
    create.argtypes = []
    return create()


@functools.lru_cache(maxsize=None)
def _aruco_dictionary(name: str):
    number = getattr(cv2.aruco, name, None)
    if number is None:
        raise InputError("family: the installed OpenCV has no {}".format(name))
    return cv2.aruco.getPredefinedDictionary(number)


def _aruco_modules(family: TagFamily, tag_id: int) -> np.ndarray:
    # It had another name before OpenCV 4.7.
    draw = getattr(cv2.aruco, "generateImageMarker", None) or cv2.aruco.drawMarker
    # One pixel for each module, with the black border, without a white one around it.
    drawing = draw(_aruco_dictionary(family.name), tag_id, family.width_at_border)
    return np.pad(drawing > 127, 1, constant_values=True)


@functools.lru_cache(maxsize=None)
def tag_family(name: str) -> TagFamily:
    """The family of this name; raises InputError if the libraries have none."""
    if name not in FAMILIES:
        raise InputError("family: expected one of {}, found {!r}".format(", ".join(FAMILIES), name))
    if name in _ARUCO:
        dictionary = _aruco_dictionary(name)
        return TagFamily(name, len(dictionary.bytesList), dictionary.markerSize + 2,
                         dictionary.markerSize + 4)
    if name == APRILGRID:
        codes = tag_family(_APRILGRID_CODES)
        return TagFamily(name, codes.number_of_ids, codes.width_at_border + 2, codes.total_width + 2)
    family = _family_pointer(name).contents
    return TagFamily(name, int(family.ncodes), int(family.width_at_border),
                     int(family.total_width))


def tag_bitmap(family_name: str, tag_id: int) -> TagBitmap:
    """The pattern of one tag, upright; raises InputError for an unknown family or id."""
    family = tag_family(family_name)
    if not 0 <= tag_id < family.number_of_ids:
        raise InputError("id: expected 0 to {} in {}, found {}".format(
            family.number_of_ids - 1, family_name, tag_id))
    if family_name in _ARUCO:
        return TagBitmap(family, tag_id, _aruco_modules(family, tag_id))
    if family_name == APRILGRID:
        black = _apriltag_modules(_APRILGRID_CODES, tag_id)[1:-1, 1:-1]
        return TagBitmap(family, tag_id, np.pad(np.pad(black, 1, constant_values=False), 1,
                                                constant_values=True))
    return TagBitmap(family, tag_id, _apriltag_modules(family_name, tag_id))


def _apriltag_modules(family_name: str, tag_id: int) -> np.ndarray:
    pointer = _library().apriltag_to_image(_family_pointer(family_name), tag_id)
    image = pointer.contents
    pixels = np.ctypeslib.as_array(image.buf, shape=(image.height, image.stride))
    modules = pixels[:, :image.width] > 127
    # The library does not export image_u8_destroy; both blocks come from the C allocator.
    libc = ctypes.CDLL(None)
    libc.free.argtypes = [ctypes.c_void_p]
    libc.free(image.buf)
    libc.free(pointer)
    return modules
