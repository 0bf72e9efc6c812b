"""The command `inerter`. Results go to stdout, progress and problems to stderr.

Exit codes are those of `inerter.statements`.
"""

from __future__ import annotations

import os
import signal
import sys
from dataclasses import asdict
from inspect import signature
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, CycloptsError, Parameter

from inerter import __version__
from inerter.app.serve import LIMIT, RECORD_LIMIT
from inerter.atomic_io import remove_temporary_folders
from inerter.cli.interrupts import install_interrupt_handler, interruptible, say_interrupted, was_interrupted
from inerter.cli.options import (
    DEFAULT_WORK,
    NO_CLUSTER,
    AtCondition,
    BestFor,
    ClusterOptions,
    Force,
    ForceFile,
    Json,
    LongWork,
    Output,
    SweepPoint,
    Whole,
)
from inerter.cli.pulse import alive
from inerter.cli.reading import DEFAULT_READING, DEFAULT_SEARCH, ReadingOptions, SearchOptions
from inerter.cli.streams import output_error, say
from inerter.errors import InerterError, StudyError, WorkError
from inerter.statements import INTERRUPTED, Statement, exit_code

EXAMPLES = """Examples:
  inerter run examples/quarter-car.toml
  inerter run examples/stiffness-sweep.toml -o sweep -j 2
  inerter search examples/search_quarter_car.toml
  inerter check my-study.toml
  inerter simulate examples/stick_slip.toml
  inerter rig examples/rig_fit.toml -o fit.csv
  inerter identify fit.csv --model ball-screw
  inerter reproduce    lists the papers
  inerter serve    opens the workbench in the browser

Exit codes: 0 success, 1 failed computation, no feasible design or unreliable
fit, 2 invalid input, 130 interrupted by Ctrl-C."""

app = App(
    name="inerter",
    version=f"inerter {__version__}",
    help="Analysis, optimisation and identification of vehicle suspensions with inerters.",
    help_epilogue=EXAMPLES,
    help_format="plaintext",
    suppress_keyboard_interrupt=False,
)

Reading = Annotated[ReadingOptions, Parameter(name="*")]
Searching = Annotated[SearchOptions, Parameter(name="*")]


@app.command(
    help_epilogue="""Examples:
  inerter run examples/quarter-car.toml
  inerter run sweep.toml -o sweep -j 2
  inerter run sweep.toml -o sweep --resume    after an interruption
  inerter run sweep.toml --scheduler tcp://node1:8786    on a Dask cluster"""
)
def run(
    study: Path,
    /,
    *,
    options: LongWork = DEFAULT_WORK,
) -> tuple[Statement, ...]:
    """Optimise all layouts of a study file, and write tables, figures and a report.

    The folder, by default STUDY-results, then holds report.html, summary.csv,
    results.nc and figures. An interrupted run keeps completed results.

    Parameters
    ----------
    study
        The study file (TOML). examples/quarter-car.toml is a commented example.
    """
    from inerter.cli.commands import run as command

    return command(study, options)


@app.command(
    help_epilogue="""Examples:
  inerter search examples/search_quarter_car.toml
  inerter search examples/search_absorber.toml -o absorber -j 2
  inerter search study.toml -o best --resume    after an interruption"""
)
def search(
    study: Path,
    /,
    *,
    options: LongWork = DEFAULT_WORK,
) -> tuple[Statement, ...]:
    """Find the best network: optimise every network that the free networks of a study file may be, and rank them.

    The folder, by default STUDY-search, then holds report.html, search.csv with
    all networks, and figures. An interrupted search keeps completed results.

    Parameters
    ----------
    study
        The study file (TOML) with a free network in a layout. examples/search_quarter_car.toml is one.
    """
    from inerter.cli.search import search as command

    return command(study, options)


@app.command(
    help_epilogue="""Examples:
  inerter compare before after
  inerter compare before after --json

Exit codes: 0 all values agree within their errors, 1 some differ, 2 the
folders cannot be compared."""
)
def compare(first: Path, second: Path, /, *, json: Json = False) -> tuple[Statement, ...]:
    """Compare two folders of results of inerter run: what was asked, and which values differ beyond their errors.

    Values are compared by layout, index, method and swept values. They agree if
    they differ by no more than their error bounds and 95 % confidence intervals.

    Parameters
    ----------
    first
        A folder of results.
    second
        Another one; changes are relative to the first.
    """
    from inerter.cli.compare import compare as command

    return command(first, second, as_json=json)


