"""Compressed glTF files, padded ones, those of several nodes, and those that ask for too much memory."""

from __future__ import annotations

import json
import struct
from contextlib import suppress
from pathlib import Path

import DracoPy
import meshopt
import numpy as np
import pytest
from tests.core import meshfiles, shapes
from tests.core.meshfiles import refusal, write

from idviewer.core.io import libraries
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.gltf import read_glb, read_gltf
from idviewer.core.io.meshes import read_mesh
from idviewer.core.io.text import UnreadableError

BODY = shapes.l_shape()
DRACO = "KHR_draco_mesh_compression"


def contents(tree: dict, buffer: bytes, part: str | None = None) -> Contents:
    return read_glb(FileSource(meshfiles.glb_of(tree, buffer), Path("a.glb"), part))


def draco(blob: bytes, points: int, corners: int) -> tuple[dict, bytes]:
    tree, _ = meshfiles.gltf_tree(*BODY)
    for accessor, count in zip(tree["accessors"], (points, corners), strict=True):
        accessor.pop("bufferView")
        accessor["count"] = count
    tree["bufferViews"] = [{"buffer": 0, "byteLength": len(blob)}]
    tree["buffers"] = [{"byteLength": len(blob)}]
    tree["extensionsRequired"] = [DRACO]
    extension = {DRACO: {"bufferView": 0, "attributes": {"POSITION": 0}}}
    tree["meshes"][0]["primitives"][0]["extensions"] = extension
    return tree, blob


def draco_body() -> bytes:
    return DracoPy.encode(BODY[0].astype(np.float32), BODY[1].astype(np.uint32), quantization_bits=16)


@pytest.mark.slow
def test_draco(tmp_path):
    tree, blob = draco(draco_body(), len(BODY[0]), BODY[1].size)
    mesh = read_mesh(write(tmp_path, ".glb", meshfiles.glb_of(tree, blob)))
    assert (len(mesh.vertices), len(mesh.faces), mesh.unit) == (*map(len, BODY), "m")
    assert mesh.volume == pytest.approx(3.0, rel=1e-4)
    for damaged, message in (
        (draco(blob, len(BODY[0]) + 1, BODY[1].size), "do not hold what is announced"),
        (draco(blob[:-20], len(BODY[0]), BODY[1].size), "truncated or damaged"),
        (draco(b"DRACO" + bytes(40), len(BODY[0]), BODY[1].size), "truncated or damaged"),
    ):
        with pytest.raises(UnreadableError, match=message):
            contents(*damaged)


def test_draco_is_not_asked_where_plain_data_are_there_too():
    tree, buffer = meshfiles.gltf_tree(*BODY)
    extension = {DRACO: {"bufferView": 99, "attributes": {"POSITION": 0}}}
    tree["meshes"][0]["primitives"][0]["extensions"] = extension
    assert np.array_equal(contents(tree, buffer).geometry.vertices, BODY[0])


@pytest.mark.parametrize("extra", ["DracoPy", "meshopt"])
def test_without_the_extra_the_command_that_adds_it_is_named(tmp_path, monkeypatch, extra):
    monkeypatch.setattr(libraries.importlib.util, "find_spec", lambda name: None)
    tree, buffer = draco(b"DRACO", 3, 3) if extra == "DracoPy" else packed("NONE", np.float32)
    message = refusal(write(tmp_path, ".glb", meshfiles.glb_of(tree, buffer)))
    assert message.endswith(f"and the package {extra} is missing; pip install 'idviewer[formats]' adds it")


