"""Packed numbers, read back by the rule that their module states."""

import gzip
import json
from base64 import b64encode

import numpy as np
import pandas as pd
import pytest

from compare.report.compression import COLOURED, DRAWN, RESOLUTION, pack_plot, pack_table


def opened(packed):
    """Return the header, and a function that reads numbers: the rule in other words."""
    raw = gzip.decompress(packed)
    size = int.from_bytes(raw[:4], "little")
    body = np.frombuffer(raw[4 + size :], np.uint8).astype(np.int64)

    def read(part):
        planes = body[part["at"] : part["at"] + 4 * part["n"]].reshape(4, part["n"])
        codes = sum(plane << 8 * k for k, plane in enumerate(planes))
        values = np.where(codes % 2, -(codes + 1) // 2, codes // 2)
        for _ in range(part["order"]):
            values = np.cumsum(values)
        values = values * part.get("step", 1)
        return np.exp(values) if part.get("log") else values

    return json.loads(raw[4 : 4 + size]), read


def test_a_table_comes_back_to_a_millionth_of_its_largest_numbers():
    time = np.linspace(0, 0.12, 500)
    wave = 1e6 * np.sin(400 * time) * np.exp(-20 * time)
    table = pd.DataFrame({"time (s)": time, "stress (Pa)": wave, "variant": ["a", "b"] * 250})
    (t, s, v), read = (lambda found: (found[0]["columns"], found[1]))(opened(pack_table(table)))
    assert np.linspace(t["first"], t["last"], 500) == pytest.approx(time, rel=1e-12)
    np.testing.assert_allclose(read(s), wave, rtol=0, atol=RESOLUTION * np.abs(wave).max())
    assert [v["levels"][int(code)] for code in read(v)] == table["variant"].tolist()


def test_numbers_that_repeat_come_back_whole():
    repeated = np.tile([0.1, 1 / 3, 1e9], 40)
    header, read = opened(pack_table(pd.DataFrame({"y (m)": repeated})))
    (column,) = header["columns"]
    assert [column["levels"][int(code)] for code in read(column)] == pytest.approx(
        repeated, rel=1e-9
    )


@pytest.mark.parametrize("size", [1e-300, 1.0, 1e300])
def test_noise_of_any_size_survives(size):
    noise = size * np.random.default_rng(7).standard_normal(1000)
    header, read = opened(pack_table(pd.DataFrame({"noise": noise})))
    largest = np.abs(noise).max()
    np.testing.assert_allclose(read(header["columns"][0]), noise, rtol=0, atol=RESOLUTION * largest)


def test_cells_without_a_number_are_told_apart():
    values = np.sin(np.arange(100.0))
    values[[3, 98]] = np.nan
    header, read = opened(pack_table(pd.DataFrame({"x": values})))
    (column,) = header["columns"]
    assert column["gaps"] == [3, 98]
    known = np.isfinite(values)
    np.testing.assert_allclose(read(column)[known], values[known], atol=1e-6)


def test_positive_numbers_of_many_decades_keep_their_digits():
    """A spectrum falls by ten decades: each number counts; zeros stay zeros."""
    spectrum = 10.0 ** -np.linspace(0, 10, 400) * (1.5 + np.sin(np.arange(400)))
    spectrum[[0, 7]] = 0
    header, read = opened(pack_table(pd.DataFrame({"amplitude": spectrum})))
    (column,) = header["columns"]
    assert column["log"] and column["zeros"] == [0, 7]
    known = spectrum > 0
    np.testing.assert_allclose(read(column)[known], spectrum[known], rtol=5 * RESOLUTION)


def test_what_has_no_packed_form_is_left_to_the_file_itself():
    assert pack_table(pd.DataFrame({"x": ["a,b"]})) is None
    assert pack_table(pd.DataFrame({"x, y": [1.0]})) is None
    assert pack_table(pd.DataFrame({"x": [1.0, np.inf]})) is None


def array(values, kind):
    return b64encode(np.asarray(values, dtype=f"<{kind}").tobytes()).decode()


def test_a_figure_keeps_all_but_its_arrays():
    wave = np.sin(np.linspace(0, 9, 300))
    field = np.outer(np.arange(4), np.arange(5)).astype(float)
    line = {"type": "scatter", "x0": 0, "y": {"dtype": "f4", "bdata": array(wave, "f4")}}
    image = {"z": {"dtype": "f4", "bdata": array(field, "f4"), "shape": "4,5"}}
    figure = {"data": [line, image], "layout": {"height": 300, "title": None}}
    header, read = opened(pack_plot(json.dumps(figure)))
    assert header["layout"] == figure["layout"] and header["data"][0]["x0"] == 0
    np.testing.assert_allclose(read(header["data"][0]["y"]["packed"]), wave, atol=2 * DRAWN)
    z = header["data"][1]["z"]["packed"]
    assert z["width"] == 5
    np.testing.assert_allclose(read(z).reshape(4, 5), field, atol=COLOURED * field.max())
