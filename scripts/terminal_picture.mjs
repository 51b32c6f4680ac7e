// A terminal's screen as an SVG: small, sharp at any size, its words can be copied.
//
//     import { terminalPicture } from "./terminal_picture.mjs";
//     terminalPicture("$ culprit status\n" + bytes, { columns: 100 })

const kColours = { 30: "#484f58", 31: "#ff7b72", 32: "#7ee787", 33: "#e3b341", 34: "#79c0ff", 35: "#d2a8ff", 36: "#76e3ea", 37: "#c9d1d9" };
const kPlain = "#c9d1d9";
const kDim = "#8b949e";
const kCell = { width: 8, height: 18 };
const kMargin = 14;

// The lines of what was printed, each of runs of one look: what escape sequences say of colours is kept, and a screen that is
// drawn anew begins anew.
function linesOf(bytes, columns) {
  let lines = [[]];
  let look = { colour: kPlain, isBold: false };
  let isReturned = false; // to the begin of the line
  const put = (text) => lines.at(-1).push({ ...look, text });
  const sequence = /\x1b\[([?0-9;]*)([A-Za-z])|\r?\n|\r|([^\x1b\r\n]+)|\x1b/g;
  for (const [whole, parameters, letter, text] of bytes.matchAll(sequence)) {
    if (isReturned && text !== undefined) lines[lines.length - 1] = []; // a progress bar is drawn over the one before
    isReturned = whole === "\r" || (isReturned && text === undefined && letter !== undefined);
    if (text !== undefined) put(text);
    else if (whole === "\n" || whole === "\r\n") lines.push([]);
    else if (letter === "H") lines = [[]];
    else if (letter === "m") {
      for (const code of (parameters || "0").split(";").map(Number)) {
        if (code === 0) look = { colour: kPlain, isBold: false };
        else if (code === 1) look = { ...look, isBold: true };
        else if (code === 2) look = { ...look, colour: kDim };
        else if (kColours[code]) look = { ...look, colour: kColours[code] };
      }
    }
  }
  while (lines.length > 1 && lines.at(-1).length === 0) lines.pop();
  return lines.flatMap((line) => wrapped(line, columns));
}

// A line that is too long goes on in the next, as in a terminal.
function wrapped(line, columns) {
  const all = [[]];
  let room = columns;
  for (const run of line) {
    let rest = [...run.text];
    while (rest.length > 0) {
      if (room === 0) {
        all.push([]);
        room = columns;
      }
      const part = rest.slice(0, room);
      rest = rest.slice(room);
      room -= part.length;
      all.at(-1).push({ ...run, text: part.join("") });
    }
  }
  return all;
}

const escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

export function terminalPicture(bytes, { columns = 100 } = {}) {
  const lines = linesOf(bytes, columns);
  const width = columns * kCell.width + 2 * kMargin;
  const height = lines.length * kCell.height + 2 * kMargin;
  const texts = lines.map((line, row) => {
    const runs = line.map(({ colour, isBold, text }) => {
      const looks = (colour === kPlain ? "" : ` fill="${colour}"`) + (isBold ? ' font-weight="bold"' : "");
      return looks ? `<tspan${looks}>${escaped(text)}</tspan>` : escaped(text);
    });
    const length = line.reduce((sum, run) => sum + [...run.text].length, 0);
    const at = kMargin + (row + 0.75) * kCell.height;
    return length === 0 ? "" : `<text x="${kMargin}" y="${at}" textLength="${length * kCell.width}" xml:space="preserve">${runs.join("")}</text>\n`;
  });
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" font-family="ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace" font-size="13.3">
<rect width="100%" height="100%" rx="8" fill="#0d1117"/>
<g fill="${kPlain}">
${texts.join("")}</g>
</svg>
`;
}
