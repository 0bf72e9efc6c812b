"""Rig files: a virtual rig and what its table does, and the record that its sensors make."""

from inerter.files.common.kinds import FileKind

KIND = FileKind("rig files", "rig", ("rig",), __name__, "{file} -o record.csv")
