import numpy as np
import pytest

from idviewer.view.colormaps import COLORMAPS, TABLE_SIZE, UNKNOWN_COLOR, colors, lookup_table


def _luminance(rgb: np.ndarray) -> np.ndarray:
    """CIE Y of sRGB colours."""
    share = rgb / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


@pytest.mark.parametrize("name", COLORMAPS)
def test_maps_are_smooth_and_end_in_different_colors(name: str) -> None:
    table = colors(name).astype(int)
    assert table.shape == (TABLE_SIZE, 3)
    assert np.abs(np.diff(table, axis=0)).max() <= 8
    assert np.abs(table[0] - table[-1]).max() > 60


def test_the_paper_runs_from_dark_blue_over_cyan_green_and_yellow_to_dark_red() -> None:
    red, green, blue = colors("paper").astype(int).T
    at = [
        0,
        TABLE_SIZE // 6,
        TABLE_SIZE // 3,
        TABLE_SIZE // 2,
        2 * TABLE_SIZE // 3,
        5 * TABLE_SIZE // 6,
        TABLE_SIZE - 1,
    ]
    order = ["blue", "blue", "cyan", "green", "yellow", "red", "red"]
    found = []
    for i in at:
        bright = [
            name
            for name, part in zip(("red", "green", "blue"), (red[i], green[i], blue[i]), strict=True)
            if part > 0.7 * max(red[i], green[i], blue[i])
        ]
        names = {("green", "blue"): "cyan", ("red", "green"): "yellow"}
        found.append(names.get(tuple(bright), bright[0]))
    assert found == order
    light = _luminance(colors("paper"))
    assert max(light[0], light[-1]) < 0.06 < 0.5 < light.max()


def test_the_even_map_grows_lighter_all_the_way() -> None:
    assert np.all(np.diff(_luminance(colors("even"))) > -1e-3)


def test_tables_hold_the_colors_and_grey_for_unknown_values() -> None:
    table = lookup_table("paper")
    assert table.scalar_range == (0.0, 1.0)
    for value, rgb in ((0.0, colors("paper")[0]), (1.0, colors("paper")[-1]), (-1.0, colors("paper")[0])):
        assert np.allclose(np.array(table.map_value(value)[:3]) * 255, rgb, atol=1)
    assert np.allclose(table.map_value(np.nan)[:3], UNKNOWN_COLOR, atol=0.01)


def test_each_table_is_a_new_one_and_colors_cannot_be_changed() -> None:
    assert lookup_table("paper") is not lookup_table("paper")
    with pytest.raises(ValueError, match="read-only"):
        colors("paper")[0] = 0


def test_a_map_that_does_not_exist_is_an_error_that_names_those_that_do() -> None:
    with pytest.raises(ValueError, match="paper, even"):
        lookup_table("jet")
