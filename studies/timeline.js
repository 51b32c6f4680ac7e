// Draws the timeline of the chosen run. All text goes in as text, never as markup.
"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const runs = JSON.parse(document.getElementById("timelines").textContent);
  const chooser = document.getElementById("run");
  const drawing = document.getElementById("timeline-drawing");
  const rows = document.querySelector("#timeline-table tbody");

  const svg = (name, attributes, text) => {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };

  // A sign for each kind, around 0, 0; told apart by shape as well as by colour.
  const SIGNS = {
    "fault": "M0,-6 L6,5 L-6,5 Z",
    "failure": "M0,-5 A5,5 0 1 1 -0.01,-5 Z",
    "blame": "M0,-7 L7,0 L0,7 L-7,0 Z",
    "adaptation": "M-5,-5 L5,-5 L5,5 L-5,5 Z",
    "resolved": "M-5,0 L-1,5 L6,-5",
    "gave up": "M-5,-5 L5,5 M-5,5 L5,-5",
    "note": "M0,-3 A3,3 0 1 1 -0.01,-3 Z",
  };
  const sign = (kind) =>
    svg("path", { d: SIGNS[kind] ?? SIGNS.note, class: "k-" + kind.replaceAll(" ", "-") });

  const legend = document.getElementById("kinds");
  for (const kind of Object.keys(SIGNS)) {
    const item = document.createElement("li");
    const icon = svg("svg", { viewBox: "-8 -8 16 16", "aria-hidden": "true" });
    icon.append(sign(kind));
    item.append(icon, " " + kind);
    legend.append(item);
  }

  const LEFT = 150, WIDTH = 1000, RIGHT = 20, LANE = 34, TOP = 12;

  const roundStep = (least) => {
    const power = 10 ** Math.floor(Math.log10(least));
    return [1, 2, 5, 10].map((f) => f * power).find((s) => s >= least * 0.999);
  };

  // From the first sign of trouble of a component to the last "resolved" of it.
  const illness = (entries) => {
    const spells = [];
    let open = [];
    for (const entry of entries) {
      if (entry.kind === "failure") open.push(entry.time);
      if (entry.kind === "resolved" && open.length > 0) spells.push([open.shift(), entry.time]);
    }
    return { spells, open };
  };

  const draw = (run) => {
    const lanes = [...new Set(run.entries.map((entry) => entry.component))];
    const times = run.entries.map((entry) => entry.time);
    const begin = Math.min(...times), end = Math.max(...times, begin + 0.001);
    const pad = (end - begin) * 0.04;
    const x = (time) => LEFT + ((time - begin + pad) / (end - begin + 2 * pad)) * (WIDTH - LEFT - RIGHT);
    const y = (component) => TOP + LANE * (lanes.indexOf(component) + 0.5);
    const bottom = TOP + LANE * lanes.length;
    const picture = svg("svg", { viewBox: `0 0 ${WIDTH} ${bottom + 34}`, role: "img" });
    picture.append(svg("title", {}, "Timeline of " + run.label));
    picture.append(svg("desc", {}, "A lane for each component; the table below says the same in words."));
    for (const component of lanes) {
      picture.append(svg("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y(component), y2: y(component), class: "lane" }));
      picture.append(svg("text", { x: LEFT - 10, y: y(component) + 4, "text-anchor": "end" }, component || "robot"));
      const { spells, open } = illness(run.entries.filter((entry) => entry.component === component));
      for (const [from, to] of [...spells, ...open.map((time) => [time, end + pad])])
        picture.append(svg("line", { x1: x(from), x2: x(to), y1: y(component), y2: y(component), class: "ill" }));
    }
    const step = roundStep((end - begin) / 8);
    for (let tick = Math.ceil(begin / step) * step; tick <= end; tick += step) {
      picture.append(svg("line", { x1: x(tick), x2: x(tick), y1: TOP, y2: bottom + 4, class: "lane" }));
      picture.append(svg("text", { x: x(tick), y: bottom + 18, "text-anchor": "middle", class: "faint" },
        String(Number(tick.toFixed(6)))));
    }
    picture.append(svg("text", { x: WIDTH - RIGHT, y: bottom + 31, "text-anchor": "end", class: "faint" }, "seconds of the robot"));
    // Signs at one place would hide each other: later ones move to the right.
    const taken = new Map();
    for (const entry of run.entries) {
      const place = Math.max(x(entry.time), (taken.get(entry.component) ?? -Infinity) + 13);
      taken.set(entry.component, place);
      const group = svg("g", { transform: `translate(${place},${y(entry.component)})` });
      group.append(svg("title", {}, `${entry.time.toFixed(3)} s: ${entry.text}`), sign(entry.kind));
      picture.append(group);
    }
    drawing.replaceChildren(picture);
  };

  const tell = (run) => {
    rows.replaceChildren(...run.entries.map((entry) => {
      const row = document.createElement("tr");
      for (const text of [entry.time.toFixed(3), entry.kind, entry.component, entry.text]) {
        const cell = document.createElement("td");
        cell.textContent = text;
        row.append(cell);
      }
      row.firstChild.className = "right";
      return row;
    }));
  };

  const show = () => {
    const run = runs[chooser.selectedIndex];
    if (run.entries.length > 0) draw(run);
    else drawing.textContent = "Nothing happened.";
    tell(run);
  };
  for (const run of runs) chooser.append(new Option(run.label));
  chooser.addEventListener("change", show);
  show();
})();
