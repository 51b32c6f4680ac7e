// Draws the graph of a rule file, in the page of a panel (graph_panel.ts). Where things stand, and how edges pass what stands
// in their way, is what the web app does (ui/src). Names come from rule files: they become text, and nothing else.
import { clearBend } from "../../../../ui/src/edge_bends";
import { kLayer, kNode, kRow, layered, type Point } from "../../../../ui/src/layout";
import type { Asked, RuleGraph, Shown } from "../rule_graph";
import "./graph_view.css";

declare function acquireVsCodeApi(): { postMessage(message: Asked): void };
const editor = acquireVsCodeApi();

const kGap = { row: 82, layer: 268, uprightRow: 208, uprightLayer: 124 }; // of middles; lines have no words to make room for
const kMargin = 16;
const kLeastScale = 0.6; // below, names cannot be read: one scrolls instead
const kMostLetters = 24; // in a box
const kCriticalities = { NON_CRITICAL: "non-critical", WARNING: "warning", ERROR: "error" };

interface Box {
  id: string;
  what: "component" | "rule";
  index: number;
  name: string;
  below: string;
  tone: string;
  says: string; // all of it, in words
}
interface Edge {
  from: string;
  to: string;
  kind: "needs" | "reads" | "adapts";
}

// In the order of the file, also where they are sorted by name.
const idOf = (what: Box["what"], index: number) => `${what} ${String(index).padStart(6, "0")}`;

function boxesOf({ components, rules }: RuleGraph): Box[] {
  return [
    ...components.map((c, index): Box => {
      const below = c.declared ? c.node : "not declared";
      const says = `Component ${c.name}${c.node ? `, node ${c.node}` : ""}${c.declared ? "" : ", not declared"}`;
      return { id: idOf("component", index), what: "component", index, name: c.name, below, tone: c.declared ? "declared" : "undeclared", says };
    }),
    ...rules.map((r, index): Box => {
      const words = kCriticalities[r.criticality] ?? "";
      const of = (verb: string, names: string[]) => (names.length > 0 ? `, ${verb} ${names.join(", ")}` : "");
      const says = `Rule ${r.name}, ${words}${of("looks at", r.reads)}${of("adapts", r.adapts)}`;
      return { id: idOf("rule", index), what: "rule", index, name: r.name, below: words, tone: r.criticality in kCriticalities ? r.criticality : "NON_CRITICAL", says };
    }),
  ];
}

// A component that a rule both reads and adapts has one line: that it is adapted.
function edgesOf({ components, dependencies, rules }: RuleGraph): Edge[] {
  const ids = new Map(components.map((c, index) => [c.name, idOf("component", index)]));
  const edges: Edge[] = [];
  const add = (from: string | undefined, to: string | undefined, kind: Edge["kind"]) => {
    if (from !== undefined && to !== undefined) edges.push({ from, to, kind });
  };
  for (const { producer, consumer } of dependencies) add(ids.get(producer), ids.get(consumer), "needs");
  rules.forEach((rule, index) => {
    for (const name of rule.reads) if (!rule.adapts.includes(name)) add(ids.get(name), idOf("rule", index), "reads");
    for (const name of rule.adapts) add(idOf("rule", index), ids.get(name), "adapts");
  });
  return edges;
}

function svg(name: string, attributes: Record<string, string | number>, ...children: Node[]): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.append(...children);
  return element;
}
function html(name: string, className: string, ...children: (Node | string)[]): HTMLElement {
  const element = document.createElement(name);
  element.className = className;
  element.append(...children);
  return element;
}

function words(text: string, attributes: Record<string, string | number>): SVGElement {
  const letters = Array.from(text);
  // The end of a node's name says most.
  const isNode = text.startsWith("/");
  const short = letters.length <= kMostLetters ? text : isNode ? `…${letters.slice(1 - kMostLetters).join("")}` : `${letters.slice(0, kMostLetters - 1).join("")}…`;
  return svg("text", attributes, document.createTextNode(short));
}

function drawnBox(box: Box, { x, y }: Point): SVGElement {
  const { width, height } = kNode;
  const go = () => editor.postMessage({ what: box.what, index: box.index });
  const group = svg(
    "g",
    { class: `box ${box.what} ${box.tone}`, transform: `translate(${x} ${y})`, role: "link", tabindex: 0 },
    svg("title", {}, document.createTextNode(box.says)), // its name for who cannot see it, too
    svg("rect", { x: -width / 2, y: -height / 2, width, height, rx: box.what === "rule" ? 20 : 6 }),
    words(box.name, { class: "name", y: box.below ? -3 : 5 }),
    words(box.below, { class: "below", y: 16 }),
  );
  group.addEventListener("click", go);
  group.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    go();
  });
  return group;
}

// Where the line from the middle of a box to `to` leaves it.
function rim(middle: Point, to: Point): Point {
  const [dx, dy] = [to.x - middle.x, to.y - middle.y];
  const share = Math.min(kNode.width / 2 / Math.abs(dx || 1e-9), kNode.height / 2 / Math.abs(dy || 1e-9));
  return { x: middle.x + dx * share, y: middle.y + dy * share };
}

const drawnEdge = (edge: Edge, d: string) => svg("path", { class: `edge ${edge.kind}`, d, "marker-end": `url(#${edge.kind})` });

