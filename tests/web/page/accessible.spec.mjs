// Checks that everybody can use the page: axe-core finds nothing in any of its states, and an operator does each task with
// the keyboard alone. With a made-up fleet (mock-api.mjs).
//
// COPPICE_PAGE_SHOTS: a folder for screenshots. An argument selects the checks whose names contain it.
import assert from 'node:assert/strict';

import axe from 'axe-core';

import {close, finish, openReady, pause, run, shoot, small, until} from './in_browser.mjs';
import {startMock} from './mock-monitor.mjs';
import {last, openControlled as open, orders, within} from './operator.mjs';

const token = 'oak tree';
const openControlled = (mock, options) => open(mock, token, options);
const phone = {viewport: small, hasTouch: true, isMobile: true, deviceScaleFactor: 2};

async function findings(page) {
  await page.evaluate(axe.source);  // evaluated by the browser's debugger, so the page's policy does not matter
  const {violations} = await page.evaluate(() => window.axe.run(document, {resultTypes: ['violations']}));
  return violations.map(({id, nodes}) => `${id}: ${nodes.slice(0, 5).map(({target, any, all, none}) => `${target} (${[...any, ...all, ...none][0]?.message})`).join('; ')}`);
}

let found = [];
/// All findings of a check are told at its end.
async function isAccessible(page, what) {
  await pause(300);
  found.push(...(await findings(page)).map((finding) => `${what}: ${finding}`));
}

function fill(mock) {
  const order = (fields) => mock.api.order({robot: 'r1', for: ['r1'], goals: [{x: 10, y: 5}], by: 'anna', ...fields});
  order({state: 'under way'});
  for (let k = 0; k < 120; ++k) order({});
  order({state: 'done', ended_at: Date.now() / 1000});
  order({state: 'cancelled', ended_at: Date.now() / 1000, reason: 'replaced by order 5 by anna'});
  order({state: 'failed', ended_at: Date.now() / 1000, reason: 'no way leads there'});
  mock.robots[6].silence = 75;
  mock.alarm([{kind: 'service_silent', robot: -1, since: 0, text: 'the planner service is not heard'},
    ...Array.from({length: 12}, (_, k) => ({kind: 'robot_silent', robot: k + 6, since: Date.now() / 1000 - 75, text: `r${k + 7} is not heard`}))]);
}

async function select(page, name) {
  await page.keyboard.press('/');
  await page.keyboard.type(name);
  await page.keyboard.press('Enter');
  await until(page, (robot) => window.coppice.selected === robot, name);
  if (await page.locator('#find').isVisible()) await page.keyboard.press('Escape');  // leaves the field
}

/// Presses Tab until an element with this name has the focus.
async function tabTo(page, name) {
  for (let k = 0; k < 120; ++k) {
    await page.keyboard.press('Tab');
    const at = await page.evaluate(() => document.activeElement.ariaLabel || document.activeElement.textContent || document.activeElement.id);
    if (at.trim() === name) return;
  }
  assert.fail(`Tab never comes to ${name}`);
}