@app.command(
    help_epilogue="""Examples:
  inerter check examples/half-car.toml
  inerter check examples/stick_slip.toml
  inerter check studies/*.toml"""
)
def check(file: Path, /, *more: Path) -> tuple[Statement, ...]:
    """Check files: keys, units, bounds, networks, and whether every layout can be analysed or simulated.

    Parameters
    ----------
    file
        A study, simulation, rig or identification file (TOML), distinguished by its sections.
    more
        Further files; the exit code is 2 if any of them cannot be used.
    """
    from inerter.cli.check import check as command

    return command([file, *more])


@app.command(
    help_epilogue="""Examples:
  inerter new                          writes quarter-car.toml
  inerter new half-car -o my-car.toml
  inerter new full-car -o -            prints it"""
)
def new(
    vehicle: str | None = None,
    /,
    *,
    output: Annotated[
        Path | None,
        Parameter(name=["--output", "-o"], allow_leading_hyphen=True, help="Output file, or - for the terminal."),
    ] = None,
    force: Annotated[
        bool, Parameter(negative=(), show_default=False, help="Replace a template that has not been edited.")
    ] = False,
) -> None:
    """Create a commented template of a study file. Existing files are not overwritten.

    Parameters
    ----------
    vehicle
        Vehicle model; default: quarter-car. All models: inerter explain vehicle.model
    """
    from inerter.cli.new import new as command

    command(vehicle, output, force)


@app.command(
    help_epilogue="""Examples:
  inerter explain                      all keys of study files
  inerter explain road.speed
  inerter explain sweep
  inerter explain simulation           keys of a section of other files"""
)
def explain(key: str | None = None, /) -> None:
    """Show the meaning, unit, default and an example of a key of files.

    Parameters
    ----------
    key
        A key such as road.speed, its last part, a section such as road, or a name such as J1.
        Default: all keys of study files.
    """
    from inerter.cli.describing import explain as command

    command(key)


@app.command(
    help_epilogue="""Examples:
  inerter schema > study.schema.json
  inerter schema simulation > simulation.schema.json"""
)
def schema(kind: str = "study", /) -> None:
    """Print the JSON Schema of a kind of files, with which editors complete and check them.

    Editors with a TOML extension such as Taplo use the schema if the first line
    of the study file is  #:schema ./study.schema.json

    Parameters
    ----------
    kind
        Kind of files: study, simulation, rig or identification.
    """
    from inerter.cli.describing import schema as command

    command(kind)


@app.command(
    help_epilogue="""Examples:
  inerter simulate examples/backlash_rattle.toml
  inerter simulate my-car.toml -o motion --force
  inerter simulate my-car.toml --window 2:4    zooms the figure to 2 to 4 s"""
)
def simulate(
    file: Path,
    /,
    *,
    output: Output = None,
    window: Annotated[
        str | None, Parameter(help="Time interval of the figure, FROM:TO in seconds; default: a readable part.")
    ] = None,
    force: Force = False,
    json: Json = False,
) -> tuple[Statement, ...]:
    """Simulate a time history with dry friction and backlash, and write tables and a figure.

    The folder, by default FILE-results, then holds trajectory.csv,
    trajectory.nc, events.csv, simulation.toml and figures.

    Parameters
    ----------
    file
        The simulation file (TOML): a vehicle or rig, its strut and a signal. examples/stick_slip.toml is one.
    """
    from inerter.cli.simulation import simulate as command

    return command(file, output, window, force=force, as_json=json)


@app.command(
    help_epilogue="""Examples:
  inerter identify fit.csv --model ball-screw
  inerter identify slow.tdms fast.tdms --model friction --unit force=kgf
  inerter identify bench.csv --config rig.toml -o bench --force"""
)
def identify(
    records: tuple[Path, ...],
    /,
    *,
    model: Annotated[
        str | None, Parameter(help="Model to fit, such as ball-screw, or choose, which selects the best of all models.")
    ] = None,
    config: Annotated[
        Path | None,
        Parameter(
            help="Identification file (TOML) with [record], [model], [elements] and [fit]; options take precedence."
        ),
    ] = None,
    reading: Reading = DEFAULT_READING,
    search: Searching = DEFAULT_SEARCH,
    output: Output = None,
    cluster: ClusterOptions = NO_CLUSTER,
    force: Force = False,
    json: Json = False,
) -> tuple[Statement, ...]:
    """Estimate the parameters of a device from measured records, with confidence intervals and identifiability.

    The folder, by default RECORD-results, then holds report.html, fit.json,
    residuals.csv and figures.

    Parameters
    ----------
    records
        Files of force and displacement (.csv .tsv .txt .tdms .mf4 .mdf .mat), fitted together.
    """
    from inerter.cli.identify import identify as command

    return command(records, model, config, output, asdict(reading), asdict(search), cluster, force=force, as_json=json)


