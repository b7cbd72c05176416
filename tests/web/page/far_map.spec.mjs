// Checks that positions on the page of a recording (COPPICE_PAGE_URL) agree with the trajectory to 1 mm, for
// a map that begins far from the origin of its frame.
//
// node far_map.spec.mjs TRAJECTORY.csv
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';

import {chromium} from 'playwright-core';

import {arguments_of_chromium, program_of_chromium} from './chromium.mjs';

const driven = readFileSync(process.argv[2], 'utf8').trim().split('\n').slice(1).map((line) => line.split(','))
  .map(([time, , x, y]) => [Number(time), Number(x), Number(y)]);

/// The distance of a position from the line that was driven.
function aside({x, y}) {
  let least = Infinity;
  for (let k = 1; k < driven.length; ++k) {
    const [[, x0, y0], [, x1, y1]] = [driven[k - 1], driven[k]];
    const squared = (x1 - x0) ** 2 + (y1 - y0) ** 2;
    const share = squared > 0 ? Math.max(0, Math.min(1, ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / squared)) : 0;
    least = Math.min(least, Math.hypot(x0 + share * (x1 - x0) - x, y0 + share * (y1 - y0) - y));
  }
  return least;
}

const browser = await chromium.launch({executablePath: program_of_chromium, args: arguments_of_chromium});
const page = await browser.newPage({viewport: {width: 1440, height: 900}});
await page.goto(process.env.COPPICE_PAGE_URL);
await page.waitForFunction(() => window.coppice.ready && window.coppice.placeOf('r1'), undefined, {timeout: 15_000});
const places = [];
for (let k = 0; k < 40; ++k) {
  places.push(await page.evaluate(() => window.coppice.placeOf('r1')));
  await new Promise((resolve) => setTimeout(resolve, 100));
}
const moved = Math.hypot(places.at(-1).x - places[0].x, places.at(-1).y - places[0].y);
assert(moved > 1, `it moves: ${moved} m`);
const worst = Math.max(...places.map(aside));
console.log(`${places.length} places, at most ${(1000 * worst).toFixed(3)} mm beside what was driven`);
assert(worst < 0.001, `${worst} m`);
await page.locator('#table tbody tr:not(.spacer)').first().click();
await page.waitForFunction(() => /^5000\d\d\.\d{3}, 540000\d\.\d{3}$/.test(document.querySelector('#details-body dd').textContent));
await browser.close();
