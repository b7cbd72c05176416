// Checks what a user sees of a run that ends (COPPICE_PAGE_URL: its monitor, which ends with it), in Debian's
// chromium.
//
// node end_of_run.spec.mjs ROBOTS
import assert from 'node:assert/strict';

import {chromium} from 'playwright-core';

import {arguments_of_chromium, program_of_chromium} from './chromium.mjs';

const robots = Number(process.argv[2]);
const url = process.env.COPPICE_PAGE_URL;
const browser = await chromium.launch({executablePath: program_of_chromium, args: arguments_of_chromium});
const page = await browser.newPage({viewport: {width: 1440, height: 900}});
const badge = page.locator('#connection');
await page.goto(url);

const until = (check, argument) => page.waitForFunction(check, argument, {timeout: 180_000});
const serverIsThere = () => fetch(`${url}healthz`).then(() => true, () => false);

await until((count) => window.coppice.ready && window.coppice.robots === count, robots);
await until(() => document.querySelector('#connection').textContent === 'run ended');
while (await serverIsThere()) await new Promise((resolve) => setTimeout(resolve, 100));
await new Promise((resolve) => setTimeout(resolve, 1500));

assert.equal(await badge.textContent(), 'run ended', 'the outcome stays after the monitor has ended');
assert.equal(await page.locator('#notice-title').textContent(), `run ended: ${robots} of ${robots} arrived`);
assert.equal(await page.locator('#arrived').textContent(), `${robots} / ${robots}`);
assert.equal(await page.locator('body.lost').count(), 0, 'nothing is dimmed');
const phases = await page.locator('#table tbody tr:not(.spacer) td:nth-child(2)').allTextContents();
assert.deepEqual(phases.map((text) => text.trim()), Array(robots).fill('arrived'));
for (let k = 1; k <= robots; ++k)
  assert(await page.evaluate((name) => window.coppice.positionOf(name), `r${k}`), 'robots stay where they arrived');
if (process.env.COPPICE_PAGE_SHOTS) await page.screenshot({path: `${process.env.COPPICE_PAGE_SHOTS}/ended.png`});
await browser.close();
