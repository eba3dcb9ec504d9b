"""Volumes of labels: each format's way to one surface, where it lies, which label, and what is refused."""

from __future__ import annotations

import gzip

import nibabel
import numpy as np
import pytest
import tifffile
from tests.core.volumefiles import (
    OBLIQUE,
    labels,
    metaimage,
    written_nifti,
    written_nrrd,
    written_stack,
)

from idviewer.core import MeshError, read_mesh
from idviewer.core.io import inspect_file, volumes
from idviewer.core.io.volumes import VolumeSettings

LABELS = labels()
VOXEL = abs(np.linalg.det(OBLIQUE))
IMAGEJ = {
    "imagej": True,
    "resolution": (1 / 0.8, 1 / 0.9),
    "metadata": {"spacing": 2.5, "unit": "um", "axes": "ZYX"},
}
OME = {"axes": "ZYX", "PhysicalSizeX": 0.8, "PhysicalSizeY": 0.9, "PhysicalSizeZ": 2.5}


def middle_of(label, affine):
    """The mean of a label's voxels in space: what a body's centre of mass must be."""
    return np.argwhere(label == LABELS).mean(axis=0) @ affine[:3, :3].T + affine[:3, 3]


def centroid(mesh):
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    sixth = np.einsum("ij,ij->i", a, np.cross(b, c))
    return (sixth[:, None] * (a + b + c)).sum(axis=0) / (4 * sixth.sum())


def saved(path, data):
    if isinstance(data, bytes):
        path.write_bytes(data)
    else:
        np.save(path, data)
    return path


SCALED = np.diag([0.8, 0.9, 2.5, 1.0])
FILES = {
    "a.nii": (lambda path: written_nifti(path, LABELS), OBLIQUE, "mm"),
    "b.nii.gz": (lambda path: written_nifti(path, LABELS.astype(np.int16)), OBLIQUE, "mm"),
    "c.nii": (lambda path: written_nifti(path, LABELS, nibabel.Nifti2Image, "micron"), OBLIQUE, "um"),
    "float.nii": (lambda path: written_nifti(path, LABELS.astype(np.float64)), OBLIQUE, "mm"),
    "four.nii.gz": (lambda path: written_nifti(path, LABELS[..., None]), OBLIQUE, "mm"),
    "a.mgz": (lambda path: written_nifti(path, LABELS.astype(np.int32), nibabel.MGHImage), OBLIQUE, "mm"),
    "a.mgh": (lambda path: written_nifti(path, LABELS, nibabel.MGHImage), OBLIQUE, "mm"),
    "a.nrrd": (lambda path: written_nrrd(path, LABELS), OBLIQUE, "mm"),
    "raw.nrrd": (lambda path: written_nrrd(path, LABELS.astype(">i4"), encoding="raw"), OBLIQUE, "mm"),
    "bz.nrrd": (lambda path: written_nrrd(path, LABELS.astype(np.uint64), encoding="bzip2"), OBLIQUE, "mm"),
    "text.nrrd": (lambda path: written_nrrd(path, LABELS, encoding="ascii"), OBLIQUE, "mm"),
    "um.nrrd": (lambda path: written_nrrd(path, LABELS, **{"space units": ["um"] * 3}), OBLIQUE, "um"),
    "a.seg.nrrd": (lambda path: written_nrrd(path, LABELS), OBLIQUE, "mm"),
    "a.nhdr": (lambda path: written_nrrd(path, LABELS), OBLIQUE, "mm"),
    "a.mha": (lambda path: saved(path, metaimage(LABELS)), OBLIQUE, "mm"),
    "b.mha": (lambda path: saved(path, metaimage(LABELS, packed=True, big=True)), OBLIQUE, "mm"),
    "ij.tif": (lambda path: written_stack(path, LABELS, **IMAGEJ), SCALED, "um"),
    "a.ome.tiff": (lambda path: written_stack(path, LABELS, ome=True, metadata=OME), SCALED, "um"),
    "a.tif": (
        lambda path: written_stack(path, LABELS.astype(np.uint16), compression="zlib"),
        np.eye(4),
        "voxel",
    ),
    "a.npy": (lambda path: saved(path, np.asfortranarray(LABELS)), np.eye(4), "voxel"),
    "b.npy": (lambda path: saved(path, LABELS.astype(">i8")), np.eye(4), "voxel"),
}


