// Control of a fleet from the page: orders, pauses and stops (docs/monitor.md, "Control"). Joins the parts, which are
// hidden while the page may only show.
import {Access} from './access.ts';
import {type Draft, type Point, type Situation, goalOf, hintOf, targetOf} from './aim.ts';
import {Api, detail} from './api.ts';
import {Commands} from './commands.ts';
import type {Connection, ConnectionState} from './connection.ts';
import {byId, setText} from './dom.ts';
import {DutyPanel} from './duty_panel.ts';
import type {ServerEvent} from './event_parser.ts';
import {EventStream} from './event_stream.ts';
import type {Fleet} from './fleet.ts';
import type {Aim} from './gestures.ts';
import {drawDraft, drawGoals} from './goal_layer.ts';
import {type KeyAim, onAimKey, tipOf} from './key_aim.ts';
import {listenToKeys} from './keyboard.ts';
import type {MapView} from './map_view.ts';
import {OrderList} from './order_list.ts';
import {Notices} from './notices.ts';
import {Orders} from './orders.ts';
import type {Palette} from './palette.ts';
import {ReplaceDialog} from './replace_dialog.ts';
import {readEvent} from './schema.ts';
import {oldAfter} from './silence.ts';
import {StopButton} from './stop_button.ts';
import {Toasts} from './toasts.ts';
import {type View, toPageX, toPageY} from './view.ts';

const coarse = matchMedia('(pointer: coarse)');
const doubleClick = {milliseconds: 500, pixels: 16};  // within these, a second press is no second order

export class Control implements Aim {
  private sends = true;
  private queues = false;
  private any = false;
  private isLost = false;  // the connection to the monitor
  private draft: Draft | undefined;
  private keyAim: KeyAim | undefined;  // keys move the draft
  private dropped = {at: {x: NaN, y: NaN}, time: -Infinity};  // the last press on the map that sent a robot
  private failure = '';  // of the stream of events
  private readonly api = new Api();
  private readonly orders = new Orders();
  private readonly stream = new EventStream(this.api, {
    onOpen: () => this.onOpen(),
    onEvent: (event) => this.onEvent(event),
    onEnd: (why) => this.onEnd(why),
    onRefused: (error) => this.access.refuse(error),
  });
  private readonly toasts = new Toasts(byId('toasts'), byId('announced'));
  private readonly access = new Access(this.api, () => this.onAccess(), (why) => this.toasts.fail('access', why, {holds: () => !this.isOn}));
  private readonly question = new ReplaceDialog();
  private readonly commands = new Commands(this.api, this.orders, this.toasts, (robot, earlier) => this.question.ask(robot, earlier), (error) => this.access.refuse(error));
  private readonly notices = new Notices(this.orders, this.toasts, () => this.api.by);
  private readonly list = new OrderList(this.orders, (order) => void this.commands.cancel(order));
  private readonly stop = new StopButton(() => this.isOn, (what) => (what === 'stop' ? this.commands.stopAll(this.connection.age <= oldAfter) : this.commands.releaseAll()));
  private readonly duty = new DutyPanel(this.orders);
  private readonly buttons = {
    send: byId('send'), queue: byId('queue'), any: byId('any'), pause: byId<HTMLButtonElement>('pause'), go: byId<HTMLButtonElement>('go'),
  };
  private readonly hint = byId('hint');

  constructor(private readonly fleet: Fleet, private readonly map: MapView, private readonly connection: Connection, private readonly onHidden: () => void) {
    map.above = (context, view, palette) => this.draw(context, view, palette);
    this.buttons.send.addEventListener('click', () => this.toggleSend());
    this.buttons.queue.addEventListener('click', () => this.toggleQueue());
    this.buttons.any.addEventListener('click', () => this.toggleAny());
    this.buttons.pause.addEventListener('click', () => this.togglePause());
    byId('go-form').addEventListener('submit', (event) => {
      event.preventDefault();
      this.sendByForm();
    });
    listenToKeys([
      {keys: ['g'], shown: 'G', does: 'a press on the map sends the selected robot, or moves the map', act: () => this.toggleSend()},
      {keys: ['q'], shown: 'Q', does: 'new orders follow earlier ones (also with Shift)', act: () => this.toggleQueue()},
      {keys: ['a'], shown: 'A', does: 'send any robot', act: () => this.toggleAny()},
      {keys: ['m'], shown: 'M', does: 'aim with the keyboard: arrow keys move the mark (with Shift by little), R turns the heading, Enter sends, Shift+Enter queues', act: () => this.aimByKeys()},
      {keys: ['p'], shown: 'P', does: 'pause or resume the selected robot', act: () => this.togglePause()},
    ], 'help-control', () => this.isOn);
    map.canvas.addEventListener('keydown', (event) => this.onMapKey(event));
  }

