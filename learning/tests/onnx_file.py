# SPDX-License-Identifier: Apache-2.0
"""Reads what a test needs of an ONNX file without the package onnx: the operators and the opset."""

from collections.abc import Iterator

MODEL_GRAPH, MODEL_OPSET, GRAPH_NODE, NODE_OPERATOR, OPSET_VERSION = 7, 8, 1, 4, 2  # field numbers of onnx.proto


def _number(data: bytes, place: int) -> tuple[int, int]:
    value, shift = 0, 0
    while True:
        byte = data[place]
        place += 1
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            return value, place


def _fields(data: bytes) -> Iterator[tuple[int, bytes | int]]:
    """Fields of a protobuf message: number and content."""
    place = 0
    while place < len(data):
        key, place = _number(data, place)
        kind = key & 7
        if kind == 0:
            value, place = _number(data, place)
            yield key >> 3, value
            continue
        if kind == 2:
            length, place = _number(data, place)
        else:
            length = {1: 8, 5: 4}[kind]
        yield key >> 3, data[place:place + length]
        place += length


def operators(data: bytes) -> list[str]:
    """Names of the operators of all nodes, in order."""
    graph = next(value for field, value in _fields(data) if field == MODEL_GRAPH)
    nodes = (value for field, value in _fields(graph) if field == GRAPH_NODE)
    return [value.decode() for node in nodes for field, value in _fields(node) if field == NODE_OPERATOR]


def opset(data: bytes) -> int:
    """Version of the operators."""
    imported = next(value for field, value in _fields(data) if field == MODEL_OPSET)
    return next(value for field, value in _fields(imported) if field == OPSET_VERSION)
