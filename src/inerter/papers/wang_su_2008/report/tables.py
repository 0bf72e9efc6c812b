"""The tables of a reproduction, for its page, its text and its data files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from inerter.errors import StatusKind
from inerter.formatting import format_number, format_percent, format_quantity, format_share, format_uncertain
from inerter.papers.wang_su_2008.linear import ComparedRow, FoundDesign, LinearTables
from inerter.papers.wang_su_2008.report.reasons import reason
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rig import IdentifiedParameter
from inerter.papers.wang_su_2008.rows import DIFFERS, OTHER_PEAK, SimulatedRow
from inerter.report.identified_values import format_with_interval
from inerter.table import Cell, Column, Content, Row, Shown, Table
