// Checks what the badge of a monitor's page (COPPICE_PAGE_URL) shows in turn, and that it never says that a
// fleet is live.
//
// node badge.spec.mjs TEXT...    (the beginnings of what it must show, one after the other)
import assert from 'node:assert/strict';

import {chromium} from 'playwright-core';

import {arguments_of_chromium, program_of_chromium} from './chromium.mjs';

const browser = await chromium.launch({executablePath: program_of_chromium, args: arguments_of_chromium});
const page = await browser.newPage();
await page.addInitScript(() => {
  window.badges = new Set();
  document.addEventListener('DOMContentLoaded', () => {
    const badge = document.querySelector('#connection');
    new MutationObserver(() => window.badges.add(badge.textContent)).observe(badge, {childList: true, characterData: true, subtree: true});
  });
});
await page.goto(process.env.COPPICE_PAGE_URL);
for (const text of process.argv.slice(2))
  await page.waitForFunction((wanted) => document.querySelector('#connection').textContent.startsWith(wanted), text, {timeout: 30_000});
const badges = await page.evaluate(() => [...window.badges]);
assert(!badges.includes('live'), `it said: ${badges}`);
await browser.close();
