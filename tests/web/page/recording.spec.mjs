// Checks what a user does with a recording that a monitor plays (COPPICE_PAGE_URL), in Debian's chromium.

import assert from 'node:assert/strict';

import {browser} from './in_browser.mjs';

const page = await browser.newPage({viewport: {width: 1440, height: 900}});
const said = [];
page.on('console', (message) => said.push(message.text()));
page.on('pageerror', (error) => said.push(error.message));
await page.goto(process.env.COPPICE_PAGE_URL);

const until = (check, argument) => page.waitForFunction(check, argument, {timeout: 15_000});
const time = () => page.evaluate(() => window.coppice.time);

await until(() => window.coppice.ready && window.coppice.robots === 8 && window.coppice.time > 1);
await page.locator('#scrubber').waitFor({timeout: 15_000});

await page.keyboard.press(' ');
await until(() => !window.coppice.playing);
await new Promise((resolve) => setTimeout(resolve, 500));
const held = await time();
await new Promise((resolve) => setTimeout(resolve, 700));
assert.equal(await time(), held, 'a pause stops the time');

await page.locator('#scrubber').fill('12');
const late = await (await until(() => Math.abs(window.coppice.time - 12) < 2 && window.coppice.positionOf('r1'))).jsonValue();
await page.locator('#scrubber').fill('3');
await until(() => Math.abs(window.coppice.time - 3) < 2);
await until(({x, y}) => {
  const at = window.coppice.positionOf('r1');
  return at && Math.hypot(at.x - x, at.y - y) > 5;
}, late);

await page.locator('#speed').selectOption('4');
await page.locator('#play').click();
const began = Date.now();
await until(() => window.coppice.playing && window.coppice.time > 11);
assert((Date.now() - began) < 8000, 'eight seconds at four times the speed');

await until(() => !window.coppice.playing);  // it ends by itself
await page.locator('#play').click();
await until(() => window.coppice.playing && window.coppice.time < 5);  // and begins again

assert.deepEqual(said, [], 'the console stays empty');
await browser.close();
