"""The report of `culprit study suave`: tables, search and distance beside the paper's, and one run of each manager from above."""
import re

import report  # first: it says which library is absent
from report import LIGHT

import numpy
from matplotlib import pyplot

SPEED = 15  # the vehicle on the page moves this much faster than the real one
AIR = 3  # metres around everything
VEHICLE = "vehicle"  # the id of the marker that moves


def comparison_figure(rows):
    """Search time and inspected distance of each manager, mean ± sd, with the paper's."""
    figure, axes = pyplot.subplots(1, 2, figsize=(9.4, 0.36 * len(rows) + 1.1), sharey=True, layout="constrained")
    for axis, (key, title) in zip(axes, (("search_time_s", "search [s]"), ("distance_m", "inspected [m]"))):
        for y, row in enumerate(rows):
            draw_mean(axis, row[key], y - 0.13, "o", LIGHT["ours"])
            if row["published"]:
                draw_mean(axis, row["published"][key], y + 0.17, "D", LIGHT["theirs"])
        axis.set_xlim(left=0)
        axis.set_xlabel(title)
        axis.grid(axis="x")
    axes[0].set_yticks(range(len(rows)), [row["manager"] for row in rows])
    axes[0].set_ylim(len(rows) - 0.5, -0.5)
    handles = [pyplot.Line2D([], [], marker=marker, color=colour, markersize=4, label=text) for marker, colour, text in
               (("o", LIGHT["ours"], "measured, mean ± sd"), ("D", LIGHT["theirs"], "published, mean ± sd"))]
    axes[1].legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 1.0), ncols=2)
    return figure


def draw_mean(axis, value, y, marker, colour):
    if value["mean"] is not None:
        axis.errorbar(value["mean"], y, xerr=value["sd"], fmt=marker, color=colour, markersize=4.5, linewidth=1.5)


def frame_of(data):
    """The area that all drawings show, so that they can be compared."""
    places = numpy.array(data["pipeline"] + [place for track in data["tracks"] for place in track["points"]])
    return places.min(axis=0) - AIR, places.max(axis=0) + AIR


def track_figure(track, pipeline, frame):
    """The pipeline, the vehicle's way, and numbers where something happened."""
    (left, bottom), (right, top) = frame
    figure, axis = pyplot.subplots(figsize=(8, 8 * (top - bottom) / (right - left) + 0.3))
    figure.subplots_adjust(left=0.05, right=0.99, bottom=0.1, top=0.97)
    axis.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axis.grid()
    axis.plot(*zip(*pipeline), color=LIGHT["faint"], alpha=0.45, linewidth=7, solid_capstyle="round")
    way = numpy.array(track["points"])
    axis.plot(way[:, 0], way[:, 1], color=LIGHT["curve0"], linewidth=1.5)
    taken = []
    for i, mark in enumerate(track["marks"]):
        # Marks at one place stand side by side.
        place = numpy.array(mark["at"], dtype=float)
        step = (right - left) * 0.024
        while any(abs(place[0] - x) < step * 0.95 and abs(place[1] - y) < step * 0.95 for x, y in taken):
            place[0] += step
        taken.append(tuple(place))
        axis.plot(*place, "o", markersize=13, color=LIGHT["grid"], markeredgecolor=LIGHT["theirs"])
        axis.text(*place, str(i + 1), ha="center", va="center_baseline", fontsize=8)
    # Points of the drawing, from its upper left.
    drawn = axis.transData.transform(way) * [1, -1] + [0, figure.bbox.height]
    return figure, drawn


def moving_vehicle(drawn):
    """A dot that goes along the way, again and again, at even times."""
    def animated(axis, values):
        return (f'<animate attributeName="c{axis}" values="{";".join(f"{value:.1f}" for value in values)}" '
                f'dur="{len(values) / SPEED:.1f}s" repeatCount="indefinite"/>')

    return f'<circle r="6" class="{VEHICLE}">{animated("x", drawn[:, 0])}{animated("y", drawn[:, 1])}</circle>'


def track_section(data, page):
    frame = frame_of(data)
    body = (f"<p>Seen from above, in metres. The broad line is the pipeline, the thin one the way of the vehicle; the dot is the vehicle, "
            f"{SPEED} times as fast as it moved. Numbers stand where something happened.</p>\n")
    for track in data["tracks"]:
        figure, drawn = track_figure(track, data["pipeline"], frame)
        events = "".join(f"<li>{mark['time']:.1f} s: {report.escaped(mark['text'])}</li>\n" for mark in track["marks"])
        drawing = page.figure(f"track-{track['manager']}", track["manager"], "", figure, f'<ol class="happenings">\n{events}</ol>\n')
        body += re.sub("</svg>", lambda _: moving_vehicle(drawn) + "</svg>", drawing, count=1)
    page.section("tracks", "The first run of each manager", body)


def report_of(data):
    study = data.json("study.json")
    campaign, tracks = study["campaign"], data.json("tracks.json")
    page = report.Report(f"SUAVE, {campaign['mission']} mission", [
        ("Command", campaign["command"]), ("Seed", campaign["seed"]), ("Version", f"culprit {campaign['version']}"),
        ("Runs", f"{campaign['runs']} of each manager")], tracks["mission"])
    page.table_section(data.json("tables.json"))
    page.section("plots", "Plots", page.figure(
        "comparison", "Search time and inspected distance.", "Runs that are left out as in the paper are not in it.",
        comparison_figure(study["rows"])))
    track_section(tracks, page)
    return page


if __name__ == "__main__":
    report.main(report_of)
