// Checks what the badge of a monitor's page (COPPICE_PAGE_URL) shows in turn, and that it never says that a
// fleet is live.
//
// node badge.spec.mjs TEXT...    (the beginnings of what it must show, one after the other; it prints each that it saw)
import assert from 'node:assert/strict';

import {chromium} from 'playwright-core';

import {arguments_of_chromium, program_of_chromium} from './chromium.mjs';

const browser = await chromium.launch({executablePath: program_of_chromium, args: arguments_of_chromium});
const page = await browser.newPage();
// Some texts are shown only briefly, so the page keeps them all, in the order in which they were shown.
await page.addInitScript(() => {
  window.badges = [];
  document.addEventListener('DOMContentLoaded', () => {
    const badge = document.querySelector('#connection');
    window.badges.push(badge.textContent);
    new MutationObserver(() => window.badges.push(badge.textContent)).observe(badge, {childList: true, characterData: true, subtree: true});
  });
});
await page.goto(process.env.COPPICE_PAGE_URL);
let from = 0;
for (const text of process.argv.slice(2)) {
  const isShown = ([wanted, first]) => window.badges.findIndex((badge, at) => at >= first && badge.startsWith(wanted)) + 1;
  from = await (await page.waitForFunction(isShown, [text, from], {timeout: 60_000})).jsonValue();
  console.log(text);
}
const badges = await page.evaluate(() => window.badges);
assert(!badges.includes('live'), `it said: ${badges}`);
await browser.close();