@pytest.mark.parametrize("name", FILES)
def test_labels_lie_where_the_file_says(tmp_path, name):
    """Their volume and centre of mass are those of their voxels, whichever way the axes run."""
    write, affine, unit = FILES[name]
    file = write(tmp_path / name)
    for label in (3, 7):
        mesh = read_mesh(file, part=str(label))
        size = np.count_nonzero(label == LABELS) * abs(np.linalg.det(affine))
        assert mesh.unit == unit
        assert mesh.volume == pytest.approx(size, rel=2e-3)
        np.testing.assert_allclose(centroid(mesh), middle_of(label, affine), atol=0.05 * size ** (1 / 3))
        assert f"Label {label}: {np.count_nonzero(label == LABELS):,} voxels of " in mesh.notes[0]
        assert "vertices moved by at most 0." in mesh.notes[0]
    assert any("does not tell the size" in note for note in mesh.notes) == (unit == "voxel")


@pytest.mark.parametrize("name", ["a.nii", "a.nrrd", "a.mha", "a.tif", "a.npy"])
def test_several_labels_are_named_with_their_volumes(tmp_path, name):
    write, affine, _ = FILES[name]
    file = write(tmp_path / name)
    with pytest.raises(
        MeshError, match=r"it holds 3 labels: '3' \(.*\), '7' \(.*\), '12' \(.*\); choose one"
    ) as caught:
        read_mesh(file)
    sizes = [float(part.description.split(" ")[0].replace(",", "")) for part in caught.value.parts]
    voxel = abs(np.linalg.det(affine))
    np.testing.assert_allclose(
        sizes, [np.count_nonzero(label == LABELS) * voxel for label in (3, 7, 12)], rtol=1e-3
    )
    for wrong in ("0", "1", "2", "liver"):  # no label goes by its place
        with pytest.raises(MeshError, match=f"it has no '{wrong}' among its labels"):
            read_mesh(file, part=wrong)
    assert inspect_file(file, "7").usable


def test_a_label_at_the_border_of_the_volume_is_closed(tmp_path):
    mesh = read_mesh(saved(tmp_path / "a.npy", LABELS), part="12")
    assert mesh.volume == pytest.approx(8.0, rel=2e-3)
    assert (mesh.bounds[0] < 0.0).all()


def test_segments_go_by_their_names(tmp_path):
    names = {"Segment0_LabelValue": "7", "Segment0_Name": "left kidney", "Segment1_LabelValue": "3"}
    file = written_nrrd(tmp_path / "a.seg.nrrd", LABELS, **names, Segment1_Name="liver")
    assert "Label 7 (left kidney): " in read_mesh(file, part="left kidney").notes[0]
    with pytest.raises(MeshError, match=r"'3' \(liver, 103.1 mm\^3\)|'3' \(liver, .* mm\^3\)"):
        read_mesh(file)


