// The live page of `coppice monitor`: joins the parts.
import './style.css';

import {AlarmPanel} from './alarm_panel.ts';
import {Charts} from './charts.ts';
import {Connection, type ConnectionState} from './connection.ts';
import {Control} from './control.ts';
import {Details, figuresExplained} from './details.ts';
import {byId, element} from './dom.ts';
import {Fleet, sceneChanges} from './fleet.ts';
import {listen} from './gestures.ts';
import {type Key, listenToKeys} from './keyboard.ts';
import {Legend} from './legend.ts';
import type {ToPage} from './live.js';
import {MapView} from './map_view.ts';
import {Playhead} from './playhead.ts';
import {decode, encode} from './protocol.ts';
import {StatusLine} from './status_line.ts';
import {RobotTable} from './table.ts';
import {PhaseCounts} from './phase_counts.ts';
import {exposeToTests} from './test_window.ts';
import {showWhatIsBeyond} from './strip.ts';
import {startTheme, toggleTheme} from './theme.ts';
import {TimeControl} from './time_control.ts';

const panelsPause = 300;  // milliseconds between two updates of the table and the details
const linePause = 200;
const chartPause = 166;   // six charts in turn, each once a second
const panStep = 60;       // pixels
const zoomStep = 1.25;
const small = matchMedia('(max-width: 760px)');  // as in style.css

const fleet = new Fleet();
const playhead = new Playhead();
let state: ConnectionState = {kind: 'connecting'};

startTheme(restyle);
const map = new MapView(byId<HTMLCanvasElement>('map'), fleet, playhead, () => time.frozen);
const connection = new Connection(address(), onBytes, onState, () => control.onMute());
const time = new TimeControl(fleet, (message) => connection.send(encode(message)), take, () => connection.open());
const statusLine = new StatusLine(fleet);
const details = new Details(fleet);
const table = new RobotTable(byId('table'), fleet, () => map.selected, (robot) => {
  pick(robot);
  map.centre(robot);
});
const phaseCounts = new PhaseCounts(byId('phases'), fleet);
const charts = new Charts(byId('charts'), fleet);
const legend = new Legend(map.layers, restyleMap);
const alarms = new AlarmPanel(fleet, byId('announced'), (robot) => {
  pick(robot);
  map.centre(robot);
});
const control = new Control(fleet, map, connection, () => { if (document.body.dataset.tab === 'orders') showTab('robots'); });

function address(): string {
  const url = new URL('/live', location.href);
  url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
  return url.href;
}

function onBytes(bytes: ArrayBuffer): void {
  const message = decode(bytes);
  if (message.begin) control.offer(message.begin.controlled);
  if (!time.holdsBack(message)) take(message);
}

function take(message: ToPage): void {
  const selected = fleet.roster[map.selected]?.name;
  const {following} = map;
  fleet.on(message);
  if (message.begin) playhead.clear();
  if (message.frame) playhead.on(message.frame, performance.now() / 1000);
  map.change(sceneChanges(message));
  if (message.begin && selected !== undefined) reselect = {name: selected, following};
  if (message.roster) restoreSelection();
}

// The selected robot stays selected when a recording jumps back, or after a new connection.
let reselect: {name: string; following: boolean} | undefined;

function restoreSelection(): void {
  const robot = reselect && fleet.indexOf(reselect.name);
  if (!reselect || robot === undefined) return;
  select(robot);
  map.following = reselect.following;
  reselect = undefined;
}

function onState(now: ConnectionState): void {
  state = now;
  if (now.kind === 'connecting') time.reset();
  statusLine.update(state, connection.age, time.frozen, map.time);
  control.onConnection(now);
}

function select(robot: number): void {
  map.select(robot);
  showFollowing();
  control.onPick(robot);
  updatePanels();
}

function pick(robot: number): void {
  reselect = undefined;
  select(robot);
  if (robot >= 0) table.reveal(robot);
  if (small.matches) showTab(robot >= 0 ? 'details' : 'robots');
}

function follow(on: boolean): void {
  map.following = on && map.selected >= 0;
  if (map.following) map.centre(map.selected);
  showFollowing();
  map.touch();
}

function showFollowing(): void {
  const button = byId('follow');
  if (button.ariaPressed !== String(map.following)) button.ariaPressed = String(map.following);
}

function step(direction: number): void {
  const order = table.sort();
  if (order.length === 0) return;
  const place = order.indexOf(map.selected);
  const next = place < 0 ? (direction > 0 ? 0 : order.length - 1) : (place + direction + order.length) % order.length;
  pick(order[next]);
  map.centre(order[next]);
}

function restyleMap(): void {
  map.restyle();
}

function restyle(): void {
  restyleMap();
  charts.restyle();
}

function switchTheme(): void {
  toggleTheme();
  restyle();
}

function toggleHelp(): void {
  const help = byId<HTMLDialogElement>('help');
  if (help.open) help.close();
  else help.show();  // not modal, and beside the map: STOP and the robots stay at hand
}

function toggleLegend(): void {
  const panel = byId<HTMLDetailsElement>('legend');
  panel.open = !panel.open;
}

