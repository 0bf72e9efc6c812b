"""The distribution beside this file is for processes that the tests start: imported here, its rows would stay."""

collect_ignore = ["src"]
