// Checks what a user does with the page, in Debian's chromium without a graphics card.
//
// COPPICE_PAGE_URL: a running monitor with moving robots. Without it, mock-monitor.mjs serves the page, and
// what only a mock can play (a recording, a server that ends, 200 robots) is checked as well. With
// --at-first-sight, only the quick checks that need a mock run. COPPICE_PAGE_SHOTS: a folder for screenshots.
// COPPICE_PAGE_FPS: the least frame rate with 200 robots, 30 by default.

import assert from 'node:assert/strict';

import {close, finish, large, open, openReady, pause, positionOf, run, shoot, small, state, until, within} from './in_browser.mjs';

const given = process.env.COPPICE_PAGE_URL;
const leastFps = Number(process.env.COPPICE_PAGE_FPS ?? 30);
const viewports = [large, {width: 1024, height: 768}, small];

const mocked = given ? undefined : await import('./mock-monitor.mjs');

const apart = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);

/// The number of pixels of the map that differ from those kept under that name; keeps the new ones. All
/// pixels differ the first time.
function pixelsChanged(page, kept) {
  return page.evaluate((name) => {
    const canvas = document.querySelector('#map');
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', {willReadFrequently: true});
    copy.drawImage(canvas, 0, 0);
    const now = new Uint32Array(copy.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
    const before = (window.keptPixels ??= {})[name];
    window.keptPixels[name] = now;
    if (before?.length !== now.length) return now.length;
    return now.reduce((count, pixel, k) => count + Number(pixel !== before[k]), 0);
  }, kept);
}

/// The worker that draws the background may be late.
async function comesToRest(page, kept) {
  const deadline = Date.now() + 10_000;
  do {
    assert(Date.now() < deadline, 'the map comes to rest');
    await pause(300);
  } while (await pixelsChanged(page, kept) > 0);
}

/// The robot of the table that moves furthest in a second, and is on the map.
async function movingRobot(page) {
  const names = await page.locator('#table tbody tr:not(.spacer) td:first-child').allTextContents();
  const before = await Promise.all(names.map((name) => positionOf(page, name)));
  await pause(1000);
  const after = await Promise.all(names.map((name) => positionOf(page, name)));
  const moved = names.map((name, k) => ({name, by: before[k] && after[k] ? apart(before[k], after[k]) : 0}));
  const most = moved.reduce((a, b) => (b.by > a.by ? b : a));
  assert(most.by > 1, `no robot moves: ${JSON.stringify(moved)}`);
  return most.name;
}

/// Clicks on a driving robot. Others may stand in front of it, so that it takes a few attempts.
async function clickOn(page, name) {
  for (let attempt = 0; attempt < 20; ++attempt) {
    const at = await positionOf(page, name);
    if (await isOnMap(page, at)) await page.mouse.click(at.x, at.y);
    if ((await state(page)).selected === name) return;
    await pause(200);
  }
  assert.fail(`no click hit ${name}`);
}

const isOnMap = (page, at) => page.evaluate((p) => p !== null && document.elementFromPoint(p.x, p.y)?.id === 'map', at);

/// Two fingers on the map move from 80 to 160 pixels apart.
async function pinch(page) {
  const box = await page.locator('#map').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const session = await page.context().newCDPSession(page);
  const touch = (type, half) => session.send('Input.dispatchTouchEvent', {
    type, touchPoints: half ? [{x: x - half, y, id: 1}, {x: x + half, y, id: 2}] : [],
  });
  await touch('touchStart', 40);
  for (let half = 44; half <= 80; half += 4) await touch('touchMove', half);
  await touch('touchEnd');
  await pause(200);
}

const checks = {
  async 'the page shows a map and moving robots'(url) {
    const page = await openReady(url);
    const {robots, frames, time} = await state(page);
    assert(robots > 0);
    const name = await movingRobot(page);
    await pixelsChanged(page, 'moving');
    await pause(700);
    assert(await pixelsChanged(page, 'moving') > 50, 'pixels of the map change');
    const later = await state(page);
    assert(later.frames > frames && later.time > time);
    assert(await positionOf(page, name));
    assert.equal(await positionOf(page, 'no robot has that name'), null);
    await pause(3000);
    await shoot(page, 'light');
    const origin = new URL(url).origin;
    assert.deepEqual(page.asked.filter((asked) => !asked.startsWith(origin)), [], 'the page makes no other requests');
    await close(page);
  },

  async 'a click shows the details of a robot, and it can be followed'(url) {
    const page = await openReady(url);
    const name = await movingRobot(page);
    await clickOn(page, name);
    assert.equal(await page.locator('#details-name').textContent(), name);
    const position = page.locator('#details-body dd').first();
    const before = await position.textContent();
    await until(page, (text) => document.querySelector('#details-body dd').textContent !== text, before);
    await page.keyboard.press('t');
    assert.equal((await state(page)).following, name);
    for (let k = 0; k < 4; ++k) await page.keyboard.press('+');
    await pause(600);
    const box = await page.locator('#map').boundingBox();
    const middle = {x: box.x + box.width / 2, y: box.y + box.height / 2};
    for (let k = 0; k < 5; ++k) {
      const at = await positionOf(page, name);
      assert(Math.abs(at.x - middle.x) < box.width / 2 && Math.abs(at.y - middle.y) < box.height / 2, 'the followed robot stays in view');
      await pause(200);
    }
    await shoot(page, 'following');
    await page.locator('#follow').click();
    assert.equal((await state(page)).following, null);
    await page.keyboard.press('Escape');
    assert.equal((await state(page)).selected, null);
    assert.equal(await page.locator('#details').isVisible(), false);
    await close(page);
  },

  async 'a pause freezes the page, and live goes on at the present'(url) {
    const page = await openReady(url);
    if (await page.locator('body.recorded').count()) return close(page);
    const name = await movingRobot(page);
    await page.keyboard.press(' ');
    await pause(300);
    const held = await state(page);
    assert.equal(held.playing, false);
    const at = await positionOf(page, name);
    // A robot that moved would change every picture. Where the machine is busy, the page may mark data of more than a second in between.
    let changed = 1;
    for (let k = 0; k < 5 && changed > 0; ++k) {
      await comesToRest(page, 'held');
      await pause(1500);
      changed = await pixelsChanged(page, 'held');
    }
    assert.equal(changed, 0, 'nothing moves');
    assert.equal((await state(page)).time, held.time);
    assert.deepEqual(await positionOf(page, name), at);
    await shoot(page, 'held');
    await page.locator('#live').click();
    await until(page, (time) => window.coppice.playing && window.coppice.time > time + 1, held.time);
    await close(page);
  },

  async 'layers can be hidden'(url) {
    const page = await openReady(url);
    await page.keyboard.press(' ');
    await pause(500);
    for (const layer of ['trees', 'roots', 'paths', 'ends']) {
      const box = page.locator(`#layer-${layer}`);
      await pixelsChanged(page, 'layers');
      await box.evaluate((input) => input.click());
      assert.equal(await box.isChecked(), false);
      await pause(600);
      if (!given) assert(await pixelsChanged(page, 'layers') > 50, `${layer} is drawn, and then no more`);
    }
    await page.keyboard.press('5');
    assert.equal(await page.locator('#layer-near').isChecked(), false);
    await page.keyboard.press('5');
    assert.equal(await page.locator('#layer-near').isChecked(), true);
    await page.locator('#legend summary').click();
    await shoot(page, 'legend');
    await close(page);
  },

  async 'the table sorts, finds and selects robots'(url) {
    const page = await openReady(url);
    const cells = async (column) =>
      (await page.locator(`#table tbody tr:not(.spacer) td:nth-child(${column})`).allTextContents()).map((text) => text.trim());
    const sorted = (values, direction) => values.every((value, k) => k === 0 || direction * (value - values[k - 1]) >= 0);
    await page.getByRole('button', {name: 'm/s'}).click();
    assert(sorted((await cells(3)).map(Number), 1), `ascending: ${await cells(3)}`);
    await page.getByRole('button', {name: 'm/s'}).click();
    assert.equal(await page.locator('th[aria-sort="descending"]').count(), 1);
    assert(sorted((await cells(3)).map(Number), -1), `descending: ${await cells(3)}`);
    await page.getByRole('button', {name: 'Robot', exact: true}).click();
    const names = await cells(1);
    assert.deepEqual(names, [...names].sort(new Intl.Collator(undefined, {numeric: true}).compare));
    const row = page.locator('#table tbody tr:not(.spacer)').nth(Math.min(1, names.length - 1));
    await row.click();
    const {selected} = await state(page);
    assert(names.includes(selected));
    assert.equal(await page.locator('#table tr.selected td').first().textContent(), selected);
    const box = await page.locator('#map').boundingBox();
    const at = await positionOf(page, selected);
    assert(at.x > box.x && at.x < box.x + box.width && at.y > box.y && at.y < box.y + box.height, 'the selected robot is in view');
    await page.locator('#table').focus();
    await page.keyboard.press('End');
    assert.notEqual((await state(page)).selected, selected);
    await page.keyboard.press('/');
    await page.keyboard.type(selected);
    assert((await cells(1)).every((name) => name.includes(selected)));
    await page.keyboard.press('Enter');
    assert((await state(page)).selected.includes(selected));
    await close(page);
  },

  async 'keys, wheel, drag and buttons zoom, pan and fit'(url) {
    const page = await openReady(url);
    const {scale} = await state(page);
    await page.keyboard.press('+');
    assert((await state(page)).scale > scale);
    await page.locator('#zoom-in').click();
    const box = await page.locator('#map').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.wheel(0, -300);
    await pause(200);
    const near = (await state(page)).scale;
    assert(near > scale * 1.8, `${near} of ${scale}`);
    const name = (await page.locator('#table tbody tr:not(.spacer) td:first-child').first().textContent());
    await page.locator('#play').click();
    await pause(200);
    const before = await positionOf(page, name);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 80, box.y + box.height / 2 + 40, {steps: 4});
    await page.mouse.up();
    await page.keyboard.press('ArrowLeft');
    await pause(200);
    if (!(await page.locator('body.recorded').count())) {
      const after = await positionOf(page, name);
      assert(after.x - before.x > 100 && after.y - before.y > 25, `dragged and pushed: ${JSON.stringify({before, after})}`);
    }
    await page.keyboard.press('0');
    await pause(100);
    assert.equal((await state(page)).scale, scale);
    await close(page);
  },

  async 'the page has a dark and a light theme, and help'(url) {
    const page = await openReady(url, {colorScheme: 'dark'});
    const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
    assert.equal(await theme(), 'dark');
    await pause(3000);
    await shoot(page, 'dark');
    await page.emulateMedia({colorScheme: 'light'});
    await until(page, () => document.documentElement.dataset.theme === 'light');
    await page.keyboard.press('d');
    assert.equal(await theme(), 'dark');
    await page.reload();
    await until(page, () => window.coppice.ready);
    assert.equal(await theme(), 'dark', 'the choice is kept');
    await page.keyboard.press('?');
    assert(await page.locator('#help').isVisible());
    await shoot(page, 'help');
    await page.keyboard.press('Escape');
    assert.equal(await page.locator('#help').isVisible(), false);
    await close(page);
  },

  async 'the page works on a phone'(url) {
    const page = await openReady(url, {viewport: small, hasTouch: true, isMobile: true, deviceScaleFactor: 2});
    assert(await page.evaluate((width) => document.documentElement.scrollWidth <= width, small.width), 'nothing is wider than the screen');
    await shoot(page, 'phone');
    const names = await page.locator('#table tbody tr:not(.spacer) td:first-child').allTextContents();
    for (let k = 0; k < 3 * names.length && (await state(page)).selected === null; ++k) {
      const at = await positionOf(page, names[k % names.length]);
      if (!(await isOnMap(page, at))) continue;  // a button lies over it
      await page.touchscreen.tap(at.x, at.y);
      await pause(100);
    }
    assert((await state(page)).selected);
    assert(await page.locator('#details').isVisible(), 'a robot that is tapped shows its details');
    const {scale} = await state(page);
    await pinch(page);
    const pinched = (await state(page)).scale / scale;
    assert(pinched > 1.5 && pinched < 2.5, `two fingers, apart from 80 to 160 pixels: ${pinched}`);
    await page.getByRole('button', {name: 'Details'}).click();
    assert(await page.locator('#details').isVisible());
    await shoot(page, 'phone-details');
    await page.getByRole('button', {name: 'Charts'}).click();
    await pause(1500);
    assert.equal(await page.locator('#charts canvas').count(), 6);
    await shoot(page, 'phone-charts');
    await close(page);
  },
};

