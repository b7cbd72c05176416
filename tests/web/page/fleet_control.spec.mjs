// Checks that an operator controls a driving fleet with the page of its monitor, in Debian's chromium: COPPICE_PAGE_URL,
// with the token. The fleet has robots r1 to r4 on scenarios/rooms-8.map.
//
// COPPICE_PAGE_SHOTS: a folder for screenshots.
import assert from 'node:assert/strict';

import {close, finish, openReady, pause, positionOf, run, shoot, state, until} from './in_browser.mjs';

const url = process.env.COPPICE_PAGE_URL;
const token = process.env.COPPICE_PAGE_TOKEN;

async function api(path) {
  const reply = await fetch(new URL(`api/${path}`, url), {headers: {Authorization: `Bearer ${token}`}});
  return reply.json();
}
const orders = async () => (await api('orders')).orders.filter((order) => order.action === 'go');
async function within(check, what) {
  for (let k = 0; k < 600; ++k) {
    if (await check()) return;
    await pause(100);
  }
  assert.fail(`${what}: ${JSON.stringify([await orders(), (await api('robots')).robots])}`);
}

async function openControlled(options) {
  const page = await openReady(`${url}#token=${encodeURIComponent(token)}`, options);
  await page.locator('#stop').waitFor();
  await until(page, () => window.coppice.robots === 4);
  return page;
}
const select = async (page, name) => {
  await page.locator('#table tbody tr', {has: page.locator(`td:text-is("${name}")`)}).click();
  await page.keyboard.press('0');  // the whole map
  await pause(500);
};
/// Pixels of the page at this place of the map.
async function pixelsOf(page, place) {
  const {scale, origin} = await state(page);
  return {x: origin.x + scale * place.x, y: origin.y + scale * place.y};
}
/// A halted robot brakes first, and the page shows it later than the API.
async function stands(page, name) {
  const before = await positionOf(page, name);
  await pause(1500);
  const after = await positionOf(page, name);
  return Math.hypot(after.x - before.x, after.y - before.y) < 0.01;
}
const robot = async (name) => (await api('robots')).robots.find((one) => one.name === name);
const far = {x: 428, y: 300};

await within(async () => (await api('robots')).robots.filter((one) => one.phase !== 'waiting').length === 4, 'the fleet drives');

await run('a click sends a robot, which goes there', async () => {
  const page = await openControlled();
  await select(page, 'r1');
  const at = await pixelsOf(page, far);
  await page.mouse.click(at.x, at.y);
  await within(async () => (await orders()).length === 1, 'the order came');
  const [order] = await orders();
  assert.equal(order.robot, 'r1');
  assert(Math.hypot(order.goals[0].x - far.x, order.goals[0].y - far.y) < 2, JSON.stringify(order));
  await pause(1000);
  await shoot(page, 'fleet-click');
  await within(async () => (await orders())[0].state === 'done', 'the robot arrived');
  const there = await robot('r1');
  assert(Math.hypot(there.x - order.goals[0].x, there.y - order.goals[0].y) < 1, JSON.stringify(there));
  await close(page);
});

await run('a tap sends another robot, STOP holds it, RELEASE lets it go on, and its order is cancelled', async () => {
  const page = await openControlled({viewport: {width: 1024, height: 768}, hasTouch: true});
  await select(page, 'r2');
  const at = await pixelsOf(page, {x: 428, y: 360});
  await page.touchscreen.tap(at.x, at.y);
  await within(async () => (await robot('r2')).phase === 'driving', 'the robot drives');
  await page.locator('#stop').tap();
  await within(async () => (await api('robots')).robots.every((one) => one.phase === 'halted'), 'all robots stand');
  await within(() => stands(page, 'r2'), 'it stands');
  await shoot(page, 'fleet-stopped');
  await until(page, () => document.querySelector('#stop strong').textContent === 'RELEASE');
  await page.locator('#stop').tap();
  await pause(300);
  await page.locator('#stop').tap();
  await within(async () => (await robot('r2')).phase === 'driving', 'it drives on');
  await page.getByRole('button', {name: /^Cancel/}).first().tap();
  await within(async () => (await orders()).some((order) => order.state === 'cancelled' && order.robot === 'r2'), 'it was cancelled');
  await shoot(page, 'fleet-cancelled');
  await close(page);
});

await finish();