// To the next layer, through what is free between the two.
function across(from: Point, to: Point, isUpright: boolean): string {
  const turned = ({ x, y }: Point): Point => (isUpright ? { x: y, y: x } : { x, y });
  const [a, b] = [turned(from), turned(to)];
  const half = (isUpright ? kNode.height : kNode.width) / 2;
  const [begin, end] = [a.x + Math.sign(b.x - a.x) * half, b.x - Math.sign(b.x - a.x) * half];
  const middle = (begin + end) / 2;
  const at = (x: number, y: number) => (isUpright ? `${y} ${x}` : `${x} ${y}`);
  return `M ${at(begin, a.y)} C ${at(middle, a.y)} ${at(middle, b.y)} ${at(end, b.y)}`;
}

// Past what stands between.
function bent(from: Point, to: Point, others: Point[]): string {
  const bend = clearBend(from, to, others);
  const [vx, vy] = [to.x - from.x, to.y - from.y];
  const length = Math.hypot(vx, vy) || 1;
  const control = { x: (from.x + to.x) / 2 - (vy / length) * bend, y: (from.y + to.y) / 2 + (vx / length) * bend };
  const [begin, end] = [rim(from, control), rim(to, control)];
  return `M ${begin.x} ${begin.y} Q ${control.x} ${control.y} ${end.x} ${end.y}`;
}

const arrow = (kind: Edge["kind"]) =>
  svg("marker", { id: kind, class: `arrow ${kind}`, viewBox: "0 0 10 10", refX: 9, refY: 5, markerWidth: 9, markerHeight: 9, markerUnits: "userSpaceOnUse", orient: "auto" }, svg("path", { d: "M 0 1 L 10 5 L 0 9 z" }));

interface Arrangement {
  points: Map<string, Point>;
  width: number;
  height: number;
  left: number;
  top: number;
}
// Along the data to the right, or down.
function arranged(places: Map<string, Point>, isUpright: boolean): Arrangement {
  const points = new Map(
    [...places].map(([id, { x, y }]): [string, Point] => {
      const [layer, row] = [x / kLayer, y / kRow];
      return [id, isUpright ? { x: row * kGap.uprightRow, y: layer * kGap.uprightLayer } : { x: layer * kGap.layer, y: row * kGap.row }];
    }),
  );
  let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const { x, y } of points.values()) {
    [left, top, right, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(right, x), Math.max(bottom, y)];
  }
  const width = right - left + kNode.width + 2 * kMargin;
  const height = bottom - top + kNode.height + 2 * kMargin;
  return { points, width, height, left: left - kNode.width / 2 - kMargin, top: top - kNode.height / 2 - kMargin };
}

function drawn(graph: RuleGraph): SVGElement {
  const boxes = boxesOf(graph);
  const edges = edgesOf(graph);
  const places = layered(
    boxes.map((b) => b.id),
    edges.map(({ from, to }): [string, string] => [from, to]),
    new Map(),
  );
  const scale = ({ width, height }: Arrangement) => Math.min(1, innerWidth / width, innerHeight / height);
  const [along, down] = [arranged(places, false), arranged(places, true)];
  const isUpright = scale(down) > scale(along);
  const { points, width, height, left, top } = isUpright ? down : along;
  const lineOf = (edge: Edge) => {
    const [from, to] = [points.get(edge.from)!, points.get(edge.to)!];
    if (Math.abs(places.get(edge.from)!.x - places.get(edge.to)!.x) === kLayer) return across(from, to, isUpright);
    return bent(from, to, [...points.values()].filter((p) => p !== from && p !== to));
  };
  const size = Math.max(kLeastScale, Math.min(1, innerWidth / width));
  return svg(
    "svg",
    { viewBox: `${left} ${top} ${width} ${height}`, width: width * size, height: height * size, role: "group", "aria-label": "Components, rules and dependencies" },
    svg("defs", {}, arrow("needs"), arrow("reads"), arrow("adapts")),
    ...edges.map((edge) => drawnEdge(edge, lineOf(edge))),
    ...boxes.map((box) => drawnBox(box, points.get(box.id)!)),
  );
}

function legend(graph: RuleGraph): HTMLElement {
  const line = (kind: Edge["kind"], text: string) =>
    html("span", "", svg("svg", { width: 34, height: 12, "aria-hidden": "true" }, svg("path", { class: `edge ${kind}`, d: "M 0 6 L 32 6", "marker-end": `url(#${kind})` })), ` ${text}`);
  const lines = [line("needs", "is needed by"), line("reads", "is looked at by"), line("adapts", "adapts")];
  const note = "The file declares no DEPENDENCY: who hears whom is found on the robot (culprit graph).";
  return html("footer", "legend", ...lines, ...(graph.dependencies.length > 0 ? [] : [html("p", "note", note)]));
}

function show(shown: Shown): void {
  const parts = [html("h1", "", `${shown.file}, as it is saved`)];
  if (shown.trouble) parts.push(html("section", "trouble", html("h2", "", "There is no graph of it"), html("pre", "", shown.trouble)));
  if (shown.trouble && shown.graph) parts.push(html("p", "note", "This is the graph of before:"));
  if (shown.graph) {
    const isEmpty = shown.graph.components.length + shown.graph.rules.length === 0;
    const place = html("div", shown.trouble ? "graph stale" : "graph", ...(isEmpty ? ["The file has no components and no rules."] : [drawn(shown.graph)]));
    parts.push(place, legend(shown.graph));
  }
  const main = document.querySelector("main")!;
  main.querySelector(".trouble")?.removeAttribute("role");
  main.replaceChildren(...parts);
  main.querySelector(".trouble")?.setAttribute("role", "alert");
}

let last: Shown | null = null;
addEventListener("message", (event: MessageEvent<Shown>) => {
  last = event.data;
  show(last);
});
let resizing = 0;
addEventListener("resize", () => {
  clearTimeout(resizing);
  resizing = window.setTimeout(() => last && show(last), 100);
});
editor.postMessage({ what: "ready" });
