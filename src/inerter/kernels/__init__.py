"""Compiled code on plain arrays; the import loads no compiler, compiles nothing and starts no process."""
