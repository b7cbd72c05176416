// Checks what an operator does with the page: orders, pauses and stops, with a made-up fleet (mock-api.mjs).
//
// COPPICE_PAGE_SHOTS: a folder for screenshots. An argument selects the checks whose names contain it.
import assert from 'node:assert/strict';

import {close, finish, openReady, pause, run, shoot, small, state, until} from './in_browser.mjs';
import {startMock} from './mock-monitor.mjs';
import {freePlace, isNear, last, openControlled as open, orders, select, within} from './operator.mjs';

const token = 'oak tree';
const tablet = {viewport: {width: 1024, height: 768}, hasTouch: true};
const phone = {viewport: small, hasTouch: true, isMobile: true, deviceScaleFactor: 2};

const openControlled = (mock, options) => open(mock, token, options);

/// One finger presses, is dragged, and is let go.
async function touchAndDrag(page, from, by) {
  const session = await page.context().newCDPSession(page);
  const touch = (type, share) => session.send('Input.dispatchTouchEvent', {
    type, touchPoints: share === undefined ? [] : [{x: from.x + share * by.x, y: from.y + share * by.y, id: 1}],
  });
  await touch('touchStart', 0);
  for (let share = 0.25; share <= 1; share += 0.25) await touch('touchMove', share);
  await touch('touchEnd');
}

