// A person writes a rule file while the camera of SUNSET runs.
//
//     node robot_session.mjs culprit lsp --robot
import assert from "node:assert/strict";
import { Editor } from "./editor.mjs";

// Asks again and again: the robot's data arrives at any time.
async function until(ask, isWanted) {
  for (;;) {
    const answer = await ask();
    if (isWanted(answer)) return answer;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

const editor = new Editor(process.argv.slice(2));
await editor.open(`COMPONENT camera NODE /managed_subsystem/camrea
SIGNAL blur PARAMETER camera image_degradation
RULE Slow
  POLICIES WARNING
  TRIGGER blur > 1 || rate(/managed_subsystem/rgb_camera) < 1
    STRATEGY tune 80 50
      ADAPTATION camera set_parameter image_degradation 0.5 2
`);
const [missing] = await editor.diagnosed("R060");
await editor.apply(await editor.quickFix(missing));
await editor.diagnosed();
assert.match(editor.document.getText(), /^COMPONENT camera NODE \/managed_subsystem\/camera\n/);

const names = await editor.labels(editor.at("/managed_subsystem/camera", 3));
assert.deepEqual(names, ["/managed_subsystem/camera"]);
const topics = await editor.labels(editor.at("rate(", 5));
assert.ok(topics.includes("/diagnostics"), "a topic that the file does not name");
await until(
  () => editor.labels(editor.at("image_degradation 0.5")),
  (parameters) => parameters.includes("autofocus_needed"),
);
await until(() => editor.hover(editor.at("blur > 1")), (text) => /Now `0\.0`/.test(text));
await until(() => editor.hover(editor.at("/rgb_camera")), (text) => /Hz now/.test(text));

assert.equal(await editor.close(), 0);
console.log("the session passed");
