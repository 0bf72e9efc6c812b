"""All papers that can be reproduced. A new one is a folder beside the others, and its row here."""

from __future__ import annotations

from inerter.papers.paper import Paper
from inerter.papers.wang_su_2008.paper import PAPER as WANG_SU_2008

PAPERS: dict[str, Paper] = {paper.name: paper for paper in (WANG_SU_2008,)}