  start(): void {
    this.access.start();
  }

  /// The monitor says so on each connection.
  offer(isOffered: boolean): void {
    this.access.offer(isOffered);
  }

  onConnection({kind}: ConnectionState): void {
    if (kind === 'lost') this.onMute();
    if (kind !== 'connecting') this.isLost = kind === 'lost';
  }

  /// What the page knows of orders and stops is as old as what the map shows.
  onMute(): void {
    if (!this.isLost) this.stream.restart();  // its connection may be dead, too, and not say so
  }

  /// Whether the key had a meaning here.
  escape(): boolean {
    if (!this.draft && !this.any) return false;
    if (!this.draft) this.any = false;
    this.leave();
    return true;
  }

  /// A selected robot is the one to send.
  onPick(robot: number): void {
    if (robot >= 0) this.any = false;
    this.update();
  }

  update(): void {
    this.toasts.update();
    if (!this.isOn) return;
    const {sends, any, queues, buttons} = this;
    for (const [button, on] of [[buttons.send, sends], [buttons.any, any], [buttons.queue, queues]] as const) button.ariaPressed = String(on);
    const target = targetOf(this.situation);
    this.map.canvas.classList.toggle('sends', target !== undefined);
    this.updatePause();
    buttons.go.disabled = !any && this.robot === undefined;
    setText(buttons.go, any ? 'Send any robot' : `Send ${this.robot ?? 'a robot'}`);
    setText(this.hint, this.failure || hintOf(this.situation));
    this.hint.classList.toggle('failure', this.failure !== '');
    this.stop.update(this.orders.allStopped);
    this.list.update();
    this.duty.update(this.robot);
  }

  begin(at: Point): boolean {
    const place = this.map.placeAt(at.x, at.y);
    if (!this.isOn || !place || targetOf(this.situation) === undefined) return false;
    this.draft = {place, from: at, to: at, up: this.map.up};
    this.changed();
    return true;
  }

  move(to: Point): void {
    if (!this.draft) return;
    this.draft = {...this.draft, to};
    this.changed();
  }

  drop(queue: boolean): void {
    const {draft, keyAim} = this;
    const target = targetOf(this.situation);
    this.leave();
    if (!draft || target === undefined) return;
    if (!keyAim) {
      if (this.isSecondClick(draft.from)) return;
      this.dropped = {at: draft.from, time: performance.now()};
    }
    void this.commands.send(target, goalOf(draft), queue || this.queues);
  }

  leave(): void {
    this.draft = this.keyAim = undefined;
    this.changed();
  }

  private get isOn(): boolean {
    return this.access.isOn;
  }
  private get robot(): string | undefined {
    return this.fleet.roster[this.map.selected]?.name;
  }
  private get situation(): Situation {
    const {sends, any, robot, queues, draft} = this;
    return {sends, any, robot, queues, draft, halt: robot === undefined ? 'none' : this.orders.haltOf(robot), touch: coarse.matches, byKeys: this.keyAim !== undefined};
  }

  private isSecondClick({x, y}: Point): boolean {
    const {at, time} = this.dropped;
    return performance.now() - time < doubleClick.milliseconds && Math.hypot(x - at.x, y - at.y) < doubleClick.pixels;
  }

  /// Begins at the selected robot, or in the middle for any robot.
  private aimByKeys(): void {
    const {canvas, robots, selected} = this.map;
    if (!this.any && this.robot === undefined) return;
    this.sends = true;
    const [x, y] = this.any ? [NaN, NaN] : [robots.x[selected], robots.y[selected]];
    const at = Number.isFinite(x) ? {x, y} : {x: canvas.clientWidth / 2, y: canvas.clientHeight / 2};
    canvas.focus();
    this.setKeyAim({at, heading: undefined});
  }