@app.command(
    help_epilogue="""Examples:
  inerter rig examples/rig_fit.toml -o fit.csv
  inerter rig examples/rig_friction.toml -o friction.tdms"""
)
def rig(
    config: Path,
    /,
    *,
    output: Annotated[
        Path,
        Parameter(name=["--output", "-o"], help="Output file: .csv, .tsv, .txt, .tdms, .mf4 or .mat."),
    ],
    force: Annotated[
        bool, Parameter(negative="", show_default=False, help="Replace a record that this command wrote.")
    ] = False,
) -> None:
    """Generate the records of a virtual test rig from a known device.

    Parameters
    ----------
    config
        The rig file (TOML): a device, a signal, sensors. examples/rig_fit.toml is one.
    """
    from inerter.cli.rig import rig as command

    command(config, output, force=force)


@app.command(
    help_epilogue="""Examples:
  inerter export examples/quarter-car.toml --layout S3 --index J1 --to matlab
  inerter export my-car.toml --layout S3 --to matlab --form state-space
  inerter export quarter-car-results --layout S3 --index J1 --to modelica
  inerter export my-car.toml --layout real --to spice --linear
  inerter export my-car.toml --to fmu --part strut
  inerter export my-coach.toml --to fmu --speed "25 m/s"
  inerter export quarter-car-results --layout S3 --index J1 --to simulation"""
)
def export(
    source: Path,
    /,
    *,
    to: Annotated[
        str | None, Parameter(help="Kind of export, such as matlab, modelica or fmu; without it, all kinds are listed.")
    ] = None,
    layout: Annotated[str | None, Parameter(help="Layout; optional if there is only one.")] = None,
    index: BestFor = None,
    point: SweepPoint = None,
    condition: AtCondition = None,
    only: Annotated[
        tuple[str, ...],
        Parameter(negative="", show_default=False, help="Output of the linear model to export; repeatable."),
    ] = (),
    form: Annotated[
        Literal["descriptor", "state-space"] | None,
        Parameter(
            help="Form of the matrices for matlab: with unknowns that no mass carries and a matrix E, or without."
        ),
    ] = None,
    part: Annotated[str, Parameter(show_default=False, help="Strut to export alone: fmu, fmu3, spice, drawings.")] = "",
    speed: Annotated[
        str | None, Parameter(help='Speed of an FMU with one road for all axles, or of a simulation, such as "25 m/s".')
    ] = None,
    platform: Annotated[
        tuple[str, ...],
        Parameter(
            negative="",
            show_default=False,
            help="Another platform for an FMU: windows, macos, macos-arm, linux-arm; repeatable.",
        ),
    ] = (),
    linear: Annotated[
        bool,
        Parameter(negative="", show_default=False, help="Export the linear model: neglect friction and close gaps."),
    ] = False,
    output: Annotated[
        Path | None,
        Parameter(name=["--output", "-o"], help="Output file; its suffix chooses among those of the kind."),
    ] = None,
    force: ForceFile = False,
) -> None:
    """Export a design to another program: matrices, Modelica source, a netlist, tables, a drawing, a simulation file.

    Design variables have the values of the best design for the index, read from a
    folder of results or computed from a study file.

    Parameters
    ----------
    source
        A study file (TOML), or a folder with its results.
    """
    from inerter.cli.export import export as command

    options = {"outputs": only or None, "form": form or "", "part": part, "linear": linear, "platforms": platform}
    command(source, to, layout, index, point, condition, output, options, speed=speed, force=force)


@app.command(
    help_epilogue="""Examples:
  inerter plot examples/quarter-car.toml --kind bode --index J1
  inerter plot quarter-car-results --kind poles --index J1 -o poles.pdf
  inerter plot examples/stick_slip.toml --kind trajectory --window 1:3
  inerter plot trade_off-results --kind front"""
)
def plot(
    source: Path,
    /,
    *,
    kind: Annotated[
        str | None,
        Parameter(
            help="Kind of plot: of designs, such as bode; of a motion, such as trajectory; of results, such as front. "
            "Without it, all kinds are listed."
        ),
    ] = None,
    layout: Annotated[
        tuple[str, ...], Parameter(negative="", show_default=False, help="Layout; repeatable. Default: all.")
    ] = (),
    index: BestFor = None,
    point: SweepPoint = None,
    condition: AtCondition = None,
    input: Annotated[
        str | None, Parameter(help="Input of a response, such as road; default: that of the index.")
    ] = None,
    only: Annotated[
        tuple[str, ...],
        Parameter(negative="", show_default=False, help="Output to draw; repeatable. Default: those of the index."),
    ] = (),
    window: Annotated[str | None, Parameter(help="Time of a motion to draw, FROM:TO in seconds.")] = None,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], help="Output file: .svg, .pdf or .png.")] = None,
    force: ForceFile = False,
) -> None:
    """Plot designs, motions or results: responses, poles, drawings, time histories, fronts, maps.

    Design variables have the values of the best design for the index, read from a
    folder of results or computed from a study file. A motion is always simulated.

    Parameters
    ----------
    source
        A study file or a simulation file (TOML), or a folder with its results.
    """
    from inerter.cli.plot import PlotOptions
    from inerter.cli.plot import plot as command

    command(source, kind, PlotOptions(layout, index, point, condition, input, only, window), output, force=force)