function updatePanels(): void {
  if (time.frozen && panelsShown === map.selected) return;
  panelsShown = map.selected;
  details.update(map.selected);
  table.update();
  phaseCounts.update();
}
let panelsShown = -2;

const keys: Key[] = [
  {keys: [' '], shown: 'Space', does: 'pause or continue', act: () => time.toggle()},
  {keys: ['l'], shown: 'L', does: 'continue at the present (live)', act: () => time.goOn()},
  {keys: [',', '.'], shown: ', .', does: 'recording: five seconds back, forward', act: (key) => time.skip(key === ',' ? -1 : 1)},
  {keys: ['<', '>'], shown: '< >', does: 'recording: slower, faster', act: (key) => time.faster(key === '<' ? -1 : 1)},
  {keys: ['+', '=', '-'], shown: '+ -', does: 'zoom', act: (key) => map.zoom(key === '-' ? 1 / zoomStep : zoomStep)},
  {keys: ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'], shown: '← ↑ ↓ →', does: 'move the map', act: panByKey},
  {keys: ['0', 'f'], shown: '0 F', does: 'fit the whole map', act: () => map.fit()},
  {keys: ['t'], shown: 'T', does: 'follow the selected robot', act: () => follow(!map.following)},
  {keys: ['[', ']'], shown: '[ ]', does: 'select the previous or next robot', act: (key) => step(key === '[' ? -1 : 1)},
  {keys: ['/'], shown: '/', does: 'find a robot', act: () => byId('find').focus()},
  {keys: ['Escape'], shown: 'Esc', does: 'select nothing', act: escape},
  {keys: ['1', '2', '3', '4', '5', '6', '7', '8'], shown: '1 … 8', does: 'layers on and off', act: (key) => legend.toggle(Number(key) - 1)},
  {keys: ['k'], shown: 'K', does: 'legend', act: toggleLegend},
  {keys: ['!'], shown: '!', does: 'alarms', act: () => byId('alarm-list').focus()},
  {keys: ['c'], shown: 'C', does: 'charts', act: () => document.body.classList.toggle('no-charts')},
  {keys: ['d'], shown: 'D', does: 'dark or light', act: switchTheme},
  {keys: ['?'], shown: '?', does: 'this help', act: toggleHelp},
];

function escape(): void {
  const dialogs = [...document.querySelectorAll('dialog')].filter(({open}) => open);
  for (const dialog of dialogs) dialog.close();
  if (dialogs.length === 0 && !control.escape()) pick(-1);
}

function panByKey(key: string): void {
  const dx = key === 'ArrowLeft' ? panStep : key === 'ArrowRight' ? -panStep : 0;
  const dy = key === 'ArrowUp' ? panStep : key === 'ArrowDown' ? -panStep : 0;
  map.pan(dx, dy);
}

function listenToButtons(): void {
  const click = (id: string, act: () => void) => byId(id).addEventListener('click', act);
  click('zoom-in', () => map.zoom(zoomStep));
  click('zoom-out', () => map.zoom(1 / zoomStep));
  click('fit', () => map.fit());
  click('theme', switchTheme);
  click('help-open', toggleHelp);
  click('help-close', toggleHelp);
  for (const dialog of document.querySelectorAll('dialog'))
    dialog.addEventListener('keydown', ({key}) => { if (key === 'Escape') dialog.close(); });
  click('follow', () => follow(!map.following));
  click('deselect', () => pick(-1));
  click('reconnect', () => connection.open());
  const find = byId<HTMLInputElement>('find');
  find.addEventListener('input', () => table.search(find.value));
  find.addEventListener('keydown', (event) => {
    const [first] = table.sort();
    if (event.key === 'Enter' && first !== undefined) {
      pick(first);
      map.centre(first);
    }
    if (event.key !== 'Escape') return;
    find.blur();
    event.stopPropagation();  // elsewhere this key deselects the robot
  });
  for (const tab of document.querySelectorAll<HTMLButtonElement>('#tabs button'))
    tab.addEventListener('click', () => showTab(tab.dataset.tab!));
}

function explainFigures(): void {
  const list = byId('help-figures');
  for (const {term, hint} of figuresExplained) list.append(element('dt', {}, term), element('dd', {}, hint));
}

/// Small pages show one panel at a time.
function showTab(name: string): void {
  document.body.dataset.tab = name;
  for (const tab of document.querySelectorAll<HTMLButtonElement>('#tabs button'))
    tab.ariaPressed = String(tab.dataset.tab === name);
  updatePanels();
}

listen(map, pick, control);
listenToKeys(keys);
listenToButtons();
explainFigures();
showWhatIsBeyond(byId('chips'), byId('chips-left'), byId('chips-right'));
showTab('robots');
exposeToTests(fleet, map, time);
setInterval(updatePanels, panelsPause);
setInterval(() => { if (!time.frozen) charts.updateNext(); }, chartPause);
setInterval(() => {
  time.update();
  statusLine.update(state, connection.age, time.frozen, map.time);
  showFollowing();
  alarms.update();
  control.update();
}, linePause);
connection.open();
control.start();