def test_voxels_beside_a_header_and_nowhere_else(tmp_path):
    (tmp_path / "inner").mkdir()
    file = saved(tmp_path / "inner" / "a.mhd", metaimage(LABELS, beside="a.raw"))
    with pytest.raises(MeshError, match=r"in 'a.raw', and there is no such file beside it"):
        read_mesh(file, part="7")
    raw = LABELS.astype("<u2").tobytes(order="F")
    (tmp_path / "inner" / "a.raw").write_bytes(raw)
    assert read_mesh(file, part="7").volume == pytest.approx(np.count_nonzero(LABELS == 7) * VOXEL, rel=2e-3)
    (tmp_path / "inner" / "a.raw").write_bytes(raw[:-2])
    with pytest.raises(MeshError, match=r"truncated: it announces 4,290 bytes of voxels and holds 4,288"):
        read_mesh(file, part="7")
    (tmp_path / "b.raw").write_bytes(raw)
    for name in ("../b.raw", "/etc/passwd", "a%03d.raw", "LIST", str(tmp_path / "b.raw")):
        saved(file, metaimage(LABELS, beside=name))
        with pytest.raises(MeshError, match=r"only files beside it are opened|a list of files"):
            read_mesh(file, part="7")
    (tmp_path / "inner" / "link.raw").symlink_to(tmp_path / "b.raw")
    saved(file, metaimage(LABELS, beside="link.raw"))
    with pytest.raises(MeshError, match="no such file beside it"):
        read_mesh(file, part="7")


def test_thresholds_choose_among_intensities(tmp_path):
    places = np.indices((12, 12, 12)) - 5.5
    heat = (100.0 - (places**2).sum(axis=0)).astype(np.float32)
    file = saved(tmp_path / "heat.npy", heat)
    with pytest.raises(
        MeshError, match=r"heat.npy: it holds intensities, not labels: .*part='>100'$"
    ) as caught:
        read_mesh(file)
    assert "export it again" not in str(caught.value)
    for part, inside in (
        (">84", heat > 84),
        (" >= 8.4e1", heat >= 84),
        ("<80.5", heat < 80.5),
        ("<=80", heat <= 80),
    ):
        mesh = read_mesh(file, part=part, component=1)
        assert mesh.volume == pytest.approx(inside.sum(), rel=5e-3)
    with pytest.raises(MeshError, match="it has no voxel > 1000; choose another threshold"):
        read_mesh(file, part=">1000")
    many = saved(tmp_path / "many.npy", np.arange(1, 126).reshape(5, 5, 5))
    with pytest.raises(
        MeshError, match=r"it holds 125 labels: .*; a threshold, such as part='>100', is taken too"
    ):
        read_mesh(many)
    for volume, why in (
        (np.arange(1331).reshape(11, 11, 11), "1,331 different numbers"),
        (-LABELS.astype(int), "below 0"),
    ):
        with pytest.raises(MeshError, match=why):
            read_mesh(saved(tmp_path / "a.npy", volume))


def test_pieces_of_a_label_are_components(tmp_path):
    two = np.zeros((9, 5, 5), np.uint8)
    two[1:4, 1:4, 1:4] = two[5:8, 2:4, 2:4] = 4
    file = saved(tmp_path / "two.npy", two)
    with pytest.raises(MeshError, match="2 components") as caught:
        read_mesh(file)
    assert len(caught.value.components) == 2
    assert read_mesh(file, component=1).volume > read_mesh(file, component=2).volume


@pytest.mark.parametrize(
    ("name", "data", "told"),
    [
        ("a.npy", np.zeros((3, 3, 3), int), "it holds no label: all of its voxels are 0"),
        ("a.npy", np.zeros((3, 3)), "an array of 2 dimensions is no volume of labels"),
        ("a.npy", np.zeros((3, 3, 3, 2), int), "its voxels are 3 x 3 x 3 x 2, and a volume"),
        ("a.npy", np.zeros((3, 3, 3), complex), "colours or complex numbers"),
        ("a.npy", np.zeros((3, 0, 3), int), "it announces 3 x 0 x 3 voxels"),
        ("a.npy", b"\x93NUMPY\x01\x00", "its header cannot be read"),
        ("a.npy", b"hello", "its header cannot be read"),
        ("a.nii", b"hello world", "does not begin with a header of NIfTI"),
        ("a.nii.gz", b"\x1f\x8bhello world, this is no gzip", "cannot be unpacked"),
        ("a.mgz", b"hello", "its header cannot be read"),
        ("a.mha", b"NDims = 3\n", "its header has no ElementDataFile"),
        ("a.mha", b"DimSize = 3 3\nElementDataFile = LOCAL\n", "it has 2 dimensions"),
        (
            "a.mha",
            b"DimSize = 3 3 3\nElementType = MET_HALF\nElementDataFile = LOCAL\n",
            "'HALF' is not known",
        ),
        ("a.mha", b"DimSize = 3 3 x\nElementDataFile = LOCAL\n", "not a readable MetaImage file"),
        ("a.nrrd", b"hello", "its header cannot be read"),
        ("a.tif", b"hello", "no whole TIFF file"),
    ],
)
def test_what_is_no_volume_of_labels_is_refused_in_one_line(tmp_path, name, data, told):
    with pytest.raises(MeshError, match=told) as caught:
        read_mesh(saved(tmp_path / name, data))
    assert "\n" not in str(caught.value)