@app.command(
    help_epilogue="""Examples:
  inerter docs    says how to build the site
  inerter docs site    opens the site in that folder"""
)
def docs(site: Path | None = None, /) -> None:
    """Open the documentation in the browser, or print how to build it.

    The site with all pages, the reference and the gallery takes 70 MB, and so
    it is not part of the package.

    Parameters
    ----------
    site
        Folder in which the site was built.
    """
    if site is None:
        print(
            "The documentation is the folder docs/ of the sources of inerter. To build its\n"
            "site, in the sources:\n"
            '  pip install ".[site]" && sphinx-build docs site && inerter docs site'
        )
        return
    start = (site / "index.html").resolve()
    if not start.is_file():
        raise StudyError(f"{site}: has no index.html. Build the site first: sphinx-build docs {site}")
    import webbrowser

    webbrowser.open(start.as_uri())
    print(start)


@app.command(
    help_epilogue="""Examples:
  inerter serve
  inerter serve examples/quarter-car.toml
  inerter serve my-study.toml --port 8722 --no-browser"""
)
def serve(
    study: Path | None = None,
    /,
    *,
    port: Annotated[int | None, Whole, Parameter(help="Port to listen on; default: a free port.")] = None,
    browser: Annotated[bool, Parameter(help="Open the page in the browser.")] = True,
    limit: Annotated[int, Whole, Parameter(help="Maximum size of a request in bytes.")] = LIMIT,
    record_limit: Annotated[int, Whole, Parameter(help="Maximum size of a measured record in bytes.")] = RECORD_LIMIT,
    folder: Annotated[
        Path | None, Parameter(help="Folder for jobs and records; default: a temporary folder, deleted at the end.")
    ] = None,
) -> None:
    """Open the interactive workbench in the browser.

    The server listens on this machine only, and prints its link. Ctrl-C stops it.

    Parameters
    ----------
    study
        The study file (TOML) to begin with.
    """
    from inerter.cli.serve import serve as command

    command(study, port, folder, (limit, record_limit), browser=browser)


app.command(
    "inerter.cli.reproduce:app",
    name="reproduce",
    help="Recompute a published paper and compare it with the printed numbers, designs, figures and claims.",
)


def main() -> int:
    """Run the command line of this process; returns its exit code, unless Ctrl-C ends it."""
    install_interrupt_handler()
    try:
        with alive():
            code = call(sys.argv[1:])
    except KeyboardInterrupt:  # while another was told
        code = INTERRUPTED
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    if was_interrupted():
        remove_temporary_folders()
        os._exit(code)  # compiled code that was cut short may not survive the interpreter's own end
    return code


def call(arguments: list[str]) -> int:
    """Run the command line with `arguments`, and turn errors into a sentence and an exit code, which is returned."""
    try:
        with interruptible():
            statements = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
        if (lost := output_error()) is not None:
            written = " The results are written all the same." if _writes(arguments) else ""
            return _fail(WorkError(f"standard output: {lost.strerror}.{written}"))
        return exit_code(statements or ())
    except KeyboardInterrupt as error:
        say_interrupted(error)
        return INTERRUPTED
    except CycloptsError as error:
        from inerter.cli.wrong_arguments import argument_sentence

        command = " ".join(("inerter", *app.parse_commands(arguments)[0]))
        return _fail(StudyError(argument_sentence(error, command)))
    except InerterError as error:
        return _fail(error)
    except OSError as error:
        return _fail(WorkError(f"{error.filename or 'system'}: {error.strerror or error}"))
    except Exception:
        if was_interrupted():  # some library made another error of it
            say_interrupted()
            return INTERRUPTED
        raise


def _writes(arguments: list[str]) -> bool:
    """Whether a command writes results to files, and not only to the terminal."""
    command = app.parse_commands(arguments)[1][-1].default_command
    return command is not None and not {"output", "options"}.isdisjoint(signature(command).parameters)


def _fail(error: InerterError) -> int:
    say(error.sentence)
    return exit_code([error])
