// Checks the page of a driving fleet through a proxy with TLS, in Debian's chromium: COPPICE_PAGE_URL is the proxy's
// address, COPPICE_PAGE_TOKEN the token. The fleet has robots r1 to r4.
import assert from 'node:assert/strict';

import {close, finish, openReady, pause, run, until} from './in_browser.mjs';

const url = process.env.COPPICE_PAGE_URL;
const token = process.env.COPPICE_PAGE_TOKEN;

await run('orders, stop, events and the map go through the proxy', async () => {
  const page = await openReady(`${url}#token=${token}`, {ignoreHTTPSErrors: true});
  await page.locator('#stop').waitFor();
  await until(page, () => document.querySelector('#connection').textContent === 'live' && window.coppice.robots === 4);
  const frames = await page.evaluate(() => window.coppice.frames);
  await pause(1000);
  assert(await page.evaluate(() => window.coppice.frames) > frames, 'the WebSocket brings frames');
  await page.locator('#table tbody tr', {has: page.locator('td:text-is("r2")')}).click();
  await page.locator('.by-numbers summary').click();
  await page.getByLabel('x, m').fill('428');
  await page.getByLabel('y, m').fill('300');
  await page.locator('#go').click();
  await until(page, () => document.querySelector('#order-count').textContent === '1 open');  // an event says so
  await page.locator('#stop').click();
  await until(page, () => document.querySelector('#stop strong').textContent === 'RELEASE');
  await until(page, () => /4halted/.test(document.querySelector('#phases').textContent));
  const pressed = Date.now();
  await page.getByRole('button', {name: /^Cancel/}).click();
  await until(page, () => /cancelled by page/.test(document.querySelector('#order-list .cancelled')?.textContent));
  assert(Date.now() - pressed < 3000, 'events are not held back');
  await close(page);
});

await finish();
