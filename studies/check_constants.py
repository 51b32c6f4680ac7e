#!/usr/bin/env python3
"""Compares constants.csv, the table of all constants of planner and models, with the sources.

    check_constants.py

Each constant of the folders below has a row with its value, where it comes from, what it was fitted or chosen on, and what it is judged
on. Exits with 1 and a line for each that is missing, that has another value, or that is gone. The standard library is enough.
"""
import csv
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).parent
SOURCES = HERE.parent / "src"
FOLDERS = ("core/plan", "core/diagnose", "core/analyze", "core/knowledge", "lab/managers", "lab/exemplars/sunset/model",
           "lab/exemplars/suave/model", "lab/exemplars/rover/model", "lab/rca_study")
NOT_OF_MODELS = ("optimum", "regret", "export", "cases", "learning", "campaign", "report", "repair_process", "calibration", "scenario")
ORIGINS = ("paper", "code", "measured", "fit", "design")

KINDS = r"(?:double|float|Duration|std::chrono::\w+|int|Cycles|simulation::Span|EntropyLevel|Pace)"
CONSTANT = re.compile(rf"constexpr {KINDS}\s+(k\w+)\s*(?:=\s*)?([^;]+);")
FIELD = re.compile(r"^\s+(?:double|p\.)\s*(\w+) = ([^;]+);", re.M)  # of a vehicle or a profile
WEIGHT = re.compile(r"\.(time|attempt|redeployment|disruption) = ([\d.]+)")
WITH_FIELDS = ("vehicle.h", "profile.cpp")


def is_read(path):
    is_test = "test" in path.name
    return path.suffix in (".h", ".cpp") and not is_test and not (path.parent.name == "rca_study" and path.stem.startswith(NOT_OF_MODELS))


def plain(text):
    return " ".join(re.sub(r"//[^\n]*", "", text).split())


def constants_in(path):
    """(name, value) of each constant, in their order; a name may be there several times, as in profiles."""
    text = path.read_text(encoding="utf-8")
    found = [(name, plain(value)) for name, value in CONSTANT.findall(text)]
    if path.name in WITH_FIELDS:
        found += [(name, plain(value)) for name, value in FIELD.findall(text) if not value.startswith('"')]
    if path.name == "objective.cpp":
        found += WEIGHT.findall(text)
    return found


def in_sources():
    return {(str(path.relative_to(SOURCES)), name, value)
            for folder in FOLDERS for path in sorted((SOURCES / folder).rglob("*")) if path.is_file() and is_read(path)
            for name, value in constants_in(path)}


def main():
    with open(HERE / "constants.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    table = {(row["file"], row["constant"], row["value"]) for row in rows}
    sources = in_sources()
    mistakes = [f"src/{file}: {name} = {value} is not in studies/constants.csv" for file, name, value in sorted(sources - table)]
    mistakes += [f"studies/constants.csv: src/{file} has no {name} = {value}" for file, name, value in sorted(table - sources)]
    for row in rows:
        if row["origin"] not in ORIGINS or not row["judged_on"]:
            mistakes.append(f"studies/constants.csv: {row['constant']} needs an origin of {', '.join(ORIGINS)}, and what it is judged on")
        if row["origin"] == "fit" and not row["fitted_on"]:
            mistakes.append(f"studies/constants.csv: {row['constant']} does not say what it was fitted on")
    print("\n".join(mistakes) or f"{len(rows)} constants are as in the sources")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
