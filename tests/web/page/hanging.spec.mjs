// Checks what the page shows of a real monitor that hangs, and of an agent that does: COPPICE_PAGE_URL, with the token in
// COPPICE_PAGE_TOKEN, of a fleet of robots r1 to r4.
//
// node hanging.spec.mjs MONITOR_PID AGENT_PID     of the agent of r2
//
// COPPICE_PAGE_SHOTS: a folder for screenshots.
import assert from 'node:assert/strict';

import {close, finish, openReady, run, shoot, until} from './in_browser.mjs';

const url = process.env.COPPICE_PAGE_URL;
const token = process.env.COPPICE_PAGE_TOKEN;
const [monitor, agent] = process.argv.slice(2).map(Number);
const badge = (page) => page.locator('#connection').textContent();

async function openControlled() {
  const page = await openReady(`${url}#token=${token}`);
  await page.locator('#stop').waitFor();
  await until(page, () => document.querySelector('#connection').textContent === 'live');
  return page;
}

await run('a monitor that hangs is marked after a second and lost after three, and STOP does not get through', async () => {
  const page = await openControlled();
  process.kill(monitor, 'SIGSTOP');
  try {
    const hung = Date.now();
    await until(page, () => document.body.classList.contains('old'));
    const [old, pressed] = [Date.now() - hung, Date.now()];
    await page.locator('#stop').click();
    await until(page, () => document.querySelector('.toast.failure')?.textContent.includes('THE ROBOTS ARE NOT STOPPED'));
    const told = Date.now() - pressed;
    await until(page, () => document.body.classList.contains('lost'));
    const lost = Date.now() - hung;
    console.log(`old after ${old} ms, lost after ${lost} ms, STOP told after ${told} ms`);
    assert(old < 2500 && lost < 4500 && told < 1500, 'in time, on a busy machine');
    await shoot(page, 'hanging-monitor');
  } finally {
    process.kill(monitor, 'SIGCONT');
  }
  await until(page, () => document.querySelector('#connection').textContent === 'live');
  await close(page);
});

await run('an agent that hangs is an alarm, and its robot is none that is well', async () => {
  const page = await openControlled();
  assert.equal(await badge(page), 'live');
  process.kill(agent, 'SIGSTOP');
  try {
    const hung = Date.now();
    await until(page, () => /r2 is not heard/.test(document.querySelector('#alarm-list').textContent));
    console.log(`alarm after ${Date.now() - hung} ms`);
    assert(Date.now() - hung < 8000);
    const row = page.locator('#table tbody tr', {has: page.locator('td:text-is("r2")')});
    await until(page, () => [...document.querySelectorAll('#table tbody tr')].some((each) => /^r2silent/.test(each.textContent)));
    await row.click();
    await shoot(page, 'hanging-agent');
    const {alarms} = await (await fetch(new URL('api/alarms', url), {headers: {Authorization: `Bearer ${token}`}})).json();
    assert(alarms.some(({kind, robot}) => kind === 'robot_silent' && robot === 'r2'), JSON.stringify(alarms));
    const metrics = await (await fetch(new URL('metrics', url))).text();
    assert.match(metrics, /^coppice_alarms\{kind="robot_silent"\} [1-4]$/m);
    assert.match(metrics, /^coppice_robot_alarm\{robot="r2",kind="robot_silent"\} 1$/m);
  } finally {
    process.kill(agent, 'SIGCONT');
  }
  await until(page, () => !/r2 is not heard/.test(document.querySelector('#alarm-list').textContent));
  await close(page);
});

await finish();
