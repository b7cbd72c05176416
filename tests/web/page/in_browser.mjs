// What the checks of the page have in common: a browser, a page that is ready, and what it shows.
import assert from 'node:assert/strict';
import {mkdirSync} from 'node:fs';
import {join} from 'node:path';

import {chromium} from 'playwright-core';

import {arguments_of_chromium, program_of_chromium} from './chromium.mjs';

const shots = process.env.COPPICE_PAGE_SHOTS;
if (shots) mkdirSync(shots, {recursive: true});

export const large = {width: 1440, height: 900};
export const small = {width: 390, height: 844};
export const browser = await chromium.launch({executablePath: program_of_chromium, args: arguments_of_chromium});

export async function shoot(page, name) {
  if (shots) await page.screenshot({path: join(shots, `${name}.png`)});
}

export const state = (page) => page.evaluate(() => {
  const {ready, robots, frames, fps, time, following, selected, playing, scale, origin} = window.coppice;
  return {ready, robots, frames, fps, time, following, selected, playing, scale, origin};
});
export const positionOf = (page, name) => page.evaluate((robot) => window.coppice.positionOf(robot), name);
/// Milliseconds within which all comes true that must, however busy the machine is.
const longest = 60_000;
export const until = (page, check, argument) => page.waitForFunction(check, argument, {timeout: longest});
/// Asks again and again until an answer is yes.
export async function within(ask, what) {
  const deadline = Date.now() + longest;
  while (!(await ask())) {
    assert(Date.now() < deadline, what);
    await pause(100);
  }
}
export const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/// Chromium itself notes each answer that is no success.
function isOfControl(message) {
  return message.text().startsWith('Failed to load resource') && new URL(message.location().url).pathname.startsWith('/api/');
}

export async function open(url, options = {}) {
  const context = await browser.newContext({viewport: large, ...options});
  const page = await context.newPage();
  page.said = [];
  page.on('console', (message) => { if (!isOfControl(message)) page.said.push(`${message.type()}: ${message.text()}`); });
  page.on('pageerror', (error) => page.said.push(`error: ${error.message}`));
  page.asked = [];
  page.on('request', (request) => page.asked.push(request.url()));
  await page.goto(url);
  return page;
}

export async function openReady(url, options) {
  const page = await open(url, options);
  await until(page, () => window.coppice.ready && window.coppice.time !== null);
  await pause(500);
  return page;
}

export async function close(page) {
  assert.deepEqual(page.said, [], 'the console stays empty');
  await page.context().close();
}

let failed = 0;
export async function run(name, check) {
  try {
    await check();
    console.log(`ok   ${name}`);
  } catch (error) {
    ++failed;
    console.log(`FAIL ${name}\n${error.stack}`);
  }
}

export async function finish() {
  await browser.close();
  process.exit(failed ? 1 : 0);
}