const checks = {
  async 'without control the page only shows'() {
    const mock = await startMock({});
    const page = await openReady(mock.url);
    for (const id of ['stop', 'control', 'orders', 'control-open', 'duty', 'orders-tab']) assert(!(await page.locator(`#${id}`).isVisible()), id);
    await page.keyboard.press('s');
    assert.deepEqual(page.asked.filter((url) => url.includes('/api/')), []);
    await close(page);
    await mock.close();
  },

  async 'a form takes the token, and refuses a wrong one'() {
    const mock = await startMock({token});
    const page = await openReady(mock.url);
    assert(!(await page.locator('#stop').isVisible()));
    await page.keyboard.press('s');
    await page.getByRole('button', {name: 'Control'}).click();
    await page.getByLabel('Token of an operator').fill('beech');
    await page.keyboard.press('Enter');
    await page.locator('#token-failure').waitFor();
    assert.match(await page.locator('#token-failure').textContent(), /no such token/);
    await shoot(page, 'control-token');
    assert.deepEqual(mock.api.asked, [], 'nothing was asked without a token');
    await page.getByLabel('Token of an operator').fill(token);
    await page.getByRole('button', {name: 'Take control'}).click();
    await page.locator('#stop').waitFor();
    await page.reload();
    await page.locator('#stop').waitFor();
    await page.locator('#control-open').click();
    await page.getByRole('button', {name: 'Only watch'}).click();
    await page.locator('#stop').waitFor({state: 'hidden'});
    await close(page);
    await mock.close();
  },

  async 'the address gives the token once'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    assert.equal(page.url(), mock.url);
    assert.equal(await page.evaluate(() => sessionStorage.getItem('coppice-token')), token);
    await close(page);
    await mock.close();
  },

  async 'a click sends the selected robot, and a drag gives it a heading'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    await select(page, 'r2');
    await until(page, () => document.querySelector('#hint').textContent.includes('sends r2'));
    const first = await freePlace(page);
    await page.mouse.click(first.at.x, first.at.y);
    await within(() => mock.api.orders.size === 1, 'the order came');
    assert.equal(last(mock).robot, 'r2');
    assert(isNear(last(mock).goals[0], first.metres), JSON.stringify([last(mock).goals, first.metres]));
    assert.equal(last(mock).goals[0].yaw, undefined);
    const {scale, origin} = await state(page);
    const second = await freePlace(page, 7);
    await page.mouse.move(second.at.x, second.at.y);
    await page.mouse.down();
    await page.mouse.move(second.at.x + 20, second.at.y - 30);
    await page.mouse.move(second.at.x + 60, second.at.y - 60);
    await pause(300);
    await shoot(page, 'control-aim');
    await page.mouse.up();
    await page.getByRole('button', {name: 'Replace'}).click();
    await within(() => mock.api.orders.size === 2 && orders(mock)[0].state === 'cancelled', 'it replaces the first order');
    assert(isNear(last(mock).goals[0], second.metres));
    assert(Math.abs(last(mock).goals[0].yaw - Math.PI / 4) < 0.05, `${last(mock).goals[0].yaw}`);
    assert.deepEqual([(await state(page)).scale, (await state(page)).origin], [scale, origin], 'the map did not move');
    const third = await freePlace(page, 14);
    await page.keyboard.down('Shift');
    await page.mouse.click(third.at.x, third.at.y);
    await page.keyboard.up('Shift');
    await within(() => mock.api.orders.size === 3, 'the third order came');
    await pause(300);
    assert.deepEqual(orders(mock).map((order) => order.state), ['cancelled', 'under way', 'accepted']);
    await shoot(page, 'control-queue');
    await close(page);
    await mock.close();
  },

  async 'a tap sends, a second finger does not, and a queue is chosen by a button'() {
    const mock = await startMock({token});
    const page = await openControlled(mock, tablet);
    await select(page, 'r3');
    const first = await freePlace(page);
    await page.touchscreen.tap(first.at.x, first.at.y);
    await within(() => mock.api.orders.size === 1, 'the order came');
    assert(isNear(last(mock).goals[0], first.metres));
    await page.locator('#queue').tap();
    const second = await freePlace(page, 7);
    await touchAndDrag(page, second.at, {x: 0, y: 80});
    await within(() => mock.api.orders.size === 2, 'the second order came');
    assert(Math.abs(last(mock).goals[0].yaw + Math.PI / 2) < 0.05, `${last(mock).goals[0].yaw}`);
    assert.equal(orders(mock)[0].state, 'under way');
    const session = await page.context().newCDPSession(page);
    const touch = (type, points) => session.send('Input.dispatchTouchEvent', {type, touchPoints: points});
    const {x, y} = second.at;
    const {scale} = await state(page);
    await touch('touchStart', [{x, y, id: 1}]);
    await touch('touchStart', [{x, y, id: 1}, {x: x + 40, y, id: 2}]);
    await touch('touchMove', [{x, y, id: 1}, {x: x + 100, y, id: 2}]);
    await touch('touchEnd', []);
    await pause(300);
    assert.equal(mock.api.orders.size, 2, 'two fingers zoom');
    assert((await state(page)).scale > scale);
    await page.locator('#fit').tap();
    await pause(1000);
    await shoot(page, 'control-tablet');
    const sizes = await page.evaluate(() => [...document.querySelectorAll('#control button, #orders button, #orders summary, #control-open')]
      .filter((each) => each.offsetParent).map((each) => [each.id || each.textContent, each.getBoundingClientRect().width, each.getBoundingClientRect().height]));
    assert.deepEqual(sizes.filter(([, width, height]) => width < 44 || height < 44), [], 'fingers hit them');
    await close(page);
    await mock.close();
  },

  async 'the map moves as ever while no robot is selected or Send is off'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    const drag = async () => {
      const before = (await state(page)).origin;
      const {at} = await freePlace(page);
      await page.mouse.move(at.x, at.y);
      await page.mouse.down();
      await page.mouse.move(at.x + 40, at.y + 20, {steps: 3});
      await page.mouse.up();
      await pause(100);
      const after = (await state(page)).origin;
      return Math.hypot(after.x - before.x, after.y - before.y);
    };
    assert(await drag() > 20);
    await select(page, 'r2');
    await page.keyboard.press('g');
    assert.equal(await page.locator('#send').getAttribute('aria-pressed'), 'false');
    assert(await drag() > 20);
    await page.keyboard.press('g');
    await page.mouse.move(600, 400);
    await page.mouse.wheel(0, -200);
    await pause(100);
    await page.keyboard.press('0');
    const {at} = await freePlace(page);
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await page.mouse.move(at.x + 50, at.y);
    await page.keyboard.press('Escape');
    await page.mouse.up();
    await pause(300);
    assert.equal((await state(page)).selected, 'r2', 'Escape ended only the aiming');
    await page.keyboard.press('Escape');
    assert.equal((await state(page)).selected, null);
    assert.equal(mock.api.orders.size, 0);
    await close(page);
    await mock.close();
  },

  async 'any robot can be sent, also by coordinates, and orders are cancelled'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    await page.locator('#any').click();
    const place = await freePlace(page);
    await page.mouse.click(place.at.x, place.at.y);
    await within(() => mock.api.orders.size === 1, 'the order came');
    assert.deepEqual([last(mock).robot, last(mock).for], [null, []]);
    await page.locator('.by-numbers summary').click();
    await page.getByLabel('x, m').fill('12.5');
    await page.getByLabel('y, m').fill('20');
    await page.getByLabel('y, m').press('s');
    await page.getByLabel('y, m').press('Enter');
    await within(() => mock.api.orders.size === 2, 'the second order came');
    assert.deepEqual(last(mock).goals, [{x: 12.5, y: 20}]);
    await until(page, () => document.querySelectorAll('#order-list li').length === 2);
    assert.match(await page.locator('#order-list li').first().textContent(), /accepted.*any robot to 12\.50, 20\.00.*waits for a robot/);
    await page.getByRole('button', {name: 'Cancel: any robot to 12.50, 20.00'}).click();
    await within(() => last(mock).state === 'cancelled', 'it was cancelled');
    await until(page, () => /any robot to 12.50.*cancelled by page ....$/.test(document.querySelector('#order-list .ended.cancelled')?.textContent.replace(/Cancel$/, '')));
    mock.api.change('o1', {state: 'failed', robot: 'r4', reason: 'no way leads to the goal'});
    await until(page, () => document.querySelector('#order-list .failed .reason')?.textContent === 'no way leads to the goal');
    assert(!mock.api.asked.includes('POST /api/stop'), 'S in a text field is no stop');
    await close(page);
    await mock.close();
  },

  async 'STOP stops at once, and RELEASE needs two calm presses'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    const label = (text) => until(page, (wanted) => document.querySelector('#stop strong').textContent === wanted, text);
    await select(page, 'r1');
    await pause(1200);
    for (let k = 0; k < 5; ++k) await page.locator('#stop').click();
    await label('RELEASE');
    assert.equal(mock.api.everybody, 'stopped');
    assert(!mock.api.asked.includes('POST /api/release'), 'hasty presses release nothing');
    await pause(1500);
    assert.match(await page.locator('#phases').textContent(), /20halted/);
    await shoot(page, 'control-stopped');
    await page.locator('#stop').click();
    await label('PRESS AGAIN');
    await pause(3300);
    await label('RELEASE');
    await page.locator('#stop').click();
    await pause(500);
    await page.locator('#stop').click();
    await label('STOP');
    assert.equal(mock.api.everybody, 'none');
    for (const [where, key] of [['#table', 's'], ['#theme', 'Pause'], ['#help-open', 'S']]) {
      await page.locator(where).focus();
      if (where === '#help-open') await page.keyboard.press('Enter');  // the help opens
      if (where === '#help-open') await shoot(page, 'control-help');
      await page.keyboard.press(key);
      await within(() => mock.api.everybody === 'stopped', `${key} stops from ${where}`);
      mock.api.halt('release');
      await pause(200);
    }
    await close(page);
    await mock.close();
  },

  async 'one robot pauses and goes on, and says why it stands'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    assert(await page.locator('#pause').isDisabled());
    await select(page, 'r1');
    await page.locator('#pause').click();
    await until(page, () => document.querySelector('#pause').textContent === 'Resume r1');
    assert.equal(mock.api.haltOf('r1'), 'paused');
    mock.api.tell('r1', {why: 'an operator paused it', time_left: 83});
    await until(page, () => document.querySelector('#duty-why').textContent === 'an operator paused it');
    assert.equal(await page.locator('#duty-left').textContent(), '1:23');
    await pause(700);  // else it would be the second click of a double click
    await page.keyboard.press('p');
    await until(page, () => document.querySelector('#pause').textContent === 'Pause r1');
    await close(page);
    await mock.close();
  },

  async 'failures are shown'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    const alarm = (text) => until(page, (wanted) => [...document.querySelectorAll('.toast.failure')].some((each) => each.textContent.includes(wanted)), text);
    await page.locator('#any').click();
    await page.locator('.by-numbers summary').click();
    await page.getByLabel('x, m').fill('-1');
    await page.getByLabel('y, m').fill('2');
    await page.locator('#go').click();
    await alarm('The order for any robot failed: the goal is blocked by an obstacle');
    await select(page, 'r2');
    await page.getByLabel('x, m').fill('5');
    await page.locator('#go').click();
    await within(() => mock.api.orders.size === 1, 'the order came');
    await until(page, () => document.querySelectorAll('#order-list li').length === 1);
    await page.getByLabel('x, m').fill('-5');
    await page.locator('#go').click();
    await page.getByRole('button', {name: 'Replace'}).click();
    await alarm('The order for r2 failed: the goal is blocked by an obstacle');
    assert.equal(last(mock).state, 'under way', 'a refused order does not cancel the earlier one');
    mock.api.broken = 'the service does not answer';
    await page.keyboard.press('Tab');
    await page.locator('#stop').click();
    await alarm('THE ROBOTS WERE NOT STOPPED: the service does not answer');
    await shoot(page, 'control-failure');
    await page.locator('.toast button').first().click();
    mock.api.broken = undefined;
    mock.api.endStreams();
    await until(page, () => document.querySelector('#hint').textContent.includes('not up to date'));
    await until(page, () => !document.querySelector('#hint').textContent.includes('not up to date'));
    mock.api.token = 'another';
    await page.locator('#stop').click();
    await alarm('THE ROBOTS WERE NOT STOPPED: no such token');
    await page.locator('#stop').waitFor({state: 'hidden'});
    await close(page);
    await mock.close();
  },

  async 'a page that nobody sees hears no events, and then all that is known'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    const show = (visibility) => page.evaluate((now) => {
      Object.defineProperty(document, 'visibilityState', {get: () => now, configurable: true});
      document.dispatchEvent(new Event('visibilitychange'));
    }, visibility);
    await within(() => mock.api.listeners === 1, 'it listens');
    await show('hidden');
    await within(() => mock.api.listeners === 0, 'it listens no more');
    mock.api.everybody = 'stopped';
    await show('visible');
    await until(page, () => document.querySelector('#stop strong').textContent === 'RELEASE');
    assert.equal(await page.locator('.toast').count(), 0);
    await close(page);
    await mock.close();
  },

  async 'control works on a phone, and in the dark'() {
    const mock = await startMock({token});
    const page = await openControlled(mock, {...phone, colorScheme: 'dark'});
    assert(await page.evaluate((width) => document.documentElement.scrollWidth <= width, small.width), 'nothing is wider than the screen');
    await page.locator('#any').tap();
    await shoot(page, 'control-phone');
    const place = await freePlace(page);
    await page.touchscreen.tap(place.at.x, place.at.y);
    await within(() => mock.api.orders.size === 1, 'the order came');
    await page.getByRole('button', {name: 'Orders'}).tap();
    await page.locator('#order-list li').waitFor();
    await shoot(page, 'control-phone-orders');
    for (const tab of ['Robots', 'Details', 'Orders', 'Charts']) {
      await page.getByRole('button', {name: tab, exact: true}).tap();
      const box = await page.locator('#stop').boundingBox();
      assert(box.height >= 48 && box.width >= 48 && box.y + box.height <= small.height, `STOP is in sight beside ${tab}`);
    }
    await page.locator('#help-open').tap();
    await shoot(page, 'control-phone-help');
    const {x, y, width, height} = await page.locator('#stop').boundingBox();
    await page.touchscreen.tap(x + width / 2, y + height / 2);
    await within(() => mock.api.everybody === 'stopped', 'it stops, also beside the help');
    assert(!(await page.locator('#help').isVisible()));
    await pause(500);
    await shoot(page, 'control-phone-stopped');
    await close(page);
    const lying = await openControlled(mock, {...phone, viewport: {width: 844, height: 390}});
    const [map, stop] = [await lying.locator('#map').boundingBox(), await lying.locator('#stop').boundingBox()];
    assert(map.height > 150 && stop.height >= 48 && stop.y + stop.height <= 390, `a phone on its side: ${JSON.stringify({map, stop})}`);
    await shoot(lying, 'control-phone-lying');
    await close(lying);
    await mock.close();
  },
};

for (const [name, check] of Object.entries(checks)) if (name.includes(process.argv[2] ?? '')) await run(name, check);
await finish();
