"""The bodies of requests: which keys each has. They are checked by these, and described by them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

Text = Annotated[str, Field(max_length=200)]
Name = Annotated[str, Field(max_length=200)]
Number = Annotated[float, Field(allow_inf_nan=False)]
Document = Annotated[dict[str, Any], Field(description="A study document: the tables of a study file.")]
Values = Annotated[
    dict[str, str | Number],
    Field(description="Values of free elements: texts with a unit, or numbers in the SI unit."),
]


class Body(BaseModel):
    """The body of a request; keys that it does not know are errors."""

    model_config = ConfigDict(extra="forbid", strict=True)


class DesignRequest(Body):
    """A design: a layout, and a value for each of its free elements."""

    layout: Name
    values: Values = {}
    name: Text = ""


class ComparedDesign(DesignRequest):
    """A design that is compared: one of the study of the request, or of another one."""

    study: Annotated[Document | None, Field(description="Study of the design, if it is another one.")] = None


class ReadStudy(Body):
    """A study file as text, or a document whose problems are asked for."""

    text: str | None = None
    study: Document | None = None
    name: Text = ""


class CheckStudy(Body):
    """A study document."""

    study: Document


class StudyParts(Body):
    """A study document, finished or not."""

    study: Document


class RenameElements(Body):
    """A study document, and new names of its elements by the old ones."""

    study: Document
    names: dict[Name, Name]


class DeviceInStrut(Body):
    """A study document, the network of a strut, and a document of a device that joins it."""

    study: Document
    network: str
    device: Document


class WriteStudy(Body):
    """A study document, and designs at which it is to be fixed, if any."""

    study: Document
    designs: Annotated[list[DesignRequest], Field(max_length=100)] = []


class ParseNetwork(Body):
    """The text of a network, and the names that it may use."""

    text: str
    elements: dict[str, Any] | list[str] | None = None


class QuantityBody(Body):
    """A text that is to be read, in `unit` if it is given; or a value in `unit` that is to be written."""

    text: str | None = None
    value: Number | None = None
    unit: Text | None = None
    digits: Annotated[int, Field(ge=1, le=17)] = 4


class Quantities(Body):
    """Several texts or values, as in `QuantityBody`."""

    items: Annotated[list[QuantityBody], Field(max_length=10_000)]


class OfDesigns(Body):
    """Study, designs and sequence number of a request about designs."""

    study: Document
    designs: Annotated[list[ComparedDesign], Field(max_length=100)] = []
    layouts: Annotated[list[Name], Field(max_length=1000)] = []
    values: Annotated[dict[str, Values], Field(description="By layout, where `designs` are not given.")] = {}
    baseline: DesignRequest | None = None
    indices: list[Name] = []
    methods: list[Name] = []


class PanelRequest(OfDesigns):
    """A request to a panel."""

    client: Annotated[str, Field(max_length=100, description="Unique text of each open page.")] = ""
    sequence: Annotated[Number, Field(description="Increases with each request of the page to the panel.")] = 0
    design: DesignRequest | None = None
    layout: Name | None = None
    index: Name | None = None
    parameter: Name | None = None
    method: Name | None = None
    duration: Annotated[Number, Field(gt=0.0, description="[s]")] | None = None
    step: Annotated[Number, Field(gt=0.0, description="[s]")] | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    spread: Annotated[dict[Name, Number], Field(description="Relative tolerances of the values.")] = {}
    samples: Annotated[int, Field(ge=2, le=65536)] | None = None
    outputs: list[Name] = []
    output: Annotated[Name, Field(description="The only output in the answer; default: the first.")] = ""
    while_waiting: Annotated[bool, Field(description="Optimise only what comes while a person waits.")] = False


class WorkRequest(OfDesigns):
    """A request for long work."""

    kind: Name
    study: Document = {}
    title: Text = ""
    wait: Annotated[Number, Field(ge=0.0, le=30.0, description="Seconds to wait for its end.")] = 0.0
    method: Name | None = None
    design: DesignRequest | None = None
    layout: Name | None = None
    index: Name | None = None
    sweep: dict[str, Any] | None = None
    points: Annotated[int, Field(ge=3, le=200)] | None = None
    records: Annotated[list[Name], Field(max_length=100)] = []
    model: Name | None = None
    config: dict[str, Any] | None = None


class FigureRequest(OfDesigns):
    """A request for a picture."""

    kind: Name
    format: Name = "svg"
    duration: Annotated[Number, Field(gt=0.0, description="[s] of the motion")] | None = None
    step: Annotated[Number, Field(gt=0.0, description="[s]")] | None = None
    seed: Annotated[int, Field(ge=0)] = 0


class DesignExport(Body):
    """A design that is wanted in the format of another program."""

    kind: Name
    suffix: Annotated[Name, Field(description="Suffix of the file, if the kind has several.")] = ""
    study: Document
    design: DesignRequest
    index: Annotated[Name | None, Field(description="Index whose curves are in tables; default: the first.")] = None
    linear: Annotated[bool, Field(description="Export the linear model: neglect friction and close gaps.")] = False


class ExportRequest(Body):
    """A panel, and its request, whose numbers are wanted as a table."""

    panel: Name
    request: PanelRequest
