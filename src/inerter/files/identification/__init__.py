"""Configurations of an identification: how records are read, what is fitted, and what comes of it."""

from inerter.files.common.kinds import FileKind

KIND = FileKind(
    "configurations",
    "identify",
    ("record", "model", "fit"),
    __name__,
    "identification_codec",
    "Reading of records, model of the device and settings of the fit. Every quantity is text with its unit.",
    "RECORD --config {file}",
)
