// Checks what operators meet in a day: a monitor that hangs, robots that fall silent, queues that a goal would replace,
// other operators, a thousand orders, hasty fingers. With a made-up fleet (mock-api.mjs).
//
// COPPICE_PAGE_SHOTS: a folder for screenshots. An argument selects the checks whose names contain it.
import assert from 'node:assert/strict';

import {close, finish, large, openReady, pause, run, shoot, small, state, until} from './in_browser.mjs';
import {startMock} from './mock-monitor.mjs';
import {freePlace, isNear, last, openControlled as open, orders, select, within} from './operator.mjs';

const token = 'oak tree';
const openControlled = (mock, options) => open(mock, token, options);
const phone = {viewport: small, hasTouch: true, isMobile: true, deviceScaleFactor: 2};
const badge = (page) => page.locator('#connection').textContent();
const toasts = (page) => page.locator('.toast p').allTextContents();
const boxes = (page, selector) => page.evaluate((wanted) => [...document.querySelectorAll(wanted)].filter((one) => one.checkVisibility()).map((one) => {
  const {left, top, right, bottom} = one.getBoundingClientRect();
  return {name: one.id || one.className || one.textContent, left, top, right, bottom};
}), selector);
const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

const checks = {
  async 'a monitor that hangs is noticed within three seconds, and STOP says at once that it did not get through'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    await until(page, () => document.querySelector('#connection').textContent === 'live');
    mock.hang(true);
    const hung = Date.now();
    await until(page, () => document.body.classList.contains('old'));
    assert(Date.now() - hung < 1700, 'marked as old');
    assert.match(await badge(page), /^\d\.\d.s old$/);
    await page.locator('#stop').click();
    const pressed = Date.now();
    await until(page, () => /THE ROBOTS ARE NOT STOPPED: the monitor does not answer/.test(document.querySelector('.toast.failure')?.textContent));
    assert(Date.now() - pressed < 700, 'at once');
    await until(page, () => document.body.classList.contains('lost'));
    assert(Date.now() - hung < 4000, 'lost');
    assert.match(await badge(page), /^lost: nothing heard for/);
    assert.match(await page.locator('#notice').textContent(), /The monitor does not answer/);
    await until(page, () => document.querySelector('#stop small').textContent === 'NO ANSWER');
    await shoot(page, 'operating-hung');
    mock.hang(false);
    await until(page, () => document.querySelector('#connection').textContent === 'live');
    await page.locator('#stop').click();
    await within(() => mock.api.everybody === 'stopped', 'it stops again');
    await until(page, () => document.querySelectorAll('.toast.failure').length === 0);
    await close(page);
    await mock.close();
  },

  async 'STOP says within a second and a half that a monitor that was heard just now does not answer'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    mock.api.hangs = true;  // the map goes on
    await page.keyboard.press('s');
    const pressed = Date.now();
    await until(page, () => /NOT STOPPED/.test(document.querySelector('.toast.failure')?.textContent));
    assert(Date.now() - pressed < 1600);
    assert.equal(await badge(page), 'live');
    for (let k = 1; k <= 8; ++k) mock.api.order({action: 'pause', for: [`r${k}`], by: `operator ${k}`, state: 'done'});
    await until(page, () => [...document.querySelectorAll('.toast.notice')].some((one) => one.textContent.includes('operator 8 paused r8')));
    assert((await toasts(page)).some((text) => text.includes('NOT STOPPED')), 'news does not push it out');
    mock.api.hangs = false;
    mock.api.halt('stop');  // by another way
    await until(page, () => document.querySelectorAll('.toast.failure').length === 0);
    await close(page);
    await mock.close();
  },

  async 'a robot that is not heard is no green one: alarms say so'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    assert(!(await page.locator('#alarms').isVisible()));
    const silent = {kind: 'robot_silent', robot: 6, since: Date.now() / 1000 - 75, text: 'r7 is not heard: its agent has ended, hangs, or cannot be reached'};
    mock.robots[6].silence = 75;
    mock.robots[2].silence = 1.4;
    mock.alarm([{kind: 'service_silent', robot: -1, since: 0, text: 'the planner service is not heard'}, silent]);
    await page.locator('#alarms').waitFor();
    assert.equal(await page.locator('#alarm-count').textContent(), '2 alarms');
    assert.match(await page.locator('#announced').textContent(), /^Alarm: the planner service is not heard; r7 is not heard/);
    await until(page, () => /r7 is not heard.*for 1:1\d/.test(document.querySelector('#alarm-list').textContent));
    await until(page, () => /1silent/.test(document.querySelector('#phases').textContent));
    await page.getByRole('button', {name: /^r7 is not heard/}).click();
    await until(page, () => window.coppice.selected === 'r7');
    assert.equal(await page.locator('#details-phase').textContent(), 'silent');
    await page.keyboard.press('0');
    await pause(500);
    await shoot(page, 'operating-alarms');
    mock.robots[6].silence = undefined;
    mock.alarm([]);
    await page.locator('#alarms').waitFor({state: 'hidden'});
    await close(page);
    await mock.close();
  },

  async 'a goal that would replace a queue asks first, and others see who did it'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    const other = await openControlled(mock);
    for (const x of [10, 20, 30]) mock.api.order({robot: 'r1', for: ['r1'], goals: [{x, y: 5}], by: 'anna', state: x === 10 ? 'under way' : 'accepted'});
    await select(page, 'r1');
    const press = async (from) => {
      const {at} = await freePlace(page, from);
      await page.mouse.click(at.x, at.y);
      await page.locator('#replace-dialog').waitFor();
    };
    await press(0);
    assert.equal(await page.locator('#replace-title').textContent(), 'r1 has 3 orders; replace them?');
    assert.match(await page.locator('#replace-orders').textContent(), /r1 to 10\.00, 5\.00, by anna/);
    await shoot(page, 'operating-replace');
    await page.getByRole('button', {name: 'Nothing'}).click();
    await press(7);
    await page.keyboard.press('Escape');
    await pause(200);
    assert.equal(orders(mock).length, 3);
    await press(14);
    await page.getByRole('button', {name: 'Add to the end'}).click();
    await within(() => orders(mock).length === 4, 'it was added');
    assert(orders(mock).every(({state}) => state !== 'cancelled'));
    await pause(700);
    await press(21);
    await page.getByRole('button', {name: 'Replace'}).click();
    await within(() => orders(mock).filter(({state}) => state === 'cancelled').length === 4, 'they were replaced');
    assert.match(orders(mock)[0].reason, /^replaced by order o\d+ by page ....$/);
    assert.equal(last(mock).state, 'under way');
    assert(!mock.api.asked.some((request) => request.startsWith('DELETE')), 'the fleet replaces them, all at once');
    assert.match(last(mock).by, /^page ....$/);
    await until(other, () => /^page .... replaced 4 orders of r1$/.test(document.querySelector('.toast.notice p')?.textContent));
    assert.deepEqual((await toasts(page)).filter((text) => text.includes('replaced')), [], 'the operator needs no news of his own');
    await other.bringToFront();
    await shoot(other, 'operating-notice');
    await close(other);
    await close(page);
    await mock.close();
  },

  async 'others see who stops and pauses'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    mock.api.order({action: 'stop', by: 'ben', state: 'done'});
    await until(page, () => document.querySelector('.toast.notice')?.textContent.includes('ben stopped all robots'));
    await close(page);
    await mock.close();
  },

  async 'a double click sends one order'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    await select(page, 'r2');
    const {at} = await freePlace(page);
    await page.mouse.dblclick(at.x, at.y);
    await pause(800);
    assert.equal(orders(mock).length, 1, 'on the map');
    await page.locator('#any').click();
    await page.locator('.by-numbers summary').click();
    await page.getByLabel('x, m').fill('12.5');
    await page.getByLabel('y, m').fill('20');
    await page.locator('#go').dblclick();
    await pause(800);
    assert.equal(orders(mock).length, 2, 'by the form');
    await page.locator('#go').click();
    await within(() => orders(mock).length === 3, 'a calm press sends the same again');
    await select(page, 'r3');
    await page.locator('#pause').dblclick();
    await pause(800);
    assert.equal(mock.api.haltOf('r3'), 'paused', 'and pauses once');
    await close(page);
    await mock.close();
  },

  async 'a thousand orders are counted and can all be seen'() {
    const mock = await startMock({token});
    for (let k = 0; k < 1000; ++k) mock.api.order({robot: `r${1 + (k % 5)}`, for: [], goals: [{x: k, y: 5}], by: 'a program'});
    const page = await openControlled(mock);
    await until(page, () => document.querySelector('#order-count').textContent === '1000 open');
    assert.equal(await page.locator('#order-list li').count(), 100);
    for (let k = 0; k < 9; ++k) await page.locator('#more-orders').click();
    assert.equal(await page.locator('#order-list li').count(), 1000);
    assert(!(await page.locator('#more-orders').isVisible()));
    await close(page);
    await mock.close();
  },

  async 'names are on the map, and messages beside it'() {
    const mock = await startMock({token});
    const page = await openControlled(mock);
    const named = await page.evaluate(() => window.coppice.named);
    assert(named.length >= 15, `of 20 robots at full view: ${named}`);
    mock.api.broken = 'the service does not answer';
    await select(page, 'r1');
    const {at} = await freePlace(page);
    await page.mouse.click(at.x, at.y);
    await until(page, () => document.querySelector('.toast.failure')?.textContent.includes('The order for r1 failed'));
    await shoot(page, 'operating-names');
    const [map] = await boxes(page, '#stage');
    for (const toast of await boxes(page, '.toast')) assert(!overlap(map, toast), JSON.stringify(toast));
    mock.api.broken = undefined;
    await pause(700);
    await page.mouse.click(at.x, at.y);
    await within(() => orders(mock).length === 1, 'the order came');
    await until(page, () => ![...document.querySelectorAll('.toast')].some((one) => one.textContent.includes('failed')));
    await close(page);
    await mock.close();
  },

  async 'nothing that opens lies over STOP'() {
    const mock = await startMock({token});
    mock.api.order({robot: 'r1', for: ['r1'], goals: [{x: 1, y: 5}], by: 'anna'});
    for (const viewport of [large, {width: 1024, height: 768}, {width: 844, height: 390}, small, {width: 1440, height: 600}]) {
      const page = await openControlled(mock, {viewport});
      const atStop = async (what) => {
        const hit = await page.evaluate(() => {
          const {left, right, top, bottom} = document.querySelector('#stop').getBoundingClientRect();
          return [[left + 4, top + 4], [right - 4, top + 4], [left + 4, bottom - 4], [right - 4, bottom - 4], [(left + right) / 2, (top + bottom) / 2]]
            .map(([x, y]) => document.elementFromPoint(x, y)?.closest('#stop') !== null);
        });
        assert(hit.every((one) => one), `${what} at ${JSON.stringify(viewport)}`);
      };
      await page.locator('#help-open').click();
      await atStop('help');
      await shoot(page, `operating-help-${viewport.width}`);
      await page.keyboard.press('Escape');
      assert(!(await page.locator('#help').isVisible()));
      await page.locator('#control-open').click();
      await atStop('token');
      await page.keyboard.press('Escape');
      await page.locator('#legend summary').click();
      await atStop('legend');
      await page.locator('#legend summary').click();
      await select(page, 'r1');
      const {at} = await freePlace(page);
      await page.mouse.click(at.x, at.y);
      await page.locator('#replace-dialog').waitFor();
      await atStop('question');
      await page.locator('#stop').click();
      await within(() => mock.api.everybody === 'stopped', 'it stops');
      assert(!(await page.locator('#replace-dialog').isVisible()));
      mock.api.halt('release');
      await close(page);
    }
    assert.equal(orders(mock).length, 1);
    await mock.close();
  },

  async 'on a phone robots can be seen and fingers hit what they press'() {
    const mock = await startMock({token});
    mock.api.order({robot: 'r1', for: ['r1'], goals: [{x: 1, y: 5}], by: 'anna'});
    mock.alarm([{kind: 'robot_silent', robot: 6, since: 1, text: 'r7 is not heard'}]);
    const page = await openControlled(mock, phone);
    const sizes = await page.evaluate(() => Array.from({length: 20}, (_, k) => window.coppice.sizeOf(`r${k + 1}`)));
    assert(sizes.every((size) => size >= 16), `${sizes}`);
    for (const tab of ['Robots', 'Details', 'Orders', 'Charts']) {
      await page.getByRole('button', {name: tab, exact: true}).tap();
      await shoot(page, `operating-phone-${tab.toLowerCase()}`);
      const all = await boxes(page, 'button, summary, select, input:not([type="checkbox"]), .chips label, tbody tr:not(.spacer)');
      const small = all.filter(({left, right, top, bottom}) => right - left < 43.9 || bottom - top < 43.9);
      assert.deepEqual(small, [], tab);
    }
    await close(page);
    await mock.close();
  },
};

for (const [name, check] of Object.entries(checks)) if (name.includes(process.argv[2] ?? '')) await run(name, check);
await finish();
