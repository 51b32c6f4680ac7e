// A person writes a rule file: mistakes, a quick fix, completion, hover, rename, formatting.
//
//     node session.mjs culprit lsp
import assert from "node:assert/strict";
import { Editor } from "./editor.mjs";

const editor = new Editor(process.argv.slice(2));
const { capabilities, serverInfo } = await editor.open(`CONTS limit = 0.06
COMPONENT camera NODE /robot/camera  # Bäume 🌳
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy STALE 1s
RULE Blurred
  POLICIES WARNING
  TRIGGER   entropy>limit
    STRATEGY focus 80 50
      ADAPTATION camera set_parameter autofocus true 2
`);
assert.equal(serverInfo.name, "culprit");
assert.ok(capabilities.codeActionProvider);

const [mistake] = await editor.diagnosed("R001");
await editor.apply(await editor.quickFix(mistake));
await editor.diagnosed();

assert.ok((await editor.labels(editor.at("entropy>limit"))).includes("limit"));
assert.match(await editor.hover(editor.at("entropy>limit", 2)), /Unknown when older than 1s/);
assert.equal((await editor.definition(editor.at(">limit", 2))).range.start.line, 0);

await editor.apply(await editor.rename(editor.at("limit"), "threshold"));
await editor.apply(await editor.format());
await editor.diagnosed();
assert.match(editor.document.getText(), /^CONST threshold = 0.06\n/);
assert.match(editor.document.getText(), /\n  TRIGGER entropy > threshold\n/);
assert.match(editor.document.getText(), /# Bäume 🌳\n/);
const rule = (await editor.symbols()).at(-1);
assert.deepEqual([rule.name, rule.children[0].name], ["Blurred", "focus"]);

assert.equal(await editor.close(), 0);
console.log("the session passed");
