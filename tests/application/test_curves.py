"""Curves as files: what is written comes back, and a file appears whole or not at all."""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest

from cardan.app.files import columns as curves
from cardan.app.files.whole_file import check_writable, whole_file
from cardan.app.scene import Scene, SceneResult
from cardan.app.scene.study.curves import columns, write_curves, write_study
from cardan.app.scene.study.study import StudyResult
from cardan.arrays import FloatArray

SCENE = """\
[driveline]
bends_deg = [10, 25]
twists_deg = [30]
[load]
speed_rpm = 3000
inertias_kgm2 = [0, 0.1, 0.02]
[sweep]
samples_per_turn = 90
turns = 2
[output]
quantities = ["angle", "speed_ratio", "torque", "support_moment", "moment", "tilt_driven"]
"""

NAMES = [
    "drive_angle_deg",
    "angle_deg",
    "speed_ratio",
    "torque_Nm",
    *(f"support_moment_{axis}_Nm" for axis in "xyz"),
    *(f"moment_{joint}_{axis}_Nm" for joint in (0, 1) for axis in "xyz"),
    "tilt_driven_0_deg",
    "tilt_driven_1_deg",
]


@pytest.fixture(scope="module")
def result() -> SceneResult:
    return Scene.parse(SCENE).run()


def test_columns(result: SceneResult) -> None:
    table = columns(result)
    assert list(table) == NAMES
    assert {len(curve) for curve in table.values()} == {181}
    np.testing.assert_array_equal(table["drive_angle_deg"], np.arange(181) * 4.0)
    np.testing.assert_array_equal(table["angle_deg"], np.degrees(result.values["angle"]))
    np.testing.assert_array_equal(table["moment_1_z_Nm"], result.values["moment"][1, :, 2])
    np.testing.assert_array_equal(
        table["support_moment_y_Nm"], result.values["support_moment"][:, 1]
    )
    np.testing.assert_array_equal(
        table["tilt_driven_1_deg"], np.degrees(result.values["tilt_driven"][1])
    )


