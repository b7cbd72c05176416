// What an operator does with the page, for the checks of control with a made-up fleet (mock-monitor.mjs).
import assert from 'node:assert/strict';

import {openReady, pause, positionOf, state} from './in_browser.mjs';

/// With the token of an operator.
export async function openControlled(mock, token, options) {
  const page = await openReady(`${mock.url}#token=${encodeURIComponent(token)}`, options);
  await page.locator('#stop').waitFor();
  return page;
}

/// A place on the map, in pixels of the page and in metres, that no robot is near.
export async function freePlace(page, from = 0) {
  const {scale, origin} = await state(page);
  const box = await page.locator('#map').boundingBox();
  const names = await page.evaluate(() => Array.from({length: window.coppice.robots}, (_, k) => `r${k + 1}`));
  const robots = (await Promise.all(names.map((name) => positionOf(page, name)))).filter((at) => at);
  for (let k = from; k < 400; ++k) {
    const at = {x: box.x + 60 + (k * 97) % (box.width - 180), y: box.y + 60 + (k * 61) % (box.height - 120)};
    const metres = {x: (at.x - origin.x) / scale, y: (origin.y - at.y) / scale};
    const isFree = robots.every((robot) => Math.hypot(robot.x - at.x, robot.y - at.y) > 70);
    if (isFree && metres.x > 0 && metres.x < 400 && metres.y > 0 && metres.y < 300) return {at, metres};
  }
  return assert.fail('no place is free');
}

export const select = async (page, name) => {
  await page.locator('#table tbody tr', {has: page.locator(`td:text-is("${name}")`)}).click();
  await page.keyboard.press('0');  // the whole map
  await pause(300);
};
export const last = (mock) => [...mock.api.orders.values()].at(-1);
export const orders = (mock) => [...mock.api.orders.values()];
export async function within(check, what) {
  for (let k = 0; k < 100; ++k) {
    if (check()) return;
    await pause(50);
  }
  assert.fail(what);
}
export const isNear = (goal, metres) => Math.hypot(goal.x - metres.x, goal.y - metres.y) < 1;
