"""The published tables still hold: a sample of their rows is computed again."""

import math
import shutil
from dataclasses import fields

import numpy as np
import pandas as pd
import pytest
from declared import equal_to
from PIL import Image

from analytic import conditioning, overturning_modes, simulate
from engines import ENGINES, installed_engines
from studies import overturning, respond, restitution, scenes, sweep
from studies.cases.drawn import RandomCase
from studies.cases.paper import Case
from studies.kit.pictures import save
from studies.kit.run import makers_of
from studies.kit.store import Store, provenance_of
from studies.linearizations import errors_on, line
from studies.measures.halving import factors
from studies.measures.published import PUBLISHED
from studies.page.chapters import PARTS

AWAY = set(ENGINES) - set(installed_engines())


def asked_here(table):
    return table[~table["source"].str.partition(":")[0].isin(AWAY)]


def sample(name, count):
    table = asked_here(pd.read_csv(PUBLISHED / name / "sweep.csv"))
    parts = [rows.sample(count, random_state=7) for _, rows in table.groupby("source")]
    return [row for part in parts for row in part.to_dict("records")]


@pytest.mark.parametrize(
    "row",
    [*sample("sweep", 8), *sample("presets", 2)],
    ids=lambda row: f"{row['source']}-{row['figure']}-{row['aspect']}-{row['omega_over_p']}",
)
def test_a_published_row_is_what_comes_out_today(row):
    labels = ("figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p")
    case = Case(**{name: row[name] for name in labels})
    response = respond(row["source"], case.block, case.motion)
    assert response.outcome.value == row["outcome"]
    # other processors round differently, and a response amplifies that by its kappa
    engine = row["source"].partition(":")[0]
    within = equal_to(engine, 1e-6) if engine in ENGINES else 1e-6
    assert response.peak_ratio == pytest.approx(float(row["peak_ratio"]), rel=within, nan_ok=True)


@pytest.mark.parametrize("name", ["sweep", "presets"])
def test_nothing_is_computed_again_in_a_published_folder(name, tmp_path):
    folder = shutil.copytree(PUBLISHED / name, tmp_path / name)
    (part,) = (part for part in PARTS if part.folder == name)
    sources = tuple(provenance_of(folder)["made"])
    jobs = sweep.jobs(sources, False, sweep.Options())
    with Store(folder, "sweep", "sweep") as store:
        kept = store.kept({job.key: job for job in jobs}, makers_of(jobs, sweep.STUDY.measure))
    assert len(kept) == len(jobs)
    assert part.study is sweep.STUDY


FOLLOWING = {
    "scenes": scenes.tabulate,
    "restitution": lambda found: restitution.tabulate(
        found["restitution"].assign(source="", outcome="", message="")
    ),
    "estimate": lambda found: {"factors": factors(found["estimates"])},
}
"""Folder -> what makes its tables, or some, of those of its rows."""


@pytest.mark.parametrize("folder", FOLLOWING)
def test_published_tables_follow_from_published_rows(folder):
    (study,) = (part.study for part in PARTS if part.folder == folder)
    kept = study.read(PUBLISHED / folder)
    for name, table in FOLLOWING[folder](kept).items():
        table = table.reset_index(drop=True)
        pd.testing.assert_frame_equal(table, kept[name], check_dtype=False, rtol=1e-12)


def published(name, **options):
    return pd.read_csv(PUBLISHED / name, keep_default_na=False, na_values=["nan"], **options)


def test_random_cases_are_what_comes_out_today():
    table = published("validate/errors.csv")
    well = table[(table["exact_outcome"] == "rocked") & (table["kappa"].abs() < 10)]
    for row in asked_here(well).groupby("source").sample(3, random_state=7).itertuples():
        case = RandomCase(**{each.name: getattr(row, each.name) for each in fields(RandomCase)})
        asked, within = (case.block, case.motion), equal_to(row.source.partition(":")[0], 1e-6)
        response, exact = respond(row.source, *asked), simulate(*asked)
        assert response.outcome.value == row.outcome
        assert response.peak_ratio == pytest.approx(row.peak_ratio, rel=within, nan_ok=True)
        assert exact.peak_ratio == pytest.approx(row.exact_peak, rel=1e-9)
        found = conditioning(*asked)
        assert found == pytest.approx((row.kappa, row.kappa_eta), rel=1e-6, abs=1e-12)


def test_linearizations_are_what_comes_out_today():
    kept = published("linearizations/linearizations.csv", dtype={"changed": str})
    kept = kept[kept["grid"] == "paper"].set_index("changed").drop(columns=["grid", "title"])
    today = pd.DataFrame([line(errors_on("paper", changed)) for changed in kept.index], kept.index)
    pd.testing.assert_frame_equal(today, kept, check_dtype=False, rtol=1e-9)


def test_cells_of_the_overturning_map_are_what_they_were():
    tables = overturning.STUDY.read(PUBLISHED / "overturning")
    window = overturning.window_of(tables["window"])
    for model, areas in tables["map"].groupby("model"):
        column = np.s_[::97]
        alpha, ratios = math.atan(1.0 / window.aspect), window.ratios(window.columns)[column, None]
        amplitudes = window.amplitudes(window.rows) * math.tan(alpha)
        modes = overturning_modes(alpha, amplitudes, ratios, 2, model).mode
        assert (modes == overturning.modes_of(areas, window)[column]).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "part",  # the samples of histories are not published: its command takes a second
    [part for part in PARTS if part.folder != "histories"],
    ids=lambda part: part.folder,
)
def test_a_published_picture_is_what_its_tables_draw_today(part, tmp_path):
    folder = PUBLISHED / part.folder
    for name, drawing in part.study.figures(part.study.read(folder)).items():
        save(drawing, tmp_path / f"{name}.png")
    assert {path.name for path in tmp_path.iterdir()} == {p.name for p in folder.glob("*.png")}
    for path in tmp_path.iterdir():
        now, before = pixels(path), pixels(folder / path.name)
        assert now.shape == before.shape
        assert (abs(now - before).max(axis=2) > 40).mean() < 1e-4, path.name


def pixels(path):
    return np.asarray(Image.open(path).convert("RGB"), dtype=int)
