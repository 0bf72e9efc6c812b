"""Rig files: a virtual rig and what its table does, and the record that its sensors make."""

from inerter.files.common.kinds import FileKind

KIND = FileKind(
    "rig files",
    "rig",
    ("rig",),
    __name__,
    "rig_codec",
    "A device, a signal and sensors. Every quantity is text with its unit.",
    "{file} -o record.csv",
)
