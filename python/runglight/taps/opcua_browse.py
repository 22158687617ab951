"""The boolean and integer variables below a node of an OPC UA server, by browsing."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from asyncua import ua
from asyncua.client.client import Client
from asyncua.ua.attribute_ids import AttributeIds

AT_ONCE = 200
"""Nodes per request; small controllers refuse large ones."""
INTEGERS: dict[ua.VariantType, str] = {
    ua.VariantType.Boolean: "BOOL",
    ua.VariantType.SByte: "SINT",
    ua.VariantType.Byte: "BYTE",
    ua.VariantType.Int16: "INT",
    ua.VariantType.UInt16: "UINT",
    ua.VariantType.Int32: "DINT",
    ua.VariantType.UInt32: "UDINT",
    ua.VariantType.Int64: "LINT",
    ua.VariantType.UInt64: "ULINT",
}
# OPC 10000-6, Annex A: the ids of the standard nodes.
_SERVER = ua.NodeId.from_string("i=2253")
_HIERARCHY = ua.NodeId.from_string("i=33")
_PROPERTY = ua.NodeId.from_string("i=46")
_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable that was found: `name` is its browse path below the node, joined by `-`."""

    node_id: ua.NodeId
    name: str
    type: str | None
    """IEC type; None where it is neither boolean nor integer, which `reason` says."""
    reason: str = ""


def chunks(items: Sequence[_T], size: int = AT_ONCE) -> Iterator[Sequence[_T]]:
    """The items, `size` at a time."""
    for start in range(0, len(items), size):
        yield items[start : start + size]


async def variables_below(client: Client, root: ua.NodeId) -> list[Variable]:
    """Every variable below `root` (and `root` itself), without the server's own diagnostics."""
    found: list[tuple[ua.NodeId, str]] = []
    visited = {root, _SERVER}
    level: list[tuple[ua.NodeId, tuple[str, ...]]] = [(root, ())]
    node_class = await client.get_node(root).read_node_class()
    if node_class is ua.NodeClass.Variable:
        browse_name = await client.get_node(root).read_browse_name()
        found.append((root, browse_name.Name))
    while level:
        below: list[tuple[ua.NodeId, tuple[str, ...]]] = []
        for part in chunks(level):
            answers = await _browse(client, [node_id for node_id, _ in part])
            for (_, path), references in zip(part, answers, strict=True):
                for reference in references:
                    node_id = ua.NodeId(
                        reference.NodeId.Identifier,
                        reference.NodeId.NamespaceIndex,
                        reference.NodeId.NodeIdType,
                    )
                    if node_id in visited or reference.ReferenceTypeId == _PROPERTY:
                        continue
                    visited.add(node_id)
                    step = (*path, reference.BrowseName.Name)
                    if reference.NodeClass is ua.NodeClass.Variable:
                        found.append((node_id, "-".join(step)))
                    below.append((node_id, step))
        level = below
    return await _typed(client, found)


async def _browse(
    client: Client, node_ids: Sequence[ua.NodeId]
) -> list[list[ua.ReferenceDescription]]:
    parameters = ua.BrowseParameters()
    parameters.View = ua.ViewDescription()
    parameters.RequestedMaxReferencesPerNode = 0
    parameters.NodesToBrowse = [
        ua.BrowseDescription(
            NodeId=node_id,
            BrowseDirection=ua.BrowseDirection.Forward,
            ReferenceTypeId=_HIERARCHY,
            IncludeSubtypes=True,
            NodeClassMask=ua.NodeClass.Object | ua.NodeClass.Variable,
            ResultMask=ua.BrowseResultMask.All,
        )
        for node_id in node_ids
    ]
    references: list[list[ua.ReferenceDescription]] = []
    for result in await client.uaclient.browse(parameters):
        listed = list(result.References or ())
        # A server may hand out long lists in pieces (OPC 10000-4, 5.9.3).
        point = result.ContinuationPoint
        while point:
            following = ua.BrowseNextParameters()
            following.ContinuationPoints = [point]
            following.ReleaseContinuationPoints = False
            [piece] = await client.uaclient.browse_next(following)
            listed += piece.References or ()
            point = piece.ContinuationPoint
        references.append(listed)
    return references


async def _typed(client: Client, found: list[tuple[ua.NodeId, str]]) -> list[Variable]:
    variables: list[Variable] = []
    for part in chunks(found):
        nodes = [client.get_node(node_id) for node_id, _ in part]
        values = await client.read_attributes(nodes)
        # A value that is bad at the moment may have no type: then the declared one counts.
        declared = await client.read_attributes(nodes, AttributeIds.DataType)
        for (node_id, name), value, data_type in zip(part, values, declared, strict=True):
            variables.append(_variable(node_id, name, value, data_type))
    return variables


def _variable(
    node_id: ua.NodeId, name: str, value: ua.DataValue, data_type: ua.DataValue
) -> Variable:
    variant = value.Value
    kind = None if variant is None else variant.VariantType
    if variant is None or kind is ua.VariantType.Null:
        kind = _declared(data_type)
    elif variant.is_array or isinstance(variant.Value, list):
        return Variable(node_id, name, None, "is an array, not one boolean or integer")
    if kind in INTEGERS:
        return Variable(node_id, name, INTEGERS[kind])
    called = "of a type of its own" if kind is None else f"of type {kind.name}"
    return Variable(node_id, name, None, f"is {called}, neither boolean nor integer")


def _declared(data_type: ua.DataValue) -> ua.VariantType | None:
    node_id = None if data_type.Value is None else data_type.Value.Value
    if not isinstance(node_id, ua.NodeId) or node_id.NamespaceIndex != 0:
        return None
    try:
        return ua.VariantType(int(str(node_id.Identifier)))
    except ValueError:
        return None