  private onMapKey(event: KeyboardEvent): void {
    if (!this.isOn || !this.keyAim || event.ctrlKey || event.metaKey || event.altKey) return;
    const outcome = onAimKey(event, this.keyAim);
    if (outcome === undefined) return;
    event.preventDefault();
    event.stopPropagation();  // elsewhere the arrow keys move the map
    if (typeof outcome === 'object') this.setKeyAim(outcome.aim);
    else this.drop(outcome === 'queue');
  }

  private setKeyAim(aim: KeyAim): void {
    const {map} = this;
    const {clientWidth, clientHeight} = map.canvas;
    const at = {x: Math.max(0, Math.min(clientWidth, aim.at.x)), y: Math.max(0, Math.min(clientHeight, aim.at.y))};
    const place = map.placeAt(at.x, at.y);
    if (!place) return;
    this.keyAim = {at, heading: aim.heading};
    this.draft = {place, from: at, to: tipOf(this.keyAim), up: map.up};
    this.changed();
    byId('announced').textContent = this.fleet.isBlocked(place) ? `${this.hint.textContent} There is an obstacle.` : this.hint.textContent;
  }

  private changed(): void {
    this.map.touch();
    this.update();
  }

  private onAccess(): void {
    byId('control').hidden = byId('orders').hidden = byId('orders-tab').hidden = byId('help-of-control').hidden = !this.isOn;
    document.body.classList.toggle('controlled', this.isOn);
    if (this.isOn) this.stream.open();
    else this.hide();
    this.changed();
  }

  private hide(): void {
    this.stream.close();
    this.question.close();
    this.orders.forget();
    this.draft = this.keyAim = undefined;
    this.map.canvas.classList.remove('sends');
    this.duty.update(undefined);
    this.onHidden();
  }

  private onOpen(): void {
    this.orders.forget();
    this.notices.begin(this.fleet.beat);
    this.failure = '';
    this.changed();
  }

  private onEvent({kind, data}: ServerEvent): void {
    const event = readEvent(kind, JSON.parse(data));
    if (!event) return;
    const before = this.orders.on(event);
    if (event.kind === 'order') this.notices.on(event.data, before);
    this.changedSoon();
  }

  /// Many events come at once when the stream opens.
  private changedSoon(): void {
    if (this.isChanging) return;
    this.isChanging = true;
    requestAnimationFrame(() => {
      this.isChanging = false;
      this.changed();
    });
  }
  private isChanging = false;

  private onEnd(why: unknown): void {
    this.orders.forgetHalt();
    if (why !== undefined) this.failure = `Orders and stops are not up to date: ${detail(why)}. Trying again.`;
    this.changed();
  }

  private sendByForm(): void {
    const target = this.any ? null : this.robot;
    if (target === undefined) return;
    const number = (id: string) => byId<HTMLInputElement>(id).valueAsNumber;
    const [x, y, yaw] = [number('go-x'), number('go-y'), number('go-yaw')];
    void this.commands.send(target, Number.isFinite(yaw) ? {x, y, yaw} : {x, y}, this.queues);
  }

  private togglePause(): void {
    const {robot} = this;
    if (robot === undefined || this.buttons.pause.disabled) return;
    void this.commands.togglePause(robot);
  }

  private updatePause(): void {
    const {pause} = this.buttons;
    const {robot} = this;
    const words = {none: 'Pause', paused: 'Resume', stopped: 'Release'};
    setText(pause, `${words[robot === undefined ? 'none' : this.orders.haltOf(robot)]}${robot === undefined ? '' : ` ${robot}`}`);
    pause.disabled = robot === undefined || this.orders.allStopped;
  }

  private toggleSend(): void {
    this.sends = !this.sends;
    this.leave();
  }
  private toggleQueue(): void {
    this.queues = !this.queues;
    this.changed();
  }
  private toggleAny(): void {
    this.any = !this.any;
    if (this.any) this.sends = true;
    this.leave();
  }

  private draw(context: CanvasRenderingContext2D, view: View, palette: Palette): void {
    const {robot, map, fleet} = this;
    if (!this.isOn) return;
    const toPage = ({x, y}: Point) => ({x: toPageX(view, x - (fleet.map?.origin_x ?? 0)), y: toPageY(view, y - (fleet.map?.origin_y ?? 0))});
    const [x, y] = [map.robots.x[map.selected], map.robots.y[map.selected]];
    if (robot !== undefined) drawGoals(context, Number.isFinite(x) ? {x, y} : undefined, this.orders.openOf(robot), toPage, palette);
    if (this.draft) drawDraft(context, this.draft, palette);
  }
}
