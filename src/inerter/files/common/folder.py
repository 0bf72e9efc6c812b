"""Result folders: new results are written next to the old ones, and replace them once the run has completed.

Only files that this package wrote there, and that nobody has changed since, are ever replaced or removed.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from filelock import FileLock, Timeout

from inerter.atomic_io import defer_interrupts, is_disk_failure, sync_to_disk, temporary_folder
from inerter.errors import StudyError, WorkError
from inerter.files.common.listing import MARK, Entry, Listing, digest, is_linked, is_own, listing, names_below
from inerter.formatting import format_some

_LOCK, _NEW, _WHOLE = f"{MARK}/lock", f"{MARK}/new", f"{MARK}/whole"
FIGURES, REPORT = "figures", "report.html"  # in folders of results of any command
_ELSEWHERE = "choose another folder with -o"
_SHOWN = 3  # names in a message


@dataclass(frozen=True)
class WriteMode:
    """Planned use of a result folder by a command; `resume` is None for work that cannot be resumed.

    `names` are what it will write there, folders with "/" at the end; `inputs` are the files that it reads.

    >>> import inerter as it
    >>> from pathlib import Path
    >>> mode = it.WriteMode(Path("results"), by="run", names=("report.html", "figures/"))
    >>> mode.force
    False
    """

    folder: Path
    by: str
    names: tuple[str, ...]
    inputs: tuple[Path, ...] = ()
    resume: bool | None = None
    force: bool = False


@dataclass(frozen=True)
class Results:
    """Result folder under the exclusive lock of this process.

    What is written goes to `draft`, and with `publish` to its `place`: the `folder` itself or, as long as that holds
    the results which these replace, one beside them.
    """

    folder: Path
    place: Path
    draft: Path
    intent: WriteMode
    top: Results | None = field(default=None, repr=False)

    @property
    def resume(self) -> bool:
        """Whether existing results are kept and completed."""
        return bool(self.intent.resume)

    def within(self, name: str) -> Results:
        """Subfolder of results in this folder."""
        parts = {part: getattr(self, part) / name for part in ("folder", "place", "draft")}
        (self.draft / name).mkdir(exist_ok=True)
        return replace(self, **parts, top=self.top or self)

    def list_journal(self, name: str) -> None:
        """List the file `name`, which grows in `place`, as a journal of this package."""
        top = self.top or self
        own = (self.place / name).relative_to(top.place).as_posix()
        top.place.mkdir(exist_ok=True)
        (listing(top.place) or Listing()).with_files({own: Entry(self.intent.by, journal=True)}).write(top.place)
        self.place.mkdir(exist_ok=True)  # a folder that is on no list could not be gone on with

    def publish(self) -> None:
        """Move all drafted files to `place`; move none if a file not written by this package is in the way."""
        top = self.top or self
        files = {name: Entry(self.intent.by, (digest(top.draft / name),)) for name in names_below(top.draft)}
        _move(top.draft, top.place, files, top.intent.inputs)


@contextmanager
def open_results(intent: WriteMode) -> Iterator[Results]:
    """The folder for the results of a command; what is in `Results.draft` when the block ends well is published.

    With `force`, what the folder holds stays as it is until all of the new results are there.

    Raises `StudyError` if the folder is not one for these results, or is in use, and then nothing has been changed;
    `WorkError` if the disk is full, or a file of the user's has come in the way meanwhile.

    >>> import inerter as it
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     with it.open_results(it.WriteMode(Path(folder) / "out", by="run", names=("table.csv",))) as results:
    ...         _ = (results.draft / "table.csv").write_text("k,c")
    ...     (Path(folder) / "out" / "table.csv").read_text()
    'k,c'
    """
    _check(intent)
    with _full_disk_reported(intent), _folder_lock(intent.folder, wait=0.0):
        _check(intent)
        _clean(intent.folder)
        with defer_interrupts():
            _complete(intent.folder)
        yield from _results(intent)


def _results(intent: WriteMode) -> Iterator[Results]:
    folder, new = intent.folder, intent.folder / _NEW
    if intent.force:
        shutil.rmtree(new, ignore_errors=True)
    beside = new.is_dir() or (intent.force and bool((listing(folder) or Listing()).by(intent.by)))
    place = new if beside else folder
    try:
        (place / MARK).mkdir(parents=True, exist_ok=True)
        with temporary_folder(folder / MARK) as draft:
            results = Results(folder, place, draft, intent)
            yield results
            results.publish()
        _seal(place)
        if beside:
            (new / _WHOLE).touch()
            with defer_interrupts():
                _complete(folder)
    finally:
        if intent.resume is None and not (new / _WHOLE).exists():
            shutil.rmtree(new, ignore_errors=True)


def _seal(folder: Path) -> None:
    """Record the final hashes of the journals of a folder."""
    known = listing(folder) or Listing()
    grown = {name: entry for name, entry in known.files.items() if entry.journal and not entry.digests}
    known.with_files({n: replace(e, digests=(digest(folder / n),)) for n, e in grown.items()}).write(folder)


@contextmanager
def single(path: Path, *, by: str, inputs: tuple[Path, ...], force: bool) -> Iterator[Path]:
    """Draft path of one file that is moved to `path` at the end; its folder may hold any other files.

    Raises as `check_single` does, and `WorkError` if the disk is full.
    """
    check_single(path, by=by, inputs=inputs, force=force)
    folder = path.parent
    with _full_disk_reported(None, path), _folder_lock(folder, wait=10.0):
        check_single(path, by=by, inputs=inputs, force=force)
        with temporary_folder(folder / MARK) as draft:
            yield draft / path.name
            _move(draft, folder, {path.name: Entry(by, (digest(draft / path.name),), single=True)}, inputs)


def check_single(path: Path, *, by: str, inputs: tuple[Path, ...], force: bool) -> None:
    """Raises `StudyError` unless a file can be at `path`: where none is, or one of our own that `force` may replace."""
    if path.is_dir():
        raise StudyError(f"{path}: this is a folder. Give the name of a file in it with -o.")
    if not path.parent.is_dir():
        raise StudyError(f"{path.parent}: folder not found. Create it, or choose another with -o.")
    if not _is_mark(path.parent):
        raise StudyError(f"{path.parent / MARK}: is in the way. Move it away, or choose another folder with -o.")
    if not os.path.lexists(path):
        return
    if not _may_replace(path.parent, path.name, listing(path.parent) or Listing(), by, inputs):
        raise StudyError(
            f"{path}: exists and was not replaced: this command did not write it, or it was edited since. "
            "Choose another name with -o."
        )
    if not force:
        raise StudyError(f"{path}: exists. Replace it with --force, or choose another name with -o.")


def _check(intent: WriteMode) -> None:
    """Raises `StudyError` for an intent that cannot be met; reads only."""
    folder = intent.folder
    if intent.resume and intent.force:
        raise StudyError("--resume keeps the results in the folder, --force replaces them: give one of the two.")
    if os.path.lexists(folder) and not folder.is_dir():
        raise StudyError(f"{folder}: is a file; expected a folder for the results. Choose another with -o.")
    try:
        if _is_empty(folder):
            return
        known = (listing(folder) if _is_mark(folder) else None) or Listing()
        commands = {entry.by for entry in known.files.values() if not entry.single}
        if intent.by not in commands:
            raise StudyError(_not_ours(intent, commands))
        if not intent.resume and not intent.force:
            again = "Replace" if intent.resume is None else "Continue with --resume, replace"
            there = _name_list(sorted({name.partition("/")[0] for name in known.by(intent.by)}))
            raise StudyError(
                f"{folder}: holds results of inerter {intent.by} ({there}). {again} them with --force, or {_ELSEWHERE}."
            )
        _check_files(intent, known)
    except OSError as error:
        raise StudyError(f"{folder}: cannot be read ({error.strerror}). Choose another folder with -o.") from None


def _check_files(intent: WriteMode, known: Listing) -> None:
    folder, own = intent.folder, known.by(intent.by)
    there = [name for name in dict.fromkeys((*own, *intent.names)) if os.path.lexists(folder / name)]
    if intent.resume:  # its lines are looked at one by one
        there = [name for name in there if name not in own or not own[name].journal or is_linked(folder, name)]
    strange = [
        name
        for name in there
        if not (_is_folder(folder, name) if name.endswith("/") else is_own(folder, name, Listing(own)))
    ]
    if strange:
        raise StudyError(f"{folder}: {_kept_files_note(strange)} Move that away, or {_ELSEWHERE}.")
    read = [name for name in there if intent.force and _is_input(folder / name, intent.inputs)]
    if read:
        raise StudyError(
            f"{folder}: this command reads {_name_list(read)}, and --force would replace it. "
            f"Copy it to another folder, or {_ELSEWHERE}."
        )


def _is_folder(folder: Path, name: str) -> bool:
    return (folder / name).is_dir() and not is_linked(folder, name)


def _not_ours(intent: WriteMode, commands: Iterable[str]) -> str:
    folder = intent.folder
    if commands:
        return f"{folder}: holds the results of inerter {_name_list(sorted(commands))}. Choose another folder with -o."
    unknown = f"it has no list ({MARK}/files.json) of what inerter wrote there"
    if intent.resume:
        return f"{folder}: holds nothing that --resume could continue: {unknown}. Choose another folder with -o."
    if intent.force:
        return (
            f"{folder}: --force replaces results, and nothing here is known as one: {unknown}. "
            "Choose another folder with -o, or move away what is there."
        )
    there = sorted({*os.listdir(folder)} - {MARK}) or [MARK]
    return f"{folder}: holds {_name_list(there)}, not results of inerter. Choose another folder with -o."


def _kept_files_note(names: list[str]) -> str:
    was, they = ("was", "it is") if len(names) == 1 else ("were", "they are")
    return f"{_name_list(names)} {was} not written by inerter, or edited since; {they} kept."


def _name_list(names: list[str]) -> str:
    return format_some((name.rstrip("/") for name in names), _SHOWN)


def _is_empty(folder: Path) -> bool:
    """Whether a folder holds nothing, apart from traces of this package without results."""
    if not folder.exists():
        return True
    return {entry.name for entry in os.scandir(folder)} <= {MARK} and _is_mark(folder) and not (folder / _NEW).exists()


def _is_mark(folder: Path) -> bool:
    """Whether the folder's mark is that of this package, or absent."""
    mark = folder / MARK
    if not os.path.lexists(mark):
        return True
    if not _is_folder(folder, MARK):
        return False
    return listing(folder) is not None or all(one == "lock" or one.startswith(".inerter-") for one in os.listdir(mark))


