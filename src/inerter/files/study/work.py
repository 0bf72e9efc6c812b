"""Work on the parts of a study in its result folder, and its journal: what is known is not computed again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from inerter.files.common.folder import Results
from inerter.files.study import journal as journals
from inerter.files.study.cases import portable
from inerter.files.study.parts import PartResult, StudyPart, lost_part, resume_part
from inerter.files.study.study import Study
from inerter.files.study.tasks import Designs, journal_entry
from inerter.work.checkpoints import Checkpoint, join_checkpoints, storing_checkpoints
from inerter.work.pool import Pool
from inerter.work.progress import logging_steps


class StudyWork:
    """Computes parts of a study, each kept in the journal at once, as are searches under way.

    `enter` is called with every result: those in the journal when this is made, which `result_of` makes of their
    entries, then those that are computed.
    """

    def __init__(
        self,
        study: Study,
        results: Results,
        pool: Pool,
        enter: Callable[[PartResult], object],
        result_of: journals.ResultOfEntry = journals.result_of,
    ) -> None:
        self.study, self.results, self.pool, self.enter = portable(study), results, pool, enter
        self._journal = journals.journal_of(study, results.place / journals.NAME)
        searches: dict[str, list[Checkpoint]] = {}
        for one in journals.results_of(self._journal, result_of) if results.resume else ():
            if isinstance(one, Checkpoint):
                searches.setdefault(one.name, []).append(one)
            else:
                searches.pop(one.name, None)
                enter(one)
        self._known = {name: join_checkpoints(several) for name, several in searches.items()}

    @contextmanager
    def journalling(self) -> Iterator[None]:
        """Keep what is computed in this block."""
        self.results.list_journal(journals.NAME)
        with (
            logging_steps(),
            self._journal.appending(self.results.resume) as self._append,
            storing_checkpoints(lambda kept: self._append(kept.to_json())),
        ):
            yield

    def compute(self, parts: Iterable[StudyPart[Any]], designs: Designs) -> Iterator[list[PartResult]]:
        """Lists of results in the order in which they are completed; searches begun go on from what is known."""
        run = partial(resume_part, self.study, designs, self._known)
        threaded, lost = partial(run, threads=self.pool.jobs), partial(lost_part, self.study)
        for ready in self.pool.batches(run, parts, threaded, lost):
            self._append(*map(journal_entry, ready))
            for result in ready:
                self.enter(result)
            yield ready