def packed(way: str, dtype: type) -> tuple[dict, bytes]:
    """The body with its points and corners compressed by meshopt, and a second buffer that has no data."""
    tree, _ = meshfiles.gltf_tree(*BODY)
    count = len(BODY[0])
    rows = np.zeros((count, 4), dtype)
    rows[:, :3] = BODY[0]
    if way == "EXPONENTIAL":
        coded = meshopt.encode_filter_exp(rows[:, :3].astype(np.float32), 16)
    else:
        coded = rows if dtype != np.float32 else rows[:, :3].copy()
    blobs = [
        (meshopt.encode_gltf_buffer(coded, "ATTRIBUTES"), count, coded.nbytes // count, "ATTRIBUTES", way),
        (
            meshopt.encode_gltf_buffer(BODY[1].astype(np.uint32).ravel(), "TRIANGLES"),
            BODY[1].size,
            2,
            "TRIANGLES",
            "NONE",
        ),
    ]
    buffer, fallback = b"", 0
    for number, (blob, amount, stride, mode, filtered) in enumerate(blobs):
        where = {"buffer": 0, "byteOffset": len(buffer), "byteLength": len(blob), "byteStride": stride}
        extension = {**where, "count": amount, "mode": mode, "filter": filtered}
        length = amount * stride
        tree["bufferViews"][number] = {
            **{"buffer": 1, "byteOffset": fallback, "byteLength": length},
            "extensions": {"EXT_meshopt_compression": extension},
        }
        if number == 0:
            tree["bufferViews"][0]["byteStride"] = stride
        fallback += length
        buffer += blob + bytes(-len(blob) % 4)
    tree["accessors"][0]["componentType"] = {"f": 5126, "h": 5122}[np.dtype(dtype).char]
    fallback_buffer = {"byteLength": fallback, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}
    tree["buffers"] = [{"byteLength": len(buffer)}, fallback_buffer]
    tree["extensionsRequired"] = ["EXT_meshopt_compression", "KHR_mesh_quantization"]
    return tree, buffer


@pytest.mark.parametrize(
    ("way", "dtype"), [("NONE", np.float32), ("NONE", np.int16), ("EXPONENTIAL", np.float32)]
)
def test_meshopt(tmp_path, way, dtype):
    tree, buffer = packed(way, dtype)
    mesh = read_mesh(write(tmp_path, ".glb", meshfiles.glb_of(tree, buffer)))
    assert mesh.volume == 3.0
    assert np.array_equal(mesh.vertices, BODY[0])
    for place in range(0, len(buffer), 7):
        damaged = bytearray(buffer)
        damaged[place] ^= 0x55
        with suppress(UnreadableError):  # many a byte is that of a coordinate
            assert len(contents(tree, bytes(damaged)).geometry.sizes) == len(BODY[1])


def glb_with(gap: bytes = b"", behind: bytes = b"", uncounted: bytes = b"") -> bytes:
    tree, buffer = meshfiles.gltf_tree(*BODY)
    scene = json.dumps(tree).encode()
    scene += b" " * (-len(scene) % 4 + (2 if gap else 0))
    chunks = struct.pack("<I4s", len(scene), b"JSON") + scene + gap
    chunks += struct.pack("<I4s", len(buffer), b"BIN\0") + buffer + behind
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks + uncounted


@pytest.mark.parametrize(
    ("data", "note"),
    [
        (glb_with(), ()),
        (glb_with(gap=b"\0\0"), ("Padding bytes between its chunks, or behind them, were passed over.",)),
        (glb_with(behind=b"\0\0"), ("Padding bytes between its chunks, or behind them, were passed over.",)),
        (glb_with(uncounted=b"\0" * 9), ("9 bytes after its end were passed over.",)),
    ],
)
def test_padding_is_passed_over(data, note):
    read = read_glb(FileSource(data, Path("a.glb")))
    assert np.array_equal(read.geometry.vertices, BODY[0])
    assert read.notes == note


@pytest.mark.parametrize("cut", [1, 20, 200])
def test_what_is_cut_is_no_padding(cut):
    data = glb_with()
    with pytest.raises(UnreadableError, match="truncated"):
        read_glb(FileSource(data[:-cut], Path("a.glb")))
    with pytest.raises(UnreadableError, match="truncated"):
        read_glb(FileSource(data[:8] + struct.pack("<I", len(data) - cut) + data[12:-cut], Path("a.glb")))


@pytest.mark.parametrize(
    "name",
    ["KHR_materials_unlit", "KHR_texture_basisu", "VRMC_vrm", "KHR_lights_punctual", "EXT_texture_webp"],
)
def test_required_extensions_of_looks_are_harmless(name):
    tree, buffer = meshfiles.gltf_tree(*BODY)
    tree["extensionsRequired"] = [name]
    assert contents(tree, buffer).notes == ()


@pytest.mark.parametrize("name", ["KHR_implicit_shapes", "EXT_mesh_gpu_instancing", "KHR_gaussian_splatting"])
def test_required_extensions_of_shape_are_refused(name):
    tree, buffer = meshfiles.gltf_tree(*BODY)
    tree["extensionsRequired"] = [name]
    with pytest.raises(UnreadableError, match=f"it needs the extension {name}, which is not supported"):
        contents(tree, buffer)


def test_several_nodes_are_one_mesh_unless_one_is_chosen(tmp_path):
    tree, buffer = meshfiles.gltf_tree(*BODY, name="left", translation=[-5, 0, 0])
    tree["nodes"] += [{"mesh": 0, "name": "right", "translation": [5, 0, 0]}, {"mesh": 0}]
    tree["scenes"] = [{"nodes": [0, 1]}]
    path = write(tmp_path, ".glb", meshfiles.glb_of(tree, buffer))
    assert "2 components with 20, 20 faces; choose" in refusal(path)
    assert refusal(path).endswith("or one of its parts by name, part='left'")
    assert read_mesh(path, part="right").bounds[0, 0] == 5.0
    assert read_mesh(path, part="1").bounds[0, 0] == -5.0
    assert "it has no 'node 2' among its nodes; there are 'left', 'right'" in refusal(path, part="node 2")


def bomb(change) -> bytes:
    tree, buffer = meshfiles.gltf_tree(*BODY)
    change(tree)
    return meshfiles.glb_of(tree, buffer)


def instances(tree: dict) -> None:
    tree["nodes"] = [{"mesh": 0} for _ in range(100)]
    tree["meshes"][0]["primitives"] *= 1000
    tree["scenes"] = [{"nodes": list(range(100))}]


@pytest.mark.parametrize(
    "change",
    [
        lambda t: t["accessors"][0].update(count=10**13, sparse={}),
        lambda t: t["accessors"][0].update(count=10**13),
        lambda t: (t["accessors"][0].pop("bufferView"), t["accessors"][0].update(count=10**13, sparse={})),
        pytest.param(instances, marks=pytest.mark.slow),
    ],
)
def test_what_asks_for_more_memory_than_its_size_allows_is_refused(change):
    with pytest.raises(UnreadableError, match="more than 20 times the file's"):
        read_glb(FileSource(bomb(change), Path("a.glb")))


def test_compressed_counts_are_bounded():
    tree, buffer = packed("NONE", np.float32)
    tree["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 10**12
    with pytest.raises(UnreadableError, match="more than 20 times the file's"):
        contents(tree, buffer)


def test_a_buffer_beside_the_document_is_read_no_further_than_it_says(tmp_path):
    tree, buffer = meshfiles.gltf_tree(*BODY)
    (tmp_path / "body.bin").write_bytes(buffer + b"and more")
    tree["buffers"][0]["uri"] = "body.bin"
    source = FileSource(json.dumps(tree).encode(), tmp_path / "body.gltf")
    assert np.array_equal(read_gltf(source).geometry.vertices, BODY[0])
    (tmp_path / "folder").mkdir()
    tree["buffers"][0]["uri"] = "folder"
    with pytest.raises(UnreadableError, match="the file folder with its data is missing"):
        read_gltf(FileSource(json.dumps(tree).encode(), tmp_path / "body.gltf"))