@pytest.mark.parametrize("block", [1, 7, 181, 10_000])
def test_csv(
    result: SceneResult, tmp_path: Path, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(curves, "_BLOCK", block)
    path = tmp_path / "a.csv"
    assert write_curves(result, path) == 181
    head, *lines = path.read_text(encoding="ascii").splitlines()
    assert head.split(",") == NAMES
    # Every digit: the doubles are the same, not close.
    read = np.array([[float(figure) for figure in line.split(",")] for line in lines])
    np.testing.assert_array_equal(read.T, list(columns(result).values()))


def test_npz(result: SceneResult, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    assert write_curves(result, str(path)) == 181
    with np.load(path) as read:
        assert set(read) == {"drive_angle", *result.values}
        np.testing.assert_array_equal(read["drive_angle"], result.drive_angle)
        for name, values in result.values.items():
            np.testing.assert_array_equal(read[name], values)


def test_parquet(result: SceneResult, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "a.parquet"
    assert write_curves(result, path) == 181
    read = parquet.read_table(path)
    assert read.column_names == NAMES
    for name, curve in columns(result).items():
        np.testing.assert_array_equal(read[name].to_numpy(), curve)


def test_parquet_without_pyarrow(
    result: SceneResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImportError, match=r"needs pyarrow: pip install 'cardan\[table\]'"):
        write_curves(result, tmp_path / "a.parquet")
    assert list(tmp_path.iterdir()) == []


def test_unknown_suffix(result: SceneResult, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"a\.ods must end in \.csv or .* or \.xlsx"):
        write_curves(result, tmp_path / "a.ods")
    assert list(tmp_path.iterdir()) == []


# Studies


@pytest.fixture(scope="module")
def study() -> StudyResult:
    result = Scene.parse(
        "[driveline]\nbends_deg = [10, 25]\n[load]\ndrive_torque_Nm = 5\n"
        "[study]\nbends_deg.1 = {from = 0, to = 30, steps = 7}\nphases_deg = [0, 45, 90]\n"
        "[output]\nquantities = ['moment', 'tilt_driven']\nreduce = ['peak', 'mean']\n"
        "joints = [1]\n"
        "[sweep]\nsamples_per_turn = 8\n"
    ).run()
    assert result.study is not None
    return result.study


STUDY_NAMES = [
    *("bends_deg.1", "phases_deg", "equivalent_bend_deg", "non_uniformity", "max_angle_error_deg"),
    "moment_1_peak_Nm",
    *(f"moment_1_{axis}_mean_Nm" for axis in "xyz"),
    *("tilt_driven_1_peak_deg", "tilt_driven_1_mean_deg"),
]


@pytest.mark.parametrize("block", [1, 4, 21, 1000])
@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_study_rows(
    study: StudyResult, tmp_path: Path, suffix: str, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(curves, "_BLOCK", block)
    path = tmp_path / f"a.{suffix}"
    assert write_study(study, path) == 21
    if suffix == "csv":
        head, *lines = path.read_text(encoding="ascii").splitlines()
        names = head.split(",")
        rows = [[float(figure) for figure in line.split(",")] for line in lines]
        read = list(np.array(rows).T)
    else:
        table = pytest.importorskip("pyarrow.parquet").read_table(path)
        names, read = table.column_names, [column.to_numpy() for column in table.columns]
    assert names == STUDY_NAMES
    np.testing.assert_array_equal(read[0], np.repeat(np.arange(7) * 5.0, 3))
    np.testing.assert_array_equal(read[1], np.tile([0.0, 45.0, 90.0], 7))
    np.testing.assert_array_equal(read[2], np.degrees(study.values["equivalent_bend"]).ravel())
    np.testing.assert_array_equal(read[6], study.values["moment_1_x_mean"].ravel())


def test_study_as_a_grid(study: StudyResult, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    assert write_study(study, path) == 21
    with np.load(path) as read:
        assert set(read) == {"bends_deg.1", "phases_deg", *study.values}
        np.testing.assert_array_equal(read["bends_deg.1"], np.arange(7) * 5.0)
        for name, values in study.values.items():
            assert values.shape == (7, 3)
            np.testing.assert_array_equal(read[name], values)


def test_figures_of_one_driveline_are_one_row(tmp_path: Path) -> None:
    result = Scene.parse("[driveline]\nbends_deg = [10]\n[output]\nclosed_forms = ['k']").run()
    assert result.study is not None
    assert write_study(result.study, tmp_path / "a.csv") == 1
    k = result.scene.line.equivalent().k
    assert (tmp_path / "a.csv").read_text() == f"k\n{float(k)!r}\n"


def test_columns_of_shafts_and_in_radians() -> None:
    text = SCENE.replace("quantities", "shafts = [0, 2]\njoints = [1]\nquantities")
    result = Scene.parse(text).run()
    table = columns(result, radians=True)
    assert list(table) == [
        "drive_angle_rad",
        *("angle_0_rad", "angle_2_rad", "speed_ratio_0", "speed_ratio_2", "torque_0_Nm"),
        "torque_2_Nm",
        *(f"support_moment_{shaft}_{axis}_Nm" for shaft in (0, 2) for axis in "xyz"),
        *(f"moment_1_{axis}_Nm" for axis in "xyz"),
        "tilt_driven_1_rad",
    ]
    np.testing.assert_array_equal(table["drive_angle_rad"], result.drive_angle)
    np.testing.assert_array_equal(table["angle_2_rad"], result.values["angle"][1])
    np.testing.assert_array_equal(table["moment_1_y_Nm"], result.values["moment"][0, :, 1])


def test_writable_or_not(tmp_path: Path) -> None:
    (tmp_path / "old.csv").write_text("old")
    check_writable(tmp_path / "a.csv")
    check_writable(tmp_path / "old.csv")
    assert [(entry.name, entry.read_text()) for entry in tmp_path.iterdir()] == [("old.csv", "old")]
    for path in (tmp_path, tmp_path / "missing" / "a.csv"):
        with pytest.raises(OSError, match="directory") as caught:
            check_writable(path)
        assert caught.value.filename == str(path)


# Whole or not at all


def test_takes_its_name_when_complete(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")
    with whole_file(path) as file:
        file.write(b"new")
        file.flush()
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_link_stays(tmp_path: Path) -> None:
    path, link = tmp_path / "a.csv", tmp_path / "link.csv"
    link.symlink_to(path)
    for text in (b"first", b"second"):
        with whole_file(link) as file:
            file.write(text)
        assert (link.readlink(), path.read_bytes()) == (path, text)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_keeps_what_is_no_file(tmp_path: Path) -> None:
    path = tmp_path / "pipe.csv"
    os.mkfifo(path)
    with pytest.raises(OSError, match="Not a plain file") as caught, whole_file(path):
        pass
    assert caught.value.filename == str(path)
    assert path.is_fifo()


@pytest.mark.parametrize("old", [True, False])
@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, SystemExit, MemoryError])
def test_interrupted(tmp_path: Path, error: type[BaseException], old: bool) -> None:
    path = tmp_path / "a.csv"
    if old:
        path.write_text("old")

    def write() -> None:
        with whole_file(path) as file:
            file.write(b"half")
            raise error

    with pytest.raises(error):
        write()
    assert [(entry, entry.read_text()) for entry in tmp_path.iterdir()] == [(path, "old")][:old]


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_disk_full(
    result: SceneResult, tmp_path: Path, step: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, step, full)
    with pytest.raises(OSError, match="No space") as caught:
        write_curves(result, path)
    assert (caught.value.errno, caught.value.filename) == (errno.ENOSPC, str(path))
    assert [(entry, entry.read_text()) for entry in tmp_path.iterdir()] == [(path, "old")]


def test_failing_writer_leaves_nothing(
    result: SceneResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first blocks are on their way when the rest fails."""

    def blocks(table: Mapping[str, FloatArray], _: object) -> Iterator[list[FloatArray]]:
        yield [column[:10] for column in table.values()]
        raise MemoryError

    monkeypatch.setattr(curves, "_blocks", blocks)
    with pytest.raises(MemoryError):
        write_curves(result, tmp_path / "a.csv")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_progress_of_a_long_file(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    monkeypatch.setattr(curves, "_BLOCK", 4)
    seen: list[tuple[int, int]] = []
    table = {"a": np.arange(10.0)}
    curves.write_columns(tmp_path / f"a{suffix}", table, lambda *done: seen.append(done))
    assert seen == [(4, 10), (8, 10), (10, 10)]


def test_unwritable(result: SceneResult, tmp_path: Path) -> None:
    missing = tmp_path / "missing" / "a.csv"
    with pytest.raises(FileNotFoundError) as caught:
        write_curves(result, missing)
    assert caught.value.filename == str(missing)

    (tmp_path / "file").touch()
    with pytest.raises(NotADirectoryError) as not_a_folder:
        write_curves(result, tmp_path / "file" / "a.csv")
    assert not_a_folder.value.filename == str(tmp_path / "file" / "a.csv")

    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(IsADirectoryError) as folder:
        write_curves(result, tmp_path / "folder.csv")
    assert folder.value.filename == str(tmp_path / "folder.csv")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["file", "folder.csv"]


@pytest.mark.skipif(
    os.name != "posix" or os.geteuid() == 0, reason="root may write into every folder"
)
def test_read_only_folder(result: SceneResult, tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(PermissionError) as caught:
            write_curves(result, tmp_path / "a.csv")
    finally:
        tmp_path.chmod(0o700)
    assert caught.value.filename == str(tmp_path / "a.csv")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="POSIX permissions")
def test_permissions_are_those_of_any_new_file(result: SceneResult, tmp_path: Path) -> None:
    (tmp_path / "plain").touch()
    write_curves(result, tmp_path / "a.csv")
    modes = {stat.S_IMODE(entry.stat().st_mode) for entry in tmp_path.iterdir()}
    assert len(modes) == 1