const checks = {
  async 'axe finds nothing on a page that only shows'() {
    const mock = await startMock({});
    for (const options of [{}, {colorScheme: 'dark'}, phone]) {
      const page = await openReady(mock.url, options);
      await isAccessible(page, 'at first');
      await page.keyboard.press('k');
      await isAccessible(page, 'with the legend');
      await page.keyboard.press('k');
      await select(page, 'r3');
      await isAccessible(page, 'with the details of a robot');
      await close(page);
    }
    const recorded = await startMock({recorded: true});
    const page = await openReady(recorded.url);
    await isAccessible(page, 'of a recording');
    await close(page);
    await recorded.close();
    await mock.close();
  },

  async 'axe finds nothing on a page that controls'() {
    const mock = await startMock({token});
    fill(mock);
    for (const [name, options] of Object.entries({light: {}, dark: {colorScheme: 'dark'}, phone, darkPhone: {...phone, colorScheme: 'dark'}})) {
      const page = await openControlled(mock, options);
      const check = (what) => isAccessible(page, `${what}, ${name}`);
      await page.locator('#alarms').waitFor();
      await check('with orders and alarms');
      await shoot(page, `accessible-${name}`);
      await select(page, 'r1');
      await check('with a robot');
      if (options.isMobile) {
        await page.getByRole('button', {name: 'Orders', exact: true}).tap();
        await check('orders');
      }
      await page.locator('.by-numbers summary').click();
      await check('with the form');
      await page.locator('#help-open').click();
      await check('with help');
      await page.keyboard.press('Escape');
      await page.locator('#control-open').click();
      await check('with the dialog of control');
      await page.keyboard.press('Escape');
      await page.keyboard.press('m');
      await page.keyboard.press('ArrowUp');
      await page.keyboard.press('Enter');
      await page.locator('#replace-dialog').waitFor();
      await check('with the question');
      await page.keyboard.press('Escape');
      mock.api.broken = 'the service does not answer';
      await page.keyboard.press('s');
      await page.locator('.toast.failure').waitFor();
      await check('with a failure');
      mock.api.broken = undefined;
      await page.keyboard.press('s');
      await page.locator('.toast.success').waitFor();
      await check('with a success');
      mock.api.halt('release');
      await close(page);
    }
    await mock.close();
  },

  async 'axe finds nothing while the token is asked for, and while the monitor hangs'() {
    const mock = await startMock({token});
    const page = await openReady(mock.url);
    await page.locator('#control-open').click();
    await page.locator('#token').fill('beech');
    await page.keyboard.press('Enter');
    await page.locator('#token-failure').waitFor();
    await isAccessible(page, 'a wrong token');
    mock.hang(true);
    await until(page, () => document.body.classList.contains('lost'));
    await isAccessible(page, 'lost');
    await close(page);
    await mock.close();
  },

  async 'an operator does each task with the keyboard alone'() {
    const mock = await startMock({token});
    const page = await openReady(mock.url);
    await tabTo(page, 'Control');
    await page.keyboard.press('Enter');
    await page.keyboard.press('Tab');
    await page.keyboard.type(token);
    await page.keyboard.press('Tab');
    await page.keyboard.type('anna');
    await page.keyboard.press('Enter');
    await page.locator('#stop').waitFor();

    await select(page, 'r3');
    await page.keyboard.press('m');
    const hint = () => page.locator('#hint').textContent();
    const placeOf = (text) => text.match(/^(-?[\d.]+), (-?[\d.]+)/).slice(1).map(Number);
    await until(page, () => /Enter sends r3/.test(document.querySelector('#hint').textContent));
    const begin = placeOf(await hint());
    for (let k = 0; k < 3; ++k) await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Shift+ArrowDown');
    await page.keyboard.press('r');
    await pause(100);
    assert.match(await page.locator('#announced').textContent(), /Enter sends r3/, 'it is said aloud');
    const aimed = placeOf(await hint());
    assert(aimed[0] > begin[0] && aimed[1] < begin[1], `${begin} ${aimed}`);
    await shoot(page, 'accessible-aim');
    await page.keyboard.press('Enter');
    await within(() => orders(mock).length === 1, 'it was sent');
    const [goal] = last(mock).goals;
    assert(Math.hypot(goal.x - aimed[0], goal.y - aimed[1]) < 0.02, JSON.stringify(goal));
    assert.deepEqual([last(mock).robot, last(mock).by, Math.abs(goal.yaw) < 1e-9], ['r3', 'anna', true]);

    await page.keyboard.press('m');
    await page.keyboard.press('ArrowUp');
    await page.keyboard.press('Shift+Enter');
    await within(() => orders(mock).length === 2, 'it was queued');
    await until(page, () => document.querySelectorAll('#order-list li').length === 2);
    await page.keyboard.press('m');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('Enter');
    await page.locator('#replace-dialog').waitFor();
    assert.equal(await page.evaluate(() => document.activeElement.textContent), 'Add to the end', 'the question has the focus');
    await page.keyboard.press('Enter');
    await within(() => orders(mock).length === 3, 'it was added');
    await page.keyboard.press('m');
    await page.keyboard.press('Escape');
    assert.doesNotMatch(await hint(), /Enter sends/);

    await page.keyboard.press('a');
    await page.keyboard.press('m');
    await page.keyboard.press('Enter');
    await within(() => last(mock).robot === null, 'any robot was sent');
    await page.keyboard.press('Escape');

    const {x, y} = last(mock).goals[0];
    await tabTo(page, `Cancel: any robot to ${x.toFixed(2)}, ${y.toFixed(2)}`);
    await page.keyboard.press('Enter');
    await within(() => last(mock).state === 'cancelled', 'it was cancelled');

    await select(page, 'r5');
    await page.keyboard.press('p');
    await within(() => mock.api.haltOf('r5') === 'paused', 'r5 is paused');
    await until(page, () => document.querySelector('#pause').textContent === 'Resume r5');
    await pause(700);
    await page.keyboard.press('p');
    await within(() => mock.api.haltOf('r5') === 'none', 'r5 goes on');
    await page.keyboard.press('s');
    await within(() => mock.api.everybody === 'stopped', 'all stop');
    await pause(1200);
    await page.locator('#stop').focus();
    await page.keyboard.press('Enter');
    await pause(500);
    await page.keyboard.press('Enter');
    await within(() => mock.api.everybody === 'none', 'all are released');
    mock.alarm([{kind: 'robot_silent', robot: 6, since: 1, text: 'r7 is not heard'}]);
    await page.locator('#alarms').waitFor();
    await page.keyboard.press('!');
    await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    await until(page, () => window.coppice.selected === 'r7');
    await close(page);
    await mock.close();
  },
};

for (const [name, check] of Object.entries(checks)) {
  if (!name.includes(process.argv[2] ?? '')) continue;
  await run(name, async () => {
    found = [];
    await check();
    assert.deepEqual(found, []);
  });
}
await finish();
