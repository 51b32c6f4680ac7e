// A moving picture of a page, as an animated WebP: pictures that the browser took, one behind the other.
//
//     import { watch } from "./moving_picture.mjs";
//     const film = await watch(page);
//     film.say("$ kill -9 1234");                         // below the page, from now on
//     ...
//     writeFileSync("film.webp", await film.end([/camera is down/, /All is well/]));
//
// The file format: https://developers.google.com/speed/webp/docs/riff_container

const kPeriod = 20; // ms, of looking: a repair may take less than a second
const kLeast = 1600; // ms that a picture is shown, so that people can read it
const kMost = 2500;
const kLast = 4000;
const kQuality = 55;

function chunk(name, payload) {
  const head = Buffer.alloc(8);
  head.write(name, 0, "latin1");
  head.writeUInt32LE(payload.length, 4);
  return Buffer.concat([head, payload, Buffer.alloc(payload.length % 2)]);
}

function uint24(value) {
  const bytes = Buffer.alloc(3);
  bytes.writeUIntLE(value, 0, 3);
  return bytes;
}

// The chunks of a still picture, without its RIFF header and without what says how it is composed.
function imageOf(still) {
  const kept = [];
  for (let at = 12; at + 8 <= still.length; ) {
    const length = still.readUInt32LE(at + 4);
    const end = at + 8 + length + (length % 2);
    if (["ALPH", "VP8 ", "VP8L"].includes(still.toString("latin1", at, at + 4))) kept.push(still.subarray(at, end));
    at = end;
  }
  if (kept.length === 0) throw new Error("the browser gave a picture that is no WebP");
  return Buffer.concat(kept);
}

// `frames`: { still: Buffer, lasts: ms }, all of one size.
function animated(frames, { width, height }) {
  const kIsAnimated = 0x02;
  const canvas = Buffer.concat([Buffer.from([kIsAnimated, 0, 0, 0]), uint24(width - 1), uint24(height - 1)]);
  const forEver = Buffer.from([255, 255, 255, 255, 0, 0]); // background, count of rounds
  const parts = frames.map(({ still, lasts }) => {
    const kReplace = 0x02; // what was there before
    const place = Buffer.concat([uint24(0), uint24(0), uint24(width - 1), uint24(height - 1), uint24(Math.round(lasts)), Buffer.from([kReplace])]);
    return chunk("ANMF", Buffer.concat([place, imageOf(still)]));
  });
  const body = Buffer.concat([Buffer.from("WEBP", "latin1"), chunk("VP8X", canvas), chunk("ANIM", forEver), ...parts]);
  return chunk("RIFF", body);
}

// A line below the page that says what is done to the robot.
async function addCaption(page) {
  await page.evaluate(() => {
    const line = Object.assign(document.createElement("div"), { id: "caption" });
    line.style.cssText = "position:fixed;left:0;right:0;bottom:0;z-index:99;padding:0.5rem 1rem;background:#0d1117;color:#7ee787;font:15px ui-monospace,monospace;min-height:2.3rem";
    document.body.append(line);
    document.getElementById("app").style.height = "calc(100vh - 2.3rem)";
  });
}

// Looks at the page again and again. A picture stays for as long as nothing else was to be seen, within bounds.
export async function watch(page) {
  await addCaption(page);
  const camera = await page.context().newCDPSession(page);
  const { width, height } = page.viewportSize();
  const seen = []; // { still, at }
  let isOver = false;
  // Running clocks and charts are no news: a new picture is one with other words.
  const words = () =>
    page.evaluate(() => [".level", ".cause b", ".cause .detail", ".explanation", ".components", "#caption"].map((part) => document.querySelector(part)?.textContent.replace(/[\d.:]+/g, "") ?? "").join("|"));
  const look = async () => {
    let before = "";
    while (!isOver) {
      const now = await words();
      if (now !== before) {
        await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
        const { data } = await camera.send("Page.captureScreenshot", { format: "webp", quality: kQuality });
        seen.push({ still: Buffer.from(data, "base64"), at: Date.now(), words: now });
        before = now;
      }
      await page.waitForTimeout(kPeriod);
    }
  };
  const looking = look();
  return {
    say: (text) => page.evaluate((t) => (document.getElementById("caption").textContent = t), text),
    // All these words must be on pictures of it, in this order.
    async end(wanted) {
      await page.waitForTimeout(500);
      isOver = true;
      await looking;
      let from = 0;
      for (const each of wanted) {
        from = seen.findIndex(({ words }, i) => i >= from && each.test(words));
        if (from < 0) throw new Error(`no picture shows ${each}`);
      }
      const lasts = (i) => (i + 1 === seen.length ? kLast : Math.min(kMost, Math.max(kLeast, seen[i + 1].at - seen[i].at)));
      return animated(seen.map(({ still }, i) => ({ still, lasts: lasts(i) })), { width, height });
    },
  };
}
