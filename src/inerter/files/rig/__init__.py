"""Rig files: a virtual rig and what its table does, and the record that its sensors make."""