def _complete(folder: Path) -> None:
    """Replace old results by complete new ones, or finish a replacement that was interrupted."""
    new = folder / _NEW
    found = listing(new)
    if found is not None and (new / _WHOLE).exists():
        files = found.files
        commands = {entry.by for entry in files.values()}
        before = (listing(folder) or Listing()).files
        _move(new, folder, files, (), {name for name, entry in before.items() if entry.by in commands} - set(files))
        shutil.rmtree(new)


def _move(
    source: Path, target: Path, files: Mapping[str, Entry], inputs: tuple[Path, ...], stale: Iterable[str] = ()
) -> None:
    """Move files from one folder to another, where they are listed, and remove the stale ones, or do nothing at all.

    Until all are there, the list knows the files of both sides, so that a cut at any point leaves only what it knows.

    Raises `WorkError` if a file that is not ours is in the way.
    """
    known = listing(target) or Listing()
    moved = {
        name: entry
        for name, entry in files.items()
        if (source / name).exists() and not _is_there(target, name, known, entry)
    }
    stale = [name for name in stale if os.path.lexists(target / name)]
    strange = [name for name in moved if not _may_replace(target, name, known, moved[name].by, inputs)]
    strange += [name for name in stale if not is_own(target, name, known)]
    if strange:
        raise WorkError(f"{target}: {_kept_files_note(strange)} Move that away, and repeat the command.")
    for name in moved:
        sync_to_disk(source / name)
    both = {
        name: replace(entry, digests=(*entry.digests, *(known.files[name].digests if name in known.files else ())))
        for name, entry in files.items()
    }
    known.with_files(both).write(target)
    with defer_interrupts():
        for name in moved:
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            (source / name).replace(target / name)
        for name in stale:
            (target / name).unlink()
        _prune(target, stale)
        for parent in {(target / name).parent for name in moved}:
            sync_to_disk(parent)
    known.with_files(files, stale).write(target)


