"""OFF files as they are found in the wild, and as they must not be."""

from __future__ import annotations

import pytest
from tests.core import meshfiles

from idviewer.core.io.off import read_off
from idviewer.core.io.text import UnreadableError

POINTS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
FACES = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"


OFF_VARIANTS = {
    "plain": f"OFF\n4 4 6\n{POINTS}{FACES}",
    "counts beside OFF": f"OFF 4 4 6\n{POINTS}{FACES}",
    "two counts": f"OFF\n4 4\n{POINTS}{FACES}",
    "comments": f"# made by hand\n\nOFF # text\n# sizes\n4 4 0 # all\n\n{POINTS}\n# faces\n{FACES}\n# end",
    "colours": f"COFF\n4 4 0\n{POINTS.replace(chr(10), ' 255 0 0 255' + chr(10))}{FACES}",
    "normals": f"NOFF\n4 4 0\n{POINTS.replace(chr(10), ' 0.1 0.2 0.3' + chr(10))}{FACES}",
    "all of them": f"STCNOFF\n4 4 0\n{POINTS.replace(chr(10), ' 1 2 3 4 5 6 7 8 9' + chr(10))}{FACES}",
    "coloured faces": f"OFF\n4 4 0\n{POINTS}3 0 2 1 0.5 0.5 0.5\n3 0 1 3 7\n3 0 3 2\n3 1 2 3 1 0 0 1\n",
    "Windows": f"OFF\n4 4 0\n{POINTS}{FACES}".replace("\n", "\r\n"),
    "old Mac": f"OFF\n4 4 0\n{POINTS}{FACES}".replace("\n", "\r"),
    "byte order mark": f"\ufeffOFF\n4 4 0\n{POINTS}{FACES}",
    "indented": f"  OFF\n 4   4\t0\n{POINTS}{FACES}".replace("\n", " \n\t"),
}


@pytest.mark.parametrize("text", OFF_VARIANTS.values(), ids=list(OFF_VARIANTS))
def test_off_variants(text):
    assert meshfiles.is_tetrahedron(read_off(text.encode()).geometry)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"OFF BINARY\n4 4 0\n{POINTS}{FACES}", "binary OFF is not supported"),
        (f"4OFF\n4 4 0\n{POINTS}{FACES}", "three dimensions"),
        (f"nOFF\n3\n4 4 0\n{POINTS}{FACES}", "three dimensions"),
        (f"OFX\n4 4 0\n{POINTS}{FACES}", "does not begin with OFF"),
        ("OFF\n", "nothing follows OFF"),
        (f"OFF\n4\n{POINTS}{FACES}", "numbers of vertices and faces"),
        (f"OFF\n4 -4 0\n{POINTS}{FACES}", "numbers of vertices and faces"),
        (f"OFF\n99 4 0\n{POINTS}{FACES}", "truncated: it announces 99 vertices and holds 8"),
        (f"OFF\n4 5 0\n{POINTS}{FACES}", "truncated: it announces 5 faces and holds 4"),
        (f"OFF\n4 3 0\n{POINTS}{FACES}", "wrong counts: it announces 3 faces and holds more"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("3 1 2 3", "4 1 2 3"), "fewer corners than it announces"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("3 1 2 3", "3 1 2 x"), "'x' stands where a vertex number"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("1 0 0", "1 0 O"), "'O' stands where a number"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("1 0 0", "1 0"), "fewer than three coordinates"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("3 1 2 3", "3 1 2 99999999999999999999"), "vertex number"),
    ],
)
def test_off_refusals(text, message):
    with pytest.raises(UnreadableError, match=message):
        read_off(text.encode())
