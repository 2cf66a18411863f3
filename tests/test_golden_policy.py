"""The policy of golden pictures itself: what it lets pass and what it must catch."""

from __future__ import annotations

from pathlib import Path

import golden
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from refcloud.image import Picture, read_png, srgb_decode, write_png

CODES = st.integers(0, 255)


def grey(height: int = 40, width: int = 50) -> np.ndarray:
    return np.full((height, width, 3), 100, np.uint8)


def as_picture(codes: np.ndarray) -> Picture:
    values = codes / 255
    if codes.shape[2] == 4:
        alpha = values[..., 3]
        return Picture(srgb_decode(values[..., :3]) * alpha[..., None], alpha=alpha)
    return Picture(srgb_decode(values))


def compare(old: np.ndarray, new: np.ndarray, folder: Path) -> None:
    write_png(folder / "scene.png", old)
    golden.check_picture("scene", as_picture(new), folder, folder / "failures")


def test_the_same_picture_passes(tmp_path: Path) -> None:
    compare(grey(), grey(), tmp_path)


def test_a_small_wrong_patch_fails(tmp_path: Path) -> None:
    new = grey(192, 192)
    new[50:58, 60:68] += 40  # a whole-picture RMS of 1.7 codes would let it pass
    with pytest.raises(AssertionError, match=r"off by up to 40 codes.*0\.174%"):
        compare(grey(192, 192), new, tmp_path)


def test_one_code_on_few_pixels_passes(tmp_path: Path) -> None:
    new = grey(100, 100)
    new[:5, 0] += 1  # 0.05 %
    compare(grey(100, 100), new, tmp_path)


def test_one_code_on_more_pixels_fails(tmp_path: Path) -> None:
    new = grey(100, 100)
    new[:11, 0, 1] += 1  # 0.11 %
    with pytest.raises(AssertionError, match="off by up to 1 codes"):
        compare(grey(100, 100), new, tmp_path)


def test_two_codes_on_one_pixel_fail(tmp_path: Path) -> None:
    new = grey(100, 100)
    new[3, 4, 2] -= 2
    with pytest.raises(AssertionError, match=r"row 3, column 4: \[100, 100, 100\] -> "):
        compare(grey(100, 100), new, tmp_path)


def test_a_wrong_alpha_fails(tmp_path: Path) -> None:
    old = np.full((20, 20, 4), 255, np.uint8)
    new = old.copy()
    new[4, 4, 3] = 200
    with pytest.raises(AssertionError, match="off by up to 55 codes"):
        compare(old, new, tmp_path)
    assert read_png(tmp_path / "failures/scene.png").shape == (40, 60, 3)


def test_another_size_fails_and_shows_the_new_picture(tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match=r"stored \(40, 50, 3\), drawn \(50, 40"):
        compare(grey(), grey(50, 40), tmp_path)
    assert read_png(tmp_path / "failures/scene.png").shape == (50, 40, 3)


def test_a_picture_too_large_fails(tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match="long side"):
        compare(grey(1, 193), grey(1, 193), tmp_path)


def test_a_missing_picture_fails(tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match="pytest --regenerate scene"):
        golden.check_picture("scene", as_picture(grey()), tmp_path, tmp_path)


def test_a_failure_leaves_old_new_and_difference_and_success_clears_it(
    tmp_path: Path,
) -> None:
    old, new = grey(10, 20), grey(10, 20)
    new[2, 3] = [103, 90, 255]
    with pytest.raises(AssertionError):
        compare(old, new, tmp_path)
    sheet = read_png(tmp_path / "failures/scene.png")
    assert sheet.shape == (10, 60, 3)
    np.testing.assert_array_equal(sheet[:, :20], old)
    np.testing.assert_array_equal(sheet[:, 20:40], new)
    assert sheet[2, 43].tolist() == [30, 100, 255]
    assert np.count_nonzero(sheet[:, 40:]) == 3
    compare(old, old, tmp_path)
    assert not (tmp_path / "failures/scene.png").exists()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
