"""An export: the values of the elements of a design, as rows for a parts list."""

from __future__ import annotations

import inerter as it


def parts_list(request: it.ExportSpec, suffix: str) -> str:
    """Rows "strut, element, value, unit"; a design with free values is refused."""
    rows = ["strut,element,value,unit"]
    for strut in request.mechanism.struts:
        rows += [f"{strut.name},{one.label},{one.value!r},{one.unit}" for one in strut.network.elements()]
    return "\n".join(rows) + "\n"


it.EXPORTS.add(it.ExportKind("parts-list", "values of all elements, for a parts list", (".parts",), parts_list))
