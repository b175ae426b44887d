"""What the paper's cases say about each source: the engines by preset, and the linearizations."""

from pathlib import Path
from typing import Any

import pandas as pd

from studies.measures.presets import engine_of, in_order, in_words, preset_of
from studies.measures.words import NAMED, alike, capital, each_out_of, listed, out_of, part
from studies.sources.registry import resolve


def whole(folder: Path) -> pd.DataFrame:
    """Return the lines of a folder's summary.csv that are about all its figures."""
    return over_all(pd.read_csv(folder / "summary.csv"))


def over_all(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of a summary that are about all its figures."""
    lines: pd.DataFrame = summary[summary["figure"] == summary["figure"].iloc[-1]]
    return lines.reset_index(drop=True)


def engines_by_preset(lines: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return the engines' lines of a summary, by preset, in the order in which these get better."""
    rows = lines.assign(preset=lines["source"].map(preset_of))
    rows = rows[rows["preset"] != ""]
    return {name: rows[rows["preset"] == name] for name in in_order(rows["preset"])}


def preset_claim(preset: str, lines: pd.DataFrame) -> str:
    """Say how many outcomes the engines get right with a preset, and how far peaks are off."""
    if len(lines) > NAMED:
        return capital(_range(preset, lines))
    names = listed([engine_of(source) for source in lines["source"]])
    right = each_out_of(list(lines["agree"]), list(lines["cases"]))
    verb = "get" if len(lines) > 1 else "gets"
    medians, largest = (list(map(part, lines[f"{name}_error"])) for name in ("median", "max"))
    return capital(
        f"{in_words(preset)}, {names} {verb} {right} outcomes right, and peaks wrong by "
        f"{alike(medians)} in the median and {alike(largest)} at most."
    )


def _range(preset: str, lines: pd.DataFrame) -> str:
    """Say between what the engines lie with a preset, and which is the worst."""
    by_count, cases = lines.sort_values("agree").iloc[[0, -1]], float(lines["cases"].iloc[0])
    few, most = by_count["agree"]
    fewest, worst = (
        engine_of(str(found["source"].iloc[0]))
        for found in (by_count, lines.sort_values("max_error", ascending=False))
    )
    right = out_of(few, cases) if few == most else f"{few} ({fewest}) to {out_of(most, cases)}"
    medians = dict.fromkeys([part(lines["median_error"].min()), part(lines["median_error"].max())])
    return (
        f"{in_words(preset)}, {len(lines)} engines get {right} outcomes right, and peaks wrong by "
        f"{' to '.join(medians)} in the median and at most by {part(lines['max_error'].max())} "
        f"({worst})."
    )


def model_claim(line: "pd.Series[Any]") -> str:
    """Say how many outcomes a linearization gets right, on which side it errs, and how far."""
    wrong = [
        f"{line[column]:.0f} {words}"
        for column, words in (
            ("false_overturnings", "falsely overturned"),
            ("missed_overturnings", "overturnings missed"),
        )
        if line[column]
    ]
    return (
        f"{line['source']} {out_of(line['agree'], line['cases'])}"
        + (f" ({listed(wrong)})" if wrong else "")
        + f", {part(line['median_error'])} in the median and {part(line['max_error'])} at most"
    )


def first_claim(lines: pd.DataFrame) -> str:
    """Say in a sentence what each preset, and each linearization, is off by."""
    parts = [_short(*item) for item in engines_by_preset(lines).items()]
    models = [
        f"{row['source']} {row['cases'] - row['agree']}" for _, row in linearized(lines).iterrows()
    ]
    parts += [f"outcomes wrong by linearization: {listed(models)}"] if models else []
    return capital("; ".join(parts)) + "."


def _short(preset: str, lines: pd.DataFrame) -> str:
    if len(lines) > NAMED:
        lost = out_of((lines["cases"] - lines["agree"]).sum(), lines["cases"].sum())
        largest = part(lines["max_error"].max())
    else:
        lost = each_out_of(list(lines["cases"] - lines["agree"]), list(lines["cases"]))
        largest = alike([part(error) for error in lines["max_error"]])
    return f"{in_words(preset)} {lost} outcomes are wrong, and peaks by up to {largest}"


def linearized(lines: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the linearizations."""
    kinds = lines["source"].map(lambda source: resolve(source).kind)
    return lines[(kinds == "model") & (lines["source"] != "exact")]


def claims(lines: pd.DataFrame) -> str:
    """Return a sentence for each preset of the engines, and one for the linearizations."""
    sentences = [preset_claim(*item) for item in engines_by_preset(lines).items()]
    models = linearized(lines)
    if len(models):
        words = "; ".join(model_claim(row) for _, row in models.iterrows())
        sentences.append(f"Of the linearizations: {words}.")
    return " ".join(sentences)


def preset_table(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each preset and engine: outcomes, errors of the peak, time of a case."""
    groups = engines_by_preset(lines)
    if not groups:
        return pd.DataFrame()
    found = pd.concat(groups.values(), ignore_index=True)
    return pd.DataFrame(
        {
            "preset": found["preset"],
            "engine": found["source"].map(engine_of),
            "source": found["source"],
            "right": found["agree"],
            "cases": found["cases"],
            "median": found["median_error"],
            "p90": found["p90_error"],
            "max": found["max_error"],
            "ms": 1e3 * found["wall_s"] / found["cases"],
        }
    )


def verdict(table: pd.DataFrame) -> str:
    """Say in a sentence each what the first and the best of the presets are off by, at worst.

    Parameters
    ----------
    table : DataFrame
        From `preset_table`, of one folder or several.
    """
    names = in_order(table["preset"])
    parts = [_of_preset(name, table[table["preset"] == name]) for name in (names[0], names[-1])]
    return " ".join(dict.fromkeys(parts))


def _of_preset(name: str, lines: pd.DataFrame) -> str:
    lost = out_of((lines["cases"] - lines["right"]).sum(), lines["cases"].sum())
    return capital(
        f"{in_words(name)}, {len(lines)} engines are wrong about whether the block falls in {lost} "
        f"cases, and about how far it rocks by up to {part(lines['max'].max())}."
    )
