"""Configurations of an identification: how records are read, what is fitted, and what comes of it."""

from inerter.files.common.kinds import FileKind

KIND = FileKind("configurations", "identify", ("record", "model", "fit"), __name__, "RECORD --config {file}")
