"""Registry of all papers that can be reproduced. A new one is a subpackage, and its entry here."""

from __future__ import annotations

from inerter.papers.paper import Paper
from inerter.papers.wang_su_2008.paper import PAPER as WANG_SU_2008
from inerter.registry import Registry

PAPERS: Registry[Paper] = Registry("paper", "name", ("title", "parts", "claims", "figures"), (WANG_SU_2008,))