const mockChecks = {
  async 'a recording can be played, paused and searched'() {
    const mock = await mocked.startMock({recorded: true});
    const page = await openReady(mock.url);
    await page.locator('#scrubber').waitFor({timeout: 15_000});
    await page.keyboard.press(' ');
    await until(page, () => !window.coppice.playing);
    await pause(500);
    const {time} = await state(page);
    await pause(700);
    assert.equal((await state(page)).time, time);
    await page.locator('#scrubber').fill('90');
    await until(page, () => Math.abs(window.coppice.time - 90) < 1);
    await page.locator('#table tbody tr:not(.spacer)').first().click();
    const {selected, scale} = await state(page);
    await page.locator('#scrubber').fill('20');
    await until(page, () => Math.abs(window.coppice.time - 20) < 1);
    await until(page, (name) => window.coppice.selected === name, selected);
    assert.equal((await state(page)).scale, scale, 'the view stays at the same position');
    await page.locator('#speed').selectOption('4');
    await page.locator('#play').click();
    await until(page, () => window.coppice.playing && window.coppice.time > 24);
    await shoot(page, 'recording');
    await close(page);
    await mock.close();
  },

  async 'the page reconnects to a restarted server'() {
    const mock = await mocked.startMock({});
    const page = await openReady(mock.url);
    await mock.close();
    await page.locator('.pill.lost').waitFor();
    await pause(800);
    await shoot(page, 'lost');
    const again = await mocked.startMock({port: mock.port});
    await page.locator('.pill.live').waitFor({timeout: 15_000});
    await until(page, () => window.coppice.ready);
    await movingRobot(page);
    page.said = page.said.filter((line) => !line.includes('ERR_CONNECTION_REFUSED'));  // a message of chromium itself
    await close(page);
    await again.close();
  },

  async 'an invalid message is refused, and the page reconnects'() {
    const mock = await mocked.startMock({});
    const page = await openReady(mock.url);
    const before = (await state(page)).frames;
    mock.say(Uint8Array.from([0x3a, 0xff, 0xff, 0xff, 0xff]));  // a truncated frame
    await page.locator('.pill.lost').waitFor();
    await page.locator('.pill.live').waitFor({timeout: 15_000});
    await until(page, (frames) => window.coppice.ready && window.coppice.frames > frames + 10, before);
    await close(page);
    await mock.close();
  },

  async 'the page says that there is no fleet yet'() {
    const mock = await mocked.startMock({silent: true});
    const page = await open(mock.url);
    await page.locator('.pill.waiting').waitFor();
    assert.equal(await page.locator('#connection').textContent(), 'waiting for a fleet');
    await page.locator('#notice').waitFor({timeout: 15_000});
    assert.equal((await state(page)).ready, false);
    await shoot(page, 'empty');
    await close(page);
    await mock.close();
  },

  async [`200 robots, ${leastFps} frames a second at least`]() {
    const mock = await mocked.startMock({robots: 200});
    const page = await openReady(mock.url);
    await pause(2000);
    await measure(page, 'all layers, whole map');
    await shoot(page, '200');
    await page.locator('#table tbody tr:not(.spacer)').nth(1).click();
    await page.keyboard.press('t');
    await pause(1000);
    await measure(page, 'following one, zoomed in');
    await page.keyboard.press('f');
    await pause(500);
    const panning = setInterval(() => page.keyboard.press('ArrowLeft').then(() => page.keyboard.press('ArrowRight')).catch(() => {}), 120);
    await page.keyboard.press('+');
    await measure(page, 'while one pans');
    clearInterval(panning);
    await pause(300);
    await close(page);
    await mock.close();
  },
};