def _is_there(folder: Path, name: str, known: Listing, entry: Entry) -> bool:
    """Whether the file already exists with one of the expected hashes, unchanged since it was written."""
    return is_own(folder, name, known) and digest(folder / name) in entry.digests


def _may_replace(folder: Path, name: str, known: Listing, by: str, inputs: tuple[Path, ...]) -> bool:
    if not os.path.lexists(folder / name):
        return not is_linked(folder, name)
    return is_own(folder, name, Listing(known.by(by))) and not _is_input(folder / name, inputs)


def _is_input(path: Path, inputs: tuple[Path, ...]) -> bool:
    """Whether the path is one of the inputs, under any name, link or spelling."""
    return any(given.exists() and path.samefile(given) for given in inputs)


def _prune(folder: Path, names: Iterable[str]) -> None:
    """Remove the folders that files of these names were in, if they are empty now."""
    places = {parent for name in names for parent in (folder / name).parents if folder in parent.parents}
    for place in sorted(places, reverse=True):
        if not any(place.iterdir()):
            place.rmdir()


@contextmanager
def _folder_lock(folder: Path, wait: float) -> Iterator[None]:
    """Hold the lock of a folder, created if missing; unused folders created for it are removed again."""
    made = [path for path in (folder / MARK, folder, *folder.parents) if not path.exists()]
    try:
        (folder / MARK).mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / _LOCK)
        lock.acquire(timeout=wait)
    except Timeout:
        raise StudyError(f"{folder}: another run is writing to it. Wait for it, or {_ELSEWHERE}.") from None
    except OSError as error:
        _tidy(folder, made)
        if is_disk_failure(error):
            raise
        raise StudyError(f"{folder}: cannot be written ({error.strerror}). Choose another folder with -o.") from None
    try:
        yield
    finally:
        lock.release()
        _tidy(folder, made)


