"""A report of a study: one HTML page, its figures as SVG files, its tables as LaTeX.

A script of a study (sunset.py, suave.py, rca.py) reads the files that `culprit study` writes, draws with matplotlib, and hands
sections to a Report. The page needs no network and no other file, and follows the reader's preference for light or dark.
Run as a program, this file says whether the libraries are there. Imported, it ends the program with a message if one is
absent: scripts import it before the libraries.
"""
import argparse
import csv
import html
import importlib.util
import io
import json
import re
import sys
from pathlib import Path

import latex

HERE = Path(__file__).resolve().parent

# What a library is called in Debian.
PACKAGES = {"matplotlib": "python3-matplotlib", "scipy": "python3-scipy"}

# Colour: in light and in dark scheme. Figures are drawn in the light ones; inside a page each becomes a variable of the style.
# Those of curves are Okabe and Ito's, which people with any colour vision can distinguish.
COLOURS = {
    "ink": ("#1c2128", "#e6e9ed"),
    "faint": ("#57606a", "#9ba4af"),
    "grid": ("#e2e6ea", "#343b44"),
    "ours": ("#2f6db5", "#6ea8ec"),
    "theirs": ("#b8500f", "#f2955c"),
    "curve0": ("#0072b2", "#5fb4ea"),
    "curve1": ("#c4560f", "#f2965c"),
    "curve2": ("#00805e", "#3cc79f"),
    "curve3": ("#a94f86", "#e29bc6"),
    "curve4": ("#8a6100", "#e0b04c"),
}
LIGHT = {name: light for name, (light, _) in COLOURS.items()}
CURVES = [LIGHT[f"curve{i}"] for i in range(5)]


def missing_packages():
    return [package for library, package in PACKAGES.items() if importlib.util.find_spec(library) is None]


def use_style():
    """Sets matplotlib up: equal figures for equal data, text that stays text."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({
        "svg.fonttype": "none", "svg.hashsalt": "culprit", "savefig.transparent": True, "figure.dpi": 72,
        "font.family": "DejaVu Sans", "font.size": 9, "axes.titlesize": 10, "axes.titlelocation": "left",
        "text.color": LIGHT["ink"], "axes.labelcolor": LIGHT["faint"], "axes.edgecolor": LIGHT["faint"],
        "xtick.color": LIGHT["faint"], "ytick.color": LIGHT["faint"], "grid.color": LIGHT["grid"],
        "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True, "legend.frameon": False,
        "legend.fontsize": 9,
    })


class Data:
    """The folder that `culprit study` wrote."""

    def __init__(self, folder):
        self.folder = Path(folder)

    def has(self, name):
        return (self.folder / name).exists()

    def json(self, name):
        return json.loads((self.folder / name).read_text(encoding="utf-8"))

    def csv(self, name):
        """Its lines as dictionaries; numbers are numbers, empty fields None."""
        with open(self.folder / name, encoding="utf-8", newline="") as file:
            return [{key: value_of(text) for key, text in row.items()} for row in csv.DictReader(file)]


def value_of(text):
    if text in ("", "true", "false"):
        return {"": None, "true": True, "false": False}[text]
    try:
        return float(text)
    except ValueError:
        return text


def escaped(text):
    """For text and attributes; control characters, which no page may hold, become U+FFFD."""
    return html.escape(re.sub(r"[\x00-\x08\x0b-\x1f]", "\ufffd", str(text)))


def safe_id(text):
    return re.sub(r"[^A-Za-z0-9_-]", "-", text)


def script_data(data):
    """JSON for a <script> element, which nothing in it can end."""
    return json.dumps(data).replace("<", "\\u003c")


def p_value(p):
    """As the tables have it: no p is 0."""
    return "< 0.001" if p < 0.001 else f"{p:.3f}"


class Report:
    """Collects sections and figures in the order of the page."""

    def __init__(self, title, facts, introduction=""):
        self.title, self.facts, self.introduction = title, facts, introduction
        self.sections = []  # id, title, HTML
        self.figures = {}  # id: SVG file
        self.tables = []
        self.script = ""

    def section(self, name, title, body):
        self.sections.append((name, title, body))

    def table_section(self, tables):
        self.tables += tables
        self.section("tables", "Tables", "".join(table_html(table) for table in tables))

    def figure(self, name, title, caption, figure, after=""):
        """The HTML of a matplotlib figure, which is written as a file of this name, too."""
        file = io.StringIO()
        figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
        from matplotlib import pyplot

        pyplot.close(figure)
        name = safe_id(name)
        self.figures[name] = re.sub(r"\s*<metadata>.*?</metadata>", "", file.getvalue(), flags=re.S)
        return (f'<figure id="plot-{name}">\n<figcaption><strong>{escaped(title)}</strong> {escaped(caption)}</figcaption>\n'
                f"{inside_page(self.figures[name], name, title, caption)}{after}</figure>\n")

    def page(self):
        facts = "".join(f"<dt>{escaped(name)}</dt><dd>{escaped(value)}</dd>\n" for name, value in self.facts)
        links = "".join(f'<li><a href="#{name}">{escaped(title)}</a></li>' for name, title, _ in self.sections)
        body = "".join(f'<section id="{name}">\n<h2>{escaped(title)}</h2>\n{text}</section>\n' for name, title, text in self.sections)
        introduction = f"<p>{escaped(self.introduction)}</p>\n" if self.introduction else ""
        return (f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
                '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
                '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; style-src \'unsafe-inline\'; '
                "script-src 'unsafe-inline'\">\n"
                f"<title>{escaped(self.title)} – culprit study</title>\n<style>\n{page_style()}</style>\n</head>\n<body>\n"
                f'<a class="skip" href="#main">Skip to the results</a>\n<header>\n<h1>{escaped(self.title)}</h1>\n{introduction}'
                f'<dl class="facts">\n{facts}</dl>\n<nav aria-label="Contents"><ul>{links}</ul></nav>\n</header>\n'
                f'<main id="main">\n{body}</main>\n{self.script}</body>\n</html>\n')

    def write(self, arguments):
        folder = Path(arguments.folder)
        everything = not (arguments.html or arguments.svg)
        if everything or arguments.html:
            write(arguments.html or folder / "report.html", self.page())
        if everything or arguments.svg:
            for name, figure in self.figures.items():
                write(Path(arguments.svg or folder / "figures") / f"{name}.svg", figure)
        if everything:
            for table in self.tables:
                write(folder / "tables" / f"{table['id']}.tex", latex.table(table))


def write(path, text):
    path = Path(path)
    if path.parent.name in ("figures", "tables") or path.suffix == ".svg":
        path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def page_style():
    def variables(scheme):
        return "".join(f"--plot-{name}: {both[scheme]}; " for name, both in COLOURS.items())

    return ((HERE / "report.css").read_text(encoding="utf-8") + f":root {{ {variables(0)}}}\n"
            f"@media (prefers-color-scheme: dark) {{ :root {{ {variables(1)}}} }}\n")


def inside_page(svg, name, title, description):
    """A figure as an element of a page: named, in the page's colours, as wide as there is room."""
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r'<svg [^>]*viewBox="([^"]*)"[^>]*>',
                 f'<svg class="plot" viewBox="\\1" role="img" aria-label="{escaped(title)}"><desc>{escaped(description)}</desc>',
                 svg, count=1)
    svg = re.sub(r'( id="| xlink:href="#|url\(#)', rf"\1{name}-", svg).replace("xlink:href", "href")
    svg = svg.replace("'DejaVu Sans'", "system-ui")
    for colour, light in LIGHT.items():
        svg = svg.replace(light, f"var(--plot-{colour})")
    return svg