// What a new user sees. These checks take little time.
const checksAtFirstSight = {
  async 'no width cuts off the numbers in table cells'() {
    const mock = await mocked.startMock({longest: 1255.04, late: 0.5});
    for (const viewport of viewports) {
      const page = await openReady(mock.url, {viewport});
      const cut = await page.evaluate(() => [...document.querySelectorAll('#table td, #table th button')]
        .filter((cell) => cell.clientWidth > 0 && cell.scrollWidth > cell.clientWidth).map((cell) => cell.textContent));
      assert.deepEqual(cut, [], `at ${viewport.width} pixels`);
      assert((await page.locator('#table tbody td:nth-child(4)').allTextContents()).includes('1255'));
      await close(page);
    }
    await mock.close();
  },

  async 'the map fills the view while a robot is selected'() {
    const mock = await mocked.startMock({});
    for (const viewport of viewports) {
      const page = await openReady(mock.url, {viewport});
      await page.keyboard.press(' ');
      await comesToRest(page, 'paused');
      for (let k = 0; k < 20; ++k) {
        await page.keyboard.press(']');
        const deadline = Date.now() + 3000;  // a busy browser draws late
        let covered = 0;
        do covered = await shareOfMapInSight(page); while (covered < 0.999 && Date.now() < deadline);
        assert(covered >= 0.999, `${(await state(page)).selected}: ${covered} of the view, at ${viewport.width} pixels`);
      }
      await close(page);
    }
    await mock.close();
  },

  async 'a scrollable strip looks like one'() {
    const mock = await mocked.startMock({});
    const page = await openReady(mock.url, {viewport: small});
    const last = page.locator('#chips label').last();
    const [left, right] = [page.locator('#chips-left'), page.locator('#chips-right')];
    assert(await right.isVisible() && !(await left.isVisible()), 'there is more to the right');
    for (let k = 0; k < 10 && await right.isVisible(); ++k) {
      await right.click();
      await pause(600);
    }
    const [strip, box] = [await page.locator('#chips').boundingBox(), await last.boundingBox()];
    assert(box.x + box.width <= strip.x + strip.width + 1, 'the last layer is in view');
    assert(await left.isVisible());
    await close(page);
    const wide = await openReady(mock.url);
    assert(!(await wide.locator('#chips-right').isVisible()), 'there is no hint if all layers are in view');
    await close(wide);
    await mock.close();
  },

  async 'the page shows a map far from the origin of its frame'() {
    const [x, y] = [500000.25, 5400000.5];
    const mock = await mocked.startMock({origin: [x, y]});
    const page = await openReady(mock.url);
    const name = await movingRobot(page);
    await clickOn(page, name);
    for (const robot of mock.robots) robot.stands = true;  // a robot that drives is drawn a little behind its newest position
    const shown = (term) => page.locator(`#details-body dt:text-is("${term}") + dd`).textContent();
    const box = await page.locator('#map').boundingBox();
    await within(async () => {
      const position = await shown('Position');
      assert.match(position, /^500\d{3}\.\d{3}, 5400\d{3}\.\d{3}$/);
      const [px, py] = position.split(',').map(Number);
      const {scale} = await state(page);
      const fit = {left: box.x + box.width / 2 - 200 * scale, bottom: box.y + box.height / 2 + 150 * scale};
      return apart(await positionOf(page, name), {x: fit.left + (px - x) * scale, y: fit.bottom - (py - y) * scale}) < 0.5;
    }, 'the robot is drawn at its position');
    const [gx, gy] = (await shown('Goal')).split(',').map(Number);
    assert(gx > x && gx < x + 400 && gy > y && gy < y + 300, `its goal: ${await shown('Goal')}`);
    await close(page);
    await mock.close();
  },

  async 'the badge says whether a fleet is alive'() {
    const {LifeState} = mocked;
    const mock = await mocked.startMock({});
    const page = await openReady(mock.url);
    const badge = (text) => until(page, (wanted) => document.querySelector('#connection').textContent.startsWith(wanted), text);
    await badge('live');
    mock.tell({state: LifeState.SILENT, heard: 1.7e9});
    await badge('fleet silent since ');
    assert(await page.locator('#notice').isVisible());
    await shoot(page, 'silent');
    mock.tell({state: LifeState.NOBODY});
    await badge('waiting for a fleet');
    mock.tell({replayed: true});
    await badge('replay');
    mock.tell({});
    await badge('live');
    await close(page);
    await mock.close();
  },

  async 'the page shows the end of a run, also after its monitor ended'() {
    const mock = await mocked.startMock({});
    const page = await openReady(mock.url);
    mock.tell({state: mocked.LifeState.ENDED, robots: 20, arrived: 19});
    await page.locator('.pill.ended').waitFor();
    const title = () => page.locator('#notice-title').textContent();
    assert.equal(await title(), 'run ended: 19 of 20 arrived');
    await mock.close();
    await pause(1500);
    assert.equal(await title(), 'run ended: 19 of 20 arrived');
    assert.equal(await page.locator('#connection').textContent(), 'run ended');
    assert.equal(await page.locator('body.lost').count(), 0);
    const again = await mocked.startMock({port: mock.port});
    await page.locator('.pill.live').waitFor({timeout: 15_000});
    page.said = page.said.filter((line) => !line.includes('ERR_CONNECTION_REFUSED'));
    await close(page);
    await again.close();
  },

  async 'a robot that waits says why, and for how long it has'() {
    const mock = await mocked.startMock({waiting: 12});
    const page = await openReady(mock.url);
    const shown = (term) => page.locator(`#details-body dt:text-is("${term}") + dd`).textContent();
    await page.locator('#table tbody tr', {has: page.locator('td:text-is("r3")')}).click();
    const why = 'it waits for r1, which goes first by the joint plan';
    await until(page, (cause) => document.querySelector('#details-alarms').textContent.includes(cause), why);
    assert.match(await page.locator('#details-alarms').textContent(), new RegExp(`Has waited for 12\\ss: ${why}\\.`));
    assert.match(await shown('Waits'), new RegExp(`^12\\.0\\ss: ${why}$`));
    assert.match(await shown('Waited'), /^31\.5\ss$/);
    await shoot(page, 'waits');
    await page.locator('#table tbody tr', {has: page.locator('td:text-is("r2")')}).click();
    await until(page, () => document.querySelector('#details-alarms').textContent === '');
    assert.equal(await shown('Waits'), 'no');
    await close(page);
    await mock.close();
  },

  async 'alarming figures explain themselves'() {
    const mock = await mocked.startMock({late: 0.5});
    const page = await openReady(mock.url);
    const row = page.locator('#table tbody tr', {has: page.locator('td:text-is("r3")')});
    await until(page, () => document.querySelectorAll('#table td.alarm').length > 0);
    assert.match(await row.locator('td.alarm').first().getAttribute('title'), /for lack of processor time/);
    await row.click();
    await until(page, () => /for lack of processor time/.test(document.querySelector('#details-alarms').textContent));
    await shoot(page, 'alarms');
    const unexplained = await page.evaluate(() => [...document.querySelectorAll('#details-body dt, #table th button, #charts figcaption')]
      .filter((figure) => !figure.title).map((figure) => figure.textContent));
    assert.deepEqual(unexplained, []);
    await page.keyboard.press('?');
    assert.match(await page.locator('#help-figures').textContent(), /Periods missed/);
    await close(page);
    await mock.close();
  },
};