@given(data=st.data())
def test_policy_by_counting(tmp_path: Path, data: st.DataObject) -> None:
    old = np.full((32, 32, 3), 128, np.uint8)  # one pixel of 1024 is 0.098 %
    new = old.copy()
    for _ in range(data.draw(st.integers(0, 3))):
        place = data.draw(st.tuples(st.integers(0, 31), st.integers(0, 31)))
        channel = data.draw(st.integers(0, 2))
        new[(*place, channel)] = data.draw(st.sampled_from([126, 127, 128, 129, 255]))
    off = np.abs(old.astype(int) - new)
    passes = off.max() <= 1 and np.count_nonzero(off.any(axis=-1)) <= 1
    if passes:
        compare(old, new, tmp_path)
    else:
        with pytest.raises(AssertionError):
            compare(old, new, tmp_path)


def stored_scene(folder: Path, light: float = 0.3) -> Picture:
    picture = Picture(np.full((8, 8, 3), light))
    golden.regenerate("scene", picture, folder)
    return picture


def test_probes_see_what_clipping_hides(tmp_path: Path) -> None:
    stored_scene(tmp_path, 5.0)
    brighter = Picture(np.full((8, 8, 3), 5.001))
    golden.check_picture("scene", brighter, tmp_path, tmp_path)
    with pytest.raises(AssertionError, match="linear pixel at row 4, column 4"):
        golden.check_probes("scene", brighter, tmp_path)


def test_probes_let_last_bits_pass(tmp_path: Path) -> None:
    picture = stored_scene(tmp_path)
    golden.check_probes("scene", Picture(picture.linear * (1 + 1e-10)), tmp_path)


def test_missing_probes_fail(tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match="no probes"):
        golden.check_probes("scene", Picture(np.zeros((2, 2, 3))), tmp_path)


def give_reasons(folder: Path) -> None:
    path = folder / "index.toml"
    path.write_text(path.read_text().replace('why = ""', 'why = "a test"'))


def test_a_renewed_picture_needs_its_reason_again(tmp_path: Path) -> None:
    stored_scene(tmp_path)
    with pytest.raises(AssertionError, match="say why scene"):
        golden.check_folder({"scene"}, tmp_path)
    give_reasons(tmp_path)
    golden.check_folder({"scene"}, tmp_path)
    stored_scene(tmp_path)
    with pytest.raises(AssertionError, match="say why scene"):
        golden.check_folder({"scene"}, tmp_path)


@pytest.mark.parametrize("scenes", [set(), {"scene", "another"}, {"another"}])
def test_scenes_and_pictures_are_the_same_names(
    tmp_path: Path, scenes: set[str]
) -> None:
    stored_scene(tmp_path)
    give_reasons(tmp_path)
    with pytest.raises(AssertionError, match=r"no scene|nothing for"):
        golden.check_folder(scenes, tmp_path)


def test_a_folder_that_grows_too_large_fails(tmp_path: Path) -> None:
    stored_scene(tmp_path)
    give_reasons(tmp_path)
    (tmp_path / "notes.bin").write_bytes(bytes(golden.MOST_BYTES))
    with pytest.raises(AssertionError, match="bytes in the folder"):
        golden.check_folder({"scene"}, tmp_path)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    table=st.dictionaries(
        st.from_regex(r"[a-z][a-z0-9-]{0,9}", fullmatch=True),
        st.fixed_dictionaries(
            {
                "why": st.text(st.characters(codec="utf-8"), max_size=20),
                "pixels": st.lists(
                    st.tuples(
                        st.integers(0, 999),
                        st.floats(allow_nan=False, allow_infinity=False),
                    ).map(list),
                    max_size=3,
                ),
            }
        ),
        max_size=3,
    )
)
def test_tables_come_back_from_their_text(tmp_path: Path, table: dict) -> None:
    path = tmp_path / "table.toml"
    path.write_text(golden.format_toml(table), encoding="utf-8", newline="\n")
    assert golden.read_toml(path) == table
