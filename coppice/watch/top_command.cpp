#include <algorithm>
#include <iostream>
#include <string>

#include <ncurses.h>
#include <unistd.h>

#include "coppice/commands.h"
#include "dds/dds_bus.h"
#include "monitor/view/fleet_table.h"
#include "runtime/process.h"

namespace coppice {

namespace {

constexpr double redraw_period = 0.25;  // seconds
constexpr double time_to_find_all = 3;  // seconds that --once waits
constexpr const char* keys =
    "q quits   n p g a m: order by name, phase, way to go, age, missed periods   arrows scroll";

/// Takes over the terminal, and restores it afterwards.
class Screen {
 public:
  Screen() {
    initscr();
    cbreak();
    noecho();
    curs_set(0);
    keypad(stdscr, TRUE);
    nodelay(stdscr, TRUE);
  }
  ~Screen() { endwin(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  int key() { return getch(); }
  int height() const { return LINES; }

  void show(const FleetTable& table, std::size_t first) {
    erase();
    int y = 0;
    for (const std::string& line : table.summary) put(y++, line, A_NORMAL);
    ++y;
    put(y++, table.header, A_REVERSE);
    for (std::size_t k = first; k < table.rows.size() && y < LINES - 1; ++k)
      put(y++, table.rows[k], A_NORMAL);
    put(LINES - 1, keys, A_DIM);
    refresh();
  }

 private:
  static void put(int y, const std::string& line, attr_t look) {
    attron(look);
    mvaddnstr(y, 0, line.c_str(), COLS);
    attroff(look);
  }
};

void print(const FleetTable& table) {
  for (const std::string& line : table.summary) std::cout << line << '\n';
  std::cout << '\n' << table.header << '\n';
  for (const std::string& line : table.rows) std::cout << line << '\n';
}

void hear(DdsBus& bus, ProcessClock& clock, FleetView& view, double seconds) {
  bus.wait(seconds);
  for (const Arrival& arrival : take(bus, clock)) view.on(arrival.message, arrival.at);
}

/// The visible part of the table, and its order.
struct Look {
  RobotOrder order = RobotOrder::name;
  std::size_t first = 0;
  bool over = false;

  void on(int key, std::size_t page) {
    switch (key) {
      case 'q':
        over = true;
        break;
      case 'n':
        order = RobotOrder::name;
        break;
      case 'p':
        order = RobotOrder::phase;
        break;
      case 'g':
        order = RobotOrder::to_goal;
        break;
      case 'a':
        order = RobotOrder::age;
        break;
      case 'm':
        order = RobotOrder::missed;
        break;
      case KEY_DOWN:
        ++first;
        break;
      case KEY_UP:
        first -= std::min<std::size_t>(first, 1);
        break;
      case KEY_NPAGE:
        first += page;
        break;
      case KEY_PPAGE:
        first -= std::min(first, page);
        break;
      case KEY_HOME:
        first = 0;
        break;
      default:
        break;
    }
  }
};

int watch(DdsBus& bus, ProcessClock& clock, FleetView& view, RobotOrder order) {
  Screen screen;
  Look look{.order = order};
  WallTime next = 0;
  while (!look.over && !stop_requested()) {
    hear(bus, clock, view, longest_wait);
    const auto page = static_cast<std::size_t>(std::max(1, screen.height() - 8));
    const auto robots = view.robots().size();
    bool pressed = false;
    for (int key = screen.key(); key != ERR; key = screen.key()) {
      look.on(key, page);
      look.first = std::min(look.first, robots == 0 ? 0 : robots - 1);
      pressed = true;
    }
    const WallTime now = clock.now();
    if (now < next && !pressed) continue;
    next = now + redraw_period;
    screen.show(fleet_table(view, look.order, now), look.first);
  }
  return 0;
}

}  // namespace

int top_command(const TopOptions& options) {
  install_stop_signals();
  give_way();
  const RobotOrder order = robot_order(options.order).value();
  DdsBus bus(options.network, Role::viewer, "top");
  ProcessClock clock;
  FleetView view;
  if (!options.once && ::isatty(STDOUT_FILENO) == 1) return watch(bus, clock, view, order);
  const WallTime end = clock.now() + time_to_find_all;
  while (clock.now() < end && !stop_requested()) hear(bus, clock, view, longest_wait);
  print(fleet_table(view, order, clock.now()));
  return view.robots().empty() ? 1 : 0;
}

}  // namespace coppice