/// The share of the view that the mock's map of 400 x 300 m covers.
async function shareOfMapInSight(page) {
  await pause(150);
  const [{scale, origin}, box] = [await state(page), await page.locator('#map').boundingBox()];
  const overlap = (low, high, from, size) => Math.max(0, Math.min(high, from + size) - Math.max(low, from)) / size;
  const across = overlap(origin.x, origin.x + 400 * scale, box.x, box.width);
  return across * overlap(origin.y - 300 * scale, origin.y, box.y, box.height);
}

async function measure(page, what) {
  const from = await state(page);
  const began = performance.now();
  const seconds = [];
  for (let k = 0; k < 5; ++k) {
    await pause(1000);
    seconds.push((await state(page)).fps);
  }
  const mean = (1000 * ((await state(page)).frames - from.frames)) / (performance.now() - began);
  console.log(`     ${what}: ${mean.toFixed(1)} frames/s; each second: ${seconds.join(' ')}`);
  assert(mean >= leastFps, `${mean} frames a second`);
}

const atFirstSight = process.argv[2] === '--at-first-sight';
const wanted = atFirstSight ? '' : process.argv[2] ?? '';
const shared = mocked && !atFirstSight ? await mocked.startMock({robots: 20}) : undefined;
if (!atFirstSight) for (const [name, check] of Object.entries(checks)) if (name.includes(wanted)) await run(name, () => check(given ?? shared.url));
if (mocked) for (const [name, check] of Object.entries(checksAtFirstSight)) if (name.includes(wanted)) await run(name, check);
if (mocked && !atFirstSight) for (const [name, check] of Object.entries(mockChecks)) if (name.includes(wanted)) await run(name, check);
await shared?.close();
await finish();
