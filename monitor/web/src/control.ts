// Control of a fleet from the page: orders, pauses and stops (docs/monitor.md, "Control"). Joins the parts, which are
// hidden while the page may only show.
import {Access} from './access.ts';
import {type Draft, type Point, type Situation, goalOf, hintOf, targetOf} from './aim.ts';
import {Api, detail} from './api.ts';
import {Commands} from './commands.ts';
import type {ConnectionState} from './connection.ts';
import {byId, setText} from './dom.ts';
import {DutyPanel} from './duty_panel.ts';
import type {ServerEvent} from './event_parser.ts';
import {EventStream} from './event_stream.ts';
import type {Fleet} from './fleet.ts';
import type {Aim} from './gestures.ts';
import {drawDraft, drawGoals} from './goal_layer.ts';
import {listenToKeys} from './keyboard.ts';
import type {MapView} from './map_view.ts';
import {OrderList} from './order_list.ts';
import {Orders} from './orders.ts';
import type {Palette} from './palette.ts';
import {StopButton} from './stop_button.ts';
import {Toasts} from './toasts.ts';
import {type View, toPageX, toPageY} from './view.ts';

const coarse = matchMedia('(pointer: coarse)');

export class Control implements Aim {
  private sends = true;
  private queues = false;
  private any = false;
  private isLost = false;  // the connection to the monitor
  private draft: Draft | undefined;
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
  private readonly access = new Access(this.api, () => this.onAccess(), (why) => this.toasts.fail(why));
  private readonly commands = new Commands(this.api, this.orders, this.toasts, (error) => this.access.refuse(error));
  private readonly list = new OrderList(this.orders, (order) => void this.commands.cancel(order));
  private readonly stop = new StopButton(() => this.isOn, (what) => (what === 'stop' ? this.commands.stopAll() : this.commands.releaseAll()));
  private readonly duty = new DutyPanel(this.orders);
  private readonly buttons = {
    send: byId('send'), queue: byId('queue'), any: byId('any'), pause: byId<HTMLButtonElement>('pause'), go: byId<HTMLButtonElement>('go'),
  };
  private readonly hint = byId('hint');

  constructor(private readonly fleet: Fleet, private readonly map: MapView, private readonly onHidden: () => void) {
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
      {keys: ['p'], shown: 'P', does: 'pause or resume the selected robot', act: () => this.togglePause()},
    ], 'help-control', () => this.isOn);
  }

  start(): void {
    this.access.start();
  }

  /// The monitor says so on each connection.
  offer(isOffered: boolean): void {
    this.access.offer(isOffered);
  }

  onConnection({kind}: ConnectionState): void {
    if (kind === 'lost' && !this.isLost) this.stream.restart();  // its connection may be dead, too, and not say so
    if (kind !== 'connecting') this.isLost = kind === 'lost';
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
    const {draft} = this;
    const target = targetOf(this.situation);
    this.leave();
    if (draft && target !== undefined) void this.commands.send(target, goalOf(draft), queue || this.queues);
  }

  leave(): void {
    this.draft = undefined;
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
    return {sends, any, robot, queues, draft, halt: robot === undefined ? 'none' : this.orders.haltOf(robot), touch: coarse.matches};
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
    this.orders.forget();
    this.draft = undefined;
    this.map.canvas.classList.remove('sends');
    this.duty.update(undefined);
    this.onHidden();
  }

  private onOpen(): void {
    this.orders.forget();
    this.failure = '';
    this.changed();
  }

  private onEvent({kind, data}: ServerEvent): void {
    this.orders.on(kind, JSON.parse(data));
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