def test_pickles_are_not_opened(tmp_path):
    np.save(tmp_path / "a.npy", np.array([[[{}]]], dtype=object), allow_pickle=True)
    with pytest.raises(
        MeshError, match="it holds pickled objects, which could run any program, and is not opened"
    ):
        read_mesh(tmp_path / "a.npy")


def test_images_alone_and_in_colour_are_refused(tmp_path):
    tifffile.imwrite(tmp_path / "one.tif", LABELS[0])
    with pytest.raises(MeshError, match="it holds one image, and a volume of labels is a stack"):
        read_mesh(tmp_path / "one.tif")
    tifffile.imwrite(tmp_path / "rgb.tif", np.zeros((4, 5, 6, 3), np.uint8), photometric="rgb")
    with pytest.raises(MeshError, match="colours"):
        read_mesh(tmp_path / "rgb.tif")


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["a.nii", "b.nii.gz", "a.mgz", "a.nrrd", "bz.nrrd", "a.mha", "b.mha", "a.tif", "a.npy"]
)
def test_files_that_are_cut_or_damaged_are_refused_in_one_line(tmp_path, rng, name):
    whole = FILES[name][0](tmp_path / name).read_bytes()
    for share in (0.1, 0.5, 0.95):
        (tmp_path / name).write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(MeshError) as caught:
            read_mesh(tmp_path / name, part="7")
        assert "\n" not in str(caught.value)
    for _ in range(25):
        data = bytearray(whole)
        for place in rng.integers(min(len(data), 400), size=3):
            data[place] = rng.integers(256)
        (tmp_path / name).write_bytes(bytes(data))
        try:
            read_mesh(tmp_path / name, part="7")
        except MeshError as error:
            assert "\n" not in str(error)  # noqa: PT017


def test_no_header_asks_for_more_than_is_there(tmp_path, monkeypatch):
    data = bytearray(written_nifti(tmp_path / "a.nii", LABELS).read_bytes())
    data[42:48] = np.array([9999, 9999, 9999], "<i2").tobytes()
    saved(tmp_path / "a.nii", bytes(data))
    with pytest.raises(
        MeshError, match="truncated: it announces 999,700,029,999 bytes of voxels and holds 2,145"
    ):
        read_mesh(tmp_path / "a.nii")
    bomb = metaimage(np.zeros((100, 100, 100), np.uint16), packed=True)
    saved(tmp_path / "bomb.mha", bomb)
    monkeypatch.setattr(volumes, "VOLUMES", VolumeSettings(most_bytes=1_000_000))
    with pytest.raises(
        MeshError, match="announces 2,000,000 bytes of voxels, more than the 1,000,000 allowed"
    ):
        read_mesh(tmp_path / "bomb.mha")
    saved(tmp_path / "bomb.nii.gz", gzip.compress(bytes(5_000_000)))
    with pytest.raises(MeshError, match="it unpacks to over 2,048,576 bytes, more than is allowed"):
        read_mesh(tmp_path / "bomb.nii.gz")