def _tidy(folder: Path, made: list[Path]) -> None:
    """Remove what was made and holds nothing: our mark, and folders."""
    known = (listing(folder) or Listing()).files
    if folder / MARK in made and not any(os.path.lexists(folder / name) for name in known):
        shutil.rmtree(folder / MARK, ignore_errors=True)
    for path in made:
        if path.is_dir() and not any(path.iterdir()):
            path.rmdir()


def _clean(folder: Path) -> None:
    """Remove what was under way when a process was killed."""
    known = (listing(folder) or Listing()).files
    for place in {folder, folder / MARK, *((folder / name).parent for name in known)}:
        for path in place.glob(".inerter-????????"):
            shutil.rmtree(path, ignore_errors=True)


@contextmanager
def _full_disk_reported(intent: WriteMode | None, path: Path | None = None) -> Iterator[None]:
    """A full disk is reported in a sentence, with what is kept."""
    try:
        yield
    except (OSError, WorkError) as error:
        cause = error.__cause__ if isinstance(error, WorkError) else error
        if not isinstance(cause, OSError) or not is_disk_failure(cause):
            raise
        kept = ""
        if intent and intent.force:
            kept = " The earlier results are as they were."
        if intent and intent.resume is not None:
            kept += " What was computed is kept; continue with --resume."
        raise WorkError(f"{intent.folder if intent else path}: {cause.strerror}.{kept}") from None