# Shade: its class, its sign for those who see no colours, and what it means.
SHADES = {"not_significant": ("grey", "", "not significant"), "better": ("better", "+", "significantly better"),
          "worse": ("worse", "!", "significantly worse")}


def cell_html(cell, column):
    shade = cell.get("shade")
    kind, sign, meaning = SHADES.get(shade, ("", "", ""))
    strength = f' style="--strength:{cell["strength"]:.2f}"' if cell.get("strength") else ""
    text = escaped(cell["text"])
    if cell.get("bold"):
        text = f"<strong>{text}</strong>"
    label = f' title="{meaning}" aria-label="{meaning}"' if sign else ""
    mark = f'<span class="mark"{label}>{sign}</span>' if shade else ""
    return f'<td class="{(column["align"] + " " + kind).strip()}"{strength}>{text}{mark}</td>'


def table_html(table):
    columns = table["columns"]
    groups = ""
    if any(column["group"] for column in columns):
        groups = "<tr>" + "".join(
            f'<th class="group" colspan="{end - begin}" scope="colgroup">{escaped(columns[begin]["group"])}</th>'
            if columns[begin]["group"] else "<td></td>" for begin, end in latex.head_spans(columns)) + "</tr>\n"
    heads = "".join(f'<th scope="col" class="{column["align"]}">{escaped(column["title"])}</th>' for column in columns)
    rows = "".join("<tr>" + "".join(map(cell_html, row, columns)) + "</tr>\n" for row in table["rows"])
    legend = ""
    if any(cell.get("shade") for row in table["rows"] for cell in row):
        legend = '<p class="legend">' + " ".join(f'<span class="swatch {kind}"></span> {meaning}' for kind, _, meaning in
                                                 (SHADES[shade] for shade in ("better", "worse", "not_significant"))) + "</p>\n"
    notes = "".join(f'<p class="note">{escaped(note)}</p>\n' for note in table["notes"])
    name = table["id"]
    return (f'<figure class="table" id="{name}">\n<div class="wide" tabindex="0" role="region" aria-labelledby="{name}-caption">'
            f'<table>\n<caption id="{name}-caption">{escaped(table["caption"])}</caption>\n<thead>\n{groups}<tr>{heads}</tr>\n'
            f"</thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n{legend}{notes}</figure>\n")


def main(report_of):
    """Runs the script of a study: `report_of` makes a Report of a Data."""
    options = argparse.ArgumentParser(description="Makes the report of a study from the files of `culprit study … --report FOLDER`; "
                                                  "without an option, report.html, figures/ and tables/ in that folder.")
    options.add_argument("folder", help="the folder with the files")
    options.add_argument("--html", help="write only the page, there")
    options.add_argument("--svg", help="write only the figures, into this folder")
    arguments = options.parse_args()
    use_style()
    try:
        report_of(Data(arguments.folder)).write(arguments)
    except OSError as error:
        sys.exit(f"{error.filename}: {error.strerror}")


if absent := missing_packages():
    if __name__ == "__main__":
        sys.exit(" ".join(absent))
    sys.exit(f"{Path(sys.argv[0]).name}: {sys.executable} lacks a library that reports need; install: sudo apt install {' '.join(absent)}")
