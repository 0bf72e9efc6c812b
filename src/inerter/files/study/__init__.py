"""Study files: vehicles, layouts, indices, methods and swept values, read from TOML and checked."""

from inerter.files.common.kinds import FileKind

KIND = FileKind(
    "study files",
    "run",
    ("study",),
    __name__,
    "study_codec",
    "Vehicle, road, elements, layouts and indices. Every quantity is text with its unit.",
)
